"""Equilibrium at one strength reduction factor: Bᵀ f(B γ) + P = 0, six unknowns a block, by Newton's method.

The law is taken in total displacements: the strength is first more than enough, then brought down to the factor
asked for in steps, so that Newton starts near its answer and pairs fail in the order in which the paper's
increments fail them. Where no step leads on, the blocks do not stand: that is an answer (`stands` is false).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints, frozen
from slopekit.preie.solvers.newton import balanced
from slopekit.preie.system.contact import ContactMode, JointStiffness, Tractions, breaks, reduced_law
from slopekit.preie.system.model import Model
from slopekit.preie.tolerances import EQUILIBRIUM, SHORTEST_STRIDE

_SHORTEST = 1e-4  # part of a step of Newton's method: with 0.05 two wedges of 150 find no rest at full strength
MOST_RELEASES = 30  # rounds of pairs that debond
BOLT_GIVE_M = 1e-3  # a passive bolt carries its full capacity once it is drawn out by this much
_RAMP = (0.03, 0.1, 0.3, 0.6, 1.0)  # parts of the load, where all of it at once is too much for Newton


@dataclass(frozen=True)
class Equilibrium:
    """The state of a model at one strength reduction factor.

    Attributes
    ----------
    stands : whether forces and moments balance
    factor : the strength reduction factor; where they do not stand that at which they are lost on the way to it
    displacement : (u,) m and radians, of the block's centroid
    forces : (n, 3) kN at the node pairs; modes : (n,) ContactMode
    residual : largest unbalanced generalised force in parts of the load
    """

    stands: bool
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
    model: Model, factor: float, stiffness: JointStiffness, start: Equilibrium | None = None,
    until_all_failed: bool = False,
) -> Equilibrium:  # fmt: skip
    """Bring the strength down to 1/factor of itself and find where the blocks come to rest.

    Parameters
    ----------
    factor : strength reduction factor F > 0
    start : an equilibrium at a smaller factor to go on from
    until_all_failed : stop at the first state on the way in which no pair sticks
    """
    if start is None or not start.stands or start.factor > factor:
        none: Bools = np.zeros(len(model.control_area), dtype=bool)
        here = min(1e-3, factor * 1e-3)
        # first guess: springs in all directions, the normal ones' stiffness
        spring = (
            np.repeat(model.control_area * model.area_scale, 3)[:, None]
            * model.flat_rows
            * (stiffness.normal / model.force_scale)
        )
        bonded = model.flat_rows.T @ spring
        try:
            guess = np.asarray(np.linalg.solve(bonded, model.load), dtype=np.float64)
        except np.linalg.LinAlgError:  # a sheet thinner than any joint has no stiffness against turning
            guess = np.asarray(np.linalg.lstsq(bonded, model.load, rcond=None)[0], dtype=np.float64)
        state = _settle(model, here, stiffness, guess, none)
        if not state.stands:
            for part in _RAMP:
                lighter = replace(model, load=frozen(model.load * part))
                state = _settle(lighter, here, stiffness, guess * part if part == _RAMP[0] else guess, none)
                guess = state.scaled
        if not state.stands:
            return state
    else:
        state = start
    stride = math.log(factor / state.factor) if state.factor < factor else 0.0
    remaining = stride
    while remaining > 0.0:
        target = factor if stride >= remaining else state.factor * math.exp(stride)
        trial = _settle(model, target, stiffness, state.scaled, state.debonded)
        if trial.stands:
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


def _settle(model: Model, factor: float, stiffness: JointStiffness, start: Floats, debonded: Bools) -> Equilibrium:
    """Newton until the forces balance, again while pairs debond (Table 2); a bond once broken stays so."""
    scaled, area = start, model.control_area * model.area_scale
    rounding = EQUILIBRIUM * model.force_scale / model.area_scale
    for _ in range(MOST_RELEASES):
        scaled, law, residual = _newton(model, factor, stiffness, scaled, debonded)
        broken: Bools = ~debonded & breaks(law, model.tension * model.force_scale / area, factor, rounding)
        if residual > EQUILIBRIUM or not broken.any():
            break
        debonded = debonded | broken
    forces = law.tractions * area[:, None]
    to_metres = np.where(np.arange(model.unknowns) < model.translations, model.length_scale, 1.0)
    return Equilibrium(
        residual <= EQUILIBRIUM, factor, scaled * to_metres, forces, law.modes, residual, scaled, debonded
    )


def _newton(
    model: Model, factor: float, stiffness: JointStiffness, scaled: Floats, debonded: Bools
) -> tuple[Floats, Tractions, float]:
    bolts = model.bolt_capacity / factor
    stretch = model.bolt_capacity * (model.length_scale / BOLT_GIVE_M)
    weight, rows = model.control_area * (model.area_scale / model.force_scale), model.flat_rows
    tractions = reduced_law(
        stiffness, model.cohesion / weight, model.tan_friction, model.tan_dilation, factor, debonded
    )  # fmt: skip

    def unbalanced(at: Floats) -> tuple[Floats, Tractions]:
        law = tractions((rows @ at).reshape(-1, 3) * model.length_scale)
        out = (law.tractions * weight[:, None]).ravel() @ rows + model.load
        if len(bolts):
            out = out + np.minimum(np.maximum(-stretch * (model.bolt_rows @ at), 0.0), bolts) @ model.bolt_rows
        return out, law

    def slopes(at: Floats, law: Tractions) -> Floats:
        own = law.slopes * (weight * model.length_scale)[:, None, None]
        matrix: Floats = rows.T @ np.matmul(own, model.rows).reshape(-1, model.unknowns)
        if len(bolts):
            pull = -stretch * (model.bolt_rows @ at)
            springs = np.where((pull > 0.0) & (pull < bolts), stretch, 0.0)
            matrix = matrix - (model.bolt_rows.T * springs) @ model.bolt_rows
        return matrix

    return balanced(unbalanced, slopes, scaled, EQUILIBRIUM * 1e-3, _SHORTEST)
