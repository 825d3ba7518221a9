"""Every block of every scene is a closed body; trimesh judges it."""

import numpy as np
import pytest
import trimesh

from slopekit.block_scene import BlockScene
from slopekit.core.orientation import Plane
from slopekit.geometry.rock.bench import bench_body
from slopekit.geometry.rock.joint_sets import JointSet, planes_of_sets
from slopekit.geometry.rock.splitting import cut_bench
from slopekit.geometry.solids.welding import open_edges, welded
from tests.exchange.conftest import TEMPLATES

NAMES = sorted(
    path.stem
    for path in TEMPLATES.glob("*.yaml")
    if path.stem not in ("paper-wedge", "cylinder", "surface")
)


@pytest.mark.parametrize("name", NAMES)
def test_blocks_of_the_templates_are_closed_and_add_up(result, name) -> None:
    """Curved slip surfaces: the body of flat triangles lies within the curve, up to 1 % (6 m edges: 4 %) short."""
    document = result(name)
    shapes = BlockScene.from_dict(document["scene"]).shapes
    moving = 0.0
    for k, block in enumerate(shapes.names):
        vertices, triangles = shapes.solids.block_surface(k)
        mesh = trimesh.Trimesh(vertices - vertices.mean(axis=0), triangles, process=False)
        assert mesh.is_watertight, block
        assert mesh.is_winding_consistent, block
        assert mesh.volume > 0.0, block
        moving += 0.0 if shapes.fixed[k] else mesh.volume
    true = document["geometry"]["volume_m3"]
    if document["kind"] == "surface":
        assert 0.96 * true < moving < true
    else:
        assert moving == pytest.approx(true, rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_joined_slivers_of_random_benches_are_closed(seed) -> None:
    """Scattered sets and a coarse min_volume: many blocks are made up of several cells."""
    rng = np.random.default_rng(seed)
    body = bench_body(Plane(70.0, 180.0).normal(), Plane(5.0, 180.0).normal(), 10.0, 20.0, 10.0)
    sets = [
        JointSet(
            Plane(rng.uniform(20, 89), rng.uniform(0, 360)).normal(),
            rng.uniform(2, 4),
            0.3,
            5.0,
            0.3,
        )
        for _ in range(3)
    ]
    assembly = cut_bench(body, planes_of_sets(sets, body, rng), 20000, 1.0).assembly
    before = open_edges(assembly.triangles, assembly.triangle_block)[1]
    vertices, triangles, block = welded(
        assembly.vertices, assembly.triangles, assembly.triangle_block
    )
    assert len(before) > 0  # else this shows nothing
    assert len(open_edges(triangles, block)[0]) == 0
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volumes = np.bincount(block, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0, len(assembly))
    assert volumes == pytest.approx(assembly.volumes, rel=1e-9)


def test_closed_blocks_stay_as_they_are() -> None:
    box = trimesh.creation.box()
    vertices, triangles = np.asarray(box.vertices), np.asarray(box.faces)
    found = welded(vertices, triangles, np.zeros(len(triangles), dtype=int))
    assert found[0] is vertices
    assert found[1] is triangles
