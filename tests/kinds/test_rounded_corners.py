"""Blocks whose corners a file rounds: to decimals, to single precision, in another unit; tan φ / tan β by hand."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
import trimesh

import slopekit as sk
from slopekit.core.errors import DesignError, GeometryError

PHI = 40.0
QUADS = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
TRIANGLES = np.array([quad[:3] for quad in QUADS] + [[quad[0], *quad[2:]] for quad in QUADS])


def rectangle(x: float, z: float, wide: float, high: float):
    return np.array([[x, z], [x + wide, z], [x + wide, z + high], [x, z + high]])


def stack(rng, courses: int):
    """The outlines, upright, of a base and of blocks that lie on it one upon the other, each of its own size."""
    low, blocks = 0.0, {"base": rectangle(-8.0, -4.0, 30.0, 4.0)}
    for course in range(courses):
        high = 0.8 + rng.random()
        blocks[f"B{course}"] = rectangle(0.2 * rng.random(), low, 3.0 + rng.random(), high)
        low += high
    return blocks


def on_incline(outlines, dip_deg: float, shift):
    c, s = math.cos(math.radians(dip_deg)), math.sin(math.radians(dip_deg))
    return {
        name: outline @ np.array([[c, -s], [s, c]]) + shift for name, outline in outlines.items()
    }


def factor(dip_deg: float) -> float:
    return math.tan(math.radians(PHI)) / math.tan(math.radians(dip_deg))


def run_sections(outlines, **more):
    blocks = {name: {"polygon": outline.tolist()} for name, outline in outlines.items()}
    blocks["base"]["fixed"] = True
    return sk.run(
        {
            "slopekit": 1,
            "kind": "blocks",
            "rock": {"unit_weight": 25},
            "blocks": blocks,
            "strength": {"joint": {"c": 0, "phi": PHI}},
            **more,
        }
    )


@cache
def exact_sections(seed: int) -> tuple[float, Any, float]:
    """The dip, the outlines, and the length of contact that they have before they are rounded."""
    rng = np.random.default_rng(seed)
    dip = 20.0 + 15.0 * rng.random()
    exact = on_incline(stack(rng, 1 + seed % 3), dip, 20.0 * rng.random(2))
    return dip, exact, run_sections(exact).findings.checks["contact_length_m"]


@pytest.mark.parametrize("decimals", [2, 3, 4])
@pytest.mark.parametrize("seed", [0, 2, 5])
def test_sections_whose_corners_are_rounded(seed, decimals) -> None:
    """√2 units of the last decimal: both corners moved by half a unit along x and along z, apart or together."""
    (dip, exact, length), unit = exact_sections(seed), 10.0**-decimals
    result = run_sections({name: outline.round(decimals) for name, outline in exact.items()})
    assert result.status == "slides"
    assert result.fos.limit == pytest.approx(factor(dip), rel=0.5 * unit)
    checks = result.findings.checks
    assert len(result.geometry.contacts) == len(exact) - 1
    if "corner_rounding_m" in checks:
        assert checks["corner_rounding_m"] == unit
        assert checks["contact_tolerance_m"] == pytest.approx(math.sqrt(2.0) * unit)
        assert f"corner rounding {unit:g} m" in " ".join(result.sheet.full.split())
        assert result.to_dict()["assembly"]["checks"]["corner_rounding_m"] == unit
    else:
        assert decimals == 4  # where 1e-5 of the blocks found every contact
    assert checks["contact_length_m"] == pytest.approx(length, abs=0.02)


def save_mesh(path, vertices, decimals: int | None):
    if path.suffix == ".obj":
        shown = (lambda x: repr(float(x))) if decimals is None else (lambda x: f"{x:.{decimals}f}")
        lines = [f"v {' '.join(map(shown, vertex))}" for vertex in vertices]
        lines += [f"f {' '.join(str(k + 1) for k in quad)}" for quad in QUADS]
        path.write_text("\n".join(lines), encoding="utf-8")
        return
    mesh = trimesh.Trimesh(
        vertices if decimals is None else vertices.round(decimals), TRIANGLES, process=False
    )
    if decimals is None:
        mesh.export(path)
    else:
        path.write_text(trimesh.exchange.stl.export_stl_ascii(mesh), encoding="utf-8")


def run_meshes(
    folder, suffix: str, dip: float, shift, decimals: int | None = None, courses: int = 2
):
    """Boxes 2 to 3 m long on an incline that dips toward some azimuth."""
    rng = np.random.default_rng(7)
    turn = trimesh.transformations.euler_matrix(0.0, math.radians(dip), 0.7, "sxyz")[:3, :3]
    files = {}
    for name, outline in stack(rng, courses).items():
        deep = (-9.0, 11.0) if name == "base" else (0.0, 2.5)
        (x0, z0), (x1, z1) = outline[0], outline[2]
        corners = [
            [x, y, z]
            for z in (z0, z1)
            for x, y in ((x0, deep[0]), (x1, deep[0]), (x1, deep[1]), (x0, deep[1]))
        ]
        files[name] = folder / f"{name}{suffix}"
        save_mesh(files[name], np.array(corners) @ turn.T + shift, decimals)
    blocks = {name: {"mesh": str(file), "up": "z"} for name, file in files.items()}
    blocks["base"]["fixed"] = True
    return sk.run(
        {
            "slopekit": 1,
            "kind": "blocks",
            "rock": {"unit_weight": 25},
            "blocks": blocks,
            "strength": {"joint": {"c": 0, "phi": PHI}},
        }
    )


@pytest.mark.parametrize(("suffix", "decimals"), [(".obj", 2), (".obj", 4), (".stl", 3)], ids=str)
def test_meshes_whose_corners_are_rounded(tmp_path, suffix, decimals) -> None:
    result = run_meshes(tmp_path, suffix, 33.0, np.array([7.1, -3.3, 2.2]), decimals)
    unit = 10.0**-decimals
    assert result.fos.limit == pytest.approx(factor(33.0), rel=max(0.2 * unit, 1e-4))
    checks = result.findings.checks
    assert checks["corner_rounding_m"] == unit
    assert checks["contact_tolerance_m"] == pytest.approx(math.sqrt(3.0) * unit)


@pytest.mark.parametrize("suffix", [".stl", ".glb", ".obj"])
def test_meshes_of_single_precision_far_from_the_origin(tmp_path, suffix) -> None:
    """At 5000 m single precision holds 0.5 mm, more than 1e-5 of the blocks; a text holds every digit."""
    result = run_meshes(tmp_path, suffix, 33.0, np.array([5000.3, -3000.7, 100.1]))
    assert result.fos.limit == pytest.approx(factor(33.0), rel=2e-4)
    assert result.findings.checks.get("corner_rounding_m") == (
        None if suffix == ".obj" else 2.0**-11
    )


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".glb"])
@pytest.mark.parametrize(
    ("shift", "held"), [((512300.0, 0.0, 0.0), "0.031 m"), ((512300.0, 4187650.0, 0.0), "0.25 m")]
)
def test_map_coordinates_in_single_precision_are_refused(tmp_path, suffix, shift, held) -> None:
    with pytest.raises(
        DesignError, match=rf"single precision \(float32\), which rounds them to {held}"
    ) as error:
        run_meshes(tmp_path, suffix, 33.0, np.array(shift))
    assert {fault.code for fault in error.value.faults} == {"E172"}
    assert "Shift the origin" in error.value.faults[0].advice


def test_map_coordinates_in_the_nodes_of_a_glb_lose_nothing(tmp_path) -> None:
    """The vertices lie near the origin, and the matrix of their node, in doubles, moves them."""
    blocks = {}
    slope = trimesh.transformations.rotation_matrix(math.radians(-33.0), [1, 0, 0])
    place = trimesh.transformations.translation_matrix([512300.0, 4187650.0, 120.0])
    for name, size, up in (("base", (30.0, 30.0, 4.0), -2.0), ("B", (3.0, 2.0, 1.0), 0.5)):
        body = trimesh.creation.box(
            size, trimesh.transformations.translation_matrix([0, 0, up])
        ).apply_transform(slope)
        scene = trimesh.Scene()
        scene.add_geometry(body, transform=place)
        scene.export(tmp_path / f"{name}.glb")
        blocks[name] = {"mesh": str(tmp_path / f"{name}.glb"), "up": "z", "fixed": name == "base"}
    design = {"slopekit": 1, "kind": "blocks", "rock": {"unit_weight": 25}, "blocks": blocks}
    result = sk.run(design | {"strength": {"joint": {"c": 0, "phi": PHI}}})
    assert result.fos.limit == pytest.approx(factor(33.0), rel=1e-6)


def test_map_coordinates_of_single_precision_in_a_text_are_refused(tmp_path) -> None:
    """A program of single precision writes 512303.906250: the digits after the fifth are none."""
    corners = [
        [x, y, z] for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0))
    ]
    vertices = np.array(corners) @ [[0.8, 0.1, 0.6], [0, 1, 0.1], [-0.6, 0, 0.8]]
    vertices = (
        (vertices + np.array([512300.0, 4187650.0, 120.0])).astype(np.float32).astype(np.float64)
    )
    save_mesh(tmp_path / "B.obj", vertices, 6)
    (tmp_path / "base.obj").write_text(
        (tmp_path / "B.obj").read_text(encoding="utf-8"), encoding="utf-8"
    )
    blocks = {name: {"mesh": str(tmp_path / f"{name}.obj")} for name in ("base", "B")}
    blocks["base"]["fixed"] = True
    with pytest.raises(DesignError, match=r"E172 the mesh B\.obj .* in single precision"):
        sk.run(
            {
                "slopekit": 1,
                "kind": "blocks",
                "rock": {"unit_weight": 25},
                "blocks": blocks,
                "strength": {"joint": {"c": 0, "phi": PHI}},
            }
        )


@pytest.mark.parametrize("binary", [False, True])
def test_drawings_in_millimetres_and_inches_say_so(tmp_path, binary) -> None:
    """A DXF in mm to whole millimetres, and one in inches to 1 decimal: 2.54 mm."""
    ezdxf = pytest.importorskip("ezdxf")
    for units, name, length, decimals in ((4, "millimeters", 1e-3, 0), (1, "inches", 0.0254, 1)):
        blocks = {}
        outlines = on_incline(stack(np.random.default_rng(3), 1), 33.0, np.array([4.3, 1.7]))
        for block, outline in outlines.items():
            deep = (-5.0, 5.0) if block == "base" else (0.0, 2.0)
            corners = np.array([[x, y, z] for y in deep for x, z in outline])[
                [0, 1, 5, 4, 3, 2, 6, 7]
            ]
            drawing = ezdxf.new("R2000", units=units)
            mesh = ezdxf.render.MeshBuilder()
            mesh.add_mesh(vertices=(corners / length).round(decimals).tolist(), faces=QUADS)
            mesh.render_polyface(drawing.modelspace())
            file = tmp_path / f"{block}-{name}.dxf"
            drawing.saveas(file, fmt="bin" if binary else "asc")
            blocks[block] = {"mesh": str(file), "fixed": block == "base"}
        result = sk.run(
            {
                "slopekit": 1,
                "kind": "blocks",
                "rock": {"unit_weight": 25},
                "blocks": blocks,
                "strength": {"joint": {"c": 0, "phi": PHI}},
            }
        )
        assert result.fos.limit == pytest.approx(factor(33.0), rel=1e-3)
        assert result.findings.checks["corner_rounding_m"] == pytest.approx(
            length * 10.0**-decimals
        )
        assert f"B0-{name}.dxf ($INSUNITS {name}, scaled to m)" in " ".join(str(result).split())


def test_contacts_that_depend_on_the_tolerance_are_named() -> None:
    """A gap of 1 mm: lost with a third of 2 mm, gained with three times 0.5 mm, neither within 0.9 mm and 3 mm."""
    outlines = on_incline(
        {"base": rectangle(-3, -1, 9, 1), "B": rectangle(0, 0, 2, 1), "C": rectangle(2, 0, 2, 1)},
        20.0,
        np.zeros(2),
    )
    outlines["C"] = outlines["C"] + 0.001 * np.array(
        [math.cos(math.radians(20.0)), -math.sin(math.radians(20.0))]
    )
    expected = {
        "2 mm": "with a third of the contact tolerance (2 mm) contacts are lost: B/C",
        "0.5 mm": "with three times the contact tolerance (0.5 mm) contacts are gained: B/C",
        "0.1 mm": None,
        "5 mm": None,
    }
    for tolerance, message in expected.items():
        said = [
            notice.message
            for notice in run_sections(outlines, contact_tolerance=tolerance).warnings
        ]
        assert [words for words in said if words.startswith("with ")] == (
            [message] if message else []
        )


def test_a_thin_seam_is_not_closed_across() -> None:
    """A seam 10 mm thick in coordinates of 2 decimals: the blocks above and below it do not touch each other."""
    seam = {
        "base": rectangle(-3, -1, 9, 1),
        "seam": rectangle(0, 0, 2, 0.01),
        "B": rectangle(0, 0.01, 2, 1),
    }
    result = run_sections(seam)
    assert len(result.geometry.contacts) == 2
    assert "corner_rounding_m" not in result.findings.checks


def test_rounding_that_leaves_no_contact_is_refused() -> None:
    """Corners to 1 decimal leave nothing to judge; the message names the gap."""
    exact = on_incline(stack(np.random.default_rng(0), 1), 31.0, np.zeros(2))
    exact["B0"] = exact["B0"] + np.array([0.01, 0.02])
    with pytest.raises(GeometryError, match=r"E257 B0 has no contact") as error:
        run_sections(exact)
    assert "base and B0 are 22.3 mm apart" in error.value.faults[0].advice
