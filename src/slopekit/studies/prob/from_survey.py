"""The two joints of a wedge drawn from a survey: its own joints, pair by pair.

P(failure) = P(two joints form a wedge that can leave the slope) × P(it fails | it forms). A survey is a sample itself:
where its own joints are drawn, resampling them (Efron 1979, Ann. Stat. 7, 1-26) says how far the three would be off
with as many other joints: a pair that was drawn counts as often as its two joints do in the resampled survey.
"""

import math
from dataclasses import field, replace
from typing import Any

import numpy as np

from slopekit.core.arrays import Bools, Ints
from slopekit.core.errors import Fault, Faults, Notice
from slopekit.core.orientation import Plane
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.design.joint_lists import JointList, joint_list
from slopekit.design.scatter.distributions import Fisher, Variable
from slopekit.kinds import kind_of
from slopekit.studies.prob.estimates import Share, share_of
from slopekit.studies.prob.judged import Judged
from slopekit.studies.prob.sampling import Samples
from slopekit.studies.surveys import MOST_JOINTS, left_out

_RESAMPLED = 400
_OWN_STREAM = 0x5E75  # apart from the stream that draws the other numbers
_PLACEHOLDER_K = 1.0  # of a distribution that is not drawn from: the survey is


@dataclass(frozen=True, slots=True)
class Resampled:
    """Limits of a probability over surveys resampled from this one."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class FromSurvey:
    """What the joints of a survey come to.

    Attributes
    ----------
    occurrence, failure, both : P(forms), P(fails | forms), their product, with the limits of the samples
    resampled : of the three over resampled surveys, None where none of them holds a pair; times : how many
    """

    survey: str
    joints: int
    occurrence: Share
    failure: Share
    both: Share
    resampled: tuple[Resampled, Resampled, Resampled] | None
    times: int


@dataclass(frozen=True, slots=True)
class SurveySource:
    """A survey that joints are drawn from.

    Attributes
    ----------
    paths : of the two planes in the design
    """

    listed: JointList
    paths: tuple[str, str]
    notices: tuple[Notice, ...] = field(default=(), compare=False)

    def pairs(self, n: int, seed: int) -> tuple[Ints, Ints, np.random.Generator]:
        """Two joints each, never one twice, by quantity."""
        rng = np.random.default_rng([seed, _OWN_STREAM])
        part = self.listed.quantities / self.listed.quantities.sum()
        first, second = rng.choice(len(part), n, p=part), rng.choice(len(part), n, p=part)
        while (same := np.flatnonzero(first == second)).size:
            first[same] = rng.choice(len(part), same.size, p=part)
            second[same] = rng.choice(len(part), same.size, p=part)
        return first, second, rng

    def samples(self, others: Samples | None, variables: tuple[Variable, ...], n: int, seed: int) -> Samples:
        """The planes of the two joints beside what else scatters."""
        first, second, _ = self.pairs(n, seed)
        dips, ways = self.listed.dips_deg, self.listed.dip_directions_deg
        columns = [dips[first], ways[first], dips[second], ways[second]]
        values = np.stack([*columns, *([] if others is None else others.values.T)])
        values.setflags(write=False)
        names = tuple(name for variable in variables for name in variable.columns)
        replicate = np.zeros(n, dtype=np.int16)
        return Samples(variables, names, values.T, replicate)

    def outcome(self, judged: Judged, seed: int, confidence: float) -> FromSurvey:
        """P(forms), P(fails | forms) and their product, with limits."""
        possible = judged.counted
        forms, fails = possible & judged.forms, possible & judged.fails
        once = np.zeros(len(possible), dtype=np.int64)
        shares = (
            share_of(forms, possible, once, confidence),
            share_of(fails, forms, once, confidence),
            share_of(fails, possible, once, confidence),
        )
        resampled = self._resampled(possible, forms, fails, seed, confidence)
        times = 0 if resampled is None else _RESAMPLED
        return FromSurvey(self.listed.name, len(self.listed), *shares, resampled, times)

    def _resampled(
        self, possible: Bools, forms: Bools, fails: Bools, seed: int, confidence: float
    ) -> tuple[Resampled, Resampled, Resampled] | None:
        first, second, rng = self.pairs(len(possible), seed)
        probabilities, even = [], np.full(len(self.listed), 1.0 / len(self.listed))
        for _ in range(_RESAMPLED):
            times = rng.multinomial(len(self.listed), even)
            weights = (times[first] * times[second]).astype(float)
            whole, formed, failed = (float(weights[some].sum()) for some in (possible, forms, fails))
            if whole > 0.0:
                probabilities.append((formed / whole, failed / formed if formed else math.nan, failed / whole))
        if not probabilities:
            return None
        tail = (1.0 - confidence) / 2.0
        columns = np.array(probabilities).T
        limits = [
            np.quantile(known, [tail, 1.0 - tail]) if (known := column[~np.isnan(column)]).size else (0.0, 1.0)
            for column in columns
        ]
        one, two, three = (Resampled(float(low), float(high)) for low, high in limits)
        return one, two, three


def surveyed(design: Design, survey: Any, method: str, option: str) -> tuple[Design, SurveySource]:
    """A wedge whose joints come from a survey, and the source of their planes.

    Raises
    ------
    DesignError
        E288 not a wedge with joints of its own, E126 samples that are not Monte Carlo, E167 a rank correlation with the
        orientation of a joint; those of the list.
    """
    faults = Faults()
    drawn = kind_of(design).drawn_planes
    plain = design.source.root.plain() if design.source is not None else None
    given = plain.get("joints") if isinstance(plain, dict) else None
    if drawn is None or not isinstance(given, dict) or "csv" in given:
        message = f"a survey gives a wedge its two joints, this is a {design.kind}"
        message += " whose joints are of a list" if drawn is not None else ""
        faults.append(
            Fault("E288", message, option, "Write joints: {J1: {plane: 45/115}, ...}: their planes are drawn.")
        )
    if method != "monte-carlo":
        faults.append(Fault("E126", f"joints of a survey are drawn by monte-carlo, not by {method}", "--method"))
    paths: tuple[str, ...] = () if drawn is None else drawn(design)
    for one, other, _ in design.correlation:
        if _is_of(one, paths) or _is_of(other, paths):
            message = f"{one} and {other} are correlated, the planes come from a survey"
            faults.append(Fault("E167", message, "correlation", "Leave this correlation out."))
    faults.refuse()
    listed = joint_list(survey, None, False, 2, "", most=MOST_JOINTS)
    centre = Fisher(Plane(45.0, 180.0), _PLACEHOLDER_K)
    where = f"{listed.name} joints {listed.rows()!r} {listed.quantities.tolist()!r}"
    own = tuple(Variable(path, centre, where) for path in paths)
    kept = tuple(one for one in design.variables if not _is_of(one.path, paths))
    source = SurveySource(listed, (paths[0], paths[1]), tuple(left_out(listed)))
    return replace(design, variables=(*own, *kept)), source


def _is_of(path: str, planes: tuple[str, ...]) -> bool:
    """Whether a number is one of a plane."""
    return any(f"{path}.".startswith(f"{plane}.") for plane in planes)
