"""Rounding of the vertices of a mesh file: by its decimals, or by single precision."""

from pathlib import Path

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.geometry.fit import corner_unit

_STL_HEADER, _STL_TRIANGLE = 84, 50  # bytes of a binary STL file
_MOST_PLY_HEADER = 10_000  # bytes
_MILLIMETRE = 1e-3  # coarser ones may be quarters of a metre that somebody wrote


def file_rounding(path: Path, vertices: Floats, length_unit: float = 1.0) -> tuple[float, float]:
    """Return the unit (m) to which a file's vertices are rounded, and the resolution of its single precision; or 0.

    Parameters
    ----------
    vertices : (v, 3) m, as they were read from it; length_unit : m, of the file's own coordinates
    """
    suffix = path.suffix.lower()
    if suffix in (".glb", ".gltf"):
        return _node_rounding(path)
    written = vertices / length_unit
    is_single = _is_single(path, suffix) or _passed_through_single(written)
    return length_unit * corner_unit(written, is_single), length_unit * _resolution(
        written
    ) if is_single else 0.0


def _resolution(coordinates: Floats) -> float:
    """Return the distance of neighbouring numbers of single precision at the largest coordinate."""
    return float(np.spacing(np.float32(np.abs(coordinates).max())))


def _is_single(path: Path, suffix: str) -> bool:
    """Return whether a file is binary with coordinates of four bytes."""
    if suffix == ".stl":
        with path.open("rb") as file:
            header = file.read(_STL_HEADER)
        count = int.from_bytes(header[-4:], "little")
        return (
            len(header) == _STL_HEADER
            and path.stat().st_size == _STL_HEADER + _STL_TRIANGLE * count
        )
    if suffix == ".ply":
        with path.open("rb") as file:
            header = file.read(_MOST_PLY_HEADER).partition(b"end_header")[0]
        return b"format ascii" not in header and any(
            b"property %s x" % name in header for name in (b"float", b"float32")
        )
    return False


def _passed_through_single(vertices: Floats) -> bool:
    """Return whether the coordinates along some axis of a text file are single-precision numbers, unrounded."""
    for along in vertices.T:
        if (along.astype(np.float32) == along).all() and corner_unit(along) <= min(
            _MILLIMETRE, _resolution(along)
        ):
            return True
    return False


def _node_rounding(path: Path) -> tuple[float, float]:
    """Return the coarsest unit and resolution (m) of the meshes of a GLB file, as its nodes scale them."""
    import trimesh

    scene = trimesh.load_scene(path, process=False)
    roundings = [(0.0, 0.0)]
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        vertices = np.asarray(getattr(scene.geometry[name], "vertices", ()), dtype=np.float64)
        if vertices.size:
            scale = float(np.sqrt((matrix[:3, :3] ** 2).sum(axis=0)).max())
            roundings.append(
                (scale * corner_unit(vertices, is_single=True), scale * _resolution(vertices))
            )
    units, resolutions = zip(*roundings, strict=True)
    return max(units), max(resolutions)
