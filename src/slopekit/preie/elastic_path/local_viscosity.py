"""Many blocks brought to rest at one strength, from any displacement.

A step is one of Newton's with viscosity in its stiffness alone (pseudo-transient continuation: Kelley & Keyes 1998,
SIAM J. Numer. Anal. 35, 508). Every block has a viscosity of its own (local time steps): as much as it is out of
balance, more where that grows, less where it does not, so that the slivers of one place do not hold up all the others.

A step is cut short where more gets out of balance. What holds up all others is settled by itself on the way: single
blocks, those with their neighbours, and places with two rings around them (nonlinear elimination: Cai & Keyes 2002).
The few blocks that are out of balance in the end are settled with all others held (`elastic_path.flow`).
"""

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import SolverError
from slopekit.core.records import dataclass
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import BedForces
from slopekit.preie.elastic_path.flow import ENOUGH, THICKEST, THIN, Flow, relaxed
from slopekit.preie.system.assembly import AssemblyModel

_STEPS = 250  # to a rest
_LESS_OUT, _HOPE, _HOPE_ALONE = 0.8, 40, 20  # of what is out of balance; steps in which it has to fall to that
_LENGTHS, _MORE = (1.0, 0.5, 0.25, 0.1), 1.1  # parts of a step, and how much more may be out of balance after it
_CALM = 0.01  # part of the blocks out of balance from which on those are settled by themselves
_FAR_OUT, _NEARLY = 1e4, 1e2  # what is out of balance of a block that is settled by itself on the way, before and after
_SPOTS, _SPOTS_ALONE = 0.05, 0.2  # part of the blocks that these may be, and of those that are calmed by themselves
_PLACES = 0.02  # part of the blocks out of balance from which on those are
_EVERY, _RINGS = 5, 2  # steps after which the places that are out of balance are, and how far around them
_FEW = 0.05  # part of the blocks out of balance from which on they are settled by themselves
_VISCOUS = 0.1  # viscosity by what is out of balance
_GREW, _UP, _DOWN = 1.15, 2.0, 0.5  # what is out of balance grows by more: viscosity times these
_OUT = 3.0  # of a block's load: more out of balance counts as that
_ROUNDS, _ALONE, _PATIENCE = 9, 25, 150  # of settling blocks by themselves; steps, factorisations for it


def rest_from(bed: Bed, at: Floats, parameter: float) -> Flow | None:
    """All blocks at rest at one strength, from a displacement (N,), as that of rest at another; None where they are not

    A step is cut short where much more is out of balance after it. The few blocks that are far out of balance are
    settled by themselves between the steps.
    """
    here = _calmed(bed, _State.at(bed, at, parameter), parameter)
    return _settled(bed, here.displacement, parameter) if (here.out > 1.0).mean() <= _FEW else None


def _calmed(bed: Bed, here: "_State", parameter: float, alone: bool = False) -> "_State":
    """From a state to one with few blocks out of balance, or where no step leads on.

    Parameters
    ----------
    alone : all others are held: until none is out of balance, with larger parts of the blocks far out of it
    """
    spots, few = (_SPOTS_ALONE, 0.0) if alone else (_SPOTS, _CALM * len(here.out))
    control, least, last = _ViscosityControl(bed), here.total, 0
    for turn in range(1, _STEPS + 1):
        if np.count_nonzero(here.out > 1.0) <= (few if control.steady else 0.0):
            break
        way = control.way(bed, here.there, parameter)
        if way is None:
            break
        enough, best = _MORE * here.total, None
        for part in _LENGTHS:
            trial = _State.at(bed, here.displacement + part * way, parameter)
            if trial.total > enough:
                trial = _spots_settled(bed, trial, parameter, spots)
            best = trial if best is None or trial.total < best.total else best
            if best.total <= enough:
                break
        assert best is not None
        here = _spots_settled(bed, best, parameter, spots)
        if turn % _EVERY == 0 and not alone:
            here = _parts_calmed(bed, here, parameter)
        least, last = (here.total, turn) if here.total < _LESS_OUT * least else (least, last)
        if turn - last > (_HOPE_ALONE if alone else _HOPE):
            break
    return here


def _parts_calmed(bed: Bed, here: "_State", parameter: float) -> "_State":
    """With the places out of balance calmed one by one, with blocks around them, where that is better for all."""
    off, u = here.out > _NEARLY, bed.model.unknowns
    if not 0.0 < off.mean() < _PLACES:
        return here
    for _ in range(_RINGS):
        off = bed.model.touching(off)
    at = here.displacement.copy()
    for blocks in _clusters(bed.model, off):
        those = (blocks[:, None] * u + np.arange(u)).ravel()
        few = bed.among(blocks, here.displacement)
        calm = _calmed(few, _State.at(few, at[those], parameter), parameter, alone=True)
        if calm.out.max() < _NEARLY:
            at[those] = calm.displacement
    trial = _State.at(bed, at, parameter)
    return trial if trial.total < here.total else here


@dataclass(frozen=True, slots=True)
class _State:
    """A displacement (N,), the forces there, and what is out of balance (n,)."""

    displacement: Floats
    there: BedForces
    out: Floats

    @classmethod
    def at(cls, bed: Bed, at: Floats, parameter: float) -> "_State":
        """With the forces at a displacement (N,)."""
        there = bed.forces(at, parameter)
        return cls(at, there, _out(bed, there))

    @property
    def total(self) -> float:
        """What is out of balance of all blocks together."""
        return float(_share(self.out).sum())

    def off(self, label: Ints) -> Floats:
        """What is out of balance of the blocks of each label, (c,), the labels (n,)."""
        sums: Floats = np.bincount(label, _share(self.out)).astype(np.float64, copy=False)
        return sums


def _cut_short(bed: Bed, here: _State, way: Floats, parameter: float, label: Ints) -> _State:
    """A step (N,) on, for the blocks of each label (n,) so much of it that not much more is out of balance.

    Where no part of it does, the best that was seen. Blocks of different labels do not touch.
    """
    before, u = here.off(label), bed.model.unknowns
    best, least, taken = np.ones(len(before)), np.full(len(before), np.inf), np.zeros(0)
    for part in _LENGTHS:
        length = np.where(least > _MORE * before, part, best)
        trial, taken = _State.at(bed, here.displacement + np.repeat(length[label], u) * way, parameter), length
        off = trial.off(label)
        best, least = np.where(off < least, length, best), np.minimum(off, least)
        if not (least > _MORE * before).any():
            break
    if (best != taken).any():
        trial = _State.at(bed, here.displacement + np.repeat(best[label], u) * way, parameter)
    return trial


def _spots_settled(bed: Bed, here: _State, parameter: float, spots: float) -> _State:
    """With blocks far out of balance settled by themselves, then with their neighbours, where that is better for all.

    All such spots at once, each with steps of its own length; `spots` is the part of the blocks that they may be.
    """
    u = bed.model.unknowns
    for with_neighbours in (False, True):
        far = here.out > _FAR_OUT
        if not 0.0 < far.mean() < spots:
            break
        if with_neighbours:
            far = bed.model.touching(far)
        blocks, label = np.flatnonzero(far), _labels(bed.model, far)
        those = (blocks[:, None] * u + np.arange(u)).ravel()
        few = bed.among(blocks, here.displacement)
        control, alone = _ViscosityControl(few), _State.at(few, here.displacement[those], parameter)
        for _ in range(_ALONE):
            settled = np.bincount(label, alone.out > _NEARLY) == 0
            way = None if settled.all() else control.way(few, alone.there, parameter)
            if way is None:
                break
            alone = _cut_short(few, alone, way, parameter, label)
        settled = np.bincount(label, alone.out > _NEARLY) == 0
        if settled.any():
            good, at = np.repeat(settled[label], u), here.displacement.copy()
            at[those[good]] = alone.displacement[good]
            trial = _State.at(bed, at, parameter)
            if trial.total < here.total:
                here = trial
    return here


def _out(bed: Bed, there: BedForces) -> Floats:
    """What is out of balance, (n,), in parts of what may be."""
    worst: Floats = np.abs(there.unbalanced / bed.unbalanced_at_most).reshape(-1, bed.model.unknowns).max(axis=1)
    return worst


def _share(out: Floats, most: float = _OUT) -> Floats:
    """Unbalanced force of each block (n,) in parts of its load."""
    part: Floats = np.minimum(1e-6 * out, most)
    return part


class _ViscosityControl:
    """Newton steps with a viscosity (n,) of each block in the stiffness, which goes with what is out of balance."""

    def __init__(self, bed: Bed) -> None:
        model = bed.model
        self.plus, self.minus = model.plus, np.where(model.minus < 0, model.plus, model.minus)
        self.viscosity: Floats | None = None
        self.before, self.count, self.least = np.zeros(0), np.inf, 0

    @property
    def steady(self) -> bool:
        """Whether fewer blocks are out of balance no more from step to step."""
        return self.least >= 2

    def way(self, bed: Bed, there: BedForces, parameter: float) -> Floats | None:
        """A step on (N,)."""
        out = _out(bed, there)
        share, count = _share(out), float((out > 1.0).sum())
        self.least = self.least + 1 if count >= 0.9 * self.count else 0
        self.count = min(count, self.count)
        wanted = np.clip(_VISCOUS * share, THIN, THICKEST)
        if self.viscosity is None:
            self.viscosity = wanted
        else:
            more = np.maximum(np.minimum(_UP * self.viscosity, THICKEST), 0.3 * wanted)
            self.viscosity = np.where(share > _GREW * self.before, more, _DOWN * self.viscosity)
            self.viscosity = np.clip(self.viscosity, THIN, 3.0 * wanted)
        self.before = share
        around = self.viscosity.copy()
        for one, other in ((self.plus, self.minus), (self.minus, self.plus)):
            np.maximum.at(around, one, self.viscosity[other])
        of_contact = np.maximum(around[self.plus], around[self.minus])[:, None, None]
        try:
            way = bed.factored(bed.tangent(there, parameter) + of_contact * bed.elastic)(there.unbalanced)
        except SolverError:
            return None
        return way if np.isfinite(way).all() else None


def _settled(bed: Bed, at: Floats, parameter: float) -> Flow | None:
    """All blocks at rest, those out of balance settled by themselves: alone, with neighbours, with theirs."""
    size = bed.model.unknowns
    for turn in range(_ROUNDS):
        there = bed.forces(at, parameter)
        out = _out(bed, there) > ENOUGH
        if not out.any():
            return Flow(at, there, "rest", at, 0.0)
        for _ in range(turn % 3):
            out = bed.model.touching(out)
        trial = at.copy()
        for blocks in _clusters(bed.model, out):
            those = (blocks[:, None] * size + np.arange(size)).ravel()
            few = bed.among(blocks, at)
            calm = _calmed(few, _State.at(few, at[those], parameter), parameter, alone=True)
            if calm.out.max() < 1.0:
                trial[those] = calm.displacement
                continue
            flow = relaxed(few, at[those], parameter, 0.0, runs_at=1e6, patience=_PATIENCE)
            if flow.ended == "rest":
                trial[those] = flow.at
        step = bed.newton(trial, trial, parameter, 0.0, None, downhill=True)
        if step.settled:
            return Flow(step.at, step.forces, "rest", step.at, 0.0)
        left = [int((_out(bed, forces) > ENOUGH).sum()) for forces in (step.forces, bed.forces(trial, parameter))]
        at = step.at if left[0] <= left[1] else trial
    return None


def _clusters(model: AssemblyModel, among: Bools) -> list[Ints]:
    """Blocks among some that touch each other, together."""
    blocks, label = np.flatnonzero(among), _labels(model, among)
    order = np.argsort(label, kind="stable")
    return np.split(blocks[order], np.flatnonzero(np.diff(label[order])) + 1)


def _labels(model: AssemblyModel, among: Bools) -> Ints:
    """Of each of some blocks (n,) the number of those among them that touch each other, (b,)."""
    both = among[model.plus] & (model.minus >= 0) & among[model.minus]
    count = len(among)
    graph = sparse.coo_matrix((np.ones(int(both.sum())), (model.plus[both], model.minus[both])), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    numbers: Ints = np.unique(label[among], return_inverse=True)[1]
    return numbers
