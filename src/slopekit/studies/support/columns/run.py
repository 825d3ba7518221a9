"""Toppling columns: the force on the toe column, or an anchor of the crest, that gives a wanted factor of safety.

Two ways side by side: Goodman & Bray's table with the force on one column (`anchor_force_required`), and PRE-IE with a
bolt on that column. The force acts on the outer side of its column: at the toe half way up, above the toe in the middle
of what stands out over the column below. Forces are per metre of slope.
"""

import math
import time
from dataclasses import replace

import numpy as np

from slopekit.closed_form.toppling import ColumnSlope, anchor_force_required, toppling_factor_of_safety, toppling_table
from slopekit.core.errors import DesignError, Fault, Faults, Notice
from slopekit.core.orientation import Line
from slopekit.design.parts import ON_FACTOR, Bolt
from slopekit.kinds import factors_of, kind_of, peak_only, slips_of_size
from slopekit.kinds.topple import ToppleDesign, column_slope, cut, not_taken, why_no_table
from slopekit.notices import common_notices
from slopekit.studies.points import rules_left_out
from slopekit.studies.support.columns.records import ByColumn, ColumnSupport, HoldingForce, Where
from slopekit.studies.support.records import Acts, Need, SupportOptions, enough, written
from slopekit.studies.support.search import AIM, WITHIN, Answer, least_force, limit_answer, pre_ie

INTO_SLOPE = Line(90.0, 0.0)  # columns fall toward -x: level, into the slope
_IN_SECTION = 1e-9
_ALL = 24  # of more columns the table is not asked for every one
_ALMOST_ALL = 1e3  # times the weight of the row: a force as good as endless


def support_of_columns(design: ToppleDesign, options: SupportOptions, began: float) -> ColumnSupport:
    """The forces on the toe column, the crest and the best column.

    Raises
    ------
    DesignError
        E387 rows of columns, E388 a direction out of the section, E389 options that columns do not have.
    """
    _refuse(design, options)
    search = _RowSearch(design, options)
    held = () if search.stands else tuple(search.held())
    notices = (*common_notices(design, kind_of(design).strengths(design)), *slips_of_size(design),
               *peak_only(design, "bolts are for the factor"), *rules_left_out(design, ON_FACTOR))  # fmt: skip
    return ColumnSupport(
        design, options.target, options, search.closed, search.bare, search.why_not, held,
        () if search.stands else search.by_column(), "kN/m", design.thickness_m,
        notices, time.perf_counter() - began,
    )  # fmt: skip


def _refuse(design: ToppleDesign, options: SupportOptions) -> None:
    faults = Faults()
    if design.rows > 1:
        advice = "Set columns.rows to 1: rows do not touch, each takes the same."
        faults.append(Fault("E387", f"support takes one row of columns, this design has {design.rows}", "", advice))
    if options.toward is not None and abs(options.toward.vector()[1]) > _IN_SECTION:
        line = f"{options.toward.trend_deg:g}/{options.toward.plunge_deg:g}"
        message = f"the direction {line} leaves the section of the columns, which runs east to west"
        faults.append(Fault("E388", message, "", "090/10 is into the slope and 10° downward; 090/00 where left out."))
    given = {"plunge": options.plunge, "spacing": options.spacing, "length": options.length}
    for name in [name for name, value in given.items() if value is not None]:
        advice = "Columns take toward, acts and bolt_capacity."
        faults.append(Fault("E389", f"{name} is for bolts on the face of a wedge or a plane", "", advice))
    faults.refuse()


class _RowSearch:
    """One row of columns at one target."""

    def __init__(self, design: ToppleDesign, options: SupportOptions) -> None:
        self.design, self.options, self.target = design, options, options.target
        factors = factors_of(design)
        self.bare = limit_answer(factors)
        self.why_not = why_no_table(design)
        self.slope: ColumnSlope | None = None
        self.closed: Answer | None = None
        self._columns: tuple[ByColumn, ...] | None = None
        if not self.why_not:
            try:
                self.slope = column_slope(design)
            except DesignError as error:
                self.why_not = not_taken(error)
        if self.slope is not None:
            closed = toppling_factor_of_safety(self.slope)
            self.closed = Answer(closed.factor, "no_driving_force" if closed.factor is None else closed.status)
        self.stands = enough(self.target, self.closed, self.bare)
        self.line = options.toward or INTO_SLOPE
        east, _, up = self.line.vector()
        self.plunge = math.degrees(math.atan2(-up, east))

    # -- where ------------------------------------------------------------------------------------------

    def height(self, column: int) -> float:
        """Where a force acts on a column (0: the toe): the middle of what stands out over the one below, m."""
        heights, step = self.design.heights_m, self.design.base_step_m
        covered = max(heights[column - 1] - step, 0.0) if column else 0.0
        return 0.5 * (min(covered, heights[column]) + heights[column])

    def at(self, column: int) -> tuple[float, float, float]:
        """That point."""
        dip = math.radians(90.0 - self.design.dip_deg)
        along, up = column * self.design.width_m, column * self.design.base_step_m + self.height(column)
        x, z = along * math.cos(dip) - up * math.sin(dip), along * math.sin(dip) + up * math.cos(dip)
        scene = cut(self.design)
        middle = float((scene.assembly.centroids[column] + scene.origin)[1])
        return float(x + scene.origin[0]), middle, float(z + scene.origin[2])

    def places(self) -> list[tuple[Where, int]]:
        """The toe, the crest, and the column that needs least, each once."""
        places: list[tuple[Where, int]] = [("toe", 0)]
        crest = int(np.argmax(self.design.heights_m))
        if crest:
            places.append(("crest", crest))
        able = [(one.force, k) for k, one in enumerate(self.by_column()) if one.force]
        if able and min(able)[1] not in (0, crest):
            places.append(("least", min(able)[1]))
        return places

    # -- Goodman & Bray -----------------------------------------------------------------------------------

    def pulled(self, slope: ColumnSlope, column: int, force: float = 0.0) -> ColumnSlope:
        return replace(
            slope, toe_force_kn=force, toe_force_plunge_deg=self.plunge, toe_force_height_m=self.height(column),
            force_column=column + 1,
        )  # fmt: skip

    def by_column(self) -> tuple[ByColumn, ...]:
        """The table's force on each column by itself."""
        if self._columns is not None:
            return self._columns
        if self.slope is None or len(self.design.heights_m) > _ALL:
            return ()
        forces = [self.force_on(self.slope, k) for k in range(len(self.design.heights_m))]
        self._columns = tuple(
            ByColumn(self.design.block_names[k], self.height(k), force if math.isfinite(force) else None)
            for k, force in enumerate(forces)
        )
        return self._columns

    def force_on(self, slope: ColumnSlope, column: int) -> float:
        return anchor_force_required(self.pulled(slope, column), self.target * (1.0 + AIM))

    def by_table(self, column: int, acts: Acts) -> tuple[Need | None, tuple[Notice, ...]]:
        """What the table asks of a column, put back; the pull of a passive anchor is divided by the factor."""
        if self.slope is None or self.closed is None:
            return None, ()
        name = self.design.block_names[column]
        if self.closed.reaches(self.target):
            return Need(0.0, self.closed.factor, self.closed.status), ()
        force = self.force_on(self.slope, column)
        endless = not math.isfinite(force)
        try:
            weight = self.slope.unit_weight_kn_m3 * self.slope.width_m * sum(self.design.heights_m)
            held = self.pulled(self.slope, column, _ALMOST_ALL * weight if endless else force)
            closed = toppling_factor_of_safety(held)
            table = toppling_table(held, self.target)
        except DesignError as error:
            return Need(None, None, self.closed.status), (Notice("E390", f"{name}: {error.faults[0].message}"),)
        if endless:
            best = "" if closed.factor is None else f": at best FoS {closed.factor:.4g}"
            why = "those below it topple or slide by themselves" if column else "it is not held in that direction"
            message = f"no force on {name} reaches the target by Goodman & Bray, {why}{best}"
            return Need(None, closed.factor, closed.status), (Notice("E390", message),)
        lifted = [self.design.block_names[k] for k in np.flatnonzero(~table.base_holds)[:5]]
        notices = () if not lifted else (
            Notice("W445", f"with {name} held Goodman & Bray's forces are not admissible at {', '.join(lifted)}"),
        )  # fmt: skip
        times = self.target if acts == "passive" else 1.0
        return Need(times * force, closed.factor, closed.status), notices

    # -- PRE-IE -------------------------------------------------------------------------------------------

    def held(self) -> list[HoldingForce]:
        """Each way to act, each column."""
        return [self.one(acts, where, column) for acts in self.options.acts for where, column in self.places()]

    def bolt(self, acts: Acts, column: int, force: float) -> Bolt:
        thick = force * self.design.thickness_m
        return Bolt(thick, self.line, acts, self.at(column), None, self.design.block_names[column])

    def one(self, acts: Acts, where: Where, column: int) -> HoldingForce:
        """Both methods on one column."""
        closed, notices = self.by_table(column, acts)
        name = self.design.block_names[column]
        limit, said = self.by_pre_ie(acts, column, None if closed is None else closed.force)
        held = HoldingForce(
            acts, name, where, self.height(column), self.at(column), self.line, closed, limit, None, (*notices, *said)
        )
        use = held.use_kn
        return replace(held, bolt=written(self.bolt(acts, column, use))) if use else held

    def by_pre_ie(self, acts: Acts, column: int, guess: float | None) -> tuple[Need, tuple[Notice, ...]]:
        """The least force on a column at which PRE-IE gives the target."""
        if self.bare.reaches(self.target):
            return Need(0.0, self.bare.factor, self.bare.status), ()
        design, weight = self.design, self.design.unit_weight_kn_m3 * self.design.width_m * sum(self.design.heights_m)

        def ask(force: float) -> Answer:
            return pre_ie(replace(design, bolts=(*design.bolts, self.bolt(acts, column, force))))

        within = min(WITHIN, 4e-7 / self.target)
        start = guess or 0.1 * weight
        at_zero = self.bare.search_level
        upward = None if guess else [start * factor for factor in (3.0, 10.0, 100.0)]
        root = least_force(ask, self.target, within, start, at_zero, math.inf, upward=upward)
        answer = root.answer
        if root.force is None:
            best = f"at best FoS {answer.search_level:.4g} at {root.best_force:.4g} kN/m"
            message = f"PRE-IE does not reach the target by a force on {design.block_names[column]}: {best}"
            return Need(None, answer.factor, answer.status), (Notice("E329", message),)
        said: tuple[Notice, ...] = ()
        if root.below is not None:
            jump = f"from {root.below:.4g} to {answer.search_level:.4g}"
            message = f"FoS jumps over the target at {root.force:.6g} kN/m, {jump}"
            said = (Notice("E325", f"{message}: the way the columns move changes there"),)
        return Need(root.force, answer.factor, answer.status, root.below), said
