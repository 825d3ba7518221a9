"""Mechanisms of many blocks read: how each block moves, what interfaces and contacts do; Goodman & Bray's table."""

import math

import numpy as np

from slopekit.analysis.assembly_scene import AssemblyScene
from slopekit.analysis.assembly_states import states_of_part
from slopekit.analysis.stages import ClosedForm
from slopekit.arrays import Floats
from slopekit.closed_form.toppling import ColumnSlope, TopplingTable, toppling_factor_of_safety, toppling_table
from slopekit.design.blocky import ToppleDesign
from slopekit.errors import DesignError
from slopekit.findings import BlockMotion, Column, GoverningInterface, Mechanism
from slopekit.preie.blocks import Basis
from slopekit.preie.passes import Outcome
from slopekit.preie.ravelling import Failure, Part, block_sizes

_TURNS = 0.05  # rotation beyond this part of a block's motion counts
_OPENS = 1e-5  # an interface of which more than this part of the area opens
_MOST_INTERFACES = 12
_SUREST = (Basis.LIMIT, Basis.SETTLED, Basis.PEAK, Basis.NONE)  # the surest first
_WITHOUT = (("topples", "topples"), ("rotates", "topples"), ("lifts", "lifted"), ("falls", "falls"))
_BEYOND = 1e-6  # the table is that of columns which just fail
_MODES = {"slides": "slide", "topples": "topple", "rotates": "turn", "falls": "fall", "lifts": "lift"}


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
    carried = model.by_group(model.cohesion * limit.bond) + model.tan_friction * model.by_group(limit.normal_force)
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


def goodman_bray(design: ToppleDesign, found: Mechanism | None) -> tuple[ClosedForm, tuple[Column, ...]]:
    """The closed form of a row of columns, and its table at the factor where the columns are at their limit."""
    why = _why_not(design)
    if why:
        return ClosedForm(None, "", why), ()
    base, sides = design.strength(design.base), design.strength(design.sides)
    toward, k = design.seismic.trend_deg, design.seismic.coefficient
    try:
        slope = ColumnSlope(
            heights_m=design.heights_m, width_m=design.width_m, step_m=design.base_step_m,
            base_dip_deg=90.0 - design.dip_deg, unit_weight_kn_m3=design.unit_weight_kn_m3,
            friction_angle_deg=base.friction_angle_deg, side_friction_angle_deg=sides.friction_angle_deg,
            cohesion_kpa=base.cohesion_kpa, seismic=k if toward is None or toward > 180.0 else -k,
        )  # fmt: skip
        closed = toppling_factor_of_safety(slope)
        table = toppling_table(slope, (closed.factor or 1.0) * (1.0 + _BEYOND))
    except DesignError as error:
        return ClosedForm(
            None, "", f"Goodman & Bray's method does not take these columns: {error.faults[0].message}"
        ), ()
    ways = {block.name: _MODES[block.how] for block in found.blocks} if found is not None else {}
    columns = tuple(_columns(design, table, ways))
    rough = math.tan(math.radians(base.friction_angle_deg)) * math.tan(math.radians(sides.friction_angle_deg))
    if closed.factor and rough >= closed.factor**2:
        why = (
            f"at {closed.factor:.4g} the columns are so rough (tan φ tan φ of the sides above 1) that Goodman & Bray's "
            "sliding has no meaning: not compared"
        )
        return ClosedForm(closed.factor, closed.status, why), columns
    if not table.base_holds.all():
        lifted = ", ".join(f"C{n + 1}" for n in np.flatnonzero(~table.base_holds)[:5])
        why = f"Goodman & Bray's forces are not admissible at {lifted} (lifted, or slipping back): not compared"
        return ClosedForm(closed.factor or None, closed.status, why), columns
    return ClosedForm(closed.factor or None, closed.status), columns


def _why_not(design: ToppleDesign) -> str:
    """Why Goodman & Bray's method says nothing of a design."""
    sides, base = design.strength(design.sides), design.strength(design.base)
    if sides.cohesion_kpa:
        return "the closed form (Goodman & Bray) knows no cohesion on the sides of columns: not compared"
    if any(design.pressures_kpa):
        return "the closed form (Goodman & Bray) is without water here: not compared"
    if design.forces or design.bolts:
        return "the closed form (Goodman & Bray) is without forces and bolts on single columns: not compared"
    if sides.dilation_deg or base.dilation_deg:
        return "the closed form (Goodman & Bray) knows no dilation: not compared"
    return ""


def _columns(design: ToppleDesign, table: TopplingTable, ways: dict[str, str]) -> list[Column]:
    rows = []
    for k in range(len(table.heights_m)):
        name = design.block_names[k]
        rows.append(
            Column(
                k + 1, float(table.heights_m[k]), _known(table.upper_contact_m[k]), _known(table.lower_contact_m[k]),
                _known(table.topple_force_kn[k]), _known(table.slide_force_kn[k]), _known(table.force_kn[k]),
                _known(table.normal_kn[k]), _known(table.shear_kn[k]), table.modes[k], ways.get(name, "stable"),
            )
        )  # fmt: skip
    return rows


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
