"""Strength laws in design files: keys, units, limits, faults, `--set`, sweeps and scatter."""

from dataclasses import dataclass, field, fields
from math import inf, radians, tan
from typing import ClassVar

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.fields import field_at
from slopekit.design.reading.files import with_values
from slopekit.design.strength_laws import KEYS, keys_of_laws
from slopekit.kinds import factors_of
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.strength.barton_bandis import BartonBandis
from slopekit.strength.bilinear import Bilinear
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.power import PowerCurve
from slopekit.strength.registry import LAWS
from slopekit.strength.waviness import Wavy
from slopekit.studies.evaluation.vectorised import vectorised
from slopekit.studies.keys import key_of

ROUGH = {"law": "barton-bandis", "jrc": 8, "jcs": "50 MPa", "phi_r": 25}
GIVEN = [
    (ROUGH, BartonBandis(8.0, 50e3, 25.0)),
    ({**ROUGH, "length": "5 m", "length_0": "20 cm"}, BartonBandis(8.0, 50e3, 25.0, 5.0, 0.2)),
    ({"law": "power", "a": 2, "b": 0.75}, PowerCurve(2.0, 0.75)),
    ({"law": "power", "a": 2, "b": 0.75, "d": "5 kPa"}, PowerCurve(2.0, 0.75, 5.0)),
    ({"law": "bilinear", "phi": 25, "i": 15, "sigma_t": "0.3 MPa"}, Bilinear(25.0, 15.0, 300.0)),
    ({**ROUGH, "waviness": 5}, Wavy(BartonBandis(8.0, 50e3, 25.0), 5.0)),
    ({"c": "50 kPa", "phi": 20, "waviness": 5}, Wavy(MohrCoulomb(50.0, 20.0), 5.0)),
]
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
}
KINDS = {
    "wedge": WEDGE,
    "plane": {
        "slopekit": 1,
        "kind": "plane",
        "slope": {"face": "60/180", "height": "12 m"},
        "joints": {"J1": {"plane": "35/180"}},
        "rock": {"unit_weight": 26},
    },
    "footing": {
        "slopekit": 1,
        "kind": "footing",
        "footing": {"load": "1500 kN"},
        "weak_plane": {"dip": 45, "length": "7 m"},
    },
    "surface": {
        "slopekit": 1,
        "kind": "surface",
        "slope": {"profile": [[60, 0], [40, 0], [0, 40], [-20, 40]]},
        "slip": {"shape": "sphere", "centre": [40, 0, 40], "radius": 40},
        "rock": {"unit_weight": 20},
    },
    "topple": {
        "slopekit": 1,
        "kind": "topple",
        "columns": {"dip": 60, "width": "1 m", "heights": [2, 3]},
        "rock": {"unit_weight": 25},
    },
    "bench": {
        "slopekit": 1,
        "kind": "bench",
        "slope": {"face": "70/180", "height": "10 m", "length": "20 m"},
        "sets": {"S1": {"plane": "30/175", "spacing": "3 m"}},
        "rock": {"unit_weight": 25},
    },
    "blocks": {
        "slopekit": 1,
        "kind": "blocks",
        "rock": {"unit_weight": 25},
        "blocks": {
            "base": {"polygon": [[0, 0], [2, 0], [2, -1], [0, -1]], "fixed": True},
            "B1": {"polygon": [[0, 0], [2, 0], [2, 1], [0, 1]]},
        },
    },
}


def law_of(design):
    """The law of a design's one strength, curved or straight."""
    first = design.strengths[0] if hasattr(design, "strengths") else design.strength
    return (first[1] if isinstance(first, tuple) else first).named_law


def codes(strength, of=WEDGE):
    """The fault codes of a design with one strength."""
    with pytest.raises(DesignError) as found:
        sk.load({**of, "strength": {"joint": strength}})
    return list(found.value.codes)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("given", "law"), GIVEN, ids=lambda part: str(part)[:40])
def test_every_law_on_every_kind(kind, given, law) -> None:
    """The keys of a law (docs/design-files.md), on the joints of every kind, with dilation beside them."""
    design = sk.load({**KINDS[kind], "strength": {"joint": {**given, "dilation": 2}}})
    assert law_of(design) == law
    own = design.strengths[0] if kind == "wedge" else getattr(design, "strength", None)
    own = dict(design.strengths)["joint"] if kind in ("topple", "bench", "blocks") else own
    assert own.dilation_deg == 2.0
    assert "law" in str(design.inputs())


@pytest.mark.parametrize("kind", KINDS)
def test_mohr_coulomb_by_name_is_the_default(kind) -> None:
    """`law` may be left out."""
    named = sk.load(
        {**KINDS[kind], "strength": {"joint": {"law": "mohr-coulomb", "c": 5, "phi": 30}}}
    )
    plain = sk.load({**KINDS[kind], "strength": {"joint": {"c": 5, "phi": 30}}})
    assert named.inputs() == plain.inputs()
    assert named.input_hash() == plain.input_hash()


@pytest.mark.parametrize("kind", ["wedge", "plane", "topple"])
def test_faults(kind) -> None:
    """Unknown laws and keys, what is missing, and every value out of its limits, all at once."""
    of = KINDS[kind]
    assert codes({"law": "bartn"}, of) == ["E142"]
    assert codes({"law": "barton-bandis", "jrc": 8}, of) == ["E143", "E143"]
    assert codes({**ROUGH, "sigma_t": 3}, of) == ["E142"]
    assert codes({**ROUGH, "c": 3}, of) == ["E142"]
    bad = {"law": "barton-bandis", "jrc": 40, "jcs": "-5 MPa", "phi_r": 80, "length": 0}
    assert codes(bad, of) == ["E127", "E114", "E115", "E127"]
    assert codes({"law": "power", "a": 2, "b": 1.5}, of) == ["E127"]
    assert codes({"law": "bilinear", "phi": 60, "i": 40, "sigma_t": 300}, of) == ["E115"]
    assert codes({**ROUGH, "waviness": -1}, of) == ["E115"]
    assert codes({**ROUGH, "jcs": "50 m"}, of) == ["E107"]
    assert [codes({**ROUGH, "jcs": kpa}, of) for kpa in (50, 99.5, 1.005e6, 5e7)] == [["E553"]] * 4
    assert codes({"c": 5, "phi": 30, "jrc": 8}, of) == ["E142"]


@pytest.mark.parametrize(("written", "meant"), [("50", "50 MPa"), ("50000000", "50000000 Pa")])
def test_a_wall_in_another_unit_is_told_how_to_be_written(written, meant) -> None:
    """A bare number is kPa: 50 would have no roughness left, and 50 MPa in Pa would hold at 70°."""
    with pytest.raises(DesignError) as refused:
        sk.load({**WEDGE, "strength": {"joint": {**ROUGH, "jcs": float(written)}}})
    assert refused.value.faults[0].advice.endswith(f"write {meant}.")
    for end in (100.0, 1e6, "0.1 MPa"):
        sk.load({**WEDGE, "strength": {"joint": {**ROUGH, "jcs": end}}})


def test_a_curved_joint_beside_a_straight_one() -> None:
    """Each joint of a wedge has its own strength, whatever its law."""
    joints = {
        "J1": {"plane": "45/115", "strength": "rough"},
        "J2": {"plane": "45/245", "strength": "clay"},
    }
    design = sk.load(
        {**WEDGE, "joints": joints, "strength": {"rough": ROUGH, "clay": {"c": 20, "phi": 22}}}
    )
    first, second = design.strengths
    assert first.law == BartonBandis(8.0, 50e3, 25.0)
    assert (second.law, second.cohesion_kpa, second.friction_angle_deg) == (None, 20.0, 22.0)


def test_the_limits_for_studies_are_those_of_the_laws() -> None:
    """The fields of the laws say what is read, and what may be drawn or solved for."""
    parts = [part for law in (*LAWS.values(), Wavy) for part in fields(law) if part.metadata]
    assert {part.metadata["key"] for part in parts} == {*KEYS, "c", "phi"}
    for part in parts:
        said = part.metadata
        if said["key"] in KEYS:
            field = field_at(WedgeDesign, f"strength.any.{said['key']}")
            ends = said.get("least", said.get("above")), said.get("most", said.get("below", inf))
            assert (field.measures, field.least, field.most) == (said["unit"], *ends)
            assert (field.above, field.below) == ("above" in said, "below" in said)


@dataclass(frozen=True)
class Rooted(PowerCurve):
    """A law from outside with keys a and b of its own, as a contributor's file would have it."""

    name: ClassVar[str] = "rooted"
    a: float = field(
        default=2.0,
        metadata={"key": "a", "unit": "pressure", "least": 0.0, "example": "2 kPa", "doc": "root"},
    )
    b: float = field(
        default=0.5,
        metadata={
            "key": "b",
            "unit": "ratio",
            "above": 0.0,
            "most": 1e3,
            "example": "9",
            "doc": "base",
        },
    )


def test_a_key_of_two_laws_has_the_limits_and_the_unit_of_the_law_that_is_named(
    monkeypatch,
) -> None:
    monkeypatch.setitem(LAWS, "rooted", Rooted)
    power, rooted = (
        {**WEDGE, "strength": {"joint": {"law": law, "a": 2, "b": 0.75}}}
        for law in ("power", "rooted")
    )
    keys = {
        law["strength"]["joint"]["law"]: key_of(sk.load(law), "strength.joint.b")
        for law in (power, rooted)
    }
    assert {name: key.high for name, key in keys.items()} == {"power": 1.0, "rooted": 1000.0}
    assert [key_of(sk.load(law), "strength.joint.a").unit for law in (power, rooted)] == ["", "kPa"]
    with pytest.raises(DesignError, match="E127"):
        sk.load(power, set={"strength.joint.b": 2})
    with pytest.raises(DesignError, match="E281"):
        sk.prob(
            sk.load(power, set={"strength.joint.b": {"dist": "normal", "mean": 0.9, "sd": 0.3}}),
            20,
            by="closed-form",
        )
    merged = keys_of_laws([PowerCurve, Rooted])
    assert (merged["b"].least, merged["b"].most, merged["b"].axis) == (0.0, 1000.0, "")
    assert keys_of_laws([Rooted, PowerCurve])["b"].most == 1000.0
    assert keys_of_laws([PowerCurve])["b"].most == 1.0


def test_what_scatters_is_read_anew() -> None:
    """JRC and JCS as distributions, correlated; `--set` and studies change them by their paths."""
    rough = {
        **ROUGH,
        "jrc": {"dist": "normal", "mean": 8, "sd": 1, "min": 4, "max": 12},
        "jcs": {"dist": "uniform", "min": "40 MPa", "max": "60 MPa"},
    }
    design = sk.load(
        {**WEDGE, "strength": {"rough": rough}, "correlation": {"rough.jrc/J1.jcs": 0.5}}
    )
    assert design.correlation == (("strength.rough.jrc", "strength.rough.jcs", 0.5),)
    key = key_of(design, "strength.rough.jrc")
    assert (key.value, key.low, key.high) == (8.0, 0.0, 25.0)
    assert with_values(design, {"strength.rough.jcs": "90 MPa"}).strengths[0].law.jcs_kpa == 90e3


@pytest.mark.slow
def test_studies_ask_the_law() -> None:
    """A sample, a sweep and a solution of JRC by the closed form are those of designs with that JRC."""
    rough = {**ROUGH, "jrc": {"dist": "uniform", "min": 6, "max": 10}}
    design = sk.load({**WEDGE, "strength": {"rough": rough}})
    assert vectorised(design, np.zeros((4, 1)), lambda row: {}) is None
    swept = sk.sweep(design, {"strength.rough.jrc": [6, 8, 10]}, closed_form=True)
    found = [point.factors.closed_form for point in swept.points]
    for jrc, factor in zip((6.0, 8.0, 10.0), found, strict=True):
        own = factors_of(
            sk.load({**WEDGE, "strength": {"rough": {**ROUGH, "jrc": jrc}}}), pre_ie=False
        )
        assert factor == pytest.approx(own.closed_form, rel=1e-12)
    solved = sk.solve(design, "strength.rough.jrc", fos=found[1], within=(6.0, 10.0))
    assert [root.value for root in solved.closed_form.roots] == pytest.approx([8.0], rel=1e-9)
    drawn = sk.prob(design, n=20, seed=3, by="closed-form", fos=found[1])
    assert (
        0.2 < drawn.all_samples.share < 0.8
    )  # F rises with JRC, which lies below 8 in half of the samples


def test_a_joint_list_counts_before_the_design_beside_waves_too(tmp_path) -> None:
    """c and φ of the list, the waves of the design: τ = c + σ (tan φ + tan φ_w), as the key reference says."""
    path = tmp_path / "joints.csv"
    path.write_text(
        "name,dip,dip_direction,c,phi\nA,45,115,11,31\nB,45,245,12,32\n", encoding="utf-8"
    )
    design = sk.load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "joints": {"csv": str(path)},
            "strength": {"joint": {"c": 90, "phi": 50, "waviness": 4}},
        }
    )
    for strength, c, phi in zip(design.strengths, (11.0, 12.0), (31.0, 32.0), strict=True):
        steep = tan(radians(phi)) + tan(radians(4.0))
        assert strength.named_law.resistance(np.array([0.0, 10.0])) == pytest.approx(
            [c, c + 10.0 * steep], rel=1e-12
        )
    assert f"c of the design for A: {path} has its own" in design.reading.left_out
