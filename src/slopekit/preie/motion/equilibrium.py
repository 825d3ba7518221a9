"""Equilibrium at one strength reduction factor: Bᵀ f(B γ) + P = 0, six unknowns a block, by Newton's method.

The law is taken in total displacements: the strength is first ample, then reduced to the factor in steps, so that
Newton's method starts near its solution and pairs fail in the order of the paper's increments. Where no step
converges the blocks have no equilibrium: that is an answer (`is_balanced` is false).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.preie.solvers.newton import newton_equilibrium
from slopekit.preie.system.contact import (
    ContactMode,
    JointStiffness,
    Tractions,
    breaks,
    reduced_law,
)
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import EQUILIBRIUM, SHORTEST_STRIDE

_SHORTEST = 1e-4  # least part of a Newton step: with 0.05 two wedges of 150 do not converge at full strength
MOST_RELEASES = 30  # rounds in which pairs debond
BOLT_GIVE_M = 1e-3  # a passive bolt carries its full capacity once it is drawn out by this much
_RAMP = (
    0.03,
    0.1,
    0.3,
    0.6,
    1.0,
)  # parts of the load, where Newton's method does not converge under all of it at once


@dataclass(frozen=True)
class Equilibrium:
    """The state of a model at one strength reduction factor.

    Attributes
    ----------
    is_balanced : whether forces and moments balance
    factor : the strength reduction factor; without equilibrium the one at which it was lost on the path
    displacement : (u,) m and radians, of the block's centroid
    forces : (n, 3) kN at the node pairs; modes : (n,) ContactMode
    residual : largest unbalanced generalised force in parts of the load
    """

    is_balanced: bool
    factor: float
    displacement: Floats
    forces: Floats
    modes: Ints
    residual: float
    scaled: Floats
    debonded: Bools

    @property
    def failed_pairs(self) -> int:
        """Number of pairs that slip or have debonded."""
        return int((self.modes != ContactMode.STICK).sum())


def equilibrium(
    model: Model,
    factor: float,
    stiffness: JointStiffness,
    start: Equilibrium | None = None,
    until_all_failed: bool = False,
) -> Equilibrium:
    """Reduce the strength to 1/factor of itself and return the equilibrium of the block.

    Parameters
    ----------
    factor : strength reduction factor F > 0
    start : an equilibrium at a smaller factor, at which the path continues
    until_all_failed : stop at the first state on the path in which no pair sticks
    """
    if start is None or not start.is_balanced or start.factor > factor:
        none: Bools = np.zeros(len(model.control_area), dtype=bool)
        start_factor = min(1e-3, factor * 1e-3)
        # first guess: springs in all directions with the normal stiffness
        spring = (
            np.repeat(model.control_area * model.area_scale, 3)[:, None]
            * model.flat_rows
            * (stiffness.normal / model.force_scale)
        )
        bonded = model.flat_rows.T @ spring
        try:
            guess = np.asarray(np.linalg.solve(bonded, model.load), dtype=np.float64)
        except (
            np.linalg.LinAlgError
        ):  # a sheet thinner than any joint has no stiffness against turning
            guess = np.asarray(np.linalg.lstsq(bonded, model.load, rcond=None)[0], dtype=np.float64)
        state = _settle(model, start_factor, stiffness, guess, none)
        if not state.is_balanced:
            for load_fraction in _RAMP:
                lighter = replace(model, load=frozen(model.load * load_fraction))
                state = _settle(
                    lighter,
                    start_factor,
                    stiffness,
                    guess * load_fraction if load_fraction == _RAMP[0] else guess,
                    none,
                )
                guess = state.scaled
        if not state.is_balanced:
            return state
    else:
        state = start
    stride = math.log(factor / state.factor) if state.factor < factor else 0.0
    remaining = stride
    while remaining > 0.0:
        target = factor if stride >= remaining else state.factor * math.exp(stride)
        trial = _settle(model, target, stiffness, state.scaled, state.debonded)
        if trial.is_balanced:
            state = trial
            if until_all_failed and state.failed_pairs == len(state.modes):
                break
            remaining = math.log(factor / state.factor) if target != factor else 0.0
            stride *= 2.0
        else:
            stride = min(stride, remaining) / 3.0
            if stride < SHORTEST_STRIDE:
                return trial
    return state if remaining > 0.0 else replace(state, factor=factor)


def _settle(
    model: Model, factor: float, stiffness: JointStiffness, start: Floats, debonded: Bools
) -> Equilibrium:
    """Solve for equilibrium at one factor, and again while pairs debond (Table 2); broken bonds stay broken."""
    scaled, area = start, model.control_area * model.area_scale
    rounding = EQUILIBRIUM * model.force_scale / model.area_scale
    for _ in range(MOST_RELEASES):
        scaled, law, residual = _newton(model, factor, stiffness, scaled, debonded)
        broken: Bools = ~debonded & breaks(
            law, model.tension * model.force_scale / area, factor, rounding
        )
        if residual > EQUILIBRIUM or not broken.any():
            break
        debonded = debonded | broken
    forces = law.tractions * area[:, None]
    to_metres = np.where(np.arange(model.unknowns) < model.translations, model.length_scale, 1.0)
    return Equilibrium(
        residual <= EQUILIBRIUM,
        factor,
        scaled * to_metres,
        forces,
        law.modes,
        residual,
        scaled,
        debonded,
    )


def _newton(
    model: Model, factor: float, stiffness: JointStiffness, scaled: Floats, debonded: Bools
) -> tuple[Floats, Tractions, float]:
    bolts = model.bolt_capacity / factor
    stretch = model.bolt_capacity * (model.length_scale / BOLT_GIVE_M)
    weight, rows = model.control_area * (model.area_scale / model.force_scale), model.flat_rows
    tractions = reduced_law(
        stiffness, model.cohesion / weight, model.tan_friction, model.tan_dilation, factor, debonded
    )

    def unbalanced(displacement: Floats) -> tuple[Floats, Tractions]:
        law = tractions((rows @ displacement).reshape(-1, 3) * model.length_scale)
        residual = (law.tractions * weight[:, None]).ravel() @ rows + model.load
        if len(bolts):
            residual = (
                residual
                + np.minimum(np.maximum(-stretch * (model.bolt_rows @ displacement), 0.0), bolts)
                @ model.bolt_rows
            )
        return residual, law

    def slopes(displacement: Floats, law: Tractions) -> Floats:
        pair_slopes = law.slopes * (weight * model.length_scale)[:, None, None]
        matrix: Floats = rows.T @ np.matmul(pair_slopes, model.rows).reshape(-1, model.unknowns)
        if len(bolts):
            pull = -stretch * (model.bolt_rows @ displacement)
            springs = np.where((pull > 0.0) & (pull < bolts), stretch, 0.0)
            matrix = matrix - (model.bolt_rows.T * springs) @ model.bolt_rows
        return matrix

    return newton_equilibrium(unbalanced, slopes, scaled, EQUILIBRIUM * 1e-3, _SHORTEST)
