"""Mesh files (STL, OBJ, PLY, GLB) as closed bodies or open sheets, read with trimesh in double precision."""

from pathlib import Path

import numpy as np

from slopekit.arrays import Floats, Ints
from slopekit.errors import DesignError, Fault

_MOST_TRIANGLES = 400_000


def read_mesh(path: Path, name: str, where: str = "", turn: bool = True) -> tuple[Floats, Ints, bool]:
    """Vertices (n, 3), triangles (m, 3) and whether they close a body; duplicate vertices are merged.

    Parameters
    ----------
    name, where : how the mesh is called in messages, and where the design names it
    turn : turn a closed mesh that is inside out

    Raises
    ------
    DesignError
        E172 the file is no mesh that can be read.
    """
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh", process=True)
        if isinstance(mesh, trimesh.Trimesh):  # vertices of a GLB with their own normals are one place all the same
            mesh.merge_vertices(merge_tex=True, merge_norm=True)
    except Exception as error:  # trimesh's readers raise whatever their format makes them stumble over
        reason = f"{type(error).__name__}: {error}".splitlines()[0][:120]
        advice = "STL, OBJ, PLY, OFF and GLB are read."
        raise DesignError(
            [Fault("E172", f"the mesh {name} cannot be read ({reason})", where or name, advice)]
        ) from None
    triangles = np.asarray(getattr(mesh, "faces", np.zeros((0, 3))), dtype=np.int64)
    vertices = np.asarray(getattr(mesh, "vertices", np.zeros((0, 3))), dtype=np.float64)
    if len(triangles) == 0 or not np.isfinite(vertices).all():
        raise DesignError([Fault("E172", f"the mesh {name} has no triangles that can be used", where or name)])
    if len(triangles) > _MOST_TRIANGLES:
        message = f"the mesh {name} has {len(triangles)} triangles, more than {_MOST_TRIANGLES}"
        raise DesignError([Fault("E172", message, where or name, "Decimate it: the answer does not need them.")])
    closed = bool(mesh.is_watertight and mesh.is_winding_consistent)
    if turn and closed and mesh.volume < 0.0:
        triangles = triangles[:, ::-1]
    return vertices, np.ascontiguousarray(triangles), closed
