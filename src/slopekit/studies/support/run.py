"""Support: the bolts, or the pressure on the face, that give a wedge or a plane a wanted factor of safety.

>>> import slopekit as sk
>>> plane = {"slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12}, "rock": {"unit_weight": 26},
...          "joints": {"J1": {"plane": "35/180"}}, "strength": {"s": {"c": 0, "phi": 37}}}
>>> found = sk.support(sk.load(plane), 1.5, acts="active")
>>> bolts = found.cases[0]
>>> bolts.toward.plunge_deg, round(bolts.closed_form.force, 1), round(bolts.closed_form.fos, 6)
(0.0, 233.1, 1.5)
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.errors import Notice
from slopekit.core.orientation import Line
from slopekit.design.common import Design
from slopekit.design.parts import ON_FACTOR, Bolt
from slopekit.kinds import also_falls_short, dilates, factors_of, kind_of, peak_only, slips_of_size
from slopekit.kinds.protocol import Factors
from slopekit.notices import common_notices
from slopekit.studies.points import Point, rules_left_out, said_at
from slopekit.studies.protocol import DESK, ADesign, Option, Workplace, study
from slopekit.studies.support.directions import NO_STRENGTH, BoltDirections, Way
from slopekit.studies.support.pattern import Layout, centre_of, groups, layout
from slopekit.studies.support.records import (
    DRILLABLE_DEG,
    BoltCase,
    FacePressure,
    Need,
    Pattern,
    Support,
    SupportOptions,
    Which,
    built_force,
    enough,
    read_options,
    written,
)
from slopekit.studies.support.search import (
    AIM,
    WITHIN,
    Answer,
    SearchResult,
    Site,
    closed_form_answer,
    least_force,
    limit_answer,
    pre_ie,
    site_of,
)

_NEAR = 0.02  # of the target: a first answer so near is as good as a rough search
_MOST_WITH_MOMENTS = 2.0  # times the force that the closed form needs: where moments govern the search begins there
_LAYOUTS = 4  # of heads, each for the force that the one before asks for
_MOST_GROUPS = 9  # passive bolts that PRE-IE takes one by one; more of them stand together in groups
_WANTED = 1.5  # where nobody says another factor of safety
_CLOSE_M = 1.0  # bolts that stand closer share the rock they hold


@study
def support(
    design: ADesign,
    fos: Annotated[Any, Option("The factor of safety that is wanted [what acceptance asks for, else 1.5].")] = None,
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
        Any, Option("Plunges that can be drilled, positive downward: -5,15 [0,30].", metavar="LEAST,MOST")
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
    >>> bolts = sk.support(sk.load(wedge), 1.7, acts="active").cases[0]
    >>> round(bolts.force), round(bolts.closed_form.fos, 6), round(bolts.pre_ie.fos, 6)
    (169428, 1.7, 1.7)
    """  # fmt: skip
    began = time.perf_counter()
    wanted = (design.accepted_fos or _WANTED) if fos is None else fos
    options = read_options(
        fos=wanted, acts=acts, toward=toward, plunge=plunge, bolt_capacity=bolt_capacity, spacing=spacing, bond=bond,
        length=length, named=desk.named,
    )  # fmt: skip
    if options.toward is None and options.plunge is None:
        options = replace(options, plunge=DRILLABLE_DEG)
    site = site_of(design)
    bare, bare_limit = site.closed_form(design), pre_ie(design)
    search = _SupportSearch(site, options, bare, bare_limit)
    stands = enough(options.target, bare, bare_limit, search.dilates)
    cases = () if stands else tuple(search.cases())
    weight = design.unit_weight_kn_m3 * site.block.volume
    return Support(
        design, options.target, options, bare, bare_limit, cases, None if stands else search.pressure(), weight,
        site.area, site.unit, tuple(_said(site, cases, options.target)), search.dilates,
        time.perf_counter() - began,
    )  # fmt: skip


def _said(site: Site, cases: Sequence[BoltCase], target: float) -> Iterator[Notice]:
    """What is to be known of the design, and what runs of it would say, as it stands and with the bolts."""
    design = site.design
    of_inputs = (*common_notices(design, kind_of(design).strengths(design)), *slips_of_size(design))
    yield from of_inputs
    yield from peak_only(design, "bolts are for the factor")
    yield from rules_left_out(design, ON_FACTOR)
    bare = factors_of(design)
    points, places = [Point(bare)], ["as it stands"]
    laid = [case for case in cases if case.bolts]
    besides = [] if laid else [(bare.also, places[0])]
    for case in laid:
        place = f"with the {case.acts} bolts"
        if case.factors is not None:
            points.append(Point(case.factors))
            places.append(place)
        besides.append((kind_of(design).without_basal(site.with_bolts(*case.bolts)), place))
    for also, place in dict.fromkeys(besides):
        yield from also_falls_short(also, target, place)
    yield from said_at(points, places.__getitem__, of_inputs, "designs")


def _need_of(way: Way, area: float = 1.0) -> Need:
    """What the closed form needs along a way, on each of so many m²."""
    force = None if way.force is None else way.force / area
    return Need(force, way.answer.factor, way.answer.status, way.below, notice=way.notice)


def _said_by(answer: Answer) -> str:
    """A factor, or the status that stands for none."""
    return answer.status.replace("_", " ") if answer.factor is None else f"FoS {answer.factor:.4f}"


class _Answers:
    """PRE-IE's answers to a design with more force, each asked once."""

    def __init__(self, changed: Callable[[float], Design]) -> None:
        self.changed = changed
        self._known: dict[float, Answer] = {}

    def __call__(self, force: float) -> Answer:
        if force not in self._known:
            self._known[force] = pre_ie(self.changed(force))
        return self._known[force]


class _SupportSearch:
    """One design at one target."""

    def __init__(self, site: Site, options: SupportOptions, bare: Answer, bare_limit: Answer) -> None:
        self.site, self.options, self.bare, self.bare_limit = site, options, bare, bare_limit
        self.target = options.target
        self.dilates = dilates(site.design)
        self.aim = self.target * (1.0 + AIM)
        self.factor = self.aim  # that the forces alone have to reach
        # what the forces alone need where they have the target already
        self.as_it_is = Need(0.0, bare.factor, bare.status) if bare.reaches(self.target) else None
        if self.as_it_is is not None:
            # they have it already, PRE-IE has not: ask them for as much more as it lacks, for a direction
            lacks = self.aim / bare_limit.search_level if bare_limit.search_level > 0.0 else 2.0
            self.factor = (bare.factor or self.aim) * max(lacks, 1.0 + AIM)

    def cases(self) -> list[BoltCase]:
        """Every case that was asked for."""
        return [self._case(*asked) for asked in self._requested_directions()]

    def _requested_directions(self) -> Iterator[tuple[BoltDirections, Which, Way | None]]:
        """The directions that were asked for, of bolts of each way to act."""
        goal, toward, plunges = self.factor / (1.0 + AIM), self.options.toward, self.options.plunge or DRILLABLE_DEG
        for acts in self.options.acts:
            ways = BoltDirections(self.site, self.factor, acts == "passive")
            if toward is not None:
                yield ways, "given", ways.along(self.site.axes @ toward.vector(), goal, self.bare)
            else:
                yield ways, "practical", ways.drillable(plunges, goal, self.bare)

    def _case(self, ways: BoltDirections, which: Which, way: Way | None) -> BoltCase:
        if way is None:
            nowhere = Need(None, None, self.bare.status, notice=self._nowhere(ways))
            return BoltCase(ways.acts, which, None, nowhere, None)
        line = self._line(which, way)
        own, stands = _need_of(way), self.as_it_is is not None
        closed = self.as_it_is or own
        if way.force is None:
            return BoltCase(ways.acts, which, line, closed, own if stands else None)
        root = self._least(_Answers(lambda force: self.site.with_bolts(ways.bolt(line, force))), way.force, way.most)
        limit = self._need(root, "through the centroid")
        most = None if math.isinf(way.most) or stands else way.most
        case = BoltCase(ways.acts, which, line, closed, limit, most, dilates=self.dilates)
        force = case.force or max(closed.force or 0.0, way.force)
        least = 0.0 if self.dilates else closed.force or 0.0
        pattern = self._pattern(ways, line, force, least, root.slope)
        case = replace(case, pattern=pattern)
        if not pattern.reached:  # one force through the centroid is none that can be built
            return replace(case, lacks=f"NOT REACHED, FoS {self.target:g}: {self._short_of_it(case)}")
        return self._checked(case, self._bolts(ways, line, pattern))

    def _checked(self, case: BoltCase, bolts: tuple[Bolt, ...]) -> BoltCase:
        """A case with its bolts as they are built, and what the design comes to when it is solved again with them."""
        factors = factors_of(self.site.with_bolts(*bolts))
        lacks = ""
        if not self._is_met(factors):
            answers = {"PRE-IE": limit_answer(factors), "the closed form": closed_form_answer(factors)}
            said = "; ".join(f"{_said_by(answer)} by {name}" for name, answer in answers.items() if answer is not None)
            lacks = f"NOT REACHED, FoS {self.target:g}: solved again with these bolts {said}"
        return replace(case, existing=self.site.design.bolts, bolts=bolts, factors=factors, lacks=lacks)

    def _is_met(self, factors: Factors) -> bool:
        """Whether a design that was solved again reaches the target by both methods, of dilating joints by PRE-IE."""
        return enough(self.target, closed_form_answer(factors), limit_answer(factors), self.dilates)

    def _short_of_it(self, case: BoltCase) -> str:
        """What is reached where bolts on the face do not give the target, and the codes that say why."""
        need = case.pattern.need if case.pattern is not None else None
        codes = ", ".join(dict.fromkeys(notice.code for notice in case.pattern.notices)) if case.pattern else ""
        if need is not None and need.force is None and need.fos is not None:
            return f"bolts on the face give FoS {need.fos:.4f} at best ({codes})"
        bare = self.bare_limit.factor
        return f"no bolts on the face give it ({codes}), without them {'no FoS' if bare is None else f'FoS {bare:.4f}'}"

    def _nowhere(self, ways: BoltDirections) -> Notice:
        if not ways.held.has_strength:
            return NO_STRENGTH
        low, high = self.options.plunge or (0.0, 0.0)
        return Notice("E322", f"no direction into the face that plunges {low:g} to {high:g}° reaches the target")

    # -- PRE-IE ---------------------------------------------------------------------------------------------

    def _least(self, ask: "_Answers", guess: float, most: float, slope: float | None = None) -> SearchResult:
        at_zero = self.bare_limit.search_level
        if self.bare_limit.reaches(self.target):
            return SearchResult(0.0, self.bare_limit, 0.0, None, None)
        within = min(WITHIN, 4e-7 / self.target)
        if slope is None:
            guess = min(guess * self._with_moments(), most)
            first = ask(guess).search_level
            near = self.bare_limit.moments_govern and abs(first / self.target - 1.0) < _NEAR
            if near and first > at_zero:
                slope = (first - at_zero) / guess
        return least_force(ask, self.target, within, guess, at_zero, most, slope)

    def _with_moments(self) -> float:
        """How much more force it takes where moments govern, if each level rises alike: 1 where they do not."""
        lacks, lacks_alone = self.target - self.bare_limit.search_level, self.target - self.bare.search_level
        if not self.bare_limit.moments_govern or not lacks_alone > 0.0:
            return 1.0
        return min(max(lacks / lacks_alone, 1.0), _MOST_WITH_MOMENTS)

    def _need(self, root: SearchResult, where: str) -> Need:
        answer, notice = root.answer, None
        if root.force is None:
            at = f"at best FoS {answer.search_level:.4g} at {root.best_force:.4g} {self.site.unit}"
            turning = "moments turn the block" if answer.moments_govern else "its limit lies below the closed form's"
            notice = Notice("E329", f"PRE-IE does not reach the target {where}: {turning}, {at}")
        elif root.below is not None:
            notice = Notice(
                "E325", f"FoS jumps over the target at {root.force:.6g} {self.site.unit}, from {root.below:.4g} to "
                f"{answer.search_level:.4g}: contact, or how the block moves, changes there"
            )  # fmt: skip
        return Need(root.force, answer.factor, answer.status, root.below, answer.moments_govern, answer.agree, notice)

    # -- heads on the face ------------------------------------------------------------------------------------

    def _pattern(self, ways: BoltDirections, line: Line, force: float, least: float, rate: float | None) -> Pattern:
        """Heads on the face for a force that is enough through the centroid, and what PRE-IE asks with them there.

        `least` is what the forces alone need, `rate` how the level rises with the force. Where the moments of the heads
        ask for another force the heads are laid out for that: more of them until they can take what they need, fewer if
        those can. The analysis of the bolts as they are built judges them.
        """
        options, site = self.options, self.site
        direction = site.local(line.vector())
        found: tuple[Layout, Floats, _Answers, SearchResult] | None = None
        kept, grows, wanted, first = found, False, force, None
        for _ in range(_LAYOUTS):
            laid = layout(site, direction, wanted, options.capacity, options.spacing)
            if isinstance(laid, Notice):
                if kept is None:
                    return Pattern(None, (laid,), asked=force, first=first)
                break
            if found is not None and np.array_equal(laid.heads_m, found[0].heads_m):
                heads, ask = found[1:3]
            else:
                heads, ask = self._in_groups(ways, line, direction, laid)
            first = ask(force).level if found is None else first
            root = self._least(ask, wanted, math.inf, rate)
            needed, found = root.force, (laid, heads, ask, root)
            if self._is_carried(laid, needed):
                kept = found
            if needed is None or (grows or needed > 0.9 * wanted if kept is found else kept is not None):
                break
            grows = grows or kept is None
            wanted, rate = needed, root.slope
        assert found is not None
        laid, heads, _, root = kept or found
        return self._laid_out(Pattern(laid, (), asked=force, first=first, groups=len(heads)), laid, root, least)

    def _in_groups(
        self, ways: BoltDirections, line: Line, direction: Floats, laid: Layout
    ) -> tuple[Floats, "_Answers"]:
        """Heads of the groups that PRE-IE takes, and its answers with the force spread over them."""
        heads, counts = groups(self.site, laid, direction, _MOST_GROUPS if ways.passive else 1)
        return heads, _Answers(self._with_heads(ways, line, direction, heads, counts))

    def _is_carried(self, laid: Layout, force: float | None) -> bool:
        """Whether bolts of a layout can take the force that PRE-IE asks with their heads."""
        slice_m = laid.across_m if self.site.in_section else 1.0
        return force is not None and force * slice_m <= self.options.capacity * len(laid) * (1.0 + 1e-6)

    def _laid_out(self, pattern: Pattern, laid: Layout, root: SearchResult, least: float) -> Pattern:
        """A pattern with its lengths, and whether those given are enough."""
        options, site = self.options, self.site
        need = self._need(root, "with the heads on the face")
        lengths = laid.sound_m + options.bond
        notices = [need.notice] if need.notice is not None else []
        apart = min([laid.across_m] + [laid.up_m] * (laid.rows > 1))
        if apart < _CLOSE_M and (len(laid) > 1 or site.in_section):
            message = f"bolts stand {apart:.2g} m apart: closer than {_CLOSE_M:g} m they hold the same rock"
            notices.append(Notice("W311", f"{message}; stronger bolts (--bolt-capacity) stand farther apart"))
        taken = np.ceil(lengths * 10.0 - 1e-9) / 10.0
        if options.length is not None:
            taken = np.full(len(laid), options.length)
            short = int((taken < lengths * (1.0 - 1e-12)).sum())
            message = f"{short} of {len(laid)} bolts are too short at {options.length:g} m"
            notices += [Notice("E212", f"{message}: the longest needs {lengths.max():.4g} m")] if short else []
        force = each = per_m2 = None
        if root.force is not None:
            force = max(root.force, least)  # with heads PRE-IE needs no less than the forces alone
            slice_m = laid.across_m if site.in_section else 1.0
            each = force * slice_m / len(laid)
            if each > options.capacity * (1.0 + 1e-6):
                message = f"{each:.6g} kN come to each bolt: with more of them the moments ask for more force again"
                notices.append(Notice("E328", message))
            each = built_force(each, options.capacity)
            per_m2 = each * len(laid) / slice_m / site.area
        return replace(
            pattern, layout=laid, notices=tuple(notices), force=force, each=each, lengths=lengths, taken=taken,
            per_m2=per_m2, need=need,
        )  # fmt: skip

    def _with_heads(
        self, ways: BoltDirections, line: Line, direction: Floats, heads: Floats, counts: Ints
    ) -> Callable[[float], Design]:
        """The design with a force spread over heads: active bolts are one force through their mean head."""
        shares = counts / counts.sum()
        if not ways.passive:
            middle = shares @ heads
            return lambda force: self.site.with_force(force * direction, middle)
        places = [self.site.place(head) for head in heads]

        def changed(force: float) -> Design:
            bolts = [
                Bolt(force * float(share), line, "passive", place) for share, place in zip(shares, places, strict=True)
            ]
            return self.site.with_bolts(*bolts)

        return changed

    def _bolts(self, ways: BoltDirections, line: Line, pattern: Pattern) -> tuple[Bolt, ...]:
        laid = pattern.layout
        assert laid is not None
        assert pattern.each is not None
        force = pattern.each / (laid.across_m if self.site.in_section else 1.0)
        return tuple(
            written(Bolt(force, line, ways.acts, (east, north, up), length))
            for (east, north, up), length in zip(laid.heads_m.tolist(), pattern.taken.tolist(), strict=True)
        )

    def _line(self, which: Which, way: Way) -> Line:
        """The direction as it was given, else as it was found."""
        return self.options.toward if which == "given" and self.options.toward else self.site.line(way.direction)

    # -- pressure -----------------------------------------------------------------------------------------------

    def pressure(self) -> FacePressure:
        """An even pressure on the face."""
        site, area = self.site, self.site.area
        ways = BoltDirections(site, self.factor, passive=False)
        way = ways.along(site.inward, self.factor / (1.0 + AIM), self.bare)
        middle = centre_of(site.face)
        place = site.place(middle)
        line = site.line(site.inward)
        own = _need_of(way, area)
        closed = self.as_it_is or own
        if way.force is None:
            return FacePressure(closed, own if self.as_it_is else None, area, line, place)
        root = self._least(_Answers(lambda force: site.with_force(force * site.inward, middle)), way.force, math.inf)
        need = self._need(root, "with the pressure on the face")
        if need.force is not None:
            need = replace(need, force=need.force / area)
        return FacePressure(closed, need, area, line, place, self.dilates)
