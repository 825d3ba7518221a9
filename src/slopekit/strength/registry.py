"""The strength laws by the names that design files write. A new law is its file and a line here."""

from collections.abc import Mapping
from typing import Any

from slopekit.strength.barton_bandis import BartonBandis
from slopekit.strength.bilinear import Bilinear
from slopekit.strength.bridged import Bridged
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.power import PowerCurve

LAWS: Mapping[str, Any] = {law.name: law for law in (MohrCoulomb, BartonBandis, PowerCurve, Bilinear, Bridged)}
