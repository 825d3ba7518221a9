"""Scenes: the slope with its blocks, in place, apart, as they move, and with what the node pairs carry.

Made of the JSON of a result (`scene` and what stands beside it), drawn by `solid.rendering`.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.block_scene import MODES, OPEN
from slopekit.bolts import rods
from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import DesignError, Fault
from slopekit.core.orientation import parse_plane
from slopekit.core.sheet import factor_text
from slopekit.findings import MOTIONS
from slopekit.kinds import status_text
from slopekit.kinds.words import short
from slopekit.views.solid.layers import (
    BLOCK,
    DARK,
    FALLS,
    LOADS,
    MODE_COLOURS,
    MOTION_COLOURS,
    ROCK,
    STANDS,
    UNSETTLED,
    Bar,
    Colour,
    Layer,
    Picture,
    arrows,
    free_normal,
    layer,
    rigid_displacement,
    spheres,
)
from slopekit.views.solid.scene_parts import (
    Scenery,
    bolt_colour,
    colour_bar_range,
    drawn_arrows,
    grouped_loads,
    joint_faces,
    kilonewtons,
    load_summary,
    loads_summary,
    millimetres,
    movement_counts,
    pair_spacing,
    resultants,
    rounded_down_125,
    widened_joint,
)
from slopekit.views.solid.stage import Stage, joint_colour

_THIN, _END = 1.6e-3, 4.5e-3  # of the size: radius of the lines, of the balls at their ends
_HEIGHT_OFFSET = 0.05  # of the size: how far before the block the height stands
_SAME_LENGTH = 1e-4  # of the size: what was measured, found again


#: A length as it is called, the two points (3,) that it lies between, and where its number stands.
_Dimension = tuple[str, Floats, Floats, Floats]


def dimensions(stage: Stage) -> list[_Dimension]:
    """Setback, face width and height of the block, of many blocks of those that move first, as far as they are known.

    The numbers are those of the result; the ends are corners of the blocks, or lie square to the crest from one.
    """
    record: Mapping[str, Any] = (
        stage.document.get("geometry" if stage.has_single_block else "mechanism") or {}
    )
    is_measured = stage.free if stage.has_single_block else stage.scene.order == 1
    corners = stage.scene.shapes.solids.vertices[is_measured[stage.vertex_block]]
    height, width, setback = (record.get(key) for key in ("height_m", "face_width_m", "setback_m"))
    if height is None or not len(corners):
        return []
    outward, size = _square_to_crest(stage), float(np.ptp(corners, axis=0).max())
    depth, measures = corners @ outward, list[_Dimension]()
    if setback:
        behind = depth.min() if (crest := _crest_of_columns(stage)) is None else -crest - setback
        back = corners[np.abs(depth - behind) < _SAME_LENGTH * size]
        back = back[back[:, 2] > back[:, 2].max() - _SAME_LENGTH * size].mean(axis=0)
        label_point = back + 0.55 * setback * outward
        measures.append(
            (f"setback {short(setback)} m", back, back + setback * outward, label_point)
        )
    if width:
        start, end = _crest_ends(corners, outward, depth.min() + (setback or 0.0), width, size)
        measures.append((f"width {short(width)} m", start, end, start + 0.3 * (end - start)))
    foot = corners[np.argmin(corners[:, 2])] + _HEIGHT_OFFSET * size * outward
    top = foot + np.array([0.0, 0.0, height])
    return [*measures, (f"height {short(height)} m", foot, top, foot + 0.45 * (top - foot))]


def _crest_ends(
    corners: Floats, outward: Floats, crest: float, width: float, size: float
) -> tuple[Floats, Floats]:
    """The ends of the width: corners on the crest, or else square to it from the outermost ones."""
    along = cross(np.array([0.0, 0.0, 1.0]), outward)
    across, on_crest = corners @ along, np.abs(corners @ outward - crest) < _SAME_LENGTH * size
    if on_crest.any():
        start, end = (corners[on_crest][pick(across[on_crest])] for pick in (np.argmin, np.argmax))
        if abs(float(np.sqrt(((end - start) ** 2).sum())) - width) < _SAME_LENGTH * size:
            return start, end
    low = corners[np.argmin(across)]
    return low, low + np.ptp(across) * along


def dimension_lines(stage: Stage, measures: Sequence[_Dimension]) -> list[Layer]:
    """Dimensions as thin lines with their ends."""
    if not measures:
        return []
    starts, ends = (
        np.array([start for _, start, _, _ in measures]),
        np.array([end for _, _, end, _ in measures]),
    )
    size = min(stage.size, 2.0 * float(np.sqrt(((ends - starts) ** 2).sum(axis=1)).max()))
    balls = spheres(np.concatenate([starts, ends]), _END * size)
    return [
        layer("dimensions", rods(starts, ends, _THIN * size), DARK, front=2),
        layer("dimensions: ends", balls, DARK, front=2),
    ]


def _crest_of_columns(stage: Stage) -> float | None:
    """Return the distance of the crest from the foot of C1 into the slope, of columns."""
    inputs = stage.document.get("inputs") or {}
    height, face = inputs.get("slope_height_m"), inputs.get("slope_face_deg")
    return None if height is None or face is None else height / math.tan(math.radians(face))


def _square_to_crest(stage: Stage) -> Floats:
    """(3,) unit and level, out of the slope and square to its crest."""
    inputs = stage.document.get("inputs") or {}
    face, upper = inputs.get("face"), inputs.get("upper")
    if isinstance(face, str) and isinstance(upper, str):
        edge = cross(parse_plane(face, "face").normal(), parse_plane(upper, "upper").normal())
        flat = np.array([-edge[1], edge[0], 0.0])
        if flat.any():
            level: Floats = flat / np.sqrt(flat @ flat) * np.copysign(1.0, flat @ stage.outward)
            return level
    return stage.outward


_DISPLACEMENT_LENGTH = (
    0.08  # of the size: what the largest displacement is drawn as, where nothing else is asked for
)
_EXPLODED = 0.35
_NO_FORCE, _VISIBLE_FORCE = 1e-9, 0.03  # of the largest
#: Arrows of one colour: what they are called, what the legend says, where and what they are, whether they push.
_Group = tuple[str, str, Floats, Floats, Colour, bool]
_NO_LIMIT = "no limit state was found: what the joints carry is not known"


def draw(document: Mapping[str, Any], scene: str, path: Path, step: int = 1) -> None:
    """Draw a scene of a result to PNG, GLB or glTF.

    Parameters
    ----------
    document : the JSON of a result; scene : a key of `SCENES`
    step : the mechanism (1 is the first)

    Raises
    ------
    DesignError
        E140 where pyvista or matplotlib is not installed, E273 and E350 where the document holds no such scene.
    """
    from slopekit.views.solid.rendering import save

    save(compose(document, scene, step), path)


def compose(document: Mapping[str, Any], scene: str, step: int = 1) -> Picture:
    """The picture of a document.

    Raises
    ------
    DesignError
        E350 no scene, E273 no displacement, mechanism or step.
    """
    return SCENES[scene](Stage.from_document(document), step)


# -- the pictures -----------------------------------------------------------------------------------------------------


def _scene(stage: Stage, _: int) -> Picture:
    shapes, scenery = stage.scene.shapes, Scenery(stage)
    scenery.rock()
    scenery.legend += scenery.block_legend(bool(scenery.layers))
    scenery.blocks("blocks", stage.free)
    if stage.has_single_block and not stage.is_curved:
        for joint, name in enumerate(stage.joint_names()):
            scenery.add(
                shapes.joints[joint],
                widened_joint(stage, joint, 1.22),
                joint_colour(joint),
                opacity=0.55,
            )
            scenery.legend.append((name, joint_colour(joint), 0.7))
    if stage.has_single_block and stage.scene.order[0] == 1:
        velocity = stage.scene.velocity[0, :3]
        length = math.sqrt(float(velocity @ velocity))
        if length > 0.05:
            starts = shapes.centroids[:1] + 0.3 * stage.size * free_normal(shapes) * (
                0.0 if stage.in_section else 1.0
            )
            body = arrows(starts, 0.3 * stage.size * velocity[None, :] / length, 0.03 * stage.size)
            scenery.add("movement", body, DARK, "movement as it fails", front=1)
    scenery.notes.append(scenery.measures())
    if stage.is_curved and not (stage.document.get("inputs") or {}).get("profile_m"):
        scenery.notes.append("the ground is a mesh of its own: it is not drawn")
    scenery.bolts()
    measured = dimensions(stage)
    scenery.layers += dimension_lines(stage, measured)
    return scenery.picture(
        "scene",
        labels=[*((label_point, text) for text, _, _, label_point in measured), *scenery.names()],
    )


def _exploded(stage: Stage, _: int) -> Picture:
    shapes, scenery = stage.scene.shapes, Scenery(stage)
    block_offset = _EXPLODED * stage.explosion_vectors
    if stage.has_single_block:
        scenery.rock()
        note = f"the block moved out of the slope by {_EXPLODED:g} of its size"
    else:
        middle = "the middle of the bedrock" if shapes.fixed.any() else "the middle"
        note = f"blocks moved apart by {_EXPLODED:g} of their distance from {middle}"
    scenery.legend += scenery.block_legend(bool(scenery.layers))
    colours = stage.block_colours()
    colours[shapes.fixed] = ROCK
    scenery.blocks(
        "blocks",
        np.ones(len(shapes.names), dtype=bool),
        offset=block_offset[stage.vertex_block],
        colours=colours,
    )
    for joint, body in joint_faces(stage, block_offset):
        scenery.add(shapes.joints[joint], body, joint_colour(joint), stage.joint_names()[joint])
    scenery.notes += [note, scenery.measures()]
    scenery.bolts(block_offset)
    return scenery.picture("exploded", labels=scenery.names(block_offset))


def _tractions(stage: Stage, _: int) -> Picture:
    pairs, scenery = stage.scene.pairs, Scenery(stage)
    chosen = stage.free if stage.has_single_block else stage.free & stage.has_node_pairs
    if stage.has_single_block:
        scenery.rock(0.55 if stage.in_section else 1.0)
    legend_text = "block" if stage.has_single_block else "blocks whose contacts were solved"
    scenery.blocks("blocks", chosen, legend_text, opacity=0.12, shade=0.3)
    scale = stage.neighbourhood(chosen)
    pair_distance = scale if stage.in_section else pair_spacing(pairs.control_area_m2)
    for k, name in enumerate(MODES):
        in_mode = pairs.mode == k
        if in_mode.any():
            radius = min(0.016 * scale, 0.22 * pair_distance) * (0.6 if k == OPEN else 1.0)
            legend_text = f"{name}: {int(in_mode.sum())} of {len(pairs)} node pairs"
            front = 0 if stage.has_single_block else 1 if k == OPEN else 2
            scenery.add(
                f"node pairs: {name}",
                spheres(pairs.points_m[in_mode], radius),
                MODE_COLOURS[name],
                legend_text,
                front=front,
            )
    traction = (pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn) / pairs.control_area_m2[
        :, None
    ]
    size = np.sqrt((traction * traction).sum(axis=1))
    size[pairs.mode == OPEN] = 0.0
    if not size.any():
        scenery.notes.append(_NO_LIMIT if len(pairs) else "no node pairs: nothing was solved")
        return scenery.picture("tractions", labels=scenery.names(restricted_to=chosen))
    arrow_pairs = drawn_arrows(size)
    longest = float(size.max())
    body = arrows(
        pairs.points_m[arrow_pairs],
        0.25 * scale * traction[arrow_pairs] / longest,
        min(0.014 * scale, 0.15 * pair_distance),
    )
    acting_on = (
        " on the block"
        if stage.has_single_block
        else " on one of the two blocks, the other has its opposite"
    )
    scenery.add(
        "tractions",
        body,
        DARK,
        f"traction{acting_on}, longest {longest:.4g} kPa",
        front=0 if stage.has_single_block else 3,
    )
    arrow_count = int((size > 0.0).sum())
    if len(arrow_pairs) < arrow_count:
        scenery.notes.append(f"{len(arrow_pairs)} of {arrow_count} tractions are drawn")
    scenery.notes.append(
        "tractions at the limit: normal and shear of each pair by the area that it controls"
    )
    return scenery.picture("tractions", labels=scenery.names(restricted_to=chosen))


def _forces(stage: Stage, _: int) -> Picture:
    scene, loads, scenery = stage.scene, stage.scene.loads, Scenery(stage)
    in_equilibrium = stage.free if stage.has_single_block else stage.balanced
    points_m, force, joint = resultants(stage, in_equilibrium)
    is_drawn = in_equilibrium[loads.block]
    all_forces = np.concatenate([loads.force_kn[is_drawn], force])
    longest = float(np.sqrt((all_forces * all_forces).sum(axis=1)).max(initial=0.0))
    scale = stage.neighbourhood(in_equilibrium)
    metres_per_kn = 0.65 * scale / max(longest, 1e-300)
    if stage.has_single_block:
        scenery.rock(0.35)
    legend_text = (
        "block"
        if stage.has_single_block
        else f"blocks in equilibrium ({int(in_equilibrium.sum())})"
    )
    scenery.blocks("blocks", in_equilibrium, legend_text, opacity=0.3, shade=0.5)
    scenery.notes.append(
        f"arrows to scale, the longest {kilonewtons(longest)}: forces on the blocks at the limit"
    )
    if not force.any():
        scenery.notes = [f"loads to scale, the longest {kilonewtons(longest)}", _NO_LIMIT]
    omitted = int(stage.free.sum()) - int(in_equilibrium.sum())
    if not stage.has_single_block and omitted:
        scenery.notes.append(
            f"{omitted} other blocks are left out: held, or their contacts were not all solved"
        )
    load_sizes = np.sqrt((loads.force_kn**2).sum(axis=1))
    sizes = [load_sizes[is_drawn & (loads.what == k)] for k in range(len(loads.names))]
    large = [k for k, size in enumerate(sizes) if (size > _NO_FORCE * longest).any()]
    load_names = scenery.load_names()
    legend_lines = grouped_loads([load_names[k] for k in large])
    groups: list[_Group] = []
    for name, kinds in legend_lines:
        load_indices = [large[k] for k in kinds]
        in_group = is_drawn & np.isin(loads.what, load_indices)
        legend_text = loads_summary(name, [sizes[k] for k in load_indices])
        colour = bolt_colour(load_names[load_indices[0]]) or LOADS[load_indices[0] % len(LOADS)]
        groups.append(
            (
                name,
                legend_text,
                loads.at_m[in_group],
                loads.force_kn[in_group],
                colour,
                name[:5] == "water",
            )
        )
    for k, joint_name in enumerate(scene.shapes.joints):
        name = f"{joint_name} on the block" if stage.has_single_block else joint_name
        size = np.sqrt((force[joint == k] ** 2).sum(axis=1))
        if (size > _NO_FORCE * longest).any():
            groups.append(
                (
                    name,
                    load_summary(name, size),
                    points_m[joint == k],
                    force[joint == k],
                    joint_colour(k),
                    True,
                )
            )
    scenery.bolts(rods_note="rods and plates show where bolts are, arrows their forces")
    for name, legend_text, points, forces, colour, pushes in groups:
        vectors = metres_per_kn * forces
        unseen = (
            " (too small to be seen)"
            if float((forces**2).sum(axis=1).max()) < (_VISIBLE_FORCE * longest) ** 2
            else ""
        )
        scenery.add(
            name,
            arrows(points - (vectors if pushes else 0.0), vectors, 0.022 * scale),
            colour,
            legend_text + unseen,
            front=1,
        )
    return scenery.picture("forces", labels=scenery.names(restricted_to=in_equilibrium))


def _displacement(stage: Stage, _: int) -> Picture:
    scene = stage.scene
    if scene.displacement is None:
        limit = (stage.document.get("fos") or {}).get("limit")
        is_stable = stage.document.get("status") == "no_driving_force" or (
            limit is not None and limit > 1.0
        )
        many = "the blocks are too many, or " if not stage.has_single_block and is_stable else ""
        reason = (
            f"{many}they do not come to rest" if is_stable else "at full strength it does not stand"
        )
        advice = "How it moves as it fails: slopekit plot result.json mechanism"
        raise DesignError(
            [
                Fault(
                    "E273",
                    f"there is no displacement at full strength: {reason}",
                    "displacement",
                    advice,
                )
            ]
        )
    displacement = rigid_displacement(
        scene.shapes, scene.displacement, scene.shapes.solids.vertices, stage.vertex_block
    )
    largest = float(np.sqrt((displacement * displacement).sum(axis=1)).max())
    magnification = rounded_down_125(_DISPLACEMENT_LENGTH * stage.size / max(largest, 1e-300))
    magnified = rigid_displacement(
        scene.shapes,
        scene.displacement * magnification,
        scene.shapes.solids.vertices,
        stage.vertex_block,
    )
    centroids = np.sqrt((scene.displacement[:, :3] ** 2).sum(axis=1))
    first = int(np.argmax(centroids))
    scenery = Scenery(stage)
    scenery.rock()
    scenery.blocks("at rest", stage.free, "as it was", opacity=0.2)
    scenery.blocks(
        "displaced", stage.free, f"displaced, {magnification:,.6g} times", offset=magnified
    )
    down = millimetres(-float(scene.displacement[first, 2]))
    rotation_deg = math.degrees(
        math.sqrt(float(scene.displacement[first, 3:] @ scene.displacement[first, 3:]))
    )
    centroid_name = (
        "centroid" if stage.has_single_block else f"centroid of {scene.shapes.names[first]}"
    )
    scenery.notes.append(
        f"displacement at full strength on the elastic bed, magnified {magnification:,.6g} times: "
        f"largest {millimetres(largest)}, "
        f"{centroid_name} {millimetres(float(centroids[first]))} ({down} down), turned by {rotation_deg:.3g}°"
    )
    return scenery.picture("displacement")


def _mechanism(stage: Stage, step: int) -> Picture:
    scene, shapes = stage.scene, stage.scene.shapes
    last = int(scene.order.max(initial=0))
    if last == 0:
        raise DesignError(
            [Fault("E273", f"nothing moves: {stage.document.get('status_text')}", "mechanism")]
        )
    if not 1 <= step <= last:
        mechanism_count = f"there are {last} mechanisms" if last > 1 else "there is one mechanism"
        advice = "More of them: analysis: {mechanisms: N} in the design."
        raise DesignError(
            [Fault("E273", f"there is no mechanism {step}: {mechanism_count}", "--step", advice)]
        )
    moving = scene.order == step
    has_failed = (scene.order > 0) & (scene.order < step)
    unit = rigid_displacement(
        shapes,
        np.where(moving[:, None], scene.velocity, 0.0),
        shapes.solids.vertices,
        stage.vertex_block,
    )
    fastest = max(float(np.sqrt((unit * unit).sum(axis=1)).max()), 1e-300)
    reach = (
        0.3 * float(stage.sizes[moving].mean()) if not stage.has_single_block else 0.14 * stage.size
    )
    magnification = reach / fastest
    displacement = rigid_displacement(
        shapes, scene.velocity * magnification, shapes.solids.vertices, stage.vertex_block
    )
    movement_of_block = stage.movements(step)
    colours = stage.block_colours()
    for k in np.flatnonzero(moving):
        colours[k] = MOTION_COLOURS.get(movement_of_block.get(shapes.names[k], ""), BLOCK)
    scenery, at_rest = Scenery(stage), stage.free & ~moving & ~has_failed
    scenery.rock()
    for movement, count in movement_counts(movement_of_block, shapes.names, moving):
        legend_text = f"{MOTIONS.get(movement, movement)}: {count}" if movement else "moves"
        scenery.legend.append((legend_text, MOTION_COLOURS.get(movement, BLOCK), 1.0))
    if at_rest.any():
        colours[at_rest] = STANDS
        scenery.blocks("at rest", at_rest, colours=colours)
        scenery.legend.append(("at rest", STANDS, 1.0))
    scenery.blocks("where they were", moving, opacity=0.15, colours=colours)
    scenery.blocks("moving", moving, offset=displacement, colours=colours)
    moving_blocks = np.flatnonzero(moving)
    speed = np.sqrt((scene.velocity[moving_blocks, :3] ** 2).sum(axis=1))
    arrow_blocks = drawn_arrows(speed)
    moving_blocks, speed = moving_blocks[arrow_blocks], speed[arrow_blocks]
    length = 0.3 * stage.size if stage.has_single_block else 0.8 * float(stage.sizes[moving].mean())
    starts = shapes.centroids[moving_blocks] + scene.velocity[moving_blocks, :3] * magnification
    fast = max(float(speed.max(initial=0.0)), 1e-300)
    body = arrows(starts, scene.velocity[moving_blocks, :3] * (length / fast), 0.06 * length)
    scenery.add("velocity", body, DARK, "velocity of the centroids", front=1)
    scenery.notes.append(
        "a mechanism has proportions, no size: drawn so that it is seen, and so far that blocks may cut into others"
    )
    if has_failed.any():
        scenery.notes.append(f"{int(has_failed.sum())} blocks that failed before are left out")
    subject = "mechanism" if last == 1 else f"mechanism {step} of {last}"
    labels = scenery.names(scene.velocity[:, :3] * magnification, moving)
    return scenery.picture(subject, labels=labels, answer=_mechanism_answer(stage, step))


def _mechanism_answer(stage: Stage, step: int) -> str:
    """Status and factor of a later mechanism; "" where it is the result's."""
    if step == 1 or step > len(stage.mechanisms):
        return ""
    mechanism = stage.mechanisms[step - 1]
    factor = (
        "no factor of safety"
        if mechanism.get("fos") is None
        else f"FoS {factor_text(mechanism['fos'])} (PRE-IE)"
    )
    return (
        f"mechanism {step}: {status_text(stage.kind, str(mechanism.get('status')))}"
        f" · {factor} · what moved before is gone"
    )


def _factors(stage: Stage, _: int) -> Picture:
    """Blocks by the factor of safety at which they fail."""
    factor, fixed = stage.scene.factor, stage.scene.shapes.fixed
    has_factor = np.isfinite(factor)
    falls, unsettled = stage.without_strength & ~has_factor, stage.unsettled & ~has_factor
    no_factor_text = (
        "no factor of safety"
        if stage.has_single_block
        else "no factor: it stands, or was not looked at"
    )
    scenery, colours = Scenery(stage), np.tile(np.array(STANDS), (len(factor), 1))
    bar = (
        Bar("factor of safety at which a block fails", *colour_bar_range(factor[has_factor]))
        if has_factor.any()
        else None
    )
    if bar is not None:
        colours[has_factor] = bar.colours(factor[has_factor])
        if not np.ptp(factor[has_factor]) > 1e-9 * float(
            factor[has_factor].max()
        ):  # one value needs no scale
            red, green, blue = colours[has_factor][0].tolist()
            legend_text = f"fails at {float(factor[has_factor][0]):.3f} ({int(has_factor.sum())})"
            scenery.legend.append((legend_text, (red, green, blue), 1.0))
            bar = None
    for in_group, colour, legend_text in (
        (stage.free & ~has_factor & ~falls & ~unsettled, STANDS, no_factor_text),
        (falls, FALLS, "held by no strength that was tried"),
        (unsettled, UNSETTLED, "moves in a mechanism that did not settle"),
        (fixed, ROCK, "bedrock"),
    ):
        if in_group.any():
            colours[in_group] = colour
            scenery.legend.append((f"{legend_text} ({int(in_group.sum())})", colour, 1.0))
    if not stage.has_single_block:
        scenery.notes.append("a block that only the one before it held fails together with it")
    scenery.rock()
    scenery.blocks("blocks", stage.free, colours=colours)
    return scenery.picture("factors", bar=bar)


#: Who puts a scene together, by its word: of the stage and the mechanism, 1 the first.
SCENES: Mapping[str, Callable[[Stage, int], Picture]] = {
    "scene": _scene,
    "exploded": _exploded,
    "tractions": _tractions,
    "forces": _forces,
    "displacement": _displacement,
    "mechanism": _mechanism,
    "factors": _factors,
}
