"""The sheet of the kinematic tests: which joints and pairs could move, by set."""

from collections.abc import Callable, Mapping
from functools import partial
from operator import itemgetter
from typing import Any, TypeAlias

from slopekit.core.sheet import Column, Entry, Section, Sheet, Table
from slopekit.kinds.words import shortened
from slopekit.studies.kinematic.criteria import (
    DIRECT,
    JOINT_MODES,
    OBLIQUE,
    OBLIQUE_RELEASE,
    PRIMARY_BOTH,
    PRIMARY_ONE,
    RELEASE,
    SECONDARY,
    SLIDING_BASE,
)
from slopekit.studies.kinematic.run import SEED, Kinematic
from slopekit.studies.surveys import (
    MOST_NAMES,
    codes_of,
    inputs_in_words,
    study_sheet,
    survey_entry,
)

_NO_SET_LABEL = "single"  # joints of no set
_WEDGES = {
    0: "",
    PRIMARY_BOTH: "primary on both",
    PRIMARY_ONE: "primary on one",
    SECONDARY: "secondary",
}
_COLUMNS = {0: "", DIRECT: "direct", OBLIQUE: "oblique"}
_BASES = {0: "", SLIDING_BASE: "sliding", RELEASE: "release", OBLIQUE_RELEASE: "oblique"}
#: Of a set or a face: its name or dip, and counts or percentages.
_TallyRow: TypeAlias = tuple[Any, Mapping[str, Any]]


def sheet_of(analysis: Kinematic) -> Sheet:
    """The sheet of the kinematic tests."""
    m, share = len(analysis.lines.first), partial(_share, analysis)
    parallel = analysis.pairs - m
    pair_remark = (
        f", {analysis.pairs} of them drawn at random (seed {SEED})" if analysis.is_sample else ""
    )
    pair_remark += (
        f", {parallel} of them parallel, without a line of intersection" if parallel else ""
    )
    return study_sheet(
        "kinematic",
        analysis.joints,
        analysis.input_hash(),
        (
            Section(
                "SURVEY", [survey_entry(analysis.joints) + pair_remark, *_sampling_remark(analysis)]
            ),
            Section("INPUTS", inputs_in_words(analysis.inputs(), analysis.defaults)),
            Section(
                "PLANAR",
                [
                    f"{share('planar')} joints slide within the lateral limit, "
                    f"{share('planar_without_limits')} without one",
                    *_joint_names(analysis, "planar"),
                ],
            ),
            Section("WEDGE", _wedge(analysis, share)),
            Section(
                "FLEXURAL",
                [
                    f"{share('flexural')} joints could bend over as layers",
                    *_joint_names(analysis, "flexural"),
                ],
            ),
            Section("DIRECT", _direct(analysis, share)),
            Section("SETS", _sets(analysis)),
            Section("TIME", [f"{analysis.seconds * 1e3:.0f} ms"]),
            Section("NOTE", [str(notice) for notice in analysis.warnings]),
        ),
        {"joints.csv": _joints(analysis), "intersections.csv": _intersections(analysis)},
    )


def line_of(analysis: Kinematic) -> str:
    """The counts on one line."""
    counts = analysis.counts
    direct, oblique = analysis.toppling
    toppling = (
        "direct toppling" if direct else "oblique toppling" if oblique else "no direct toppling"
    )
    line = (
        f"planar {counts['planar']}  wedge {counts['wedge_primary']}+{counts['wedge_secondary']} "
        f"({counts['wedge_by_friction']} by friction)  flexural {counts['flexural']}  {toppling}"
    )
    return "  ".join([line, *codes_of(analysis.warnings)])


def _sampling_remark(analysis: Kinematic) -> list[str]:
    """Return a remark where pairs were sampled: twice the standard error of a share of a half is 0.1 %."""
    if not analysis.is_sample:
        return []
    accuracy = "" if analysis.joints.has_quantities else "; their shares are within 0.1 % (95 %)"
    return [f"lines are counted among the pairs drawn{accuracy}"]


def _joints(analysis: Kinematic) -> Table[int]:
    """Every joint with what could happen to it."""
    modes, (names, sets, dips, dip_directions) = (
        analysis.modes,
        zip(*analysis.joints.rows(), strict=True),
    )
    return Table(
        [
            Column("joint", names, "name"),
            Column("set", sets, "set"),
            Column("dip", dips, "dip", "°", exact=".10g"),
            Column("dip direction", dip_directions, "dip_direction", "°", exact=".10g"),
            Column("φ", analysis.friction_deg, "phi", "°", exact=".10g"),
            Column("slides", modes.planar.astype(int), "planar"),
            Column(
                "slides without lateral limits",
                modes.planar_without_limits.astype(int),
                "planar_without_limits",
            ),
            Column("bends over", modes.flexural.astype(int), "flexural"),
            Column("base of columns", [_BASES[base] for base in modes.base], "base"),
        ],
        range(len(names)),
    )


def _intersections(analysis: Kinematic) -> Table[int]:
    """Every line of intersection with what could happen along it."""
    lines, modes, names = (
        analysis.lines,
        analysis.modes,
        [joint.name for joint in analysis.joints.joints],
    )
    return Table(
        [
            Column("first", lambda k: names[lines.first[k]], "joint1"),
            Column("second", lambda k: names[lines.second[k]], "joint2"),
            Column("trend", lines.trend_deg, "trend", "°", exact=".4f"),
            Column("plunge", lines.plunge_deg, "plunge", "°", exact=".4f"),
            Column("wedge", lambda k: _WEDGES[int(modes.wedge[k])], "wedge"),
            Column("friction fails", modes.by_friction.astype(int), "friction_fails"),
            Column("toppling", lambda k: _COLUMNS[int(modes.column[k])], "toppling"),
        ],
        range(len(lines.first)),
    )


def _share(analysis: Kinematic, *kinds: str) -> str:
    """Joints or lines of some kinds: how many, of how many, and their percentage, by quantity where joints have one."""
    total = len(analysis.joints if kinds[0] in JOINT_MODES else analysis.lines.first)
    count, percent = (
        sum(values[kind] or 0 for kind in kinds) for values in (analysis.counts, analysis.percent)
    )
    by_quantity = " by quantity" if analysis.joints.has_quantities else ""
    return f"{count} of {total} ({percent:.1f} %{by_quantity})" if total else "0 of 0"


def _joint_names(analysis: Kinematic, kind: str) -> list[str]:
    """The joints of a kind, where there are any."""
    return [*filter(None, [", ".join(shortened(analysis.joint_names(kind), MOST_NAMES))])]


def _wedge(analysis: Kinematic, share: Callable[..., str]) -> list[str]:
    counts = analysis.counts
    on_one = counts["wedge_primary"] - counts["wedge_on_both"]
    return [
        f"primary    {share('wedge_primary')} lines daylight and plunge steeper than friction: "
        f"{counts['wedge_on_both']} slide on both joints, {on_one} on one",
        f"secondary  {share('wedge_secondary')} plunge flatter, the wedge slides on one steeper joint",
        f"friction alone does not hold {counts['wedge_by_friction']} of the {counts['wedge']}; the others stick "
        "between their joints (c = 0, dry: F > 1)",
    ]


def _direct(analysis: Kinematic, share: Callable[..., str]) -> list[str]:
    counts, (direct, oblique) = analysis.counts, analysis.toppling
    verdict = {
        (True, True): "possible, also obliquely: there are edges of columns and bases under them",
        (True, False): "possible: there are edges of columns and bases under them",
        (False, True): "obliquely only: outside the lateral limit",
    }.get((direct, oblique))
    if verdict is None:
        edges = bool(counts["direct"] + counts["oblique"])
        lacking = "bases under the columns" if edges else "edges of columns"
        verdict = f"not possible: there are no {lacking}"
    return [
        verdict,
        f"edges  {share('direct')} lines plunge steeply into the slope; {counts['oblique']} oblique",
        f"bases  {share('base_sliding', 'base_release')} joints, on {counts['base_sliding']} of them columns may slide "
        f"as well; {counts['base_oblique']} oblique",
    ]


def _sets(analysis: Kinematic) -> list[Entry]:
    """Joints by set, lines by two sets."""
    by_set = list(analysis.by_set().items())
    if not by_set:
        return []
    by_pair = [
        (f"{a or _NO_SET_LABEL} x {b or _NO_SET_LABEL}", counts)
        for (a, b), counts in analysis.by_set_pair().items()
    ]
    width = min(max(len(name) for name, _ in (*by_set, *by_pair)), 28)

    def name_column(key: str) -> Column[_TallyRow]:
        return Column(
            "",
            itemgetter(0),
            key,
            width=-width - 1,
            text=lambda row: (row[0] or _NO_SET_LABEL)[:width],
        )

    return [
        Table(
            [
                name_column("set"),
                _count("joints", "joints", 7),
                _count("planar", "planar", 8),
                _count("flexural", "flexural", 10),
                Column(
                    "bases",
                    lambda row: row[1]["base_sliding"] + row[1]["base_release"],
                    "bases",
                    width=7,
                ),
            ],
            by_set,
        ),
        Table(
            [
                name_column("sets"),
                _count("lines", "lines", 7),
                _count("primary", "wedge_primary", 9),
                _count("secondary", "wedge_secondary", 11),
                _count("by friction", "wedge_by_friction", 13),
                _count("direct", "direct", 8),
                _count("oblique", "oblique", 9),
            ],
            by_pair,
        ),
    ]


def _count(title: str, kind: str, width: int) -> Column[_TallyRow]:
    return Column(title, lambda row: row[1][kind], kind, width=width)
