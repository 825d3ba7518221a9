"""Check a design: how far two independent methods agree on it, what its number rests on, and what accuracy costs.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> checked = sk.check(sk.load(wedge))
>>> checked.sound, checked.against
(True, 'the closed form')
"""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

from slopekit._version import __version__
from slopekit.design.blocky import AssemblyDesign
from slopekit.design.common import Design
from slopekit.result import Result
from slopekit.studies.ladders import Rung, assembly_ladder, block_ladder, refines

_EXACT = 1e-9  # a mesh that moves the factor by less does not matter
_ROUNDING = 1e-9
_MOST_UNTIED = 400  # moving blocks for which the all-pairs factor is looked for
_BOUND_SLACK = 1e-6  # the bound is bracketed to 1e-7 and proved to 1e-9


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at.

    Attributes
    ----------
    name : what; value : the figure, None where there is none; wanted : the most it may be, None where it is not judged
    met : None where it is not judged; words : a sentence
    """

    name: str
    value: float | None
    wanted: float | None
    met: bool | None
    words: str

    def to_dict(self) -> dict[str, Any]:
        """The finding as JSON values."""
        return {"name": self.name, "value": self.value, "wanted": self.wanted, "met": self.met, "words": self.words}


@dataclass(frozen=True, slots=True)
class Check:
    """A checked design.

    Attributes
    ----------
    result : the analysis, with the all-pairs factor where it was looked for
    ladder : the rungs of effort; errors : (n,) of each, relative to `reference`, None where a rung has no factor
    reference, against : what errors are measured against; None where there is no factor of safety
    orders : observed orders of convergence from one mesh to the next, empty where the mesh does not matter
    cheapest : index of the cheapest rung of PRE-IE within `agree_within`, None where none is
    findings : what was looked at
    """

    result: Result
    ladder: tuple[Rung, ...]
    errors: tuple[float | None, ...]
    reference: float | None
    against: str
    orders: tuple[float, ...]
    cheapest: int | None
    findings: tuple[Finding, ...]
    seconds: float = field(default=0.0, compare=False)

    @property
    def sound(self) -> bool:
        """Whether nothing that was judged failed."""
        return all(finding.met is not False for finding in self.findings)

    @property
    def exit_code(self) -> int:
        """0 sound; 4 the methods disagree, or something that the number rests on does not hold."""
        return 0 if self.sound and self.result.exit_code != 4 else 4

    def to_dict(self) -> dict[str, Any]:
        """The check as JSON values; times stand in a block of their own."""
        result = self.result
        return {
            "slopekit": __version__,
            "kind": result.kind,
            "title": result.design.title,
            "input_sha256": result.design.input_hash(),
            "status": result.status,
            "fos": result.to_dict()["fos"],
            "sound": self.sound,
            "agree_within": result.design.agree_within,
            "reference": {"value": self.reference, "what": self.against},
            "findings": [finding.to_dict() for finding in self.findings],
            "ladder": [
                {
                    "method": rung.method, "setting": rung.setting, "node_pairs": rung.node_pairs,
                    "effort": rung.effort, "fos": rung.factor, "error": error,
                }
                for rung, error in zip(self.ladder, self.errors, strict=True)
            ],
            "orders": list(self.orders),
            "cheapest": None if self.cheapest is None else self.ladder[self.cheapest].setting,
            "balance": None if result.balance is None else result.balance.to_dict(),
            "warnings": [{"code": notice.code, "message": notice.message} for notice in result.warnings],
            "timing_s": {
                "total": self.seconds,
                "ladder": [{"setting": rung.setting, "seconds": rung.seconds} for rung in self.ladder],
            },
        }  # fmt: skip


def check(design: Design) -> Check:
    """Check a design of any kind over a ladder of effort.

    Raises
    ------
    GeometryError, DesignError
        As `slopekit.analyse`.
    """
    began = time.perf_counter()
    if isinstance(design, AssemblyDesign):
        result, ladder, unrefined = _blocks(design)
    else:
        from slopekit.analysis import analyse

        result = replace(analyse(replace(design, criterion="all-pairs")), design=design)
        ladder, unrefined = block_ladder(design, result) if result.fos.limit else (), ""
    reference, against = _reference(result, ladder)
    errors = tuple(
        None if rung.factor is None or reference is None else abs(rung.factor / reference - 1.0) for rung in ladder
    )
    orders = _orders(ladder)
    findings = tuple(_findings(result, ladder, orders, unrefined))
    return Check(
        result, ladder, errors, reference, against, orders, _cheapest(ladder, errors, design.agree_within), findings,
        time.perf_counter() - began,
    )  # fmt: skip


def _blocks(design: AssemblyDesign) -> tuple[Result, tuple[Rung, ...], str]:
    """The result with its all-pairs factor, the ladder, and why it has no meshes."""
    from slopekit.analysis.assembly import all_pairs, solve_assembly, untied_search

    solved = solve_assembly(design)
    result = solved.result
    few = result.model.moving_blocks <= _MOST_UNTIED
    if few and result.fos.limit and result.all_pairs is None:
        search = untied_search(design, solved.scene, solved.loads, result.fos.limit)
        if search is not None:
            fos = replace(result.fos, all_pairs_failed=search.factor)
            result = replace(result, fos=fos, all_pairs=all_pairs(search))
    ends = "" if refines(solved) else "without cohesion the ends of contacts carry all they can"
    return result, assembly_ladder(solved), ends


def _reference(result: Result, ladder: tuple[Rung, ...]) -> tuple[float | None, str]:
    """The closed form where it is compared, else the finest of our own."""
    if result.fos.limit is None:
        return None, "nothing: there is no factor of safety"
    if result.agree is not None and not result.moments_govern and result.fos.closed_form is not None:
        return result.fos.closed_form, "the closed form"
    finest = [rung for rung in ladder if rung.method == "mesh" and rung.factor is not None]
    if finest:
        return finest[-1].factor, f"the finest node pairs ({finest[-1].node_pairs})"
    return result.fos.limit, "the settled limit"


def _orders(ladder: tuple[Rung, ...]) -> tuple[float, ...]:
    """log₂ of how much less each halving of the mesh changes the factor than the one before it."""
    factors = [rung.factor for rung in ladder if rung.method == "mesh" and rung.factor is not None]
    moves = [abs(b - a) for a, b in pairwise(factors)]
    if not factors or max(moves, default=0.0) < _EXACT * factors[-1]:
        return ()
    return tuple(math.log2(a / b) for a, b in pairwise(moves) if min(a, b) > _EXACT * factors[-1])


def _cheapest(ladder: tuple[Rung, ...], errors: tuple[float | None, ...], within: float) -> int | None:
    fit, missed = list[int](), set[str]()
    for k in reversed(range(len(ladder))):  # from the most effort down: what passes only by the way does not count
        error, method = errors[k], ladder[k].method
        if method == "closed form":
            continue
        if error is None or error > within:
            missed.add(method)
        if method not in missed:
            fit.append(k)
    return min(fit, key=lambda k: ladder[k].seconds, default=None)


def _findings(result: Result, ladder: tuple[Rung, ...], orders: tuple[float, ...], unrefined: str) -> Iterator[Finding]:
    design, fos = result.design, result.fos
    yield _agreement(result)
    if fos.limit is None:
        yield Finding("factor of safety", None, None, result.status != "not_converged",
                      f"none, by its status: {result.status_text}")  # fmt: skip
        return
    yield from _convergence(result, ladder, orders, unrefined)
    settled = result.model.residual <= design.stop_when
    yield Finding("passes", result.model.residual, design.stop_when, settled,
                  "change in the last pass (0: settled exactly)")  # fmt: skip
    yield from _balance(result)
    if fos.static_bound is None:
        yield Finding("static bound", None, None, None, "not found: nothing is said of limit <= bound")
    else:
        above = max(fos.limit / fos.static_bound - 1.0, 0.0)
        proved = "proved" if result.static_bound_proved else "not proved"
        yield Finding("static bound", above, _BOUND_SLACK, above <= _BOUND_SLACK,
                      f"limit {fos.limit:.6g} <= bound {fos.static_bound:.6g} ({proved})")  # fmt: skip
    if fos.all_pairs_failed is None:
        why = "not looked for among so many blocks" if result.all_pairs is None else "the search found none"
        yield Finding("all pairs failed", None, None, None, f"none: {why}")
    else:
        words = f"for {design.stiffness.in_words()}"
        yield Finding("all pairs failed", fos.all_pairs_failed, None, None, words)


def _agreement(result: Result) -> Finding:
    name, within = "closed form", result.design.agree_within
    if result.agree is None:
        return Finding(name, None, None, None, "none to compare with: judged by node pairs and bound")
    if result.difference is None:
        words = "the same status from both" if result.agree else "statuses differ, or no convergence"
        return Finding(name, None, None, result.agree, words)
    what = "forces alone, as it knows no moments" if result.moments_govern else "limit"
    return Finding(name, result.difference, within, result.agree, f"the {what} against the closed form")


def _convergence(
    result: Result, ladder: tuple[Rung, ...], orders: tuple[float, ...], unrefined: str
) -> Iterator[Finding]:
    """Self-convergence: the limit against that of the finest node pairs."""
    name, within = "node pairs", result.design.agree_within
    meshes = [rung for rung in ladder if rung.method == "mesh"]
    lost = sum(rung.factor is None for rung in meshes)
    if lost:
        yield Finding(name, None, None, False, f"{lost} of {len(meshes)} meshes gave no factor")
        return
    if len(meshes) < 2:
        yield Finding(name, None, None, None, unrefined or "no finer ones to compare with")
        return
    finest = meshes[-1].factor
    off = abs((result.fos.limit or math.nan) / (finest or math.nan) - 1.0)
    words = "finer ones leave the factor as it is"
    if orders:
        words = f"the limit against the finest; observed order {', '.join(f'{order:.1f}' for order in orders)}"
    yield Finding(name, off, within, off <= within, words)


def _balance(result: Result) -> Iterator[Finding]:
    balance, wanted = result.balance, max(result.design.stop_when, _ROUNDING)
    if balance is None:
        yield Finding("balance", None, None, None, "no forces were kept of this limit: nothing to hold it against")
        return
    yield Finding("forces", balance.force, wanted, balance.force <= wanted,
                  "unbalanced force of a block, in parts of its load")  # fmt: skip
    yield Finding("moments", balance.moment, wanted, balance.moment <= wanted, "unbalanced moment, likewise")
    worst = max(balance.pull, balance.friction_excess)
    at = "" if math.isclose(balance.factor, result.fos.limit or 0.0, rel_tol=1e-6) else (
        f" (at F = {balance.factor:.4g}, so at the limit)"
    )  # fmt: skip
    yield Finding("admissible", worst, wanted, balance.admissible_within(wanted),
                  f"all {balance.node_pairs} push, within their strength{at}")  # fmt: skip
