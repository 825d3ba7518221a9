"""Reading a mechanism of many blocks: how each block moves, which interfaces govern, what the contacts do."""

import numpy as np

from slopekit.analysis.assembly_scene import AssemblyScene
from slopekit.analysis.assembly_states import states_of_part
from slopekit.arrays import Floats
from slopekit.findings import BlockMotion, GoverningInterface, Mechanism
from slopekit.preie.blocks import Basis
from slopekit.preie.passes import Outcome
from slopekit.preie.ravelling import Failure, Part, block_sizes
from slopekit.strength.mohr_coulomb import line

_TURNS = 0.05  # rotation beyond this part of a block's motion counts
_OPENS = 1e-5  # an interface of which more than this part of the area opens
_MOST_INTERFACES = 12


def mechanism(failure: Failure, scene: AssemblyScene) -> Mechanism:
    """A failure in words: status, factor, blocks and governing interfaces."""
    limit = failure.limit
    size = block_sizes(scene.assembly)
    blocks = []
    for block, motion in zip(failure.blocks.tolist(), failure.motion, strict=True):
        how = _how(motion, float(size[block]), limit.outcome)
        blocks.append(BlockMotion(scene.names[block], how, motion[:3], motion[3:]))
    blocks.sort(key=lambda block: -float(np.abs(block.displacement).max()))
    ways = {block.how for block in blocks}
    if any(part.limit.outcome is Outcome.NOT_CONVERGED for part in failure.parts):
        status = "not_converged"
    elif limit.outcome in (Outcome.LIFTED, Outcome.NO_REST):
        status = next((way for word, way in _WITHOUT if word in ways), "falls")
    elif "topples" in ways:
        status = "topples"
    elif "rotates" in ways:
        status = "rotates"
    else:
        upward = all(motion[2] > _TURNS for motion in failure.motion)
        status = "slides_up" if upward else "slides"
    counts: dict[str, int] = {"stick": 0, "slip": 0, "open": 0}
    interfaces: list[GoverningInterface] = []
    total = 0.0
    for part in failure.parts:
        for mode, count in _modes(part).items():
            counts[mode] += count
        found, lost = _interfaces(part, scene)
        interfaces, total = interfaces + found, total + lost
    interfaces.sort(key=lambda interface: -interface.share)
    governing = tuple(
        GoverningInterface(
            found.name, found.joint, found.mode, found.share / max(total, 1e-300), found.normal_kn, found.area_m2
        )
        for found in interfaces[:_MOST_INTERFACES]
    )  # fmt: skip
    return Mechanism(
        status,
        limit.factor,
        limit.static_bound,
        max(part.limit.change for part in failure.parts),
        tuple(blocks),
        governing,
        counts,
        max((part.limit.basis for part in failure.parts), key=_SUREST.index).name.lower(),
    )


_SUREST = (Basis.LIMIT, Basis.SETTLED, Basis.PEAK, Basis.NONE)  # the surest first
_WITHOUT = (("topples", "topples"), ("rotates", "topples"), ("lifts", "lifted"), ("falls", "falls"))


def _how(motion: Floats, size: float, outcome: Outcome) -> str:
    """How a block moves: its top goes ahead where it topples, its bottom where it turns back under itself."""
    moved, turned = motion[:3], motion[3:] * size
    speed, spin = float(np.sqrt(moved @ moved)), float(np.sqrt(turned @ turned))
    if spin > _TURNS * max(speed, spin):
        up = np.array([0.0, 0.0, 1.0])
        top, bottom = moved + np.cross(turned, up), moved - np.cross(turned, up)
        flat = top[:2] @ top[:2] - bottom[:2] @ bottom[:2]
        return "topples" if flat > 0.0 else "rotates"
    if outcome in (Outcome.LIFTED, Outcome.NO_REST):
        return "lifts" if moved[2] > 0.0 else "falls"
    return "slides"


def _modes(part: Part) -> dict[str, int]:
    if len(part.model.control_area) == 0:
        return {}
    opened, slips = (state[part.model.joint_pairs] for state in states_of_part(part)[:2])
    return {"stick": int((~opened & ~slips).sum()), "slip": int(slips.sum()), "open": int(opened.sum())}


def _interfaces(part: Part, scene: AssemblyScene) -> tuple[list[GoverningInterface], float]:
    """Interfaces between two blocks, and bolts, that lose work in the mechanism, with the work, and all work."""
    model, limit = part.model, part.limit
    if len(model.control_area) == 0 or limit.factor is None:
        return [], 0.0
    opened, _, size = states_of_part(part)
    carried = line(model.by_group(model.cohesion * limit.bond), model.tan_friction, model.by_group(limit.normal_force))
    carried = np.where(model.bolted, limit.friction[:, 0] * limit.factor, carried)
    lost = carried * size
    work = np.bincount(model.group_contact, lost, len(model.plus))
    normal = np.bincount(model.pair_contact, limit.normal_force, len(model.plus)) * model.force_scale
    area = np.bincount(model.pair_contact, model.control_area, len(model.plus)) * model.area_scale
    open_area = np.bincount(model.pair_contact, model.control_area * opened, len(model.plus)) * model.area_scale
    chosen = np.argsort(-work, kind="stable")[: 4 * _MOST_INTERFACES]
    found: dict[tuple[str, str], list[float]] = {}
    patches = scene.assembly.patches
    bolts: list[GoverningInterface] = []
    for k in chosen[work[chosen] > 1e-6 * work.max(initial=0.0)].tolist():
        if k >= len(part.patch):
            bolt = int(model.bolts[k - len(part.patch)])
            pull = float(limit.friction[k - len(model.plus), 0]) * model.force_scale
            head = scene.names[int(scene.bolts.head[bolt])]
            bolts.append(GoverningInterface(scene.bolt_names[bolt], head, "pull", float(work[k]), pull, 0.0))
            continue
        patch = int(part.patch[k])
        name = _pair_name(scene, int(patches.plus[patch]), int(patches.minus[patch]))
        entry = found.setdefault((name, scene.joints[int(patches.joint[patch])]), [0.0, 0.0, 0.0, 0.0])
        for at, value in enumerate((work[k], normal[k], area[k], open_area[k])):
            entry[at] += float(value)
    return [
        GoverningInterface(name, joint, "open" if gone > _OPENS * area_ else "slip", share, force, area_)
        for (name, joint), (share, force, area_, gone) in found.items()
    ] + bolts, float(work.sum())


def _pair_name(scene: AssemblyScene, plus: int, minus: int) -> str:
    names = [scene.names[side] if side >= 0 else "bedrock" for side in (plus, minus)]
    return "/".join(names)
