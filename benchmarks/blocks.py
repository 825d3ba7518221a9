"""What the limit of many blocks is worth: published and random assemblies through the public reader.

    python -m benchmarks.blocks                          the table of named cases (about a minute)
    python -m benchmarks.blocks multipliers [W1 ...]     walls: the horizontal load at which F is 1, against published
    python -m benchmarks.blocks populations [sections | walls | benches ...] [-n N] [-j 2] [--plain] [-o file]
    python -m benchmarks.blocks speed [quick]            times and memory beside a generic conic solver

A population reports how many designs of a static bound of 0.3 or more get a number, numbers above the static bound
(that of slopekit, and one of all blocks by an independent program), F of the strength divided by 0.5 and by 3, of
the design mirrored, listed in another order, moved to UTM and with its polygons from another corner (`--plain`: none of
these), and CPU seconds. `-o` keeps a line of JSON a design.

Sections and walls without a number are looked at by judges of another kind: whether they tip whatever the strength (a
limit state under a part of the load in which nothing slips that carries a force, by a linear program), and whether a
history comes to rest at all, weight first and other loads slowly after it, or all at once.
"""

import argparse
import json
import math
import multiprocessing
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from benchmarks import populations
from benchmarks.populations import Design

_SECONDS = 120.0  # of CPU time, after which an analysis is given up
_JUDGED = 0.3  # static bounds from which a number is asked for
_NEAR = 5e-3  # of a published multiplier, which is rounded in its third digit
_RESTS = (
    1.05,
    2.0,
    4.0,
    8.0,
)  # strengths, in parts of the static bound's, at which a history may come to rest
_ABOVE = 1e-4  # by how much a factor may be above a static bound, both being known to that
_SAME = {"strength": 1e-6, "other": 1e-8}  # what the same slope in another writing may change


@dataclass(frozen=True)
class Answer:
    """What one analysis says, and its CPU seconds; `status` is "error" or "time" where it says nothing."""

    status: str
    seconds: float
    factor: float | None = None
    bound: float | None = None
    lowest: float | None = None
    highest: float | None = None
    blocks: int = 0
    codes: tuple[str, ...] = ()
    fault: str = ""


def answer(design: Design, seconds: float = _SECONDS) -> Answer:
    """Analyse a design, without its memory of earlier ones."""
    from slopekit.core.errors import SlopekitError
    from tests.properties import changes

    changes._run.cache_clear()
    began = time.process_time()
    try:
        with _within(seconds):
            found = changes.run(design)
    except TimeoutError:
        return Answer("time", time.process_time() - began)
    except SlopekitError as error:
        return Answer("error", time.process_time() - began, fault=str(error))
    fos = found.fos
    return Answer(
        found.status,
        time.process_time() - began,
        fos.limit,
        fos.static_bound,
        getattr(fos, "lowest", None),
        getattr(fos, "highest", None),
        found.model.moving_blocks,
        tuple(notice.code for notice in found.warnings),
    )


@contextmanager
def _within(seconds: float) -> Iterator[None]:
    """TimeoutError after so many CPU seconds."""
    signal.signal(signal.SIGPROF, _late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def _late(number: int, frame: FrameType | None) -> None:
    raise TimeoutError


# -- named cases ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """A design and what is known of it: the factor, the range of its mechanism, its static bound, and from where."""

    name: str
    design: Design
    factor: float | None
    source: str
    lowest: float | None = None
    highest: float | None = None
    bound: float | None = None


_PATH = "prototype of the path"
_FORM = "closed form"


def named() -> list[Case]:
    """The cases of the prototype of the path and what has a closed form or is published."""
    from tests.properties import test_not_unique as known

    tangent = math.tan(math.radians(35.0)) / math.tan(math.radians(30.0))
    found = [
        Case("two blocks", known.TWO_BLOCKS, 0.529555, _PATH, 0.52049, 0.52955, 0.52956),
        Case("shards", known.SHARDS, 3.749624, _PATH, 3.7050, 3.7496, 3.74962),
        Case("bonded row", known.BONDED_ROW, 1.531150, "a history: 1.520", 1.5001, 1.5312, 1.53506),
        Case("rough columns", known.ROUGH_COLUMNS, 0.818, _PATH, 0.669, 0.971, 1.0),
        Case("bonded columns", known.BONDED_COLUMNS, 0.172230, _PATH, 0.009, 0.425, 0.468),
        Case(
            "leaning row",
            known.LEANING_ROW,
            None,
            "a history: 0.352019 opens a joint, then no rest",
        ),
        Case("bench, 8 moving", known.BENCH, 2.498175, _PATH, 2.491, 2.509, 2.634),
        Case("template bench", _template("bench"), 1.5990, _PATH, 1.589, 1.751, 1.7775),
    ]
    for n in (16, 32, 64, 100, 200):
        known_range = (0.799, 1.111, 1.19089) if n == 16 else ()
        factor = populations.goodman_bray_factor(n)
        found.append(
            Case(f"columns, {n}", populations.goodman_bray(n), factor, _FORM, *known_range)
        )
    found += [Case(f"stack, {n}", populations.stack(n), tangent, _FORM) for n in (3, 10, 100)]
    for number in (1, 2, 6):
        design, factor = populations.active_passive(number)
        found.append(Case(f"active, passive {number}", design, factor, _FORM))
    found += [
        Case("arch t/R 0.2006", populations.arch(), 0.6 / 0.309215, "Cocchetti & Rizzi 2020"),
        Case("arch t/R 0.15", populations.arch(0.15, 0.7), 1.988989, "linear program"),
        Case("arch t/R 0.1", populations.arch(0.10, 0.7), None, "cannot stand, Milankovitch"),
        Case(
            "frame of 14", populations.frame(), None, "associated multiplier published", bound=1.0
        ),
        Case("torsion", populations.torsion(), 2.2956, _FORM),
    ]
    for name, wall in populations.WALLS.items():
        found.append(
            Case(f"{name} at {wall.multiplier}", wall.design(), 1.0, "Ferris & Tin-Loi 2001")
        )
    return found


def _template(name: str) -> Design:
    from ruamel.yaml import YAML

    text = (Path(__file__).parents[1] / "templates" / f"{name}.yaml").read_text(encoding="utf-8")
    found: Design = YAML(typ="safe", pure=True).load(text)
    return found


def show_named() -> None:
    """The table; "program S" is an independent static bound of all blocks, with ! where F is above it."""
    print(
        f"{'case':18s}{'blocks':>7s}{'F':>12s}{'lowest':>10s}{'highest':>10s}{'S':>10s}{'CPU s':>8s}"
        f"{'known F':>12s}{'error':>9s}{'program S':>11s}  {'known range and S':30s}source, status"
    )
    for case in named():
        got, bound = answer(case.design), None
        if "solids" not in case.design:
            from tests.preie.path_oracle import model_of, static_bound

            bound = static_bound(model_of(case.design))
        above = "!" if got.factor and got.factor > (bound or math.inf) * (1.0 + _ABOVE) else ""
        error = f"{got.factor / case.factor - 1.0:.1e}" if got.factor and case.factor else "-"
        known = f"{_figure(case.lowest, 4)} .. {_figure(case.highest, 4)} {_figure(case.bound, 4)}"
        print(
            f"{case.name:18s}{got.blocks:7d}{_figure(got.factor, 8):>12s}{_figure(got.lowest, 5):>10s}"
            f"{_figure(got.highest, 5):>10s}{_figure(got.bound, 5):>10s}{got.seconds:8.2f}"
            f"{_figure(case.factor, 8):>12s}{error:>9s}{_figure(bound, 5) + above:>11s}  {known:30s}"
            f"{case.source}; {got.status} {' '.join(got.codes)}",
            flush=True,
        )


def _figure(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def show_multipliers(names: Iterable[str]) -> None:
    """The loads at which F of published walls is 1, straight from the elastic path in the load."""
    print("wall  blocks  published  associated    found  difference  CPU s  status")
    near = 0
    for name in (names := list(names)):
        wall = populations.WALLS[name]
        found, status, seconds = multiplier(wall.design(0.0), wall.design(1.0))
        off = None if found is None else found / wall.multiplier - 1.0
        near += off is not None and abs(off) <= _NEAR
        print(
            f"{name}  {wall.blocks:8d}  {wall.multiplier:9.3f}  {wall.associated:10.5f}  {_figure(found, 5):>7s}"
            f"  {'-' if off is None else f'{off:+.2%}':>10s}  {seconds:5.1f}  {status}",
            flush=True,
        )
    print(
        f"{near} of {len(names)} within {_NEAR:.1%}; without association the published have three digits"
    )


def multiplier(
    without: Design, unit: Design, seconds: float = _SECONDS
) -> tuple[float | None, str, float]:
    """The part of a load at which F is 1 as `slopekit solve` begins with it, whether there is one, and CPU seconds."""
    import slopekit as sk
    from slopekit.kinds import kind_of

    began = time.process_time()
    try:
        with _within(seconds):
            design = sk.load(without)
            found = kind_of(design).at_load(design, sk.load(unit), 1.0)
    except TimeoutError:
        return None, "time", time.process_time() - began
    return found, "none" if found is None else "found", time.process_time() - began


# -- populations ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Judged:
    """A design of a population: its answer, those to the same design in other words, and an independent static bound.

    `other` has factors by what was done, in terms of the first: F(strength / k) k. `program` is None where no
    admissible forces exist. Of sections and walls without a number: `tips` is the part of the loads beside weight and
    water under which no strength holds them, proved; of those that do not tip so `path` is where an independent history
    ends, all loads on at once, and `rests` the least strength of `_RESTS`, in parts of the static bound's, at which one
    comes to rest.
    """

    population: str
    number: int
    first: Answer
    other: Mapping[str, float | None] = field(default_factory=dict)
    program: float | None = None
    path: float | None = None
    tips: float | None = None
    rests: float | None = None


def judged(task: tuple[str, int, bool]) -> Judged:
    """Make one design, run it, and unless `plain` run what must not change its factor."""
    population, number, plain = task
    design = populations.POPULATIONS[population][0](number)
    first = answer(design)
    from tests.preie.path_oracle import model_of, static_bound

    program, without = static_bound(model_of(design)), (None, None, None)
    if (
        population != "benches"
        and first.factor is None
        and program is not None
        and program < math.inf
    ):
        without = _without_number(design, program)
    other: dict[str, float | None] = {}
    for name, (change, times) in ({} if plain else _changes(design)).items():
        factor = answer(change(design)).factor
        other[name] = None if factor is None else times * factor
    return Judged(population, number, first, other, program, *without)


def _without_number(
    design: Design, bound: float
) -> tuple[float | None, float | None, float | None]:
    """`path`, `tips` and `rests` of a design."""
    from slopekit.preie.many_blocks.blocks import limit_of_blocks
    from tests.preie.load_oracle import comes_on, tips_whatever_the_strength
    from tests.preie.path_oracle import model_of, with_bonds

    model = model_of(design)
    limit = limit_of_blocks(model, ranged=False)
    part, factor = limit.tips or (0.0, 1.0)
    if tips_whatever_the_strength(model, limit.velocity, part, 1.0 / factor):
        return None, part, None
    ended, bonds = with_bonds(model, 2.0 / bound)
    rests = next((times for times in _RESTS if comes_on(model, times / bound, bonds) == 1.0), None)
    if rests is None and ended.peak is not None and ended.peak >= bound / _RESTS[-1]:
        rests = _RESTS[-1]
    return ended.factor if ended.end == "settled" else None, None, rests


def _changes(design: Design) -> dict[str, tuple[Callable[[Design], Design], float]]:
    """What leaves a factor as it is, or divides it by a number; a scattered bench in other words is another bench."""
    from tests.properties import changes

    found: dict[str, tuple[Callable[[Design], Design], float]] = {
        "strength / 0.5": (lambda given: changes.reduced(given, 0.5), 0.5),
        "strength / 3": (lambda given: changes.reduced(given, 3.0), 3.0),
        "moved to UTM": (changes.moved, 1.0),
    }
    if not any(joint_set.get("scatter") for joint_set in design.get("sets", {}).values()):
        found |= {"mirrored": (changes.mirrored, 1.0), "another order": (changes.reordered, 1.0)}
    if "blocks" in design:
        found["another corner"] = (populations.rolled, 1.0)
    if design["kind"] == "topple":  # its columns have no place and no sides
        found = {name: change for name, change in found.items() if name.startswith("strength")}
    return found


def all_judged(population: str, count: int | None, plain: bool, workers: int) -> Iterator[Judged]:
    """The designs of a population in turn, each in one of so many processes."""
    size = populations.POPULATIONS[population][1] if count is None else count
    tasks = [(population, number, plain) for number in range(size)]
    if workers == 1:
        yield from map(judged, tasks)
        return
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        yield from pool.imap(judged, tasks)


def report(found: list[Judged]) -> str:
    """Figures of a population, as text."""
    stands = [
        one for one in found if one.first.status == "no_driving_force" or one.program == math.inf
    ]
    asked = [one for one in found if one not in stands and (one.program or 0.0) >= _JUDGED]
    none = [one for one in asked if one.first.factor is None]
    numbers = [one for one in found if one.first.factor is not None]
    lines = [
        f"{found[0].population}: {len(found)} designs; statuses {dict(Counter(one.first.status for one in found))}",
        f"  a number: {len(asked) - len(none)} of {len(asked)} whose static bound is {_JUDGED} or more and finite"
        f"{_share(len(asked) - len(none), len(asked))}; {len(numbers)} numbers in all; {len(stands)} stand without any"
        " strength",
        f"  without a number: {_listed(none)}",
    ]
    if found[0].population != "benches":
        tip, given = [one for one in none if one.tips], len(asked) - len(none)
        could = [one for one in none if not one.tips and one.rests]
        lines.append(
            f"  of these tip whatever the strength, proved by a motion without slip: {len(tip)}"
        )
        share = _share(given, given + len(could))
        lines.append(
            f"  of the others a history comes to rest at {_RESTS[-1]:g} times the static bound's strength "
            f"or less: {_listed(could)}; a number among all that do{share}"
        )
        settles = [one for one in none if one.path]
        lines.append(
            f"  and one of all loads at once, begun at any strength, ends in a limit: {_listed(settles)}"
        )
    bounds: dict[str, Callable[[Judged], float | None]] = {
        "its own static bound": lambda one: one.first.bound,
        "the independent one": lambda one: one.program or 0.0,
    }
    pairs = [(one.first.bound, one.program) for one in found if one.first.bound and one.program]
    far = [ours / theirs - 1.0 for ours, theirs in pairs if math.isfinite(theirs)]
    higher = sum(1 for x in far if x > _ABOVE)
    lines.append(
        f"  static bounds and independent ones: {_spread(list(map(abs, far)), _ABOVE)}; {higher} higher"
    )
    for name, bound_of in bounds.items():
        above = [one for one in numbers if _excess(one, bound_of(one)) > _ABOVE]
        worst = max((_excess(one, bound_of(one)) for one in above), default=0.0)
        lines.append(
            f"  above {name} by more than {_ABOVE:g}: {len(above)}, worst {worst:.1e}; {_listed(above)}"
        )
    ranged = [
        one for one in numbers if one.first.lowest is not None and one.first.highest is not None
    ]
    outside = [one for one in ranged if not _in_range(one.first)]
    lines.append(
        f"  with lowest and highest: {len(ranged)}, the factor outside: {len(outside)}; {_listed(outside)}"
    )
    for name in dict.fromkeys(name for one in found for name in one.other):
        both = [one for one in numbers if one.other.get(name)]
        lost = sum(
            1
            for one in found
            if name in one.other and (one.other[name] is None) != (one.first.factor is None)
        )
        most = _SAME["strength" if name.startswith("strength") else "other"]
        far = [
            abs(float(one.other[name] or 0.0) / float(one.first.factor or 1.0) - 1.0)
            for one in both
        ]
        lines.append(
            f"  {name}: {_spread(far, most)}; a number in one and none in the other: {lost}"
        )
    seconds = np.array([one.first.seconds for one in found])
    lines.append(
        "  CPU s: median {:.3f}, 95 % {:.2f}, worst {:.1f}".format(
            *np.quantile(seconds, [0.5, 0.95, 1.0])
        )
    )
    codes = Counter(code for one in found for code in one.first.codes)
    lines.append(f"  warnings: {dict(codes.most_common(8))}")
    faults = Counter(one.first.fault[:90] for one in found if one.first.fault)
    return "\n".join([*lines, *(f"  error: {text} ({count})" for text, count in faults.items())])


def _excess(one: Judged, bound: float | None) -> float:
    if one.first.factor is None or bound is None:
        return 0.0
    return math.inf if bound == 0.0 else one.first.factor / bound - 1.0


def _in_range(one: Answer) -> bool:
    if one.lowest is None or one.highest is None or one.factor is None:
        return False
    return one.lowest * (1.0 - _ABOVE) <= one.factor <= one.highest * (1.0 + _ABOVE)


def _share(part: int, whole: int) -> str:
    return f" ({part / whole:.1%})" if whole else ""


def _spread(far: list[float], most: float) -> str:
    if not far:
        return "none to compare"
    beyond = sum(1 for x in far if x > most)
    return f"{beyond} of {len(far)} differ by more than {most:g}, median {np.median(far):.0e}, worst {max(far):.1e}"


def _listed(chosen: list[Judged], most: int = 12) -> str:
    more = f" and {len(chosen) - most} more" if len(chosen) > most else ""
    return (
        f"numbers {' '.join(str(one.number) for one in chosen[:most])}{more}" if chosen else "none"
    )


def main(words: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blocks")
    parser.add_argument(
        "what", nargs="?", default="named", choices=["named", "multipliers", "populations", "speed"]
    )
    parser.add_argument("of", nargs="*", help="populations, walls, or the word quick")
    parser.add_argument("-n", type=int, help="so many designs of each population")
    parser.add_argument("-j", type=int, default=1, help="processes")
    parser.add_argument("--plain", action="store_true", help="run each design once only")
    parser.add_argument("-o", type=Path, help="keep a line of JSON a design here")
    given = parser.parse_args(words)
    if given.what == "speed":
        from benchmarks import block_speed

        block_speed.table("quick" in given.of)
    elif given.what == "named":
        show_named()
    elif given.what == "multipliers":
        _known("wall", given.of, populations.WALLS)
        show_multipliers(given.of or populations.WALLS)
    else:
        _known("population", given.of, populations.POPULATIONS)
        for population in given.of or populations.POPULATIONS:
            _show_population(population, given)


def _known(what: str, names: Iterable[str], there: Iterable[str]) -> None:
    unknown = [name for name in names if name not in there]
    if unknown:
        sys.exit(f"no such {what}: {', '.join(unknown)}; there are {', '.join(there)}")


def _show_population(population: str, given: Any) -> None:
    found = []
    for one in all_judged(population, given.n, given.plain, given.j):
        found.append(one)
        if given.o:
            with given.o.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(one)) + "\n")
    print(report(found), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
