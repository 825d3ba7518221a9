"""Support: the bolts, or the pressure on the face, that give a wedge or a plane a wanted factor of safety.

>>> import slopekit as sk
>>> plane = {"slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12}, "rock": {"unit_weight": 26},
...          "joints": {"J1": {"plane": "35/180"}}, "strength": {"s": {"c": 0, "phi": 37}}}
>>> found = sk.support(sk.load(plane), 1.5, acts="active")
>>> bolts = found.cases[0]
>>> bolts.toward.plunge_deg, round(bolts.closed_form.force, 1), round(bolts.closed_form.answer.factor, 6)
(0.0, 233.1, 1.5)
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Annotated, Any

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import Notice
from slopekit.core.orientation import Line
from slopekit.design.common import Design
from slopekit.design.parts import ON_FACTOR, Bolt
from slopekit.kinds import (
    dilates,
    factors_of,
    implausible_sizes,
    peak_strength_notice,
    whole_wedge_notice,
)
from slopekit.notices import common_notices
from slopekit.studies.points import Method, Point, rules_left_out, run_notices
from slopekit.studies.protocol import DESK, ADesign, Option, Workplace, study
from slopekit.studies.support.pattern import Layout, centre_of, layout
from slopekit.studies.support.records import (
    DRILLABLE_DEG,
    Acts,
    BoltCase,
    Support,
    SupportOptions,
    as_written,
    built_force,
    meets_target,
    read_options,
)
from slopekit.studies.support.search import (
    Need,
    Site,
    best_direction,
    least_force,
    least_forces,
    method_answer,
    site_of,
)

_GOAL_MARGIN = (
    2e-8  # relative; the first guess aims above the target, so that rounding leaves none below
)
_NO_STRENGTH = Notice("E322", "the joints have no strength: a load can only balance the block")
_DEFAULT_TARGET = 1.5  # factor of safety without an acceptance rule
_MOST_LAYOUTS = 3  # layouts of heads, each for the force that PRE-IE needs with the one before
_CLOSE_M = 1.0  # bolts that stand closer share the rock they hold


@study
def support(
    design: ADesign,
    fos: Annotated[
        Any, Option("The factor of safety that is wanted [what acceptance asks for, else 1.5].")
    ] = None,
    *,
    acts: Annotated[str | None, Option("active (a load) or passive (strength) [both].")] = None,
    toward: Annotated[
        Any,
        Option(
            "Direction of the bolts' force on the block, into the rock [the best within --plunge].",
            metavar="TREND/PLUNGE",
        ),
    ] = None,
    plunge: Annotated[
        Any,
        Option(
            "Plunges that can be drilled, positive downward: -5,15 [0,30].", metavar="LEAST,MOST"
        ),
    ] = None,
    bolt_capacity: Annotated[Any, Option("Of one bolt [200 kN].")] = 200.0,
    spacing: Annotated[Any, Option("Of the heads on the face [what the force asks for].")] = None,
    bond: Annotated[Any, Option("Anchorage behind the deepest joint [3 m].")] = 3.0,
    length: Annotated[Any, Option("Of every bolt [each as long as it must be, to 0.1 m].")] = None,
    desk: Workplace = DESK,
) -> Support:
    """Bolts for a factor of safety: force, best direction, pattern on the face, length; and pressure.

    For a wedge or a plane. Bolts that the design has stay and count. Bolts are laid out as they are built: trend and
    plunge to 5° (in a section the plunge), forces up to 10 kN, lengths up to 0.1 m, and the design is solved again with
    them. Exit codes: 0 reached (or nothing is needed), 1 not reached, 4 the methods disagree or one has no answer.

    Raises
    ------
    DesignError
        E288 for other kinds, E307 for what is not understood.
    GeometryError
        Where no block can be formed.

    Notes
    -----
    The force T (kN; kN/m of a plane) is the smallest of a bolt in a direction with F(T) = the target. An active bolt is
    a load on the driving side; a passive one is strength, at most T / F. On one plane of dip ψ, dry, an active bolt at
    the angle θ to the normal of the plane, upward along it, gives
    F = (c A + (W cos ψ + T cos θ) tan φ) / (W sin ψ - T sin θ).

    References
    ----------
    Hoek & Bray (1981), Rock Slope Engineering, ch. 7 and 8; Wyllie & Mah (2004), ch. 6, 7 and 12.

    Examples
    --------
    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> bolts = sk.support(sk.load(wedge), 1.7, acts="active", bolt_capacity="1 MN").cases[0]
    >>> round(bolts.force), round(bolts.closed_form.answer.factor, 6), round(bolts.pre_ie.answer.factor, 6)
    (169428, 1.7, 1.7)
    """
    target = (design.accepted_fos or _DEFAULT_TARGET) if fos is None else fos
    options = read_options(
        fos=target,
        acts=acts,
        toward=toward,
        plunge=plunge,
        bolt_capacity=bolt_capacity,
        spacing=spacing,
        bond=bond,
        length=length,
        option_name=desk.named,
    )
    if options.toward is None and options.plunge is None:
        options = replace(options, plunge=DRILLABLE_DEG)
    site = site_of(design)
    search = _Search(site, options)
    is_met = meets_target(options.target, search.bare, search.bare_limit, search.dilates)
    cases = () if is_met else tuple(search.case(acts) for acts in options.acts)
    return Support(
        design,
        options.target,
        options,
        search.bare,
        search.bare_limit,
        cases,
        None if is_met else search.pressure(),
        site.unit,
        tuple(_support_notices(site, cases, options.target)),
        search.dilates,
    )


def _support_notices(site: Site, cases: Sequence[BoltCase], target: float) -> Iterator[Notice]:
    """Yield the notices on the design, and those of its runs as it stands and with the bolts."""
    design = site.design
    input_notices = (*common_notices(design, design.joint_strengths), *implausible_sizes(design))
    yield from input_notices
    yield from peak_strength_notice(design, "bolts are for the factor")
    yield from rules_left_out(design, ON_FACTOR)
    bare = factors_of(design)
    built = {
        f"with the {case.acts} bolts": case.factors for case in cases if case.factors is not None
    }
    if not built:
        yield from whole_wedge_notice(bare.also, target, "as it stands")
    points = [Point(bare), *map(Point, built.values())]
    yield from run_notices(points, ["as it stands", *built].__getitem__, input_notices, "designs")


class _Search:
    """The search for the bolts, and the pressure, that give a design its target factor of safety."""

    def __init__(self, site: Site, options: SupportOptions) -> None:
        self.site, self.options, self.target = site, options, options.target
        factors = factors_of(site.design)
        self.bare, self.bare_limit = (
            method_answer(factors, "closed_form"),
            method_answer(factors, "pre_ie"),
        )
        self.dilates = dilates(site.design)
        strengths = site.design.joint_strengths
        self.has_strength = any(
            strength.cohesion_kpa or strength.friction_angle_deg for strength in strengths
        )
        self.goal = self.target * (
            1.0 + _GOAL_MARGIN
        )  # factor of the closed form, for a direction and a first guess
        if self.bare.reaches(
            self.target
        ):  # PRE-IE does not reach it: raise the goal by what it lacks
            missing_ratio = (
                self.target / self.bare_limit.search_level
                if self.bare_limit.search_level > 0.0
                else 2.0
            )
            self.goal *= (
                max(missing_ratio, 1.0 + 1e-6) * (self.bare.factor or self.target) / self.target
            )

    def case(self, acts: Acts) -> BoltCase:
        """Return active or passive bolts: direction, force, heads, lengths, and the factors of the design with them."""
        site, options = self.site, self.options
        if not self.has_strength:
            return self._without_bolts(
                BoltCase(acts, None, Need(None, self.bare, notice=_NO_STRENGTH))
            )
        toward = options.toward or best_direction(site, self.goal, options.plunge or DRILLABLE_DEG)
        if toward is None:
            low, high = options.plunge or DRILLABLE_DEG
            return self._without_bolts(
                BoltCase(
                    acts,
                    None,
                    Need(
                        None,
                        self.bare,
                        notice=Notice(
                            "E322",
                            f"no direction into the face that plunges {low:g} to {high:g}° reaches the target",
                        ),
                    ),
                )
            )
        guess = self._guess(toward.vector()) * (self.goal if acts == "passive" else 1.0)
        key = f"support.bolts.{len(site.design.bolts)}.force"
        closed = self._need("closed_form", site.with_bolts(Bolt(guess, toward, acts)), key, guess)
        case = BoltCase(acts, toward, closed, existing=site.design.bolts)
        if closed.force is None:
            return self._without_bolts(case)
        design_force = closed.force or guess
        for _ in range(_MOST_LAYOUTS):
            bolt_layout = layout(
                site, site.across(toward.vector()), design_force, options.capacity, options.spacing
            )
            if isinstance(bolt_layout, Notice):
                return self._without_bolts(replace(case, notices=(bolt_layout,)))
            # parallel bolts of one force are one through the middle of their heads
            bolted = site.with_bolts(
                Bolt(design_force, toward, acts, site.place(bolt_layout.middle_m))
            )
            limit = self._need("pre_ie", bolted, key, design_force)
            case = replace(
                case, pre_ie=limit, layout=bolt_layout, force=self._governing_force(closed, limit)
            )
            if case.force is None:
                return self._without_bolts(case)
            if case.force * self._slice_m(bolt_layout) <= options.capacity * len(bolt_layout) * (
                1.0 + 1e-6
            ):
                return self._with_built_bolts(case, toward, bolt_layout, case.force)
            design_force = case.force
        too_much = (
            f"{design_force:.6g} {site.unit} are more than the bolts can take: with more of "
            "them the moments ask for more"
        )
        return self._without_bolts(replace(case, notices=(Notice("E328", too_much),)))

    def _slice_m(self, layout: Layout) -> float:
        """Return the length of slope (m) that one bolt holds in a section, its spacing along the slope; else 1."""
        return layout.across_m if self.site.in_section else 1.0

    def _with_built_bolts(
        self, case: BoltCase, toward: Line, layout: Layout, force: float
    ) -> BoltCase:
        """Return a case with its bolts as they are built, and the factors of the design with them."""
        options, slice_m = self.options, self._slice_m(layout)
        bolt_force = built_force(force * slice_m / len(layout), options.capacity)
        needed = layout.sound_m + options.bond
        lengths = np.ceil(needed * 10.0 - 1e-9) / 10.0
        least_m, notices = (
            min([layout.across_m] + [layout.up_m] * (layout.rows > 1)),
            list[Notice](),
        )
        if least_m < _CLOSE_M and (len(layout) > 1 or self.site.in_section):
            message = f"bolts stand {least_m:.2g} m apart: closer than {_CLOSE_M:g} m they hold the same rock"
            notices.append(
                Notice("W311", f"{message}; stronger bolts (--bolt-capacity) stand farther apart")
            )
        if options.length is not None:
            lengths = np.full(len(layout), options.length)
        short = int((lengths < needed * (1.0 - 1e-12)).sum())
        case = replace(case, layout=layout, each=bolt_force, lengths=lengths)
        if short:
            message = f"{short} of {len(layout)} bolts are too short at {options.length:g} m"
            notices.append(Notice("E212", f"{message}: the longest needs {needed.max():.4g} m"))
            return self._without_bolts(replace(case, notices=tuple(notices)))
        bolts = tuple(
            as_written(Bolt(bolt_force / slice_m, toward, case.acts, (east, north, up), length))
            for (east, north, up), length in zip(
                layout.heads_m.tolist(), lengths.tolist(), strict=True
            )
        )
        return replace(case, bolts=bolts, notices=tuple(notices)).solved_in(
            self.site.design, self.target
        )

    def _without_bolts(self, case: BoltCase) -> BoltCase:
        """Return a case without bolts to build, with the reason."""
        codes = ", ".join(
            dict.fromkeys(notice.code for notice in case.all_notices if notice.code.startswith("E"))
        )
        lacks = f"NOT REACHED, FoS {self.target:g}: no bolts give it ({codes}), without them {self.bare_limit.in_words}"
        return replace(case, lacks=lacks)

    def pressure(self) -> float | None:
        """Return the even pressure on the face, kPa, that both methods need; None where it is not enough."""
        site = self.site
        guess = self._guess(site.inward)
        pressed, key = (
            site.pressed(guess, centre_of(site.face)),
            f"loads.forces.{len(site.design.forces)}.force",
        )
        closed = self._need("closed_form", pressed, key, guess)
        if closed.force is None or not self.has_strength:
            return None
        limit = self._need("pre_ie", pressed, key, closed.force or guess)
        force = self._governing_force(closed, limit)
        return None if force is None else force / site.area

    def _guess(self, direction: Floats) -> float:
        """Return the least force (kN) along a unit vector (3,) by the closed form, the weight where none is enough."""
        return float(
            np.nan_to_num(
                least_forces(self.site, self.goal, direction[None]), posinf=self.site.weight
            )[0]
        )

    def _governing_force(self, closed: Need, limit: Need) -> float | None:
        """Return the larger need of both methods, of dilating joints PRE-IE's; None where one has no such force."""
        if closed.force is None or limit.force is None:
            return None
        return limit.force if self.dilates else max(closed.force, limit.force)

    def _need(self, method: Method, design: Design, key: str, guess: float) -> Need:
        """Return the least force at a key of a design by one method, with a notice where there is none or it jumps."""
        bare, pre_ie = self.bare_limit if method == "pre_ie" else self.bare, method == "pre_ie"
        if bare.reaches(self.target):
            return Need(0.0, bare)
        need = least_force(partial(self.site.answers, design, key, method), self.target, guess)
        level = need.answer.search_level
        if need.force is None:
            best = f"at best FoS {level:.4g} at {need.best:.4g} {self.site.unit}"
            cause = (
                "moments turn the block"
                if need.answer.moments_govern
                else "its limit lies below the closed form's"
            )
            notice = Notice(
                "E329",
                f"PRE-IE does not reach the target with the heads on the face: {cause}, {best}",
            )
            if not pre_ie:
                if level <= bare.search_level * (1.0 + 1e-9):
                    best = "it drives the block as much as it holds it, or the movement does not draw passive bolts out"
                notice = Notice("E322", f"no force that way reaches the target: {best}")
            return replace(need, notice=notice)
        if need.below is None:
            return need
        message = f"FoS jumps over the target at {need.force:.6g} {self.site.unit}, from {need.below:.4g} to "
        message += f"{level:.4g}: contact, or how the block moves, changes there; go above"
        return replace(need, notice=Notice("E325", message))
