"""Which contacts of many blocks have lost their cohesion where they fail.

A contact that is open all over as blocks rest on their elastic joints has lost its cohesion before any motion begins:
each limit is that of the motion with which they run as their strength falls (`elastic_path.falling`), with those bonds
gone. A flat contact that this motion opens anywhere touches along a line at most: all its cohesion goes, and the limit
is looked for again without it. While that has the same motion, one that opens all that was opened before, it is the
limit. Another motion is not there: a motion begins at its own factor and breaks nothing before, and strength that
falls comes to the first with those contacts whole. Then the limit is the first, less what the cohesion that it opens
does of its work,

    λ' (P·v - λ Σ_opened c |s|) = λ P·v        (of a load α R:  α' R·v = α R·v - λ Σ_opened c |s|)

or the other, where that begins later than this and opens nothing more: until then the blocks stand without those bonds.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from slopekit.core.arrays import Bools, Floats
from slopekit.core.records import dataclass
from slopekit.preie.elastic_path.path_limit import MANY, PathLimit, PathOutcome
from slopekit.preie.system.assembly import AssemblyModel
from slopekit.preie.tolerances import EQUILIBRIUM, FLOWS, NO_MOTION, OPENS_ROUGHLY, SAME_FACTOR, TINY

_MOST_ROUNDS, MOST_GROUPS = 60, 8  # of cohesion lost; groups of blocks that are tried, one after the other
_LITTLE = 0.02  # of the work of a motion that has not settled: cohesion that it opens does no more
# cosine of two motions from which on they are one: of 69 random benches (46 to 140, 5 kPa) one moves with 0.5 (46: 10.2
# for 10.7), two with 0.9999 (66: 0.527 for 0.492); of 35 others none from 0.9 to 0.999
_ALIKE = 0.99

Search = Callable[[Floats, bool, bool], tuple[PathLimit, bool]]
"""The limit with bonds (m,), whether more of them break as strength falls, whether all blocks have to vouch for it; and
whether they do."""


@dataclass(frozen=True, slots=True)
class Bonded:
    """A limit and the bonds there.

    Attributes
    ----------
    limit : its parameter is that without cohesion where its motion opens; its bonds are those that are left
    share : part of the motion's work that the cohesion did which it opens
    """

    limit: PathLimit
    share: float = 0.0


class _Rounds:
    """Limits of one model with ever fewer bonds."""

    def __init__(
        self, model: AssemblyModel, once: Search, working: Floats, load_grows: bool, begun: Floats
    ) -> None:  # fmt: skip
        self.model, self.once, self.working, self.load_grows = model, once, working, load_grows
        joints = model.joint_pairs  # what bolts pull is no bond of a contact
        self.bonded = np.bincount(model.pair_contact[joints], model.cohesion[joints], len(model.plus)) > 0.0
        self.asked, self.all_rest = (begun, True), False  # what the limit was looked for with; whether all blocks rest
        self.opens = np.zeros_like(self.bonded)  # contacts that its motion opens, and another one would without them

    def ended(self, last: PathLimit) -> Bonded:
        """The limit of the blocks that fail, from the one with the bonds that falling strength leaves on."""
        opened, self.opens = np.zeros_like(self.bonded), np.zeros_like(self.bonded)
        for _ in range(_MOST_ROUNDS if _runs(last) else 0):
            new = self._opens(last) & self.bonded & ~self._lost(last)
            if not new.any():
                break
            self.opens, before = new, (self.asked, self.all_rest)
            if not last.found and self.model.load.size > MANY and self._share(last, new) < _LITTLE:
                break  # another path takes seconds
            after = self.limit(np.where(new[self.model.pair_contact], 0.0, last.bond), False)
            if after.outcome is PathOutcome.NO_REST:  # all that holds the blocks is cohesion that they open
                last = after
                break
            opened |= new
            if not self._is_same(last, after, opened) and not self._stands(last, after):
                self.asked, self.all_rest = before
                break
            last, self.opens = after, np.zeros_like(new)
        return Bonded(last)

    def vouched(self, ended: Bonded) -> Bonded | PathLimit:
        """The same once all blocks have vouched for it, less the work of what it opens; or the limit of others."""
        last = ended.limit
        if not self.all_rest:
            last, self.all_rest = self.once(*self.asked, True)
            if not np.array_equal(last.motion, ended.limit.motion):
                return last
        if not self.opens.any() or last.parameter is None:
            return replace(ended, limit=last)
        share, less = self._less(last, self.opens)
        if share > 1.0 - EQUILIBRIUM:  # all that holds the motion is cohesion that it opens
            left = np.where(self.opens[self.model.pair_contact], 0.0, last.bond)
            return replace(ended, limit=replace(last, outcome=PathOutcome.NO_REST, parameter=None, bond=left))
        return Bonded(replace(last, parameter=less), share)

    def limit(self, bond: Floats, falls: bool) -> PathLimit:
        """With some bonds (m,)."""
        path_end, self.all_rest = self.once(bond, falls, False)
        self.asked = bond, falls
        return path_end

    def _lost(self, path_end: PathLimit) -> Bools:
        lost: Bools = np.bincount(self.model.pair_contact, path_end.bond, len(self.bonded)) == 0.0
        return lost

    def _opens(self, path_end: PathLimit) -> Bools:
        """Contacts (k,) that a motion opens anywhere, beyond what slip opens by itself."""
        model = self.model
        opening, slip = model.opening_and_slip(path_end.motion)
        size = np.sqrt((slip * slip).sum(axis=1))
        dilation = np.minimum(model.tan_dilation, path_end.reduction * model.tan_friction)
        least = {PathOutcome.LIMIT: NO_MOTION, PathOutcome.SETTLED: OPENS_ROUGHLY}.get(path_end.outcome, FLOWS)
        fastest = max(float(np.abs(opening).max()), float(size.max()))
        apart = opening - (dilation * size)[model.group_of_pair] > least * fastest
        opens: Bools = np.bincount(model.pair_contact, apart, len(model.plus)) > 0
        return opens

    def _is_same(self, last: PathLimit, after: PathLimit, opened: Bools) -> bool:
        """Whether the motion without what others opened (k,) opens that too, is no other, and begins no later."""
        if not last.found or not after.found:
            return False
        if self._is_later(after, last.parameter or 0.0) or not self._opens(after)[opened].all():
            return False
        one, other = (self._relative(path_end) for path_end in (last, after))
        return float(one @ other) > _ALIKE * float(np.sqrt((one @ one) * (other @ other)))

    def _stands(self, last: PathLimit, after: PathLimit) -> bool:
        """Whether blocks without what a motion opens stand longer than its work without that allows, but not than it.

        They are at rest until then with less cohesion than there is. Only where they open no more of it.
        """
        _, less = self._less(last, self.opens)
        longer = _runs(after) and self._is_later(after, less) and not self._is_later(after, last.parameter or 0.0)
        return longer and not (self._opens(after) & self.bonded & ~self._lost(after)).any()

    def _is_later(self, after: PathLimit, parameter: float) -> bool:
        """Whether a motion begins at less strength, or more load, than at a parameter."""
        assert after.parameter is not None
        later = (after.parameter - parameter) * (1.0 if self.load_grows else -1.0)
        return later > SAME_FACTOR * parameter

    def _less(self, path_end: PathLimit, opens: Bools) -> tuple[float, float]:
        """The part of a motion's work that the cohesion of contacts (k,) does, and the parameter without that."""
        share, parameter = self._share(path_end, opens), path_end.parameter or 0.0
        return share, parameter * (1.0 - share) if self.load_grows else parameter / max(1.0 - share, TINY)

    def _relative(self, path_end: PathLimit) -> Floats:
        """Opening and slip of the motion."""
        opening, slip = self.model.opening_and_slip(path_end.motion)
        return np.concatenate([opening, slip.ravel()])

    def _share(self, path_end: PathLimit, opens: Bools) -> float:
        """Part of the work of a motion that the cohesion of contacts (k,) does, 1 at most.

        Joints that dilate lift the load as they slip: of the work of their strength it is a smaller part.
        """
        assert path_end.parameter is not None
        _, slip = self.model.opening_and_slip(path_end.motion)
        cohesion = self.model.by_group(np.where(opens[self.model.pair_contact], self.model.cohesion, 0.0))
        work = path_end.reduction * float(cohesion @ np.sqrt((slip * slip).sum(axis=1)))
        driven = float(self.working @ path_end.motion) * (path_end.parameter if self.load_grows else 1.0)
        return work / driven if work < driven else float(work > 0.0)


def with_bonds(
    model: AssemblyModel, once: Search, working: Floats, load_grows: bool = False, bond: Floats | None = None
) -> Bonded:
    """The limit with the bonds that its own motion leaves whole.

    Parameters
    ----------
    once : finds the limit with some bonds
    working : (N,) the load whose work drives; `load_grows`: by so much as the parameter says
    bond : (m,) that are left to begin with, as between other node pairs of the same contacts
    """
    begun = np.ones(len(model.control_area)) if bond is None else bond
    rounds = _Rounds(model, once, working, load_grows, begun)
    last = rounds.limit(begun, True)
    for _ in range(MOST_GROUPS):  # forces of one alone are none of all blocks
        ended = rounds.ended(last)
        vouched = rounds.vouched(ended)
        if isinstance(vouched, Bonded):
            return vouched
        last = vouched
    return replace(ended, limit=replace(ended.limit, outcome=PathOutcome.GAVE_UP))


def _runs(path_end: PathLimit) -> bool:
    return path_end.parameter is not None and (path_end.found or path_end.outcome is PathOutcome.BRACKET)
