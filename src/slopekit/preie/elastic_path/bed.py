"""Many blocks on elastic joints without tension: forces at a displacement, their tangent, and Newton's method.

    N_i = a_i <-B_n u>,    T_g = -k_t A_g s_g cut back to λ r_g,    r_g = Σ c + μ_g Σ N,    R = B_nᵀ N + B_tᵀ T + P

`a` are the control areas (k_n is one in the model's units), k_t = ρ k_n, λ = 1/F. The law is holonomic: what is found
at a displacement does not depend on the way there. Slip that dilates by tan ψ <= λ μ presses the joint:
N_i = a_i <-B_n u + tan ψ p>, p the slip beyond the elastic one.

A step of viscous flow adds η K_e (u - u_before) to what the forces have to balance, K_e the stiffness of joints that
stick and pull; with η large enough it always has one solution.

Passive bolts are friction forces of their own, one-sided: 0 <= T <= λ r, and nothing where the bolt gets shorter.
"""

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import SolverError
from slopekit.preie.elastic_path.bed_states import BedForces, Drive, NewtonStep, PressedShare
from slopekit.preie.solvers.stiffness import SparseStiffness
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.system.contact import SHEAR_TO_NORMAL
from slopekit.preie.system.joint_strengths import strengths_of
from slopekit.preie.system.patterns import ContactPattern
from slopekit.preie.tolerances import (
    DIAGONAL_SHIFT,
    EACH_BALANCED,
    LIGHTEST,
    ROUGHLY_SETTLED,
    SPRING_ROUNDING,
    TINY,
    TOUCHES,
)

_DENSE = 20_000  # entries: below, B as a dense matrix multiplies faster than as a sparse one
_SHORTEST = 0.02  # step of a line search
_TRIES = 12  # Newton steps
_FARTHER = 4  # Newton steps in a row that may climb before a shorter step of the path is tried
_POLISHES = 3  # of a state that is at rest
_KINKS = 8  # of the law of a joint that dilates: a flat contact has a few node pairs
_BENDS, _STRAIGHT = 40, 1e-14  # Newton steps along a curved one, and change, in parts of what sticks, that ends them


class Bed:
    """A model on its elastic joints, driven by its strength or by a load.

    Cohesion acts on the pressed part of a contact (`cells`), but for contacts that `have_opened` (k,), which have none;
    where `bond` (m,) is given it is the share of the cohesion that acts, wherever the blocks go.
    `held` (k, u) is the relative motion of contacts by blocks that are held where they are, `slid` (g, t) the slip that
    stays, None where joints spring back from all of it.
    """

    def __init__(
        self,
        model: AssemblyModel,
        drive: Drive,
        bond: Floats | None = None,
        ratio: float | Floats = SHEAR_TO_NORMAL,
        held: Floats | None = None,
    ) -> None:
        self.model, self.drive = model, drive
        self.ratio = ratio
        self.bond = np.ones(len(model.control_area)) if bond is None else bond
        self.held = held
        self.slid: Floats | None = None
        if held is not None:
            of_pairs = (model.normal_rows * held[model.pair_contact]).sum(axis=1)
            of_groups = np.matmul(model.slip_rows, held[model.group_contact][:, :, None])
            self._of_held = np.concatenate([of_pairs, of_groups.ravel()])
        self.pairs, (self.groups, self.tangents) = len(model.control_area), model.slip_rows.shape[:2]
        self.size = model.load.size
        self.area = model.control_area
        self.group_of_pair = model.group_of_pair
        self.strengths = strengths_of(model, self.group_of_pair)
        self._summed = self.strengths.summed
        self.spring = ratio * self._summed(self.area)
        self.cohesion = self._summed(model.cohesion * self.bond)
        self.friction = model.tan_friction
        self.cells = model.cells if bond is None else None
        self.have_opened: Bools | None = None
        self.bolted: Bools | None = model.bolted if len(model.bolts) else None
        self.dilates = bool(model.tan_dilation.any())
        self.stiffness = SparseStiffness(model, symmetric=held is None)
        self.contacts = len(model.plus)
        self._pattern = ContactPattern(model)
        self._pressing = self.area[:, None] * model.normal_rows
        self._transposed = np.ascontiguousarray(model.slip_rows.transpose(0, 2, 1))
        self._group_starts = np.searchsorted(model.group_contact, np.arange(self.contacts))
        self._one_each = self.groups == self.contacts
        self._kernels, self._law = self._pattern.kernels, None
        if self._kernels is not None:
            self._bonds = self.cohesion.copy()  # what of it acts at the displacement that is looked at
            given = self.area, self.spring, self._bonds, self.friction, self.bolted, held
            self._law = self._kernels.law(self._pattern.contacts, *given)
        every = np.ones(self.pairs, dtype=bool)
        self.elastic = self._local(every, self.spring[:, None, None] * np.eye(self.tangents))
        self.evaluations = self.factorisations = 0
        self.load_size = float(np.abs(drive.load).max())
        own = np.sqrt((drive.load.reshape(model.load.shape) ** 2).sum(axis=1))
        own = np.maximum(own, LIGHTEST * float(own.max(initial=0.0)))
        self.unbalanced_at_most = EACH_BALANCED * np.repeat(own, model.unknowns)
        self.working = self._working()
        if held is None:  # of a few blocks hardly anybody asks
            self._at_first = self._elastic()

    def pressed_share(self, displacement: Floats, reduction: float) -> PressedShare | None:
        """Return the share of the cohesion that acts; None where no contact has any.

        Joints that dilate are pressed by as much as slip opens them.
        """
        cells, contact = self.cells, self.model.group_contact
        if cells is None:
            return None
        by_strength = np.zeros(self.groups)
        if self._kernels is not None and not self.dilates:
            share, slopes = np.ones(self.groups), np.zeros((self.groups, self.model.unknowns))
            self._kernels.pressed_share(
                self._law, *cells.corners.shape, cells.groups.shape[1], cells.contact, cells.corners, cells.groups,
                cells.parts, TOUCHES, np.ascontiguousarray(displacement), share, slopes,
            )  # fmt: skip
        else:
            relative = self.rows @ displacement if self.held is None else self.rows @ displacement + self._of_held
            size, by_slip = self._slip_of_contacts(displacement)
            dilation = self._dilation(reduction)[self._group_starts]
            gaps = relative[: self.pairs] - (dilation * size)[self.model.pair_contact] - TOUCHES
            share, slopes = cells.pressed_share(gaps, self.model.normal_rows, self.groups)
            # where the joint dilates by all of its reduced friction angle that angle falls too
            steeper = np.where(self.model.tan_dilation > reduction * self.friction, self.friction, 0.0)
            by_strength = -slopes[:, 0] * steeper * size[contact]
            slopes[:, 1 : 1 + self.tangents] -= (dilation[:, None] * by_slip)[contact] * slopes[:, :1]
        if self.have_opened is not None:
            gone = self.have_opened[contact]
            share[gone] = by_strength[gone] = 0.0
            slopes[gone] = 0.0
        return PressedShare(share, slopes, by_strength)

    def _slip_of_contacts(self, displacement: Floats) -> tuple[Floats, Floats]:
        """Return how far contacts slip at their centroids, (k,), and which way, (k, t)."""
        model = self.model
        blocks = np.concatenate([displacement.reshape(model.load.shape), np.zeros((1, model.unknowns))])
        motion = np.matmul(model.plus_motion, blocks[model.plus][:, :, None])[:, :, 0]
        motion += np.matmul(model.minus_motion, blocks[model.minus][:, :, None])[:, :, 0]
        if self.held is not None:
            motion = motion + self.held
        slip = motion[:, 1 : 1 + self.tangents]
        size = np.sqrt((slip * slip).sum(axis=1))
        return size, slip / np.maximum(size, TINY)[:, None]

    def opened_by(self, motion: Floats, parameter: float, least: float) -> Bools:
        """Return the cohesive contacts (k,) that a motion (N,) opens anywhere, by `least` of its fastest part."""
        opened = np.zeros(self.contacts, dtype=bool)
        if self.cells is not None:
            opening, slip = self.motion(motion, parameter)
            fastest = max(float(np.abs(opening).max()), float(np.abs(slip).max()))
            opens = (opening[self.cells.corners] > least * fastest).any(axis=1)
            opened[self.cells.contact[opens]] = True
        return opened

    def with_opened(self, contacts: Bools) -> "Bed":
        """Return the same joints without the cohesion of some contacts (k,), which have opened."""
        other = copy.copy(self)
        other.have_opened = contacts
        return other

    def with_cohesion_at(self, displacement: Floats, parameter: float) -> "Bed":
        """Return the same joints with the cohesion of what is pressed at a displacement (N,), wherever they go."""
        pressed = self.pressed_share(displacement, self.drive.at(parameter)[0])
        if pressed is None:
            return self
        other = copy.copy(self)
        other.cells, other.bond = None, pressed.share[self.group_of_pair]
        other.cohesion = self._summed(self.model.cohesion * other.bond)
        if self._kernels is not None:
            other._bonds = other.cohesion.copy()
            given = self.area, self.spring, other._bonds, self.friction, self.bolted, self.held
            other._law = self._kernels.law(self._pattern.contacts, *given)
        return other

    @cached_property
    def rows(self) -> Any:
        """B, (m + g t, N)."""
        dense = math.prod(self.model.kinematics.shape) <= _DENSE
        return self.model.kinematics.toarray() if dense else self.model.kinematics

    @cached_property
    def columns(self) -> Any:
        """Bᵀ."""
        return np.ascontiguousarray(self.rows.T) if isinstance(self.rows, np.ndarray) else self.model.statics

    @cached_property
    def _at_first(self) -> tuple[Floats, float]:
        return self._elastic()

    def _elastic(self) -> tuple[Floats, float]:
        """Where joints that stick and pull come to rest (N,), and the work that drives them there."""
        solver = self.factored(self.elastic)  # not kept: of thousands of blocks it is 200 MB
        rest = solver(self.drive.load)
        driven = rest if self.drive.ramp is None else solver(self.drive.working)
        return rest, abs(float(self.working @ driven))

    @property
    def elastic_displacement(self) -> Floats:
        """Of joints that stick and pull, (N,)."""
        return self._at_first[0]

    @property
    def elastic_work(self) -> float:
        """What drives does that work there."""
        return self._at_first[1]

    def worked(self, at: Floats) -> float:
        """The work of what drives at a displacement (N,), in parts of the elastic."""
        return abs(float(self.working @ at)) / self.elastic_work

    def _working(self) -> Floats:
        """What the work of the path is measured with, (N,): the load that drives.

        In space, where a bench holds slivers a millionth of its largest block, each block's in parts of its own: else
        the smallest would have to slide for kilometres before its work is seen.
        """
        working = self.drive.working
        if self.tangents == 1 or self.drive.ramp is not None:
            return working
        of_block = working.reshape(self.model.load.shape)
        own = np.sqrt((of_block * of_block).sum(axis=1))
        parts: Floats = of_block / np.maximum(own, 1e-12 * float(own.max()))[:, None]
        return parts.ravel()

    # -- the law ------------------------------------------------------------------------------------------------------

    def forces(self, at: Floats, parameter: float, modes: BedForces | None = None) -> BedForces:
        """Forces at the displacement (N,).

        Parameters
        ----------
        modes : pairs touch and joints slip (in a section) as they do there, whatever the forces: all is linear
        """
        self.evaluations += 1
        reduction, load = self.drive.at(parameter)
        if self._kernels is not None and modes is None and not self.dilates and self.slid is None:
            pressed = self.pressed_share(at, reduction)
            if self.strengths.curved:
                return self._by_laws(pressed, at, reduction, load)
            if pressed is not None:
                np.multiply(self.cohesion, pressed.share, out=self._bonds)
            there = self._compiled_forces(at, reduction, load, None)
            there.pressed = pressed
            return there
        relative = self.rows @ at if self.held is None else self.rows @ at + self._of_held
        opening, slip = relative[: self.pairs], relative[self.pairs :].reshape(self.groups, self.tangents)
        if self.slid is not None:
            slip = slip - self.slid
        pressing = -self.area * opening
        elastic = self.spring[:, None] * slip
        size = np.abs(elastic[:, 0]) if self.tangents == 1 else np.sqrt((elastic * elastic).sum(axis=1))
        touching = opening < 0.0 if modes is None else modes.touching
        normal = np.where(touching, pressing, 0.0)
        direction = elastic / np.maximum(size, TINY)[:, None] if modes is None else modes.direction
        pressed = self.pressed_share(at, reduction)
        cohesion = self._cohesion_of(pressed)
        if self.bolted is not None:
            cohesion = np.where(self.bolted & (direction[:, 0] > 0.0), 0.0, cohesion)
        strength = self.strengths.at(normal, cohesion)
        allowed = reduction * strength
        if modes is None:
            slips = size > allowed
            carried = np.minimum(size, allowed)
        else:
            slips = modes.slips
            size = (elastic * direction).sum(axis=1)
            carried = np.where(slips, allowed, size)
        if self.dilates and slips.any():
            normal, touching, carried = self._dilated(pressing, size, reduction, touching, carried, modes, cohesion)
            strength = self.strengths.at(normal, cohesion)
        friction = -direction * carried[:, None]
        if modes is not None:
            friction = np.where(slips[:, None], friction, -elastic)
        unbalanced = self.columns @ np.concatenate([normal, friction.ravel()]) + load
        return BedForces(
            normal, friction, strength, touching, slips, direction, size / self.spring, unbalanced,
            max(self.load_size, float(normal.max())),
            SPRING_ROUNDING * (float(np.abs(pressing).max()) + float(size.max())), pressed,
        )  # fmt: skip

    def _cohesion_of(self, pressed: PressedShare | None) -> Floats:
        """Return the cohesion forces (g,), of which a share acts."""
        return self.cohesion if pressed is None else self.cohesion * pressed.share

    def _compiled_forces(self, at: Floats, reduction: float, load: Floats, allowed: Floats | None) -> BedForces:
        normal, strength, slip = np.empty(self.pairs), np.empty(self.groups), np.empty(self.groups)
        friction, direction = np.empty((self.groups, self.tangents)), np.empty((self.groups, self.tangents))
        touching, slips = np.empty(self.pairs, dtype=bool), np.empty(self.groups, dtype=bool)
        unbalanced = np.empty(self.size)
        highest, pressed, longest = self._kernels.forces(
            self._law, np.ascontiguousarray(at), reduction, load, allowed,
            normal, friction, strength, touching, slips, direction, slip, unbalanced,
        )  # fmt: skip
        return BedForces(
            normal, friction, strength, touching, slips, direction, slip, unbalanced, max(self.load_size, highest),
            SPRING_ROUNDING * (pressed + longest),
        )  # fmt: skip

    def _by_laws(self, pressed: PressedShare | None, at: Floats, reduction: float, load: Floats) -> BedForces:
        """The forces with the strengths of curved laws at the normal forces there, and of cohesion where it acts."""
        there = self._compiled_forces(at, reduction, load, None)
        strength = self.strengths.at(there.normal, self._cohesion_of(pressed))
        if self.bolted is not None:  # slack ones have none
            strength = np.where(self.bolted, there.strength, strength)
        there = self._compiled_forces(at, reduction, load, reduction * strength)
        there.strength, there.pressed = strength, pressed
        return there

    def _dilation(self, reduction: float) -> Floats:
        """Tangents of dilation (g,): no joint dilates by more than its reduced friction angle."""
        return np.minimum(self.model.tan_dilation, reduction * self.friction)

    def _dilated(
        self, pressing: Floats, size: Floats, reduction: float, touching: Bools, carried: Floats,
        modes: BedForces | None, cohesion: Floats,
    ) -> tuple[Floats, Bools, Floats]:  # fmt: skip
        """Normal forces, touching pairs and friction where slip presses the joints: linear in p by pieces, on lines."""
        dilation, of_pair = self._dilation(reduction), self.group_of_pair
        pushes = self.area * dilation[of_pair] / self.spring[of_pair]
        strengths, beyond = self.strengths, np.zeros_like(size)
        for _ in range(_BENDS if strengths.curved else _KINKS):
            begun = beyond if strengths.curved else np.zeros_like(size)
            there = np.where(touching, pressing + pushes * begun[of_pair], 0.0)
            allowed = reduction * strengths.at(there, cohesion)
            gain = strengths.followed(reduction * strengths.slopes(there), np.where(touching, pushes, 0.0))
            beyond = begun + (size - begun - allowed) / (1.0 + gain)  # k_t A p
            beyond = np.maximum(beyond, 0.0) if modes is None else np.where(modes.slips, beyond, 0.0)
            now = pressing + pushes * beyond[of_pair] > 0.0 if modes is None else touching
            bends = strengths.curved and bool((np.abs(beyond - begun) > _STRAIGHT * size).any())
            if (now == touching).all() and not bends:
                break
            touching = now
        normal = np.where(touching, pressing + pushes * beyond[of_pair], 0.0)
        return normal, touching, np.where(beyond != 0.0, size - beyond, carried)

    def _local(self, touching: Bools | Floats, tangent: Floats) -> Floats:
        """Stiffness (k, u, u) of the contacts: pairs that touch, and tangent stiffnesses (g, t, t)."""
        return self._pattern.stiffness(self.area * touching, tangent)

    def _by_contact(self, of_groups: Floats) -> Floats:
        if self._one_each:
            return of_groups
        return np.add.reduceat(of_groups, self._group_starts)

    def tangent(self, there: BedForces, parameter: float, viscosity: float = 0.0, turning: bool = True) -> Floats:
        """Stiffness (k, u, u) of the contacts at some forces.

        Parameters
        ----------
        turning : in space the direction of slip follows the displacement
        """
        if self._kernels is not None and not self.dilates:
            local = np.empty_like(self.elastic)
            reduction, _ = self.drive.at(parameter)
            curved = self.strengths.curved
            self._kernels.tangent(
                self._law, reduction, viscosity, not curved, turning, there.touching, there.slips,
                there.direction, there.friction, there.slip, self.elastic,
                None if there.pressed is None else there.pressed.slopes, self.cohesion, local,
            )  # fmt: skip
            return local - self._coupled(there, reduction) if curved else local
        carried = np.sqrt((there.friction * there.friction).sum(axis=1))
        sideways = self.spring.copy()
        if turning:
            np.divide(carried, there.slip, out=sideways, where=there.slips & (there.slip > 0.0))
        else:
            sideways[there.slips] = 0.0
        e = there.direction
        tangent = sideways[:, None, None] * np.eye(self.tangents)
        tangent -= np.where(there.slips, sideways, 0.0)[:, None, None] * e[:, :, None] * e[:, None, :]
        local = self._local(there.touching, tangent)
        if there.slips.any():
            reduction, _ = self.drive.at(parameter)
            if not self.dilates:
                local -= self._coupled(there, reduction)
                if there.pressed is not None:
                    local += self._shared(there, reduction)
            else:
                slipping = np.matmul(self._transposed, e[:, :, None])[:, :, 0]  # (g, u)
                rows = self._pressing * there.touching[:, None]
                pressing = np.add.reduceat(rows, self.model.group_first)
                follows = reduction * self.strengths.slopes(there.normal)
                dilation = np.where(there.slips, self._dilation(reduction), 0.0)
                stiff = self.spring + dilation * self._pushed(follows, there)
                dragged = self.strengths.rows(follows, rows)
                if there.pressed is not None:
                    dragged -= (reduction * self.cohesion)[:, None] * there.pressed.slopes
                dragged[~there.slips] = 0.0
                beyond = (self.spring[:, None] * slipping + dragged) / stiff[:, None]
                carries = np.where(there.slips, self.spring, 0.0)[:, None] * (slipping - beyond)
                local += self._by_contact(slipping[:, :, None] * carries[:, None, :])
                local -= self._by_contact((dilation[:, None] * pressing)[:, :, None] * beyond[:, None, :])
        return local + viscosity * self.elastic if viscosity else local

    def _coupled(self, there: BedForces, reduction: float) -> Floats:
        """How friction that slips follows the normal forces: a stiffness (k, u, u) that is taken away."""
        slipping = np.matmul(self._transposed, there.direction[:, :, None])[:, :, 0]  # (g, u)
        pressing = self._pressing * there.touching[:, None]
        dragged = self.strengths.rows(reduction * self.strengths.slopes(there.normal), pressing)
        dragged[~there.slips] = 0.0
        return self._by_contact(slipping[:, :, None] * dragged[:, None, :])

    def _shared(self, there: BedForces, reduction: float) -> Floats:
        """How friction that slips follows the pressed share of its contact: a stiffness (k, u, u)."""
        assert there.pressed is not None
        slipping = np.matmul(self._transposed, there.direction[:, :, None])[:, :, 0]  # (g, u)
        slipping *= np.where(there.slips, reduction * self.cohesion, 0.0)[:, None]
        return self._by_contact(slipping[:, :, None] * there.pressed.slopes[:, None, :])

    def _pushed(self, follows: Floats, there: BedForces) -> Floats:
        """How strength grows with an even closing of what touches, (g,)."""
        return self.strengths.followed(follows, np.where(there.touching, self.area, 0.0))

    def by_parameter(self, there: BedForces, parameter: float) -> Floats:
        """How the unbalanced force changes with the parameter, (N,)."""
        if self.drive.ramp is not None:
            return self.drive.ramp
        weaker = np.where(there.slips, there.strength, 0.0)
        normal = np.zeros(self.pairs)
        if self.dilates:
            dilation = np.where(there.slips, self._dilation(parameter), 0.0)
            pushed = self._pushed(parameter * self.strengths.slopes(there.normal), there)
            if there.pressed is not None:
                shared = parameter * self.cohesion * there.pressed.by_strength
                weaker = weaker + np.where(there.slips, shared, 0.0)
            # where the joint dilates by all of its reduced friction angle that angle falls too
            steeper = np.where(self.model.tan_dilation > parameter * self.friction, self.friction, 0.0)
            carried = np.sqrt((there.friction * there.friction).sum(axis=1))
            pressed = np.where(there.slips, steeper * (there.slip - carried / self.spring), 0.0)
            beyond = -(weaker + pushed * pressed) / (self.spring + dilation * pushed)
            weaker = -self.spring * beyond
            normal = np.where(there.touching, self.area, 0.0) * (dilation * beyond + pressed)[self.group_of_pair]
        changed: Floats = self.columns @ np.concatenate([normal, (-there.direction * weaker[:, None]).ravel()])
        return changed

    def factored(self, local: Floats, symmetric: bool = False) -> Callable[[Floats], Floats]:
        """A solver of the stiffness.

        Raises
        ------
        SolverError
            E599 it is singular.
        """
        self.factorisations += 1
        return self.stiffness.factored(local, DIAGONAL_SHIFT, symmetric)

    def motion(self, velocity: Floats, parameter: float) -> tuple[Floats, Floats]:
        """Opening (m,) beyond what slip opens by itself, and slip (g, t), of a motion (N,)."""
        relative = self.rows @ velocity
        opening, slip = relative[: self.pairs], relative[self.pairs :].reshape(self.groups, self.tangents)
        if self.dilates:
            reduction, _ = self.drive.at(parameter)
            size = np.sqrt((slip * slip).sum(axis=1))
            opening = opening - (self._dilation(reduction) * size)[self.group_of_pair]
        return opening, slip

    def turned(self, modes: BedForces, velocity: Floats) -> BedForces:
        """The modes with the directions of slip of a motion (N,), where it slips."""
        _, slip = self.motion(velocity, 1.0)
        size = np.sqrt((slip * slip).sum(axis=1))
        clear = modes.slips & (size > 1e-6 * float(size.max()))
        direction = np.where(clear[:, None], slip / np.maximum(size, TINY)[:, None], modes.direction)
        return replace(modes, direction=direction)

    def viscous(self, moved: Floats) -> Floats:
        """K_e times a displacement, (N,)."""
        if self._kernels is not None:
            pushed = np.zeros(self.size)
            self._kernels.add_viscous(self._law, np.ascontiguousarray(moved), 1.0, pushed)
            return pushed
        relative = self.rows @ moved
        springs = np.concatenate([self.area, np.repeat(self.spring, self.tangents)])
        force: Floats = self.columns @ (springs * relative)
        return force

    # -- Newton's method ----------------------------------------------------------------------------------------------

    def among(self, blocks: Ints, at: Floats) -> "Bed":
        """The elastic joints of some blocks (b,), ascending, with all others held at the displacement (N,)."""
        u = self.model.unknowns
        those = (blocks[:, None] * u + np.arange(u)).ravel()
        model, contacts, pairs, groups = self.model.among(blocks)
        others = at.reshape(-1, u).copy()
        others[blocks] = 0.0
        plus, minus = self.model.plus[contacts], self.model.minus[contacts]
        held = np.matmul(self.model.plus_motion[contacts], others[plus][:, :, None])
        held += np.matmul(self.model.minus_motion[contacts], others[minus][:, :, None])
        ramp = None if self.drive.ramp is None else self.drive.ramp[those]
        drive = replace(self.drive, load=self.drive.load[those], ramp=ramp)
        ratio = self.ratio[groups] if isinstance(self.ratio, np.ndarray) else self.ratio
        few = Bed(model, drive, None if self.cells is not None else self.bond[pairs], ratio, held[:, :, 0])
        few.have_opened = None if self.have_opened is None else self.have_opened[contacts]
        few.unbalanced_at_most = self.unbalanced_at_most[those]
        few.slid = None if self.slid is None else self.slid[groups]
        return few

    def with_slip_of(self, at: Floats, there: BedForces) -> "Bed":
        """The same joints, their slip at a displacement (N,) there to stay but for what its forces spring back.

        Bolts, which go slack, spring back by all of theirs.
        """
        other = copy.copy(self)
        slip = (self.rows @ at)[self.pairs :].reshape(self.groups, self.tangents)
        other.slid = slip + there.friction / self.spring[:, None]
        if self.bolted is not None:
            other.slid[self.bolted] = 0.0
        return other

    def polished(self, at: Floats, parameter: float) -> tuple[Floats, BedForces]:
        """A state at rest nearer to balance, so that slivers are too, and its forces."""
        there = self.forces(at, parameter)
        for _ in range(_POLISHES):
            try:
                trial = at + self.factored(self.tangent(there, parameter))(there.unbalanced)
            except SolverError:
                break
            seen = self.forces(trial, parameter)
            if not seen.residual < 0.5 * there.residual:
                break
            at, there = trial, seen
        return at, there

    def onward(self, step: NewtonStep) -> Floats | None:
        """How the blocks go on from a state at rest as work is done, (N,) per unit of work; None where they do not."""
        try:
            solver = self.factored(self.tangent(step.forces, step.parameter))
        except SolverError:
            return None
        motion = solver(self.by_parameter(step.forces, step.parameter))
        gained = float(self.working @ motion)
        return motion / gained if np.isfinite(motion).all() and gained != 0.0 else None

    def _each_balanced(self, off: Floats) -> bool:
        """Whether, in space, where there are slivers, forces (N,) are small in parts of the load of each block."""
        return self.tangents == 1 or bool((np.abs(off) < self.unbalanced_at_most).all())

    def unbalanced_parts(
        self, at: Floats, before: Floats, parameter: float, viscosity: float
    ) -> tuple[BedForces, Floats]:
        there = self.forces(at, parameter)
        if not viscosity:
            return there, there.unbalanced
        return there, there.unbalanced - viscosity * self.viscous(at - before)

    def newton(
        self, at: Floats, before: Floats, parameter: float, viscosity: float, work: float | None, downhill: bool
    ) -> NewtonStep:
        working = self.working
        there, off = self.unbalanced_parts(at, before, parameter, viscosity)
        size = best = float(np.abs(off).max())
        stalled = farther = 0

        def worked(at: Floats, part: float) -> bool:
            return work is None or abs(work - float(working @ at)) < part * abs(work)

        for taken in range(_TRIES + 1):
            if there.balanced(size) and self._each_balanced(off) and worked(at, 1e-9):
                return NewtonStep(at, parameter, there, True, taken)
            if taken == _TRIES or not np.isfinite(size):
                break
            try:
                solver = self.factored(self.tangent(there, parameter, viscosity))
            except SolverError:
                break
            if work is None:
                way, change = solver(off), 0.0
            else:
                both = solver(np.stack([off, self.by_parameter(there, parameter)], axis=1))
                gained = float(working @ both[:, 1])
                if gained == 0.0:
                    break
                change = (work - float(working @ (at + both[:, 0]))) / gained
                way = both[:, 0] + change * both[:, 1]
            if not np.isfinite(way).all():
                break
            length = 1.0 if abs(change) <= 0.5 * abs(parameter) else 0.5 * abs(parameter) / abs(change)
            nearest: tuple[float, Floats, float, BedForces, Floats] | None = None
            while True:
                trial, tried = at + length * way, parameter + length * change
                seen, left = self.unbalanced_parts(trial, before, tried, viscosity)
                now = float(np.abs(left).max())
                if nearest is None or now < nearest[0]:
                    nearest = now, trial, tried, seen, left
                least = size if work is None else max(size, 1e-9 * self.load_size)
                if not downhill or now < (1.0 - 0.1 * length) * least or length < _SHORTEST:
                    break
                length *= 0.5
            stalled = stalled + 1 if nearest[0] > 0.75 * size and nearest[0] > 1e-8 * self.load_size else 0
            size, at, parameter, there, off = nearest
            farther = farther + 1 if size > best else 0
            lost = size > 1e4 * best or (work is not None and farther >= _FARTHER)
            if stalled >= 3 if downhill else lost:
                break
            best = min(best, size)
        good = there.balanced(size, ROUGHLY_SETTLED) and self._each_balanced(off) and worked(at, 1e-6)
        return NewtonStep(at, parameter, there, good, _TRIES)
