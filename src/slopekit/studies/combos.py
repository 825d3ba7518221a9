"""Every pair of a joint survey as a wedge in a slope: removable or not and why, ranked, PRE-IE on the worst.

>>> import slopekit as sk
>>> found = sk.combos(["45/115", "45/245", "50/240", "80/350"], face="65/180", height=15, c=10, phi=30)
>>> found.counts["slides_on_both"], sum(found.counts.values()), found.removable
(2, 6, 2)
>>> [(pair.names, round(pair.closed_form, 3), pair.agree) for pair in found.worst]
[(('J1', 'J3'), 1.858, True), (('J1', 'J2'), 2.134, True)]
"""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from slopekit._version import __version__
from slopekit.arrays import Ints
from slopekit.design.joint_lists import JointList
from slopekit.errors import Notice
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.orientation import Plane
from slopekit.studies.pairs import LIMITED_BY, NEVER, PAIR_OUTCOMES, PairInputs, Pairs, evaluated, pair_inputs
from slopekit.studies.running import ALONE, Advance, Crew, run_all

Bar = Callable[[str, int], AbstractContextManager[Advance]]


@contextmanager
def _no_bar(_: str, __: int) -> Iterator[Advance]:
    yield lambda _: None


@dataclass(frozen=True, slots=True)
class PairCheck:
    """A pair that PRE-IE has looked at.

    Attributes
    ----------
    index : among all pairs; names, planes : of its joints
    status : of PRE-IE; limit : its factor, moments included; closed_status, closed_form : of the closed form
    difference, agree : on the same assumptions, None where they are not compared
    moments_govern : the limit lies below what forces alone give: it is the number to use
    height_m : at the trace of the first joint; volume_m3, scale, limited_by, trend_deg, plunge_deg : of the wedge
    """

    index: int
    names: tuple[str, str]
    planes: tuple[Plane, Plane]
    status: str
    limit: float | None
    closed_status: str
    closed_form: float | None
    difference: float | None
    agree: bool | None
    moments_govern: bool
    settled: bool
    height_m: float
    volume_m3: float
    scale: float
    limited_by: str
    trend_deg: float
    plunge_deg: float

    def falls_short(self, target: float) -> bool:
        """Whether PRE-IE finds it below a factor of safety, or that nothing holds it."""
        return self.status in ("lifted", "falls", "topples") or (self.limit is not None and self.limit < target)

    def to_dict(self) -> dict[str, Any]:
        """The pair as JSON values."""
        return {
            "joints": list(self.names), "planes": [str(plane) for plane in self.planes], "status": self.status,
            "fos": {"limit": self.limit, "closed_form": self.closed_form}, "closed_form_status": self.closed_status,
            "difference": self.difference, "agree": self.agree, "moments_govern": self.moments_govern,
            "settled": self.settled, "volume_m3": self.volume_m3, "height_m": self.height_m, "scale": self.scale,
            "limited_by": self.limited_by or None, "line": {"trend_deg": self.trend_deg, "plunge_deg": self.plunge_deg},
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class Target:
    """What lies below a factor of safety: pairs (by PRE-IE where it was asked, else by the closed form), volumes."""

    fos: float
    below: int
    by_pre_ie_only: int
    largest_m3: float | None
    median_m3: float | None

    def to_dict(self, removable: int, pairs: int) -> dict[str, Any]:
        """As JSON values."""
        return {
            "fos": self.fos, "below": self.below, "by_pre_ie_only": self.by_pre_ie_only,
            "share_of_removable": self.below / removable if removable else None,
            "share_of_pairs": self.below / pairs if pairs else None,
            "largest_volume_m3": self.largest_m3, "median_volume_m3": self.median_m3,
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class Combos:
    """A survey's pairs against a slope. `to_dict()` is the JSON of `slopekit combos --json`.

    Attributes
    ----------
    given : the joints with their strengths, the slope, the limits of size
    worst : the pairs that PRE-IE has looked at, worst first by the closed form
    """

    given: PairInputs
    pairs: Pairs
    worst: tuple[PairCheck, ...]
    target: Target | None
    warnings: tuple[Notice, ...]
    timing_s: Mapping[str, float] = field(default_factory=dict, compare=False)

    @property
    def joints(self) -> JointList:
        """The joints of the list."""
        return self.given.joints

    @property
    def counts(self) -> dict[str, int]:
        """How many pairs there are of each outcome; they add up to all pairs."""
        found = np.bincount(self.pairs.outcome, minlength=len(PAIR_OUTCOMES))
        counted = zip(PAIR_OUTCOMES, map(int, found), strict=True)
        return {name: count for name, count in counted if name not in NEVER}

    @property
    def removable(self) -> int:
        """How many pairs form a wedge that could leave the slope."""
        return int(self.pairs.is_removable.sum())

    @property
    def exit_code(self) -> int:
        """0 done, 1 pairs below the target, 4 the methods disagree or PRE-IE did not converge."""
        if any(pair.agree is False or not pair.settled for pair in self.worst):
            return 4
        return 1 if self.target is not None and self.target.below else 0

    def partners(self) -> tuple[tuple[str, int], ...]:
        """Joints by how many pairs below the target (else below 1) they take part in, most first."""
        below = self.pairs.fails(1.0 if self.target is None else self.target.fos)
        n = len(self.joints)
        times = np.bincount(self.pairs.shapes.first[below], minlength=n)
        times += np.bincount(self.pairs.shapes.second[below], minlength=n)
        order = np.argsort(-times, kind="stable")
        return tuple((self.joints.joints[k].name, int(times[k])) for k in order if times[k])

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON values; times stand in a block of their own."""
        m, removable = len(self.pairs), self.removable
        return {
            "slopekit": __version__,
            "study": "combos",
            "kind": "combos",
            "survey": {
                "name": self.joints.name, "joints": len(self.joints), "left_out": list(self.joints.left_out),
            },
            "input_sha256": self.given.input_hash(),
            "inputs": self.given.to_dict(),
            "defaults": list(self.given.defaults),
            "pairs": m,
            "counts": self.counts,
            "removable": removable,
            "scaled_down": {
                name.replace(" ", "_"): int((self.pairs.is_removable & (self.pairs.shapes.limited_by == kind)).sum())
                for kind, name in enumerate(LIMITED_BY) if name
            },
            "target": None if self.target is None else self.target.to_dict(removable, m),
            "worst": [pair.to_dict() for pair in self.worst],
            "pre_ie": {
                "pairs": len(self.worst), "agree": sum(pair.agree is True for pair in self.worst),
                "disagree": sum(pair.agree is False for pair in self.worst),
                "not_compared": sum(pair.agree is None for pair in self.worst),
                "moments_govern": sum(pair.moments_govern for pair in self.worst),
                "not_settled": sum(not pair.settled for pair in self.worst),
                "largest_difference": max(
                    (pair.difference for pair in self.worst if pair.difference is not None), default=None
                ),
            },
            "joints_in_pairs_below": [{"joint": name, "pairs": times} for name, times in self.partners()],
            "warnings": [notice.to_dict() for notice in self.warnings],
            "timing_s": dict(self.timing_s),
        }  # fmt: skip


def combos(
    joints: Any,
    given: Mapping[str, Any],
    *,
    convention: str | None = None,
    skip_bad: bool = False,
    fos: Any = None,
    top: Any = None,
    limits: Mapping[str, Any] | None = None,
    crew: Crew = ALONE,
    bar: Bar = _no_bar,
    option: Callable[[str], str] = lambda key: f"{key} =",
) -> Combos:
    """Every pair of a list as a wedge.

    Parameters
    ----------
    joints, convention, skip_bad : as `slopekit.design.joint_lists.joint_list`
    given : the slope by the names of `slopekit.wedge`: face, upper, height, c, phi, density, unit_weight, water,
        seismic, gravity, water_unit_weight, agree_within; None means not given
    fos : target, a factor of safety; top : how many of the worst PRE-IE looks at [10]
    limits : persistence, bench_width, max_volume, min_volume
    option : how an input is called where the user wrote it

    Raises
    ------
    DesignError
        Every fault: of the list, of the slope as for a wedge, E332 a strength that a joint needs, E334 limits of size,
        E335 top, E336 fos, E339 two values where pairs have no order.
    GeometryError
        E209 the slope has no crest.
    """
    began = time.perf_counter()
    asked = pair_inputs(joints, given, limits or {}, convention, skip_bad, fos, top, option)
    read_s = time.perf_counter() - began

    began = time.perf_counter()
    pairs = evaluated(asked.joints, asked.slope, asked.limits, asked.cohesion_kpa, asked.friction_deg)
    closed_s = time.perf_counter() - began

    began = time.perf_counter()
    chosen = pairs.ranked()[: asked.top]
    with bar("PRE-IE", len(chosen)) as advance:
        worst = _looked_at(asked, pairs, chosen, crew, advance)
    pre_ie_s = time.perf_counter() - began
    return Combos(
        asked, pairs, worst, None if asked.target is None else _judged(pairs, worst, asked.target),
        tuple(_notices(asked.joints, pairs, worst)),
        {"read": read_s, "closed_form": closed_s, "pre_ie": pre_ie_s, "total": read_s + closed_s + pre_ie_s},
    )  # fmt: skip


# -- PRE-IE on the worst ----------------------------------------------------------------------------------------------


def _looked_at(asked: PairInputs, pairs: Pairs, chosen: Ints, crew: Crew, advance: Advance) -> tuple[PairCheck, ...]:
    joints, cohesion, friction = asked.joints.joints, asked.cohesion_kpa, asked.friction_deg
    one, two = pairs.shapes.first, pairs.shapes.second
    designs = [
        replace(
            asked.slope, joints=(joints[a].plane, joints[b].plane), joint_names=(joints[a].name, joints[b].name),
            height_m=float(pairs.shapes.height_m[k]), cohesion_kpa=(float(cohesion[a]), float(cohesion[b])),
            friction_angle_deg=(float(friction[a]), float(friction[b])),
        )
        for k, a, b in zip(chosen, one[chosen], two[chosen], strict=True)
    ]  # fmt: skip
    records = run_all(both_methods, designs, crew, advance=advance)
    return tuple(
        PairCheck(
            int(k), design.joint_names, design.joints, **record, height_m=design.height_m,
            volume_m3=float(pairs.volume_m3[k]), scale=float(pairs.shapes.scale[k]),
            limited_by=LIMITED_BY[pairs.shapes.limited_by[k]], trend_deg=float(pairs.trend_deg[k]),
            plunge_deg=float(pairs.plunge_deg[k]),
        )
        for k, design, record in zip(chosen, designs, records, strict=True)
    )  # fmt: skip


def both_methods(design: WedgeDesign) -> dict[str, Any]:
    """Both factors of safety of a wedge as JSON values: what a worker does."""
    from slopekit.kinds import factors_of

    found = factors_of(design)
    return {
        "status": found.status, "limit": found.limit, "closed_status": found.closed_status or "",
        "closed_form": found.closed_form, "difference": found.difference, "agree": found.agree,
        "moments_govern": found.moments_govern, "settled": found.settled and found.status != "not_converged",
    }  # fmt: skip


def _judged(pairs: Pairs, worst: tuple[PairCheck, ...], target: float) -> Target:
    """What lies below the target: by the closed form, and by PRE-IE where moments lower a factor below it."""
    below = pairs.fails(target)
    only = [pair.index for pair in worst if pair.falls_short(target) and not below[pair.index]]
    below[only] = True
    volumes = pairs.volume_m3[below]
    largest, median = (float(volumes.max()), float(np.median(volumes))) if len(volumes) else (None, None)
    return Target(target, int(below.sum()), len(only), largest, median)


def _notices(joints: JointList, pairs: Pairs, worst: tuple[PairCheck, ...]) -> Iterator[Notice]:
    governed = [pair for pair in worst if pair.moments_govern]
    if governed:
        lowered = [1.0 - pair.limit / pair.closed_form for pair in governed if pair.limit and pair.closed_form]
        topple = sum(pair.status == "topples" for pair in governed)
        by = [f"by up to {max(lowered) * 100:.1f} %"] if lowered else []
        by += [f"{topple} of them topple"] if topple else []
        rest = int(pairs.is_removable.sum()) - len(worst)
        last = f"; the other {rest} removable pairs have the closed form alone, which knows no moments" if rest else ""
        message = f"moments govern {len(governed)} of the {len(worst)} pairs that PRE-IE looked at"
        yield Notice("W365", ", ".join([message, *by]) + last)
    if joints.left_out:
        yield Notice("W366", f"not used of {joints.name}: {'; '.join(joints.left_out)}")
    if joints.read_as:
        yield Notice("W373", f"read of {joints.name}: {'; '.join(joints.read_as)}")
    if joints.has_quantities:
        message = (
            f"quantities of {joints.name} ({len(joints)} joints, {joints.quantities.sum():.6g} by quantity) count "
            "nothing here: each pair of joints stands once"
        )
        yield Notice("W374", message)
