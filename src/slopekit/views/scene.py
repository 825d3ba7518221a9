"""Pictures of the wedge in its slope (pyvista, off-screen). Needs the extra `plot`."""

from pathlib import Path
from typing import Any

import numpy as np

from slopekit.arrays import Floats
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import DesignError, Fault
from slopekit.extents import WedgeGeometry
from slopekit.result import Result

_SIZE = (1400, 1000)


def wedge_picture(result: Result, path: Path) -> None:
    """Draw the wedge, moved a little along its mechanism, in front of its joints and the slope; write a PNG.

    Raises
    ------
    DesignError
        E140 where pyvista is not installed.
    """
    try:
        import pyvista
    except ImportError:
        advice = "In slopekit's folder: pip install '.[plot]'"
        raise DesignError([Fault("E140", "drawing needs the extra plot (pyvista)", str(path), advice)]) from None
    pyvista.vtk_verbosity("off")
    draw: Any = pyvista.Plotter(off_screen=True, window_size=list(_SIZE))
    design, geometry, mechanism = result.design, result.geometry, result.mechanism
    if not isinstance(design, WedgeDesign) or not isinstance(geometry, WedgeGeometry):
        message = f"a {result.kind} is not drawn yet, a wedge is"
        raise DesignError([Fault("E173", message, str(path), "Leave --picture out.")])
    toe = np.asarray(geometry.corners_m["toe"])
    corners = {name: np.asarray(point) - toe for name, point in geometry.corners_m.items()}
    size = float(np.ptp(np.array(list(corners.values())), axis=0).max())
    wedge = _surface(pyvista, [np.asarray(polygon) - toe for polygon in geometry.faces_m.values()])
    moved = wedge if mechanism is None else wedge.translate(0.12 * size * np.asarray(mechanism.displacement))
    draw.set_background("white")
    draw.add_mesh(moved, color="#d9a066", label="wedge" if mechanism is None else "wedge, moved as it fails")
    draw.add_mesh(moved.extract_feature_edges(1), color="#5b3a1a", line_width=3)
    for joint, (name, colour) in enumerate((("J1", "#4c78a8"), ("J2", "#59a14f"))):
        patch = _surface(pyvista, [np.asarray(geometry.faces_m[name]) - toe])
        draw.add_mesh(patch, color=colour, opacity=0.75, label=f"{name} {design.joints[joint]}")
    draw.add_mesh(_slope(pyvista, design, corners, size), color="#bbbbbb", opacity=0.35, label="face and upper slope")
    if mechanism is not None:
        start = (
            np.asarray(geometry.faces_m["face"]).mean(axis=0) - toe + 0.12 * size * np.asarray(mechanism.displacement)
        )
        arrow = pyvista.Arrow(start=start, direction=mechanism.displacement, scale=0.35 * size)
        draw.add_mesh(arrow, color="#c0392b", label="movement")
    north = pyvista.Arrow(start=(0.75 * size, -0.45 * size, 0.0), direction=(0, 1, 0), scale=0.25 * size)
    draw.add_mesh(north, color="black", label="north")
    fos = result.criterion_fos
    factor = "no factor of safety" if fos is None else f"FoS {fos:.4f}"
    title = f"J1 {design.joints[0]}   J2 {design.joints[1]}   {factor}   {result.status_text}"
    scale = f"volume {geometry.volume_m3:.6g} m³, total height {geometry.total_height_m:.6g} m"
    draw.add_text(title, position="upper_left", font_size=13, color="black")
    draw.add_text(scale, position="lower_left", font_size=10, color="black")
    draw.add_legend(bcolor="white", border=True, size=(0.24, 0.2), loc="lower right")
    view = np.radians(design.face.dip_direction_deg) + 0.6
    middle = np.mean(list(corners.values()), axis=0)
    eye = middle + 2.4 * size * np.array([np.sin(view), np.cos(view), 0.7])
    draw.camera_position = [tuple(eye), tuple(middle), (0, 0, 1)]
    draw.screenshot(str(path))
    draw.close()


def _surface(pyvista: Any, polygons: list[Floats]) -> Any:
    """Flat polygons as one surface."""
    faces, first = [], 0
    for polygon in polygons:
        faces += [len(polygon), *range(first, first + len(polygon))]
        first += len(polygon)
    return pyvista.PolyData(np.concatenate(polygons), faces=faces)


def _slope(pyvista: Any, design: WedgeDesign, corners: dict[str, Floats], size: float) -> Any:
    """The face below the crest and the upper slope behind it, as two sheets as wide as the scene."""
    crest = corners["crest_J2"] - corners["crest_J1"]
    along = crest / np.sqrt(crest @ crest)
    middle = (corners["crest_J1"] + corners["crest_J2"]) / 2
    ends = [middle - 0.7 * size * along, middle + 0.7 * size * along]
    down = _down_dip(design.face.normal())
    up = -_down_dip(design.upper.normal())
    reach = float(np.sqrt(corners["crest_J1"] @ corners["crest_J1"]))
    sheets = np.array(
        [
            ends[0],
            ends[1],
            ends[1] + reach * down,
            ends[0] + reach * down,
            ends[1] + 0.9 * size * up,
            ends[0] + 0.9 * size * up,
        ]
    )
    return pyvista.PolyData(sheets, faces=[4, 0, 1, 2, 3, 4, 0, 1, 4, 5])


def _down_dip(normal: Floats) -> Floats:
    flat = float(np.hypot(normal[0], normal[1]))
    if flat < 1e-12:
        return np.array([0.0, -1.0, 0.0])
    return np.array([normal[0] * normal[2] / flat, normal[1] * normal[2] / flat, -flat])
