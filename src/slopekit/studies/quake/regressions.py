"""Displacements by published regressions over many records, to hold a record's own against.

All are medians for a rigid block on records of shallow earthquakes, with κ = 1: plain Newmark displacements.

Sources: Ambraseys & Menu 1988 (Earthquake Eng. Struct. Dyn. 16, 985-1006); Jibson 2007 (Eng. Geology 91, 209-218),
eqs. 6 and 10; Saygili & Rathje 2008 (J. Geotech. Geoenviron. Eng. 134, 790-803), eq. 6 with PGA and PGV, with PGA and
Arias intensity. Coefficients as Meehan & Vahedifard 2013 (Eng. Geology 152, 180-193) list them; the first four are
those of USGS's SLAMMER too (Jibson et al. 2013, its source), the last those of a public R function for Newmark
displacements (Dn_SR08). The papers themselves were not read.
"""

import math
from collections.abc import Callable
from typing import TypeAlias

from slopekit.core.records import dataclass

#: Below that k_y, g, none is printed: all grow without end as k_y / PGA falls, far beyond the records behind them.
LEAST_K = 0.02
#: Of k_y, PGA (g), PGV (cm/s), Arias intensity (m/s) to the displacement in cm.
Formula: TypeAlias = Callable[[float, float, float, float], float]


@dataclass(frozen=True, slots=True)
class Regression:
    """A regression: its name, what it asks of a record, its median displacement (cm)."""

    name: str
    asks: str
    median_cm: Formula


def _polynomial(r: float, *coefficients: float) -> float:
    return sum(coefficient * r**k for k, coefficient in enumerate(coefficients))


def _saygili_rathje_pgv(k: float, pga: float, pgv: float, _arias: float) -> float:
    of_ratio = _polynomial(k / pga, -1.56, -4.58, -20.84, 44.75, -30.50)
    return math.exp(of_ratio - 0.64 * math.log(pga) + 1.55 * math.log(pgv))


def _saygili_rathje_arias(k: float, pga: float, _pgv: float, arias: float) -> float:
    of_ratio = _polynomial(k / pga, 2.39, -5.24, -18.78, 42.01, -29.15)
    return math.exp(of_ratio - 1.56 * math.log(pga) + 1.38 * math.log(arias))


REGRESSIONS = (
    Regression("Ambraseys & Menu 1988", "PGA",
               lambda k, pga, _pgv, _ia: 10.0**0.90 * (1.0 - k / pga) ** 2.53 * (k / pga) ** -1.09),
    Regression("Jibson 2007, eq. 6", "PGA",
               lambda k, pga, _pgv, _ia: 10.0**0.215 * (1.0 - k / pga) ** 2.341 * (k / pga) ** -1.438),
    Regression("Jibson 2007, eq. 10", "PGA, Arias intensity",
               lambda k, pga, _pgv, ia: 10.0 ** (0.561 * math.log10(ia) - 3.833 * math.log10(k / pga) - 1.474)),
    Regression("Saygili & Rathje 2008", "PGA, PGV", _saygili_rathje_pgv),
    Regression("Saygili & Rathje 2008", "PGA, Arias intensity", _saygili_rathje_arias),
)  # fmt: skip


def median_m(regression: Regression, k: float, pga_g: float, pgv_m_s: float, arias_m_s: float) -> float:
    """The median displacement of a regression, m; nothing where the peak does not reach the yield coefficient.

    >>> round(median_m(REGRESSIONS[1], 0.1, 0.4, 0.3, 1.0), 5)
    0.06142
    """
    if pga_g <= k:
        return 0.0
    return regression.median_cm(k, pga_g, pgv_m_s * 100.0, arias_m_s) / 100.0
