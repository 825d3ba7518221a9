"""An assembly in parts: components that touch each other, and the model of some of its blocks with all others held."""

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
    """What every part of an assembly shares."""

    assembly: Assembly
    loads: AssemblyLoads
    strength: JointStrength
    ranged: bool = True


def whole_model(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, refine: Ints | None = None
) -> AssemblyModel | None:
    """One model of all blocks that touch something and are not fixed; None where there is none.

    Parameters
    ----------
    refine : (k,) how often each contact is split: halved in a section, its triangles in four in space
    """
    patches = assembly.patches
    touched = np.zeros(len(assembly) + 1, dtype=bool)
    touched[patches.plus] = touched[patches.minus] = True
    held = assembly.fixed | ~touched[:-1]
    free = np.append(~held, False)
    if not (free[patches.plus] | free[patches.minus]).any():
        return None
    return build_assembly(
        patches, held, assembly.centroids, loads.forces, loads.moments, strength, assembly.in_section,
        refine, loads.live, loads.bolts,
    )  # fmt: skip


def components(scene: WholeAssembly, among: Ints) -> list[Ints]:
    """Blocks that touch each other or are bolted together, not only bedrock or what is held, together."""
    if len(among) == 0:
        return []
    assembly, bolts = scene.assembly, scene.loads.bolts
    plus, minus = np.append(assembly.patches.plus, bolts.head), np.append(assembly.patches.minus, bolts.toe)
    inside = np.zeros(len(assembly) + 1, dtype=bool)
    inside[among] = True
    both = inside[plus] & inside[minus] & (minus >= 0) & (plus >= 0)
    graph = sparse.coo_matrix((np.ones(int(both.sum())), (plus[both], minus[both])), shape=(len(assembly),) * 2)
    _, label = connected_components(graph, directed=False)
    order = np.argsort(label[among], kind="stable")
    return np.split(among[order], np.flatnonzero(np.diff(label[among][order])) + 1)


def model_of(
    scene: WholeAssembly, there: Bools, free: Ints, refine: Ints | None = None
) -> tuple[AssemblyModel, Ints] | None:
    """The model with the blocks `free` moving and all others held, those that are gone taken away, and its patches.

    A block that has gone takes its bolts with it.
    """
    assembly, patches, loads = scene.assembly, scene.assembly.patches, scene.loads
    held = np.ones(len(assembly), dtype=bool)
    held[free] = False
    out, moves = np.append(~there & ~assembly.fixed, False), np.append(~held, False)  # bedrock never goes nor moves
    kept = (moves[patches.plus] | moves[patches.minus]) & ~out[patches.plus] & ~out[patches.minus]
    if not kept.any():
        return None
    off = out[loads.bolts.head] | out[loads.bolts.toe]
    head, toe = (np.where(off, BEDROCK, end) for end in (loads.bolts.head, loads.bolts.toe))
    model = build_assembly(
        _chosen(patches, kept), held, assembly.centroids, loads.forces, loads.moments, scene.strength,
        assembly.in_section, None if refine is None else refine[kept], loads.live,
        replace(loads.bolts, head=head, toe=toe),
    )  # fmt: skip
    return model, np.flatnonzero(kept)[model.patch]


def _chosen(patches: Patches, kept: Bools) -> Patches:
    """Some patches (k,) of an assembly, in their order."""
    counts = np.diff(patches.first)
    first = np.concatenate([[0], np.cumsum(counts[kept])])
    return Patches(
        patches.plus[kept], patches.minus[kept], patches.joint[kept], patches.normals[kept], patches.areas[kept],
        patches.centroids[kept], patches.corners[np.repeat(kept, counts)], first,
    )  # fmt: skip


def block_sizes(assembly: Assembly) -> Floats:
    """Half the size of each block, m: in a section that of its area, whatever the thickness."""
    root = np.cbrt(assembly.volumes)
    if assembly.in_section and len(assembly.patches):
        ends = assembly.patches.corners.reshape(-1, 2, 3)
        length = float(np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)).sum())
        root = np.sqrt(assembly.volumes * length / float(assembly.patches.areas.sum()))
    return root / 2.0
