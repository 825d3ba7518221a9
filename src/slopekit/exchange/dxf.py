"""DXF with ezdxf (extra `cad`): blocks as polyface meshes, which CAD and mining programs read; metres, doubles."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.block_scene import Bolts
from slopekit.bolts import nearest
from slopekit.exchange.bodies import (
    WrittenBlock,
    block_bodies,
    line_of_intersection,
    mechanism_state,
)
from slopekit.exchange.solids import Files
from slopekit.exchange.source import ExportSource

_MOST_INDEX = 32_767  # vertices of a polyface mesh: indices are 16-bit
# layers of bedrock, of blocks that stand and of those that move; AutoCAD's index of the colour of each
_STATES = (("BLOCKS-BEDROCK", 8), ("BLOCKS-STABLE", 41), ("BLOCKS-MOVING", 30))
_OUTLINES, _LINE, _BOLTS = ("OUTLINES", 7), ("LINE-OF-INTERSECTION", 1), ("BOLTS", 2)
_NOT_IN_NAMES = re.compile(r"[<>/\\\":;?*|=`,]")  # of layers


def write_dxf(path: Path, source: ExportSource) -> Files:
    """One polyface mesh a block, lines and points for bolts.

    Of a bolt, on the layer BOLTS: a point at its head with its number as a text beside
    it, and a line to its end, to the millimetre; number, force (kN) and how it acts are XDATA of the point.

    Layers: BLOCKS-MOVING (in a mechanism), BLOCKS-STABLE, BLOCKS-BEDROCK; OUTLINES of a section;
    LINE-OF-INTERSECTION of a wedge. The block's name is XDATA of the application SLOPEKIT.
    """
    import ezdxf
    from ezdxf import units

    drawing = ezdxf.new("R2000", units=units.M)
    drawing.header["$MEASUREMENT"] = 1
    drawing.appids.add("SLOPEKIT")
    space = drawing.modelspace()
    layers = drawing.layers

    def layer(name: str, colour: int) -> str:
        name = _NOT_IN_NAMES.sub("_", name)
        if name not in layers:
            layers.add(name, color=colour)
        return name

    scene = source.scene
    for body in block_bodies(scene):
        _add_block(space, body, layer(*_STATES[mechanism_state(scene, body)]))
        if source.is_section:
            _add_outline(space, body, layer(*_OUTLINES))
    if (line := line_of_intersection(scene)) is not None:
        space.add_line(*line.tolist(), dxfattribs={"layer": layer(*_LINE)})
    if scene.bolts is not None:
        _add_bolts(space, scene.bolts, layer(*_BOLTS))
    corners = scene.shapes.solids.vertices
    low, high = corners.min(axis=0), corners.max(axis=0)
    drawing.header["$EXTMIN"], drawing.header["$EXTMAX"] = tuple(low.tolist()), tuple(high.tolist())
    drawing.set_modelspace_vport(
        height=1.5 * float((high - low)[:2].max()), center=tuple(((low + high) / 2)[:2])
    )
    drawing.saveas(path)
    return [path], "text, every digit of a double; $INSUNITS metres"


def _add_block(space: Any, body: WrittenBlock, layer: str) -> None:
    attributes = {"layer": layer}
    corners = body.vertices[body.triangles].tolist()
    if len(body.vertices) > _MOST_INDEX:
        for a, b, c in corners:
            space.add_3dface((a, b, c, c), dxfattribs=attributes)
        return
    mesh = space.add_polyface(dxfattribs=attributes)
    mesh.append_faces(corners, dxfattribs=attributes)
    mesh.set_xdata("SLOPEKIT", [(1000, body.name[:255])])


def _add_bolts(space: Any, bolts: Bolts, layer: str) -> None:
    attributes = {"layer": layer}
    height = min(0.3, 0.25 * nearest(bolts.heads_m))  # m: numbers do not lie on each other
    for k in range(len(bolts)):
        head, end = (
            [round(coordinate, 3) for coordinate in place[k].tolist()]
            for place in (bolts.heads_m, bolts.ends_m)
        )
        point = space.add_point(head, dxfattribs=attributes)
        acts = "passive" if bolts.passive[k] else "active"
        number = int(bolts.number[k])
        point.set_xdata(
            "SLOPEKIT",
            [
                (1000, f"bolt {number}"),
                (1070, number),
                (1040, float(bolts.force_kn[k])),
                (1000, acts),
            ],
        )
        space.add_line(head, end, dxfattribs=attributes)
        space.add_text(str(number), height=height, dxfattribs=attributes).dxf.insert = head


def _add_outline(space: Any, body: WrittenBlock, layer: str) -> None:
    """The outline of a block of a section, in the section's middle."""
    from ezdxf.math import OCS

    outline = body.outline
    extrusion = (outline - body.vertices[len(outline) :]).mean(axis=0)
    points = outline - extrusion / 2.0
    ocs = OCS((extrusion / np.sqrt(extrusion @ extrusion)).tolist())
    flat = list(ocs.points_from_wcs(points.tolist()))
    space.add_lwpolyline(
        [(point.x, point.y) for point in flat],
        close=True,
        dxfattribs={"layer": layer, "elevation": flat[0].z, "extrusion": tuple(ocs.uz)},
    )
