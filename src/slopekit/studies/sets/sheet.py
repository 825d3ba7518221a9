"""The sheet of joint sets: how many, what each is, spacing and traces, blocks to paste."""

import math
from collections.abc import Sequence

from slopekit.core.orientation import number, tenths
from slopekit.core.sheet import Column, Entry, Section, Sheet, Table, Verbatim, counted
from slopekit.kinds.words import shortened
from slopekit.studies.sets.clustering import Clusters
from slopekit.studies.sets.run import CONFIDENCE, FoundSet, JointSets
from slopekit.studies.sets.sizes import metres
from slopekit.studies.surveys import MOST_NAMES, codes_of, study_sheet


def sheet_of(joint_sets: JointSets) -> Sheet:
    """The sheet of joint sets."""
    has_ends = any(joint_set.ended is not None for joint_set in joint_sets.sets)
    return study_sheet(
        "sets",
        joint_sets.joints,
        joint_sets.input_hash(),
        (
            Section("SURVEY", _survey(joint_sets)),
            Section("NUMBER", _number_of_sets(joint_sets)),
            Section(
                "SETS",
                [_set_table(joint_sets), _CONE_LEGEND.format(share=100.0 * CONFIDENCE)]
                if joint_sets.sets
                else [],
            ),
            Section("ANGLES", [_angles(joint_sets)] if joint_sets.sets else []),
            Section("SPACING", _lengths(joint_sets, "spacing", _SPACING)),
            Section("TRACE", _lengths(joint_sets, "trace", _TRACE if has_ends else ())),
            Section("NO SET", _joints_without_set(joint_sets)),
            Section(
                "BENCH",
                ["for a design of kind bench:", Verbatim(joint_sets.block)]
                if joint_sets.sets
                else [],
            ),
            Section(
                "PROB",
                [
                    "for slopekit prob, a wedge takes two of them:",
                    Verbatim(joint_sets.scatter_block),
                ]
                if joint_sets.sets
                else [],
            ),
            Section("TIME", [f"{joint_sets.seconds * 1e3:.0f} ms"]),
            Section("NOTE", [str(notice) for notice in joint_sets.warnings]),
        ),
        {"joints.csv": _joint_table(joint_sets), "sets.csv": _full_set_table(joint_sets)},
    )


def line_of(joint_sets: JointSets) -> str:
    """The sets on one line."""
    set_texts = [
        f"{joint_set.name} {joint_set.rounded} ({len(joint_set.members)}, K {_k_text(joint_set.axes.k)})"
        for joint_set in joint_sets.sets
    ]
    remainder = [f"{len(joint_sets.without_set)} of no set"] if joint_sets.without_set else []
    return "  ".join([*(set_texts or ["no sets"]), *remainder, *codes_of(joint_sets.warnings)])


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


def _number_of_sets(joint_sets: JointSets) -> list[Entry]:
    if joint_sets.are_given:
        return [f"{counted(len(joint_sets.sets), 'set')}, those of the column set"]
    if joint_sets.asked is not None:
        return [
            f"{counted(joint_sets.asked, 'set')}, as asked; fuzzy K-means (Hammah & Curran 1998)"
        ]
    columns: list[Column[Clusters]] = [
        Column("sets", len, "sets", width=5),
        Column("BIC", "bic", "bic", show=".1f", width=11),
        Column(
            "of no set", lambda clusters: int((clusters.labels < 0).sum()), "without_set", width=11
        ),
    ]
    return [
        f"{counted(len(joint_sets.sets), 'set')} by the least BIC; fuzzy K-means (Hammah & Curran 1998)",
        Table(columns, list(joint_sets.tried)),
    ]


def _set_table(joint_sets: JointSets) -> Table[FoundSet]:
    return Table(
        [
            _name_column(joint_sets),
            Column("joints", lambda joint_set: len(joint_set.members), "joints", width=7),
            Column("mean", lambda joint_set: str(tenths(joint_set.plane)), "plane", width=12),
            Column("K", "axes.k", "k", show=_k_text, width=10),
            Column(
                "limits",
                lambda joint_set: [joint_set.axes.k_low, joint_set.axes.k_high],
                width=16,
                show=_k_limits,
            ),
            Column("cone of mean", "axes.cone_deg", "cone_of_mean", "°", _DEGREES, 14, blank="-"),
            Column(
                "68 % cone",
                lambda joint_set: joint_set.axes.cone_of(0.68),
                "variability_68",
                "°",
                _DEGREES,
                11,
                blank="-",
            ),
            Column(
                "95 % cone",
                lambda joint_set: joint_set.axes.cone_of(0.95),
                "variability_95",
                "°",
                _DEGREES,
                11,
                blank="-",
            ),
        ],
        list(joint_sets.sets),
    )


def _angles(joint_sets: JointSets) -> Table[FoundSet]:
    return Table(
        [
            _name_column(joint_sets),
            Column("dip", "angles.dip_mean_deg", "dip_mean", "°", _DEGREES, 9, blank="-"),
            Column("sd", "angles.dip_sd_deg", "dip_sd", "°", _DEGREES, 8, blank="-"),
            Column(
                "dip direction",
                "angles.dip_direction_mean_deg",
                "dip_direction_mean",
                "°",
                _DEGREES,
                16,
                blank="-",
            ),
            Column(
                "sd", "angles.dip_direction_sd_deg", "dip_direction_sd", "°", _DEGREES, 8, blank="-"
            ),
            Column("scatter", "axes.scatter_deg", "scatter", "°", _DEGREES, 10, blank="-"),
        ],
        list(joint_sets.sets),
    )


def _lengths(joint_sets: JointSets, name: str, further: Sequence[Column[FoundSet]]) -> list[Entry]:
    """The spacings, or the traces, of the sets that have such, with further columns."""
    rows = [joint_set for joint_set in joint_sets.sets if getattr(joint_set, name) is not None]
    columns: list[Column[FoundSet]] = [
        _name_column(joint_sets),
        Column("number", f"{name}.count", "number", width=8),
        Column("mean", f"{name}.mean_m", "mean", "m", _metres, 9, blank="-"),
        Column(
            "limits",
            lambda joint_set: [getattr(joint_set, name).low_m, getattr(joint_set, name).high_m],
            width=19,
            show=_length_limits,
        ),
        Column("sd", f"{name}.sd_m", "sd", "m", _metres, 9, blank="-"),
        *further,
    ]
    return [Table(columns, rows)] if rows else []


def _metres(value: float) -> str:
    return f"{metres(value)} m"


_SPACING: Sequence[Column[FoundSet]] = (Column("", "spacing.how", "how", width=1, about="  {}"),)
_TRACE: Sequence[Column[FoundSet]] = (
    Column("both ends", "ended", "both_ends_seen", width=11),
    Column("mean if whole", "whole_mean_m", "whole_mean", "m", _metres, 15, blank="-"),
)


def _joints_without_set(joint_sets: JointSets) -> list[Entry]:
    names = joint_sets.without_set
    if not names or not joint_sets.sets:
        return []
    reason = (
        "the list gives them none"
        if joint_sets.are_given
        else "likelier of uniform directions than of a set"
    )
    return [f"{counted(len(names), 'joint')}, {reason}: {', '.join(shortened(names, MOST_NAMES))}"]


def _joint_table(joint_sets: JointSets) -> Table[int]:
    """Every joint with its set: a list that other studies read."""
    names, _, dips, dip_directions = zip(*joint_sets.joints.rows(), strict=True)
    return Table(
        [
            Column("joint", names, "name"),
            Column(
                "set", [joint_sets.sets[k].name if k >= 0 else "" for k in joint_sets.of], "set"
            ),
            Column("dip", dips, "dip", "°", exact=".10g"),
            Column("dip direction", dip_directions, "dip_direction", "°", exact=".10g"),
            Column(
                "weight", joint_sets.weights * joint_sets.joints.quantities, "weight", exact=".6g"
            ),
            Column("angle to the mean", joint_sets.angle_deg, "angle_to_mean", "°", exact=".4f"),
        ],
        range(len(names)),
    )


def _full_set_table(joint_sets: JointSets) -> Table[FoundSet]:
    """Every set with every digit."""
    return Table(
        [
            Column("set", "name", "set"),
            Column("joints", lambda joint_set: len(joint_set.members), "joints"),
            Column("dip", "plane.dip_deg", "dip", "°", exact=".4f"),
            Column("dip direction", "plane.dip_direction_deg", "dip_direction", "°", exact=".4f"),
            Column("K", "axes.k", "k"),
            Column("K low", "axes.k_low", "k_low"),
            Column("K high", "axes.k_high", "k_high"),
            Column("cone", "axes.cone_deg", "cone_of_mean", "°"),
            Column("scatter", "axes.scatter_deg", "scatter", "°"),
            Column("dip sd", "angles.dip_sd_deg", "dip_sd", "°"),
            Column("dip direction sd", "angles.dip_direction_sd_deg", "dip_direction_sd", "°"),
            Column("spacing", "spacing.mean_m", "spacing", "m"),
            Column("spacing sd", "spacing.sd_m", "spacing_sd", "m"),
            Column("trace", "trace.mean_m", "trace", "m"),
            Column("trace if whole", "whole_mean_m", "trace_if_whole", "m"),
        ],
        list(joint_sets.sets),
    )


# -- small things -----------------------------------------------------------------------------------------------------


def _name_column(joint_sets: JointSets) -> Column[FoundSet]:
    width = min(max([len(joint_set.name) for joint_set in joint_sets.sets] + [3]), 12)
    return Column(
        "set", "name", "set", width=-width - 1, text=lambda joint_set: joint_set.name[:width]
    )


def _k_text(value: float) -> str:
    """Fisher's K in three digits."""
    if not math.isfinite(value):
        return "-" if math.isnan(value) else "all alike"
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def _k_limits(limits: Sequence[float]) -> str:
    return f"{_k_text(limits[0])} to {_k_text(limits[1])}" if math.isfinite(limits[0]) else "-"


def _length_limits(limits: Sequence[float]) -> str:
    return "-" if math.isnan(limits[0]) else f"{metres(limits[0])} to {metres(limits[1])}"


_DEGREES = "{:.1f}°"
_CONE_LEGEND = (
    "cone of mean: confidence cone of the mean ({share:.0f} %); 68 %, 95 % cone: variability cones, with so many of "
    "the joints in them"
)
