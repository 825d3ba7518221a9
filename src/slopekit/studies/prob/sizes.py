"""How large it is what the samples form: percentiles of volume, setback, width, height; what limits made of it."""

from collections.abc import Mapping
from dataclasses import field

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.codec import NO_JSON
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.studies.prob.vectorised import Vectorised

SHARES = (0.05, 0.5, 0.95)


@dataclass(frozen=True, slots=True)
class SizeStatistics:
    """One size of some samples: its mean, percentiles by share, and the largest."""

    mean: float
    quantiles: Mapping[float, float]
    most: float = field(metadata={"json": "max"})


@dataclass(frozen=True, slots=True)
class LimitedSamples:
    """What limits of size made of the samples.

    Attributes
    ----------
    by : scale or filter; scaled : samples made smaller, and by which limit; filtered : left out, larger than a limit;
    too_small : left out, smaller than the least volume. Samples that are left out form no block
    """

    by: str
    scaled: int
    scaled_by: Mapping[str, int]
    filtered: int
    too_small: int


@dataclass(frozen=True, slots=True)
class SampleSizes:
    """Sizes of the samples, nan where none forms.

    Attributes
    ----------
    columns : (n,) each, by key; forming, failing : of the samples that form a block and of those that fail, by key
    limits : None where the design has none
    """

    columns: Mapping[str, Floats] = field(metadata=NO_JSON)  # the samples themselves are in the CSV
    forming: Mapping[str, SizeStatistics]
    failing: Mapping[str, SizeStatistics]
    limits: LimitedSamples | None


def sizes_of_samples(
    design: Design, fast: Vectorised | None, values: Floats, forms: Bools, fails: Bools
) -> SampleSizes | None:
    """The sizes of all samples; None where the kind has none, or samples are read one by one.

    Parameters
    ----------
    fast : the evaluator of all samples, None where there is none; forms, fails : (n,)
    """
    limits = getattr(design, "limits", None)
    sizes = None if fast is None else fast.sizes(values)
    if sizes is None:
        return None
    columns = {key: np.where(forms, column, np.nan) for key, column in sizes.columns.items()}
    made = None
    if limits is not None:
        kept = forms & (sizes.why == 0)
        by = sizes.by[kept]
        names = {name: int((by == k).sum()) for k, name in enumerate(sizes.names) if name and (by == k).any()}
        is_scaled = limits.by == "scale"
        made = LimitedSamples(
            limits.by, int((by > 0).sum()) if is_scaled else 0, names if is_scaled else {},
            int((sizes.why == 1).sum()), int((sizes.why == 2).sum()),
        )  # fmt: skip
    return SampleSizes(columns, _spreads(columns, forms), _spreads(columns, forms & fails), made)


def _spreads(columns: Mapping[str, Floats], own: Bools) -> dict[str, SizeStatistics]:
    spreads = {}
    for key, column in columns.items():
        known = column[own & np.isfinite(column)]
        if len(known) and key != "scale":
            cuts = np.quantile(known, SHARES).tolist()
            spreads[key] = SizeStatistics(float(known.mean()), dict(zip(SHARES, cuts, strict=True)), float(known.max()))
    return spreads
