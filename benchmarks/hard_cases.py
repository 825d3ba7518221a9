"""The hard cases as curves: docs/hard-cases.json, docs/hard-cases.md and docs/images/hard-*.png.

Run by hand: ``python -m benchmarks.hard_cases`` (ten to fifteen minutes; with names of pictures only
these again, with ``none`` only the page and the pictures). The tests take a few points of each curve.
"""

import json
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from itertools import groupby
from pathlib import Path
from typing import Any

from slopekit import __version__
from slopekit.views.charts import Curve, sweep_chart
from tests.hard_cases.catalogue import SWEEPS
from tests.hard_cases.jumps import JUMPS, Jump, Located, located
from tests.hard_cases.sweeps import NO_DRIVE, Point, Sweep, verdict, walk

DOCS = Path(__file__).parents[1] / "docs"
TITLES = {
    "angle": "Joints nearly parallel", "size": "Size: 1 mm to 100 km",
    "size-blocks": "Size of many blocks",
    "offset": "Coordinates far from the origin",
    "aspect": "Long, thin and slender blocks", "stiffness": "Joint stiffness",
    "water": "Water, past the loss of contact", "pull": "Pulled uphill until sliding reverses",
    "unloaded": "One joint unloaded", "facing": "A joint that turns out of contact",
    "seismic": "Earthquake until the block is lifted", "plunge": "Line or plane close to the face",
    "flat": "Flat joints", "steep": "Steep joints", "friction": "Friction from 0 to 89°", "cohesion": "Cohesion from 0",
}  # fmt: skip
#: Which jumps a picture shows, by the beginning of their names, and what is written beside them.
SHOWN = {
    "water": (("Wyllie & Mah's wedge, water on both: J2", "J2 loses contact (also water on J2)"),
              ("Wyllie & Mah's wedge, water on both: it is", "lifted: both joints"),
              ("Wyllie & Mah's wedge, water on J1", "J1 loses contact"),
              ("paper's wedge, water on both", "lifted: symmetric wedge"), ("plane, water", "lifted: plane"),
              ("block on wet ground", "block tips")),
    "facing": (("wedge, dip direction of J2", "J2 comes into contact"),),
    "seismic": (("steep wedge", "wedge is lifted"),),
    "pull": (("paper's wedge pulled uphill", "wedge: sliding reverses"),),
}  # fmt: skip


@dataclass(frozen=True)
class Walked:
    """A sweep and its points."""

    sweep: Sweep
    points: Sequence[Point]

    def kept(self) -> dict[str, Any]:
        """The curve as columns."""
        sweep, points = self.sweep, self.points
        rows = [asdict(found) | {"seconds": round(found.seconds, 4)} for found in points]
        return {
            "picture": sweep.picture, "name": sweep.name, "kind": sweep.kind, "label": sweep.label,
            "quantity": sweep.quantity, "tolerance": sweep.tolerance[0], "cause": sweep.tolerance[1],
            "verdict": [verdict(sweep, found) for found in points],
            **{key: [row[key] for row in rows] for key in rows[0]},
        }  # fmt: skip

    def worst(self) -> tuple[float, float] | None:
        """Largest error and where it is."""
        errors = [(found.error, found.value) for found in self.points if found.error is not None]
        return max(errors) if errors else None

    def row(self) -> str:
        """The sweep as a line of the table."""
        sweep, worst = self.sweep, self.worst()
        low, high = min(sweep.values), max(sweep.values)
        largest, where = ("none", "") if worst is None else (f"{worst[0]:.1e}", f"{worst[1]:.4g}")
        statuses = Counter(found.status or found.refused for found in self.points)
        lost = [found.value for found in self.points if found.status == "not_converged"]
        said = f"{len(lost)}" + (": " + ", ".join(f"{value:.4g}" for value in lost) if lost else "")
        met = ", ".join(f"{name} {count}" for name, count in statuses.most_common())
        below = sum(verdict(sweep, found) == "below" for found in self.points)
        name = f"[{sweep.name}](images/hard-{sweep.picture}.png)"
        cells = (name, sweep.kind, sweep.label, f"{low:.4g} to {high:.4g}", largest, where, f"{sweep.tolerance[0]:g}",
                 met, below, said)  # fmt: skip
        return f"| {' | '.join(str(cell) for cell in cells)} |"


def draw(picture: str, walks: Sequence[Walked], jumps: Sequence[tuple[Jump, Located]]) -> None:
    """One chart: the errors along all sweeps that share a parameter."""
    curves: list[Curve] = []
    for one in walks:
        curves += _curves(one.sweep.name, one.sweep, [(found.value, found.error) for found in one.points])
    if picture == "stiffness":
        for one in walks:
            failed = [(found.value, found.all_pairs, found.limit) for found in one.points]
            below = [(value, max(1.0 - pairs / limit, 0.0)) for value, pairs, limit in failed if pairs and limit]
            curves += _curves(f"{one.sweep.name}: 1 - all-pairs factor / limit", one.sweep, below)
    shown = [
        (found.exact_place, text) for start, text in SHOWN.get(picture, ()) for jump, found in jumps
        if jump.name.startswith(start)
    ]  # fmt: skip
    sweep = walks[0].sweep
    labels = list(dict.fromkeys(one.sweep.label for one in walks))
    sweep_chart(
        curves, DOCS / "images" / f"hard-{picture}.png", TITLES[picture], labels[0], logarithmic=sweep.logarithmic,
        jumps=shown, tolerance=max(one.sweep.tolerance[0] for one in walks),
    )  # fmt: skip


def _curves(name: str, sweep: Sweep, points: Iterable[tuple[float, float | None]]) -> list[Curve]:
    """The pieces of a curve between the points that have no number."""
    pieces = []
    seen = [(value, error) for value, error in points if value > 0.0 or not sweep.logarithmic]
    for has_number, piece in groupby(seen, key=lambda at: at[1] is not None):
        if has_number:
            values, errors = zip(*piece, strict=True)
            pieces.append(Curve(name, values, errors))
    return pieces


def page(walks: Sequence[Walked], jumps: Sequence[tuple[Jump, Located]]) -> str:
    """docs/hard-cases.md."""
    points = [(one.sweep, found) for one in walks for found in one.points]
    verdicts = Counter(verdict(sweep, found).split(":")[0] for sweep, found in points)
    lines = [
        "# Hard cases", "",
        f"slopekit {__version__} against closed forms in 50 digits (`tests/hard_cases/exact.py`), made by "
        "`python -m benchmarks.hard_cases`; the points are in [hard-cases.json](hard-cases.json).", "",
        f"{len(points)} points: {verdicts['exact']} exact (the number, or the same status where there is none), "
        f"{verdicts['below']} where moments govern (the limit lies below the forces alone, and these are exact), "
        f"{verdicts['said']} without an answer that say so, {verdicts['wrong']} wrong.", "",
        "The largest error is that of the factor of safety (of the volume, of the coordinates where the name says so), "
        "relative; where moments govern it is that of the forces alone, which is what the closed form computes.", "",
        "| sweep | kind | parameter | range | largest error | where | tolerance | statuses met | moments govern "
        "| not converged |",
        "|---|---|---|---|---|---|---|---|---|---|", *(one.row() for one in walks), "",
        "## Causes of the tolerances", "",
        *(f"- {size:g}: {cause}" for size, cause in sorted({one.sweep.tolerance for one in walks})), "",
        f"- `no_driving_force` instead of a number above {NO_DRIVE:g}: what drives is less than a millionth of the "
        "strength.", "",
        "## Jumps", "",
        "Places by bisection, in slopekit to a thousandth of the tolerance. Values: what the reference and the "
        "forces alone (many blocks: the limit) of slopekit have, as far beside the jump as the tolerance.", "",
        "| jump | parameter | place, 50 digits | place, slopekit | apart | tolerance | below: exact, slopekit, limit, "
        "status | above: exact, slopekit, limit, status |",
        "|---|---|---|---|---|---|---|---|",
        *(f"| {jump.name} | {jump.label} | {found.exact_place:.13g} | {found.place:.13g} | {found.off:.1e} "
          f"| {jump.tolerance[0]:g} | {_side(found.below)} | {_side(found.above)} |" for jump, found in jumps), "",
        *(f"- {size:g}: {cause}" for size, cause in sorted({jump.tolerance for jump, _ in jumps})), "",
    ]  # fmt: skip
    for picture in dict.fromkeys(one.sweep.picture for one in walks):
        lines += [f"## {TITLES[picture]}", "", f"![{TITLES[picture]}](images/hard-{picture}.png)", ""]
        if picture == "stiffness":
            lines += ["The all-pairs factor is the upper end of a bracket 1e-5 wide: where that lies above the limit, "
                      "the picture shows no distance.", ""]  # fmt: skip
    return "\n".join(lines)


def _side(found: Point) -> str:
    shown = found.forces_only if found.forces_only is not None else found.limit
    numbers = ", ".join("none" if x is None else f"{x:.8g}" for x in (found.exact, shown, found.limit))
    return f"{numbers}, {found.status}"


def main(again: Sequence[str]) -> None:
    """Walk, bisect, write, draw; with names of pictures (or "jumps", or "none") only these, the rest as on file."""
    (DOCS / "images").mkdir(parents=True, exist_ok=True)
    kept = json.loads((DOCS / "hard-cases.json").read_text(encoding="utf-8")) if again else {"sweeps": [], "jumps": []}
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
    return [_point(dict(zip(names, row, strict=True))) for row in zip(*(curve[name] for name in names), strict=True)]


def _point(row: Mapping[str, Any]) -> Point:
    return Point(**{**row, "flags": tuple(row["flags"])})


def _place(place: Mapping[str, Any]) -> Located:
    return Located(place["exact_place"], place["place"], _point(place["below"]), _point(place["above"]))


def write(walks: Sequence[Walked], jumps: Sequence[tuple[Jump, Located]]) -> None:
    """The data, the page and the pictures."""
    kept = {
        "slopekit": __version__,
        "sweeps": [one.kept() for one in walks],
        "jumps": [
            {"name": jump.name, "label": jump.label, "tolerance": jump.tolerance[0], "cause": jump.tolerance[1],
             "exact_place": found.exact_place, "place": found.place, "apart": found.off,
             "below": asdict(found.below), "above": asdict(found.above)}
            for jump, found in jumps
        ],
    }  # fmt: skip
    text = json.dumps(kept, ensure_ascii=False, allow_nan=False).replace('{"picture"', '\n{"picture"')
    (DOCS / "hard-cases.json").write_text(text.replace('{"name"', '\n{"name"') + "\n", encoding="utf-8")
    (DOCS / "hard-cases.md").write_text(page(walks, jumps), encoding="utf-8")
    for picture, group in groupby(walks, key=lambda one: one.sweep.picture):
        draw(picture, list(group), jumps)


if __name__ == "__main__":
    main(sys.argv[1:])
