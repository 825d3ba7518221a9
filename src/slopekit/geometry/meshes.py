"""Mesh files (STL, OBJ, PLY, OFF, GLB, DXF) as closed bodies or open sheets, read in double precision."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from slopekit.arrays import Floats, Ints
from slopekit.errors import DesignError, Fault
from slopekit.geometry.mesh_bodies import merged, mesh_bodies, one_mesh

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
        E172 the file is no mesh that can be read; E140 a DXF without the extra `cad`.
    """
    import trimesh

    try:
        _, vertices, triangles = merged((name, *one_mesh(mesh_bodies(path))))  # a body may be spread over groups
    except DesignError as error:
        raise DesignError([replace(fault, where=where or name) for fault in error.faults]) from None
    except Exception as error:  # trimesh's readers raise whatever their format makes them stumble over
        reason = f"{type(error).__name__}: {error}".splitlines()[0][:120]
        advice = "STL, OBJ, PLY, OFF, GLB and DXF are read."
        raise DesignError(
            [Fault("E172", f"the mesh {name} cannot be read ({reason})", where or name, advice)]
        ) from None
    if len(triangles) == 0 or not np.isfinite(vertices).all():
        raise DesignError([Fault("E172", f"the mesh {name} has no triangles that can be used", where or name)])
    if len(triangles) > _MOST_TRIANGLES:
        message = f"the mesh {name} has {len(triangles)} triangles, more than {_MOST_TRIANGLES}"
        raise DesignError([Fault("E172", message, where or name, "Decimate it: the answer does not need them.")])
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    closed = bool(mesh.is_watertight and mesh.is_winding_consistent)
    if turn and closed and mesh.volume < 0.0:
        triangles = triangles[:, ::-1]
    return vertices, np.ascontiguousarray(triangles), closed
