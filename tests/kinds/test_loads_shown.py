"""A sheet shows every load of its design; of one that it has no words for it never says that there is none."""

from dataclasses import dataclass, fields

import pytest

import slopekit as sk
from slopekit.design.fields import number
from slopekit.design.parts import Seismic
from slopekit.design.templates import path_of
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.kinds.words import WEIGHT_ONLY, loads_section
from slopekit.result import Result
from tests.support import SMALL_BENCH

WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
}


@dataclass(frozen=True, kw_only=True)
class WithCable(WedgeDesign):
    """A wedge of another's kind, whose load the sheets here have never seen."""

    cable_kn: float = number("loads.cable", "force", default=0.0)
    anchor_wall_kpa: float = number("wall.pressure", "pressure", default=0.0)
    ACTIONS = {"anchor_wall_kpa": "surcharge"}  # noqa: RUF012


def loads_of(**given) -> str:
    result = sk.run(WEDGE)
    assert isinstance(result, Result)
    plain = {part.name: getattr(result.design, part.name) for part in fields(WedgeDesign)}
    object.__setattr__(result, "design", WithCable(**{**plain, **given}))
    return " | ".join(map(str, loads_section([], result).entries))


def test_a_load_that_a_sheet_does_not_know_is_shown_and_never_denied() -> None:
    assert loads_of() == WEIGHT_ONLY
    assert loads_of(cable_kn=120.0) == "cable 120 kN"
    assert loads_of(anchor_wall_kpa=15.0) == "pressure 15 kPa"
    both = loads_of(cable_kn=120.0, seismic=Seismic(0.1))
    assert both.startswith("seismic 0.1 g")
    assert both.endswith("cable 120 kN")


LOADS = {
    "loads.seismic.k": 0.1,
    "loads.forces": ["50 kN@180/10"],
    "support.bolts": ["50 kN@000/10"],
    "loads.surcharge": "20 kPa",
}


@pytest.mark.parametrize("kind", ["wedge", "plane", "footing", "blocks"])
@pytest.mark.parametrize("path", LOADS)
def test_no_sheet_denies_a_load(kind, path) -> None:
    try:
        design = sk.load(
            path_of(kind), {path: LOADS[path]} | (SMALL_BENCH if kind == "bench" else {})
        )
    except sk.DesignError:
        pytest.skip("this kind has no such load")
    try:
        text = str(sk.run(design).sheet)
    except sk.SlopekitError:
        pytest.skip("no block with this load")
    assert WEIGHT_ONLY not in text
    assert {"k": "seismic 0.1", "forces": "force (", "bolts": "bolt", "surcharge": "20 kPa"}[
        path.rpartition(".")[2]
    ] in text
