"""Blocks, interfaces and node pairs as they are drawn and exported, in the user's coordinates, and their JSON.

The arrays stand in a result's JSON under `scene`, packed: `{"type": "float64", "shape": [24, 3], "zlib_base64": ...}`.

The classes neither compare nor print: arrays do that badly, and every wedge would pay for the methods.
"""

import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.codec import MISREAD, is_of_document
from slopekit.core.errors import DesignError, Fault

#: Contact modes of node pairs by their number.
MODES = ("stick", "slip", "open")
STICK, SLIP, OPEN = range(3)
CLOSED = 1e-9  # normal force below this part of the largest is none
SLIPS = 1e-4  # slip beyond this part of the fastest motion is slip
_TYPES = {"float64": np.float64, "int32": np.int32, "uint8": np.uint8}
_ZLIB_LEVEL = 4  # of zlib: beyond it costs more time than it saves room


@dataclass(frozen=True)
class Sizes:
    """The size of what fails, in m.

    Attributes
    ----------
    height_m : vertical, from its lowest to its highest corner
    face_width_m : along the crest, between its outermost corners there; of what does not reach the crest between its
        outermost corners; None where the slope is taken per metre, or has no crest
    setback_m : how far behind the crest it reaches, horizontal and square to the crest; None where there is no crest
    volume_m3, mass_t : of the blocks of a mechanism; not a number of one block, whose geometry and forces have them
    trace_lengths_m : by joint, on the face and on the upper slope, of a plane in the section; none where there is none
    """

    height_m: float
    face_width_m: float | None
    setback_m: float | None
    trace_lengths_m: Mapping[str, Mapping[str, float]]
    volume_m3: float = math.nan
    mass_t: float = math.nan


@dataclass(frozen=True, eq=False, repr=False)
class Solids:
    """Closed surfaces of blocks.

    Attributes
    ----------
    vertices : (v, 3) m; triangles : (t, 3) anticlockwise seen from outside; block : (t,) whose they are
    face : (t,) index into `faces`, -1 where it is not known; faces : names
    """

    vertices: Floats
    triangles: Ints
    block: Ints
    face: Ints
    faces: tuple[str, ...] = ()

    def block_surface(self, block: int) -> tuple[Floats, Ints]:
        """Vertices (k, 3) and triangles (m, 3) of one block, for itself."""
        triangles = self.triangles[self.block == block]
        used, index = np.unique(triangles, return_inverse=True)
        return self.vertices[used], index.reshape(-1, 3)


@dataclass(frozen=True, eq=False, repr=False)
class Contacts:
    """Flat pieces of the interfaces: convex polygons between two blocks.

    Attributes
    ----------
    corners : (c, 3) m; first : (k + 1,) polygon i has the corners first[i] to first[i + 1]
    joint : (k,) index into the scene's joints; plus, minus : (k,) blocks, -1 for bedrock that is none of them
    """

    corners: Floats
    first: Ints
    joint: Ints
    plus: Ints
    minus: Ints

    def __len__(self) -> int:
        return len(self.joint)


@dataclass(frozen=True, eq=False, repr=False)
class NodePairState:
    """The node pairs (n) at the limit.

    Attributes
    ----------
    points_m : (n, 3); joint : (n,) index into the joints; control_area_m2 : (n,); normals : (n, 3) unit, into the plus
        block; plus, minus : (n,) blocks, -1 for bedrock
    normal_kn : (n,) compression positive; shear_kn : (n, 3) friction and cohesion on the plus block
    mode : (n,) index into `MODES`
    """

    points_m: Floats
    joint: Ints
    control_area_m2: Floats
    normals: Floats
    plus: Ints
    minus: Ints
    normal_kn: Floats
    shear_kn: Floats
    mode: Ints

    def __len__(self) -> int:
        return len(self.joint)


@dataclass(frozen=True, eq=False, repr=False)
class Arrows:
    """Loads (k) on blocks: `what` (k,) index into `names`, `block` (k,), `force_kn` (k, 3), `at_m` (k, 3)."""

    names: tuple[str, ...]
    what: Ints
    block: Ints
    force_kn: Floats
    at_m: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Shapes:
    """Blocks (n) with their interfaces: what geometry knows of a scene.

    Attributes
    ----------
    names, fixed : (n,) blocks and which of them are bedrock; centroids : (n, 3) m
    joints : names by joint index
    """

    names: tuple[str, ...]
    fixed: Bools
    centroids: Floats
    joints: tuple[str, ...]
    solids: Solids
    contacts: Contacts


@dataclass(frozen=True, eq=False, repr=False)
class Bolts:
    """Bolts (b) whose heads are known.

    Attributes
    ----------
    number : (b,) as the design lists them, from 1; block : (b,) of the head, -1 where none is met
    heads_m, ends_m : (b, 3); without a length a bolt ends where it leaves its block
    plates : (b, 3) unit, out of the face that the plate lies on; passive : (b,)
    force_kn : (b,) of an active bolt its load, of a passive one its capacity; length_m : (b,) nan where none is given
    """

    number: Ints
    block: Ints
    heads_m: Floats
    ends_m: Floats
    plates: Floats
    passive: Bools
    force_kn: Floats
    length_m: Floats

    def __len__(self) -> int:
        return len(self.number)


@dataclass(frozen=True, eq=False, repr=False)
class BlockScene:
    """Everything that pictures, reports and files of other programs need of a result.

    Attributes
    ----------
    shapes : the blocks (n)
    pairs : node pairs at the limit; loads : on the blocks, weight first
    velocity : (n, 6) displacement of the centroids and rotation about them in the mechanism that each block moves in
        (the fastest is 1; rotation per m), 0 where it moves in none
    order : (n,) number of that mechanism, counted from 1 in the order in which they happen; 0 for none
    factor : (n,) the factor of safety at which a block fails; nan where it has none
    displacement : (n, 6) m and radians at full strength on the elastic bed, None where it was not found
    bolts : those with a head, None without any
    """

    shapes: Shapes
    pairs: NodePairState
    loads: Arrows
    velocity: Floats
    order: Ints
    factor: Floats
    displacement: Floats | None = None
    bolts: Bolts | None = None

    @property
    def known_bolts(self) -> Bolts:
        """The bolts with a head, none of them where there are none."""
        if self.bolts is not None:
            return self.bolts
        none, integers, points = np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros((0, 3))
        return Bolts(
            integers, integers, points, points, points, np.zeros(0, dtype=bool), none, none
        )

    def to_dict(self) -> dict[str, Any]:
        """The scene as JSON values, arrays packed; `bolts` only where there are any."""
        document: dict[str, Any] = _packed(self)
        return (
            document
            if self.bolts is not None
            else {key: value for key, value in document.items() if key != "bolts"}
        )

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> "BlockScene":
        """The scene of a document.

        Raises
        ------
        DesignError
            E350 where the document holds no scene that can be read.
        """
        try:
            shapes, displacement = document["shapes"], document["displacement"]
            return cls(
                Shapes(
                    tuple(shapes["names"]),
                    unpacked(shapes["fixed"]).astype(bool),
                    unpacked(shapes["centroids"]),
                    tuple(shapes["joints"]),
                    _read(Solids, shapes["solids"]),
                    _read(Contacts, shapes["contacts"]),
                ),
                _read(NodePairState, document["pairs"]),
                _read(Arrows, document["loads"]),
                unpacked(document["velocity"]),
                unpacked(document["order"]),
                unpacked(document["factor"]),
                None if displacement is None else unpacked(displacement),
                None if document.get("bolts") is None else _bolts(document["bolts"]),
            )
        except zlib.error as error:
            raise unreadable(f"{type(error).__name__}: {error}") from None
        except MISREAD as error:
            if not is_of_document(error):
                raise
            raise unreadable(f"{type(error).__name__}: {error}") from None


def unreadable(reason: str) -> DesignError:
    """E350, with what is wrong with the scene of a result."""
    advice = "Make the file again with slopekit run -o DIR."
    return DesignError(
        [Fault("E350", f"the scene of the result cannot be read ({reason})", "", advice)]
    )


def packed(values: Floats | Ints | Bools) -> dict[str, Any]:
    """An array as JSON values: float64, int32 or uint8 (for bools), little-endian, C order, zlib, base64.

    >>> unpacked(packed(np.array([[1.5, 2.0]]))).tolist()
    [[1.5, 2.0]]
    """
    name = (
        "float64" if values.dtype.kind == "f" else "uint8" if values.dtype.kind == "b" else "int32"
    )
    array = np.ascontiguousarray(values, dtype=np.dtype(_TYPES[name]).newbyteorder("<"))
    import base64  # of JSON alone

    data = base64.b64encode(zlib.compress(array.tobytes(), _ZLIB_LEVEL)).decode()
    return {"type": name, "shape": list(array.shape), "zlib_base64": data}


def unpacked(document: Mapping[str, Any]) -> Any:
    """The array of a packed one: float64 or int64.

    Raises
    ------
    KeyError, TypeError, ValueError
        For anything else.
    """
    import base64

    kind, shape = document["type"], tuple(document["shape"])
    raw = zlib.decompress(base64.b64decode(document["zlib_base64"], validate=True))
    array = np.frombuffer(raw, np.dtype(_TYPES[kind]).newbyteorder("<")).reshape(shape)
    return array.astype(np.float64 if kind == "float64" else np.int64)


def _packed(value: Any) -> Any:
    if is_dataclass(value):
        return {field.name: _packed(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray):
        return packed(value)
    return list(value) if isinstance(value, tuple) else value


def _read(kind: Any, document: Mapping[str, Any]) -> Any:
    """A dataclass of arrays and tuples of names."""
    entries = {field.name: document[field.name] for field in fields(kind)}
    return kind(
        **{
            name: tuple(value) if isinstance(value, list) else unpacked(value)
            for name, value in entries.items()
        }
    )


def _bolts(document: Mapping[str, Any]) -> Bolts:
    bolts: Bolts = _read(Bolts, document)
    return replace(bolts, passive=bolts.passive.astype(bool))


# -- making shapes ----------------------------------------------------------------------------------------------------


def closed(polygons: Sequence[Floats]) -> tuple[Floats, Ints, Ints]:
    """The flat convex faces (k, 3) of one block as triangles: vertices, triangles, and the face of each.

    Corners that faces share are one vertex where they are the same to the last digit, or nearly (1e-9 of the size).
    """
    corners = np.concatenate(polygons)
    size = max(float(np.ptp(corners, axis=0).max()), 1e-300)
    _, first, index = np.unique(
        np.round((corners - corners.min(axis=0)) / size, 9),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    index = index.ravel()
    triangles, faces, begin = [], [], 0
    for k, polygon in enumerate(polygons):
        face_corners = index[begin : begin + len(polygon)]
        begin += len(polygon)
        for i in range(1, len(face_corners) - 1):
            if len({face_corners[0], face_corners[i], face_corners[i + 1]}) == 3:
                triangles.append((face_corners[0], face_corners[i], face_corners[i + 1]))
                faces.append(k)
    return (
        corners[first],
        np.array(triangles, dtype=np.int64).reshape(-1, 3),
        np.array(faces, dtype=np.int64),
    )


def prism(outline: Floats, thickness: float, y: float = 0.0) -> tuple[Floats, Ints]:
    """An outline (k, 2) in x and z, drawn out along y by half the thickness to both sides; convex or not.

    Returns
    -------
    vertices (2k, 3): those at the smaller y first; triangles, anticlockwise seen from outside
    """
    from manifold3d import triangulate

    x, z = outline.T
    twice = float(x @ np.roll(z, -1) - z @ np.roll(x, -1))
    line = outline if twice > 0.0 else outline[::-1]
    count = len(line)
    front = np.stack([line[:, 0], np.full(count, y - thickness / 2.0), line[:, 1]], axis=1)
    back = front + np.array([0.0, thickness, 0.0])
    cap = np.asarray(triangulate([line - line.mean(axis=0)]), dtype=np.int64)
    corner = np.arange(count)
    next_corner = np.roll(corner, -1)
    sides = [
        np.stack([corner, corner + count, next_corner + count], axis=1),
        np.stack([corner, next_corner + count, next_corner], axis=1),
    ]
    return np.concatenate([front, back]), np.concatenate([cap, cap[:, ::-1] + count, *sides])


def joined(bodies: Sequence[tuple[Floats, Ints]]) -> tuple[Floats, Ints, Ints]:
    """Bodies as one set of vertices and triangles, with the body of each triangle."""
    firsts = np.cumsum([0, *(len(vertices) for vertices, _ in bodies)])
    return (
        np.concatenate([vertices for vertices, _ in bodies]),
        np.concatenate(
            [triangles + first for (_, triangles), first in zip(bodies, firsts, strict=False)]
        ),
        np.repeat(np.arange(len(bodies)), [len(triangles) for _, triangles in bodies]),
    )


def contacts_of(polygons: Sequence[Floats], joint: Sequence[int]) -> Contacts:
    """Polygons (k, 3) between one block, 0, and the bedrock."""
    count = len(polygons)
    return Contacts(
        np.concatenate([np.zeros((0, 3)), *polygons]),
        np.cumsum([0, *map(len, polygons)]),
        np.array(joint, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
        np.full(count, -1),
    )
