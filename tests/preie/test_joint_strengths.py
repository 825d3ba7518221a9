"""What elastic joints with curved laws resist and how it follows their normal forces, held against the laws alone."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import populations
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import Drive
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.joint_strengths import strengths_of
from tests.preie.path_oracle import model_of

LAWS = {
    "power": {"law": "power", "a": 2.0, "b": 0.6, "d": "3 kPa"},
    "barton-bandis": {"law": "barton-bandis", "jrc": 8, "jcs": "30 MPa", "phi_r": 25},
    "bilinear": {"law": "bilinear", "phi": 22, "i": 14, "sigma_t": "15 kPa"},
    "waves": {"law": "power", "a": 2.0, "b": 0.6, "waviness": 4},
}
SCENES = {"section": lambda: populations.section(3), "space": lambda: populations.bench(0, 40)}


def model_with(scene: str, law: str) -> AssemblyModel:
    """The model of a scene with one law on all joints."""
    design = SCENES[scene]()
    return model_of({**design, "strength": dict.fromkeys(design["strength"], LAWS[law])})


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("scene", SCENES)
def test_strength_is_that_of_the_law_at_the_traction_of_each_pair(scene, law) -> None:
    """Σ A τ(N / A) of each friction force, by the law alone; the cohesion that is given is τ(0) of the bonds left."""
    model = model_with(scene, law)
    kpa = model.control_area * (model.area_scale / model.force_scale)
    rng = np.random.default_rng(1)
    normal = kpa * 10.0 ** rng.uniform(-1.0, 3.0, len(kpa))
    tau = model.lines.laws[0].resistance(normal / kpa) * kpa
    strengths = strengths_of(model, model.group_of_pair)
    found = strengths.strength(normal, model.by_group(model.cohesion))
    assert found == pytest.approx(np.bincount(model.group_of_pair, tau), rel=1e-12)
    straight = strengths_of(
        replace(model, lines=replace(model.lines, follows_laws=False)), model.group_of_pair
    )
    by_lines = np.bincount(
        model.group_of_pair, model.cohesion + model.tan_friction[model.group_of_pair] * normal
    )
    assert straight.strength(normal, model.by_group(model.cohesion)) == pytest.approx(
        by_lines, rel=1e-12
    )


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(
    ("way", "dilation"), [("numpy", 0.0), ("compiled", 0.0), ("compiled", 0.05)]
)
def test_the_tangent_is_that_of_the_forces(scene, law, way, dilation, monkeypatch) -> None:
    """Unbalanced forces a little farther on, by differences of both sides: contact modes are those of the middle.

    And at a little more strength; where slip dilates it presses the joint, and its law follows.
    """
    monkeypatch.setenv("SLOPEKIT_KERNELS", way)
    model = model_with(scene, law)
    model = replace(model, tan_dilation=np.full(len(model.tan_dilation), dilation))
    bed, rng = ElasticContactModel(model, Drive(model.load.ravel())), np.random.default_rng(2)
    at = bed.elastic_displacement * 6.0
    there, move = bed.forces(at, 0.1), rng.normal(size=bed.size) * np.abs(at).mean()
    assert there.slips.any()
    ahead, behind = (bed.forces(at + by * move, 0.1) for by in (1e-6, -1e-6))
    assert ahead.same_modes(behind)
    by_differences = (ahead.unbalanced - behind.unbalanced) / 2e-6
    stiff = -bed.stiffness.dense(bed.tangent(there, 0.1)) @ move
    assert stiff == pytest.approx(by_differences, abs=1e-6 * float(np.abs(by_differences).max()))
    stronger, weaker = (bed.forces(at, 0.1 + by) for by in (1e-7, -1e-7))
    by_strength = (stronger.unbalanced - weaker.unbalanced) / 2e-7
    assert bed.parameter_derivative(there, 0.1) == pytest.approx(
        by_strength, abs=1e-6 * float(np.abs(by_strength).max())
    )
    modes = bed.forces(at, 0.1, modes=there)
    assert modes.unbalanced == pytest.approx(there.unbalanced, abs=1e-12 * there.largest)


def test_compiled_forces_are_those_of_numpy(monkeypatch) -> None:
    """Where joints slip at their law."""
    model, found = model_with("space", "power"), []
    for way in ("numpy", "compiled"):
        monkeypatch.setenv("SLOPEKIT_KERNELS", way)
        bed = ElasticContactModel(model, Drive(model.load.ravel()))
        found.append(bed.forces(6.0 * bed.elastic_displacement, 0.1))
    one, other = found
    for name in ("normal", "friction", "strength", "slips", "unbalanced"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-12), name
