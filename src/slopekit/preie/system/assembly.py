"""The PRE-IE model of many rigid blocks as arrays: moving blocks, contacts between them, node pairs on the contacts.

The mixed system is that of `system.model` (eq. 23, Sheng et al. 2023). Its rows are kept in two factors: a contact
turns the unknowns of its two blocks into one relative rigid motion at its centroid, in its own axes, and each node
pair reads its opening and slip off that motion. Bedrock and fixed blocks have no unknowns.

In a vertical section all node pairs of a flat contact share one friction force. In space every node pair has its own.

A passive bolt is one more contact, between the blocks of its head and its toe, with one friction force along the bolt
and a node pair that never touches: it pulls with 0 <= T <= λ times its capacity, which is entered as cohesion.
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
    """The contacts of n moving blocks, and how they open and slip with the motions of the blocks.

    Attributes
    ----------
    plus, minus : (k,) moving blocks on the two sides of each contact, -1 for bedrock
    plus_motion, minus_motion : (k, u, u) relative motion of the contact per unknown of the block on that side
    pair_contact : (m,) the contact of each node pair, ascending
    normal_rows : (m, u) opening of the node pair per motion of its contact
    group_contact : (g,) the contact of each friction force, ascending
    slip_rows : (g, t, u) slip of the friction force per motion of its contact
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
    control_area : (m,) in units of the mean
    cohesion : (m,) strength forces c A in units of the force scale
    tan_friction, tan_dilation : (g,)
    moving : (n,) indices of the moving blocks in the assembly
    load : (n, u) generalised forces in units of the force scale
    live : (n, u) the share of the load that is neither weight nor water (earthquake, forces, active bolts)
    length_scale : m; force_scale : kN; area_scale : m²
    bolts : (b,) indices of the passive bolts that are the last b contacts, friction forces and node pairs; these have
        no patch
    cells : triangles of contacts with cohesion, which acts on their pressed part; None where no contact has any
    lines : tractions at which tan_friction is the line of a curved law; None without curved laws
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
        """Whether each friction force (g,) is the pull of a passive bolt; pulls are positive."""
        groups = len(self.group_contact)
        return np.arange(groups) >= groups - len(self.bolts)

    @property
    def axes(self) -> Floats:
        """Normal and tangents (k, 3, 3) of each contact, one a row; the second tangent of a section is y."""
        if self.unknowns == 6:
            return self.plus_motion[:, :3, :3]
        axes = np.zeros((len(self.plus), 3, 3))
        axes[:, :2, [0, 2]], axes[:, 2, 1] = self.plus_motion[:, :2, :2], 1.0
        return axes

    @property
    def mean_pulls(self) -> Floats:
        """Generalised forces (n u,) on the blocks when every passive bolt pulls with half of its capacity."""
        pulls = np.zeros(self.slip_rows.shape[:2])
        pulls[:, 0] = np.where(self.bolted, 0.5 * self.by_group(self.cohesion), 0.0)
        return self.forces_on_blocks(np.zeros(len(self.control_area)), pulls).ravel()

    @property
    def joint_pairs(self) -> slice:
        """The node pairs of joints: all but the last, which represent bolts."""
        return slice(len(self.control_area) - len(self.bolts))

    @property
    def has_cohesion(self) -> bool:
        """Whether any joint has cohesion; the capacity of bolts, entered as cohesion, does not count."""
        return bool(self.cohesion[self.joint_pairs].any())

    @property
    def unknowns(self) -> int:
        """Number of unknowns of one block: 6, or 3 in a section."""
        return int(self.load.shape[1])

    @property
    def group_of_pair(self) -> Ints:
        """The friction force of each node pair, (m,)."""
        counts = np.diff(np.append(self.group_first, len(self.control_area)))
        return np.repeat(np.arange(len(self.group_first)), counts)

    def by_group(self, pair_values: Floats) -> Floats:
        """Return the sums (g,) of values (m,) over the node pairs of each friction force."""
        if len(self.group_first) == len(self.control_area):
            return pair_values.copy()
        return np.add.reduceat(pair_values, self.group_first)

    def touching(self, blocks: Bools) -> Bools:
        """Return a mask (n,) of some blocks together with the blocks that they touch."""
        chosen = np.append(blocks, False)
        touched = chosen.copy()
        touched[self.plus[chosen[self.minus]]] = True
        touched[self.minus[chosen[self.plus]]] = True
        return touched[:-1]

    def restricted_to(self, blocks: Ints) -> tuple["AssemblyModel", Ints, Ints, Ints]:
        """Return the model of some blocks (b,), ascending, with all other blocks fixed.

        Returns
        -------
        model, and the indices of its contacts, node pairs and friction forces in this one
        """
        n, u = self.load.shape
        block_number = np.full(n + 1, BEDROCK)
        block_number[blocks] = np.arange(len(blocks))
        plus, minus = block_number[self.plus], block_number[self.minus]
        contacts = np.flatnonzero((plus >= 0) | (minus >= 0))
        contact_number = np.full(len(plus), -1)
        contact_number[contacts] = np.arange(len(contacts))
        pairs, groups = (
            np.flatnonzero(contact_number[self.pair_contact] >= 0),
            np.flatnonzero(contact_number[self.group_contact] >= 0),
        )
        pair_number, group_number = (
            np.full(len(self.control_area), -1),
            np.full(len(self.group_contact), -1),
        )
        pair_number[pairs], group_number[groups] = np.arange(len(pairs)), np.arange(len(groups))
        plus, minus = plus[contacts], minus[contacts]
        is_flipped = (plus < 0)[:, None, None]  # the plus side always moves
        plus, minus = np.where(plus < 0, minus, plus), np.where(plus < 0, BEDROCK, minus)
        old_plus_motion, old_minus_motion = self.plus_motion[contacts], self.minus_motion[contacts]
        tangents = self.slip_rows.shape[1]
        rows = np.concatenate(
            [
                pairs,
                (len(self.control_area) + groups[:, None] * tangents + np.arange(tangents)).ravel(),
            ]
        )
        kinematics = self.kinematics[rows][:, (blocks[:, None] * u + np.arange(u)).ravel()]
        bolts = self.bolts[
            groups[groups >= len(self.group_contact) - len(self.bolts)] - len(self.group_contact)
        ]
        model = replace(
            self,
            plus=plus,
            minus=minus,
            plus_motion=np.where(is_flipped, old_minus_motion, old_plus_motion),
            minus_motion=np.where(is_flipped, old_plus_motion, old_minus_motion)
            * (minus >= 0)[:, None, None],
            pair_contact=contact_number[self.pair_contact[pairs]],
            normal_rows=self.normal_rows[pairs],
            group_contact=contact_number[self.group_contact[groups]],
            slip_rows=self.slip_rows[groups],
            group_first=np.searchsorted(pairs, self.group_first[groups]),
            control_area=self.control_area[pairs],
            cohesion=self.cohesion[pairs],
            tan_friction=self.tan_friction[groups],
            tan_dilation=self.tan_dilation[groups],
            patch=self.patch[contacts[contacts < len(self.patch)]],
            points=self.points[pairs],
            moving=self.moving[blocks],
            load=self.load[blocks],
            live=self.live[blocks],
            kinematics=kinematics,
            statics=kinematics.T,
            bolts=bolts,
            cells=None
            if self.cells is None
            else self.cells.renumbered(contact_number, pair_number, group_number),
            lines=None if self.lines is None else self.lines.restricted_to(pairs),
        )
        return model, contacts, pairs, groups

    def opening_and_slip(self, velocity: Floats) -> tuple[Floats, Floats]:
        """Return the openings (m,) of the node pairs and slips (g, t) of the friction forces at motions (n, u)."""
        pairs = len(self.control_area)
        rates: Floats = self.kinematics @ velocity.ravel()
        return rates[:pairs], rates[pairs:].reshape(len(self.group_first), -1)

    def forces_on_blocks(self, normal: Floats, friction: Floats) -> Floats:
        """Return the generalised forces (n, u) on the blocks of normal forces (m,) and friction forces (g, t): Bᵀ f."""
        forces: Floats = self.statics @ np.concatenate([normal, friction.ravel()])
        return forces.reshape(self.load.shape)

    def unbalanced(self, normal: Floats, friction: Floats) -> Floats:
        """Return the residual force (n, u) of each block as a fraction of its load (at least 1e-6 of the largest)."""
        weights = np.sqrt((self.load * self.load).sum(axis=1))
        residual: Floats = self.forces_on_blocks(normal, friction) + self.load
        relative: Floats = residual / np.maximum(weights, LIGHTEST * float(weights.max()))[:, None]
        return relative


def build_assembly(
    patches: Patches,
    fixed: Bools,
    centroids: Floats,
    forces: Floats,
    moments: Floats,
    strength: JointStrength,
    in_section: bool,
    refine: Ints | None = None,
    live: tuple[Floats, Floats] | None = None,
    bolts: PassiveBolts = NO_BOLTS,
) -> AssemblyModel:
    """Return the scaled model of an assembly of blocks.

    Parameters
    ----------
    fixed : (b,) blocks without unknowns
    centroids : (b, 3) m; forces : (b, 3) kN; moments : (b, 3) kNm about the centroids
    strength : indexed by `patches.joint`
    in_section : the blocks move in their x-z section only
    refine : (k,) how often each contact is split: halved in a section, its triangles in four in space
    live : the share of forces and moments (b, 3) that is neither weight nor water
    bolts : passive bolts; those between fixed blocks are left out

    Raises
    ------
    SolverError
        E599 there is nothing to solve.
    """
    moving = np.flatnonzero(~fixed)
    index = np.full(len(fixed) + 1, BEDROCK)
    index[moving] = np.arange(len(moving))
    plus, minus = index[patches.plus], index[patches.minus]
    active = np.flatnonzero((plus >= 0) | (minus >= 0))
    force_scale = math.sqrt(float((forces[moving] ** 2).sum()) / max(len(moving), 1))
    if len(active) == 0 or not force_scale > 0.0:
        raise SolverError([Fault("E599", "the model has no node pairs or no load")])
    plus, minus, normals = plus[active], minus[active], patches.normals[active].copy()
    is_flipped = plus < 0  # the plus side always moves
    plus[is_flipped], minus[is_flipped], normals[is_flipped] = (
        minus[is_flipped],
        plus[is_flipped],
        -normals[is_flipped],
    )
    middle = patches.centroids[active]
    length = math.sqrt(float(patches.areas[active].mean()))
    axes = section_axes(normals) if in_section else local_axes(normals)
    split = np.zeros(len(patches), dtype=np.int64) if refine is None else refine
    pair_rule = segment_pairs if in_section else polygon_pairs
    points, pair_contact, areas, cells = pair_rule(patches, active, split[active])
    offsets = np.einsum("mij,mj->mi", axes[pair_contact], points - middle[pair_contact]) / length
    joint = patches.joint[active]
    if in_section:
        normal_rows = np.stack(
            [np.ones(len(offsets)), np.zeros(len(offsets)), -offsets[:, 1]], axis=1
        )
        group_contact = np.arange(len(active))
        slip_rows = np.tile(np.array([[[0.0, 1.0, 0.0]]]), (len(active), 1, 1))
    else:
        a, b, zeros, ones = (
            offsets[:, 1],
            offsets[:, 2],
            np.zeros(len(offsets)),
            np.ones(len(offsets)),
        )
        normal_rows = np.stack([ones, zeros, zeros, zeros, b, -a], axis=1)
        group_contact = pair_contact
        slip_rows = np.stack(
            [
                np.stack([zeros, ones, zeros, -b, zeros, zeros], 1),
                np.stack([zeros, zeros, ones, a, zeros, zeros], 1),
            ],
            axis=1,
        )
    first = (
        np.searchsorted(pair_contact, np.arange(len(active)))
        if in_section
        else np.arange(len(points))
    )
    area_scale = float(areas.mean())
    group_joint = joint[group_contact]
    unknowns = [0, 2, 4] if in_section else list(range(6))
    load, live_load = (
        np.concatenate([force[moving], moment[moving] / length], axis=1)[:, unknowns] / force_scale
        for force, moment in (
            (forces, moments),
            live or (np.zeros_like(forces), np.zeros_like(moments)),
        )
    )
    plus_motion = _motion(axes, (middle - centroids[moving[plus]]) / length, in_section)
    minus_motion = (
        -_motion(axes, (middle - centroids[moving[minus]]) / length, in_section)
        * (minus >= 0)[:, None, None]
    )
    kinematics = _kinematics(
        np.concatenate([normal_rows, slip_rows.reshape(-1, slip_rows.shape[2])]),
        np.concatenate([pair_contact, np.repeat(group_contact, slip_rows.shape[1])]),
        plus,
        minus,
        plus_motion,
        minus_motion,
        len(moving),
    )
    model = AssemblyModel(
        plus=plus,
        minus=minus,
        plus_motion=frozen(plus_motion),
        minus_motion=frozen(minus_motion),
        kinematics=kinematics,
        statics=kinematics.T.tocsr(),
        pair_contact=pair_contact,
        normal_rows=frozen(normal_rows),
        group_contact=group_contact,
        slip_rows=frozen(slip_rows),
        group_first=first,
        control_area=frozen(areas / area_scale),
        cohesion=frozen(strength.cohesion[joint[pair_contact]] * areas / force_scale),
        tan_friction=frozen(strength.tan_friction[group_joint]),
        tan_dilation=frozen(strength.tan_dilation[group_joint]),
        patch=active,
        points=frozen(points),
        moving=moving,
        load=frozen(load),
        live=frozen(live_load),
        length_scale=length,
        force_scale=force_scale,
        area_scale=area_scale,
        cells=_cohesive_cells(cells, strength.cohesion[joint]),
    )
    if strength.laws:
        from slopekit.preie.system.strength_lines import (
            with_initial_lines,  # only curved laws pay for it
        )

        mean = force_scale * len(moving) / float(areas.sum())
        model = with_initial_lines(strength.laws, joint[pair_contact], model, mean)
    return _with_bolts(model, bolts, index, centroids) if len(bolts.head) else model


def _cohesive_cells(cells: ContactCells, cohesion: Floats) -> ContactCells | None:
    """Return the cells of those contacts whose joint has cohesion (k,) kPa, None where no contact has any."""
    has_cohesion = cohesion[cells.contact] > 0.0
    if not has_cohesion.any():
        return None
    return ContactCells(
        cells.contact[has_cohesion],
        cells.corners[has_cohesion],
        cells.groups[has_cohesion],
        cells.cohesion_shares[has_cohesion],
    )


def one_block(model: Model) -> AssemblyModel:
    """Return the model of one block as an assembly: every node pair is a contact, with a friction force of its own.

    The motion of a contact is the translation of its node pair, in the axes of the pair, and the rotation.
    """
    pairs, bolts, unknowns = len(model.control_area), len(model.bolt_capacity), model.unknowns
    slips = model.rows[:, 1:] if unknowns == 6 else model.section_slip_rows
    count, tangents, zeros = pairs + bolts, slips.shape[1], np.zeros(bolts)
    motion = np.tile(np.eye(unknowns), (count, 1, 1))
    motion[:pairs, 0], motion[:pairs, 1 : 1 + tangents] = model.normal_rows, slips
    if unknowns == 6:
        motion[:pairs, 3:, 3:] = model.rows[:, :, :3]
        motion[pairs:, :3, :3] = local_axes(model.bolt_rows[:, :3])[:, [1, 0, 2]]
    else:
        motion[pairs:, 0, :2] = model.bolt_rows[:, 1::-1] * [-1.0, 1.0]
    motion[pairs:, 1] = model.bolt_rows  # the shortening of a bolt is the first slip of its contact
    normal_rows, slip_rows = np.zeros((count, unknowns)), np.zeros((count, tangents, unknowns))
    normal_rows[:pairs, 0] = slip_rows[:, 0, 1] = 1.0
    slip_rows[:pairs, 1:, 2] = 1.0
    kinematics = sparse.csr_matrix(
        np.concatenate(
            [
                np.einsum("mu,muv->mv", normal_rows, motion),
                *np.einsum("mtu,muv->mtv", slip_rows, motion),
            ]
        )
    )
    share = model.bolt_capacity / max(float(model.bolt_capacity.sum()), TINY)
    return AssemblyModel(
        plus=np.zeros(count, dtype=np.int64),
        minus=np.full(count, BEDROCK),
        plus_motion=motion,
        minus_motion=np.zeros_like(motion),
        pair_contact=np.arange(count),
        normal_rows=normal_rows,
        group_contact=np.arange(count),
        slip_rows=slip_rows,
        group_first=np.arange(count),
        control_area=np.append(model.control_area, share),
        cohesion=np.append(model.cohesion, model.bolt_capacity),
        tan_friction=np.append(model.tan_friction, zeros),
        tan_dilation=np.append(model.tan_dilation, zeros),
        patch=np.arange(pairs),
        points=np.zeros((count, 3)),
        moving=np.zeros(1, dtype=np.int64),
        load=model.load[None, :],
        live=np.zeros((1, unknowns)),
        length_scale=model.length_scale,
        force_scale=model.force_scale,
        area_scale=model.area_scale,
        kinematics=kinematics,
        statics=kinematics.T.tocsr(),
        bolts=np.arange(bolts),
        lines=None
        if model.lines is None
        else replace(model.lines.with_bolts(bolts), follows_laws=True),
    )


def _with_bolts(
    model: AssemblyModel, bolts: PassiveBolts, index: Ints, centroids: Floats
) -> AssemblyModel:
    """Return the model with passive bolts as its last contacts.

    The bolts of a block are together as stiff as its joints are in shear, shared by capacity: one bolt of 200 kN
    equals two of 100 kN, and the stiffness does not depend on the strength.

    Parameters
    ----------
    index : (b + 1,) number of each block among the moving ones, -1 for the others
    """
    head, toe = index[bolts.head], index[bolts.toe]
    active = np.flatnonzero((head >= 0) | (toe >= 0))
    if len(active) == 0:
        return model
    forces, middle = bolts.forces[active].copy(), bolts.points[active]
    plus, minus = head[active], toe[active]
    is_flipped = plus < 0  # the plus side always moves
    plus[is_flipped], minus[is_flipped], forces[is_flipped] = (
        minus[is_flipped],
        plus[is_flipped],
        -forces[is_flipped],
    )
    capacity = np.sqrt((forces * forces).sum(axis=1))
    directions = forces / capacity[:, None]
    in_section, contacts, blocks = model.unknowns == 3, len(model.plus), len(model.moving)
    if in_section:  # the tangent of the axes is the bolt
        axes = section_axes(
            np.stack([-directions[:, 2], directions[:, 1], directions[:, 0]], axis=1)
        )
    else:
        axes = local_axes(directions)[:, [2, 0, 1]]
    arms = (middle - centroids[model.moving[plus]]) / model.length_scale
    plus_motion = _motion(axes, arms, in_section)
    arms = (middle - centroids[model.moving[minus]]) / model.length_scale
    minus_motion = -_motion(axes, arms, in_section) * (minus >= 0)[:, None, None]
    slip_rows = np.zeros((len(active), *model.slip_rows.shape[1:]))
    slip_rows[:, 0, 1] = 1.0
    joint_areas = sum(
        np.bincount(side[model.pair_contact] + 1, model.control_area, blocks + 1)[1:]
        for side in (model.plus, model.minus)
    )
    areas = np.asarray(joint_areas)[plus] * capacity / np.bincount(plus, capacity, blocks)[plus]
    number, zeros = contacts + np.arange(len(active)), np.zeros(len(active))
    pairs, groups = len(model.control_area), len(model.group_contact)
    bolted_model = replace(
        model,
        plus=np.append(model.plus, plus),
        minus=np.append(model.minus, minus),
        plus_motion=frozen(np.concatenate([model.plus_motion, plus_motion])),
        minus_motion=frozen(np.concatenate([model.minus_motion, minus_motion])),
        pair_contact=np.append(model.pair_contact, number),
        normal_rows=frozen(
            np.concatenate([model.normal_rows, np.zeros((len(active), model.unknowns))])
        ),
        group_contact=np.append(model.group_contact, number),
        slip_rows=frozen(np.concatenate([model.slip_rows, slip_rows])),
        group_first=np.append(model.group_first, pairs + np.arange(len(active))),
        control_area=frozen(np.append(model.control_area, areas)),
        cohesion=frozen(np.append(model.cohesion, capacity / model.force_scale)),
        tan_friction=frozen(np.append(model.tan_friction, zeros)),
        tan_dilation=frozen(np.append(model.tan_dilation, zeros)),
        points=frozen(np.concatenate([model.points, middle])),
        bolts=active,
        lines=None if model.lines is None else model.lines.with_bolts(len(active)),
    )
    tangents = model.slip_rows.shape[1]
    rows = np.concatenate(
        [
            bolted_model.normal_rows,
            bolted_model.slip_rows.reshape(groups * tangents + len(active) * tangents, -1),
        ]
    )
    kinematics = _kinematics(
        rows,
        np.concatenate(
            [bolted_model.pair_contact, np.repeat(bolted_model.group_contact, tangents)]
        ),
        bolted_model.plus,
        bolted_model.minus,
        bolted_model.plus_motion,
        bolted_model.minus_motion,
        blocks,
    )
    return replace(bolted_model, kinematics=kinematics, statics=kinematics.T.tocsr())


def _kinematics(
    rows: Floats,
    contact: Ints,
    plus: Ints,
    minus: Ints,
    plus_motion: Floats,
    minus_motion: Floats,
    blocks: int,
) -> Any:
    """Return B, sparse (r, blocks u): rows (r, u) per motion of their contact as rows per motion of the blocks."""
    unknowns = rows.shape[1]
    values, columns, entry_rows = [], [], []
    for side, motion in ((plus, plus_motion), (minus, minus_motion)):
        row_numbers = np.flatnonzero(side[contact] >= 0)
        values.append(
            np.matmul(rows[row_numbers][:, None, :], motion[contact[row_numbers]])[:, 0, :].ravel()
        )
        columns.append(
            (side[contact[row_numbers]][:, None] * unknowns + np.arange(unknowns)).ravel()
        )
        entry_rows.append(np.repeat(row_numbers, unknowns))
    return sparse.csr_matrix(
        (np.concatenate(values), (np.concatenate(entry_rows), np.concatenate(columns))),
        shape=(len(rows), blocks * unknowns),
    )


def _motion(axes: Floats, arms: Floats, in_section: bool) -> Floats:
    """Return the motion of a point in local axes per motion of its block, (k, u, u).

    arms : (k, 3) from the centroid of the block to the point
    """
    if in_section:
        motion = np.zeros((len(axes), 3, 3))
        motion[:, :2, 0], motion[:, :2, 1] = axes[:, :2, 0], axes[:, :2, 2]
        turn = np.stack([arms[:, 2], np.zeros(len(arms)), -arms[:, 0]], axis=1)  # e_y x arm
        motion[:, :2, 2] = np.einsum("kij,kj->ki", axes[:, :2], turn)
        motion[:, 2, 2] = 1.0
        return motion
    motion = np.zeros((len(axes), 6, 6))
    motion[:, :3, :3] = axes
    motion[:, :3, 3:] = np.cross(arms[:, None, :], axes)
    motion[:, 3:, 3:] = axes
    return motion


def section_axes(normals: Floats) -> Floats:
    """Return the normal, the tangent in the section (e_y x normal) and y of each contact, (k, 3, 3)."""
    axes = np.zeros((len(normals), 3, 3))
    axes[:, 0] = normals
    axes[:, 1, 0], axes[:, 1, 2] = normals[:, 2], -normals[:, 0]
    axes[:, 2, 1] = 1.0
    return axes
