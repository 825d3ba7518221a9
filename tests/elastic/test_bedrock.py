"""Elastic bedrock: its cells fill the box, its elements conform, and it gives as strength of materials says."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu

import slopekit as sk
from benchmarks.elastic_oracle import last_rest, state_of
from slopekit.core.errors import DesignError
from slopekit.elastic.bedrock import _far, bedrock, box_around, box_of, cut_cells, graded
from slopekit.elastic.flexibility import Elements, Rock
from slopekit.elastic.meshing import cells_of, fanned, measures, mesh_of, split_evenly
from slopekit.elastic.model import on_bedrock
from slopekit.elastic.rest import RestSearch
from slopekit.preie.system.contact import JointStiffness, tractions
from slopekit.preie.system.model import local_axes

E = 2e6
WEDGE = {"dips": ("45/105", "70/235"), "face": "65/185", "upper": "12/195", "height": 30, "c": (24, 48),
         "phi": (20, 30), "unit_weight": 25, "modulus": "2 GPa", "edge": "40 m", "shear_stiffness": 1e5,
         "bedrock": "elastic"}  # fmt: skip
PLANE = {
    "slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12, "upper": "0/180"},
    "joints": {"J1": {"plane": "35/180"}}, "strength": {"joint": {"c": 20, "phi": 30, "stiffness": {"shear": 1e6}}},
    "rock": {"density": 2600}, "analysis": {"elastic": {"bedrock": "elastic"}},
}  # fmt: skip


@pytest.mark.parametrize("dim", [2, 3])
def test_planes_cut_a_box_into_cells_that_fill_it_and_share_faces(dim: int) -> None:
    points, cell = box_of(np.zeros(dim), np.arange(2.0, 2.0 + dim))
    rng, cells = np.random.default_rng(5), [cell]
    for k in range(5):
        normal = rng.normal(size=dim) if k else np.eye(dim)[0]
        points, cells = cut_cells(points, cells, normal, float(normal @ (0.4 + rng.random(dim))))
    parts = [fanned(cell) if dim == 2 else cells_of(points, fanned(cell)) for cell in cells]
    volumes = [float(np.abs(measures(points, part)).sum()) for part in parts]
    whole = float(np.prod(np.arange(2.0, 2.0 + dim)))
    assert sum(volumes) == pytest.approx(whole, rel=1e-12)
    assert min(volumes) > 0.0
    mesh = mesh_of(points, np.concatenate(parts))
    assert surface(mesh) == pytest.approx(2.0 * (2 + 3) if dim == 2 else 2.0 * (6 + 8 + 12), rel=1e-12)


def surface(mesh) -> float:
    """What elements share with no other, m or m²: more than the outside where they do not conform."""
    ends = mesh.p.T[mesh.facets[:, mesh.boundary_facets()].T]
    sides = ends[:, 1:] - ends[:, :1]
    if len(mesh.p) == 2:
        return float(np.sqrt((sides[:, 0] ** 2).sum(axis=1)).sum())
    return float(np.sqrt((np.cross(sides[:, 0], sides[:, 1]) ** 2).sum(axis=1)).sum() / 2.0)


def test_the_rock_around_a_block_of_a_section() -> None:
    """A slope of 45°, 2 m high, a triangle on a joint of 26.6°; areas by hand."""
    toe, crest, back = np.array([0.0, 0.0]), np.array([-2.0, 2.0]), np.array([-4.0, 2.0])
    faces = {0: np.array([toe, back]), 1: np.array([crest, toe]), 2: np.array([back, crest])}
    box = box_around(faces, [1, 2], 0.0, margin=1.0)
    mesh = graded(box.mesh, np.linspace(toe, back, 9), 0.5, 10_000)
    assert box.lowest == pytest.approx([-8.0, -4.0])
    assert box.highest == pytest.approx([4.0, 6.0])
    area = float(np.abs(measures(mesh.p.T, mesh.t.T)).sum())
    assert area == pytest.approx(12.0 * 4.0 + 8.0 * 2.0 - 2.0 - 2.0, rel=1e-12)  # below, above, air, block
    joint = np.hypot(4.0, 2.0)
    assert surface(mesh) == pytest.approx(12.0 + 4.0 + 6.0 + 4.0 + joint + 4.0, rel=1e-12)
    assert mesh.t.shape[1] < 500
    elements = Elements(mesh, Rock(E, 0.25))
    x, z = elements.basis.doflocs  # of both ends and of the bottom; above them there is air
    held = np.zeros(elements.degrees, dtype=bool)
    held[_far(elements, box)] = True
    far = (np.abs(x + 8.0) < 1e-9) | (np.abs(x - 4.0) < 1e-9) | (np.abs(z + 4.0) < 1e-9)
    assert (held.reshape(-1, 2) == far[:, None]).all()
    assert graded(box.mesh, np.linspace(toe, back, 9), 0.01, 100).t.shape[1] > 100  # given up


def test_a_column_on_rock_of_its_own_width_settles_by_both() -> None:
    """Patch test: the same pressure everywhere is σ h / E under the pairs, exactly."""
    corners = np.array([[x, y, z] for z in (-3.0, 0.0) for x, y in ((0, 0), (2, 0), (2, 1), (0, 1))])
    faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    mesh = split_evenly(mesh_of(corners, cells_of(corners, fanned(faces))), 2.0)
    elements = Elements(mesh, Rock(E, 0.0))
    nodes = elements.basis.get_dofs(lambda x: np.abs(x[2] + 3.0) < 1e-9).all()
    fixed = (3 * nodes[:, None] + np.arange(3)).ravel()
    # the middles of the sides of each triangle on top integrate all that elements of order two can do
    top = mesh.facets[:, np.abs(mesh.p[2, mesh.facets]).max(axis=0) < 1e-9]
    ends = mesh.p.T[top.T]
    points = (0.5 * (ends + np.roll(ends, 1, axis=1))).reshape(-1, 3)
    areas = np.repeat(2.0 / len(ends) / 3.0, len(points))
    axes = local_axes(np.tile([0.0, 0.0, 1.0], (len(points), 1)))
    give = elements.held_at(fixed, points, axes)
    force = np.zeros((len(points), 3))
    force[:, 0] = areas * 100.0
    assert float(force.ravel() @ give @ force.ravel()) == pytest.approx(2.0 * 100.0**2 * 3.0 / E, rel=1e-10)
    moved = (give @ force.ravel()).reshape(-1, 3)
    assert moved[:, 0] == pytest.approx(100.0 * 3.0 / E, rel=1e-10)


def test_what_is_condensed_is_the_solution_of_the_whole() -> None:
    box = box_around({0: np.array([[0.0, 0.0], [-4.0, 2.0]]), 1: np.array([[-2.0, 2.0], [0.0, 0.0]]),
                      2: np.array([[-4.0, 2.0], [-2.0, 2.0]])}, [1, 2], 0.0)  # fmt: skip
    points = np.column_stack([np.linspace(0.0, -4.0, 7), np.zeros(7), np.linspace(0.0, 2.0, 7)])
    axes = local_axes(np.tile([1.0, 0.0, 2.0], (7, 1)) / np.sqrt(5.0))
    mesh = graded(box.mesh, points[:, [0, 2]], 0.7, 10_000)
    found = bedrock(box, mesh, Rock(E, 0.25), points, axes)
    elements = Elements(mesh, Rock(E, 0.25))
    at = sparse.block_diag(list(axes), format="csr") @ elements.shapes(points)
    whole = at @ elements.held(_far(elements, box))(at.T.toarray())
    assert found.by_force == pytest.approx(whole, abs=1e-12 * float(np.abs(whole).max()))
    assert found.degrees == elements.degrees
    assert found.cells == mesh.t.shape[1]


def test_a_load_on_a_half_space() -> None:
    """Flamant's strip (Timoshenko & Goodier, Theory of Elasticity, §37): under a pressure q on a width 2a the middle
    settles by 4 a q ln 2 (1 - ν²) / π E more than the edges; how far the held faces are does not matter."""
    nu, a, parts = 0.25, 1.0, 64
    points, cell = box_of(np.array([-80.0, -80.0]), np.array([80.0, 0.0]))
    cells = [cell]
    for offset in (-a, a):
        points, cells = cut_cells(points, cells, np.eye(2)[0], offset)
    mesh = mesh_of(points, np.concatenate([fanned(cell) for cell in cells]))
    at = np.concatenate([((np.arange(parts) + 0.5) / parts * 2.0 - 1.0) * a, [0.0, -a, a]])
    places = np.column_stack([at, np.zeros(len(at)), np.zeros(len(at))])
    elements = Elements(graded(mesh, places[:, [0, 2]], 0.125, 10_000), Rock(E, nu))
    nodes = elements.basis.get_dofs(lambda x: (np.abs(x[0]) > 79.9) | (x[1] < -79.9)).all()
    axes = local_axes(np.tile([0.0, 0.0, 1.0], (len(at), 1)))
    give = elements.held_at((2 * nodes[:, None] + np.arange(2)).ravel(), places, axes)
    load = np.zeros((len(at), 3))
    load[:parts, 0] = 100.0 * 2.0 * a / parts
    moved = (give @ load.ravel()).reshape(-1, 3)[parts:, 0]
    exact = 4.0 * a * 100.0 * np.log(2.0) * (1.0 - nu**2) / (np.pi * E)
    assert moved[0] - moved[1:].mean() == pytest.approx(exact, rel=5e-3)


def test_displacements_on_nodes_of_both_bodies_give_the_same_forces() -> None:
    """Rest on all displacements of the elements of block and bedrock: no D, nothing condensed."""
    from slopekit.elastic.flexibility import flexibility
    from slopekit.elastic.model import with_blocks
    from slopekit.geometry.sections.section import FACE, UPPER
    from slopekit.kinds import cut
    from slopekit.kinds.elastic_scene import elastic_model

    made = cut(sk.load(PLANE | {"rock": {"density": 2600, "modulus": "0.1 GPa"}}))
    scene, rock = made.scene_at(3), Rock(1e5, 0.25)
    flat = {key: face[face[:, 1] > face[:, 1].mean()][:, [0, 2]] for key, face in made.block.faces.items()
            if np.ptp(face[:, 1]) > 0.0}  # fmt: skip
    points, axes, rows = scene.pairs.points, local_axes(scene.pairs.normals), scene.model.flat_rows
    outline = np.asarray(next(face for face in made.block.faces.values() if np.ptp(face[:, 1]) == 0.0))[:, [0, 2]]
    block = Elements(split_evenly(mesh_of(outline, fanned([range(len(outline))])), 5.0), rock)
    box = box_around(flat, [FACE, UPPER], 0.0)
    mesh = graded(box.mesh, points[:, [0, 2]], 3.0, 10_000)
    model = with_blocks(elastic_model(scene.model), (
        (flexibility(block, points, axes, rows, scene.model.length_scale), np.arange(rows.shape[0]), np.arange(3)),
    ))  # fmt: skip
    model = on_bedrock(model, bedrock(box, mesh, rock, points, axes).by_force)
    stiffness = JointStiffness(normal=1e6, tangential=1e5, debonded=1e-3)
    found = RestSearch(model, stiffness).rest(1.0)
    assert found.stands
    assert found.parted.any()
    ground = Elements(mesh, rock)
    held = _far(ground, box)
    free = np.setdiff1d(np.arange(ground.degrees), held)
    local = sparse.block_diag(list(axes), format="csr")
    shapes = sparse.hstack([local @ block.shapes(points), -(local @ ground.shapes(points))[:, free]]).tocsr()
    stiff = sparse.block_diag([block.stiffness, ground.stiffness[free][:, free]], format="csr")
    load = np.concatenate([block.spread(scene.model.length_scale) @ model.load, np.zeros(len(free))])
    at = np.linalg.lstsq(shapes.toarray(), found.relative.ravel(), rcond=None)[0]
    for _ in range(30):
        relative = (shapes @ at).reshape(-1, 3)
        relative[:, 1:] -= found.memory
        law = tractions(relative, stiffness, model.cohesion, model.tan_friction, model.tan_dilation, 1.0, found.parted)
        off = load + shapes.T @ (law.tractions * model.area[:, None]).ravel() - stiff @ at
        if np.abs(off).max() < 1e-12 * np.abs(load).sum():
            break
        slopes = sparse.block_diag(list(law.slopes * model.area[:, None, None]), format="csr")
        at = at + splu((stiff - shapes.T @ slopes @ shapes).tocsc()).solve(off)
    forces = law.tractions * model.area[:, None]
    assert forces == pytest.approx(found.forces.reshape(-1, 3), abs=1e-8 * float(np.abs(forces).max()))


def turned_by(plane: str, degrees: float) -> str:
    dip, direction = plane.split("/")
    return f"{dip}/{(float(direction) + degrees) % 360.0:g}"


def test_a_wedge_on_elastic_bedrock_and_the_same_turned_moved_scaled() -> None:
    """The oracle of METHOD-2 §10 on elastic bedrock too, and what may not change anything."""
    whole = sk.wedge(**WEDGE, elastic=True)
    base = whole.elastic
    assert base.bedrock == "elastic"
    scene, search, state = state_of(whole)
    last, high = last_rest(search, state, base.limit)
    without = scene.limit_without(last.opened(scene.model))[0]
    assert last.factor * (1.0 - 3e-4) <= without <= high * (1.0 + 3e-4)
    assert base.opened_share > 0.0
    stiff = sk.wedge(**WEDGE | {"bedrock": "rigid"}, elastic=True)
    assert stiff.elastic.bedrock == "rigid"
    assert "rigid bedrock" in str(stiff.sheet)
    assert stiff.elastic.cells < base.cells
    moved = [float(np.linalg.norm(one.displacement_m)) for one in (base, stiff.elastic)]
    assert moved[0] > 1.3 * moved[1]
    turned = WEDGE | {key: turned_by(WEDGE[key], 37.0) for key in ("face", "upper")}
    turned |= {"dips": [turned_by(one, 37.0) for one in WEDGE["dips"]], "origin": (500e3, 4.2e6, 300)}
    turned |= {"height": 90, "c": (72, 144), "modulus": "6 GPa", "edge": "120 m"}  # stresses times 3: strains stay
    found = sk.wedge(**turned, elastic=True)
    assert "elastic bedrock" in str(found.sheet).replace("\n             ", " ")
    assert found.to_dict()["elastic"]["bedrock"] == "elastic"
    assert found.elastic.limit == pytest.approx(base.limit, rel=1e-6)
    assert found.elastic.opened_share == pytest.approx(base.opened_share, rel=1e-6)
    assert float(np.linalg.norm(found.elastic.displacement_m)) == pytest.approx(3.0 * moved[0], rel=1e-5)


def test_rock_that_does_not_give_is_rigid_bedrock() -> None:
    stiff = sk.analyse(replace(sk.load(PLANE), modulus_kpa=1e16), elastic=True).elastic
    joint = stiff.joints["J1"]
    assert stiff.bedrock == "elastic"
    assert joint.elastic_kpa == pytest.approx(joint.rigid_kpa, rel=1e-6)
    assert stiff.displacement_m == pytest.approx(stiff.rigid_displacement_m, rel=1e-6)


def test_where_bedrock_stays_rigid_it_is_refused_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = {"analysis.elastic.bedrock": "elastic"}
    for template in ("topple", "blocks", "footing"):
        with pytest.raises(DesignError) as caught:
            sk.run(f"templates/{template}.yaml", asked | {"rock.density": 2600}, elastic=True)
        assert [fault.code for fault in caught.value.faults] == ["E288"]
    with pytest.raises(DesignError, match="it is rigid or elastic"):
        sk.wedge(("45/115", "45/245"), bedrock="soft")
    monkeypatch.setattr("slopekit.kinds.elastic_scene._MOST_CELLS", 300)
    with pytest.raises(DesignError, match=r"E125 .* of the bedrock"):
        sk.run(PLANE, elastic=True)
