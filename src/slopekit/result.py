"""The result of an analysis: value, status and evidence, and its JSON (a contract: keys never change)."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit._version import FORMAT, __version__
from slopekit.block_scene import BlockScene, Sizes
from slopekit.core.codec import json_of
from slopekit.core.errors import Notice
from slopekit.core.shown import Shown
from slopekit.design.common import Design
from slopekit.design.parts import Rule
from slopekit.evidence import (
    Comparisons,
    Displacements,
    FactorsOfSafety,
    Forces,
    LimitState,
    ModelSize,
    Movement,
    ReductionStep,
)
from slopekit.extents import Geometry

if TYPE_CHECKING:
    from slopekit.core.sheet import Column, Sheet, Table
    from slopekit.elastic.outcome import ElasticBlocks
    from slopekit.findings import Findings, Mechanism
    from slopekit.preie.motion.all_pairs import AllPairsFailed

#: Every status a block can have, as a sentence.
STATUSES: Mapping[str, str] = {
    "slides_on_both": "slides on both planes",
    "slides_on_J1": "slides on J1, J2 has lost contact",
    "slides_on_J2": "slides on J2, J1 has lost contact",
    "slides_on_J1_and_J2": "slides on J1 and J2, off the basal joint",
    "slides_on_J1_and_basal": "slides on J1 and the basal joint, J2 has lost contact",
    "slides_on_J2_and_basal": "slides on J2 and the basal joint, J1 has lost contact",
    "slides_on_basal": "slides on the basal joint, J1 and J2 have lost contact",
    "slides_up": "slides up the slope: the loads drive it upward",
    "slides": "slides",
    "rotates": "turns while it slides",
    "topples": "topples: where its joints open, nothing is left to hold it",
    "lifted": "contact lost on both planes (uplift)",
    "falls": "falls: nothing lies under it",
    "no_driving_force": "stands: nothing drives it",
    "not_converged": "the analysis did not converge: no number",
}


@dataclass(frozen=True)
class Words:
    """What a kind of design calls things.

    Attributes
    ----------
    title : the kind in a few words; block : what moves
    seismic : the way a seismic load acts where the design gives no trend
    closed_form : what it is called; rests_on : its source or assumption; both "" where the kind has none
    statuses : those that are not as in `STATUSES`
    no_closed_form : why there is none for a design
    assumes : what the limit takes for granted beside PRE-IE
    horizontal : the way that movements are told in
    along : the status says toward where the block slides; turns : it is asked whether the block turns first
    variants : of designs that have the input of that name
    """

    title: str
    block: str
    seismic: str
    closed_form: str
    rests_on: str
    statuses: Mapping[str, str]
    no_closed_form: str = "there is none here (see NOTE)"
    assumes: str = ""
    horizontal: str = "horizontal"
    along: bool = False
    turns: bool = True
    variants: "Mapping[str, Words]" = field(default_factory=dict)

    def of(self, inputs: Mapping[str, Any]) -> "Words":
        """What it calls a design with these inputs."""
        return next((words for key, words in self.variants.items() if inputs.get(key) is not None), self)

    def status(self, status: str) -> str:
        """A status as a sentence."""
        return self.statuses.get(status, STATUSES[status])


#: The closed forms of columns by the names that results and rules have for them, as sheets call them.
METHODS: Mapping[str, str] = {
    "fellenius": "Fellenius", "janbu": "Janbu (simplified)", "bishop": "Bishop (simplified)",
}  # fmt: skip
#: Numbers that a rule may judge in place of the limit, in few words.
JUDGED: Mapping[str, str] = {
    "residual": "residual strength",
    "lowest": "lowest", "highest": "highest", "all_pairs_failed": "all pairs failed", "closed_form": "closed form",
    "static_bound": "upper bound", "whole_wedge": "whole wedge, without the basal joint",
    **METHODS,
}  # fmt: skip
_SAME = 5e-5  # factors that differ by less than this part look the same


@dataclass(frozen=True, repr=False)
class Result(Shown):
    """One analysed block. `to_dict()` is the JSON of `slopekit wedge --json` and `slopekit run --json`.

    `difference` and `agree` hold PRE-IE against the closed form, forces with forces; `moments_govern`: the limit lies
    below what forces alone give. `findings` are those of many blocks.
    """

    name = "result"
    text_name = "sheet"
    design: Design
    words: Words
    status: str
    fos: FactorsOfSafety
    difference: float | None
    agree: bool | None
    moments_govern: bool
    geometry: Geometry
    forces: Forces
    model: ModelSize
    warnings: tuple[Notice, ...]
    limit_state: LimitState = field(repr=False)
    displacements: Displacements
    comparisons: Comparisons
    findings: "Findings | None" = None
    timing_s: Mapping[str, float] = field(default_factory=dict, compare=False)

    @property
    def methods(self) -> Mapping[str, float | None]:
        """The factors of other closed forms of the kind (columns) by name; None where one has no answer."""
        return self.comparisons.methods

    @property
    def elastic(self) -> "ElasticBlocks | None":
        """What elastic blocks do, where they were asked for."""
        return self.comparisons.elastic

    @property
    def all_pairs(self) -> "AllPairsFailed | None":
        """The search for the factor at which all pairs have failed, where it was asked for."""
        return self.displacements.all_pairs

    @property
    def series(self) -> tuple[ReductionStep, ...]:
        """The displacements along the factors that the design asks for."""
        return self.displacements.series

    @property
    def kind(self) -> str:
        """The kind of design."""
        return self.design.kind

    @property
    def status_text(self) -> str:
        """The status as a sentence, in the user's own names of joints."""
        return self.design.in_own_names(self.words.status(self.status))

    @property
    def criterion_fos(self) -> float | None:
        """The factor that acceptance is held against: the limit, or the lower of it and the all-pairs factor."""
        limit = self.fos.limit
        if self.design.analysis.criterion == "limit" or limit is None:
            return limit
        return None if self.fos.all_pairs_failed is None else min(limit, self.fos.all_pairs_failed)

    @property
    def leading(self) -> tuple[str, float] | None:
        """The number that acceptance hangs on where it lies below the limit, and its name; it leads, not the limit.

        Of several rules it is that of the one nearest to being broken, or broken the most.
        """
        limit = self.fos.limit
        judged = [
            (value / max(rule.value, 1e-9), value, rule)
            for rule in self.design.rules
            if rule.relation in (">=", ">") and (value := self.value_of(rule)) is not None
        ]
        if not judged or limit is None:
            return None
        _, value, rule = min(judged, key=lambda one: one[:2])
        name, whole = self.name_of(rule), self.comparisons.without_basal
        if whole is not None and whole.factor is not None and whole.factor < value and rule.is_least:
            name, value = whole.NAME, whole.factor
        return (name, value) if value < limit * (1.0 - _SAME) else None

    def judged(self, rule: Rule) -> bool:
        """Whether the result meets a rule; what stands without strength meets every least factor of safety.

        A block whose basal joint cuts the toe off a larger wedge meets none that this one breaks.
        """
        if self._breaks_whole(rule):
            return False
        if self.status == "no_driving_force" and rule.relation in (">=", ">"):
            return True
        if self.status == "not_converged" or self.agree is False:
            return False  # a number that the two methods dispute is no reason to accept
        return rule.met(self.value_of(rule))

    def name_of(self, rule: Rule) -> str:
        """The number that a rule judges: one of `fos`, or of `methods`, or residual.

        A bare `fos` is the limit, and by the criterion of all pairs the lower of it and the factor of that.
        """
        _, _, name = rule.name.partition(".")
        limit, pairs = self.fos.limit, self.fos.all_pairs_failed
        by_pairs = self.design.analysis.criterion == "all-pairs" and (limit is None or pairs is None or pairs < limit)
        return name or ("all_pairs_failed" if by_pairs else "limit")

    def value_of(self, rule: Rule) -> float | None:
        """The number that a rule judges, None where there is none."""
        _, _, name = rule.name.partition(".")
        if not name:
            return self.criterion_fos
        if name == "residual":
            residual = self.comparisons.residual
            return None if residual is None else residual.limit
        return self.comparisons.methods.get(name) if name in METHODS else getattr(self.fos, name)

    @property
    def accepted(self) -> bool | None:
        """Whether every acceptance rule is met; None where there is none."""
        return all(self.judged(rule) for rule in self.design.rules) if self.design.rules else None

    @property
    def margin(self) -> float | None:
        """The number that acceptance hangs on over what it asks (1 without a rule); 0 without one, inf at rest."""
        least, whole = [rule for rule in self.design.rules if rule.is_least], self.comparisons.without_basal
        most = float("inf")
        if whole is not None and whole.factor is not None:
            most = min((whole.factor / max(rule.value, 1e-9) for rule in least), default=whole.factor)
        if self.status == "no_driving_force":
            return most
        judged = [(self.value_of(rule) or 0.0) / max(rule.value, 1e-9) for rule in least]
        return min(most, min(judged, default=self.criterion_fos or 0.0))

    def case_columns(self) -> "list[Column[Any]]":
        """What a table over load cases has of each."""
        from operator import attrgetter

        from slopekit.core.sheet import Column, factor_text

        def word(value: bool | None) -> str:
            return {True: "yes", False: "NO", None: ""}[value]

        def factor(value: float | None) -> str:
            return factor_text(value).strip()

        def elastic(result: Result) -> float | None:
            blocks = result.comparisons.elastic
            return None if blocks is None else blocks.limit

        of_elastic: list[Column[Any]] = [Column("elastic", elastic, "elastic_limit", show=factor, width=9)]
        return [
            Column("FoS", attrgetter("fos.limit"), "fos_limit", show=factor, width=8),
            *([] if self.comparisons.elastic is None else of_elastic),
            Column("closed form", attrgetter("fos.closed_form"), "fos_closed_form", show=factor, width=13),
            Column("agree", attrgetter("agree"), "agree", show=word, width=7),
            Column("asks", lambda of: ", ".join(str(rule) for rule in of.design.rules), "rules"),
            Column("accepted", attrgetter("accepted"), "accepted", show=word, width=10),
            Column("  status", attrgetter("status"), "status", width=-1, about="  {}"),
        ]

    @property
    def met_by_peak_only(self) -> bool:
        """Whether a rule on the limit is met that the residual factor would break."""
        left = self.comparisons.residual
        if left is None or left.status == "no_driving_force":
            return False
        return any(
            self.judged(rule) and not rule.met(left.limit)
            for rule in self.design.rules if rule.is_on_factor and rule.is_least
        )  # fmt: skip

    @property
    def exit_code(self) -> int:
        """0 done, 1 criterion not met, 4 the methods disagree or no convergence."""
        if self.status == "not_converged" or self.agree is False:
            return 4
        return 1 if self.accepted is False else 0

    @property
    def line(self) -> str:
        """Status, factor, what governs and the check: never a bare factor of safety."""
        text: str = import_module("slopekit.kinds.sheets.shared").line_of(self)  # as the sheet
        return text

    @property
    def sheet(self) -> "Sheet":
        """One design on one screen, made when it is asked for."""
        # kinds, which know how each says what it is, are a floor above; asked for by name, and only here
        result_sheet: Sheet = import_module("slopekit.kinds.sheets.result").sheet_of(self)
        return result_sheet

    def view(self) -> Any:
        """The scene as a widget of a notebook that turns (extra: notebook).

        Raises
        ------
        DesignError
            E140 without the extra.
        """
        return import_module("slopekit.app.notebook").view_of(self)  # floors above, as the sheet

    def tables(self) -> dict[str, "Table[Any]"]:
        """Its tables by name: first, in one row, the numbers that it leads with."""
        from operator import attrgetter

        from slopekit.core.sheet import Column, Table

        columns: list[Column[Result]] = [Column(name, attrgetter(name), name) for name in ("kind", "status")]
        columns += [Column(one.name, attrgetter(f"fos.{one.name}"), f"fos_{one.name}") for one in fields(self.fos)]
        columns += [
            Column(name, attrgetter(name), name)
            for name in ("criterion_fos", "difference", "agree", "moments_govern", "accepted")
        ]
        columns += [
            Column("volume", attrgetter("geometry.volume_m3"), "volume_m3", "m³"),
            Column("weight", attrgetter("forces.weight"), "weight_kn", "kN"),
            Column("mass", attrgetter("mass_t"), "mass_t", "t"),
        ]
        columns += [
            Column(name, attrgetter(f"size.{key}_m") if self.size is not None else lambda _: None, f"{key}_m", "m")
            for name, key in (("height", "height"), ("face width", "face_width"), ("setback", "setback"))
        ]
        return {self.name: Table(columns, [self]), **Shown.tables(self)}

    @property
    def size(self) -> Sizes | None:
        """Of what fails, of many blocks first; None where it was not measured."""
        if self.findings is None:
            return getattr(self.geometry, "sizes", None)
        return None if self.findings.first is None else self.findings.first.size

    @property
    def mechanisms(self) -> "tuple[Mechanism, ...]":
        """The mechanisms in the order in which they fail, of a block above a basal joint with the whole wedge."""
        if self.findings is not None:
            return self.findings.mechanisms
        whole = self.comparisons.without_basal
        if whole is None:
            return ()
        from slopekit.findings import Mechanism  # few wedges have a basal joint

        size = self.size and replace(self.size, volume_m3=self.geometry.volume_m3, mass_t=self.mass_t)
        block, closed = (self.words.block,), whole.closed_form
        above = Mechanism(self.status, self.fos.limit, block, basis="limit", size=size, role="block_above_basal")
        return above, Mechanism(whole.status, closed, ("whole wedge",), basis="closed_form", role="whole_wedge")

    @property
    def mass_t(self) -> float:
        """Mass of what may move, t."""
        return self.forces.weight / self.design.rock.gravity_m_s2

    @property
    def scene(self) -> BlockScene:
        """The blocks, interfaces, node pairs and movements, for pictures and files of other programs."""
        shapes, state = self.geometry.shapes(self.words.block), self.limit_state
        count = len(shapes.names)
        velocity, order, factor = np.zeros((count, 6)), np.zeros(count, dtype=np.int64), np.full(count, np.nan)
        displacement, settled = None, self.displacements.at_factor_one
        if self.findings is not None:
            index = {name: k for k, name in enumerate(shapes.names)}
            number, reached = 0, np.nan  # a block that only the one before it held fails together with it
            for row in self.findings.mechanisms:
                at = [index[name] for name in row.blocks]
                if row.role != "chip":
                    number += 1
                    velocity[at], order[at] = np.hstack([row.displacement, row.rotation]), number
                if row.status != "not_converged":
                    reached = factor[at] = np.fmax(reached, np.nan if row.fos is None else row.fos)
            if settled is not None and settled.every is not None:
                displacement = np.zeros((count, 6))
                displacement[: len(settled.every)] = settled.every
        else:
            if self.limit_state.mechanism is not None:
                velocity[0], order[0] = self.limit_state.mechanism.vector(), 1
            if self.fos.limit is not None:
                factor[0] = self.fos.limit
            if settled is not None:
                displacement = settled.movement.vector()[None, :]
        bolts = None
        if self.design.bolts:  # most designs have none: they load nothing of it
            from slopekit.bolts import placed

            bolts = placed(self.design.bolts, shapes)
        return BlockScene(shapes, state.node_pairs, state.acting, velocity, order, factor, displacement, bolts)

    def _breaks_whole(self, rule: Rule) -> bool:
        """Whether the whole wedge without a basal joint breaks a rule."""
        whole = self.comparisons.without_basal
        return whole is not None and not whole.meets(rule)

    def _rule(self, rule: Rule) -> dict[str, Any]:
        """A rule with the number that it judged, null where there is none."""
        value = self.value_of(rule)
        name = None if value is None else self.name_of(rule)
        whole = self.comparisons.without_basal
        if whole is not None and self._breaks_whole(rule):
            name, value = whole.NAME, whole.factor
        return {"rule": str(rule), "met": self.judged(rule), "judged": name, "fos": json_of(value)}

    def _mechanism(self) -> dict[str, Any] | None:
        if self.findings is not None:
            first = self.findings.first
            if first is None or not first.blocks:
                return None
            row = first.to_dict()
            return {
                name: row[name] for name in ("blocks", "how", "displacement", "rotation", *(json_of(first.size) or ()))
            }
        moves = self.limit_state.mechanism
        return None if moves is None else {"blocks": [self.words.block], **json_of(moves)}

    def _displacements(self) -> dict[str, Any]:
        """At full strength, by the criterion of all pairs, and along the series of factors."""
        full, pairs = self.displacements.at_factor_one, self.displacements.all_pairs
        return {
            "at_factor_one": None if full is None else {
                **_moved(full.movement), "failed_pairs": full.failed_pairs, "residual": full.residual,
                "block": full.block,
            },
            "all_pairs": None if pairs is None else {
                "bracket": json_of(pairs.bracket),
                "lost_equilibrium": pairs.lost_equilibrium,
                "history": [
                    {"factor": factor, "failed_pairs": count} for factor, count in sorted(pairs.history)
                ],
            },
            "series": [
                {"factor": one.factor, "stands": one.stands, "failed_pairs": one.failed_pairs, **_moved(one.movement)}
                for one in self.displacements.series
            ],
        }  # fmt: skip

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON values."""
        state, beside = self.limit_state, self.comparisons
        return {
            "slopekit": __version__,
            "format": FORMAT,
            "kind": self.kind,
            "title": self.design.title,
            **self.design.beside(),
            "input_sha256": self.design.input_hash(),
            "status": self.status,
            "status_text": self.status_text,
            "fos": json_of(self.fos),
            **({} if self.leading is None else {"leading": dict(zip(("name", "fos"), self.leading, strict=True))}),
            "difference": self.difference,
            "agree": self.agree,
            "moments_govern": self.moments_govern,
            "openings": json_of(state.openings),
            **({"curved_strength": json_of(state.curved_strength)} if state.curved_strength else {}),
            **({} if beside.residual is None else {"residual": json_of(beside.residual)}),
            **({"mechanisms": json_of(self.mechanisms)} if self.mechanisms else {}),
            **({} if beside.elastic is None else {"elastic": json_of(beside.elastic)}),
            "methods": dict(beside.methods),
            "accepted": self.accepted,
            "rules": [self._rule(rule) for rule in self.design.rules],
            "geometry": json_of(self.geometry) | {"mass_t": self.mass_t},
            "forces_kn": json_of(self.forces),
            "model": json_of(self.model),
            "balance": json_of(state.balance),
            "mechanism": self._mechanism(),
            **self._displacements(),
            "assembly": json_of(self.findings),
            "governs": [{"change": name, "fos": fos, "status": status} for name, fos, status in beside.governs],
            "inputs": self.design.inputs(),
            "assumed": dict(self.design.assumed),
            "defaults": list(self.design.reading.defaults),
            "warnings": [notice.to_dict() for notice in self.warnings],
            "timing_s": dict(self.timing_s),
            "scene": self.scene.to_dict(),
            "sheet": self.sheet.to_dict(),
        }  # fmt: skip


def _moved(movement: Movement | None) -> dict[str, Any]:
    """How a block has moved, as JSON values; null where it is not known."""
    return {
        "displacement_m": None if movement is None else movement.displacement.tolist(),
        "rotation_rad": None if movement is None else movement.rotation.tolist(),
    }
