"""A part of an assembly that is solved for itself: its model, its limit, and finer node pairs where it needs them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from slopekit.arrays import Bools, Ints
from slopekit.geometry.patches import Assembly, Patches
from slopekit.loads import AssemblyLoads
from slopekit.preie.assembly import AssemblyModel, build_assembly
from slopekit.preie.blocks import BlocksLimit, limit_of_blocks
from slopekit.preie.model import JointStrength
from slopekit.preie.passes import Outcome

_MOST_SPLIT, _MOST_PAIRS, _MESH_CHANGE = 3, 6000, 2e-3  # of contacts that open; as for one block


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A solved component: its model, its limit, and how it was made small.

    Attributes
    ----------
    blocks : (n,) indices in the assembly of the blocks that may move
    free : (f,) those that its model lets move
    patch : (k,) the assembly's patch of each contact of the model
    held : blocks of the component held in place, and the layers set free; 0 and 0 where none is held
    at_rest : blocks that the mechanism leaves at rest, and that were held when its factor was settled
    change : what the last layer did to the factor, in parts of it
    refined : how often the parts of its contacts were split; mesh_change : what the last split did to the factor, in
        parts of it, None where none was made
    """

    model: AssemblyModel
    limit: BlocksLimit
    blocks: Ints
    free: Ints
    patch: Ints
    held: int = 0
    layers: int = 0
    change: float = 0.0
    at_rest: int = 0
    refined: int = 0
    mesh_change: float | None = None

    @property
    def rank(self) -> float:
        """Where it stands in the order of failure: what no strength holds comes first, what nothing drives last."""
        if self.limit.outcome is Outcome.LIFTED:
            return -1.0
        if self.limit.outcome is Outcome.NOT_CONVERGED and self.limit.factor is None:
            return -0.5  # it is not known to stand
        if self.limit.outcome is Outcome.NO_STRENGTH:
            return 0.0
        if self.limit.outcome is Outcome.NO_DRIVING_FORCE or self.limit.factor is None:
            return math.inf
        return self.limit.factor


def at_other_strengths(part: Part, stop_when: float, by: Sequence[float]) -> tuple[float | None, ...]:
    """k F of a part with its strength divided by each k: F again, where its limit state is the only one.

    None where it has no factor there.
    """
    found = []
    with threadpool_limits(1):
        for k in by:
            other = replace(part.model, cohesion=part.model.cohesion / k, tan_friction=part.model.tan_friction / k)
            limit = limit_of_blocks(other, stop_when, bounded=False)
            found.append(k * limit.factor if limit.factor and limit.outcome is Outcome.SLIDES else None)
    return tuple(found)


def split_contacts(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, part: Part, stop_when: float
) -> Part:
    """A part with its contacts split until its factor stays, or the pairs are too many, or the passes do not settle."""
    for level in range(1, _MOST_SPLIT + 1):
        model = finer_model(assembly, loads, strength, part, level)
        if len(model.control_area) > _MOST_PAIRS:
            break
        limit = limit_of_blocks(model, stop_when, bounded=False)
        if not limit.factor or not part.limit.factor or limit.outcome is not Outcome.SLIDES:
            break
        change = abs(limit.factor / part.limit.factor - 1.0)
        part = replace(part, model=model, limit=limit, refined=level, mesh_change=change)
        if change < _MESH_CHANGE:
            break
    return part


def finer_model(
    assembly: Assembly, loads: AssemblyLoads, strength: JointStrength, part: Part, refine: int
) -> AssemblyModel:
    """The model of a part once more, its contacts with finer node pairs."""
    kept = np.zeros(len(assembly.patches), dtype=bool)
    kept[part.patch] = True
    held = np.ones(len(assembly), dtype=bool)
    held[part.free] = False
    return build_assembly(
        chosen(assembly.patches, kept), held, assembly.centroids, loads.forces, loads.moments, strength,
        assembly.in_section, refine=refine,
    )  # fmt: skip


def chosen(patches: Patches, kept: Bools) -> Patches:
    """Some patches (k,) of an assembly, in their order."""
    counts = np.diff(patches.first)
    first = np.concatenate([[0], np.cumsum(counts[kept])])
    return Patches(
        patches.plus[kept], patches.minus[kept], patches.joint[kept], patches.normals[kept], patches.areas[kept],
        patches.centroids[kept], patches.corners[np.repeat(kept, counts)], first,
    )  # fmt: skip
