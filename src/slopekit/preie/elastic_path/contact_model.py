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
from slopekit.preie.elastic_path.contact_states import ContactState, Drive, NewtonStep, PressedShare
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

_MAX_DENSE_ENTRIES = (
    20_000  # entries: below, B as a dense matrix multiplies faster than as a sparse one
)
_SHORTEST_STEP = 0.02  # step of a line search
_MAX_NEWTON_STEPS = 12  # Newton steps
_MAX_CLIMBS = 4  # Newton steps in a row that may climb before a shorter step of the path is tried
_MAX_REFINEMENTS = 3  # of a state that is at rest
_MAX_LINEAR_PIECES = 8  # of the law of a joint that dilates: a flat contact has a few node pairs
_MAX_CURVED_STEPS = 40  # Newton steps along a curved strength law of a joint that dilates
_CURVED_TOLERANCE = (
    1e-14  # change of the plastic shear, in parts of the elastic shear, that ends them
)


class ElasticContactModel:
    """A model on its elastic joints, driven by its strength or by a load.

    Cohesion acts on the pressed part of a contact (`cells`), but for contacts that `have_opened` (k,), which have none;
    where `bond` (m,) is given it is the share of the cohesion that acts, wherever the blocks go.
    `prescribed_motion` (k, u) is the relative motion of contacts by blocks that are held where they are;
    `plastic_slip` (g, t) the slip that stays, None where joints spring back from all of it.
    """

    def __init__(
        self,
        model: AssemblyModel,
        drive: Drive,
        bond: Floats | None = None,
        ratio: float | Floats = SHEAR_TO_NORMAL,
        prescribed_motion: Floats | None = None,
    ) -> None:
        self.model, self.drive = model, drive
        self.ratio = ratio
        self.bond = np.ones(len(model.control_area)) if bond is None else bond
        self.prescribed_motion = prescribed_motion
        self.plastic_slip: Floats | None = None
        if prescribed_motion is not None:
            opening = (model.normal_rows * prescribed_motion[model.pair_contact]).sum(axis=1)
            slip = np.matmul(model.slip_rows, prescribed_motion[model.group_contact][:, :, None])
            self._prescribed_relative = np.concatenate([opening, slip.ravel()])
        self.pairs, (self.groups, self.tangents) = (
            len(model.control_area),
            model.slip_rows.shape[:2],
        )
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
        self.stiffness = SparseStiffness(model, symmetric=prescribed_motion is None)
        self.contacts = len(model.plus)
        self._pattern = ContactPattern(model)
        self._pressing = self.area[:, None] * model.normal_rows
        self._transposed = np.ascontiguousarray(model.slip_rows.transpose(0, 2, 1))
        self._group_starts = np.searchsorted(model.group_contact, np.arange(self.contacts))
        self._has_single_groups = self.groups == self.contacts
        self._kernels, self._law = self._pattern.kernels, None
        if self._kernels is not None:
            self._active_cohesion = self.cohesion.copy()  # at the displacement evaluated last
            law_arrays = (
                self.area,
                self.spring,
                self._active_cohesion,
                self.friction,
                self.bolted,
                prescribed_motion,
            )
            self._law = self._kernels.law(self._pattern.contacts, *law_arrays)
        all_touching = np.ones(self.pairs, dtype=bool)
        self.elastic = self._local(all_touching, self.spring[:, None, None] * np.eye(self.tangents))
        self.evaluations = self.factorisations = 0
        self.load_size = float(np.abs(drive.load).max())
        block_loads = np.sqrt((drive.load.reshape(model.load.shape) ** 2).sum(axis=1))
        block_loads = np.maximum(block_loads, LIGHTEST * float(block_loads.max(initial=0.0)))
        self.unbalanced_at_most = EACH_BALANCED * np.repeat(block_loads, model.unknowns)
        self.working = self._work_load()
        if prescribed_motion is None:  # parts of an assembly rarely need it
            self._elastic_state = self._solve_elastic()

    def pressed_share(self, displacement: Floats, reduction: float) -> PressedShare | None:
        """Return the share of the cohesion that acts; None where no contact has any, or its bonds are prescribed.

        Joints that dilate are pressed by as much as slip opens them.
        """
        cells, contact = self.cells, self.model.group_contact
        if cells is None:
            return None
        by_strength = np.zeros(self.groups)
        if self._kernels is not None and not self.dilates:
            share, slopes = np.ones(self.groups), np.zeros((self.groups, self.model.unknowns))
            self._kernels.pressed_share(
                self._law,
                *cells.corners.shape,
                cells.groups.shape[1],
                cells.contact,
                cells.corners,
                cells.groups,
                cells.cohesion_shares,
                TOUCHES,
                np.ascontiguousarray(displacement),
                share,
                slopes,
            )
        else:
            relative = (
                self.rows @ displacement
                if self.prescribed_motion is None
                else self.rows @ displacement + self._prescribed_relative
            )
            size, by_slip = self._slip_of_contacts(displacement)
            dilation = self._dilation(reduction)[self._group_starts]
            gaps = relative[: self.pairs] - (dilation * size)[self.model.pair_contact] - TOUCHES
            share, slopes = cells.pressed_share(gaps, self.model.normal_rows, self.groups)
            # a dilation angle at the reduced friction angle falls with it
            steeper = np.where(
                self.model.tan_dilation > reduction * self.friction, self.friction, 0.0
            )
            by_strength = -slopes[:, 0] * steeper * size[contact]
            slopes[:, 1 : 1 + self.tangents] -= (dilation[:, None] * by_slip)[contact] * slopes[
                :, :1
            ]
        if self.have_opened is not None:
            is_open = self.have_opened[contact]
            share[is_open] = by_strength[is_open] = 0.0
            slopes[is_open] = 0.0
        return PressedShare(share, slopes, by_strength)

    def _slip_of_contacts(self, displacement: Floats) -> tuple[Floats, Floats]:
        """Return how far contacts slip at their centroids, (k,), and which way, (k, t)."""
        model = self.model
        blocks = np.concatenate(
            [displacement.reshape(model.load.shape), np.zeros((1, model.unknowns))]
        )
        motion = np.matmul(model.plus_motion, blocks[model.plus][:, :, None])[:, :, 0]
        motion += np.matmul(model.minus_motion, blocks[model.minus][:, :, None])[:, :, 0]
        if self.prescribed_motion is not None:
            motion = motion + self.prescribed_motion
        slip = motion[:, 1 : 1 + self.tangents]
        size = np.sqrt((slip * slip).sum(axis=1))
        return size, slip / np.maximum(size, TINY)[:, None]

    def opening_contacts(self, motion: Floats, parameter: float, least: float) -> Bools:
        """Return the cohesive contacts (k,) that a motion (N,) opens anywhere, by `least` of its fastest part."""
        opened = np.zeros(self.contacts, dtype=bool)
        if self.cells is not None:
            opening, slip = self.motion(motion, parameter)
            fastest = max(float(np.abs(opening).max()), float(np.abs(slip).max()))
            opens = (opening[self.cells.corners] > least * fastest).any(axis=1)
            opened[self.cells.contact[opens]] = True
        return opened

    def without_cohesion_where(self, contacts: Bools) -> "ElasticContactModel":
        """Return the same joints without the cohesion of some contacts (k,), which have opened."""
        opened = copy.copy(self)
        opened.have_opened = contacts
        return opened

    def with_pressed_cohesion(
        self, displacement: Floats, parameter: float
    ) -> "ElasticContactModel":
        """Return the same joints with the cohesion of what is pressed at a displacement (N,), wherever they go."""
        pressed = self.pressed_share(displacement, self.drive.strength_and_load(parameter)[0])
        if pressed is None:
            return self
        bonded = copy.copy(self)
        bonded.cells, bonded.bond = None, pressed.share[self.group_of_pair]
        bonded.cohesion = self._summed(self.model.cohesion * bonded.bond)
        if self._kernels is not None:
            bonded._active_cohesion = bonded.cohesion.copy()
            law_arrays = (
                self.area,
                self.spring,
                bonded._active_cohesion,
                self.friction,
                self.bolted,
                self.prescribed_motion,
            )
            bonded._law = self._kernels.law(self._pattern.contacts, *law_arrays)
        return bonded

    @cached_property
    def rows(self) -> Any:
        """Return the kinematic matrix B, (m + g t, N): relative motion of pairs and groups."""
        dense = math.prod(self.model.kinematics.shape) <= _MAX_DENSE_ENTRIES
        return self.model.kinematics.toarray() if dense else self.model.kinematics

    @cached_property
    def columns(self) -> Any:
        """Return the transposed kinematic matrix Bᵀ, (N, m + g t)."""
        return (
            np.ascontiguousarray(self.rows.T)
            if isinstance(self.rows, np.ndarray)
            else self.model.statics
        )

    @cached_property
    def _elastic_state(self) -> tuple[Floats, float]:
        """Return the elastic displacement (N,) and the driving work on it, solved once."""
        return self._solve_elastic()

    def _solve_elastic(self) -> tuple[Floats, float]:
        """Return the elastic displacement (N,) of joints that stick and carry tension, and the work of the load."""
        solver = self.factored(self.elastic)  # not kept: of thousands of blocks it is 200 MB
        displacement = solver(self.drive.load)
        driving_displacement = (
            displacement if self.drive.ramp is None else solver(self.drive.working)
        )
        return displacement, abs(float(self.working @ driving_displacement))

    @property
    def elastic_displacement(self) -> Floats:
        """Return the displacement (N,) of joints that neither slip nor open."""
        return self._elastic_state[0]

    @property
    def elastic_work(self) -> float:
        """Return the work of the driving load on the elastic displacement."""
        return self._elastic_state[1]

    def relative_work(self, displacement: Floats) -> float:
        """Return the work of the driving load on a displacement (N,), in parts of its work on the elastic one."""
        return abs(float(self.working @ displacement)) / self.elastic_work

    def _work_load(self) -> Floats:
        """Return the load (N,) whose work measures progress along the path: the driving load.

        In space, where a bench holds slivers a millionth of its largest block, each block's in parts of its own: else
        the smallest would have to slide for kilometres before its work is seen.
        """
        working = self.drive.working
        if self.tangents == 1 or self.drive.ramp is not None:
            return working
        block_forces = working.reshape(self.model.load.shape)
        block_loads = np.sqrt((block_forces * block_forces).sum(axis=1))
        normalised: Floats = (
            block_forces / np.maximum(block_loads, 1e-12 * float(block_loads.max()))[:, None]
        )
        return normalised.ravel()

    # -- the law ------------------------------------------------------------------------------------------------------

    def forces(
        self, displacement: Floats, parameter: float, modes: ContactState | None = None
    ) -> ContactState:
        """Return the contact forces and their modes at a displacement (N,).

        Parameters
        ----------
        modes : a state whose contact modes (touching, slip and its direction) are kept, so that the forces are linear
        """
        self.evaluations += 1
        reduction, load = self.drive.strength_and_load(parameter)
        if (
            self._kernels is not None
            and modes is None
            and not self.dilates
            and self.plastic_slip is None
        ):
            pressed = self.pressed_share(displacement, reduction)
            if self.strengths.curved:
                return self._curved_forces(pressed, displacement, reduction, load)
            if pressed is not None:
                np.multiply(self.cohesion, pressed.share, out=self._active_cohesion)
            state = self._compiled_forces(displacement, reduction, load, None)
            state.pressed = pressed
            return state
        relative = (
            self.rows @ displacement
            if self.prescribed_motion is None
            else self.rows @ displacement + self._prescribed_relative
        )
        opening, slip = (
            relative[: self.pairs],
            relative[self.pairs :].reshape(self.groups, self.tangents),
        )
        if self.plastic_slip is not None:
            slip = slip - self.plastic_slip
        pressing = -self.area * opening
        elastic = self.spring[:, None] * slip
        size = (
            np.abs(elastic[:, 0])
            if self.tangents == 1
            else np.sqrt((elastic * elastic).sum(axis=1))
        )
        touching = opening < 0.0 if modes is None else modes.touching
        normal = np.where(touching, pressing, 0.0)
        direction = elastic / np.maximum(size, TINY)[:, None] if modes is None else modes.direction
        pressed = self.pressed_share(displacement, reduction)
        cohesion = self._cohesion_of(pressed)
        if self.bolted is not None:
            cohesion = np.where(self.bolted & (direction[:, 0] > 0.0), 0.0, cohesion)
        strength = self.strengths.strength(normal, cohesion)
        allowed = reduction * strength
        if modes is None:
            slips = size > allowed
            shear = np.minimum(size, allowed)
        else:
            slips = modes.slips
            size = (elastic * direction).sum(axis=1)
            shear = np.where(slips, allowed, size)
        if self.dilates and slips.any():
            normal, touching, shear = self._dilatant_forces(
                pressing, size, reduction, touching, shear, modes, cohesion
            )
            strength = self.strengths.strength(normal, cohesion)
        friction = -direction * shear[:, None]
        if modes is not None:
            friction = np.where(slips[:, None], friction, -elastic)
        unbalanced = self.columns @ np.concatenate([normal, friction.ravel()]) + load
        return ContactState(
            normal,
            friction,
            strength,
            touching,
            slips,
            direction,
            size / self.spring,
            unbalanced,
            max(self.load_size, float(normal.max())),
            SPRING_ROUNDING * (float(np.abs(pressing).max()) + float(size.max())),
            pressed,
        )

    def _cohesion_of(self, pressed: PressedShare | None) -> Floats:
        """Return the cohesion forces (g,), of which a share acts."""
        return self.cohesion if pressed is None else self.cohesion * pressed.share

    def _compiled_forces(
        self, displacement: Floats, reduction: float, load: Floats, allowed: Floats | None
    ) -> ContactState:
        """Return the contact forces at a displacement (N,) by the compiled kernel.

        `allowed` (g,) are the reduced strengths, None where the kernel finds them from friction and cohesion.
        """
        normal, strength, slip = np.empty(self.pairs), np.empty(self.groups), np.empty(self.groups)
        friction, direction = (
            np.empty((self.groups, self.tangents)),
            np.empty((self.groups, self.tangents)),
        )
        touching, slips = np.empty(self.pairs, dtype=bool), np.empty(self.groups, dtype=bool)
        unbalanced = np.empty(self.size)
        highest, pressed, longest = self._kernels.forces(
            self._law,
            np.ascontiguousarray(displacement),
            reduction,
            load,
            allowed,
            normal,
            friction,
            strength,
            touching,
            slips,
            direction,
            slip,
            unbalanced,
        )
        return ContactState(
            normal,
            friction,
            strength,
            touching,
            slips,
            direction,
            slip,
            unbalanced,
            max(self.load_size, highest),
            SPRING_ROUNDING * (pressed + longest),
        )

    def _curved_forces(
        self, pressed: PressedShare | None, displacement: Floats, reduction: float, load: Floats
    ) -> ContactState:
        """Return the forces with strengths of curved laws at their normal forces, and with cohesion where it acts."""
        state = self._compiled_forces(displacement, reduction, load, None)
        strength = self.strengths.strength(state.normal, self._cohesion_of(pressed))
        if self.bolted is not None:  # slack ones have none
            strength = np.where(self.bolted, state.strength, strength)
        state = self._compiled_forces(displacement, reduction, load, reduction * strength)
        state.strength, state.pressed = strength, pressed
        return state

    def _dilation(self, reduction: float) -> Floats:
        """Return the tangents of dilation (g,): no joint dilates by more than its reduced friction angle."""
        return np.minimum(self.model.tan_dilation, reduction * self.friction)

    def _dilatant_forces(
        self,
        pressing: Floats,
        size: Floats,
        reduction: float,
        touching: Bools,
        shear: Floats,
        modes: ContactState | None,
        cohesion: Floats,
    ) -> tuple[Floats, Bools, Floats]:
        """Return normal forces, touching pairs and shear where dilatant slip presses the joints.

        On straight strength lines the balance is piecewise linear in the plastic slip p.
        """
        dilation, of_pair = self._dilation(reduction), self.group_of_pair
        pushes = self.area * dilation[of_pair] / self.spring[of_pair]
        strengths, plastic_shear = self.strengths, np.zeros_like(size)
        for _ in range(_MAX_CURVED_STEPS if strengths.curved else _MAX_LINEAR_PIECES):
            last_plastic_shear = plastic_shear if strengths.curved else np.zeros_like(size)
            trial_normal = np.where(touching, pressing + pushes * last_plastic_shear[of_pair], 0.0)
            allowed = reduction * strengths.strength(trial_normal, cohesion)
            gain = strengths.strength_change(
                reduction * strengths.slopes(trial_normal), np.where(touching, pushes, 0.0)
            )
            plastic_shear = last_plastic_shear + (size - last_plastic_shear - allowed) / (
                1.0 + gain
            )  # k_t A p
            plastic_shear = (
                np.maximum(plastic_shear, 0.0)
                if modes is None
                else np.where(modes.slips, plastic_shear, 0.0)
            )
            is_pressed = (
                pressing + pushes * plastic_shear[of_pair] > 0.0 if modes is None else touching
            )
            is_curving = strengths.curved and bool(
                (np.abs(plastic_shear - last_plastic_shear) > _CURVED_TOLERANCE * size).any()
            )
            if (is_pressed == touching).all() and not is_curving:
                break
            touching = is_pressed
        normal = np.where(touching, pressing + pushes * plastic_shear[of_pair], 0.0)
        return normal, touching, np.where(plastic_shear != 0.0, size - plastic_shear, shear)

    def _local(self, touching: Bools | Floats, tangent: Floats) -> Floats:
        """Return the stiffness (k, u, u) of contacts of touching pairs (m,) and tangent stiffnesses (g, t, t)."""
        return self._pattern.stiffness(self.area * touching, tangent)

    def _by_contact(self, group_stiffness: Floats) -> Floats:
        """Return stiffnesses of friction groups (g, u, u) summed by contact, (k, u, u)."""
        if self._has_single_groups:
            return group_stiffness
        return np.add.reduceat(group_stiffness, self._group_starts)

    def tangent(
        self, state: ContactState, parameter: float, viscosity: float = 0.0, turning: bool = True
    ) -> Floats:
        """Return the tangent stiffness (k, u, u) of the contacts in a contact state.

        Parameters
        ----------
        turning : whether, in space, the direction of slip follows the displacement
        """
        if self._kernels is not None and not self.dilates:
            local = np.empty_like(self.elastic)
            reduction, _ = self.drive.strength_and_load(parameter)
            curved = self.strengths.curved
            self._kernels.tangent(
                self._law,
                reduction,
                viscosity,
                not curved,
                turning,
                state.touching,
                state.slips,
                state.direction,
                state.friction,
                state.slip,
                self.elastic,
                None if state.pressed is None else state.pressed.slopes,
                self.cohesion,
                local,
            )
            return local - self._friction_coupling(state, reduction) if curved else local
        shear = np.sqrt((state.friction * state.friction).sum(axis=1))
        transverse = self.spring.copy()
        if turning:
            np.divide(shear, state.slip, out=transverse, where=state.slips & (state.slip > 0.0))
        else:
            transverse[state.slips] = 0.0
        e = state.direction
        tangent = transverse[:, None, None] * np.eye(self.tangents)
        tangent -= (
            np.where(state.slips, transverse, 0.0)[:, None, None] * e[:, :, None] * e[:, None, :]
        )
        local = self._local(state.touching, tangent)
        if state.slips.any():
            reduction, _ = self.drive.strength_and_load(parameter)
            if not self.dilates:
                local -= self._friction_coupling(state, reduction)
                if state.pressed is not None:
                    local += self._cohesion_coupling(state, reduction)
            else:
                slip_rows = np.matmul(self._transposed, e[:, :, None])[:, :, 0]  # (g, u)
                rows = self._pressing * state.touching[:, None]
                pressing = np.add.reduceat(rows, self.model.group_first)
                strength_slopes = reduction * self.strengths.slopes(state.normal)
                dilation = np.where(state.slips, self._dilation(reduction), 0.0)
                stiff = self.spring + dilation * self._strength_gain(strength_slopes, state)
                strength_rows = self.strengths.rows(strength_slopes, rows)
                if state.pressed is not None:
                    strength_rows -= (reduction * self.cohesion)[:, None] * state.pressed.slopes
                strength_rows[~state.slips] = 0.0
                plastic_rows = (self.spring[:, None] * slip_rows + strength_rows) / stiff[:, None]
                shear_rows = np.where(state.slips, self.spring, 0.0)[:, None] * (
                    slip_rows - plastic_rows
                )
                local += self._by_contact(slip_rows[:, :, None] * shear_rows[:, None, :])
                local -= self._by_contact(
                    (dilation[:, None] * pressing)[:, :, None] * plastic_rows[:, None, :]
                )
        return local + viscosity * self.elastic if viscosity else local

    def _friction_coupling(self, state: ContactState, reduction: float) -> Floats:
        """Return the stiffness (k, u, u) by which slipping friction follows normal forces; it is subtracted."""
        slip_rows = np.matmul(self._transposed, state.direction[:, :, None])[:, :, 0]  # (g, u)
        pressing = self._pressing * state.touching[:, None]
        strength_rows = self.strengths.rows(
            reduction * self.strengths.slopes(state.normal), pressing
        )
        strength_rows[~state.slips] = 0.0
        return self._by_contact(slip_rows[:, :, None] * strength_rows[:, None, :])

    def _cohesion_coupling(self, state: ContactState, reduction: float) -> Floats:
        """Return the stiffness (k, u, u) by which slipping friction follows the pressed share of its contact."""
        assert state.pressed is not None
        slip_rows = np.matmul(self._transposed, state.direction[:, :, None])[:, :, 0]  # (g, u)
        slip_rows *= np.where(state.slips, reduction * self.cohesion, 0.0)[:, None]
        return self._by_contact(slip_rows[:, :, None] * state.pressed.slopes[:, None, :])

    def _strength_gain(self, strength_slopes: Floats, state: ContactState) -> Floats:
        """Return how the strength (g,) grows as all touching pairs close evenly."""
        return self.strengths.strength_change(
            strength_slopes, np.where(state.touching, self.area, 0.0)
        )

    def parameter_derivative(self, state: ContactState, parameter: float) -> Floats:
        """Return the derivative (N,) of the unbalanced forces by the parameter of the path."""
        if self.drive.ramp is not None:
            return self.drive.ramp
        shear_rate = np.where(state.slips, state.strength, 0.0)
        normal = np.zeros(self.pairs)
        if self.dilates:
            dilation = np.where(state.slips, self._dilation(parameter), 0.0)
            strength_gain = self._strength_gain(
                parameter * self.strengths.slopes(state.normal), state
            )
            if state.pressed is not None:
                shared = parameter * self.cohesion * state.pressed.by_strength
                shear_rate = shear_rate + np.where(state.slips, shared, 0.0)
            # a dilation angle at the reduced friction angle falls with it
            steeper = np.where(
                self.model.tan_dilation > parameter * self.friction, self.friction, 0.0
            )
            shear = np.sqrt((state.friction * state.friction).sum(axis=1))
            pressed = np.where(state.slips, steeper * (state.slip - shear / self.spring), 0.0)
            plastic_rate = -(shear_rate + strength_gain * pressed) / (
                self.spring + dilation * strength_gain
            )
            shear_rate = -self.spring * plastic_rate
            normal = (
                np.where(state.touching, self.area, 0.0)
                * (dilation * plastic_rate + pressed)[self.group_of_pair]
            )
        changed: Floats = self.columns @ np.concatenate(
            [normal, (-state.direction * shear_rate[:, None]).ravel()]
        )
        return changed

    def factored(self, local: Floats, symmetric: bool = False) -> Callable[[Floats], Floats]:
        """Return a solver of the assembled contact stiffness.

        Raises
        ------
        SolverError
            E599 the stiffness is singular.
        """
        self.factorisations += 1
        return self.stiffness.factored(local, DIAGONAL_SHIFT, symmetric)

    def motion(self, velocity: Floats, parameter: float) -> tuple[Floats, Floats]:
        """Return the opening (m,), less the dilation by slip, and the slip (g, t) of a motion (N,)."""
        relative = self.rows @ velocity
        opening, slip = (
            relative[: self.pairs],
            relative[self.pairs :].reshape(self.groups, self.tangents),
        )
        if self.dilates:
            reduction, _ = self.drive.strength_and_load(parameter)
            size = np.sqrt((slip * slip).sum(axis=1))
            opening = opening - (self._dilation(reduction) * size)[self.group_of_pair]
        return opening, slip

    def with_slip_directions(self, modes: ContactState, velocity: Floats) -> ContactState:
        """Return a contact state with the slip directions of a motion (N,) where joints slip."""
        _, slip = self.motion(velocity, 1.0)
        size = np.sqrt((slip * slip).sum(axis=1))
        clear = modes.slips & (size > 1e-6 * float(size.max()))
        direction = np.where(
            clear[:, None], slip / np.maximum(size, TINY)[:, None], modes.direction
        )
        return replace(modes, direction=direction)

    def viscous(self, displacement: Floats) -> Floats:
        """Return the elastic stiffness K_e times a displacement (N,)."""
        if self._kernels is not None:
            viscous_force = np.zeros(self.size)
            self._kernels.add_viscous(
                self._law, np.ascontiguousarray(displacement), 1.0, viscous_force
            )
            return viscous_force
        relative = self.rows @ displacement
        springs = np.concatenate([self.area, np.repeat(self.spring, self.tangents)])
        force: Floats = self.columns @ (springs * relative)
        return force

    # -- Newton's method ----------------------------------------------------------------------------------------------

    def restricted_to(self, blocks: Ints, displacement: Floats) -> "ElasticContactModel":
        """Return the elastic joints of some blocks (b,), ascending, all others held at the displacement (N,)."""
        u = self.model.unknowns
        unknowns = (blocks[:, None] * u + np.arange(u)).ravel()
        model, contacts, pairs, groups = self.model.restricted_to(blocks)
        held_displacement = displacement.reshape(-1, u).copy()
        held_displacement[blocks] = 0.0
        plus, minus = self.model.plus[contacts], self.model.minus[contacts]
        prescribed_motion = np.matmul(
            self.model.plus_motion[contacts], held_displacement[plus][:, :, None]
        )
        prescribed_motion += np.matmul(
            self.model.minus_motion[contacts], held_displacement[minus][:, :, None]
        )
        ramp = None if self.drive.ramp is None else self.drive.ramp[unknowns]
        drive = replace(self.drive, load=self.drive.load[unknowns], ramp=ramp)
        ratio = self.ratio[groups] if isinstance(self.ratio, np.ndarray) else self.ratio
        restricted = ElasticContactModel(
            model,
            drive,
            None if self.cells is not None else self.bond[pairs],
            ratio,
            prescribed_motion[:, :, 0],
        )
        restricted.have_opened = None if self.have_opened is None else self.have_opened[contacts]
        restricted.unbalanced_at_most = self.unbalanced_at_most[unknowns]
        restricted.plastic_slip = None if self.plastic_slip is None else self.plastic_slip[groups]
        return restricted

    def with_plastic_slip(self, displacement: Floats, state: ContactState) -> "ElasticContactModel":
        """Return the same joints with the plastic slip of a displacement (N,): its slip less the elastic part.

        Bolts, which go slack, keep no slip.
        """
        slipped = copy.copy(self)
        slip = (self.rows @ displacement)[self.pairs :].reshape(self.groups, self.tangents)
        slipped.plastic_slip = slip + state.friction / self.spring[:, None]
        if self.bolted is not None:
            slipped.plastic_slip[self.bolted] = 0.0
        return slipped

    def refined_equilibrium(
        self, displacement: Floats, parameter: float
    ) -> tuple[Floats, ContactState]:
        """Return a state at rest, and its forces, after Newton steps that balance its slivers too."""
        state = self.forces(displacement, parameter)
        for _ in range(_MAX_REFINEMENTS):
            try:
                trial = displacement + self.factored(self.tangent(state, parameter))(
                    state.unbalanced
                )
            except SolverError:
                break
            trial_state = self.forces(trial, parameter)
            if not trial_state.residual < 0.5 * state.residual:
                break
            displacement, state = trial, trial_state
        return displacement, state

    def tangent_direction(self, step: NewtonStep) -> Floats | None:
        """Return the tangent (N,) of the path at a state at rest, per unit of work; None where it has none."""
        try:
            solver = self.factored(self.tangent(step.forces, step.parameter))
        except SolverError:
            return None
        motion = solver(self.parameter_derivative(step.forces, step.parameter))
        work_rate = float(self.working @ motion)
        return motion / work_rate if np.isfinite(motion).all() and work_rate != 0.0 else None

    def _blocks_are_balanced(self, unbalanced: Floats) -> bool:
        """Return whether unbalanced forces (N,) in space are small in parts of the load of each block."""
        return self.tangents == 1 or bool((np.abs(unbalanced) < self.unbalanced_at_most).all())

    def unbalanced_forces(
        self, displacement: Floats, previous: Floats, parameter: float, viscosity: float
    ) -> tuple[ContactState, Floats]:
        """Return the contact state at a displacement and its unbalanced forces (N,), the viscous ones included."""
        state = self.forces(displacement, parameter)
        if not viscosity:
            return state, state.unbalanced
        return state, state.unbalanced - viscosity * self.viscous(displacement - previous)

    def newton(
        self,
        displacement: Floats,
        previous: Floats,
        parameter: float,
        viscosity: float,
        work: float | None,
        downhill: bool,
    ) -> NewtonStep:
        """Balance joint and viscous forces by Newton's method from a displacement (N,).

        Parameters
        ----------
        previous : displacement (N,) before the viscous step
        work : of the driving load, to be met with the parameter as one more unknown; None: the parameter stays
        downhill : whether steps are shortened until the residual falls; full steps may climb
        """
        working = self.working
        state, unbalanced = self.unbalanced_forces(displacement, previous, parameter, viscosity)
        residual = best_residual = float(np.abs(unbalanced).max())
        n_stalled = n_climbs = 0

        def work_is_met(displacement: Floats, tolerance: float) -> bool:
            return work is None or abs(work - float(working @ displacement)) < tolerance * abs(work)

        for n_steps in range(_MAX_NEWTON_STEPS + 1):
            if (
                state.balanced(residual)
                and self._blocks_are_balanced(unbalanced)
                and work_is_met(displacement, 1e-9)
            ):
                return NewtonStep(displacement, parameter, state, True, n_steps)
            if n_steps == _MAX_NEWTON_STEPS or not np.isfinite(residual):
                break
            try:
                solver = self.factored(self.tangent(state, parameter, viscosity))
            except SolverError:
                break
            if work is None:
                direction, parameter_change = solver(unbalanced), 0.0
            else:
                solutions = solver(
                    np.stack([unbalanced, self.parameter_derivative(state, parameter)], axis=1)
                )
                work_rate = float(working @ solutions[:, 1])
                if work_rate == 0.0:
                    break
                parameter_change = (
                    work - float(working @ (displacement + solutions[:, 0]))
                ) / work_rate
                direction = solutions[:, 0] + parameter_change * solutions[:, 1]
            if not np.isfinite(direction).all():
                break
            length = (
                1.0
                if abs(parameter_change) <= 0.5 * abs(parameter)
                else 0.5 * abs(parameter) / abs(parameter_change)
            )
            nearest: tuple[float, Floats, float, ContactState, Floats] | None = None
            while True:
                trial, trial_parameter = (
                    displacement + length * direction,
                    parameter + length * parameter_change,
                )
                trial_state, trial_unbalanced = self.unbalanced_forces(
                    trial, previous, trial_parameter, viscosity
                )
                trial_residual = float(np.abs(trial_unbalanced).max())
                if nearest is None or trial_residual < nearest[0]:
                    nearest = trial_residual, trial, trial_parameter, trial_state, trial_unbalanced
                least_residual = residual if work is None else max(residual, 1e-9 * self.load_size)
                if (
                    not downhill
                    or trial_residual < (1.0 - 0.1 * length) * least_residual
                    or length < _SHORTEST_STEP
                ):
                    break
                length *= 0.5
            n_stalled = (
                n_stalled + 1
                if nearest[0] > 0.75 * residual and nearest[0] > 1e-8 * self.load_size
                else 0
            )
            residual, displacement, parameter, state, unbalanced = nearest
            n_climbs = n_climbs + 1 if residual > best_residual else 0
            has_diverged = residual > 1e4 * best_residual or (
                work is not None and n_climbs >= _MAX_CLIMBS
            )
            if n_stalled >= 3 if downhill else has_diverged:
                break
            best_residual = min(best_residual, residual)
        has_settled = (
            state.balanced(residual, ROUGHLY_SETTLED)
            and self._blocks_are_balanced(unbalanced)
            and work_is_met(displacement, 1e-6)
        )
        return NewtonStep(displacement, parameter, state, has_settled, _MAX_NEWTON_STEPS)
