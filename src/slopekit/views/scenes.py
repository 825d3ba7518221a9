"""Scenes: the slope with its blocks, in place, apart, as they move, and with what the node pairs carry.

Made of the JSON of a result (`scene` and what stands beside it), drawn by `views.rendering`.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.block_scene import MODES, OPEN
from slopekit.errors import DesignError, Fault
from slopekit.findings import MOTIONS
from slopekit.kinds import status_text
from slopekit.views.layers import (
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
    Picture,
    arrows,
    blocks_layer,
    free_normal,
    layer,
    rigid,
    spheres,
)
from slopekit.views.scene_parts import (
    Legend,
    amount,
    amounts,
    balanced,
    block_legend,
    bolt_colour,
    bolt_layers,
    counted,
    ends,
    has_contacts,
    joint_faces,
    kilonewtons,
    kinds_of_loads,
    load_names,
    measures,
    millimetres,
    names,
    neighbourhood,
    nice,
    picture,
    resultants,
    spacing,
    spread,
    touched,
    unsettled,
    ways,
    widened,
    without_strength,
)
from slopekit.views.stage import Stage, joint_colour

#: What can be drawn of a result, and what it shows.
SCENES: Mapping[str, str] = {
    "scene": "the slope with its blocks and joints",
    "exploded": "the blocks apart, their joints coloured",
    "tractions": "node pairs by contact mode, and the tractions that they carry at the limit",
    "forces": "the loads, and the resultants on the joints, to scale",
    "displacement": "the displacement at full strength, magnified",
    "mechanism": "how the blocks move as they fail",
    "factors": "blocks coloured by the factor of safety at which they fail",
    "ravelling": "blocks coloured by the order in which they fail",
}
_DRAWN = 0.08  # of the size: what the largest displacement is drawn as, where nothing else is asked for
_EXPLODED = 0.35
_NO_FORCE, _SEEN = 1e-9, 0.03  # of the largest
#: Arrows of one colour: what they are called, what the legend says, where and what they are, whether they push.
_Group = tuple[str, str, Floats, Floats, Colour, bool]
_NO_LIMIT = "no limit state was found: what the joints carry is not known"


@dataclass(frozen=True, slots=True)
class Asked:
    """What a user asks of a scene; None takes what fits it."""

    explode: float | None = None
    magnify: float | None = None
    step: int = 1


def draw(
    document: Mapping[str, Any], what: str, path: Path | None, *, show: bool = False, explode: float | None = None,
    magnify: float | None = None, step: int = 1,
) -> None:  # fmt: skip
    """Draw a scene of a result to PNG, GLB or glTF, or in a window.

    Parameters
    ----------
    document : the JSON of a result; what : a key of `SCENES`
    explode : how far blocks are moved apart, in parts of their distance from the middle
    magnify : times the displacement is drawn; step : the mechanism (1 is the first)

    Raises
    ------
    DesignError
        E140 where pyvista or matplotlib is not installed, E350 to E354 where the document holds no such scene, E346
        without a display.
    """
    from slopekit.views.rendering import save, show_window

    picture = compose(document, what, Asked(explode, magnify, step))
    if show:
        show_window(picture)
    elif path is not None:
        save(picture, path)


def compose(document: Mapping[str, Any], what: str, asked: Asked | None = None) -> Picture:
    """The picture of a document.

    Raises
    ------
    DesignError
        E350 no scene, E351 no displacement, E352 no mechanism, E353 no such step, E354 a magnification that is none.
    """
    wanted = asked or Asked()
    for name, value in (("explode", wanted.explode), ("magnify", wanted.magnify)):
        if value is not None and not (math.isfinite(value) and value >= 0.0):
            raise DesignError([Fault("E354", f"--{name} is {value:g}, a number of 0 or more is needed", f"--{name}")])
    return _COMPOSERS[what](Stage.of(document), wanted)


# -- the pictures -----------------------------------------------------------------------------------------------------


def _scene(stage: Stage, _: Asked) -> Picture:
    shapes = stage.scene.shapes
    layers = stage.rock()
    layers.append(blocks_layer("blocks", shapes, stage.free, stage.block_colours(), stage.still))
    legend = block_legend(stage, bool(layers[:-1]))
    if stage.alone and not stage.is_curved:
        for joint in range(len(shapes.joints)):
            layers.append(widened(stage, joint, 1.22))
            legend.append((stage.joint_names()[joint], joint_colour(joint), 0.7))
    moving = np.flatnonzero(stage.scene.order == 1)
    if stage.alone and len(moving):
        way = stage.scene.velocity[0, :3]
        length = math.sqrt(float(way @ way))
        if length > 0.05:
            starts = shapes.centroids[:1] + 0.3 * stage.size * free_normal(shapes) * (0.0 if stage.in_section else 1.0)
            body = arrows(starts, 0.3 * stage.size * way[None, :] / length, 0.03 * stage.size)[:2]
            layers.append(layer("movement", body, DARK, front=1))
            legend.append(("movement as it fails", DARK, 1.0))
    rods, named, said = bolt_layers(stage)
    notes = [*_scene_notes(stage), *said]
    return picture(stage, "scene", [*layers, *rods], [*legend, *named], notes=notes, labels=names(stage))


def _scene_notes(stage: Stage) -> tuple[str, ...]:
    bare = "the ground is a mesh of its own: it is not drawn"
    without = stage.is_curved and not (stage.document.get("inputs") or {}).get("profile_m")
    return (measures(stage), *[bare] * without)


def _exploded(stage: Stage, asked: Asked) -> Picture:
    scene, shapes = stage.scene, stage.scene.shapes
    apart = _EXPLODED if asked.explode is None else asked.explode
    if stage.alone:
        moved = apart * stage.size * free_normal(shapes)[None, :]
    else:
        own = shapes.fixed if shapes.fixed.any() else stage.free
        moved = apart * (shapes.centroids - shapes.centroids[own].mean(axis=0))
        if stage.in_section:
            moved[shapes.fixed] = 0.0
    layers = [] if not stage.alone else stage.rock()
    kept = np.ones(len(shapes.names), dtype=bool)
    colours = stage.block_colours()
    colours[shapes.fixed] = ROCK
    layers.append(blocks_layer("blocks", shapes, kept, colours, moved[stage.of_vertex]))
    layers += joint_faces(stage, moved)
    legend = block_legend(stage, stage.alone and len(layers) > 1)
    legend += [(name, joint_colour(k), 1.0) for k, name in enumerate(stage.joint_names()) if has_contacts(scene, k)]
    middle = "the middle of the bedrock" if shapes.fixed.any() else "the middle"
    note = f"blocks moved apart by {apart:g} of their distance from {middle}"
    if stage.alone:
        note = f"the block moved out of the slope by {apart:g} of its size"
    rods, named, said = bolt_layers(stage, moved)
    notes = (note, measures(stage), *said)
    return picture(stage, "exploded", [*layers, *rods], [*legend, *named], notes=notes, labels=names(stage, moved))


def _tractions(stage: Stage, _: Asked) -> Picture:
    scene, pairs = stage.scene, stage.scene.pairs
    layers = [*stage.rock(0.55 if stage.in_section else 1.0)] if stage.alone else []
    seen = stage.free if stage.alone else stage.free & touched(stage)
    layers.append(blocks_layer("blocks", scene.shapes, seen, stage.block_colours(), stage.still, 0.12))
    scale = neighbourhood(stage, seen)
    apart = scale if stage.in_section else spacing(pairs.control_area_m2)
    legend = [("block" if stage.alone else "blocks whose contacts were solved", BLOCK, 0.3)]
    for k, name in enumerate(MODES):
        own = pairs.mode == k
        if own.any():
            radius = min(0.016 * scale, 0.22 * apart) * (0.6 if k == OPEN else 1.0)
            front = 0 if stage.alone else 1 if k == OPEN else 2
            body = spheres(pairs.points_m[own], radius)[:2]
            layers.append(layer(f"node pairs: {name}", body, MODE_COLOURS[name], front=front))
            legend.append((f"{name}: {int(own.sum())} of {len(pairs)} node pairs", MODE_COLOURS[name], 1.0))
    traction = (pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn) / pairs.control_area_m2[:, None]
    size = np.sqrt((traction * traction).sum(axis=1))
    size[pairs.mode == OPEN] = 0.0
    notes = ["no node pairs: nothing was solved"] if len(pairs) == 0 else []
    notes += [_NO_LIMIT] if len(pairs) and not size.any() else []
    if size.any():
        drawn = spread(pairs.points_m, size)
        longest = float(size.max())
        width = min(0.014 * scale, 0.15 * apart)
        body = arrows(pairs.points_m[drawn], 0.25 * scale * traction[drawn] / longest, width)[:2]
        layers.append(layer("tractions", body, DARK, front=0 if stage.alone else 3))
        legend.append((f"traction{_on(stage)}, longest {longest:.4g} kPa", DARK, 1.0))
        left = int((size > 0.0).sum()) - len(drawn)
        notes += [f"{len(drawn)} of {left + len(drawn)} tractions are drawn, spread evenly"] if left else []
        notes.append("tractions at the limit: normal and shear of each pair by the area that it controls")
    return picture(stage, "tractions", layers, legend, notes=notes, labels=names(stage, only=seen))


def _on(stage: Stage) -> str:
    return " on the block" if stage.alone else " on one of the two blocks, the other has its opposite"


def _forces(stage: Stage, _: Asked) -> Picture:
    scene, loads = stage.scene, stage.scene.loads
    known = stage.free if stage.alone else balanced(stage)
    at, force, joint = resultants(stage, known)
    own = known[loads.block]
    every = np.concatenate([loads.force_kn[own], force])
    longest = float(np.sqrt((every * every).sum(axis=1)).max(initial=0.0))
    scale = neighbourhood(stage, known)
    drawn = 0.65 * scale / max(longest, 1e-300)
    layers = [*stage.rock(0.35)] if stage.alone else []
    layers.append(blocks_layer("blocks", scene.shapes, known, stage.block_colours(), stage.still, 0.3))
    legend = [("block" if stage.alone else f"blocks in equilibrium ({int(known.sum())})", BLOCK, 0.5)]
    notes = [f"arrows to scale, the longest {kilonewtons(longest)}: forces on the blocks at the limit"]
    if not force.any():
        notes = [f"loads to scale, the longest {kilonewtons(longest)}", _NO_LIMIT]
    if not stage.alone and int(known.sum()) < int(stage.free.sum()):
        left = int(stage.free.sum()) - int(known.sum())
        notes.append(f"{left} other blocks are left out: held, or their contacts were not all solved")
    every_size = np.sqrt((loads.force_kn**2).sum(axis=1))
    sizes = [every_size[own & (loads.what == k)] for k in range(len(loads.names))]
    seen = [k for k, size in enumerate(sizes) if (size > _NO_FORCE * longest).any()]
    called = load_names(stage)
    alike = kinds_of_loads([called[k] for k in seen], [sizes[k] for k in seen])
    groups: list[_Group] = []
    for name, kinds in alike:
        which = [seen[k] for k in kinds]
        of = own & np.isin(loads.what, which)
        said = amounts(name, [sizes[k] for k in which])
        colour = bolt_colour(called[which[0]]) or LOADS[which[0] % len(LOADS)]
        groups.append((name, said, loads.at_m[of], loads.force_kn[of], colour, name[:5] == "water"))
    for k, joint_name in enumerate(scene.shapes.joints):
        name = f"{joint_name} on the block" if stage.alone else joint_name
        size = np.sqrt((force[joint == k] ** 2).sum(axis=1))
        if (size > _NO_FORCE * longest).any():
            groups.append((name, amount(name, size), at[joint == k], force[joint == k], joint_colour(k), True))
    rods, _named, without = bolt_layers(stage)
    layers += rods
    for name, said, points, forces, colour, pushes in groups:
        vectors = drawn * forces
        starts = points - (vectors if pushes else 0.0)
        layers.append(layer(name, arrows(starts, vectors, 0.022 * scale)[:2], colour, front=1))
        unseen = " (too small to be seen)" if float((forces**2).sum(axis=1).max()) < (_SEEN * longest) ** 2 else ""
        legend.append((said + unseen, colour, 1.0))
    notes += [*(["rods and plates show where bolts are, arrows their forces"] if rods else []), *without]
    return picture(stage, "forces", layers, legend, notes=notes, labels=names(stage, only=known))


def _displacement(stage: Stage, asked: Asked) -> Picture:
    scene = stage.scene
    if scene.displacement is None:
        limit = (stage.document.get("fos") or {}).get("limit")
        stands = stage.document.get("status") == "no_driving_force" or (limit is not None and limit > 1.0)
        many = "the blocks are too many, or " if not stage.alone and stands else ""
        why = f"{many}they do not come to rest" if stands else "at full strength it does not stand"
        advice = "How it moves as it fails: slopekit plot result.json mechanism"
        raise DesignError([Fault("E351", f"there is no displacement at full strength: {why}", "displacement", advice)])
    true = rigid(scene.shapes, scene.displacement, scene.shapes.solids.vertices, stage.of_vertex)
    most = float(np.sqrt((true * true).sum(axis=1)).max())
    times = asked.magnify if asked.magnify is not None else nice(_DRAWN * stage.size / max(most, 1e-300))
    moved = rigid(scene.shapes, scene.displacement * times, scene.shapes.solids.vertices, stage.of_vertex)
    centroids = np.sqrt((scene.displacement[:, :3] ** 2).sum(axis=1))
    first = int(np.argmax(centroids))
    layers = [*stage.rock(), blocks_layer("at rest", scene.shapes, stage.free, stage.block_colours(), stage.still, 0.2)]
    layers.append(blocks_layer("displaced", scene.shapes, stage.free, stage.block_colours(), moved))
    legend = [("as it was", BLOCK, 0.3), (f"displaced, {times:,.6g} times", BLOCK, 1.0)]
    down = millimetres(-float(scene.displacement[first, 2]))
    turned = math.degrees(math.sqrt(float(scene.displacement[first, 3:] @ scene.displacement[first, 3:])))
    whose = "centroid" if stage.alone else f"centroid of {scene.shapes.names[first]}"
    notes = (
        f"displacement at full strength on the elastic bed, magnified {times:,.6g} times: largest {millimetres(most)}, "
        f"{whose} {millimetres(float(centroids[first]))} ({down} down), turned by {turned:.3g}°",
    )
    return picture(stage, "displacement", layers, legend, notes=notes, labels=names(stage))


def _mechanism(stage: Stage, asked: Asked) -> Picture:
    scene, shapes = stage.scene, stage.scene.shapes
    last = int(scene.order.max(initial=0))
    if last == 0:
        raise DesignError([Fault("E352", f"nothing moves: {stage.document.get('status_text')}", "mechanism")])
    if not 1 <= asked.step <= last:
        known = f"there are {last} mechanisms" if last > 1 else "there is one mechanism"
        advice = "More of them: analysis: {mechanisms: N} in the design."
        raise DesignError([Fault("E353", f"there is no mechanism {asked.step}: {known}", "--step", advice)])
    moving = scene.order == asked.step
    gone = (scene.order > 0) & (scene.order < asked.step)
    unit = rigid(shapes, np.where(moving[:, None], scene.velocity, 0.0), shapes.solids.vertices, stage.of_vertex)
    fastest = max(float(np.sqrt((unit * unit).sum(axis=1)).max()), 1e-300)
    reach = 0.3 * float(stage.sizes[moving].mean()) if not stage.alone else 0.14 * stage.size
    times = reach / fastest if asked.magnify is None else asked.magnify
    moved = rigid(shapes, scene.velocity * times, shapes.solids.vertices, stage.of_vertex)
    how = ways(stage, asked.step)
    colours = stage.block_colours()
    for k in np.flatnonzero(moving):
        colours[k] = MOTION_COLOURS.get(how.get(shapes.names[k], ""), BLOCK)
    layers = stage.rock()
    still = stage.free & ~moving & ~gone
    if still.any():
        colours[still] = STANDS
        layers.append(blocks_layer("at rest", shapes, still, colours, stage.still))
    layers.append(blocks_layer("where they were", shapes, moving, colours, stage.still, 0.15))
    layers.append(blocks_layer("moving", shapes, moving, colours, moved))
    own = np.flatnonzero(moving)
    speed = np.sqrt((scene.velocity[own, :3] ** 2).sum(axis=1))
    kept = spread(shapes.centroids[own], speed)
    own, speed = own[kept], speed[kept]
    length = 0.3 * stage.size if stage.alone else 0.8 * float(stage.sizes[moving].mean())
    starts = shapes.centroids[own] + scene.velocity[own, :3] * times
    fast = max(float(speed.max(initial=0.0)), 1e-300)
    body = arrows(starts, scene.velocity[own, :3] * (length / fast), 0.06 * length)[:2]
    layers.append(layer("velocity", body, DARK, front=1))
    legend: Legend = []
    for way, count in counted(how, shapes.names, moving):
        legend.append((f"{MOTIONS.get(way, way)}: {count}" if way else "moves", MOTION_COLOURS.get(way, BLOCK), 1.0))
    legend += [("at rest", STANDS, 1.0)] if still.any() else []
    legend += [("velocity of the centroids", DARK, 1.0)]
    notes = [
        "a mechanism has proportions, no size: drawn so that it is seen, and so far that blocks may cut into others"
    ]
    if gone.any():
        notes.append(f"{int(gone.sum())} blocks that failed before are left out")
    what = "mechanism" if last == 1 else f"mechanism {asked.step} of {last}"
    labels = names(stage, scene.velocity[:, :3] * times, moving)
    return picture(stage, what, layers, legend, notes=notes, labels=labels, answer=_answer_of(stage, asked.step))


def _answer_of(stage: Stage, step: int) -> str:
    """Status and factor of a later mechanism; "" where it is the result's."""
    mechanisms = (stage.document.get("assembly") or {}).get("mechanisms") or []
    if step == 1 or step > len(mechanisms):
        return ""
    one = mechanisms[step - 1]
    factor = "no factor of safety" if one.get("fos") is None else f"FoS {one['fos']:.4f} (limit, PRE-IE)"
    return f"mechanism {step}: {status_text(stage.kind, str(one.get('status')))} · {factor} · what moved before is gone"


_COMPOSERS: Mapping[str, Callable[[Stage, Asked], Picture]] = {
    "scene": _scene, "exploded": _exploded, "tractions": _tractions, "forces": _forces, "displacement": _displacement,
    "mechanism": _mechanism, "factors": lambda stage, _: factors(stage),
    "ravelling": lambda stage, _: ravelling(stage),
}  # fmt: skip


def factors(stage: Stage) -> Picture:
    """Blocks by the factor of safety at which they fail."""
    factor = stage.scene.factor
    known = np.isfinite(factor)
    bar = Bar("factor of safety at which a block fails", *ends(factor[known])) if known.any() else None
    one = bar is not None and not np.ptp(factor[known]) > 1e-9 * float(factor[known].max())
    fixed = int(stage.scene.shapes.fixed.sum())
    falls, open_ = without_strength(stage), unsettled(stage)
    none = int((stage.free & ~known & ~falls & ~open_).sum())
    text = "no factor: it stands, or was not looked at" if not stage.alone else "no factor of safety"
    asked = [(f"{text} ({none})", STANDS, 1.0)] if none else []
    asked += _special(falls, open_)
    asked += [(f"bedrock ({fixed})", ROCK, 1.0)] if fixed else []
    notes = ("a block that only the one before it held fails together with it",) if not stage.alone else ()
    if one and bar is not None:  # one value needs no scale
        colour = tuple(bar.colours(factor[known][:1])[0].tolist())
        asked = [(f"fails at {float(factor[known][0]):.4f} ({int(known.sum())})", colour, 1.0), *asked]
    return _by_value(stage, "factors", factor, bar, asked, notes, scale=not one)


def ravelling(stage: Stage) -> Picture:
    """Blocks by the order in which they fail.

    Raises
    ------
    DesignError
        E352 where nothing moves.
    """
    order = stage.scene.order
    if not order.any():
        raise DesignError([Fault("E352", f"nothing moves: {stage.document.get('status_text')}", "ravelling")])
    open_ = unsettled(stage)
    values = np.where((order > 0) & ~open_, order.astype(np.float64), np.nan)
    bar = Bar("order in which blocks fail", 1.0, float(order.max()), whole=True)
    left = int((stage.free & (order == 0)).sum())
    legend = [(f"left in place ({left})", STANDS, 1.0)] if left else []
    legend += _special(np.zeros_like(open_), open_)
    legend += [("bedrock", ROCK, 1.0)] if stage.scene.shapes.fixed.any() else []
    standing = (stage.document.get("assembly") or {}).get("standing")
    return _by_value(stage, "ravelling", values, bar, legend, (str(standing),) if standing else ())


def _special(falls: Bools, open_: Bools) -> Legend:
    """Blocks without a number that do not stand either."""
    legend: Legend = [(f"held by no strength that was tried ({int(falls.sum())})", FALLS, 1.0)] if falls.any() else []
    last = f"moves in a mechanism that did not settle ({int(open_.sum())})"
    return [*legend, (last, UNSETTLED, 1.0)] if open_.any() else legend


def _by_value(
    stage: Stage, what: str, values: Floats, bar: Bar | None, legend: Legend,
    notes: Sequence[str], scale: bool = True,
) -> Picture:  # fmt: skip
    colours = np.tile(np.array(STANDS), (len(values), 1))
    known = np.isfinite(values)
    if bar is not None:
        colours[known] = bar.colours(values[known])
    colours[without_strength(stage) & ~known] = FALLS
    colours[unsettled(stage) & ~known] = UNSETTLED
    layers = [*stage.rock(), blocks_layer("blocks", stage.scene.shapes, stage.free, colours, stage.still)]
    return picture(stage, what, layers, legend, notes=notes, bar=bar if scale else None, labels=names(stage))
