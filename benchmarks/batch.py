"""Single blocks in batch beside the single run: agreement, and CPU time beside the closed form.

    python -m benchmarks.batch [CUTS] [SAMPLES] [SEED]

Random ordinary cuts (`benchmarks.ordinary_cuts`) by `limits_of_blocks` and one by one by `flat_limit`; then that many
samples of templates/wedge-scatter by batch and by Hoek & Bray's closed form.
"""

import resource
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import slopekit as sk
from benchmarks.ordinary_cuts import ordinary_cut
from slopekit.core.arrays import Floats, cross
from slopekit.kinds import cut
from slopekit.kinds.single_block.one_block_limit import Cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.preie.batch import BlockLimits, Blocks, limits_of_blocks
from slopekit.preie.one_block.bed_limits import BedStatus
from slopekit.preie.one_block.flat_limit import flat_limit
from slopekit.studies.evaluation.vectorised import vectorised
from slopekit.studies.prob.sampling import samples

TEMPLATE = Path(__file__).parents[1] / "templates" / "wedge-scatter.yaml"


def random_cuts(count: int, seed: int) -> list[Cut]:
    """Return that many ordinary cuts that form a wedge."""
    rng, made = np.random.default_rng(seed), list[Cut]()
    while len(made) < count:
        try:
            made.append(cut(wedge_design(ordinary_cut(rng))))
        except sk.GeometryError:
            continue
    return made


def blocks_of(cuts: Sequence[Cut]) -> Blocks:
    """Return the blocks of single analyses as arrays."""
    beddings = [made.scene_at(0).bedding for made in cuts]
    outlines = [
        [bedding.polygons[interface.key] for interface in made.interfaces]
        for made, bedding in zip(cuts, beddings, strict=True)
        if bedding is not None
    ]
    most = max(len(outline) for each in outlines for outline in each)
    shape = len(cuts), max(len(made.interfaces) for made in cuts)
    corners, counts, cohesion, tan_friction = (
        np.zeros((*shape, most, 3)),
        np.zeros(shape, int),
        *np.zeros((2, *shape)),
    )
    for row, (made, each) in enumerate(zip(cuts, outlines, strict=True)):
        for k, (interface, outline) in enumerate(zip(made.interfaces, each, strict=True)):
            corners[row, k, : len(outline)], counts[row, k] = (
                outline - made.block.centroid,
                len(outline),
            )
            cohesion[row, k] = interface.strength.cohesion_kpa
            tan_friction[row, k] = np.tan(np.radians(interface.strength.friction_angle_deg))
    return Blocks(
        corners=corners[:, :, ::-1] if most == 2 else corners,  # ends from the toe
        counts=counts,
        cohesion=cohesion,
        tan_friction=tan_friction,
        tan_dilation=np.zeros(shape),
        load=np.array([np.concatenate([made.loads.force, made.loads.moment]) for made in cuts]),
        bolts=np.zeros((len(cuts), 0, 6)),
        laws=np.full(shape, None),
    )


def single_factors(cuts: Sequence[Cut]) -> Floats:
    """Return the limits of single analyses, not a number where there is none."""
    factors = []
    for made in cuts:
        scene = made.scene_at(made.refine)
        assert scene.bedding is not None
        limit = flat_limit(scene.model, scene.bedding.polygons, scene.bedding.centroid)
        factors.append(limit.factor)
    return np.array(factors, dtype=np.float64)


def wedges_of(arguments: Mapping[str, Any], count: int) -> Blocks:
    """Return plain wedges (no crack) by the arguments of Hoek & Bray's closed form over arrays, with their moments."""

    def normal(name: str) -> Floats:
        dip, way = (
            np.radians(np.broadcast_to(arguments[f"{name}_{of}_deg"], count))
            for of in ("dip", "dip_direction")
        )
        return np.stack([np.sin(dip) * np.sin(way), np.sin(dip) * np.cos(way), np.cos(dip)], axis=1)

    def along(way: Floats, reach: Floats) -> Floats:
        return way * reach[:, None]

    first, second, face, upper = map(normal, ("joint1", "joint2", "face", "upper"))
    traces, line = (cross(first, face), cross(second, face)), cross(first, second)
    crest1 = along(traces[0], arguments["height_m"] / traces[0][:, 2])
    offset = (upper * crest1).sum(axis=1)
    crest2, back = (along(way, offset / (upper * way).sum(axis=1)) for way in (traces[1], line))
    toe, volume = np.zeros_like(back), np.abs((crest1 * cross(crest2, back)).sum(axis=1)) / 6.0
    centroid = (crest1 + crest2 + back) / 4.0
    top = np.maximum.reduce([crest1[:, 2], crest2[:, 2], back[:, 2]])
    mean = arguments["fill"] * arguments["water_unit_weight_kn_m3"] * top / 6.0
    load = np.zeros((count, 6))
    load[:, 2] = -volume * arguments["unit_weight_kn_m3"]
    corners = np.empty((count, 2, 3, 3))
    for k, (crest, other) in enumerate(((crest1, crest2), (crest2, crest1))):
        out = cross(crest, back)
        turn = (out * other).sum(axis=1) > 0.0  # the other crest is on the inner side
        ends = np.where(turn[:, None], back, crest), np.where(turn[:, None], crest, back)
        corners[:, k] = np.stack([toe, *ends], axis=1) - centroid[:, None]
        area = 0.5 * cross(*ends)  # outward
        push = along(-area, mean)
        apex = back / 2.0
        # a third of the water on each triangle about its apex, where the pressure is highest
        parts = ((toe, crest), (crest, back), (back, toe))
        sizes = [0.5 * np.sqrt((cross(a - apex, b - apex) ** 2).sum(axis=1)) for a, b in parts]
        at = sum(
            along((2.0 * apex + a + b) / 4.0, size)
            for (a, b), size in zip(parts, sizes, strict=True)
        )
        arm = at / np.sum(sizes, axis=0)[:, None] - centroid
        load[:, :3] += push
        load[:, 3:] += cross(arm, push)
    strengths = [
        np.broadcast_to(arguments[name], count) for name in ("cohesion1_kpa", "cohesion2_kpa")
    ]
    angles = [
        np.broadcast_to(arguments[name], count) for name in ("friction1_deg", "friction2_deg")
    ]
    return Blocks(
        corners=corners,
        counts=np.full((count, 2), 3),
        cohesion=np.stack(strengths, axis=1),
        tan_friction=np.tan(np.radians(np.stack(angles, axis=1))),
        tan_dilation=np.zeros((count, 2)),
        load=load,
        bolts=np.zeros((count, 0, 6)),
        laws=np.full((count, 2), None),
    )


def said(limits: BlockLimits) -> str:
    """Return how the blocks end, in words."""
    ends = Counter(
        "forces" if status < 0 else BedStatus(status).name for status in limits.bed_status.tolist()
    )
    return ", ".join(
        f"{name} {share / len(limits.factor):.1%}" for name, share in ends.most_common()
    )


def main(count: int = 2000, size: int = 100_000, seed: int = 1) -> None:
    """Run both and print what was found."""
    cuts = random_cuts(count, seed)
    began = time.process_time()
    batch = limits_of_blocks(blocks_of(cuts))
    middle = time.process_time()
    single = single_factors(cuts)
    ended = time.process_time()
    both = np.isfinite(single) & np.isfinite(batch.factor)
    off = np.abs(batch.factor[both] / single[both] - 1.0)
    print(
        f"{count} cuts, CPU: {(middle - began) / count * 1e6:.0f} µs in batch, {(ended - middle) / count * 1e3:.1f} ms"
    )
    print(said(batch))
    print(
        "one has a number and the other none:",
        int((np.isfinite(single) != np.isfinite(batch.factor)).sum()),
    )
    print(
        "share within",
        {limit: f"{np.mean(off < limit):.4f}" for limit in (1e-9, 1e-6, 1e-4)},
        "worst",
        off.max(),
    )
    design = sk.load(str(TEMPLATE))
    drawn = samples(design.variables, design.correlation, size, seed, "monte-carlo")
    columns = vectorised(design, drawn.values, drawn.settings)
    assert columns is not None
    arguments = columns.arguments(drawn.values)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = time.process_time()
    forms = columns.rows(drawn.values).closed_form
    middle = time.process_time()
    limits = limits_of_blocks(wedges_of(arguments, size))
    ended = time.process_time()
    more = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory) / 1024
    each = (ended - middle) / size * 1e6, (middle - began) / size * 1e6
    print(f"{size} samples, CPU: {each[0]:.0f} µs in batch, {each[1]:.2f} µs by the closed form")
    print(said(limits), f"; {more:.0f} MB more")
    off = np.abs(limits.forces / forms.factor - 1.0)
    print("forces against Hoek & Bray, worst", np.nanmax(off), "; P(F < 1.2)", end=" ")
    print(
        np.mean(forms.factor < 1.2),
        "by forces,",
        np.mean(limits.factor < 1.2),
        "by the lower of both",
    )


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
