"""The sheet of the kinematic tests: which joints and pairs could move, by set and by face, 100 columns."""

import csv
import io
import textwrap
from collections.abc import Mapping, Sequence

from slopekit._version import __version__
from slopekit.core.sheet import WIDTH, block
from slopekit.orientation import number
from slopekit.studies.kinematic import Kinematic
from slopekit.studies.kinematic_criteria import (
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

_MOST_NAMES = 24
_NONE = "single"  # joints of no set
_WEDGES = {0: "", PRIMARY_BOTH: "primary on both", PRIMARY_ONE: "primary on one", SECONDARY: "secondary"}
_COLUMNS = {0: "", DIRECT: "direct", OBLIQUE: "oblique"}
_BASES = {0: "", SLIDING_BASE: "sliding", RELEASE: "release", OBLIQUE_RELEASE: "oblique"}


def kinematic_sheet(found: Kinematic) -> str:
    """The sheet, lines joined, no trailing newline."""
    counts, n, m, of = found.counts, len(found.joints), len(found.lines.first), _Shares(found)
    head = f"slopekit {__version__}   kinematic   sha {found.input_hash()[:6]}   {found.joints.name}"
    lines = textwrap.wrap(head, WIDTH)
    parallel = n * (n - 1) // 2 - m
    sets = found.joints.sets()
    lines += block("SURVEY", [
        f"{n} joints{f' in {len(sets)} sets' if sets else ''}, {n * (n - 1) // 2} pairs"
        + (f", {parallel} of them parallel, without a line of intersection" if parallel else "")
    ])  # fmt: skip
    lines += block("SLOPE", [f"face {found.face}  {found.face.in_words()}; horizontal behind the crest"])
    lines += block("LIMITS", [_limits(found)])
    lines += block("PLANAR", [
        f"{of('planar')} joints slide within the lateral limit, {of('planar_without_limits')} without one",
        *_names(found.joint_names("planar")),
    ])  # fmt: skip
    lines += block("WEDGE", _wedge(found, counts, of))
    lines += block("FLEXURAL", [
        f"{of('flexural')} joints could bend over as layers", *_names(found.joint_names("flexural"))
    ])  # fmt: skip
    lines += block("DIRECT", _direct(found, counts, of))
    lines += block("SETS", _sets(found))
    lines += block("FACES", _faces(found, n, m))
    lines += block("READS AS", [_MEANING])
    lines += block("DEFAULTS", _defaults(found))
    lines += block("TIME", [f"{found.seconds * 1e3:.0f} ms"])
    lines += block("NOTE", [str(notice) for notice in found.warnings])
    return "\n".join(lines)


def kinematic_line(found: Kinematic) -> str:
    """The counts on one line."""
    counts = found.counts
    direct, oblique = found.toppling
    toppling = "direct toppling" if direct else "oblique toppling" if oblique else "no direct toppling"
    return (
        f"planar {counts['planar']}  wedge {counts['wedge_primary']}+{counts['wedge_secondary']} "
        f"({counts['wedge_by_friction']} by friction)  flexural {counts['flexural']}  {toppling}"
    )


def joints_csv(found: Kinematic) -> str:
    """Every joint with what could happen to it."""
    kinds = found.modes
    rows = [
        (
            joint.name, joint.set_name, number(joint.plane.dip_deg), number(joint.plane.dip_direction_deg),
            number(float(phi)), int(planar), int(free), int(flexural), _BASES[int(base)],
        )
        for joint, phi, planar, free, flexural, base in zip(
            found.joints.joints, found.friction_deg, kinds.planar, kinds.planar_without_limits, kinds.flexural,
            kinds.base, strict=True,
        )
    ]  # fmt: skip
    header = "name,set,dip,dip_direction,phi,planar,planar_without_limits,flexural,base"
    return _csv(header, rows)


def intersections_csv(found: Kinematic) -> str:
    """Every line of intersection with what could happen along it."""
    lines, modes, names = found.lines, found.modes, [joint.name for joint in found.joints.joints]
    columns = (
        lines.first.tolist(), lines.second.tolist(), lines.trend_deg.tolist(), lines.plunge_deg.tolist(),
        modes.wedge.tolist(), modes.by_friction.tolist(), modes.column.tolist(),
    )  # fmt: skip
    rows = [
        (names[a], names[b], f"{trend:.4f}", f"{plunge:.4f}", _WEDGES[wedge], int(fails), _COLUMNS[column])
        for a, b, trend, plunge, wedge, fails, column in zip(*columns, strict=True)
    ]
    return _csv("joint1,joint2,trend,plunge,wedge,friction_fails,toppling", rows)


def _csv(header: str, rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    text.write(header + "\n")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


class _Shares:
    """Counts with what they are counted of and their percentages, by quantity where joints have such."""

    def __init__(self, found: Kinematic) -> None:
        self.counts, self.percent = found.counts, found.percent
        self.joints, self.lines = len(found.joints), len(found.lines.first)
        self.by = " by quantity" if found.joints.has_quantities else ""

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


def _limits(found: Kinematic) -> str:
    low, high = float(found.friction_deg.min()), float(found.friction_deg.max())
    friction = f"friction {number(low)}°" if low == high else f"friction {number(low)} to {number(high)}°"
    return (
        f"{friction}; lateral ±{number(found.lateral_deg)}° for planar sliding, "
        f"±{number(found.lateral_toppling_deg)}° for toppling, none for wedges"
    )


def _wedge(found: Kinematic, counts: Mapping[str, int], of: _Shares) -> list[str]:
    on_one = counts["wedge_primary"] - counts["wedge_on_both"]
    entries = [
        f"primary    {of('wedge_primary')} lines daylight and plunge steeper than friction: "
        f"{counts['wedge_on_both']} slide on both joints, {on_one} on one",
        f"secondary  {of('wedge_secondary')} plunge flatter, the wedge slides on one steeper joint "
        f"(Dips draws this zone otherwise: {int(found.modes.secondary_of_dips.sum())} lines)",
        f"friction alone does not hold {counts['wedge_by_friction']} of the {counts['wedge']}; the others stick "
        "between their joints (c = 0, dry: F > 1)",
    ]
    return entries + _partners(found, "wedge")


def _partners(found: Kinematic, kind: str) -> list[str]:
    most = found.partners(kind)[:8]
    if not most:
        return []
    return ["most often: " + ", ".join(f"{name} ({times})" for name, times in most)]


def _direct(found: Kinematic, counts: Mapping[str, int], of: _Shares) -> list[str]:
    direct, oblique = found.toppling
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
        *_partners(found, "direct"),
    ]


def _sets(found: Kinematic) -> list[str]:
    by_set = found.by_set()
    if not by_set:
        return []
    pairs = {f"{a or _NONE} x {b or _NONE}": counts for (a, b), counts in found.by_set_pair().items()}
    width = min(max(len(name) for name in (*by_set, *pairs)), 28)
    rows = [f"{'':<{width}} {'joints':>7}{'planar':>8}{'flexural':>10}{'bases':>7}"]
    for name, counts in by_set.items():
        bases = counts["base_sliding"] + counts["base_release"]
        rows.append(
            f"{(name or _NONE)[:width]:<{width}} {counts['joints']:>7}{counts['planar']:>8}"
            f"{counts['flexural']:>10}{bases:>7}"
        )
    rows.append(
        f"{'':<{width}} {'lines':>7}{'primary':>9}{'secondary':>11}{'by friction':>13}{'direct':>8}{'oblique':>9}"
    )
    for name, counts in pairs.items():
        rows.append(
            f"{name[:width]:<{width}} {counts['lines']:>7}{counts['wedge_primary']:>9}{counts['wedge_secondary']:>11}"
            f"{counts['wedge_by_friction']:>13}{counts['direct']:>8}{counts['oblique']:>9}"
        )
    return rows


def _faces(found: Kinematic, n: int, m: int) -> list[str]:
    if not found.over_faces:
        return []
    by = " by quantity" if found.joints.has_quantities else ""
    rows = [
        f"toward {found.face.dip_direction_deg:03.0f}; per cent{by} of {n} joints (planar, flexural, bases), "
        f"of {m} lines",
        f"{'dip':>5}{'planar':>9}{'primary':>10}{'secondary':>11}{'by friction':>13}{'flexural':>10}{'direct':>9}"
        f"{'oblique':>9}{'bases':>8}",
    ]
    for (dip, _), percent in zip(found.over_faces, found.percent_of_faces, strict=True):
        part = {kind: value or 0.0 for kind, value in percent.items()}
        rows.append(
            f"{dip:>4.4g}°{part['planar']:>9.1f}{part['wedge_primary']:>10.2f}{part['wedge_secondary']:>11.2f}"
            f"{part['wedge_by_friction']:>13.2f}{part['flexural']:>10.1f}{part['direct']:>9.2f}{part['oblique']:>9.2f}"
            f"{part['base_sliding'] + part['base_release']:>8.1f}"
        )
    return rows


def _defaults(found: Kinematic) -> list[str]:
    words = {
        "phi": "φ 30°", "lateral": "lateral limit 20°", "lateral_toppling": "lateral limit of toppling 30°",
    }  # fmt: skip
    return [", ".join(words[name] for name in found.defaults)] if found.defaults else []


_MEANING = (
    "what orientation and friction allow, no more: no cohesion, water or size; whether the joints meet in the slope is "
    "not known. A share is one of poles or lines, not a probability of failure"
)
