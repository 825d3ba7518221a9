"""The PRE-IE model of many rigid blocks as arrays: moving blocks, contacts between them, node pairs on the contacts.

The mixed system is that of `system.model` (eq. 23, Sheng et al. 2023). Its rows are kept in two factors: a contact
turns the unknowns of its two blocks into one relative rigid motion at its centroid, in its own axes, and each node
pair reads its opening and slip off that motion. Bedrock and fixed blocks have no unknowns.

In a vertical section a flat contact slips as one: its node pairs share one friction force. In space every node pair
has its own.

A passive bolt is one more contact, between the blocks of its head and its toe, with one friction force along the bolt
and a node pair that never touches: it pulls with 0 <= T <= λ times its capacity, which stands as cohesion.
"""

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.core.errors import Fault, SolverError
from slopekit.geometry.patches import BEDROCK, Patches
from slopekit.loads import NO_BOLTS, PassiveBolts
from slopekit.preie.system.contact_cells import ContactCells
from slopekit.preie.system.model import JointStrength, Model, local_axes
from slopekit.preie.system.patch_pairs import polygon_pairs, segment_pairs
from slopekit.preie.tolerances import LIGHTEST, TINY

if TYPE_CHECKING:
    from slopekit.preie.system.strength_lines import StrengthLines


@dataclass(frozen=True, kw_only=True)
class BlockContacts:
    """The contacts of n moving blocks: how their motions open and slip them.

    Attributes
    ----------
    plus, minus : (k,) moving blocks on the two sides of each contact, -1 for bedrock
    plus_motion, minus_motion : (k, u, u) relative motion of the contact per unknown of the block on that side
    pair_contact : (m,) the contact of each node pair, ascending; normal_rows : (m, u) its opening per motion
    group_contact : (g,) the contact of each friction force, ascending; slip_rows : (g, t, u) its slip per motion
    group_first : (g,) first node pair of each friction force
    patch : (k,) index of the contact's patch
    points : (m, 3) m, where the node pairs lie
    kinematics, statics : (m + g t, n u) sparse B, from block motions to openings and slips, and its transpose
    """

    plus: Ints
    minus: Ints
    plus_motion: Floats
    minus_motion: Floats
    pair_contact: Ints
    normal_rows: Floats
    group_contact: Ints
    slip_rows: Floats
    group_first: Ints
    patch: Ints
    points: Floats
    kinematics: Any
    statics: Any


@dataclass(frozen=True, kw_only=True)
class AssemblyModel(BlockContacts):
    """A scaled model of n moving blocks with u unknowns each: 6 in space, 3 in a vertical section.

    Attributes
    ----------
    control_area : (m,) in parts of the mean; cohesion : (m,) strength forces c A in parts of the force scale
    tan_friction, tan_dilation : (g,)
    moving : (n,) indices of the moving blocks in the assembly
    load : (n, u) generalised forces in parts of the force scale; live : (n, u) that part of it that is neither weight
        nor water (earthquake, forces, active bolts)
    length_scale : m; force_scale : kN; area_scale : m²
    bolts : (b,) which of the passive bolts are the last b contacts, friction forces and node pairs; they have no patch
    cells : of contacts with cohesion, which acts on the part of them that is pressed; None where none has any
    lines : where tan_friction was drawn on curved laws, None where none is
    """

    control_area: Floats
    cohesion: Floats
    tan_friction: Floats
    tan_dilation: Floats
    moving: Ints
    load: Floats
    live: Floats
    length_scale: float
    force_scale: float
    area_scale: float
    bolts: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    cells: ContactCells | None = None
    lines: "StrengthLines | None" = None

    @property
    def bolted(self) -> Bools:
        """Friction forces that are the pulls of passive bolts, (g,); pulls are positive."""
        groups = len(self.group_contact)
        return np.arange(groups) >= groups - len(self.bolts)

    @property
    def axes(self) -> Floats:
        """Normal and tangents (k, 3, 3) of each contact, one a row; in a section the second tangent is y."""
        if self.unknowns == 6:
            return self.plus_motion[:, :3, :3]
        axes = np.zeros((len(self.plus), 3, 3))
        axes[:, :2, [0, 2]], axes[:, 2, 1] = self.plus_motion[:, :2, :2], 1.0
        return axes

    @property
    def mean_pulls(self) -> Floats:
        """Forces on the blocks (n u,) of passive bolts that pull with half of their capacity."""
        pulls = np.zeros(self.slip_rows.shape[:2])
        pulls[:, 0] = np.where(self.bolted, 0.5 * self.by_group(self.cohesion), 0.0)
        return self.forces_on_blocks(np.zeros(len(self.control_area)), pulls).ravel()

    @property
    def joint_pairs(self) -> slice:
        """The node pairs of joints: all but those that stand for bolts."""
        return slice(len(self.control_area) - len(self.bolts))

    @property
    def has_cohesion(self) -> bool:
        """Whether any joint has it; what bolts pull is none that contacts could lose."""
        return bool(self.cohesion[self.joint_pairs].any())

    @property
    def unknowns(self) -> int:
        """Unknowns of one block."""
        return int(self.load.shape[1])

    @property
    def group_of_pair(self) -> Ints:
        """The friction force that each node pair shares in, (m,)."""
        counts = np.diff(np.append(self.group_first, len(self.control_area)))
        return np.repeat(np.arange(len(self.group_first)), counts)

    def by_group(self, of_pairs: Floats) -> Floats:
        """Sums over the node pairs of each friction force: (m,) to (g,)."""
        if len(self.group_first) == len(self.control_area):
            return of_pairs.copy()
        return np.add.reduceat(of_pairs, self.group_first)

    def touching(self, blocks: Bools) -> Bools:
        """Some blocks (n,) with those that they touch."""
        inside = np.append(blocks, False)
        near = inside.copy()
        near[self.plus[inside[self.minus]]] = True
        near[self.minus[inside[self.plus]]] = True
        return near[:-1]

    def among(self, blocks: Ints) -> tuple["AssemblyModel", Ints, Ints, Ints]:
        """The model of some blocks (b,), ascending, with all others held.

        Returns
        -------
        model; which contacts, pairs and friction forces are its own
        """
        n, u = self.load.shape
        inside = np.full(n + 1, BEDROCK)
        inside[blocks] = np.arange(len(blocks))
        plus, minus = inside[self.plus], inside[self.minus]
        contacts = np.flatnonzero((plus >= 0) | (minus >= 0))
        number = np.full(len(plus), -1)
        number[contacts] = np.arange(len(contacts))
        pairs, groups = np.flatnonzero(number[self.pair_contact] >= 0), np.flatnonzero(number[self.group_contact] >= 0)
        of_pair, of_group = np.full(len(self.control_area), -1), np.full(len(self.group_contact), -1)
        of_pair[pairs], of_group[groups] = np.arange(len(pairs)), np.arange(len(groups))
        plus, minus = plus[contacts], minus[contacts]
        turned = (plus < 0)[:, None, None]  # the plus side always moves
        plus, minus = np.where(plus < 0, minus, plus), np.where(plus < 0, BEDROCK, minus)
        one, other = self.plus_motion[contacts], self.minus_motion[contacts]
        tangents = self.slip_rows.shape[1]
        rows = np.concatenate([
            pairs, (len(self.control_area) + groups[:, None] * tangents + np.arange(tangents)).ravel()
        ])  # fmt: skip
        kinematics = self.kinematics[rows][:, (blocks[:, None] * u + np.arange(u)).ravel()]
        bolts = self.bolts[groups[groups >= len(self.group_contact) - len(self.bolts)] - len(self.group_contact)]
        model = replace(
            self, plus=plus, minus=minus, plus_motion=np.where(turned, other, one),
            minus_motion=np.where(turned, one, other) * (minus >= 0)[:, None, None],
            pair_contact=number[self.pair_contact[pairs]], normal_rows=self.normal_rows[pairs],
            group_contact=number[self.group_contact[groups]], slip_rows=self.slip_rows[groups],
            group_first=np.searchsorted(pairs, self.group_first[groups]),
            control_area=self.control_area[pairs], cohesion=self.cohesion[pairs],
            tan_friction=self.tan_friction[groups], tan_dilation=self.tan_dilation[groups],
            patch=self.patch[contacts[contacts < len(self.patch)]], points=self.points[pairs],
            moving=self.moving[blocks], load=self.load[blocks], live=self.live[blocks],
            kinematics=kinematics, statics=kinematics.T, bolts=bolts,
            cells=None if self.cells is None else self.cells.renumbered(number, of_pair, of_group),
            lines=None if self.lines is None else self.lines.chosen(pairs),
        )  # fmt: skip
        return model, contacts, pairs, groups

    def opening_and_slip(self, velocity: Floats) -> tuple[Floats, Floats]:
        """Opening (m,) of the node pairs and slip (g, t) of the friction forces for motions (n, u) of the blocks."""
        pairs = len(self.control_area)
        rates: Floats = self.kinematics @ velocity.ravel()
        return rates[:pairs], rates[pairs:].reshape(len(self.group_first), -1)

    def forces_on_blocks(self, normal: Floats, friction: Floats) -> Floats:
        """Generalised forces (n, u) of normal forces (m,) and friction forces (g, t): Bᵀ f."""
        forces: Floats = self.statics @ np.concatenate([normal, friction.ravel()])
        return forces.reshape(self.load.shape)

    def unbalanced(self, normal: Floats, friction: Floats) -> Floats:
        """What forces leave of the loads, (n, u), in parts of each block's load (at least 1e-6 of the largest)."""
        weights = np.sqrt((self.load * self.load).sum(axis=1))
        left: Floats = self.forces_on_blocks(normal, friction) + self.load
        parts: Floats = left / np.maximum(weights, LIGHTEST * float(weights.max()))[:, None]
        return parts


def build_assembly(
    patches: Patches, fixed: Bools, centroids: Floats, forces: Floats, moments: Floats, strength: JointStrength,
    in_section: bool, refine: Ints | None = None, live: tuple[Floats, Floats] | None = None,
    bolts: PassiveBolts = NO_BOLTS,
) -> AssemblyModel:  # fmt: skip
    """The model of an assembly of blocks.

    Parameters
    ----------
    fixed : (b,) blocks without unknowns
    centroids : (b, 3) m; forces : (b, 3) kN; moments : (b, 3) kNm about the centroids
    strength : indexed by `patches.joint`
    in_section : the blocks move in their x-z section only
    refine : (k,) how often each contact is split: halved in a section, its triangles in four in space
    live : forces and moments (b, 3) that are part of those and neither weight nor water
    bolts : passive ones; those between blocks that do not move are left out

    Raises
    ------
    SolverError
        E599 there is nothing to solve.
    """
    moving = np.flatnonzero(~fixed)
    index = np.full(len(fixed) + 1, BEDROCK)
    index[moving] = np.arange(len(moving))
    plus, minus = index[patches.plus], index[patches.minus]
    kept = np.flatnonzero((plus >= 0) | (minus >= 0))
    force_scale = math.sqrt(float((forces[moving] ** 2).sum()) / max(len(moving), 1))
    if len(kept) == 0 or not force_scale > 0.0:
        raise SolverError([Fault("E599", "the model has no node pairs or no load")])
    plus, minus, normals = plus[kept], minus[kept], patches.normals[kept].copy()
    turned = plus < 0  # the plus side always moves
    plus[turned], minus[turned], normals[turned] = minus[turned], plus[turned], -normals[turned]
    middle = patches.centroids[kept]
    length = math.sqrt(float(patches.areas[kept].mean()))
    axes = section_axes(normals) if in_section else local_axes(normals)
    split = np.zeros(len(patches), dtype=np.int64) if refine is None else refine
    pairs_on = segment_pairs if in_section else polygon_pairs
    where, pair_contact, areas, cells = pairs_on(patches, kept, split[kept])
    offsets = np.einsum("mij,mj->mi", axes[pair_contact], where - middle[pair_contact]) / length
    joint = patches.joint[kept]
    if in_section:
        normal_rows = np.stack([np.ones(len(offsets)), np.zeros(len(offsets)), -offsets[:, 1]], axis=1)
        group_contact = np.arange(len(kept))
        slip_rows = np.tile(np.array([[[0.0, 1.0, 0.0]]]), (len(kept), 1, 1))
    else:
        a, b, none, one = offsets[:, 1], offsets[:, 2], np.zeros(len(offsets)), np.ones(len(offsets))
        normal_rows = np.stack([one, none, none, none, b, -a], axis=1)
        group_contact = pair_contact
        slip_rows = np.stack(
            [np.stack([none, one, none, -b, none, none], 1), np.stack([none, none, one, a, none, none], 1)], axis=1
        )
    first = np.searchsorted(pair_contact, np.arange(len(kept))) if in_section else np.arange(len(where))
    area_scale = float(areas.mean())
    of_group = joint[group_contact]
    unknowns = [0, 2, 4] if in_section else list(range(6))
    load, live_load = (
        np.concatenate([force[moving], moment[moving] / length], axis=1)[:, unknowns] / force_scale
        for force, moment in ((forces, moments), live or (np.zeros_like(forces), np.zeros_like(moments)))
    )
    plus_motion = _motion(axes, (middle - centroids[moving[plus]]) / length, in_section)
    minus_motion = (
        -_motion(axes, (middle - centroids[moving[minus]]) / length, in_section) * (minus >= 0)[:, None, None]
    )
    kinematics = _kinematics(
        np.concatenate([normal_rows, slip_rows.reshape(-1, slip_rows.shape[2])]),
        np.concatenate([pair_contact, np.repeat(group_contact, slip_rows.shape[1])]),
        plus, minus, plus_motion, minus_motion, len(moving),
    )  # fmt: skip
    model = AssemblyModel(
        plus=plus, minus=minus, plus_motion=frozen(plus_motion), minus_motion=frozen(minus_motion),
        kinematics=kinematics, statics=kinematics.T.tocsr(),
        pair_contact=pair_contact, normal_rows=frozen(normal_rows), group_contact=group_contact,
        slip_rows=frozen(slip_rows), group_first=first, control_area=frozen(areas / area_scale),
        cohesion=frozen(strength.cohesion[joint[pair_contact]] * areas / force_scale),
        tan_friction=frozen(strength.tan_friction[of_group]), tan_dilation=frozen(strength.tan_dilation[of_group]),
        patch=kept, points=frozen(where), moving=moving,
        load=frozen(load), live=frozen(live_load),
        length_scale=length, force_scale=force_scale, area_scale=area_scale,
        cells=_cohesive(cells, strength.cohesion[joint]),
    )  # fmt: skip
    if strength.laws:
        from slopekit.preie.system.strength_lines import first_lines  # only curved laws pay for it

        mean = force_scale * len(moving) / float(areas.sum())
        model = first_lines(strength.laws, joint[pair_contact], model, mean)
    return _with_bolts(model, bolts, index, centroids) if len(bolts.head) else model


def _cohesive(cells: ContactCells, cohesion: Floats) -> ContactCells | None:
    """Return the cells of the contacts (k,) with cohesion, None where none has any."""
    kept = cohesion[cells.contact] > 0.0
    if not kept.any():
        return None
    return ContactCells(cells.contact[kept], cells.corners[kept], cells.groups[kept], cells.parts[kept])


def one_block(model: Model) -> AssemblyModel:
    """The model of one block as an assembly: every node pair a contact with the bedrock, with friction of its own.

    A contact has the motion at its node pair, in the axes of that, and the turns.
    """
    pairs, bolts, unknowns = len(model.control_area), len(model.bolt_capacity), model.unknowns
    slips = model.rows[:, 1:] if unknowns == 6 else model.section_slip_rows
    count, tangents, none = pairs + bolts, slips.shape[1], np.zeros(bolts)
    motion = np.tile(np.eye(unknowns), (count, 1, 1))
    motion[:pairs, 0], motion[:pairs, 1 : 1 + tangents] = model.normal_rows, slips
    if unknowns == 6:
        motion[:pairs, 3:, 3:] = model.rows[:, :, :3]
        motion[pairs:, :3, :3] = local_axes(model.bolt_rows[:, :3])[:, [1, 0, 2]]
    else:
        motion[pairs:, 0, :2] = model.bolt_rows[:, 1::-1] * [-1.0, 1.0]
    motion[pairs:, 1] = model.bolt_rows  # it gets shorter as its row says: the first slip
    normal_rows, slip_rows = np.zeros((count, unknowns)), np.zeros((count, tangents, unknowns))
    normal_rows[:pairs, 0] = slip_rows[:, 0, 1] = 1.0
    slip_rows[:pairs, 1:, 2] = 1.0
    kinematics = sparse.csr_matrix(
        np.concatenate([np.einsum("mu,muv->mv", normal_rows, motion), *np.einsum("mtu,muv->mtv", slip_rows, motion)])
    )
    share = model.bolt_capacity / max(float(model.bolt_capacity.sum()), TINY)
    return AssemblyModel(
        plus=np.zeros(count, dtype=np.int64), minus=np.full(count, BEDROCK), plus_motion=motion,
        minus_motion=np.zeros_like(motion), pair_contact=np.arange(count), normal_rows=normal_rows,
        group_contact=np.arange(count), slip_rows=slip_rows, group_first=np.arange(count),
        control_area=np.append(model.control_area, share), cohesion=np.append(model.cohesion, model.bolt_capacity),
        tan_friction=np.append(model.tan_friction, none), tan_dilation=np.append(model.tan_dilation, none),
        patch=np.arange(pairs), points=np.zeros((count, 3)), moving=np.zeros(1, dtype=np.int64),
        load=model.load[None, :], live=np.zeros((1, unknowns)), length_scale=model.length_scale,
        force_scale=model.force_scale, area_scale=model.area_scale, kinematics=kinematics,
        statics=kinematics.T.tocsr(), bolts=np.arange(bolts),
        lines=None if model.lines is None else replace(model.lines.with_bolts(bolts), followed=True),
    )  # fmt: skip


def _with_bolts(model: AssemblyModel, bolts: PassiveBolts, index: Ints, centroids: Floats) -> AssemblyModel:
    """The model with passive bolts as its last contacts; `index` of each block among those that move.

    The bolts of a block are together as stiff as its joints are in shear, each by its part of their capacity: one bolt
    of 200 kN is two of 100 kN, and how stiff it is does not depend on how strong it is.
    """
    head, toe = index[bolts.head], index[bolts.toe]
    kept = np.flatnonzero((head >= 0) | (toe >= 0))
    if len(kept) == 0:
        return model
    forces, middle = bolts.forces[kept].copy(), bolts.points[kept]
    plus, minus = head[kept], toe[kept]
    turned = plus < 0  # the plus side always moves
    plus[turned], minus[turned], forces[turned] = minus[turned], plus[turned], -forces[turned]
    capacity = np.sqrt((forces * forces).sum(axis=1))
    along = forces / capacity[:, None]
    in_section, contacts, blocks = model.unknowns == 3, len(model.plus), len(model.moving)
    if in_section:  # the tangent of the axes is the bolt
        axes = section_axes(np.stack([-along[:, 2], along[:, 1], along[:, 0]], axis=1))
    else:
        axes = local_axes(along)[:, [2, 0, 1]]
    arms = (middle - centroids[model.moving[plus]]) / model.length_scale
    plus_motion = _motion(axes, arms, in_section)
    arms = (middle - centroids[model.moving[minus]]) / model.length_scale
    minus_motion = -_motion(axes, arms, in_section) * (minus >= 0)[:, None, None]
    slip_rows = np.zeros((len(kept), *model.slip_rows.shape[1:]))
    slip_rows[:, 0, 1] = 1.0
    joints = sum(
        np.bincount(side[model.pair_contact] + 1, model.control_area, blocks + 1)[1:]
        for side in (model.plus, model.minus)
    )
    areas = np.asarray(joints)[plus] * capacity / np.bincount(plus, capacity, blocks)[plus]
    number, none = contacts + np.arange(len(kept)), np.zeros(len(kept))
    pairs, groups = len(model.control_area), len(model.group_contact)
    whole = replace(
        model, plus=np.append(model.plus, plus), minus=np.append(model.minus, minus),
        plus_motion=frozen(np.concatenate([model.plus_motion, plus_motion])),
        minus_motion=frozen(np.concatenate([model.minus_motion, minus_motion])),
        pair_contact=np.append(model.pair_contact, number),
        normal_rows=frozen(np.concatenate([model.normal_rows, np.zeros((len(kept), model.unknowns))])),
        group_contact=np.append(model.group_contact, number),
        slip_rows=frozen(np.concatenate([model.slip_rows, slip_rows])),
        group_first=np.append(model.group_first, pairs + np.arange(len(kept))),
        control_area=frozen(np.append(model.control_area, areas)),
        cohesion=frozen(np.append(model.cohesion, capacity / model.force_scale)),
        tan_friction=frozen(np.append(model.tan_friction, none)),
        tan_dilation=frozen(np.append(model.tan_dilation, none)),
        points=frozen(np.concatenate([model.points, middle])), bolts=kept,
        lines=None if model.lines is None else model.lines.with_bolts(len(kept)),
    )  # fmt: skip
    tangents = model.slip_rows.shape[1]
    rows = np.concatenate([whole.normal_rows, whole.slip_rows.reshape(groups * tangents + len(kept) * tangents, -1)])
    kinematics = _kinematics(
        rows, np.concatenate([whole.pair_contact, np.repeat(whole.group_contact, tangents)]),
        whole.plus, whole.minus, whole.plus_motion, whole.minus_motion, blocks,
    )  # fmt: skip
    return replace(whole, kinematics=kinematics, statics=kinematics.T.tocsr())


def _kinematics(
    rows: Floats, contact: Ints, plus: Ints, minus: Ints, plus_motion: Floats, minus_motion: Floats, blocks: int
) -> Any:
    """B as a sparse matrix: `rows` (r, u) read a motion of their contact."""
    unknowns = rows.shape[1]
    values, columns, places = [], [], []
    for side, motion in ((plus, plus_motion), (minus, minus_motion)):
        at = np.flatnonzero(side[contact] >= 0)
        values.append(np.matmul(rows[at][:, None, :], motion[contact[at]])[:, 0, :].ravel())
        columns.append((side[contact[at]][:, None] * unknowns + np.arange(unknowns)).ravel())
        places.append(np.repeat(at, unknowns))
    return sparse.csr_matrix(
        (np.concatenate(values), (np.concatenate(places), np.concatenate(columns))),
        shape=(len(rows), blocks * unknowns),
    )


def _motion(axes: Floats, arms: Floats, in_section: bool) -> Floats:
    """Motion of a point in the local axes, (k, u, u), of a block whose centroid lies `arms` (k, 3) before it."""
    if in_section:
        out = np.zeros((len(axes), 3, 3))
        out[:, :2, 0], out[:, :2, 1] = axes[:, :2, 0], axes[:, :2, 2]
        turn = np.stack([arms[:, 2], np.zeros(len(arms)), -arms[:, 0]], axis=1)  # e_y x arm
        out[:, :2, 2] = np.einsum("kij,kj->ki", axes[:, :2], turn)
        out[:, 2, 2] = 1.0
        return out
    out = np.zeros((len(axes), 6, 6))
    out[:, :3, :3] = axes
    out[:, :3, 3:] = np.cross(arms[:, None, :], axes)
    out[:, 3:, 3:] = axes
    return out


def section_axes(normals: Floats) -> Floats:
    """Normal, tangent in the section and y of each contact, (k, 3, 3); the tangent is e_y x normal."""
    axes = np.zeros((len(normals), 3, 3))
    axes[:, 0] = normals
    axes[:, 1, 0], axes[:, 1, 2] = normals[:, 2], -normals[:, 0]
    axes[:, 2, 1] = 1.0
    return axes
