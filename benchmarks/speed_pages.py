"""Where the rows of `speed_error` go: docs/speed.json, docs/speed.md and its charts."""

import json
import math
import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path

from benchmarks.charts import FLOOR, Curve, speed_error_chart
from benchmarks.speed_error import (
    CLOSED,
    COMMAND,
    PUBLISHED,
    SIZES,
    SLOPEKIT,
    SOLVERS,
    Row,
    ellipsoid,
    many_sizes,
    wedge,
    with_command,
)

_DOCS = Path(__file__).resolve().parent.parent / "docs"
_JSON = _DOCS / "speed.json"
_LIBRARIES = ("numpy", "scipy", "clarabel", "manifold3d")


@dataclass(frozen=True)
class SceneOfSpeed:
    """A chapter: how its rows come about and what to say of them."""

    title: str
    run: Callable[[bool], list[Row]]
    words: str
    against: str = "the closed form"


SCENES = {
    "wedge": SceneOfSpeed(
        "The paper's wedge, one block",
        wedge,
        "Table 4 of Sheng et al. 2023; reference: Hoek & Bray. The paper's 5 s are of its authors' machine; the cold "
        "command beside it is a whole process, imports included.",
    ),
    "ellipsoid": SceneOfSpeed(
        "The paper's ellipsoid, one block",
        ellipsoid,
        "No closed form; reference: slopekit on the finest mesh. Siconos picks normal forces of its own, which are not "
        "unique on a curved surface.",
        "the finest true-normal answer",
    ),
    "columns": SceneOfSpeed(
        "Toppling columns in rows",
        partial(many_sizes, "columns"),
        "Goodman & Bray's 16 columns (φ = 38.15°) in rows that do not touch, one model; reference: limit equilibrium.",
    ),
    "wall": SceneOfSpeed(
        "Wall in running bond",
        partial(many_sizes, "wall"),
        "Ten courses on a base of 20°, φ = 35°; reference: tan φ / tan β. Normal forces are not unique here.",
    ),
    "stack": SceneOfSpeed(
        "Stacks of 100 blocks",
        partial(many_sizes, "stack"),
        "As many stacks on a base of 30° as it takes, φ = 35°; reference: tan φ / tan β.",
    ),
}

_PREFACE = """# Speed against error

Made by `python -m benchmarks`; every row, with all efforts, is in [speed.json](speed.json).

All solvers of a table were timed in the same run on the same model, in turns: median seconds without cutting and
meshing, and how many times those of the closed form and of slopekit. The tables have the smallest and the largest
model and each solver at its most effort, the charts and the file all of them. `e`: estimated from a part of the work.
In charts of many blocks labels are numbers of blocks; the closed form, the reference, is left out.

- **closed form**: the book's formula.
- **slopekit limit**: the limit with its upper bound; of many blocks that of the elastic path, the note says on what
  it rests.
- **slopekit with range**: with the range of its mechanism under other locked-in forces. Nothing else here answers
  that.
- **conic sequence**: passes with the friction frozen at the normal forces of the last, put to Clarabel, a generic conic
  solver, until three factors agree.
- **conic bisection**: limit analysis by Clarabel. It answers another question, the upper bound: joints dilate with
  their friction angle. What error is left is the price of normality, always on the unsafe side.
- **Siconos**: does one implicit time step from rest leave the blocks at rest? Bisection on F, or one check on either
  side of the answer where that takes too long. At rest or moving is not always unique with friction. {siconos}

Conic bisection and Siconos start from a bracket of 0.5 to 1.9 times the answer.
"""


def keep(name: str, rows: Sequence[Row], quick: bool) -> None:
    """Put a scene's rows into docs/speed.json beside those of the others."""
    held = json.loads(_JSON.read_text()) if _JSON.exists() else {"scenes": {}}
    command = f"python -m benchmarks{' quick' if quick else ''} {name}"
    held["scenes"][name] = {
        "command": command,
        "machine": machine(),
        "rows": [asdict(row) for row in rows],
    }
    held["scenes"] = {key: held["scenes"][key] for key in SCENES if key in held["scenes"]}
    _DOCS.mkdir(exist_ok=True)
    _JSON.write_text(json.dumps(held, indent=1) + "\n")


def keep_command() -> None:
    """The cold command measured anew beside the other rows of the wedge, which stay; its chart and docs/speed.md."""
    held = json.loads(_JSON.read_text())
    made = held["scenes"]["wedge"]
    made["rows"] = [asdict(row) for row in with_command([Row(**row) for row in made["rows"]])]
    _JSON.write_text(json.dumps(held, indent=1) + "\n")
    write(("wedge",))


def machine() -> str:
    """The machine in words, without its name."""
    libraries = ", ".join(f"{name} {version(name)}" for name in _LIBRARIES)
    return (
        f"{os.cpu_count()} cores ({platform.machine()}, {platform.system()}), Python "
        f"{platform.python_version()}, {libraries}; one thread a solver"
    )


def write(charts: Sequence[str] = tuple(SCENES)) -> None:
    """docs/speed.md and the charts of scenes from docs/speed.json."""
    held = json.loads(_JSON.read_text())
    scenes = {name: [Row(**row) for row in made["rows"]] for name, made in held["scenes"].items()}
    asked = [row for rows in scenes.values() for row in rows if row.solver == "Siconos"]
    there = any(row.factor is not None or row.error is not None for row in asked)
    siconos = "Debian's package." if there else "Not installed where this was run."
    parts = [_PREFACE.format(siconos=siconos)]
    for name, rows in scenes.items():
        scene = SCENES[name]
        if name in charts:
            chart(name, rows)
        made = f"`{held['scenes'][name]['command']}` on {held['scenes'][name]['machine']}."
        picture = f"![{scene.title}](images/speed-{name}.png)"
        parts.append(
            f"## {scene.title}\n\n{scene.words}\n\n{picture}\n\n{made}\n\n{table(most_effort(ends_of(rows)))}\n"
        )
    (_DOCS / "speed.md").write_text("\n".join(parts))


def ends_of(rows: Sequence[Row]) -> list[Row]:
    """The rows of the smallest and the largest model on which solvers meet."""
    solvers: dict[str, set[str]] = {}
    for row in rows:
        solvers.setdefault(row.model, set()).add(row.solver)
    sizes: dict[str, dict[str, int]] = {}
    for row in rows:
        if len(solvers[row.model]) > 1:
            normals = row.model.partition(" normals")[0] if " normals" in row.model else ""
            sizes.setdefault(normals, {})[row.model] = row.node_pairs
    ends = {end(of, key=of.__getitem__) for of in sizes.values() for end in (min, max)}
    return [row for row in rows if row.model in ends]


def most_effort(rows: Sequence[Row]) -> list[Row]:
    """Of each solver on each model the row of the most effort that has an error, else the last one."""
    last: dict[tuple[str, str], Row] = {}
    for row in rows:
        key = row.model, row.solver
        if row.error is not None or key not in last or last[key].error is None:
            last[key] = row
    return list(last.values())


def table(rows: Sequence[Row]) -> str:
    """Rows as a table of Markdown that also reads as plain text."""
    head = (
        "model",
        "solver",
        "effort",
        "seconds",
        "F",
        "error",
        "x closed form",
        "x slopekit",
        "note",
    )
    lines = [
        (
            row.model,
            row.solver,
            row.effort or "-",
            _number(row.seconds, ".2g") + ("e" if row.estimated else ""),
            _number(row.factor, ".6f"),
            _number(row.error, ".1e"),
            _number(row.to_closed_form, ".2g"),
            _number(row.to_slopekit, ".2g"),
            row.note,
        )
        for row in sorted(
            rows, key=lambda row: (row.blocks, _place(rows, row.model), SOLVERS.index(row.solver))
        )
    ]
    widths = [max(len(line[k]) for line in (head, *lines)) for k in range(len(head))]
    rule = tuple("-" * width for width in widths)
    return "\n".join(
        "| "
        + " | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        + " |"
        for line in (head, rule, *lines)
    )


def _place(rows: Sequence[Row], model: str) -> int:
    return [row.model for row in rows].index(model)


def _number(value: float | None, form: str) -> str:
    if value is None:
        return "-"
    if form == ".2g" and 10.0 <= abs(value) < 1e6:
        return f"{value:,.0f}"
    return format(value, form)


def chart(name: str, rows: Sequence[Row]) -> None:
    """The chart of a scene: a colour for each solver, a line for each model, efforts along the line."""
    (_DOCS / "images").mkdir(exist_ok=True)
    scene = SCENES[name]
    shown = [row for row in rows if row.error is not None and row.seconds is not None]
    fewest = min(row.node_pairs for row in rows)
    if (
        name in SIZES
    ):  # there the book is the reference, of no error, and its microseconds would squeeze the rest
        shown = [row for row in shown if row.solver != CLOSED]
    if name == "wedge":  # more node pairs change nothing there but the time of slopekit
        shown = [row for row in shown if row.node_pairs == fewest or row.solver == SLOPEKIT]
    curves = []
    # what only some charts show comes last, so that a solver has one colour in all of them
    for solver in sorted(SOLVERS, key=lambda solver: solver in (CLOSED, COMMAND, PUBLISHED)):
        mine = [row for row in shown if row.solver == solver]
        models = list(dict.fromkeys(row.model for row in mine))
        for model in models:
            line = [row for row in mine if row.model == model]
            errors = [
                row.error if row.error > FLOOR else 0.0 for row in line if row.error is not None
            ]
            labels = [_label(name, row, row is line[-1]) for row in line]
            curves.append(
                Curve(
                    _curve_name(name, line[0]),
                    [row.seconds or math.nan for row in line],
                    errors,
                    labels,
                )
            )
    speed_error_chart(
        curves, _DOCS / "images" / f"speed-{name}.png", scene.title, against=scene.against
    )


def _curve_name(scene: str, row: Row) -> str:
    if scene == "ellipsoid":
        return f"{row.solver}, {row.model.split()[0]} normals"
    return row.solver


def _label(scene: str, row: Row, last: bool) -> str:
    """Efforts of the wedge; else, once a line, its node pairs or blocks."""
    if scene == "wedge":
        if row.solver in (CLOSED, COMMAND, PUBLISHED):
            return ""
        return (
            f"{row.node_pairs} pairs" if row.solver == SLOPEKIT else row.effort.removeprefix("to ")
        )
    if not last:
        return ""
    return (
        f"{row.node_pairs:,} pairs" if scene == "ellipsoid" else f"{row.blocks:,}"
    ) + " e" * row.estimated
