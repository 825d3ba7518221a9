"""A column under its own weight: γ h² / 2E + γ h / k_n, exact with elements of order two (strength of materials)."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

import slopekit as sk
from slopekit.elastic.condensed import ElasticModel
from slopekit.elastic.flexibility import Elements, body
from slopekit.elastic.meshing import cells_of, fanned, halvings, measures, mesh_of
from slopekit.elastic.rest import RestSearch
from slopekit.geometry.interfaces import node_pairs
from slopekit.preie.system.contact import JointStiffness
from slopekit.preie.system.model import local_axes

E, NU, K_N, GAMMA, H = 2e6, 0.0, 1e5, 25.0, 10.0
BOX = np.array([[x, y, z] for z in (0.0, H) for x, y in ((0, 0), (2, 0), (2, 1), (0, 1))])
FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def box_mesh(edge: float):
    mesh = mesh_of(BOX, cells_of(BOX, fanned(FACES)))
    return mesh.refined(halvings(mesh, edge))


def on_its_base(elements: Elements, pairs) -> ElasticModel:
    """A box on springs at node pairs of its base."""
    axes, centre, n = local_axes(pairs.normals), BOX.mean(axis=0), len(pairs)
    rows = np.concatenate([axes, np.cross((pairs.points - centre)[:, None], axes)], axis=2).reshape(
        3 * n, 6
    )
    weight = GAMMA * elements.volume
    given = np.zeros(n)
    give = body(elements, pairs.points, axes, 1.0)
    return ElasticModel(
        sparse.csr_matrix(rows),
        np.array([0.0, 0.0, -weight, 0.0, 0.0, 0.0]),
        pairs.control_areas,
        given + 100.0,
        given,
        given + 0.5,
        given,
        np.zeros((0, 6)),
        np.zeros(0),
        ((give, np.arange(3 * n), np.arange(6)),),
    )


def test_the_cells_of_a_box_fill_it() -> None:
    cells = cells_of(BOX, fanned(FACES))
    assert np.abs(measures(BOX, cells)).sum() == pytest.approx(20.0, rel=1e-14)
    assert (np.abs(measures(BOX, cells)) > 0.1).all()


@pytest.mark.parametrize("edge", [20.0, 5.0])
def test_a_column_settles_as_strength_of_materials_says(edge: float) -> None:
    model = on_its_base(Elements(box_mesh(edge), E, NU), node_pairs({0: BOX[[0, 3, 2, 1]]}, 2))
    found = RestSearch(model, JointStiffness(normal=K_N, tangential=1e5)).rest(1.0)
    assert found.is_balanced
    mean = -(GAMMA * H * H / 3.0 / E + GAMMA * H / K_N)
    seen = found.motion[2] + model.mean_bending(found.motion, 1.0, found.bent)[0, 2]
    # pairs of 1/12 and 3/4 integrate what elements of order two do, where no pair's triangle crosses an element
    assert seen == pytest.approx(mean, rel=1e-11)
    assert found.forces.reshape(-1, 3)[:, 0] == pytest.approx(GAMMA * H * model.area, rel=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("elastic", [False, True])
def test_a_block_that_overhangs_does_not_hang_on_open_pairs(elastic: bool) -> None:
    """Its weight acts a millionth of its width beyond the edge it would turn about: nothing but springs of open pairs
    could hold that, and on them it would rest with its base open by centimetres."""
    model = on_its_base(Elements(box_mesh(20.0), E, NU), node_pairs({0: BOX[[0, 3, 2, 1]]}, 2))
    model = replace(model if elastic else model.rigid(), cohesion=np.zeros(len(model.area)))
    weight = -model.load[2]
    for beyond, stands in ((-1e-2, True), (1e-6, False)):
        turned = replace(model, load=model.load + weight * (1.0 + beyond) * np.eye(6)[4])
        search = RestSearch(turned, JointStiffness(normal=K_N, tangential=1e5))
        assert search.rest(0.01).is_balanced is stands
    search = RestSearch(turned, JointStiffness(normal=K_N, tangential=1e5))
    search.rest_stiffness = search.stiffness
    hanging = search.rest(0.01)
    assert hanging.is_balanced
    assert hanging.relative[:, 0].max() > 0.02


def stacked(lower: float, upper: float, modulus: float) -> dict:
    """Two columns of a section, one on the other on bedrock, in meshes that do not match."""
    return {
        "slopekit": 1,
        "kind": "blocks",
        "section": {"thickness": "2 m"},
        "blocks": {
            "base": {"polygon": [[-5, -5], [8, -5], [8, 0], [-5, 0]], "fixed": True},
            "A": {"polygon": [[0, 0], [3, 0], [3, lower], [0, lower]], "unit_weight": 25},
            "B": {
                "polygon": [[0, lower], [3, lower], [3, lower + upper], [0, lower + upper]],
                "unit_weight": 25,
            },
        },
        "strength": {"joint": {"c": 10, "phi": 30, "stiffness": {"normal": 1e5, "shear": 1e5}}},
        "rock": {"modulus": modulus, "poisson": 0.0},
    }


def test_two_columns_with_meshes_that_do_not_match() -> None:
    lower, upper = 4.0, 7.0
    found = sk.run(stacked(lower, upper, E), elastic=True).elastic
    assert found is not None
    assert found.block == "B"
    springs = (GAMMA * (lower + upper) + GAMMA * upper) / 1e5
    below = (GAMMA * lower**2 / 2.0 + GAMMA * upper * lower) / E
    mean = springs + below + GAMMA * upper**2 / 3.0 / E
    assert found.displacement_m[2] == pytest.approx(-mean, rel=1e-9)
    assert found.rigid_displacement_m[2] == pytest.approx(-springs, rel=1e-9)
    assert found.opened_share == 0.0


SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def work_on_a_square(traction, order: int, halved: int, parts: int = 32) -> float:
    """The work of tractions up and down on the two ends of a square in a section, ν = 0."""
    mesh = mesh_of(SQUARE, fanned([[0, 1, 2, 3]])).refined(halved)
    x = np.linspace(-1.0, 1.0, 2 * parts + 1)
    weights = np.full(len(x), 2.0)
    weights[1::2], weights[[0, -1]] = 4.0, 1.0
    points = np.array([[at, 0.0, z] for z in (-1.0, 1.0) for at in x])
    axes = local_axes(np.tile([0.0, 0.0, 1.0], (len(points), 1)))
    give = body(Elements(mesh, E, 0.0, order=order), points, axes, 1.0)
    force = np.zeros((len(points), 3))
    force[:, 0] = (
        np.sign(points[:, 2]) * traction(points[:, 0]) * np.tile(weights, 2) / (3.0 * parts)
    )
    nodal = give.shapes.T @ force.ravel()
    return float(nodal @ np.linalg.lstsq(give.stiffness, nodal, rcond=1e-12)[0])


def test_bending_is_exact_in_order_two() -> None:
    """M² l / E I of a beam bent by couples at its ends: tractions are linear, displacements quadratic; I = 2 / 3."""
    moment = 2.0 / 3.0
    assert work_on_a_square(lambda x: x, 2, 1) == pytest.approx(
        moment**2 * 2.0 / (E * 2.0 / 3.0), rel=1e-9
    )


@pytest.mark.parametrize(("order", "halved", "least", "most"), [(1, 4, 1.6, 2.3), (2, 2, 3.0, 5.0)])
def test_the_flexibility_converges_with_twice_the_order_of_the_elements(
    order, halved, least, most
) -> None:
    """The energy of a smooth load that balances itself: order 2 with linear, 4 with quadratic elements (theory)."""

    def traction(x):
        return x**3 - 0.6 * x

    exact = work_on_a_square(traction, 2, 4)
    coarse, fine = (
        abs(work_on_a_square(traction, order, halved + k) / exact - 1.0) for k in (0, 1)
    )
    assert least < np.log2(coarse / fine) < most
