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
    rigid,
    spheres,
)
from slopekit.views.solid.scene_parts import (
    Scenery,
    amount,
    amounts,
    bolt_colour,
    counted,
    ends,
    joint_faces,
    kilonewtons,
    kinds_of_loads,
    millimetres,
    nice,
    resultants,
    spacing,
    spread,
    widened,
)
from slopekit.views.solid.stage import Stage, joint_colour

_THIN, _END = 1.6e-3, 4.5e-3  # of the size: radius of the lines, of the balls at their ends
_ASIDE = 0.05  # of the size: how far before the block the height stands
_SAME = 1e-4  # of the size: what was measured, found again


#: A length as it is called, the two points (3,) that it lies between, and where its number stands.
_Dimension = tuple[str, Floats, Floats, Floats]


def dimensions(stage: Stage) -> list[_Dimension]:
    """Setback, face width and height of the block, of many blocks of those that move first, as far as they are known.

    The numbers are those of the result; the ends are corners of the blocks, or lie square to the crest from one.
    """
    given: Mapping[str, Any] = stage.document.get("geometry" if stage.alone else "mechanism") or {}
    own = stage.free if stage.alone else stage.scene.order == 1
    corners = stage.scene.shapes.solids.vertices[own[stage.of_vertex]]
    height, width, setback = (given.get(key) for key in ("height_m", "face_width_m", "setback_m"))
    if height is None or not len(corners):
        return []
    out, size = _square_to_crest(stage), float(np.ptp(corners, axis=0).max())
    depth, measures = corners @ out, list[_Dimension]()
    if setback:
        behind = depth.min() if (crest := _crest_of_columns(stage)) is None else -crest - setback
        back = corners[np.abs(depth - behind) < _SAME * size]
        back = back[back[:, 2] > back[:, 2].max() - _SAME * size].mean(axis=0)
        at = back + 0.55 * setback * out
        measures.append((f"setback {short(setback)} m", back, back + setback * out, at))
    if width:
        start, end = _across(corners, out, depth.min() + (setback or 0.0), width, size)
        measures.append((f"width {short(width)} m", start, end, start + 0.3 * (end - start)))
    foot = corners[np.argmin(corners[:, 2])] + _ASIDE * size * out
    top = foot + np.array([0.0, 0.0, height])
    return [*measures, (f"height {short(height)} m", foot, top, foot + 0.45 * (top - foot))]


def _across(corners: Floats, out: Floats, crest: float, width: float, size: float) -> tuple[Floats, Floats]:
    """The ends of the width: corners on the crest, or else square to it from the outermost ones."""
    along = cross(np.array([0.0, 0.0, 1.0]), out)
    across, near = corners @ along, np.abs(corners @ out - crest) < _SAME * size
    if near.any():
        start, end = (corners[near][pick(across[near])] for pick in (np.argmin, np.argmax))
        if abs(float(np.sqrt(((end - start) ** 2).sum())) - width) < _SAME * size:
            return start, end
    low = corners[np.argmin(across)]
    return low, low + np.ptp(across) * along


def lines(stage: Stage, measures: Sequence[_Dimension]) -> list[Layer]:
    """Dimensions as thin lines with their ends."""
    if not measures:
        return []
    starts, ends = np.array([start for _, start, _, _ in measures]), np.array([end for _, _, end, _ in measures])
    size = min(stage.size, 2.0 * float(np.sqrt(((ends - starts) ** 2).sum(axis=1)).max()))
    balls = spheres(np.concatenate([starts, ends]), _END * size)
    return [
        layer("dimensions", rods(starts, ends, _THIN * size), DARK, front=2),
        layer("dimensions: ends", balls, DARK, front=2),
    ]


def _crest_of_columns(stage: Stage) -> float | None:
    """How far into the slope from the foot of C1 the crest is, of columns: their bases reach behind their tops."""
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
            level: Floats = flat / np.sqrt(flat @ flat) * np.copysign(1.0, flat @ stage.out)
            return level
    return stage.out


_DRAWN = 0.08  # of the size: what the largest displacement is drawn as, where nothing else is asked for
_EXPLODED = 0.35
_NO_FORCE, _SEEN = 1e-9, 0.03  # of the largest
#: Arrows of one colour: what they are called, what the legend says, where and what they are, whether they push.
_Group = tuple[str, str, Floats, Floats, Colour, bool]
_NO_LIMIT = "no limit state was found: what the joints carry is not known"


def draw(document: Mapping[str, Any], what: str, path: Path, step: int = 1) -> None:
    """Draw a scene of a result to PNG, GLB or glTF.

    Parameters
    ----------
    document : the JSON of a result; what : a key of `SCENES`
    step : the mechanism (1 is the first)

    Raises
    ------
    DesignError
        E140 where pyvista or matplotlib is not installed, E273 and E350 where the document holds no such scene.
    """
    from slopekit.views.solid.rendering import save

    save(compose(document, what, step), path)


def compose(document: Mapping[str, Any], what: str, step: int = 1) -> Picture:
    """The picture of a document.

    Raises
    ------
    DesignError
        E350 no scene, E273 no displacement, mechanism or step.
    """
    return SCENES[what](Stage.of(document), step)


# -- the pictures -----------------------------------------------------------------------------------------------------


def _scene(stage: Stage, _: int) -> Picture:
    shapes, seen = stage.scene.shapes, Scenery(stage)
    seen.rock()
    seen.legend += seen.block_legend(bool(seen.layers))
    seen.blocks("blocks", stage.free)
    if stage.alone and not stage.is_curved:
        for joint, name in enumerate(stage.joint_names()):
            seen.add(shapes.joints[joint], widened(stage, joint, 1.22), joint_colour(joint), opacity=0.55)
            seen.legend.append((name, joint_colour(joint), 0.7))
    if stage.alone and stage.scene.order[0] == 1:
        way = stage.scene.velocity[0, :3]
        length = math.sqrt(float(way @ way))
        if length > 0.05:
            starts = shapes.centroids[:1] + 0.3 * stage.size * free_normal(shapes) * (0.0 if stage.in_section else 1.0)
            body = arrows(starts, 0.3 * stage.size * way[None, :] / length, 0.03 * stage.size)
            seen.add("movement", body, DARK, "movement as it fails", front=1)
    seen.notes.append(seen.measures())
    if stage.is_curved and not (stage.document.get("inputs") or {}).get("profile_m"):
        seen.notes.append("the ground is a mesh of its own: it is not drawn")
    seen.bolts()
    measured = dimensions(stage)
    seen.layers += lines(stage, measured)
    return seen.picture("scene", labels=[*((at, text) for text, _, _, at in measured), *seen.names()])


def _exploded(stage: Stage, _: int) -> Picture:
    shapes, seen = stage.scene.shapes, Scenery(stage)
    moved = _EXPLODED * stage.apart
    if stage.alone:
        seen.rock()
        note = f"the block moved out of the slope by {_EXPLODED:g} of its size"
    else:
        middle = "the middle of the bedrock" if shapes.fixed.any() else "the middle"
        note = f"blocks moved apart by {_EXPLODED:g} of their distance from {middle}"
    seen.legend += seen.block_legend(bool(seen.layers))
    colours = stage.block_colours()
    colours[shapes.fixed] = ROCK
    seen.blocks("blocks", np.ones(len(shapes.names), dtype=bool), offset=moved[stage.of_vertex], colours=colours)
    for joint, body in joint_faces(stage, moved):
        seen.add(shapes.joints[joint], body, joint_colour(joint), stage.joint_names()[joint])
    seen.notes += [note, seen.measures()]
    seen.bolts(moved)
    return seen.picture("exploded", labels=seen.names(moved))


def _tractions(stage: Stage, _: int) -> Picture:
    pairs, seen = stage.scene.pairs, Scenery(stage)
    shown = stage.free if stage.alone else stage.free & stage.touched
    if stage.alone:
        seen.rock(0.55 if stage.in_section else 1.0)
    said = "block" if stage.alone else "blocks whose contacts were solved"
    seen.blocks("blocks", shown, said, opacity=0.12, shade=0.3)
    scale = stage.neighbourhood(shown)
    apart = scale if stage.in_section else spacing(pairs.control_area_m2)
    for k, name in enumerate(MODES):
        own = pairs.mode == k
        if own.any():
            radius = min(0.016 * scale, 0.22 * apart) * (0.6 if k == OPEN else 1.0)
            said = f"{name}: {int(own.sum())} of {len(pairs)} node pairs"
            front = 0 if stage.alone else 1 if k == OPEN else 2
            seen.add(f"node pairs: {name}", spheres(pairs.points_m[own], radius), MODE_COLOURS[name], said, front=front)
    traction = (pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn) / pairs.control_area_m2[:, None]
    size = np.sqrt((traction * traction).sum(axis=1))
    size[pairs.mode == OPEN] = 0.0
    if not size.any():
        seen.notes.append(_NO_LIMIT if len(pairs) else "no node pairs: nothing was solved")
        return seen.picture("tractions", labels=seen.names(only=shown))
    drawn = spread(size)
    longest = float(size.max())
    body = arrows(pairs.points_m[drawn], 0.25 * scale * traction[drawn] / longest, min(0.014 * scale, 0.15 * apart))
    on = " on the block" if stage.alone else " on one of the two blocks, the other has its opposite"
    seen.add("tractions", body, DARK, f"traction{on}, longest {longest:.4g} kPa", front=0 if stage.alone else 3)
    every = int((size > 0.0).sum())
    if len(drawn) < every:
        seen.notes.append(f"{len(drawn)} of {every} tractions are drawn")
    seen.notes.append("tractions at the limit: normal and shear of each pair by the area that it controls")
    return seen.picture("tractions", labels=seen.names(only=shown))


def _forces(stage: Stage, _: int) -> Picture:
    scene, loads, seen = stage.scene, stage.scene.loads, Scenery(stage)
    known = stage.free if stage.alone else stage.balanced
    at, force, joint = resultants(stage, known)
    own = known[loads.block]
    every = np.concatenate([loads.force_kn[own], force])
    longest = float(np.sqrt((every * every).sum(axis=1)).max(initial=0.0))
    scale = stage.neighbourhood(known)
    drawn = 0.65 * scale / max(longest, 1e-300)
    if stage.alone:
        seen.rock(0.35)
    said = "block" if stage.alone else f"blocks in equilibrium ({int(known.sum())})"
    seen.blocks("blocks", known, said, opacity=0.3, shade=0.5)
    seen.notes.append(f"arrows to scale, the longest {kilonewtons(longest)}: forces on the blocks at the limit")
    if not force.any():
        seen.notes = [f"loads to scale, the longest {kilonewtons(longest)}", _NO_LIMIT]
    left = int(stage.free.sum()) - int(known.sum())
    if not stage.alone and left:
        seen.notes.append(f"{left} other blocks are left out: held, or their contacts were not all solved")
    every_size = np.sqrt((loads.force_kn**2).sum(axis=1))
    sizes = [every_size[own & (loads.what == k)] for k in range(len(loads.names))]
    large = [k for k, size in enumerate(sizes) if (size > _NO_FORCE * longest).any()]
    called = seen.load_names()
    alike = kinds_of_loads([called[k] for k in large])
    groups: list[_Group] = []
    for name, kinds in alike:
        which = [large[k] for k in kinds]
        of = own & np.isin(loads.what, which)
        said = amounts(name, [sizes[k] for k in which])
        colour = bolt_colour(called[which[0]]) or LOADS[which[0] % len(LOADS)]
        groups.append((name, said, loads.at_m[of], loads.force_kn[of], colour, name[:5] == "water"))
    for k, joint_name in enumerate(scene.shapes.joints):
        name = f"{joint_name} on the block" if stage.alone else joint_name
        size = np.sqrt((force[joint == k] ** 2).sum(axis=1))
        if (size > _NO_FORCE * longest).any():
            groups.append((name, amount(name, size), at[joint == k], force[joint == k], joint_colour(k), True))
    seen.bolts(rods_said="rods and plates show where bolts are, arrows their forces")
    for name, said, points, forces, colour, pushes in groups:
        vectors = drawn * forces
        unseen = " (too small to be seen)" if float((forces**2).sum(axis=1).max()) < (_SEEN * longest) ** 2 else ""
        seen.add(name, arrows(points - (vectors if pushes else 0.0), vectors, 0.022 * scale), colour, said + unseen,
                 front=1)  # fmt: skip
    return seen.picture("forces", labels=seen.names(only=known))


def _displacement(stage: Stage, _: int) -> Picture:
    scene = stage.scene
    if scene.displacement is None:
        limit = (stage.document.get("fos") or {}).get("limit")
        stands = stage.document.get("status") == "no_driving_force" or (limit is not None and limit > 1.0)
        many = "the blocks are too many, or " if not stage.alone and stands else ""
        why = f"{many}they do not come to rest" if stands else "at full strength it does not stand"
        advice = "How it moves as it fails: slopekit plot result.json mechanism"
        raise DesignError([Fault("E273", f"there is no displacement at full strength: {why}", "displacement", advice)])
    true = rigid(scene.shapes, scene.displacement, scene.shapes.solids.vertices, stage.of_vertex)
    most = float(np.sqrt((true * true).sum(axis=1)).max())
    times = nice(_DRAWN * stage.size / max(most, 1e-300))
    moved = rigid(scene.shapes, scene.displacement * times, scene.shapes.solids.vertices, stage.of_vertex)
    centroids = np.sqrt((scene.displacement[:, :3] ** 2).sum(axis=1))
    first = int(np.argmax(centroids))
    seen = Scenery(stage)
    seen.rock()
    seen.blocks("at rest", stage.free, "as it was", opacity=0.2)
    seen.blocks("displaced", stage.free, f"displaced, {times:,.6g} times", offset=moved)
    down = millimetres(-float(scene.displacement[first, 2]))
    turned = math.degrees(math.sqrt(float(scene.displacement[first, 3:] @ scene.displacement[first, 3:])))
    whose = "centroid" if stage.alone else f"centroid of {scene.shapes.names[first]}"
    seen.notes.append(
        f"displacement at full strength on the elastic bed, magnified {times:,.6g} times: largest {millimetres(most)}, "
        f"{whose} {millimetres(float(centroids[first]))} ({down} down), turned by {turned:.3g}°"
    )
    return seen.picture("displacement")


def _mechanism(stage: Stage, step: int) -> Picture:
    scene, shapes = stage.scene, stage.scene.shapes
    last = int(scene.order.max(initial=0))
    if last == 0:
        raise DesignError([Fault("E273", f"nothing moves: {stage.document.get('status_text')}", "mechanism")])
    if not 1 <= step <= last:
        known = f"there are {last} mechanisms" if last > 1 else "there is one mechanism"
        advice = "More of them: analysis: {mechanisms: N} in the design."
        raise DesignError([Fault("E273", f"there is no mechanism {step}: {known}", "--step", advice)])
    moving = scene.order == step
    gone = (scene.order > 0) & (scene.order < step)
    unit = rigid(shapes, np.where(moving[:, None], scene.velocity, 0.0), shapes.solids.vertices, stage.of_vertex)
    fastest = max(float(np.sqrt((unit * unit).sum(axis=1)).max()), 1e-300)
    reach = 0.3 * float(stage.sizes[moving].mean()) if not stage.alone else 0.14 * stage.size
    times = reach / fastest
    moved = rigid(shapes, scene.velocity * times, shapes.solids.vertices, stage.of_vertex)
    how = stage.ways(step)
    colours = stage.block_colours()
    for k in np.flatnonzero(moving):
        colours[k] = MOTION_COLOURS.get(how.get(shapes.names[k], ""), BLOCK)
    seen, still = Scenery(stage), stage.free & ~moving & ~gone
    seen.rock()
    for way, count in counted(how, shapes.names, moving):
        said = f"{MOTIONS.get(way, way)}: {count}" if way else "moves"
        seen.legend.append((said, MOTION_COLOURS.get(way, BLOCK), 1.0))
    if still.any():
        colours[still] = STANDS
        seen.blocks("at rest", still, colours=colours)
        seen.legend.append(("at rest", STANDS, 1.0))
    seen.blocks("where they were", moving, opacity=0.15, colours=colours)
    seen.blocks("moving", moving, offset=moved, colours=colours)
    own = np.flatnonzero(moving)
    speed = np.sqrt((scene.velocity[own, :3] ** 2).sum(axis=1))
    kept = spread(speed)
    own, speed = own[kept], speed[kept]
    length = 0.3 * stage.size if stage.alone else 0.8 * float(stage.sizes[moving].mean())
    starts = shapes.centroids[own] + scene.velocity[own, :3] * times
    fast = max(float(speed.max(initial=0.0)), 1e-300)
    body = arrows(starts, scene.velocity[own, :3] * (length / fast), 0.06 * length)
    seen.add("velocity", body, DARK, "velocity of the centroids", front=1)
    seen.notes.append(
        "a mechanism has proportions, no size: drawn so that it is seen, and so far that blocks may cut into others"
    )
    if gone.any():
        seen.notes.append(f"{int(gone.sum())} blocks that failed before are left out")
    what = "mechanism" if last == 1 else f"mechanism {step} of {last}"
    labels = seen.names(scene.velocity[:, :3] * times, moving)
    return seen.picture(what, labels=labels, answer=_answer_of(stage, step))


def _answer_of(stage: Stage, step: int) -> str:
    """Status and factor of a later mechanism; "" where it is the result's."""
    if step == 1 or step > len(stage.mechanisms):
        return ""
    one = stage.mechanisms[step - 1]
    factor = "no factor of safety" if one.get("fos") is None else f"FoS {factor_text(one['fos'])} (PRE-IE)"
    return f"mechanism {step}: {status_text(stage.kind, str(one.get('status')))} · {factor} · what moved before is gone"


def _factors(stage: Stage, _: int) -> Picture:
    """Blocks by the factor of safety at which they fail."""
    factor, fixed = stage.scene.factor, stage.scene.shapes.fixed
    known = np.isfinite(factor)
    falls, unsettled = stage.without_strength & ~known, stage.unsettled & ~known
    without = "no factor of safety" if stage.alone else "no factor: it stands, or was not looked at"
    seen, colours = Scenery(stage), np.tile(np.array(STANDS), (len(factor), 1))
    bar = Bar("factor of safety at which a block fails", *ends(factor[known])) if known.any() else None
    if bar is not None:
        colours[known] = bar.colours(factor[known])
        if not np.ptp(factor[known]) > 1e-9 * float(factor[known].max()):  # one value needs no scale
            red, green, blue = colours[known][0].tolist()
            said = f"fails at {float(factor[known][0]):.3f} ({int(known.sum())})"
            seen.legend.append((said, (red, green, blue), 1.0))
            bar = None
    for own, colour, said in (
        (stage.free & ~known & ~falls & ~unsettled, STANDS, without),
        (falls, FALLS, "held by no strength that was tried"),
        (unsettled, UNSETTLED, "moves in a mechanism that did not settle"), (fixed, ROCK, "bedrock"),
    ):  # fmt: skip
        if own.any():
            colours[own] = colour
            seen.legend.append((f"{said} ({int(own.sum())})", colour, 1.0))
    if not stage.alone:
        seen.notes.append("a block that only the one before it held fails together with it")
    seen.rock()
    seen.blocks("blocks", stage.free, colours=colours)
    return seen.picture("factors", bar=bar)


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
