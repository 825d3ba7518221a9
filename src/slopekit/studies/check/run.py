"""Check a design: how far two independent methods agree on it, what its number rests on, and what accuracy costs.

>>> import slopekit as sk
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
>>> checked = sk.check(sk.load(wedge))
>>> checked.consistent, checked.against
(True, 'the closed form')
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from typing import Any, ClassVar

from slopekit.core.codec import json_of, record_of
from slopekit.core.errors import Notice
from slopekit.core.sheet import Column
from slopekit.kinds import add_common_notices, kind_of
from slopekit.kinds.single_block.ladders import NEAR_STRENGTH, Ladder, Rung
from slopekit.preie.motion.balance import Balance
from slopekit.preie.tolerances import LIMIT_SETTLED
from slopekit.result import Result
from slopekit.studies.protocol import DESK, ADesign, StudyOutcome, Workplace, study

_MESH_ROUNDING = 1e-9  # a mesh that moves the factor by less does not matter
_SAME_FACTOR = 1e-6  # factors that differ by less are one
_STIFFNESS_TOLERANCE = 1e-2  # that k_t / k_n from 0.1 to 1 may move a limit: of 683 random sections it moved 48 by more
_BALANCE_TOLERANCE = 1e-5  # of a block's load: what settles balances to 1e-6 or better
_INDEPENDENT_FINDINGS = (
    "closed form",
    "node pairs",
    "upper bound",
)  # findings that hold the number against something else


@dataclass(frozen=True)
class Finding:
    """A finding of a check: a figure, the most it may be, and a sentence.

    Attributes
    ----------
    name : what; value : the figure, None where there is none; wanted : the most it may be, None where it is not judged
    met : None where it is not judged; words : a sentence
    code : of its explanation (`slopekit explain`), where it needs one
    """

    name: str
    value: float | None
    wanted: float | None
    met: bool | None
    words: str
    code: str | None = None


@dataclass(frozen=True, repr=False)
class Check(StudyOutcome):
    """A checked design.

    Attributes
    ----------
    result : the analysis, with the all-pairs factor where it was looked for
    ladder : the rungs of effort; errors : (n,) of each, relative to `reference`, None where a rung has no factor
    reference, against : what errors are measured against; None where there is no factor of safety
    findings : what was looked at
    """

    name: ClassVar[str] = "check"
    result: Result
    ladder: tuple[Rung, ...]
    errors: tuple[float | None, ...]
    reference: float | None
    against: str
    findings: tuple[Finding, ...]

    charts: ClassVar[tuple[str, ...]] = ("speed-error",)

    @property
    def consistent(self) -> bool | None:
        """Whether the number follows from the model; None where nothing independent of it could be judged.

        It says nothing of whether the slope is stable, nor whether the model is the slope.
        """
        if any(finding.met is False for finding in self.findings) or self.result.exit_code == 4:
            return False
        return (
            True
            if any(
                finding.met and finding.name in _INDEPENDENT_FINDINGS for finding in self.findings
            )
            else None
        )

    @property
    def exit_code(self) -> int:
        """0 done, 1 consistent but an acceptance rule is not met, 4 not consistent, or no convergence."""
        if self.consistent is False:
            return 4
        return 1 if self.result.accepted is False else 0

    @property
    def accepted(self) -> bool | None:
        """Whether the result meets its acceptance; None without one."""
        return self.result.accepted

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """Notices of the result."""
        return self.result.warnings

    @property
    def margin(self) -> float | None:
        """The margin of the result, by which load cases are ranked."""
        return self.result.margin

    def case_columns(self) -> list[Column[Any]]:
        """The columns of the result, and whether it is consistent."""

        def of_result(column: Column[Any]) -> Column[Any]:
            return replace(column, of=lambda checked: column.of(checked.result))

        *result_columns, status = map(of_result, self.result.case_columns())
        word = {True: "yes", False: "NO", None: "open"}
        consistent: Column[Any] = Column(
            "consistent", "consistent", "consistent", show=word.__getitem__, width=12
        )
        return [*result_columns, consistent, status]

    def to_dict(self) -> dict[str, Any]:
        """The check as JSON values; times, and what depends on them, stand in a block of their own."""
        result = self.result.to_dict()
        return {
            **self.head(self.result.design),
            **{
                key: result[key]
                for key in ("status", "fos", "methods", "moments_govern", "accepted", "rules")
            },
            "consistent": self.consistent,
            "agree_within": self.result.design.analysis.agree_within,
            "reference": {"value": self.reference, "what": self.against},
            "findings": json_of(self.findings),
            "ladder": [
                record_of(rung) | {"error": error}
                for rung, error in zip(self.ladder, self.errors, strict=True)
            ],
            "balance": result["balance"],
            "timing_s": {
                "total": self.seconds,
                "ladder": [
                    {"setting": rung.setting, "seconds": rung.seconds} for rung in self.ladder
                ],
            },
            **self.words(),
        }


@study
def check(
    design: ADesign,
    *,
    desk: Workplace = DESK,
) -> Check:
    """Closed form against PRE-IE on a design, speed against error; or the verification suite.

    Takes a few seconds for one block, up to minutes for a bench. Exit codes: 0 consistent or nothing independent to
    judge by, 1 consistent but an acceptance rule is not met, 4 not consistent.

    Raises
    ------
    GeometryError, DesignError
        As `slopekit.analyse`.

    Notes
    -----
    Each finding stands beside what it is held against: the balance of forces and moments, admissible forces in every
    node pair, the closed form, finer node pairs, reduced strength (F of the strength over k is F / k), scale. Errors of
    the ladder are relative, ``|F - reference| / reference``.

    Examples
    --------
    >>> import slopekit as sk
    >>> found = sk.check(sk.load({
    ...     "slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
    ...     "joints": {"J1": {"plane": "35/180"}}, "strength": {"bedding": {"c": 25, "phi": 37}},
    ...     "rock": {"unit_weight": 26}}))
    >>> found.consistent, round(found.result.fos.limit, 4), found.exit_code
    (True, 1.6487, 0)
    """
    evidence = kind_of(design).ladder(design)
    evidence = replace(evidence, result=add_common_notices(evidence.result))
    result, ladder = evidence.result, evidence.rungs
    reference, against = _reference(result, ladder)
    errors = tuple(
        None if rung.factor is None or reference is None else abs(rung.factor / reference - 1.0)
        for rung in ladder
    )
    findings = tuple(_findings(result, ladder, evidence))
    return Check(result, ladder, errors, reference, against, findings)


def _reference(result: Result, ladder: tuple[Rung, ...]) -> tuple[float | None, str]:
    """Return the reference factor of the ladder and its name: closed form, finest node pairs, or settled limit."""
    if result.fos.limit is None:
        return None, "nothing: there is no factor of safety"
    if (
        result.agree is not None
        and not result.moments_govern
        and result.fos.closed_form is not None
    ):
        return result.fos.closed_form, "the closed form"
    finest = [rung for rung in ladder if rung.method == "mesh" and rung.factor is not None]
    if finest:
        return finest[-1].factor, f"the finest node pairs ({finest[-1].node_pairs})"
    return result.fos.limit, "the settled limit"


def _findings(result: Result, ladder: tuple[Rung, ...], evidence: Ladder) -> Iterator[Finding]:
    design, fos, other_factors = result.design, result.fos, evidence.factors_at_other_strengths
    yield _agreement(result)
    if fos.limit is None:
        is_met = False if result.status == "not_converged" else None
        yield Finding(
            "factor of safety", None, None, is_met, f"none, by its status: {result.status_text}"
        )
        return
    yield _convergence(result, ladder, evidence.unrefined)
    width = "how far above the last stable state the blocks fail (0: an exact limit state)"
    yield Finding(
        "bracket",
        result.model.residual,
        LIMIT_SETTLED,
        result.model.residual <= LIMIT_SETTLED,
        width,
    )
    yield from _balance(result, evidence.rest, fos.limit)
    if other_factors:
        deviation = max(
            (abs(factor / fos.limit - 1.0) for factor in other_factors if factor), default=0.0
        )
        words = (
            "the same F where strength is doubled, and where it is divided by F"
            if all(other_factors)
            else (
                "with its strength changed the scene has no factor: the limit state is not the only one"
            )
        )
        if all(other_factors) and deviation > design.analysis.agree_within:
            words = (
                "with its strength changed another limit state is found: the factor is not unique"
            )
        yield Finding(
            "other strengths",
            deviation if all(other_factors) else None,
            design.analysis.agree_within,
            bool(all(other_factors)) and deviation <= design.analysis.agree_within,
            words,
        )
    if neighbours := evidence.neighbours:
        yield _neighbours(fos.limit, neighbours, design.analysis.agree_within)
    yield from _stiffness(
        result, fos.limit, [rung for rung in ladder if rung.method == "stiffness"]
    )
    if fos.static_bound is None:
        yield Finding(
            "upper bound", None, None, None, "not found: nothing is said of limit <= bound"
        )
    else:
        above = max(fos.limit / fos.static_bound - 1.0, 0.0)
        words = f"limit {fos.limit:.6g}, bound {fos.static_bound:.6g}: how far the limit lies above"
        yield Finding("upper bound", above, _SAME_FACTOR, above <= _SAME_FACTOR, words)
    for notice in result.warnings:
        if (
            notice.code == "W504"
        ):  # cohesive blocks fail at less with progressive slip and debonding
            yield Finding("debonding", None, None, False, notice.message, notice.code)
    if fos.all_pairs_failed is not None:
        yield Finding(
            "all pairs failed",
            fos.all_pairs_failed,
            None,
            None,
            f"the paper's criterion, no safety factor: {design.stiffness.in_words()}",
        )


def _agreement(result: Result) -> Finding:
    name, tolerance = "closed form", result.design.analysis.agree_within
    if result.agree is None:
        words = "there is none of this kind"
        if result.fos.closed_form is not None:
            words = f"{result.fos.closed_form:.6g}, not compared: see NOTE"
        return Finding(name, None, None, None, words)
    if result.difference is None:
        words = (
            "the same status from both" if result.agree else "statuses differ, or no convergence"
        )
        return Finding(name, None, None, result.agree, words)
    quantity = "forces alone (it knows no moments)" if result.moments_govern else "limit"
    return Finding(
        name, result.difference, tolerance, result.agree, f"the {quantity} against the closed form"
    )


def _convergence(result: Result, ladder: tuple[Rung, ...], unrefined: str) -> Finding:
    """Self-convergence: how far the limit and the finest two meshes lie apart."""
    name, tolerance = "node pairs", result.design.analysis.agree_within
    meshes = [rung for rung in ladder if rung.method == "mesh"]
    without_factor = sum(rung.factor is None for rung in meshes)
    if without_factor:
        return Finding(
            name, None, None, False, f"{without_factor} of {len(meshes)} meshes gave no factor"
        )
    if unrefined or len(meshes) < 2:
        return Finding(name, None, None, None, unrefined or "no finer ones to compare with")
    finest, coarser = meshes[-1], meshes[-2]
    if (finest.node_pairs or 0) <= result.model.node_pairs:
        return Finding(
            name,
            None,
            None,
            None,
            f"finer than {result.model.node_pairs} were not tried: they would take long",
        )
    limit, finest_factor, coarser_factor = result.fos.limit, finest.factor, coarser.factor
    if not limit or not finest_factor or not coarser_factor:
        return Finding(name, None, None, False, "a mesh gave no factor to compare with")
    # what changed by little on coarse meshes may not change by more on finer ones
    steps = [abs(b / a - 1.0) for a, b in pairwise(rung.factor for rung in meshes if rung.factor)]
    late_steps = (
        step
        for step, least in zip(steps, accumulate(steps, min), strict=True)
        if least <= tolerance < step
    )
    deviation = max(
        abs(limit / finest_factor - 1.0), abs(coarser_factor / finest_factor - 1.0), *late_steps
    )
    if deviation > tolerance:
        words = "finer ones change the factor: it is not settled"
    elif deviation < _MESH_ROUNDING:
        words = "finer ones leave the factor as it is"
    else:
        words = "how far the limit and the last two meshes lie apart"
    return Finding(name, deviation, tolerance, deviation <= tolerance, words)


def _neighbours(limit: float, neighbours: Sequence[float | None], tolerance: float) -> Finding:
    """Whether the limit stays between those of strengths a little lower and higher, as scaling has it."""
    change, factors = f"{NEAR_STRENGTH:.0%}", [limit, *(factor for factor in neighbours if factor)]
    if len(factors) <= len(neighbours):
        return Finding(
            "neighbours",
            None,
            tolerance,
            False,
            f"with {change} more or less strength of one joint none is found",
        )
    least, most = min(factors), max(factors)
    deviation = max(1.0 - least / limit, most / limit - 1.0, NEAR_STRENGTH) - NEAR_STRENGTH
    words = f"{least:.4g} to {most:.4g} with {change} more or less strength of one joint, how far beyond {change}"
    words += "" if deviation <= tolerance else ": two limit states, take the lower"
    return Finding("neighbours", deviation, tolerance, deviation <= tolerance, words)


def _stiffness(result: Result, limit: float, rungs: Sequence[Rung]) -> Iterator[Finding]:
    """Whether the limit of many blocks depends on the stiffness ratio of their joints, which nobody measures."""
    if not rungs:
        return
    name, factors = (
        "stiffness ratio",
        ", ".join(
            f"{'none' if rung.factor is None else f'{rung.factor:.4g}'} with k_t/k_n {rung.setting_value:g}"
            for rung in rungs
        ),
    )
    deviation = max((abs(rung.factor / limit - 1.0) for rung in rungs if rung.factor), default=0.0)
    if deviation > _STIFFNESS_TOLERANCE:
        low, high = (
            "none" if end is None else f"{end:.4g}"
            for end in (result.fos.lowest, result.fos.highest)
        )
        range_remark = (
            "" if high == "none" else f", judge by the range of its mechanism, {low} .. {high}"
        )
        words = f"{factors}: the limit depends on the stiffness of the joints{range_remark} (W364)"
        yield Finding(name, deviation, _STIFFNESS_TOLERANCE, False, words, "W364")
    elif all(rung.factor for rung in rungs):
        verdict = "the same limit" if deviation <= _SAME_FACTOR else "the limit moves by no more"
        yield Finding(
            name,
            deviation,
            _STIFFNESS_TOLERANCE,
            True,
            f"{verdict} on joints of k_t/k_n "
            + " and ".join(f"{rung.setting_value:g}" for rung in rungs),
        )
    else:
        yield Finding(
            name,
            None,
            None,
            None,
            f"{factors}: whether the limit depends on it is not known",
            "W364",
        )


def _balance(result: Result, rest: Balance | None, limit: float) -> Iterator[Finding]:
    """The forces held against loads and strength: at the limit, or where all blocks last rest before it."""
    balance = rest or result.limit_state.balance
    if balance is None:
        yield Finding(
            "forces", None, None, None, "none were kept of this limit: nothing to hold it against"
        )
        return
    yield Finding(
        "forces",
        balance.force,
        _BALANCE_TOLERANCE,
        balance.force <= _BALANCE_TOLERANCE,
        "unbalanced force of a block, in parts of its load",
    )
    yield Finding(
        "moments",
        balance.moment,
        _BALANCE_TOLERANCE,
        balance.moment <= _BALANCE_TOLERANCE,
        "unbalanced moment, likewise",
    )
    worst = max(balance.pull, balance.friction_excess)
    yield Finding(
        "admissible",
        worst,
        _BALANCE_TOLERANCE,
        balance.admissible_within(_BALANCE_TOLERANCE),
        f"of {balance.node_pairs} node pairs none pulls, none beyond its strength",
    )
    # admissible forces that balance at a factor prove that the blocks can be held at every lower one, not at a higher
    shortfall = max(1.0 - balance.factor / limit, 0.0)
    if rest is not None:
        tolerance = result.design.analysis.agree_within
        words = f"these forces hold at F = {balance.factor:.6g}, where all blocks last rest: so far below that limit"
        yield Finding("holds at limit", shortfall, tolerance, shortfall <= tolerance, words)
        return
    above = balance.factor > limit * (1.0 + _SAME_FACTOR)
    words = f"these forces hold at F = {balance.factor:.6g}" + (
        ", above the limit: turning would add" if above else ""
    )
    yield Finding("holds at limit", shortfall, _SAME_FACTOR, shortfall <= _SAME_FACTOR, words)
