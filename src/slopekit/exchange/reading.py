"""Closed meshes read back: the blocks of a file by name."""

import os
from pathlib import Path

import numpy as np

from slopekit.arrays import Floats, Ints
from slopekit.errors import DesignError, Fault


def read_blocks(path: str | os.PathLike[str]) -> list[tuple[str, Floats, Ints]]:
    """The blocks of an STL, OBJ, PLY, OFF, GLB, glTF, DXF or VTU file, in its order and in double precision.

    Returns
    -------
    name, vertices (v, 3) m, triangles (t, 3) of each solid, object, group, node or cell

    Raises
    ------
    DesignError
        E147, E148 no such file; E172 no mesh that can be read; E140 a DXF without the extra `cad`, a VTU without
        `plot`.
    """
    from slopekit.design.document import read_bytes
    from slopekit.exchange.vtu import vtu_bodies
    from slopekit.geometry.mesh_bodies import mesh_bodies

    file = Path(path)
    read_bytes(file, 2_000_000_000)
    try:
        found = vtu_bodies(file) if file.suffix.lower() == ".vtu" else mesh_bodies(file)
    except DesignError:
        raise
    except Exception as error:  # readers raise whatever their format makes them stumble over
        reason = f"{type(error).__name__}: {error}".splitlines()[0][:120]
        advice = "STL, OBJ, PLY, OFF, GLB, DXF and VTU are read."
        raise DesignError(
            [Fault("E172", f"the mesh {file.name} cannot be read ({reason})", str(file), advice)]
        ) from None
    sound = [body for body in found if len(body[2]) and np.isfinite(body[1]).all()]
    if not sound:
        raise DesignError([Fault("E172", f"the mesh {file.name} has no triangles that can be used", str(file))])
    return sound
