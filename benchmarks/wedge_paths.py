"""Single wedges as assemblies of one block: the limit of a wedge against that of the elastic path of many blocks.

By hand: ``python -m benchmarks.wedge_paths [500]``. Random wedges with water, bolts and earthquakes;
``python -m benchmarks.wedge_paths 500 passive`` takes those with passive bolts only. Both are the lower of the limit by
forces and of that on elastic joints, whose pressed parts have the cohesion: the wedge has them from its exact polygons,
the path from node pairs, each triangle split twice, and peaks that it passes in steps.
"""

import math
import sys
from collections import Counter

import numpy as np

from slopekit.api import run
from slopekit.core.errors import SlopekitError
from slopekit.geometry.patches import BEDROCK, Patches
from slopekit.kinds import cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.loads import PassiveBolts
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.system.assembly import AssemblyModel, build_assembly
from slopekit.preie.system.model import JointStrength, Model
from tests.support import random_wedge

_SPLIT, _NEAR = 2, 0.03  # triangles of the node pairs; of a limit, what peaks and node pairs may do


def as_assembly(scene) -> AssemblyModel:
    """One block on the same flat contacts with the same loads and strengths, in the way of many."""
    pairs, model, bedding = scene.pairs, scene.model, scene.bedding
    joints = sorted(bedding.polygons)
    corners = [np.asarray(bedding.polygons[joint]) for joint in joints]
    at = [int(np.flatnonzero(pairs.interface == joint)[0]) for joint in joints]
    normals = np.array([pairs.normals[k] for k in at])
    areas, centroids = [], []
    for polygon in corners:
        crossed = np.cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0])
        parts = np.sqrt((crossed**2).sum(axis=1)) / 2.0
        areas.append(parts.sum())
        centroids.append(parts @ ((polygon[0] + polygon[1:-1] + polygon[2:]) / 3.0) / parts.sum())
    none = np.zeros(len(joints), dtype=np.int64)
    patches = Patches(
        none,
        none + BEDROCK,
        np.arange(len(joints)),
        normals,
        np.array(areas),
        np.array(centroids),
        np.concatenate(corners),
        np.cumsum([0, *(len(polygon) for polygon in corners)]),
    )
    per_area = model.control_area * model.area_scale / model.force_scale
    strength = JointStrength(
        np.array([model.cohesion[k] / per_area[k] for k in at]),
        model.tan_friction[at],
        model.tan_dilation[at],
        np.zeros(len(at)),
    )
    force, moment = (
        model.load[:3] * model.force_scale,
        model.load[3:] * model.force_scale * model.length_scale,
    )
    return build_assembly(
        patches,
        np.zeros(1, dtype=bool),
        bedding.centroid[None, :],
        force[None, :],
        moment[None, :],
        strength,
        False,
        refine=np.full(len(joints), _SPLIT),
        bolts=_bolts(model, bedding.centroid),
    )


def _bolts(model: Model, centroid: np.ndarray) -> PassiveBolts:
    """The passive bolts of one block from their rows: unit forces, and their moments about the centroid."""
    along, turning = model.bolt_rows[:, :3], model.bolt_rows[:, 3:]
    none = np.zeros(len(along), dtype=np.int64)
    return PassiveBolts(
        none,
        none + BEDROCK,
        along * (model.bolt_capacity * model.force_scale)[:, None],
        centroid + np.cross(along, turning) * model.length_scale,
    )


def compared(rng: np.random.Generator, passive: bool = False) -> tuple[str, float]:
    """What one random wedge says: a word, and the relative difference where both have a factor."""
    while True:
        wedge = random_wedge(rng)
        if not passive or any(bolt["acts"] == "passive" for bolt in wedge.get("bolts", ())):
            break
    try:
        design = wedge_design(wedge)
        one = run(design)
        many = limit_of_blocks(as_assembly(cut(design).scene_at(0)), ranged=False)
    except SlopekitError as error:
        return error.faults[0].code, 0.0
    if one.fos.limit is None or many.factor is None:
        alike = (one.fos.limit is None) == (many.factor is None)
        return f"no factor: {one.status} / {many.outcome.name}{'' if alike else ' DIFFER'}", 0.0
    off = min(many.factor, one.comparisons.forces_only or math.inf) / one.fos.limit - 1.0
    if abs(off) < 1e-6:
        return "alike", off
    if abs(off) < _NEAR:
        return f"within {_NEAR:.0%}", off
    return "lower" if off < 0.0 else "higher, DIFFER", off


def main(count: int, passive: bool) -> None:
    """The table."""
    rng = np.random.default_rng(20)
    seen: Counter[str] = Counter()
    worst: dict[str, list[float]] = {}
    for number in range(count):
        word, off = compared(rng, passive)
        seen[word] += 1
        worst.setdefault(word, []).append(off)
        if "DIFFER" in word:
            print(number, word, off)
    for word, times in seen.most_common():
        print(f"{times:5d}  {word}   {min(worst[word]):.2e} .. {max(worst[word]):.2e}")


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    main(number, "passive" in sys.argv)
