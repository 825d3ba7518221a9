"""Components of an assembly whose blocks touch each other, and the model of some blocks with all others fixed."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.geometry.patches import BEDROCK, Assembly, Patches
from slopekit.loads import AssemblyLoads
from slopekit.preie.system.assembly import AssemblyModel, build_assembly
from slopekit.preie.system.model import JointStrength


@dataclass(frozen=True, eq=False)
class WholeAssembly:
    """An assembly with its loads and joint strengths, shared by the models of all its components."""

    assembly: Assembly
    loads: AssemblyLoads
    strength: JointStrength
    ranged: bool = True


def whole_model(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, refine: Ints | None = None
) -> AssemblyModel | None:
    """Return one model of all blocks that touch something and are not fixed; None without such blocks.

    Parameters
    ----------
    refine : (k,) how often each contact is split: halved in a section, its triangles in four in space
    """
    patches = assembly.patches
    touched = np.zeros(len(assembly) + 1, dtype=bool)
    touched[patches.plus] = touched[patches.minus] = True
    fixed = assembly.fixed | ~touched[:-1]
    free = np.append(~fixed, False)
    if not (free[patches.plus] | free[patches.minus]).any():
        return None
    return build_assembly(
        patches,
        fixed,
        assembly.centroids,
        loads.forces,
        loads.moments,
        strength,
        assembly.in_section,
        refine,
        loads.live,
        loads.bolts,
    )


def components(scene: WholeAssembly, blocks: Ints) -> list[Ints]:
    """Return the components of some blocks: sets that touch each other or are bolted together, not via other blocks."""
    if len(blocks) == 0:
        return []
    assembly, bolts = scene.assembly, scene.loads.bolts
    plus, minus = (
        np.append(assembly.patches.plus, bolts.head),
        np.append(assembly.patches.minus, bolts.toe),
    )
    inside = np.zeros(len(assembly) + 1, dtype=bool)
    inside[blocks] = True
    both = inside[plus] & inside[minus] & (minus >= 0) & (plus >= 0)
    graph = sparse.coo_matrix(
        (np.ones(int(both.sum())), (plus[both], minus[both])), shape=(len(assembly),) * 2
    )
    _, label = connected_components(graph, directed=False)
    order = np.argsort(label[blocks], kind="stable")
    return np.split(blocks[order], np.flatnonzero(np.diff(label[blocks][order])) + 1)


def model_of_blocks(
    scene: WholeAssembly, is_present: Bools, free: Ints, refine: Ints | None = None
) -> tuple[AssemblyModel, Ints] | None:
    """Return the model with the blocks `free` moving and all others fixed, and the indices of its patches.

    Blocks that are not present are removed, with their bolts. None where the free blocks touch nothing.
    """
    assembly, patches, loads = scene.assembly, scene.assembly.patches, scene.loads
    fixed = np.ones(len(assembly), dtype=bool)
    fixed[free] = False
    is_removed, is_moving = (
        np.append(~is_present & ~assembly.fixed, False),
        np.append(~fixed, False),
    )  # bedrock is neither removed nor moving
    is_active = (
        (is_moving[patches.plus] | is_moving[patches.minus])
        & ~is_removed[patches.plus]
        & ~is_removed[patches.minus]
    )
    if not is_active.any():
        return None
    is_loose = is_removed[loads.bolts.head] | is_removed[loads.bolts.toe]
    head, toe = (np.where(is_loose, BEDROCK, end) for end in (loads.bolts.head, loads.bolts.toe))
    model = build_assembly(
        _active_patches(patches, is_active),
        fixed,
        assembly.centroids,
        loads.forces,
        loads.moments,
        scene.strength,
        assembly.in_section,
        None if refine is None else refine[is_active],
        loads.live,
        replace(loads.bolts, head=head, toe=toe),
    )
    return model, np.flatnonzero(is_active)[model.patch]


def _active_patches(patches: Patches, is_active: Bools) -> Patches:
    """Return the active patches (k,) of an assembly, in their order."""
    counts = np.diff(patches.first)
    first = np.concatenate([[0], np.cumsum(counts[is_active])])
    return Patches(
        patches.plus[is_active],
        patches.minus[is_active],
        patches.joint[is_active],
        patches.normals[is_active],
        patches.areas[is_active],
        patches.centroids[is_active],
        patches.corners[np.repeat(is_active, counts)],
        first,
    )


def block_sizes(assembly: Assembly) -> Floats:
    """Return half the edge (m) of a cube of each block's volume; in a section of a square of its area."""
    edge = np.cbrt(assembly.volumes)
    if assembly.in_section and len(assembly.patches):
        ends = assembly.patches.corners.reshape(-1, 2, 3)
        length = float(np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)).sum())
        edge = np.sqrt(assembly.volumes * length / float(assembly.patches.areas.sum()))
    return edge / 2.0
