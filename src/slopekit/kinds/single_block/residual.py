"""The factors of safety on residual strength, beside those on the peak: both methods asked again after slip."""

from dataclasses import replace

from slopekit.core.errors import Notice
from slopekit.design.common import Design
from slopekit.evidence import ResidualFactors
from slopekit.kinds.protocol import Factors, Kind
from slopekit.result import Result

_SAME = 1e-9


def with_residual(kind: "Kind[Design]", result: Result) -> Result:
    """The result with its factors on residual strength, where some of its strengths have one."""
    factors = kind.factors(replace(result.design.at_residual(), rules=()))
    left = ResidualFactors(factors.status, factors.limit, factors.closed_form, factors.difference, factors.agree)
    held = replace(result, comparisons=replace(result.comparisons, residual=left))
    return replace(held, warnings=(*held.warnings, *_notices(held, left, factors)))


def _notices(result: Result, left: ResidualFactors, factors: Factors) -> list[Notice]:
    said, peak = [], result.fos.limit
    if left.limit is not None and peak is not None and left.limit > peak * (1.0 + _SAME):
        said.append(Notice("W417", f"the residual factor {left.limit:.4g} lies above the peak's {peak:.4g}: other "
                           "joints open or carry then; is the residual strength that of these joints?"))  # fmt: skip
    if result.met_by_peak_only:
        number = f"is {left.limit:.4g}" if left.limit is not None else f"does not exist ({factors.status})"
        said.append(Notice("W417", f"acceptance is met by the peak strength only: the residual factor {number}; once "
                           "the joints have slipped, the rule is broken"))  # fmt: skip
    return said
