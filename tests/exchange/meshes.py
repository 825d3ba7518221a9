"""Blocks of exported files read back: VTU by VTK, the other formats by slopekit's own reader of meshes."""

import os
from pathlib import Path

import numpy as np

from slopekit.geometry.solids.meshes import MeshBody, merged, mesh_bodies

_POLYHEDRON = 42


def read_blocks(path: str | os.PathLike[str]) -> list[MeshBody]:
    """Name, vertices (v, 3) m and triangles (t, 3) of each solid, object, group, node or cell, in the file's order."""
    file = Path(path)
    return _of_vtu(file) if file.suffix.lower() == ".vtu" else mesh_bodies(file)


def _of_vtu(path: Path) -> list[MeshBody]:
    import pyvista

    grid = pyvista.read(path)
    names = [str(name) for name in grid.field_data["block_names"]]
    found = []
    for k in range(grid.n_cells):
        cell = grid.get_cell(k)
        assert cell.type == _POLYHEDRON
        faces = [list(face.point_ids) for face in cell.faces]
        triangles = [
            (face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)
        ]
        used, index = np.unique(np.array(triangles, dtype=np.int64), return_inverse=True)
        points = np.asarray(grid.points, dtype=np.float64)[used]
        found.append(merged((names[int(grid.cell_data["block"][k])], points, index.reshape(-1, 3))))
    return found
