"""The hard cases as curves: docs/hard-cases.json, docs/hard-cases.md and docs/images/hard-*.png.

Run by hand: ``python -m benchmarks.hard_cases`` (ten to fifteen minutes). Words after it choose what is computed again,
pictures by their names (``water``) and ``jumps``; the rest stays as on file. ``pictures`` computes nothing: the page
and the pictures from the points on file. The tests take a few points of each curve.
"""

import json
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from itertools import groupby
from pathlib import Path
from typing import Any

from benchmarks.charts import Curve, in_short, sweep_chart
from slopekit import __version__
from tests.hard_cases.catalogue import SWEEPS
from tests.hard_cases.jumps import JUMPS, Jump, Located, located
from tests.hard_cases.sweeps import NO_DRIVE, Point, Sweep, verdict, walk

DOCS = Path(__file__).parents[1] / "docs"
TITLES = {
    "angle": "Joints nearly parallel",
    "size": "Size: 1 mm to 100 km",
    "size-blocks": "Size of many blocks",
    "offset": "Coordinates far from the origin",
    "aspect": "Long, thin and slender blocks",
    "stiffness": "Joint stiffness",
    "water": "Water, past the loss of contact",
    "pull": "Pulled uphill until sliding reverses",
    "unloaded": "One joint unloaded",
    "facing": "A joint that turns out of contact",
    "seismic": "Earthquake until the block is lifted",
    "plunge": "Line or plane close to the face",
    "flat": "Flat joints",
    "steep": "Steep joints",
    "friction": "Friction from 0 to 89°",
    "cohesion": "Cohesion from 0",
}
#: Which jumps a picture shows, by the beginning of their names, and what is written beside them.
SHOWN = {
    "water": (
        ("Wyllie & Mah's wedge, water on both: J2", "J2 loses contact (also water on J2)"),
        ("Wyllie & Mah's wedge, water on both: it is", "lifted: both joints"),
        ("Wyllie & Mah's wedge, water on J1", "J1 loses contact"),
        ("paper's wedge, water on both", "lifted: symmetric wedge"),
        ("plane, water", "lifted: plane"),
        ("block on wet ground", "block tips"),
    ),
    "facing": (("wedge, dip direction of J2", "J2 comes into contact"),),
    "seismic": (
        ("steep wedge", "steep wedge is lifted"),
        ("plane, earthquake: it is", "plane is lifted"),
    ),
    "pull": (
        ("paper's wedge pulled uphill", "wedge: sliding reverses"),
        ("plane pulled uphill", "plane: sliding reverses"),
    ),
}
#: Jumps whose parameter is not that of their picture, by the beginning of their names: what to multiply it with.
IN_PICTURE = {"plane pulled uphill": 1.0 / 1835.0}
#: What the errors of a picture are errors of, and what is written below it.
ERRORS = {"factor": "factor of safety", "volume": "volume", "coordinates": "corners"}
ALONE = "forces alone; moments govern the limit"
BRACKET = 1e-5  # of the search for the all-pairs factor
ALL_PAIRS = "1 - all-pairs/limit"
WORDS = {
    "aspect": """What the aspect is:

- long wedge: the line of intersection meets the upper slope that many times as far away as on level ground.
- thin wedge: the line of intersection plunges 0.5/aspect (radians) less than the face dips.
- long plane: the upper slope dips 20°/aspect less than the joint (35°), which it would never meet if parallel.
- thin plane: the joint dips 25°/aspect less than the face (60°).
- long plate: a plate that many metres long and 1 m thick; slender column: that many metres high and 1 m wide, leaning
  half as far as tips it; stack of six plates: each 30 times that long, in metres, and 1 m thick.
- bench: 30 m times that long, the third spacing 14 m times that.
""",
    "stiffness": """The limit does not depend on the stiffness; the factor at which all node pairs have failed (the
paper's criterion) does. That is the upper end of a bracket 1e-5 wide: distances to the limit below 1e-5 are not drawn.
The plane's is never as far off.
""",
}


@dataclass(frozen=True)
class Walked:
    """A sweep and its points."""

    sweep: Sweep
    points: Sequence[Point]

    def collecting(self) -> dict[str, Any]:
        """The curve as columns."""
        sweep, points = self.sweep, self.points
        rows = [asdict(found) | {"seconds": round(found.seconds, 4)} for found in points]
        return {
            "picture": sweep.picture,
            "name": sweep.name,
            "kind": sweep.kind,
            "label": sweep.label,
            "quantity": sweep.quantity,
            "tolerance": sweep.tolerance[0],
            "cause": sweep.tolerance[1],
            "verdict": [verdict(sweep, found) for found in points],
            **{key: [row[key] for row in rows] for key in rows[0]},
        }

    def worst(self, *, governed: bool = False) -> tuple[float, float] | None:
        """Largest error and where it is: of what is compared, or of the forces alone where moments govern the limit."""
        errors = [
            (found.error, found.value)
            for found in self.points
            if found.error is not None and self.governed(found) == governed
        ]
        return max(errors) if errors else None

    def governed(self, found: Point) -> bool:
        """Whether the error of a point is that of the forces alone, because moments govern its limit."""
        return self.sweep.quantity == "factor" and found.below is not None


def draw(picture: str, walks: Sequence[Walked], jumps: Sequence[tuple[Jump, Located]]) -> None:
    """One chart: the errors along all sweeps that share a parameter."""
    curves: list[Curve] = []
    for one in walks:
        curves += _curves(
            one.sweep.name, one.sweep, [(x.value, x.error, one.governed(x)) for x in one.points]
        )
    quantities = dict.fromkeys(one.sweep.quantity for one in walks)
    errors = "of the " + ", ".join(ERRORS[quantity] for quantity in quantities)
    if len(quantities) > 1:
        errors += " (as named)"
    if picture == "stiffness":
        errors = f"of the limit; {ALL_PAIRS} (as named)"
        for one in walks:
            failed = [
                (x.value, 1.0 - x.all_pairs / x.limit)
                for x in one.points
                if x.all_pairs and x.limit
            ]
            below = [(value, distance, False) for value, distance in failed if distance > BRACKET]
            curves += _curves(f"{one.sweep.name}: {ALL_PAIRS}", one.sweep, below)
    shown = [
        (found.exact_place * _in_picture(jump), text)
        for start, text in SHOWN.get(picture, ())
        for jump, found in jumps
        if jump.name.startswith(start)
    ]
    sweep = walks[0].sweep
    sweep_chart(
        curves,
        DOCS / "images" / f"hard-{picture}.png",
        TITLES[picture],
        sweep.label,
        logarithmic=sweep.logarithmic,
        jumps=shown,
        errors=errors,
        tolerances=_tolerances([one.sweep for one in walks]),
        crosses=ALONE,
    )


def _in_picture(jump: Jump) -> float:
    return next(
        (factor for start, factor in IN_PICTURE.items() if jump.name.startswith(start)), 1.0
    )


def _tolerances(sweeps: Sequence[Sweep]) -> list[tuple[float, str]]:
    """Each tolerance with the names of its curves; those of most curves are the others."""
    names: dict[float, list[str]] = {}
    for sweep in sweeps:
        names.setdefault(sweep.tolerance[0], []).append(sweep.name)
    most = max(names, key=lambda size: len(names[size]))
    others = "" if len(names) == 1 else "the others" if len(names[most]) > 1 else names[most][0]
    return [(size, others if size == most else "; ".join(of)) for size, of in names.items()]


def _curves(
    name: str, sweep: Sweep, points: Iterable[tuple[float, float | None, bool]]
) -> list[Curve]:
    """The pieces of a curve between the points that have no number; each point with whether it is drawn as a cross."""
    pieces = []
    seen = [at for at in points if at[0] > 0.0 or not sweep.logarithmic]
    for has_number, piece in groupby(seen, key=lambda at: at[1] is not None):
        if has_number:
            values, errors, crossed = zip(*piece, strict=True)
            pieces.append(Curve(name, values, errors, crossed=crossed))
    return pieces


def page(walks: Sequence[Walked], jumps: Sequence[tuple[Jump, Located]]) -> str:
    """docs/hard-cases.md."""
    points = [(one.sweep, found) for one in walks for found in one.points]
    verdicts = Counter(verdict(sweep, found).split(":")[0] for sweep, found in points)
    agreed = [(sweep, found) for sweep, found in points if verdict(sweep, found) == "agrees"]
    numbers = sum(sweep.quantity == "factor" and found.exact is not None for sweep, found in agreed)
    shapes = sum(sweep.quantity != "factor" for sweep, _ in agreed)
    none = sum(
        found.limit is None for sweep, found in points if verdict(sweep, found) == "moments govern"
    )
    sizes = sorted({one.sweep.tolerance[0] for one in walks})
    lines = [
        "# Hard cases",
        "",
        f"Sweeps of one input to the edge of what is possible, slopekit {__version__} against closed forms in 50 "
        "digits (`tests/hard_cases/exact.py`). Made by `python -m benchmarks.hard_cases`; every point, with its "
        "status, is in [hard-cases.json](hard-cases.json).",
        "",
        f"{len(points)} points:",
        "",
        f"- {verdicts['agrees']} agree with the closed form within the tolerance of their sweep "
        f"({in_short(sizes[0])} to {in_short(sizes[-1])}, causes below): {numbers} factors of safety, {shapes} volumes "
        f"and places of corners, {len(agreed) - numbers - shapes} without a number on either side.",
        f"- {verdicts['moments govern']} where moments govern. The closed form knows forces only, so the limit has no "
        "reference: checked are slopekit's forces alone, within the same tolerances, and that the limit does not lie "
        f"above them (in {none} the block topples or turns and has no limit).",
        f"- {verdicts['said']} without an answer that say so.",
        f"- {verdicts['wrong']} wrong.",
        "",
        "Errors are relative. In the pictures a cross is the error of the forces alone where moments govern, an open "
        "marker at the bottom is no error to 16 digits, dashed lines are tolerances, dotted lines jumps.",
        "",
        "Compared is the limit, or what the name of the sweep says. Below each picture stands what was swept, the "
        "largest error beside the tolerance, and where moments govern the largest error of the forces alone.",
        "",
        "## Causes of the tolerances",
        "",
        *(
            f"- {in_short(size)}: {cause}"
            for size, cause in sorted({one.sweep.tolerance for one in walks})
        ),
        "",
        f"- `no_driving_force` instead of a number above {in_short(NO_DRIVE)}: what drives is less than a millionth of "
        "the strength.",
        "",
        "## Jumps",
        "",
        "Where the status changes, by bisection. Values on either side are in hard-cases.json.",
        "",
        "| jump | parameter | place, 50 digits | slopekit | apart | tolerance | status below | above |",
        "|---|---|---|---|---|---|---|---|",
        *(
            f"| {jump.name} | {jump.label} | {found.exact_place:.13g} | {found.place:.13g} | {found.off:.1e} "
            f"| {in_short(jump.tolerance[0])} | {found.below.status} | {found.above.status} |"
            for jump, found in jumps
        ),
        "",
        *(
            f"- {in_short(size)}: {cause}"
            for size, cause in sorted({jump.tolerance for jump, _ in jumps})
        ),
        "",
    ]
    for picture in dict.fromkeys(one.sweep.picture for one in walks):
        lines += [
            f"## {TITLES[picture]}",
            "",
            f"![{TITLES[picture]}](images/hard-{picture}.png)",
            "",
        ]
        lines += [*_sweeps_of([one for one in walks if one.sweep.picture == picture]), ""]
        if picture in WORDS:
            lines += [WORDS[picture]]
        if picture == "seismic":
            lines += [_toppling([one for one in walks if one.sweep.picture == picture])]
    return "\n".join(lines)


def _sweeps_of(walks: Sequence[Walked]) -> list[str]:
    """The sweeps of a picture, those of one parameter and tolerance on a line."""
    groups: dict[tuple[str, float], list[Walked]] = {}
    for one in walks:
        groups.setdefault((one.sweep.label, one.sweep.tolerance[0]), []).append(one)
    lines = []
    for (label, tolerance), members in groups.items():
        values = [value for one in members for value in one.sweep.values]
        names = "; ".join(one.sweep.name for one in members)
        errors = [worst[0] for one in members if (worst := one.worst()) is not None]
        alone = [worst[0] for one in members if (worst := one.worst(governed=True)) is not None]
        governed = sum(one.governed(found) for one in members for found in one.points)
        told = (
            f"largest error {max(errors):.1e}, tolerance {in_short(tolerance)}"
            if errors
            else "no error compared"
        )
        if governed:
            told += f"; moments govern at {governed} points (forces alone {max(alone):.1e})"
        lines.append(f"- {label}, {min(values):.4g} to {max(values):.4g}: {told}. Sweeps: {names}.")
    return lines


def _toppling(walks: Sequence[Walked]) -> str:
    """From where on blocks topple before they slide."""
    starts = [
        f"{min(found.value for found in one.points if found.status == 'topples'):g} ({one.sweep.name})"
        for one in walks
        if any(found.status == "topples" for found in one.points)
    ]
    return f"From {' and '.join(starts)} on the block topples before it slides, and there is no limit.\n"


def main(again: Sequence[str]) -> None:
    """Walk, bisect, write, draw; with names of pictures, "jumps" or "pictures" only these, the rest as on file."""
    unknown = sorted(set(again) - {*TITLES, "jumps", "pictures"})
    if unknown:
        sys.exit(
            f"no such picture: {', '.join(unknown)}; there are {', '.join(TITLES)}, and the words jumps, pictures"
        )
    (DOCS / "images").mkdir(parents=True, exist_ok=True)
    kept = (
        json.loads((DOCS / "hard-cases.json").read_text(encoding="utf-8"))
        if again
        else {"sweeps": [], "jumps": []}
    )
    curves = {(curve["picture"], curve["name"]): curve for curve in kept["sweeps"]}
    places = {place["name"]: place for place in kept["jumps"]}
    walks, jumps = [], []
    for sweep in SWEEPS:
        curve = curves.get((sweep.picture, sweep.name))
        if curve is not None and sweep.picture not in again:
            walks.append(Walked(sweep, _points(curve)))
            continue
        walks.append(Walked(sweep, walk(sweep, sweep.values)))
        texts = [(found.value, verdict(sweep, found)) for found in walks[-1].points]
        wrong = [(value, text) for value, text in texts if text.startswith("wrong")]
        said = f"{sweep.picture}: {sweep.name}, largest error and where: {walks[-1].worst()}"
        print(said, *wrong, file=sys.stderr, flush=True)
    for jump in JUMPS:
        place = places.get(jump.name)
        if place is not None and "jumps" not in again:
            jumps.append((jump, _place(place)))
            continue
        jumps.append((jump, located(jump)))
        print(f"{jump.name}: {jumps[-1][1].off:.1e} apart", file=sys.stderr, flush=True)
    write(walks, jumps)


def _points(curve: Mapping[str, Any]) -> list[Point]:
    names = [field.name for field in fields(Point)]
    return [
        _point(dict(zip(names, row, strict=True)))
        for row in zip(*(curve[name] for name in names), strict=True)
    ]


def _point(row: Mapping[str, Any]) -> Point:
    return Point(**{**row, "flags": tuple(row["flags"])})


def _place(place: Mapping[str, Any]) -> Located:
    return Located(
        place["exact_place"], place["place"], _point(place["below"]), _point(place["above"])
    )


def write(walks: Sequence[Walked], jumps: Sequence[tuple[Jump, Located]]) -> None:
    """The data, the page and the pictures."""
    kept = {
        "slopekit": __version__,
        "sweeps": [one.collecting() for one in walks],
        "jumps": [
            {
                "name": jump.name,
                "label": jump.label,
                "tolerance": jump.tolerance[0],
                "cause": jump.tolerance[1],
                "exact_place": found.exact_place,
                "place": found.place,
                "apart": found.off,
                "below": asdict(found.below),
                "above": asdict(found.above),
            }
            for jump, found in jumps
        ],
    }
    text = json.dumps(kept, ensure_ascii=False, allow_nan=False).replace(
        '{"picture"', '\n{"picture"'
    )
    (DOCS / "hard-cases.json").write_text(
        text.replace('{"name"', '\n{"name"') + "\n", encoding="utf-8"
    )
    (DOCS / "hard-cases.md").write_text(page(walks, jumps), encoding="utf-8")
    for picture, group in groupby(walks, key=lambda one: one.sweep.picture):
        draw(picture, list(group), jumps)


if __name__ == "__main__":
    main(sys.argv[1:])
