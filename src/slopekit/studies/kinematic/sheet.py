"""The sheet of the kinematic tests: which joints and pairs could move, by set."""

from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from slopekit.core.sheet import Column, Entry, Section, Sheet, Table
from slopekit.studies.kinematic.criteria import (
    DIRECT,
    OBLIQUE,
    OBLIQUE_RELEASE,
    OF_JOINTS,
    PRIMARY_BOTH,
    PRIMARY_ONE,
    RELEASE,
    SECONDARY,
    SLIDING_BASE,
)
from slopekit.studies.kinematic.run import SEED, Kinematic
from slopekit.studies.surveys import codes_of, inputs_in_words, study_sheet, survey_entry

_MOST_NAMES = 24
_NONE = "single"  # joints of no set
_WEDGES = {0: "", PRIMARY_BOTH: "primary on both", PRIMARY_ONE: "primary on one", SECONDARY: "secondary"}
_COLUMNS = {0: "", DIRECT: "direct", OBLIQUE: "oblique"}
_BASES = {0: "", SLIDING_BASE: "sliding", RELEASE: "release", OBLIQUE_RELEASE: "oblique"}
#: Of a set or a face: its name or dip, and counts or percentages.
_Counted: TypeAlias = tuple[Any, Mapping[str, Any]]


def sheet_of(analysis: Kinematic) -> Sheet:
    """The sheet of the kinematic tests."""
    m, of = len(analysis.lines.first), _Shares(analysis)
    parallel = analysis.pairs - m
    few = f", {analysis.pairs} of them drawn at random (seed {SEED})" if analysis.is_sample else ""
    few += f", {parallel} of them parallel, without a line of intersection" if parallel else ""
    return study_sheet("kinematic", analysis.joints, analysis.input_hash(), (
        Section("SURVEY", [survey_entry(analysis.joints) + few, *_drawn(analysis)]),
        Section("INPUTS", inputs_in_words(analysis.inputs(), analysis.defaults)),
        Section("PLANAR", [
            f"{of('planar')} joints slide within the lateral limit, {of('planar_without_limits')} without one",
            *_names(analysis.joint_names("planar")),
        ]),
        Section("WEDGE", _wedge(analysis, of)),
        Section("FLEXURAL", [
            f"{of('flexural')} joints could bend over as layers", *_names(analysis.joint_names("flexural"))
        ]),
        Section("DIRECT", _direct(analysis, of)),
        Section("SETS", _sets(analysis)),
        Section("TIME", [f"{analysis.seconds * 1e3:.0f} ms"]),
        Section("NOTE", [str(notice) for notice in analysis.warnings]),
    ), {"joints.csv": _joints(analysis), "intersections.csv": _intersections(analysis)})  # fmt: skip


def line_of(analysis: Kinematic) -> str:
    """The counts on one line."""
    counts = analysis.counts
    direct, oblique = analysis.toppling
    toppling = "direct toppling" if direct else "oblique toppling" if oblique else "no direct toppling"
    line = (
        f"planar {counts['planar']}  wedge {counts['wedge_primary']}+{counts['wedge_secondary']} "
        f"({counts['wedge_by_friction']} by friction)  flexural {counts['flexural']}  {toppling}"
    )
    return "  ".join([line, *codes_of(analysis.warnings)])


def _drawn(analysis: Kinematic) -> list[str]:
    """What counts of lines mean where pairs were drawn: twice the standard error of a share of a half is 0.1 %."""
    if not analysis.is_sample:
        return []
    within = "" if analysis.joints.has_quantities else "; their shares are within 0.1 % (95 %)"
    return [f"lines are counted among the pairs drawn{within}"]


def _joints(analysis: Kinematic) -> Table[int]:
    """Every joint with what could happen to it."""
    joints, modes = analysis.joints.joints, analysis.modes
    return Table([
        Column("joint", lambda k: joints[k].name, "name"),
        Column("set", lambda k: joints[k].set_name, "set"),
        Column("dip", lambda k: joints[k].plane.dip_deg, "dip", "°", exact=".10g"),
        Column("dip direction", lambda k: joints[k].plane.dip_direction_deg, "dip_direction", "°", exact=".10g"),
        Column("φ", _at(analysis.friction_deg, float), "phi", "°", exact=".10g"),
        Column("slides", _at(modes.planar, int), "planar"),
        Column("slides without lateral limits", _at(modes.planar_without_limits, int), "planar_without_limits"),
        Column("bends over", _at(modes.flexural, int), "flexural"),
        Column("base of columns", _at(modes.base, _BASES.__getitem__), "base"),
    ], range(len(joints)))  # fmt: skip


def _intersections(analysis: Kinematic) -> Table[int]:
    """Every line of intersection with what could happen along it."""
    lines, modes, names = analysis.lines, analysis.modes, [joint.name for joint in analysis.joints.joints]
    return Table([
        Column("first", _at(lines.first, names.__getitem__), "joint1"),
        Column("second", _at(lines.second, names.__getitem__), "joint2"),
        Column("trend", _at(lines.trend_deg, float), "trend", "°", exact=".4f"),
        Column("plunge", _at(lines.plunge_deg, float), "plunge", "°", exact=".4f"),
        Column("wedge", _at(modes.wedge, _WEDGES.__getitem__), "wedge"),
        Column("friction fails", _at(modes.by_friction, int), "friction_fails"),
        Column("toppling", _at(modes.column, _COLUMNS.__getitem__), "toppling"),
    ], range(len(lines.first)))  # fmt: skip


def _at(values: Any, what: Callable[[Any], Any]) -> Callable[[int], Any]:
    """What the values (n,) of joints or lines mean, by number."""
    return lambda k: what(values[k])


class _Shares:
    """Counts with what they are counted of and their percentages, by quantity where joints have such."""

    def __init__(self, analysis: Kinematic) -> None:
        self.counts, self.percent = analysis.counts, analysis.percent
        self.joints, self.lines = len(analysis.joints), len(analysis.lines.first)
        self.by = " by quantity" if analysis.joints.has_quantities else ""

    def __call__(self, *kinds: str) -> str:
        whole = self.joints if kinds[0] in OF_JOINTS else self.lines
        percent = sum(self.percent[kind] or 0.0 for kind in kinds)
        count = sum(self.counts[kind] for kind in kinds)
        return f"{count} of {whole} ({percent:.1f} %{self.by})" if whole else "0 of 0"


def _names(names: Sequence[str]) -> list[str]:
    if not names:
        return []
    more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    return [", ".join(names[:_MOST_NAMES]) + more]


def _wedge(analysis: Kinematic, of: _Shares) -> list[str]:
    counts = analysis.counts
    on_one = counts["wedge_primary"] - counts["wedge_on_both"]
    return [
        f"primary    {of('wedge_primary')} lines daylight and plunge steeper than friction: "
        f"{counts['wedge_on_both']} slide on both joints, {on_one} on one",
        f"secondary  {of('wedge_secondary')} plunge flatter, the wedge slides on one steeper joint",
        f"friction alone does not hold {counts['wedge_by_friction']} of the {counts['wedge']}; the others stick "
        "between their joints (c = 0, dry: F > 1)",
    ]


def _direct(analysis: Kinematic, of: _Shares) -> list[str]:
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
        f"edges  {of('direct')} lines plunge steeply into the slope; {counts['oblique']} oblique",
        f"bases  {of('base_sliding', 'base_release')} joints, on {counts['base_sliding']} of them columns may slide "
        f"as well; {counts['base_oblique']} oblique",
    ]


def _sets(analysis: Kinematic) -> list[Entry]:
    """Joints by set, lines by two sets."""
    by_set = list(analysis.by_set().items())
    if not by_set:
        return []
    by_pair = [(f"{a or _NONE} x {b or _NONE}", counts) for (a, b), counts in analysis.by_set_pair().items()]
    width = min(max(len(name) for name, _ in (*by_set, *by_pair)), 28)

    def named(key: str) -> Column[_Counted]:
        return Column("", itemgetter(0), key, width=-width - 1, text=lambda row: (row[0] or _NONE)[:width])

    return [
        Table([named("set"), _count("joints", "joints", 7), _count("planar", "planar", 8),
               _count("flexural", "flexural", 10),
               Column("bases", lambda row: row[1]["base_sliding"] + row[1]["base_release"], "bases", width=7)], by_set),
        Table([named("sets"), _count("lines", "lines", 7), _count("primary", "wedge_primary", 9),
               _count("secondary", "wedge_secondary", 11), _count("by friction", "wedge_by_friction", 13),
               _count("direct", "direct", 8), _count("oblique", "oblique", 9)], by_pair),
    ]  # fmt: skip


def _count(title: str, kind: str, width: int) -> Column[_Counted]:
    return Column(title, lambda row: row[1][kind], kind, width=width)
