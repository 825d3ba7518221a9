"""How large it is what the samples form: percentiles of volume, setback, width, height."""

from collections.abc import Mapping
from dataclasses import field

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.codec import NO_JSON
from slopekit.core.records import dataclass
from slopekit.studies.prob.vectorised import Vectorised

SHARES = (0.05, 0.5, 0.95)


@dataclass(frozen=True, slots=True)
class SizeStatistics:
    """One size of some samples: its mean, percentiles by share, and the largest."""

    mean: float
    quantiles: Mapping[float, float]
    most: float = field(metadata={"json": "max"})


@dataclass(frozen=True, slots=True)
class SampleSizes:
    """Sizes of the samples, nan where none forms.

    Attributes
    ----------
    columns : (n,) each, by key; forming, failing : of the samples that form a block and of those that fail, by key
    scaled : samples that limits of size made smaller
    """

    columns: Mapping[str, Floats] = field(metadata=NO_JSON)  # the samples themselves are in the CSV
    forming: Mapping[str, SizeStatistics]
    failing: Mapping[str, SizeStatistics]
    scaled: int


def sizes_of_samples(fast: Vectorised | None, values: Floats, forms: Bools, fails: Bools) -> SampleSizes | None:
    """The sizes of all samples; None where the kind has none, or samples are read one by one.

    Parameters
    ----------
    fast : the evaluator of all samples, None where there is none; forms, fails : (n,)
    """
    sizes = None if fast is None else fast.sizes(values)
    if sizes is None:
        return None
    columns = {key: np.where(forms, column, np.nan) for key, column in sizes.columns.items()}
    scaled = int((columns["scale"] < 1.0).sum()) if "scale" in columns else 0
    return SampleSizes(columns, _spreads(columns, forms), _spreads(columns, forms & fails), scaled)


def _spreads(columns: Mapping[str, Floats], own: Bools) -> dict[str, SizeStatistics]:
    spreads = {}
    for key, column in columns.items():
        known = column[own & np.isfinite(column)]
        if len(known) and key != "scale":
            cuts = np.quantile(known, SHARES).tolist()
            spreads[key] = SizeStatistics(float(known.mean()), dict(zip(SHARES, cuts, strict=True)), float(known.max()))
    return spreads
