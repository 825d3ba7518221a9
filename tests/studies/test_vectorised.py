"""Samples all at once: every key that scatters goes into the arguments that reading each sample gives (1e-12)."""

import copy
import json

import numpy as np
import pytest

from slopekit.core.errors import DesignError
from slopekit.design.reading.files import load, with_values
from slopekit.kinds import kind_of
from slopekit.strength.protocol import row_laws
from slopekit.studies.evaluation.vectorised import vectorised
from slopekit.studies.prob.sampling import samples
from tests.bolted import as_laid_out, standing


def plane(dip: float, direction: float) -> dict:
    return {"dip": dip, "dip_direction": direction}


LOADS = {
    "seismic": {"k": 0.05, "toward": 180},
    "forces": [
        {"force": 300, "toward": {"trend": 180, "plunge": 10}},
        {"force": -50, "toward": {"trend": 170, "plunge": 80}},
    ],
}
SUPPORT = {
    "bolts": [
        {"force": 400, "toward": {"trend": 10, "plunge": 10}, "acts": "passive"},
        {"force": 200, "toward": {"trend": 10, "plunge": 5}, "head": [0, -1, 5], "length": 9},
    ]
}
BARTON = {"law": "barton-bandis", "jrc": 8, "jcs": 5e4, "phi_r": 26, "waviness": 3}
POWER = {"law": "power", "a": 1.2, "b": 0.8, "d": 4}
BILINEAR = {"law": "bilinear", "phi": 25, "i": 12, "sigma_t": 80}
BRIDGED = {"law": "bridged", "c": 2, "phi": 28, "c_rock": 3000, "phi_rock": 45, "persistence": 0.9}
STRENGTH = {
    "a": {"c": 20, "phi": 25, "tension": 1, "stiffness": {"normal": 1e7}},
    "b": {"c": 30, "phi": 22},
}
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "strength": STRENGTH,
    "joints": {
        "A": {"plane": plane(45, 115), "strength": "b"},
        "B": {"plane": plane(45, 245), "strength": "a"},
    },
    "slope": {"face": plane(65, 185), "upper": plane(8, 180), "height": 30},
    "rock": {"unit_weight": 26},
}
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": plane(60, 180), "upper": plane(5, 180), "height": 12},
    "joints": {"A": {"plane": plane(35, 185)}},
    "strength": {"only": {"c": 25, "phi": 37}},
    "rock": {"unit_weight": 26},
}
DENSE = {"density": 2650, "gravity": 9.81}
CRACK = {"plane": plane(75, 180), "distance": 6}
DESIGNS = {
    "wedge": WEDGE
    | {
        "rock": DENSE,
        "water": {"fill": 0.4, "unit_weight": 9.8},
        "loads": LOADS,
        "support": SUPPORT,
    },
    "wedge-crack": WEDGE
    | {"crack": CRACK | {"water": 0.5}, "water": {"fill": 0.3}, "loads": {"seismic": 0.1}},
    "wedge-pressures": WEDGE | {"crack": CRACK, "water": {"pressures": {"B": 9, "crack": 4}}},
    "wedge-list": WEDGE | {"crack": CRACK, "water": {"pressures": [5, 9, 4]}},
    "wedge-curved": WEDGE | {"strength": {"a": BARTON, "b": POWER}},
    "wedge-laws": WEDGE | {"strength": {"a": BILINEAR, "b": BRIDGED}},
    "wedge-waves": WEDGE
    | {"strength": {"a": {"c": 20, "phi": 25, "waviness": 4}, "b": {"c": 30, "phi": 22}}},
    "plane": PLANE
    | {"rock": DENSE, "crack": {"depth": 4, "water": 2}, "loads": LOADS, "support": SUPPORT},
    "plane-fill": PLANE | {"crack": {"distance": 3}, "water": {"fill": 0.4, "unit_weight": 9.8}},
    "plane-pressures": PLANE
    | {"crack": {"depth": 4}, "water": {"pressures": {"A": 9, "crack": 5}}},
}
NO_SCATTER = ("slopekit", "seismic", "head")


def numbers(tree, path=()):
    """The paths of the numbers that may scatter."""
    for key, below in tree.items() if isinstance(tree, dict) else enumerate(tree):
        if key in NO_SCATTER:
            continue
        if isinstance(below, dict | list):
            yield from numbers(below, (*path, key))
        elif isinstance(below, int | float):
            yield *path, key


def scattered(values: dict, *paths: tuple) -> dict:
    """The design with these numbers uniform within 3 %."""
    values = copy.deepcopy(values)
    for path in paths:
        holder = values
        for part in path[:-1]:
            holder = holder[part]
        ends = sorted((holder[path[-1]] * 0.97, holder[path[-1]] * 1.03))
        holder[path[-1]] = {"dist": "uniform", "min": ends[0], "max": ends[1]}
    return values


def check(values: dict, n: int = 2) -> None:
    """All at once, and each argument that of the sample read by itself."""
    design = load(values)
    drawn = samples(design.variables, (), n, 3)
    fast = vectorised(design, drawn.values, drawn.settings)
    assert fast is not None
    found, own = fast.arguments(drawn.values), kind_of(design).on_arrays
    rows = fast.rows(drawn.values)
    strengths, forms = rows.numbers[1], rows.closed_form
    for row in range(n):
        sample = standing(with_values(design, drawn.settings(row)), as_laid_out(design))
        for name, value in own.arguments(sample).items():
            one = None if found[name] is None else float(np.broadcast_to(found[name], n)[row])
            assert (
                one is None
                if value is None
                else one == pytest.approx(float(value), rel=1e-12, abs=1e-12)
            ), (
                name,
                row,
            )
        for strength, alone in zip(strengths, sample.joint_strengths, strict=True):
            law, at = row_laws(strength.law, n)[row], np.array([3.0, 40.0, 300.0])
            assert (law is None) == (alone.law is None)
            if law is not None:
                assert law.resistance(at) == pytest.approx(alone.law.resistance(at), rel=1e-12)
        assert forms.names[forms.outcome[row]] == (solution := own.closed_form(sample)).status
        assert forms.factor[row] == pytest.approx(solution.factor, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "path"), [(name, path) for name, values in DESIGNS.items() for path in numbers(values)]
)
def test_every_key_alone(name, path) -> None:
    check(scattered(DESIGNS[name], path))


@pytest.mark.parametrize("name", DESIGNS)
def test_all_keys_together(name) -> None:
    """Also what several keys make up: the weight by density and gravity, the sum of the forces."""
    check(scattered(DESIGNS[name], *numbers(DESIGNS[name])))


def test_what_is_read_one_by_one(tmp_path) -> None:
    """A strength that a column of the joint list takes the place of."""
    (tmp_path / "joints.csv").write_text("name,dip,dip direction,c\nJ1,45,115,20\nJ2,45,245,30\n")
    listed = scattered(WEDGE, ("strength", "a", "c")) | {
        "joints": {"csv": "joints.csv", "strength": "a"}
    }
    del listed["strength"]["b"]
    (tmp_path / "design.yaml").write_text(json.dumps(listed))
    design = load(tmp_path / "design.yaml")
    drawn = samples(design.variables, (), 40, 3)
    assert design.cohesion_kpa == (20.0, 30.0)
    assert vectorised(design, drawn.values, drawn.settings) is None


def test_samples_that_no_design_can_have_are_passed_over() -> None:
    values = scattered(WEDGE, ("slope", "height"))
    values["strength"]["b"]["phi"] = {"dist": "uniform", "min": -1, "max": 30}
    design = load(values)
    drawn = samples(design.variables, (), 200, 3)
    with pytest.raises(DesignError, match="E115"):
        with_values(
            design,
            drawn.settings(int(drawn.values[:, drawn.names.index("strength.b.phi")].argmin())),
        )
    assert vectorised(design, drawn.values, drawn.settings) is not None
