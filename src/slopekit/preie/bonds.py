"""Which contacts of many blocks have lost their cohesion where they fail: rounds of limits, and of their motions.

A contact that is open all over as blocks rest on their elastic joints has lost its cohesion before any motion begins,
though the mechanism may well leave it as it is. Falling strength is followed to see which (`preie.falling`), with what
motions have opened gone from its start; where that takes too long contacts are asked at the limit alone. No limit lies
beyond the history in which no motion has opened anything, if it counts on a bond that is broken there.
A flat contact that a motion opens anywhere touches along a line at most: all its cohesion goes, and the limit is looked
for again. A motion begins at its own factor and breaks nothing before. So where a lesser motion, at a lower factor,
slides on a closed contact whose cohesion an earlier one has opened, settled or not, it is not there: strength that
falls slowly comes to that factor with the contact whole. Such a bond is kept. Where the motion that it holds opens it
again the bond breaks as that motion begins: the limit is that motion's, less what the cohesion that it opens does
of its work,

    λ' (P·v - λ Σ_kept c |s|) = λ P·v        (of a load α R:  α' R·v = α R·v - λ Σ_kept c |s|)

or, if that is less, the factor up to which blocks at rest on their elastic joints press that contact anywhere: one
that is open all over has lost its bond, and the lesser motion begins. Other bonds that the last motion, once it has
settled, leaves closed come back once. Where motions do not settle a second one breaks nothing more if what it opens
does little of its work, which is taken off as well. Every bond breaks twice at most and is kept once: the rounds end.
"""

import math
from collections.abc import Callable
from copy import copy
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.records import dataclass
from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.falling import NEAR_RUNNING, Fallen
from slopekit.preie.path_limit import PathLimit, PathOutcome
from slopekit.preie.tolerances import FLOWS, LIMIT_BALANCED, NO_MOTION, OPENS_ROUGHLY, SAME_FACTOR, TINY

_MOST_ROUNDS = 60  # of cohesion lost; every one breaks a contact, keeps it or gives it back
_LITTLE = 0.02  # of the work of a motion that does not settle: what cohesion that opens does of it is taken off
_HALVINGS = 7  # between the factors at which a bond that is kept breaks and does not
_TOUCHES = 1e-6  # of the deepest that a pair is pressed in: pairs that are no farther apart touch
_JUST = 0.98  # of the way to a limit: there contacts that its motion opens are open all over if they are before it

Search = Callable[[Floats, bool], tuple[PathLimit, bool]]
"""The limit with bonds (m,), whether all blocks have to vouch for it, and whether they do."""

Pressed = Callable[[Floats, float], Bools | None]
"""Contacts (k,) that are pressed anywhere at rest with bonds (m,) at a parameter; None where there is no rest."""


Falls = Callable[[Bools], Fallen | None]
"""The history of falling strength without the bonds of some contacts (k,); None where it is not followed."""


@dataclass(frozen=True, slots=True)
class Bonded:
    """A limit and the bonds there.

    Attributes
    ----------
    limit : its parameter is that without cohesion where its motion opens
    bond : (m,) 0 where a pair has lost its cohesion
    whole : the parameter of the first round, with all bonds or, where falling strength breaks some before, `entire` is
        false
    least : of the rounds, the parameter at which blocks would move without the bonds that are kept; None where none is
    kept : contacts whose bond the motion opens and that keep it
    share : part of the motion's work that their cohesion did, and that of what it opens without having settled
    unsettled : the parameter of the first motion that broke bonds and had not settled, None where all had
    soonest : of all rounds, whatever bonds they had, the parameter at which a motion would begin first
    counted : contacts that are open before the motion and whose cohesion counts, as it is the peak of a group
    fell : the parameter at which blocks run whose strength falls step by step, with these bonds
    rounds : what the rounds have come to: others between the same contacts, of other node pairs, can begin with it
    """

    limit: PathLimit
    bond: Floats
    whole: float | None
    least: float | None = None
    kept: int = 0
    share: float = 0.0
    unsettled: float | None = None
    soonest: float | None = None
    rounds: "Rounds | None" = None
    counted: int = 0
    fell: float | None = None
    entire: bool = True


class Rounds:
    """What contacts (k,) have lost, and the rounds that say so."""

    def __init__(self, model: AssemblyModel, working: Floats, load_grows: bool, falls: Falls | None = None) -> None:
        self.model, self.working, self.load_grows, contacts = model, working, load_grows, len(model.plus)
        self.falls = falls
        self.inherits = False  # whether it goes on from rounds between other node pairs
        self.fallen: Fallen | None = None  # the history without what motions opened
        self.bonded = np.bincount(model.pair_contact, model.cohesion, contacts) > 0.0
        self.lost, self.kept = np.zeros(contacts, dtype=bool), np.zeros(contacts, dtype=bool)
        self.times = np.zeros(contacts, dtype=np.int64)
        self.gone = np.zeros(contacts, dtype=bool)  # for good, before a motion begins
        self.pulls = np.zeros(contacts, dtype=bool)  # and open at a limit whose forces need them
        self.late = np.zeros(contacts, dtype=bool)  # opened by a motion that does not settle once more
        self.broke = np.zeros(contacts)  # the parameter of the motion that opened it
        self.whole: float | None = None
        self.entire = True
        self.least: float | None = None
        self.unsettled: float | None = None
        self.soonest: float | None = None
        self.first: tuple[PathLimit, Bools, Bools] | None = None  # settled and broke bonds; lost before; what it breaks
        self.counted = 0  # contacts that are open before the motion of the last round, and are not asked
        self.stood: Bools | None = None  # what was lost where all blocks stood up to `least`

    def on(self, model: AssemblyModel, falls: Falls | None) -> "Rounds":
        """The same between other node pairs of the same contacts; without histories there those of these stand."""
        other = copy(self)
        other.model, other.broke, other.first = model, self.broke.copy(), None
        other.inherits, other.falls, other.times = True, falls, self.times.copy()
        return other

    @property
    def bond(self) -> Floats:
        """(m,) 0 where a pair has lost its cohesion."""
        left: Floats = np.where(self.lost[self.model.pair_contact], 0.0, 1.0)
        return left

    def fall(self) -> None:
        """Bonds that falling strength breaks with those gone that motions opened: from the start, at every round."""
        if self.falls is None or not self.bonded.any():
            return
        opened = self.lost & ~self.gone
        self.fallen = self.falls(opened)
        if self.fallen is None:
            self.falls = None
            return
        self.gone = (self.fallen.gone | self.pulls) & ~opened
        self.lost, self.kept = opened | self.gone, self.kept & ~self.gone

    def open_before(self, path_end: PathLimit, all_rest: bool) -> bool:
        """Whether bonds are gone before the motion of a round begins: its contacts do not touch, whatever it does.

        Not asked of the peak of a group of blocks, which would be another one after rounds of many groups: `counted`.
        Where falling strength was followed that says it: the limit is asked only if its forces need a pair that pulls.
        """
        assert path_end.parameter is not None
        if self.whole is None:
            self.whole, self.entire = path_end.parameter, not self.lost.any()
        sooner = min if self.load_grows else max
        self.soonest = sooner(path_end.parameter, path_end.parameter if self.soonest is None else self.soonest)
        bonded = self.bonded & ~self.lost
        self.counted = 0
        if not all_rest or not bonded.any():
            return False
        if self.fallen is not None and float(np.abs(self._off(path_end)).max()) < LIMIT_BALANCED:
            return False
        apart, _ = self.model.opening_and_slip(path_end.displacement)
        touches = (path_end.normal > 0.0) | (apart <= _TOUCHES * abs(float(apart.min())))
        opens, _ = _moves(self.model, path_end)
        gone = bonded & ~opens & (np.bincount(self.model.pair_contact, touches, len(opens)) == 0)
        if path_end.group and not path_end.found:
            self.counted = int(gone.sum())
            return False
        if not gone.any():
            return False
        self.lost, self.gone, self.kept = self.lost | gone, self.gone | gone, self.kept & ~gone
        self.pulls = self.pulls | gone
        left = np.where(gone[self.model.group_contact][:, None], 0.0, path_end.friction)
        held = self.model.unbalanced(path_end.normal, path_end.friction) - self.model.unbalanced(path_end.normal, left)
        return float(np.abs(held).max()) > LIMIT_BALANCED  # else the limit is the same without them

    def _off(self, path_end: PathLimit) -> Floats:
        """What is out of balance once no pair pulls, in parts of the load of the block it acts on."""
        return self.model.unbalanced(np.maximum(path_end.normal, 0.0), path_end.friction)

    def after(self, path_end: PathLimit, all_rest: bool) -> bool:
        """Whether bonds break, are kept or come back after a round."""
        opens, slips = _moves(self.model, path_end)
        self.late = np.zeros_like(self.lost)
        breaks = opens & self.bonded & ~self.lost & ~self.kept
        if breaks.any() and self.unsettled is not None and not path_end.found:
            share = self._work(path_end, breaks) / float(self.working @ path_end.motion)
            work = path_end.parameter or 0.0 if self.load_grows else 1.0  # `share` is in the parameter's unit there
            if abs(share) < _LITTLE * work:  # another round like the last would say no more
                self.late = breaks
                return False
        if breaks.any():
            if self.first is None and all_rest and path_end.found:
                self.first = path_end, self.lost, breaks
            self.lost, self.times = self.lost | breaks, self.times + breaks
            self.broke[breaks] = path_end.parameter
            if not path_end.found and self.unsettled is None:
                self.unsettled = path_end.parameter
            return True
        closed = self.lost & ~opens & ~self.gone
        change = 1.0 - self.broke / (path_end.parameter or math.inf)
        slid_on = closed & slips & ((-change if self.load_grows else change) > SAME_FACTOR)
        if slid_on.any():
            self.least = self._less(path_end, opens & self.kept)
            self.stood = self.lost if all_rest else None
            self.lost, self.kept = self.lost & ~slid_on, self.kept | slid_on
            return True
        back = closed & (self.times < 2) & path_end.found  # what has not settled gives nothing back
        self.lost = self.lost & ~back
        return bool(back.any())

    def refused(self, path_end: PathLimit, pressed: Pressed) -> bool:
        """Whether bonds that are kept are gone as the lesser motion begins: their contacts are open all over there."""
        opens, _ = _moves(self.model, path_end)
        opens &= self.kept
        if not opens.any() or self.least is None or self.fallen is not None:
            return False
        somewhere = pressed(self.bond, self.least)
        gone = opens if somewhere is None else opens & ~somewhere
        self.kept, self.lost, self.gone = self.kept & ~gone, self.lost | gone, self.gone | gone
        return bool(gone.any())

    def begun_sooner(self, last: Bonded, pressed: Pressed) -> "Rounds | Bonded | None":
        """Where the first motion begins before the last: its limit, or the rounds with what is open even before it.

        Strength that falls slowly comes to it with all bonds of contacts that still touch. The work of those that it
        opens is left out. None where the last motion begins first, or nobody knows.
        """
        if self.first is None or last.limit.parameter is None:
            return None
        first, lost, opens = self.first
        assert first.parameter is not None
        before = (last.limit.parameter - first.parameter) * (1.0 if self.load_grows else -1.0)
        if before <= SAME_FACTOR * first.parameter:
            return None
        if self.fallen is not None:
            return self._first_motion(first, lost, opens)
        just = first.parameter * _JUST if self.load_grows else first.parameter / _JUST
        somewhere = pressed(np.where(lost[self.model.pair_contact], 0.0, 1.0), just)
        if somewhere is None:
            return None
        other = Rounds(self.model, self.working, self.load_grows)
        other.whole, other.entire = self.whole, self.entire
        other.soonest, other.unsettled = self.soonest, self.unsettled
        if (opens & ~somewhere).any():
            other.lost = lost | (opens & ~somewhere)
            other.gone = other.lost.copy()
            return other
        return self._first_motion(first, lost, opens)

    def _first_motion(self, first: PathLimit, lost: Bools, opens: Bools) -> Bonded:
        """A first motion, less the work of the cohesion that it opens."""
        assert first.parameter is not None
        less = self._less(first, opens)
        share = 1.0 - (less / first.parameter if self.load_grows else first.parameter / less)
        other = copy(self)
        other.lost, other.gone, other.kept, other.least, other.first = lost, lost, opens, None, None
        other.fall()
        limit = replace(first, parameter=less)
        return Bonded(limit, other.bond, self.whole, None, int(opens.sum()), share, self.unsettled, self.soonest, other)

    def no_farther(self, last: Bonded, once: Search) -> Bonded:
        """A limit no farther than falling strength comes: where blocks run before it without bonds that it counts.

        It is then the limit without those, if it lies where they run; else it is their last rest.
        """
        fallen, limit = self._begun(), last.limit
        if fallen is None or fallen.runs is None or limit.parameter is None:
            return last
        if self._past(limit.parameter, fallen.runs) < NEAR_RUNNING or not (fallen.broken & ~self.lost).any():
            return replace(last, fell=fallen.runs)
        without = copy(self)
        without.lost, without.kept = self.lost | fallen.broken, np.zeros_like(self.kept)
        path_end, all_rest = once(without.bond, True)
        if path_end.found and all_rest and path_end.parameter is not None:
            without.kept = without.bonded & ~without.lost & _moves(self.model, path_end)[0]
            if abs(self._past(path_end.parameter, fallen.runs)) < NEAR_RUNNING:
                return without.ended(path_end, lambda *_: None)
        moved = fallen.flow.at - fallen.flow.before
        forces = fallen.rest.forces
        limit = replace(
            limit, outcome=PathOutcome.BRACKET, parameter=fallen.parameter, peak=(fallen.parameter, fallen.runs),
            displacement=fallen.rest.at, motion=moved / max(float(np.abs(moved).max(initial=0.0)), TINY),
            normal=forces.normal, friction=forces.friction, group=0, width=0.0, reached=None,
            reduction=limit.reduction if self.load_grows else fallen.parameter,
        )  # fmt: skip
        return replace(last, limit=limit, bond=without.bond, least=None, kept=0, share=0.0)

    def _begun(self) -> Fallen | None:
        """The history in which no motion has opened anything."""
        return None if self.falls is None or self.fallen is None else self.falls(np.zeros_like(self.lost))

    def touching_again(self, last: Bonded, once: Search) -> Bonded:
        """A limit with the bonds that falling strength broke and the limit presses, if it is that of the history."""
        fallen, limit = self._begun(), last.limit
        if fallen is None or fallen.runs is None or limit.parameter is None or not limit.found:
            return last
        pressed = np.bincount(self.model.pair_contact, limit.normal > 0.0, len(self.lost)) > 0
        again = self.gone & pressed & ~_moves(self.model, limit)[0]
        if not again.any():
            return last
        other = copy(self)
        other.lost, other.gone = self.lost & ~again, self.gone & ~again
        path_end, all_rest = once(other.bond, True)
        if not (path_end.found and all_rest and path_end.parameter is not None):
            return last
        near = self._past(path_end.parameter, fallen.runs) < NEAR_RUNNING
        opens = _moves(self.model, path_end)[0] & ~other.lost & ~other.kept & self.bonded
        if not near or opens.any() or self._past(path_end.parameter, limit.parameter) < 0.0:
            return last
        return other.ended(path_end, lambda *_: None)

    def _past(self, parameter: float, runs: float) -> float:
        """How far a parameter lies beyond another, in parts of it."""
        return (parameter / runs - 1.0) if self.load_grows else (runs / parameter - 1.0)

    def beyond(self) -> Floats | None:
        """Bonds (m,) that are left once blocks run whose strength falls; None where those are all that are counted."""
        fallen = self._begun()
        if fallen is None or fallen.runs is None:
            return None
        opens = (fallen.opens | fallen.broken) & self.bonded & ~self.lost
        if not opens.any():
            return None
        left: Floats = np.where((self.lost | opens)[self.model.pair_contact], 0.0, 1.0)
        return left

    def ended(self, path_end: PathLimit, pressed: Pressed) -> Bonded:
        """The limit less the work of what is kept and opens, and no further than its contacts are pressed at rest."""
        least = self.least
        opens, _ = _moves(self.model, path_end)
        opens &= self.kept | self.late
        if path_end.parameter is None or not opens.any():
            return Bonded(
                path_end, self.bond, self.whole, unsettled=self.unsettled, soonest=self.soonest, rounds=self,
                counted=self.counted,
            )  # fmt: skip
        parameter = path_end.parameter
        less = self._less(path_end, opens)
        if least is not None and (least < parameter) == self.load_grows:
            if self.stood is not None and not (self.lost & ~self.stood).any():  # what stands without bonds stands with
                less = max(less, least) if self.load_grows else min(less, least)
            if (least < less) == self.load_grows and self.fallen is None:
                less = self._pressed_to(less, least, opens & self.kept, pressed)
        share = 1.0 - (less / parameter if self.load_grows else parameter / less)
        limit, kept = replace(path_end, parameter=less), int((opens & self.kept).sum())
        return Bonded(
            limit, self.bond, self.whole, least, kept, share, self.unsettled, self.soonest, self, self.counted
        )

    def _less(self, path_end: PathLimit, opens: Bools) -> float:
        """Its parameter without the work that the cohesion of contacts (k,) does."""
        assert path_end.parameter is not None
        share = self._work(path_end, opens) / float(self.working @ path_end.motion)
        if self.load_grows:
            return max(path_end.parameter - share, 0.0)
        return path_end.parameter / max(1.0 - share, TINY)

    def _work(self, path_end: PathLimit, contacts: Bools) -> float:
        """What the cohesion of some contacts (k,) does in a motion."""
        _, slip = self.model.opening_and_slip(path_end.motion)
        cohesion = self.model.by_group(np.where(contacts[self.model.pair_contact], self.model.cohesion, 0.0))
        return path_end.reduction * float(cohesion @ np.sqrt((slip * slip).sum(axis=1)))

    def _pressed_to(self, far: float, near: float, kept: Bools, pressed: Pressed) -> float:
        """The parameter, from `near` at most to `far`, up to which the kept contacts (k,) are pressed at rest."""

        def holds(parameter: float) -> bool:
            somewhere = pressed(self.bond, parameter)
            return somewhere is not None and bool(somewhere[kept].all())

        if holds(_JUST * far + (1.0 - _JUST) * near):
            return far
        for _ in range(_HALVINGS):
            middle = 0.5 * (near + far)
            near, far = (middle, far) if holds(middle) else (near, middle)
        return near


def with_bonds(
    model: AssemblyModel, once: Search, pressed: Pressed, working: Floats, load_grows: bool = False,
    begun: Rounds | None = None, falls: Falls | None = None,
) -> Bonded:  # fmt: skip
    """The limit with the bonds that its own motion leaves whole.

    Parameters
    ----------
    once : finds the limit with some bonds; pressed : contacts that are at rest
    working : (N,) the load whose work drives; `load_grows`: by so much as the parameter says
    begun : what rounds between other node pairs of the same contacts came to: they go on from there, as long as motions
        settle; the first limit that has not settled is returned as it is
    falls : the histories of falling strength, or of the load that grows
    """
    rounds, all_rest = Rounds(model, working, load_grows, falls), False
    vouched = falls is None or not rounds.bonded.any()
    if begun is not None and begun.bonded.any():
        rounds, vouched = begun.on(model, falls), True
    for _ in range(_MOST_ROUNDS):
        rounds.fall()
        path_end, all_rest = once(rounds.bond, vouched)
        if rounds.inherits and not path_end.found:
            if all_rest:
                return replace(rounds.ended(path_end, pressed), entire=rounds.entire)
            vouched = True
            continue
        runs = path_end.found or (path_end.outcome is PathOutcome.BRACKET and path_end.parameter is not None)
        if not runs and rounds.fallen is not None and rounds.gone.any():  # no path leads on from what a history broke
            rounds, vouched = Rounds(model, working, load_grows), True
            continue
        if not runs or not rounds.bonded.any():
            whole = rounds.whole or path_end.parameter
            return Bonded(path_end, rounds.bond, whole, unsettled=rounds.unsettled, soonest=rounds.soonest)
        changed = (
            rounds.open_before(path_end, all_rest)
            or rounds.after(path_end, all_rest)
            or (all_rest and rounds.refused(path_end, pressed))
        )
        if all_rest and not changed:
            last = rounds.ended(path_end, pressed)
            sooner = rounds.begun_sooner(last, pressed)
            if not isinstance(sooner, Rounds):
                last = sooner or last
                rounds = last.rounds or rounds
                last = replace(rounds.touching_again(rounds.no_farther(last, once), once), entire=rounds.entire)
                return _with_less(rounds, last, once)
            rounds, changed = sooner, True
        vouched = not changed
    while not all_rest:  # forces of a group alone are none of all blocks
        path_end, all_rest = once(rounds.bond, True)
    return Bonded(replace(path_end, outcome=PathOutcome.GAVE_UP), rounds.bond, rounds.whole)


def _with_less(rounds: Rounds, last: Bonded, once: Search) -> Bonded:
    """A limit that has not settled, and where motions begin without the bonds that go as it does."""
    left = None if last.limit.found else rounds.beyond()
    if left is None:
        return last
    path_end, _ = once(left, False)
    if path_end.parameter is None:
        return last
    sooner = min if rounds.load_grows else max
    return replace(last, soonest=sooner(path_end.parameter, last.soonest or path_end.parameter))


def _moves(model: AssemblyModel, path_end: PathLimit) -> tuple[Bools, Bools]:
    """Contacts (k,) that a motion opens anywhere, beyond what slip opens by itself, and those on which it slips."""
    opening, slip = model.opening_and_slip(path_end.motion)
    size = np.sqrt((slip * slip).sum(axis=1))
    dilation = np.minimum(model.tan_dilation, path_end.reduction * model.tan_friction)
    least = {PathOutcome.LIMIT: NO_MOTION, PathOutcome.SETTLED: OPENS_ROUGHLY}.get(path_end.outcome, FLOWS)
    fastest = max(float(np.abs(opening).max()), float(size.max()))
    apart = opening - (dilation * size)[model.group_of_pair] > least * fastest
    opens: Bools = np.bincount(model.pair_contact, apart, len(model.plus)) > 0
    slips: Bools = np.bincount(model.group_contact, size > OPENS_ROUGHLY * fastest, len(model.plus)) > 0
    return opens, slips
