"""What a reader of a study of benches must know."""

from collections.abc import Iterator, Sequence

import numpy as np

from slopekit.core.errors import Notice
from slopekit.core.orientation import number
from slopekit.studies.bench_design.bench import SlidingColumns
from slopekit.studies.bench_design.confirmed import Confirmed
from slopekit.studies.bench_design.given import BenchInputs
from slopekit.studies.bench_design.outcomes import OfBench
from slopekit.studies.surveys import left_out

_FEW = 30  # joints: below it, a survey says little of its sets


def notices_of(asked: BenchInputs, benches: Sequence[OfBench], checked: Confirmed | None) -> Iterator[Notice]:
    """Yield what a reader must know of the survey, of the options and of what was not counted."""
    yield from asked.meant
    yield from left_out(asked.joints)
    n = len(asked.joints)
    ways = len({joint.plane for joint in asked.joints.joints})
    if ways < _FEW:
        of = f" in {ways} orientation{'s' if ways > 1 else ''}" if ways < n else ""
        yield Notice("W390", f"{asked.joints.name} holds {n} joints{of}: the same few meet again and again, "
                     "see the limits")  # fmt: skip
    known = int(np.isfinite(asked.trace_m).sum())
    if known < n:
        message = (
            f"{n - known} of {n} joints have no trace length and run as far as a block needs: blocks are too large"
        )
        yield Notice("W391", message)
    if asked.own[2]:
        yield from _hidden_ends(asked)
    if not np.isfinite(asked.spacing_m).all():
        without = int((~np.isfinite(asked.spacing_m)).sum())
        message = f"{without} of {n} joints have no spacing: columns between them form and are not judged"
        yield Notice("W391", message)
    if asked.every_m is None:
        message = (
            "how often joints meet along the bench is not known: one place is taken for each bench height; volumes per "
            "100 m go with it"
        )
        yield Notice("W391", message)
    narrow = sorted({
        (berm.berm_m, berm.catch_width_m) for bench in benches for berm in bench.berms
        if berm.berm_m < berm.catch_width_m * (1.0 - 1e-12)
    })  # fmt: skip
    if narrow:
        first, catch = narrow[0]
        message = (
            f"a berm of {number(first)} m is narrower than the catch width of {number(round(catch, 3))} m before "
            "anything fails: no place keeps it; a wider berm, or a catch width of your own (--catch)"
        )
        yield Notice("W394", message)
    wider = [bench for bench in benches if any(bench.backbreak.most > berm.berm_m for berm in bench.berms)]
    if wider:
        worst = max(bench.backbreak.most for bench in wider)
        message = (
            f"in {len(wider)} of {len(benches)} benches some places lose more than the whole berm (up "
            f"to {number(round(worst, 1))} m): the bench above, which would come along, is left out"
        )
        yield Notice("W394", message)
    yield from _cohesion(benches)
    slope = asked.slope
    if any(bench.modes["toppling"].forms.count for bench in benches) and (
        slope.water.mode != "dry" or slope.seismic.coefficient
    ):
        yield Notice(
            "W395", "toppling columns are judged by their weight alone: water and earthquake do not act on them"
        )
    if checked is None:
        return
    said = checked.said
    if said.unsafe:
        yield Notice("W353", f"{said.unsafe} of the {said.samples} blocks that PRE-IE looked at fail by it and stand "
                     "by the closed form: moments decide there")  # fmt: skip
    if said.settled < said.samples:
        yield Notice("W350", f"PRE-IE gave no answer for {said.samples - said.settled} of the {said.samples} blocks it "
                     "was asked of: they confirm nothing")  # fmt: skip


def _cohesion(benches: Sequence[OfBench]) -> Iterator[Notice]:
    """W422, of the bench in which cohesion holds the most."""
    hanging = [(bench, bench.bare) for bench in benches if bench.bare is not None and bench.bare.decides]
    if not hanging:
        return
    bench, bare = max(hanging, key=lambda one: one[1].fails["any"] - (one[0].modes["any"].fails.share or 0.0))
    of_formed = 100.0 * (bench.modes["any"].fails_if_formed.share or 0.0)
    yield Notice(
        "W422",
        f"the answer hangs on cohesion in {len(hanging)} of {len(benches)} benches: at {number(bench.height_m)} m and "
        f"{number(bench.face_dip_deg)}° {of_formed:.3g} % of the blocks that form fail, with c = 0 "
        f"{100.0 * (bare.fails_if_formed['any'] or 0.0):.3g} %; the berm needed is {bench.berm_needed_m:.3g} m or "
        f"{bare.berm_needed_m:.3g} m",
    )


def _hidden_ends(asked: BenchInputs) -> Iterator[Notice]:
    """W391, of traces that were measured: they run at least so far."""
    measured = [joint for joint in asked.joints.joints if joint.trace_m is not None]
    hidden, unknown = (sum(test) for test in (
        [joint.ends is not None and joint.ends < 2 for joint in measured], [joint.ends is None for joint in measured]
    ))  # fmt: skip
    if not hidden and not unknown:
        return
    parts = [f"{hidden} with a hidden end"] if hidden else []
    parts += [f"{unknown} without a word of their ends"] if unknown else []
    yield Notice(
        "W391",
        f"{len(measured)} traces are taken as whole as measured ({', '.join(parts)}): longer ones make more and larger "
        "blocks",
    )


def of_columns(benches: Sequence[OfBench], sliding: Sequence[SlidingColumns]) -> Iterator[Notice]:
    """W395, with the bench in which most of what slides is not counted."""
    slide, stand = sum(one.slide for one in sliding), sum(one.stand for one in sliding)
    if not slide:
        return
    bench, most = max(zip(benches, sliding, strict=True), key=lambda one: one[1].uncounted)
    counted, with_them = (100.0 * part / most.places for part in (most.failing, most.failing + most.uncounted))
    where = f"at {number(bench.height_m)} m and {number(bench.face_dip_deg)}°"
    yield Notice(
        "W395",
        f"{slide} of {stand} columns that stand against toppling slide on their base and do not count as failing "
        f"columns; {where} something fails at {counted:.1f} % of the places, with them at {with_them:.1f} %",
    )
