"""DXF with ezdxf (extra `cad`): blocks as polyface meshes, which CAD and mining programs read; metres, doubles."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.bolts import nearest
from slopekit.core.arrays import Floats
from slopekit.exchange.panels import triangles_of
from slopekit.exchange.picking import Picked, WrittenBlock
from slopekit.exchange.solids import Files

_MOST_INDEX = 32_767  # vertices of a polyface mesh: indices are 16-bit
# layers of bedrock, of blocks that stand and of those that move; AutoCAD's index of the colour of each
_STATES = (("BLOCKS-BEDROCK", 8), ("BLOCKS-STABLE", 41), ("BLOCKS-MOVING", 30))
_OUTLINES, _LINE, _BOLTS = ("OUTLINES", 7), ("LINE-OF-INTERSECTION", 1), ("BOLTS", 2)
_JOINTS, _MODES = (5, 3, 6, 40, 4), (3, 30, 5)
_NOT_IN_NAMES = re.compile(r"[<>/\\\":;?*|=`,]")  # of layers


def write_dxf(path: Path, picked: Picked) -> Files:
    """One polyface mesh a block, 3DFACEs for interfaces, points for node pairs, lines and points for bolts.

    Of a bolt, on the layer BOLTS: a point at its head with its number as a text beside
    it, and a line to its end, to the millimetre; number, force (kN) and how it acts are XDATA of the point.

    Layers: BLOCKS-MOVING (in a mechanism), BLOCKS-STABLE, BLOCKS-BEDROCK; INTERFACE-joint; PAIRS-mode; OUTLINES of a
    section; LINE-OF-INTERSECTION of a wedge. The block's name is XDATA of the application SLOPEKIT.
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

    for body in picked.bodies:
        _add_block(space, body, layer(*_STATES[picked.state_of(body)]))
    for outline, body in zip(picked.outlines, picked.bodies, strict=False):
        _add_outline(space, outline, body, layer(*_OUTLINES))
    if picked.line is not None:
        space.add_line(*picked.line.tolist(), dxfattribs={"layer": layer(*_LINE)})
    _add_interfaces(space, picked, layer)
    for mode, word, points in picked.by_mode():
        name = layer(f"PAIRS-{word.upper()}", _MODES[mode])
        for point in points.tolist():
            space.add_point(point, dxfattribs={"layer": name})
    if len(picked.bolts):
        _add_bolts(space, picked, layer(*_BOLTS))
    low, high = (picked.scene.shapes.solids.vertices.min(axis=0), picked.scene.shapes.solids.vertices.max(axis=0))
    drawing.header["$EXTMIN"], drawing.header["$EXTMAX"] = tuple(low.tolist()), tuple(high.tolist())
    drawing.set_modelspace_vport(height=1.5 * float((high - low)[:2].max()), center=tuple(((low + high) / 2)[:2]))
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


def _add_bolts(space: Any, picked: Picked, layer: str) -> None:
    bolts, attributes = picked.scene.known_bolts, {"layer": layer}
    height = min(0.3, 0.25 * nearest(bolts.heads_m))  # m: numbers do not lie on each other
    for k in picked.bolts.tolist():
        head, end = ([round(part, 3) for part in place[k].tolist()] for place in (bolts.heads_m, bolts.ends_m))
        point = space.add_point(head, dxfattribs=attributes)
        acts = "passive" if bolts.passive[k] else "active"
        number = int(bolts.number[k])
        point.set_xdata("SLOPEKIT", [(1000, f"bolt {number}"), (1070, number), (1040, float(bolts.force_kn[k])),
                                     (1000, acts)])  # fmt: skip
        space.add_line(head, end, dxfattribs=attributes)
        text = space.add_text(str(number), height=height, dxfattribs=attributes)
        text.dxf.insert = head


def _add_interfaces(space: Any, picked: Picked, layer: Any) -> None:
    """Triangles and quadrilaterals as one 3DFACE, others as several with hidden edges between them."""
    contacts = picked.scene.shapes.contacts
    triangles, panel = triangles_of(contacts)
    layers: dict[int, str] = {}
    for joint, named, own in picked.by_joint():
        layers |= dict.fromkeys(own.tolist(), layer(f"INTERFACE-{named}", _JOINTS[joint % len(_JOINTS)]))
    whole = np.diff(contacts.first) == 4
    for k in picked.contacts[whole[picked.contacts]].tolist():
        corners = contacts.corners[contacts.first[k] : contacts.first[k + 1]]
        space.add_3dface(corners.tolist(), dxfattribs={"layer": layers[k]})
    for own, k in zip(triangles.tolist(), panel.tolist(), strict=True):
        if k in layers and not whole[k]:
            first, end = int(contacts.first[k]), int(contacts.first[k + 1])
            a, b, c = contacts.corners[own].tolist()
            hidden = [not _is_side(own[i], own[(i + 1) % 3], first, end) for i in range(3)]
            flags = sum(1 << bit for bit, flag in zip((0, 1, 3), hidden, strict=True) if flag) | 4
            space.add_3dface((a, b, c, c), dxfattribs={"layer": layers[k], "invisible_edges": flags})


def _is_side(start: int, end: int, first: int, after: int) -> bool:
    """Whether two corners of a panel follow each other round it."""
    return (start - first + 1) % (after - first) == end - first


def _add_outline(space: Any, outline: Floats, body: WrittenBlock, layer: str) -> None:
    """The outline of a block of a section, in the section's middle."""
    from ezdxf.math import OCS

    points = outline + (body.vertices[len(outline) :] - outline).mean(axis=0) / 2.0
    out = (outline - body.vertices[len(outline) :]).mean(axis=0)
    ocs = OCS((out / np.sqrt(out @ out)).tolist())
    flat = list(ocs.points_from_wcs(points.tolist()))
    space.add_lwpolyline(
        [(point.x, point.y) for point in flat], close=True,
        dxfattribs={"layer": layer, "elevation": flat[0].z, "extrusion": tuple(ocs.uz)},
    )  # fmt: skip
