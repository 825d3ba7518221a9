"""The limit state of many blocks: motions, governing interfaces, contact modes, loads as arrows, sizes."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from slopekit.block_scene import CLOSED, OPEN, SLIP, SLIPS, STICK, Arrows, NodePairState, Sizes
from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.evidence import AtFactorOne, Movement
from slopekit.findings import GoverningInterface, Mechanism
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign
from slopekit.kinds.assemblies.many_blocks_scene import AssemblyScene
from slopekit.kinds.sizes import Crest, extents_of, length_on_plane
from slopekit.kinds.solver_inputs import joint_stiffness, joint_strength
from slopekit.loads import AssemblyLoads, line_of_action
from slopekit.preie.many_blocks.blocks_limit import Basis
from slopekit.preie.many_blocks.ravelling import Failure, Ravelling, SolvedComponent
from slopekit.preie.motion.settlement import settlement
from slopekit.preie.outcome import Outcome
from slopekit.preie.solvers.threads import one_thread
from slopekit.preie.solvers.work_limit import LIMIT_UNITS, WorkSpentError, work_budget
from slopekit.preie.system.components import block_sizes, whole_model
from slopekit.preie.tolerances import OPENS
from slopekit.strength.mohr_coulomb import line

_ROTATION_SHARE = 0.05  # rotation beyond this part of a block's motion counts
_OPEN_SHARE = 1e-5  # an interface of which more than this part of the area opens
_MOST_INTERFACES = 12
_MOST_SETTLED_BLOCKS = 2000  # moving blocks: beyond that the elastic bed would take minutes


def states_of_part(component: SolvedComponent) -> tuple[Bools, Bools, Floats]:
    """Return which node pairs are open, which slip, and the size of the slip of each group of friction (g,).

    Slip opens joints that dilate, by no more than their friction angle at the limit; beyond that they are open.
    """
    model, limit = component.model, component.limit
    opening, slip = model.opening_and_slip(limit.velocity)
    size = np.sqrt((slip * slip).sum(axis=1))
    fastest = max(float(size.max(initial=0.0)), float(np.abs(opening).max(initial=0.0)), 1e-300)
    dilation = np.minimum(model.tan_dilation, model.tan_friction / (limit.factor or 1.0))
    opened = opening - (dilation * size)[model.group_of_pair] > OPENS * fastest
    opened |= limit.normal_force <= CLOSED * max(float(limit.normal_force.max(initial=0.0)), 1e-300)
    slips = (size > SLIPS * fastest)[model.group_of_pair] & ~opened
    return opened, slips, size


def mechanism(failure: Failure, scene: AssemblyScene) -> Mechanism:
    """Return a failure as a mechanism: status, factor, blocks and governing interfaces."""
    limit = failure.limit
    size = block_sizes(scene.assembly)
    fastest = np.argsort(-np.abs(failure.motion[:, :3]).max(axis=1, initial=0.0), kind="stable")
    blocks, motions = failure.blocks[fastest].tolist(), frozen(failure.motion[fastest])
    motion_kinds = tuple(
        _motion_kind(motion, float(size[block]), limit.outcome)
        for block, motion in zip(blocks, motions, strict=True)
    )
    if any(component.limit.outcome is Outcome.NOT_CONVERGED for component in failure.parts):
        status = "not_converged"
    elif limit.outcome in (Outcome.LIFTED, Outcome.NO_REST):
        status = next(
            (status_word for word, status_word in _UNSTABLE_STATUSES if word in motion_kinds),
            "falls",
        )
    elif "topples" in motion_kinds:
        status = "topples"
    elif "rotates" in motion_kinds:
        status = "rotates"
    else:
        upward = all(motion[2] > _ROTATION_SHARE for motion in failure.motion)
        status = "slides_up" if upward else "slides"
    counts: dict[str, int] = {"stick": 0, "slip": 0, "open": 0}
    interfaces: list[GoverningInterface] = []
    total = 0.0
    for component in failure.parts:
        for mode, count in _modes(component).items():
            counts[mode] += count
        losing, lost = _interfaces(component, scene)
        interfaces, total = interfaces + losing, total + lost
    interfaces.sort(key=lambda interface: -interface.share)
    governing = tuple(
        GoverningInterface(
            losing.name,
            losing.joint,
            losing.mode,
            losing.share / max(total, 1e-300),
            losing.normal_kn,
            losing.area_m2,
        )
        for losing in interfaces[:_MOST_INTERFACES]
    )
    return Mechanism(
        status,
        limit.factor,
        tuple(scene.names[block] for block in blocks),
        motion_kinds,
        motions[:, :3],
        motions[:, 3:],
        max(component.limit.change for component in failure.parts),
        governing,
        counts,
        max((component.limit.basis for component in failure.parts), key=_BASES.index).name.lower(),
    )


_BASES = (Basis.LIMIT, Basis.ALONE, Basis.SETTLED, Basis.PEAK, Basis.NONE)  # the surest first
_UNSTABLE_STATUSES = (
    ("topples", "topples"),
    ("rotates", "topples"),
    ("lifts", "lifted"),
    ("falls", "falls"),
)


def _motion_kind(motion: Floats, size: float, outcome: Outcome) -> str:
    """Return how a block moves; a rotation is toppling where its top moves farther than its bottom."""
    translation, rotation = motion[:3], motion[3:] * size
    speed, spin = float(np.sqrt(translation @ translation)), float(np.sqrt(rotation @ rotation))
    if spin > _ROTATION_SHARE * max(speed, spin):
        up = np.array([0.0, 0.0, 1.0])
        top, bottom = translation + np.cross(rotation, up), translation - np.cross(rotation, up)
        flat = top[:2] @ top[:2] - bottom[:2] @ bottom[:2]
        return "topples" if flat > 0.0 else "rotates"
    if outcome in (Outcome.LIFTED, Outcome.NO_REST):
        return "lifts" if translation[2] > 0.0 else "falls"
    return "slides"


def _modes(component: SolvedComponent) -> dict[str, int]:
    if len(component.model.control_area) == 0:
        return {}
    opened, slips = (state[component.model.joint_pairs] for state in states_of_part(component)[:2])
    return {
        "stick": int((~opened & ~slips).sum()),
        "slip": int(slips.sum()),
        "open": int(opened.sum()),
    }


def _interfaces(
    component: SolvedComponent, scene: AssemblyScene
) -> tuple[list[GoverningInterface], float]:
    """Return the interfaces and bolts that dissipate work in a mechanism, and the total work."""
    model, limit = component.model, component.limit
    if len(model.control_area) == 0 or limit.factor is None:
        return [], 0.0
    opened, _, size = states_of_part(component)
    strength = line(
        model.by_group(model.cohesion * limit.bond),
        model.tan_friction,
        model.by_group(limit.normal_force),
    )
    strength = np.where(model.bolted, limit.friction[:, 0] * limit.factor, strength)
    work = np.bincount(model.group_contact, strength * size, len(model.plus))
    normal = (
        np.bincount(model.pair_contact, limit.normal_force, len(model.plus)) * model.force_scale
    )
    area = np.bincount(model.pair_contact, model.control_area, len(model.plus)) * model.area_scale
    open_area = (
        np.bincount(model.pair_contact, model.control_area * opened, len(model.plus))
        * model.area_scale
    )
    chosen = np.argsort(-work, kind="stable")[: 4 * _MOST_INTERFACES]
    sums: dict[tuple[str, str], list[float]] = {}
    patches = scene.assembly.patches
    bolts: list[GoverningInterface] = []
    for k in chosen[work[chosen] > 1e-6 * work.max(initial=0.0)].tolist():
        if k >= len(component.patch):
            bolt = int(model.bolts[k - len(component.patch)])
            pull = float(limit.friction[k - len(model.plus), 0]) * model.force_scale
            head = scene.names[int(scene.acting.bolts.head[bolt])]
            bolts.append(
                GoverningInterface(
                    scene.acting.bolt_names[bolt], head, "pull", float(work[k]), pull, 0.0
                )
            )
            continue
        patch = int(component.patch[k])
        sides = int(patches.plus[patch]), int(patches.minus[patch])
        name = "/".join(scene.names[side] if side >= 0 else "bedrock" for side in sides)
        entry = sums.setdefault(
            (name, scene.joints[int(patches.joint[patch])]), [0.0, 0.0, 0.0, 0.0]
        )
        for number, value in enumerate((work[k], normal[k], area[k], open_area[k])):
            entry[number] += float(value)
    return [
        GoverningInterface(
            name, joint, "open" if open_m2 > _OPEN_SHARE * area_ else "slip", share, force, area_
        )
        for (name, joint), (share, force, area_, open_m2) in sums.items()
    ] + bolts, float(work.sum())


def assembly_pair_state(
    scene: AssemblyScene, components: Sequence[SolvedComponent]
) -> NodePairState:
    """Return the node pairs of the solved components, each at the limit of its component."""
    vectors, none = np.zeros((0, 3)), np.zeros(0)
    empty = NodePairState(
        vectors,
        _integers(none),
        none,
        vectors,
        _integers(none),
        _integers(none),
        none,
        vectors,
        _integers(none),
    )
    states = [
        empty,
        *[
            _pair_states(scene, component)
            for component in components
            if len(component.model.control_area)
        ],
    ]
    return NodePairState(
        *(
            np.concatenate([getattr(state, name) for state in states])
            for name in NodePairState.__dataclass_fields__
        )
    )


def _pair_states(scene: AssemblyScene, component: SolvedComponent) -> NodePairState:
    model, limit, patches = component.model, component.limit, scene.assembly.patches
    joint_pairs = model.joint_pairs
    contact = model.pair_contact[joint_pairs]
    opened, slips, _ = states_of_part(component)
    tangents = model.axes[model.group_contact, 1 : 1 + limit.friction.shape[1]]
    # the pairs of a flat contact in a section share one friction force: each has its part of the strength
    capacity = line(
        model.cohesion * limit.bond, model.tan_friction[model.group_of_pair], limit.normal_force
    )
    capacity_of_group = model.by_group(capacity)[model.group_of_pair]
    share = np.divide(
        capacity,
        capacity_of_group,
        out=np.zeros_like(capacity_of_group),
        where=capacity_of_group > 0.0,
    )
    forces = np.einsum("gt,gtx->gx", limit.friction, tangents)
    moving = np.append(model.moving, -1)
    plus, minus = model.plus[: len(component.patch)], model.minus[: len(component.patch)]
    return NodePairState(
        frozen(model.points[joint_pairs] + scene.origin),
        _integers(patches.joint[component.patch][contact]),
        frozen(model.control_area[joint_pairs] * model.area_scale),
        frozen(model.axes[contact, 0]),
        moving[plus][contact],
        np.where(minus < 0, _bedrock_side(scene, component, plus), moving[minus])[contact],
        frozen(limit.normal_force[joint_pairs] * model.force_scale),
        frozen((forces[model.group_of_pair] * share[:, None])[joint_pairs] * model.force_scale),
        np.where(opened, OPEN, np.where(slips, SLIP, STICK))[joint_pairs],
    )


def _bedrock_side(scene: AssemblyScene, component: SolvedComponent, plus: Ints) -> Ints:
    """Return the fixed block on the minus side of each contact, -1 for bedrock that is none of the blocks."""
    patches = scene.assembly.patches
    first, second = patches.plus[component.patch], patches.minus[component.patch]
    return np.where(first == component.model.moving[plus], second, first)


def _integers(values: "Ints | Floats") -> Ints:
    return np.asarray(values, dtype=np.int64)


def bolt_pulls(scene: AssemblyScene, components: Sequence[SolvedComponent]) -> Floats:
    """Return the pull of each passive bolt at the limit, (b,) kN; nan where there is no limit."""
    pulls = np.full(len(scene.acting.bolts.head), np.nan)
    for component in components:
        if component.limit.factor is not None:
            bolted = component.model.bolted
            pulls[component.model.bolts] = (
                np.maximum(component.limit.friction[bolted, 0], 0.0) * component.model.force_scale
            )
    return pulls


def assembly_arrows(
    scene: AssemblyScene, loads: AssemblyLoads, solved: Sequence[SolvedComponent]
) -> Arrows:
    """Return the loads on the blocks that are not bedrock: weight, seismic load, water on contacts, forces and bolts.

    Passive bolts pull as at the limit of their part; where it has none their full capacity is given.
    """
    assembly = scene.assembly
    free = np.flatnonzero(~assembly.fixed)
    entries: list[tuple[str, Ints, Floats, Floats]] = []

    def add(name: str, blocks: Ints, forces: Floats, points: Floats) -> None:
        if len(blocks) and forces.any():
            entries.append((name, blocks, forces, points))

    middle, weights = assembly.centroids[free], loads.weights[free, None]
    add("weight", free, weights * np.array([0.0, 0.0, -1.0]), middle)
    add("seismic", free, weights * scene.acting.seismic, middle)
    patches = assembly.patches
    for side, sign in ((patches.plus, 1.0), (patches.minus, -1.0)):
        wet = np.flatnonzero((side >= 0) & (loads.water != 0.0))
        wet = wet[~assembly.fixed[side[wet]]]
        add(
            "water",
            side[wet],
            sign * loads.water[wet, None] * patches.normals[wet],
            loads.water_points[wet],
        )
    for load in scene.acting.pushes:
        point = (
            assembly.centroids[load.block] + line_of_action(load.push)
            if load.push.point is None
            else load.push.point
        )
        add(load.name, np.array([load.block]), load.push.force[None, :], point[None, :])
    bolts = scene.acting.bolts
    for k, pull in enumerate(bolt_pulls(scene, solved).tolist()):
        name, share = f"passive bolt {k + 1}", pull / float(np.linalg.norm(bolts.forces[k]))
        if np.isnan(pull):
            name, share = f"{name}, full capacity", 1.0
        ends = np.array([end for end in (bolts.head[k], bolts.toe[k]) if end >= 0])
        signs = np.where(ends == bolts.head[k], share, -share)
        points = np.repeat(bolts.points[k : k + 1], len(ends), axis=0)
        entries.append(
            (name, ends, signs[:, None] * bolts.forces[k], points)
        )  # also where it does not pull
    names = tuple(dict.fromkeys(name for name, *_ in entries))
    numbers = [np.full(len(blocks), names.index(name)) for name, blocks, *_ in entries]
    return Arrows(
        names,
        _integers(np.concatenate([np.zeros(0), *numbers])),
        _integers(np.concatenate([np.zeros(0), *(blocks for _, blocks, *_ in entries)])),
        frozen(np.concatenate([np.zeros((0, 3)), *(force for *_, force, _ in entries)])),
        frozen(
            np.concatenate([np.zeros((0, 3)), *(points for *_, points in entries)]) + scene.origin
        ),
    )


def at_full_strength(
    design: AssemblyDesign, scene: AssemblyScene, loads: AssemblyLoads
) -> AtFactorOne | None:
    """Return the displacements at full strength on elastic contacts; None without rest or for too many blocks."""
    assembly = scene.assembly
    if int((~assembly.fixed).sum()) > _MOST_SETTLED_BLOCKS:
        return None
    model = whole_model(assembly, loads, joint_strength(scene.strengths))
    if model is None:
        return None
    settled = None
    with one_thread(), suppress(WorkSpentError), work_budget(LIMIT_UNITS):
        settled = settlement(model, joint_stiffness(design))
    if settled is None:
        return None
    displacements = np.zeros((len(assembly), 6))
    displacements[model.moving[:, None], [0, 2, 4] if assembly.in_section else range(6)] = (
        settled.displacement
    )
    most = int(np.argmax(np.sqrt((displacements[:, :3] ** 2).sum(axis=1))))
    movement = Movement(frozen(displacements[most, :3]), frozen(displacements[most, 3:]))
    return AtFactorOne(
        movement, settled.failed_pairs, settled.residual, scene.names[most], frozen(displacements)
    )


# -- how large it is ---------------------------------------------------------------------------------------------------


def mechanisms_of(
    ravelling: Ravelling, scene: AssemblyScene, gravity_m_s2: float
) -> Iterator[Mechanism]:
    """Yield the mechanisms, each with its role and the sizes of its moving blocks."""
    role = "first"
    for failure in ravelling.sequence:
        size = sizes_of_blocks(failure.blocks, scene, gravity_m_s2) if len(failure.blocks) else None
        failure_role = "single_block" if failure.limit.basis is Basis.ALONE else role
        yield replace(
            mechanism(failure, scene), size=size, role="chip" if failure.is_chip else failure_role
        )
        role = role if failure.is_chip else "next"


def sizes_of_blocks(blocks: Ints, scene: AssemblyScene, gravity_m_s2: float) -> Sizes:
    assembly = scene.assembly
    volumes = assembly.volumes[blocks]
    volume, mass = float(volumes.sum()), float(volumes @ scene.unit_weights[blocks]) / gravity_m_s2
    if scene.outlines:
        outlines = [scene.polygons[k] for k in blocks.tolist()]
        heights = np.concatenate([outline[:, 1] for outline in outlines])
        setback = None
        if (
            scene.crest_x is not None
        ):  # to the back of the last column, at its top: the third corner of an outline
            setback = max(0.0, max(float(outline[2, 0]) for outline in outlines) - scene.crest_x)
        return Sizes(float(np.ptp(heights)), None, setback, {}, volume, mass)
    moves = np.zeros(len(assembly) + 1, dtype=bool)
    moves[blocks] = True
    corners = assembly.vertices[assembly.triangles[moves[assembly.triangle_block]].ravel()]
    if scene.crest is None:
        return Sizes(float(np.ptp(corners[:, 2])), None, None, {}, volume, mass)
    extents, traces = extents_of(corners, scene.crest), _traces(moves, scene, scene.crest)
    return replace(extents, trace_lengths_m=traces, volume_m3=volume, mass_t=mass)


def _traces(moves: Bools, scene: AssemblyScene, crest: Crest) -> dict[str, dict[str, float]]:
    """Return the trace lengths (m) of the moving blocks (n + 1,) on face and upper slope, by joint."""
    patches = scene.assembly.patches
    traces: dict[str, dict[str, float]] = {}
    for k in np.flatnonzero(moves[patches.plus] != moves[patches.minus]).tolist():
        polygon = patches.corners[patches.first[k] : patches.first[k + 1]]
        of_joint = traces.setdefault(scene.joints[patches.joint[k]], {})
        for short, normal in (("face", crest.face), ("upper", crest.upper)):
            if length := length_on_plane(polygon, normal, crest.point):
                of_joint[short] = of_joint.get(short, 0.0) + length
    return {name: traces[name] for name in scene.joints if name in traces}


# -- how hard it is to turn --------------------------------------------------------------------------------------------


def gyration(scene: AssemblyScene) -> Floats:
    """Return the inertia about the centroid per unit of mass (b, 3, 3) m² of the blocks of a scene.

    Blocks of a section have the inertia about the y axis alone.
    """
    from slopekit.preie.motion.shaking import inertia_of  # only earthquakes ask

    assembly = scene.assembly
    inertia_per_mass = np.zeros((len(assembly), 3, 3))
    if assembly.in_section:
        for block, (outline, centroid) in enumerate(
            zip(scene.polygons, assembly.centroids, strict=True)
        ):
            inertia_per_mass[block, 1, 1] = _polar_moment(outline - centroid[[0, 2]])
        return inertia_per_mass
    for block in np.flatnonzero(~assembly.fixed).tolist():
        faces = assembly.vertices[assembly.triangles[assembly.triangle_block == block]]
        volume, inertia = inertia_of(list(faces), assembly.centroids[block])
        inertia_per_mass[block] = inertia / volume
    return inertia_per_mass


def _polar_moment(outline: Floats) -> float:
    """Return the polar moment of area of a polygon (k, 2) m about the origin, per unit of area, m²."""
    following = np.roll(outline, -1, axis=0)
    doubled_areas = outline[:, 0] * following[:, 1] - outline[:, 1] * following[:, 0]
    squares = (outline * outline + outline * following + following * following).sum(axis=1)
    return float((doubled_areas * squares).sum() / (6.0 * doubled_areas.sum()))
