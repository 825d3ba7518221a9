"""Curved slip surfaces from design to result: files, notices, evidence, and faults with their codes."""

import math
import re

import numpy as np
import pytest
import trimesh

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.reading.files import with_values
from slopekit.design.templates import path_of
from slopekit.exchange.solids import save_gltf
from tests.scenes import (
    COARSE,
    PAPER,
    SLOPE,
    SPHERE,
    ellipsoid_mesh,
    inputs,
    run,
    save,
    sheet,
    slab,
)

CAP = {**PAPER, **COARSE}


def codes(result) -> set[str]:
    return {notice.code for notice in result.warnings}


def test_the_paper_s_ellipsoid() -> None:
    """Volume π h² (3 - h) / 3 of the mapped cap and its weight; 1.3436 ± 0.001; the bound above it."""
    result = run(PAPER)
    h = 1.0 - 1.0 / math.sqrt(2.0)
    assert result.geometry.volume_m3 == pytest.approx(
        40.0 * 40.0 * math.sqrt(800.0) * math.pi * h * h * (3.0 - h) / 3.0, rel=1e-5
    )
    assert result.forces.weight == pytest.approx(21.56 * result.geometry.volume_m3, rel=1e-12)
    assert result.fos.limit == pytest.approx(1.3436, abs=1e-3)
    assert result.fos.static_bound == pytest.approx(1.65, abs=0.01)  # cases.json 6a: SOCP, ~1.65
    assert result.status == "rotates"
    assert result.geometry.motions == 1
    pairs = result.limit_state.node_pairs
    assert pairs.control_area_m2.sum() == pytest.approx(
        result.geometry.areas_m2["slip surface"], rel=1e-9
    )
    assert not codes(result)


@pytest.mark.slow
def test_the_sphere_of_hungr() -> None:
    """φ = 0: 1.4016 ± 0.0005 (Hungr, Salgado & Byrne 1989: 1.402), agreeing with the closed form."""
    slip = {"shape": "sphere", "centre": [0, 0, 0], "radius": 10}
    result = run(slip, [[30, -20.5901699], [-30, 9.4098301]], c=20.0, phi=0.0, unit_weight=20.0)
    assert result.fos.limit == pytest.approx(1.4016, abs=5e-4)
    assert result.fos.limit == pytest.approx(result.fos.closed_form, rel=1e-5)
    assert result.agree
    with_friction = run(
        slip, [[30, -20.5901699], [-30, 9.4098301]], c=20.0, phi=20.0, unit_weight=20.0
    )
    assert with_friction.fos.limit == pytest.approx(2.673, abs=1e-3)


@pytest.mark.parametrize("suffix", ["stl"])
def test_a_mesh_of_the_ellipsoid(tmp_path, suffix) -> None:
    """Within 1e-3 of the true surface; single precision does no harm near the origin."""
    path = save(tmp_path / f"slip.{suffix}", ellipsoid_mesh(4))
    result = run({"mesh": str(path)})
    assert result.fos.limit == pytest.approx(1.34355, abs=1e-3)
    assert 0.0 < result.geometry.misfit_deg < 0.02


def test_a_sheet_and_the_closed_mesh_of_the_same_surface(tmp_path) -> None:
    """The lower half of the ellipsoid as a sheet: the same mass; its rim has normals from one side only (1e-3)."""
    vertices, triangles = ellipsoid_mesh(4)
    lower = triangles[(vertices[triangles][:, :, 2] <= 40.0 + 1e-9).all(axis=1)]
    used, lower = np.unique(lower, return_inverse=True)
    half = vertices[used], lower.reshape(-1, 3)
    closed = run({"mesh": str(save(tmp_path / "body.obj", (vertices, triangles)))})
    for k, turned in enumerate((half, (half[0], half[1][:, ::-1]))):
        open_ = run({"mesh": str(save(tmp_path / f"sheet{k}.obj", turned))})
        assert open_.geometry.volume_m3 == pytest.approx(closed.geometry.volume_m3, rel=1e-9)
        assert open_.fos.limit == pytest.approx(closed.fos.limit, rel=1e-3)


def test_the_ground_as_a_mesh(tmp_path) -> None:
    """The same slope as a profile and as a closed mesh, right way round or not: to rounding."""
    vertices, triangles = slab(SLOPE, 60.0, -20.0, (-60.0, 100.0))
    plain = run(CAP)
    for k, faces in enumerate((triangles, triangles[:, ::-1])):
        path = save(tmp_path / f"slope{k}.obj", (vertices, faces))
        found = run(CAP, path)
        assert found.fos.limit == pytest.approx(plain.fos.limit, rel=1e-7)


def test_steps_and_ledges() -> None:
    """A vertical step is the limit of a steep one; a ledge has no columns, and an answer all the same."""
    step = [[60, 0], [30, 0], [30, 30], [-20, 30]]
    nearly = [[60, 0], [30.001, 0], [30, 30], [-20, 30]]
    ledge = [[60, 5], [25, 5], [30, 20], [15, 20], [20, 40], [-20, 40]]
    assert run(CAP, step).fos.limit == pytest.approx(run(CAP, nearly).fos.limit, rel=1e-4)
    result = run(CAP, ledge)
    assert result.fos.limit
    assert result.methods == {}
    assert "W324" in codes(result)
    assert run(CAP, ledge[::-1]).fos.limit == pytest.approx(result.fos.limit, rel=1e-6)
    assert run(SPHERE | COARSE, ledge, phi=0.0).fos.closed_form is None


def test_nothing_drives_it() -> None:
    """Level ground: a status, no number, and no word on motions that nothing asks for."""
    result = run(SPHERE | COARSE | {"centre": [0, 0, 20]}, [[-60, 0], [60, 0]])
    assert result.status == "no_driving_force"
    assert result.fos.limit is None
    assert "W325" not in codes(result)


@pytest.mark.slow
def test_normals_that_were_turned_are_reported() -> None:
    """An ellipsoid of three axes lets no motion through: W325."""
    three = run({"shape": "ellipsoid", "centre": [40, 0, 40], "radii": [44, 30, 39], **COARSE})
    assert "W325" in codes(three)
    assert three.geometry.misfit_deg > 0.5


@pytest.mark.parametrize("dilation", [0.5, 25.0])
def test_a_curved_surface_does_not_dilate(dilation) -> None:
    """The limit is that without dilation, and the sheet says so (W310)."""
    plain, dilating = (
        sk.run(path_of("sphere"), set={"strength.clay": {"c": 20, "phi": 25, "dilation": given}})
        for given in (0.0, dilation)
    )
    assert dilating.fos.limit == plain.fos.limit
    assert ("W310" in codes(dilating), "W310" in codes(plain)) == (True, False)


def test_a_mass_that_lifts_off_as_it_begins_to_move_says_so() -> None:
    """Pushed aside, the paper's ellipsoid rides up: W307 names the share that lost its cohesion, near c = 0."""
    loads = {"seismic": {"k": 0.2, "toward": 0}}
    result, without = run(CAP, loads=loads), run(CAP, c=0.0, loads=loads)
    assert "W307" in codes(result)
    assert result.fos.limit == pytest.approx(without.fos.limit, rel=0.02)
    assert "W307" not in codes(without)


def test_pieces_are_reported() -> None:
    slope = [[-5, 20], [20, 30], [38, -8], [42, -8], [60, 25], [90, 20]]
    result = run(SPHERE | COARSE, slope)
    assert "W322" in codes(result)
    assert sum(result.geometry.pieces_m3) > 0.0


def test_map_coordinates() -> None:
    """The profile 500 km east: the same factor, corners in the user's coordinates."""
    far = [[x + 5e5, z] for x, z in SLOPE]
    plain, moved = run(CAP), run({**CAP, "centre": [500040, 4e6, 40]}, far)
    assert moved.fos.limit == pytest.approx(plain.fos.limit, rel=1e-7)
    assert moved.geometry.centroid_m - [5e5, 4e6, 0] == pytest.approx(
        plain.geometry.centroid_m, abs=1e-6
    )
    assert moved.limit_state.node_pairs.points_m.min(axis=0)[1] > 3.9e6


def slip_at(offset, tmp_path, suffix: str):
    """The result of an ellipsoid 80 m long, its mesh and that of the ground moved by `offset`."""
    (vertices, triangles), (points, faces) = (
        ellipsoid_mesh(3),
        slab(SLOPE, 60.0, -20.0, (-60.0, 100.0)),
    )
    slip = save(tmp_path / f"slip.{suffix}", (vertices + offset, triangles))
    return run({"mesh": str(slip)}, save(tmp_path / "slope.obj", (points + offset, faces)))


def test_a_mesh_file_of_single_precision_at_map_coordinates(tmp_path) -> None:
    """float32 keeps 7 digits: 5e5 m is rounded to 0.03125 m, which moves the factor less than a thousandth."""
    offset = np.array([5e5, 1e3, 1e3])
    single, double = (slip_at(offset, tmp_path, suffix).fos.limit for suffix in ("stl", "obj"))
    assert single != double
    assert single == pytest.approx(double, rel=1e-3)


@pytest.mark.parametrize("suffix", ["stl", "ply", "glb"])
def test_map_coordinates_that_single_precision_spoils_are_refused(tmp_path, suffix) -> None:
    """4e6 m is rounded to 0.25 m, more than a thousandth of 80 m."""
    with pytest.raises(
        DesignError, match=r"single precision \(float32\), which rounds them to 0\.25 m"
    ) as error:
        slip_at(np.array([5e5, 4e6, 1e3]), tmp_path, suffix)
    assert error.value.faults[0].code == "E172"
    assert error.value.faults[0].advice.startswith("Shift the origin")


@pytest.mark.parametrize(("slip_suffix", "slope_suffix"), [("obj", "glb"), ("gltf", "obj")])
def test_slip_and_ground_of_gltf_are_y_up(tmp_path, slip_suffix, slope_suffix) -> None:
    """The factor of the same files as OBJ, with float32; read as z-up the mass was another one, or none."""
    cap, ground = ellipsoid_mesh(3), slab(SLOPE, 60.0, -20.0, (-60.0, 100.0))
    plain = run({"mesh": str(save(tmp_path / "a.obj", cap))}, save(tmp_path / "b.obj", ground))
    paths = []
    for name, suffix, (vertices, triangles) in (
        ("slip", slip_suffix, cap),
        ("slope", slope_suffix, ground),
    ):
        x, y, z = vertices.T
        body = (vertices if suffix == "obj" else np.stack([x, z, -y], axis=1), triangles)
        path = tmp_path / f"{name}.{suffix}"
        if suffix == "gltf":
            save_gltf(trimesh.Scene(trimesh.Trimesh(*body, process=False)), path)
        else:
            save(path, body)
        paths.append(path)
    result = run({"mesh": str(paths[0])}, paths[1])
    assert result.fos.limit == pytest.approx(plain.fos.limit, rel=1e-3)
    assert result.geometry.centroid_m == pytest.approx(plain.geometry.centroid_m, abs=1e-3)
    assert (f"mesh slip.{slip_suffix} (y is up there)" in str(result.sheet)) == (
        slip_suffix != "obj"
    )
    assert (f"ground mesh slope.{slope_suffix} (y is up there)" in str(result.sheet)) == (
        slope_suffix != "obj"
    )


@pytest.mark.parametrize("length", [0.5, 1.0, 30.0])
def test_a_cylinder_is_the_same_at_any_length(length) -> None:
    slip = {"shape": "cylinder", "centre": [40, 40], "radius": 42, "length": length, "edge": 6}
    result = run(slip, phi=0.0)
    assert result.fos.limit == pytest.approx(result.fos.closed_form, rel=1e-4)
    assert result.agree


def meshes(tmp_path) -> dict:
    ball = (5.0, 5.0, 5.0)
    vertices, triangles = ellipsoid_mesh(3)
    return {
        "in the ground": {"mesh": save(tmp_path / "a.obj", ellipsoid_mesh(3, ball, (-10, 0, 5)))},
        "in the air": {"mesh": save(tmp_path / "b.obj", ellipsoid_mesh(3, ball, (60, 0, 60)))},
        "sheet too short": {"mesh": save(tmp_path / "c.obj", sheet(30.0, 20.0, 60.0))},
        "body with a hole": {"mesh": save(tmp_path / "d.obj", (vertices, triangles[1:]))},
        "upright sheet": {"mesh": save(tmp_path / "e.obj", sheet(90.0, 20.0, 60.0))},
        "sphere in the ground": {"shape": "sphere", "centre": [-10, 0, 5], "radius": 5},
        "sphere in the air": {"shape": "sphere", "centre": [60, 0, 60], "radius": 5},
    }


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("in the ground", "E214"),
        ("in the air", "E214"),
        ("sheet too short", "E215"),
        ("body with a hole", "E216"),
        ("upright sheet", "E216"),
        ("sphere in the ground", "E214"),
        ("sphere in the air", "E214"),
    ],
)
def test_faults_of_the_slip_surface(tmp_path, name, code) -> None:
    slip = meshes(tmp_path)[name]
    if "mesh" in slip:
        slip = {"mesh": str(slip["mesh"])}
    with pytest.raises(sk.GeometryError) as caught:
        run(slip)
    assert caught.value.codes == (code,)


def test_faults_of_the_ground(tmp_path) -> None:
    vertices, triangles = slab(SLOPE, 60.0, -20.0, (-60.0, 100.0))
    with pytest.raises(sk.GeometryError) as caught:
        run(CAP, save(tmp_path / "slope.obj", (vertices, triangles[1:])))
    assert caught.value.codes == ("E216",)
    with pytest.raises(sk.GeometryError) as caught:
        run(CAP, [[60, 0], [0, 40], [40, 40], [20, 0]])
    assert caught.value.codes == ("E218",)


@pytest.mark.parametrize("content", [b"", b"hello", b"solid x\nendsolid x\n"])
def test_files_that_are_no_mesh(tmp_path, content) -> None:
    path = tmp_path / "slip.stl"
    path.write_bytes(content)
    with pytest.raises(sk.DesignError) as caught:
        run({"mesh": str(path)})
    assert caught.value.codes == ("E172",)


def test_json_has_the_surface_and_every_number_is_finite() -> None:
    import json

    text = json.dumps(run(CAP).to_dict(), allow_nan=False)
    assert json.loads(text)["geometry"]["slip_motions"] == 1
    assert sk.load(inputs(CAP)).kind == "surface"


@pytest.mark.parametrize("x", [4000.0, -4000.0])
def test_a_mass_beyond_the_profile_is_no_slope(x) -> None:
    """It stood, and met its rule, on level ground that nobody has described."""
    design = with_values(sk.load(path_of("surface")), {"slip.centre": [x, 0, 40]})
    with pytest.raises(sk.GeometryError) as caught:
        sk.analyse(design)
    assert caught.value.codes == ("E551",)
    low, high = (
        float(one)
        for one in re.findall(
            r"x (\S+) to (\S+) m, the profile goes from -30.000 to 60.000 m",
            caught.value.faults[0].message,
        )[0]
    )
    assert x - 44.0 <= low < x < high <= x + 44.0
