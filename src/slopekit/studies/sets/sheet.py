"""The sheet of joint sets: how many, what each is, spacing and traces, blocks to paste."""

import math
from operator import attrgetter
from typing import Any

from slopekit.core.orientation import number, tenths
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, Verbatim, counted
from slopekit.studies.sets.clustering import Clusters
from slopekit.studies.sets.run import CONFIDENCE, FoundSet, JointSets
from slopekit.studies.sets.sizes import metres
from slopekit.studies.surveys import codes_of, study_sheet

_MOST_NAMES = 24


def sheet_of(joint_sets: JointSets) -> Sheet:
    """The sheet of joint sets."""
    return study_sheet("sets", joint_sets.joints, joint_sets.input_hash(), (
        Section("SURVEY", _survey(joint_sets)),
        Section("NUMBER", _number(joint_sets)),
        Section("SETS", [_table(joint_sets), _WORDS.format(share=100.0 * CONFIDENCE)] if joint_sets.sets else []),
        Section("ANGLES", [_angles(joint_sets)] if joint_sets.sets else []),
        Section("SPACING", _spacing(joint_sets)),
        Section("TRACE", _trace(joint_sets)),
        Section("NO SET", _alone(joint_sets)),
        Section("BENCH", ["for a design of kind bench:", Verbatim(joint_sets.block)] if joint_sets.sets else []),
        Section("PROB", ["for slopekit prob, a wedge takes two of them:", Verbatim(joint_sets.scatter_block)]
                if joint_sets.sets else []),
        Section("TIME", [f"{joint_sets.seconds * 1e3:.0f} ms"]),
        Section("NOTE", [str(notice) for notice in joint_sets.warnings]),
    ), {"joints.csv": _joints(joint_sets), "sets.csv": _sets(joint_sets)})  # fmt: skip


def line_of(joint_sets: JointSets) -> str:
    """The sets on one line."""
    each = [f"{one.name} {one.rounded} ({len(one.members)}, K {_k(one.axes.k)})" for one in joint_sets.sets]
    alone = [f"{len(joint_sets.without_set)} of no set"] if joint_sets.without_set else []
    return "  ".join([*(each or ["no sets"]), *alone, *codes_of(joint_sets.warnings)])


def _survey(joint_sets: JointSets) -> list[Entry]:
    joints = joint_sets.joints
    entries: list[Entry] = [counted(len(joints), "joint")]
    if joints.has_quantities:
        entries[0] = f"{counted(len(joints), 'joint')}, {joints.quantities.sum():.6g} by quantity"
    if joint_sets.scanline is not None:
        entries.append(
            f"scanline {joint_sets.scanline}: Terzaghi weights 1 / sin of the angle between joint and line, from "
            f"{joint_sets.weights.min():.2f} to {joint_sets.weights.max():.2f}, {joint_sets.capped} cut off at "
            f"{number(joint_sets.bias_angle_deg)}°"
        )
    return entries


def _number(joint_sets: JointSets) -> list[Entry]:
    if joint_sets.are_given:
        return [f"{counted(len(joint_sets.sets), 'set')}, those of the column set"]
    if joint_sets.asked is not None:
        return [f"{counted(joint_sets.asked, 'set')}, as asked; fuzzy K-means (Hammah & Curran 1998)"]
    columns: list[Column[Clusters]] = [
        Column("sets", len, "sets", width=5),
        Column("BIC", attrgetter("bic"), "bic", show=".1f", width=11),
        Column("of no set", lambda one: int((one.of < 0).sum()), "without_set", width=11),
    ]
    return [
        f"{counted(len(joint_sets.sets), 'set')} by the least BIC; fuzzy K-means (Hammah & Curran 1998)",
        Table(columns, list(joint_sets.tried)),
    ]


def _table(joint_sets: JointSets) -> Table[FoundSet]:
    return Table([
        _name(joint_sets),
        Column("joints", lambda one: len(one.members), "joints", width=7),
        Column("mean", lambda one: str(tenths(one.plane)), "plane", width=12),
        Column("K", lambda one: one.axes.k, "k", show=_k, width=10),
        Column("limits", lambda one: [one.axes.k_low, one.axes.k_high], "", width=16, text=_limits),
        Column("cone of mean", lambda one: one.axes.cone_deg, "cone_of_mean", "°", _degrees, 14),
        Column("68 % cone", lambda one: one.axes.cone_of(0.68), "variability_68", "°", _degrees, 11),
        Column("95 % cone", lambda one: one.axes.cone_of(0.95), "variability_95", "°", _degrees, 11),
    ], list(joint_sets.sets))  # fmt: skip


def _angles(joint_sets: JointSets) -> Table[FoundSet]:
    return Table([
        _name(joint_sets),
        Column("dip", lambda one: one.angles["dip_mean_deg"], "dip_mean", "°", _degrees, 9),
        Column("sd", lambda one: one.angles["dip_sd_deg"], "dip_sd", "°", _degrees, 8),
        Column("dip direction", lambda one: one.angles["dip_direction_mean_deg"], "dip_direction_mean", "°", _degrees,
               16),
        Column("sd", lambda one: one.angles["dip_direction_sd_deg"], "dip_direction_sd", "°", _degrees, 8),
        Column("scatter", lambda one: one.axes.scatter_deg, "scatter", "°", _degrees, 10),
    ], list(joint_sets.sets))  # fmt: skip


def _spacing(joint_sets: JointSets) -> list[Entry]:
    rows = [one for one in joint_sets.sets if one.spacing is not None]
    if not rows:
        return []
    columns = [_name(joint_sets), *_lengths("spacing"), Column("", attrgetter("spacing.how"), "how", width=1,
                                                               text=lambda one: "  " + one.spacing.how)]  # fmt: skip
    return [Table(columns, rows)]


def _trace(joint_sets: JointSets) -> list[Entry]:
    rows = [one for one in joint_sets.sets if one.trace is not None]
    if not rows:
        return []
    columns = [_name(joint_sets), *_lengths("trace")]
    if any(one.ended is not None for one in rows):
        columns += [
            Column("both ends", attrgetter("ended"), "both_ends_seen", width=11),
            Column("mean if whole", attrgetter("whole_mean_m"), "whole_mean", "m", _metres, 15),
        ]
    return [Table(columns, rows)]


def _lengths(of: str) -> list[Column[FoundSet]]:
    return [
        Column("number", attrgetter(f"{of}.count"), "number", width=8),
        Column("mean", attrgetter(f"{of}.mean_m"), "mean", "m", _metres, 9),
        Column("limits", lambda one: [attrgetter(f"{of}.low_m")(one), attrgetter(f"{of}.high_m")(one)], width=19,
               text=lambda one: _between(attrgetter(f"{of}.low_m")(one), attrgetter(f"{of}.high_m")(one))),
        Column("sd", attrgetter(f"{of}.sd_m"), "sd", "m", _metres, 9),
    ]  # fmt: skip


def _alone(joint_sets: JointSets) -> list[Entry]:
    names = joint_sets.without_set
    if not names or not joint_sets.sets:
        return []
    more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    why = "the list gives them none" if joint_sets.are_given else "likelier of uniform directions than of a set"
    return [f"{counted(len(names), 'joint')}, {why}: " + ", ".join(names[:_MOST_NAMES]) + more]


def _joints(joint_sets: JointSets) -> Table[int]:
    """Every joint with its set: a list that other studies read."""
    joints = joint_sets.joints.joints
    return Table([
        Column("joint", lambda k: joints[k].name, "name"),
        Column("set", lambda k: joint_sets.sets[joint_sets.of[k]].name if joint_sets.of[k] >= 0 else "", "set"),
        Column("dip", lambda k: joints[k].plane.dip_deg, "dip", "°", exact=".10g"),
        Column("dip direction", lambda k: joints[k].plane.dip_direction_deg, "dip_direction", "°", exact=".10g"),
        Column("weight", lambda k: float(joint_sets.weights[k] * joints[k].quantity), "weight", exact=".6g"),
        Column("angle to the mean", lambda k: float(joint_sets.angle_deg[k]), "angle_to_mean", "°", exact=".4f"),
    ], range(len(joints)))  # fmt: skip


def _sets(joint_sets: JointSets) -> Table[FoundSet]:
    """Every set with every digit."""
    return Table([
        Column("set", attrgetter("name"), "set"),
        Column("joints", lambda one: len(one.members), "joints"),
        Column("dip", attrgetter("plane.dip_deg"), "dip", "°", exact=".4f"),
        Column("dip direction", attrgetter("plane.dip_direction_deg"), "dip_direction", "°", exact=".4f"),
        Column("K", attrgetter("axes.k"), "k"), Column("K low", attrgetter("axes.k_low"), "k_low"),
        Column("K high", attrgetter("axes.k_high"), "k_high"),
        Column("cone", attrgetter("axes.cone_deg"), "cone_of_mean", "°"),
        Column("scatter", attrgetter("axes.scatter_deg"), "scatter", "°"),
        Column("dip sd", lambda one: one.angles["dip_sd_deg"], "dip_sd", "°"),
        Column("dip direction sd", lambda one: one.angles["dip_direction_sd_deg"], "dip_direction_sd", "°"),
        Column("spacing", lambda one: one.spacing and one.spacing.mean_m, "spacing", "m"),
        Column("spacing sd", lambda one: one.spacing and one.spacing.sd_m, "spacing_sd", "m"),
        Column("trace", lambda one: one.trace and one.trace.mean_m, "trace", "m"),
        Column("trace if whole", attrgetter("whole_mean_m"), "trace_if_whole", "m"),
    ], list(joint_sets.sets))  # fmt: skip


# -- small things -----------------------------------------------------------------------------------------------------


def _name(joint_sets: JointSets) -> Column[FoundSet]:
    width = min(max([len(one.name) for one in joint_sets.sets] + [3]), 12)
    return Column("set", attrgetter("name"), "set", width=-width - 1, text=lambda one: one.name[:width])


def _k(value: float) -> str:
    return (
        "-"
        if math.isnan(value)
        else "all alike"
        if math.isinf(value)
        else f"{value:.3g}"
        if value < 1000
        else f"{value:.0f}"
    )


def _limits(one: FoundSet) -> str:
    return f"{_k(one.axes.k_low)} to {_k(one.axes.k_high)}" if math.isfinite(one.axes.k_low) else "-"


def _between(low: float, high: float) -> str:
    return "-" if math.isnan(low) else f"{metres(low)} to {metres(high)}"


def _degrees(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.1f}°"


def _metres(value: Any) -> str:
    return "-" if value is None or math.isnan(value) else f"{metres(value)} m"


_WORDS = (
    "cone of mean: confidence cone of the mean ({share:.0f} %); 68 %, 95 % cone: variability cones, with so many of "
    "the joints in them"
)
