"""The result of an analysis: value, status and evidence, and its JSON, whose keys never change."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from importlib import import_module
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from slopekit._version import FORMAT, __version__
from slopekit.block_scene import BlockScene, Sizes
from slopekit.core.codec import json_of
from slopekit.core.errors import Notice
from slopekit.core.report import Report
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
    """The vocabulary of a kind of design, as sheets and notices print it.

    Attributes
    ----------
    title : the kind in a few words; block : the name of the moving block
    seismic : direction of a seismic load without a trend
    closed_form : name of the closed form; rests_on : its source or assumption; both "" where the kind has none
    statuses : sentences that differ from `STATUSES`
    no_closed_form : why a design has no closed form
    assumes : assumptions of the limit in addition to those of PRE-IE
    horizontal : the horizontal direction in which movements are printed
    along : whether the status says the sliding direction; turns : whether rotation of the block is checked
    variants : vocabularies of designs that have the input of that name
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

    def for_inputs(self, inputs: Mapping[str, Any]) -> "Words":
        """Return the vocabulary of a design with these inputs."""
        return next(
            (words for key, words in self.variants.items() if inputs.get(key) is not None), self
        )

    def status(self, status: str) -> str:
        """Return a status as a sentence."""
        return self.statuses.get(status, STATUSES[status])


#: The closed forms of columns by the names that results and rules have for them, as sheets call them.
METHODS: Mapping[str, str] = {
    "fellenius": "Fellenius",
    "janbu": "Janbu (simplified)",
    "bishop": "Bishop (simplified)",
}
#: Quantities that an acceptance rule may judge in place of the limit, by key, in words.
RULE_QUANTITIES: Mapping[str, str] = {
    "residual": "residual strength",
    "lowest": "lowest",
    "highest": "highest",
    "all_pairs_failed": "all pairs failed",
    "closed_form": "closed form",
    "static_bound": "upper bound",
    "whole_wedge": "whole wedge, without the basal joint",
    **METHODS,
}
_EQUAL_FACTORS = 5e-5  # factors that differ by less than this part look the same


@dataclass(frozen=True, repr=False)
class Result(Report):
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
        """The result of the elastic blocks, None where the analysis has rigid blocks only."""
        return self.comparisons.elastic

    @property
    def all_pairs(self) -> "AllPairsFailed | None":
        """The search for the factor at which all node pairs have failed; None where the design does not ask for it."""
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
        """The status as a sentence, with the user's names of the joints."""
        return self.design.in_own_names(self.words.status(self.status))

    @property
    def criterion_fos(self) -> float | None:
        """The factor of safety that acceptance judges: the limit, or the lower of limit and all-pairs factor."""
        limit = self.fos.limit
        if self.design.analysis.criterion == "limit" or limit is None:
            return limit
        return None if self.fos.all_pairs_failed is None else min(limit, self.fos.all_pairs_failed)

    @property
    def leading(self) -> tuple[str, float] | None:
        """The name and value of the governing factor of acceptance where it lies below the limit, else None.

        Of several rules the governing one is that with the lowest ratio of value to required value.
        """
        limit = self.fos.limit
        ratings = [
            (value / max(rule.value, 1e-9), value, rule)
            for rule in self.design.rules
            if rule.relation in (">=", ">") and (value := self.value_of(rule)) is not None
        ]
        if not ratings or limit is None:
            return None
        _, value, rule = min(ratings, key=lambda rating: rating[:2])
        name, whole_wedge = self.name_of(rule), self.comparisons.without_basal
        if (
            whole_wedge is not None
            and whole_wedge.factor is not None
            and whole_wedge.factor < value
            and rule.is_least
        ):
            name, value = whole_wedge.NAME, whole_wedge.factor
        return (name, value) if value < limit * (1.0 - _EQUAL_FACTORS) else None

    def meets(self, rule: Rule) -> bool:
        """Return whether the result meets an acceptance rule.

        A block that is stable without strength meets every least factor of safety. A block above a basal joint meets a
        rule only if the whole wedge below its crest meets it too.
        """
        if self._whole_wedge_breaks(rule):
            return False
        if self.status == "no_driving_force" and rule.relation in (">=", ">"):
            return True
        if self.status == "not_converged" or self.agree is False:
            return False  # a number that the two methods dispute is no reason to accept
        return rule.is_met_by(self.value_of(rule))

    def name_of(self, rule: Rule) -> str:
        """Return the name of the quantity that a rule judges: a field of `fos`, a key of `methods`, or residual.

        A bare `fos` is the limit, and under the criterion of all pairs the lower of the limit and the all-pairs factor.
        """
        _, _, name = rule.name.partition(".")
        limit, pairs = self.fos.limit, self.fos.all_pairs_failed
        by_pairs = self.design.analysis.criterion == "all-pairs" and (
            limit is None or pairs is None or pairs < limit
        )
        return name or ("all_pairs_failed" if by_pairs else "limit")

    def value_of(self, rule: Rule) -> float | None:
        """Return the number that a rule judges, None where there is none."""
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
        return all(self.meets(rule) for rule in self.design.rules) if self.design.rules else None

    @property
    def margin(self) -> float | None:
        """The lowest ratio of judged to required factor (1 without a rule); 0 without a factor, inf if stable."""
        least, whole_wedge = (
            [rule for rule in self.design.rules if rule.is_least],
            self.comparisons.without_basal,
        )
        most = float("inf")
        if whole_wedge is not None and whole_wedge.factor is not None:
            most = min(
                (whole_wedge.factor / max(rule.value, 1e-9) for rule in least),
                default=whole_wedge.factor,
            )
        if self.status == "no_driving_force":
            return most
        ratios = [(self.value_of(rule) or 0.0) / max(rule.value, 1e-9) for rule in least]
        return min(most, min(ratios, default=self.criterion_fos or 0.0))

    def case_columns(self) -> "list[Column[Any]]":
        """Return the columns of a table over load cases, one result a row."""
        from slopekit.core.sheet import Column, factor_text

        def word(value: bool | None) -> str:
            return {True: "yes", False: "NO", None: ""}[value]

        def factor(value: float | None) -> str:
            return factor_text(value).strip()

        def elastic(result: Result) -> float | None:
            blocks = result.comparisons.elastic
            return None if blocks is None else blocks.limit

        elastic_column: list[Column[Any]] = [
            Column("elastic", elastic, "elastic_limit", show=factor, width=9)
        ]
        return [
            Column("FoS", attrgetter("fos.limit"), "fos_limit", show=factor, width=8),
            *([] if self.comparisons.elastic is None else elastic_column),
            Column(
                "closed form",
                attrgetter("fos.closed_form"),
                "fos_closed_form",
                show=factor,
                width=13,
            ),
            Column("agree", attrgetter("agree"), "agree", show=word, width=7),
            Column(
                "asks",
                lambda case_result: ", ".join(str(rule) for rule in case_result.design.rules),
                "rules",
            ),
            Column("accepted", attrgetter("accepted"), "accepted", show=word, width=10),
            Column("  status", attrgetter("status"), "status", width=-1, about="  {}"),
        ]

    @property
    def met_by_peak_only(self) -> bool:
        """Whether a rule on the limit is met that the factor on residual strength breaks."""
        residual = self.comparisons.residual
        if residual is None or residual.status == "no_driving_force":
            return False
        return any(
            self.meets(rule) and not rule.is_met_by(residual.limit)
            for rule in self.design.rules
            if rule.is_on_factor and rule.is_least
        )

    @property
    def exit_code(self) -> int:
        """0 done, 1 criterion not met, 4 the methods disagree or no convergence."""
        if self.status == "not_converged" or self.agree is False:
            return 4
        return 1 if self.accepted is False else 0

    @property
    def line(self) -> str:
        """The result on one line: status, factor, what governs and the check; never a bare factor of safety."""
        text: str = import_module("slopekit.kinds.sheets.shared").line_of(self)  # as the sheet
        return text

    @property
    def sheet(self) -> "Sheet":
        """The sheet of the result, one design on one screen; made on access."""
        # the package kinds lies above this module: it is imported by name, and only here
        result_sheet: Sheet = import_module("slopekit.kinds.sheets.result").sheet_of(self)
        return result_sheet

    def view(self) -> Any:
        """The scene as a widget of a notebook that turns (extra: notebook).

        Raises
        ------
        DesignError
            E140 without the extra.
        """
        return import_module("slopekit.app.notebook").view_of(
            self
        )  # a higher layer, as for the sheet

    def tables(self) -> dict[str, "Table[Any]"]:
        """Return the tables of the result by name, the first with its main numbers in one row."""
        from slopekit.core.sheet import Column, Table

        columns: list[Column[Result]] = [
            Column(name, attrgetter(name), name) for name in ("kind", "status")
        ]
        columns += [
            Column(
                factor_field.name,
                attrgetter(f"fos.{factor_field.name}"),
                f"fos_{factor_field.name}",
            )
            for factor_field in fields(self.fos)
        ]
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
            Column(
                name,
                attrgetter(f"size.{key}_m") if self.size is not None else lambda _: None,
                f"{key}_m",
                "m",
            )
            for name, key in (
                ("height", "height"),
                ("face width", "face_width"),
                ("setback", "setback"),
            )
        ]
        return {self.name: Table(columns, [self]), **Report.tables(self)}

    @property
    def size(self) -> Sizes | None:
        """The size of the moving block, or of the first mechanism of many blocks; None where it was not measured."""
        if self.findings is None:
            return getattr(self.geometry, "sizes", None)
        return None if self.findings.first is None else self.findings.first.size

    @property
    def mechanisms(self) -> "tuple[Mechanism, ...]":
        """The mechanisms in the order of failure; of a block above a basal joint that block and the whole wedge."""
        if self.findings is not None:
            return self.findings.mechanisms
        whole_wedge = self.comparisons.without_basal
        if whole_wedge is None:
            return ()
        from slopekit.findings import Mechanism  # few wedges have a basal joint

        size = self.size and replace(
            self.size, volume_m3=self.geometry.volume_m3, mass_t=self.mass_t
        )
        block, closed = (self.words.block,), whole_wedge.closed_form
        block_above = Mechanism(
            self.status, self.fos.limit, block, basis="limit", size=size, role="block_above_basal"
        )
        return block_above, Mechanism(
            whole_wedge.status, closed, ("whole wedge",), basis="closed_form", role="whole_wedge"
        )

    @property
    def mass_t(self) -> float:
        """The mass of the moving blocks, t."""
        return self.forces.weight / self.design.rock.gravity_m_s2

    @property
    def scene(self) -> BlockScene:
        """The blocks, interfaces, node pairs and movements, for pictures and files of other programs."""
        shapes, state = self.geometry.shapes(self.words.block), self.limit_state
        count = len(shapes.names)
        velocity, order, factor = (
            np.zeros((count, 6)),
            np.zeros(count, dtype=np.int64),
            np.full(count, np.nan),
        )
        displacement, settled = None, self.displacements.at_factor_one
        if self.findings is not None:
            index = {name: k for k, name in enumerate(shapes.names)}
            number, failure_factor = (
                0,
                np.nan,
            )  # a block that was only supported by an earlier mechanism fails together with it
            for row in self.findings.mechanisms:
                moved_blocks = [index[name] for name in row.blocks]
                if row.role != "chip":
                    number += 1
                    velocity[moved_blocks], order[moved_blocks] = (
                        np.hstack([row.displacement, row.rotation]),
                        number,
                    )
                if row.status != "not_converged":
                    failure_factor = factor[moved_blocks] = np.fmax(
                        failure_factor, np.nan if row.fos is None else row.fos
                    )
            if settled is not None and settled.block_movements is not None:
                displacement = np.zeros((count, 6))
                displacement[: len(settled.block_movements)] = settled.block_movements
        else:
            if self.limit_state.mechanism is not None:
                velocity[0], order[0] = self.limit_state.mechanism.vector(), 1
            if self.fos.limit is not None:
                factor[0] = self.fos.limit
            if settled is not None:
                displacement = settled.movement.vector()[None, :]
        bolts = None
        if self.design.bolts:  # most designs have none: they load nothing of it
            from slopekit.bolts import bolts_with_heads

            bolts = bolts_with_heads(self.design.bolts, shapes)
        return BlockScene(
            shapes, state.node_pairs, state.acting, velocity, order, factor, displacement, bolts
        )

    def _whole_wedge_breaks(self, rule: Rule) -> bool:
        """Return whether the whole wedge without the basal joint breaks a rule."""
        whole_wedge = self.comparisons.without_basal
        return whole_wedge is not None and not whole_wedge.meets(rule)

    def _rule_json(self, rule: Rule) -> dict[str, Any]:
        """Return a rule with the number that it judges as JSON values, null where there is none."""
        value = self.value_of(rule)
        name = None if value is None else self.name_of(rule)
        whole_wedge = self.comparisons.without_basal
        if whole_wedge is not None and self._whole_wedge_breaks(rule):
            name, value = whole_wedge.NAME, whole_wedge.factor
        return {"rule": str(rule), "met": self.meets(rule), "judged": name, "fos": json_of(value)}

    def _mechanism_json(self) -> dict[str, Any] | None:
        if self.findings is not None:
            first = self.findings.first
            if first is None or not first.blocks:
                return None
            row = first.to_dict()
            return {
                name: row[name]
                for name in (
                    "blocks",
                    "how",
                    "displacement",
                    "rotation",
                    *(json_of(first.size) or ()),
                )
            }
        moves = self.limit_state.mechanism
        return None if moves is None else {"blocks": [self.words.block], **json_of(moves)}

    def _displacements_json(self) -> dict[str, Any]:
        """Return the displacements as JSON values: at full strength, by all pairs, and along the series of factors."""
        full, pairs = self.displacements.at_factor_one, self.displacements.all_pairs
        return {
            "at_factor_one": None
            if full is None
            else {
                **_movement_json(full.movement),
                "failed_pairs": full.failed_pairs,
                "residual": full.residual,
                "block": full.block,
            },
            "all_pairs": None
            if pairs is None
            else {
                "bracket": json_of(pairs.bracket),
                "lost_equilibrium": pairs.lost_equilibrium,
                "history": [
                    {"factor": factor, "failed_pairs": count}
                    for factor, count in sorted(pairs.history)
                ],
            },
            "series": [
                {
                    "factor": step.factor,
                    "stands": step.stands,
                    "failed_pairs": step.failed_pairs,
                    **_movement_json(step.movement),
                }
                for step in self.displacements.series
            ],
        }

    def to_dict(self) -> dict[str, Any]:
        """Return the result as JSON values."""
        state, comparisons = self.limit_state, self.comparisons
        return {
            "slopekit": __version__,
            "format": FORMAT,
            "kind": self.kind,
            "title": self.design.title,
            **self.design.extra_json(),
            "input_sha256": self.design.input_hash(),
            "status": self.status,
            "status_text": self.status_text,
            "fos": json_of(self.fos),
            **(
                {}
                if self.leading is None
                else {"leading": dict(zip(("name", "fos"), self.leading, strict=True))}
            ),
            "difference": self.difference,
            "agree": self.agree,
            "moments_govern": self.moments_govern,
            "openings": json_of(state.openings),
            **(
                {"curved_strength": json_of(state.curved_strength)} if state.curved_strength else {}
            ),
            **({} if comparisons.residual is None else {"residual": json_of(comparisons.residual)}),
            **({"mechanisms": json_of(self.mechanisms)} if self.mechanisms else {}),
            **({} if comparisons.elastic is None else {"elastic": json_of(comparisons.elastic)}),
            "methods": dict(comparisons.methods),
            "accepted": self.accepted,
            "rules": [self._rule_json(rule) for rule in self.design.rules],
            "geometry": json_of(self.geometry) | {"mass_t": self.mass_t},
            "forces_kn": json_of(self.forces),
            "model": json_of(self.model),
            "balance": json_of(state.balance),
            "mechanism": self._mechanism_json(),
            **self._displacements_json(),
            "assembly": json_of(self.findings),
            "governs": [
                {"change": name, "fos": fos, "status": status}
                for name, fos, status in comparisons.governs
            ],
            "inputs": self.design.inputs(),
            "assumed": dict(self.design.assumed),
            "defaults": list(self.design.reading.defaults),
            "warnings": [notice.to_dict() for notice in self.warnings],
            "timing_s": dict(self.timing_s),
            "scene": self.scene.to_dict(),
            "sheet": self.sheet.to_dict(),
        }


def _movement_json(movement: Movement | None) -> dict[str, Any]:
    """Return the displacement (m) and rotation (rad) of a block as JSON values, null where they are not known."""
    return {
        "displacement_m": None if movement is None else movement.displacement.tolist(),
        "rotation_rad": None if movement is None else movement.rotation.tolist(),
    }
