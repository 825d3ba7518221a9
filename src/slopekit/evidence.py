"""The evidence of a result beside its status: factors of safety, forces, movements, and the state at the limit."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from slopekit.block_scene import Arrows, NodePairState
from slopekit.core.arrays import Floats
from slopekit.core.codec import NO_JSON
from slopekit.core.errors import Notice
from slopekit.design.parts import ROUNDING, Rule

if TYPE_CHECKING:
    from slopekit.elastic.outcome import ElasticBlocks
    from slopekit.preie.motion.all_pairs import AllPairsFailed
    from slopekit.preie.motion.balance import Balance


@dataclass(frozen=True)
class FactorsOfSafety:
    """The factors of safety; None where one does not apply.

    limit : PRE-IE, zero (or the given) dilation: the answer; closed_form : of the kind (Hoek & Bray); static_bound :
    an upper bound, unsafe as an answer; all_pairs_failed : the paper's criterion, when asked for; lowest, highest : the
    range of the limit. Of one block: with other joint stiffness, and by forces alone where moments lower the limit. Of
    many: of the same mechanism, whatever forces are locked in; lowest no more than with progressive slip and debonding
    (W504), highest no less than the elastic path where one block goes alone at less.
    """

    limit: float | None = None
    closed_form: float | None = None
    static_bound: float | None = None
    all_pairs_failed: float | None = None
    lowest: float | None = None
    highest: float | None = None


@dataclass(frozen=True)
class Forces:
    """Forces in kN: effective normal forces by interface, along the sliding direction what drives and what resists."""

    weight: float
    normal: Mapping[str, float | None]
    water: Mapping[str, float]
    driving: float | None
    resisting: float | None


@dataclass(frozen=True)
class ModelSize:
    """The size of the model and its assumptions.

    `node_pairs` counts those of upper bound, displacements and failed pairs; the limit's are counted by `Balance`.
    """

    moving_blocks: int
    unknowns: int
    node_pairs: int
    refined: int
    mesh_change: float | None
    left_out: tuple[str, ...]
    passes: int
    residual: float


@dataclass(frozen=True)
class Movement:
    """A movement of the block: displacement of its centroid and rotation about it, (3,) each."""

    displacement: Floats
    rotation: Floats

    def vector(self) -> Floats:
        """Return displacement and rotation in one vector (6,)."""
        return np.concatenate([self.displacement, self.rotation])


@dataclass(frozen=True)
class AtFactorOne:
    """The blocks at rest at full strength on the elastic bed.

    `movement` is that of the block in m and radians; of many blocks that of the block that moves most, which `block`
    names. `block_movements` (n, 6) has the movements of all blocks; `failed_pairs` slip or are open.
    """

    movement: Movement
    failed_pairs: int
    residual: float
    block: str | None = None
    block_movements: Floats | None = None


@dataclass(frozen=True)
class ReductionStep:
    """The block at one strength reduction factor (a row of the paper's Table 3).

    `movement` is None where it does not come to rest; then every pair counts as failed.
    """

    factor: float
    stands: bool
    movement: Movement | None
    failed_pairs: int


@dataclass(frozen=True)
class WithoutBasal:
    """The whole wedge on J1 and J2 by its closed form, where a basal joint cuts its toe off.

    `closed_form` is None where it has no factor.
    """

    NAME: ClassVar = "whole_wedge"
    BRIEF: ClassVar = "whole wedge"
    WHAT: ClassVar = "the whole wedge without the basal joint"
    ALONE: ClassVar = " by the closed form; the block above the basal joint alone has it"
    status: str
    closed_form: float | None

    @property
    def factor(self) -> float | None:
        """The factor of safety that acceptance judges."""
        return self.closed_form

    def in_words(self) -> str:
        """Return status and factor in words."""
        text = self.status.replace("_", " ")
        return text if self.closed_form is None else f"{text}, FoS {self.closed_form:.4g}"

    def meets(self, rule: Rule) -> bool:
        """Return whether the wedge meets a least factor of safety; a wedge that is lifted or falls meets none."""
        if not rule.is_least:
            return True
        if self.closed_form is None:
            return self.status not in ("lifted", "falls")
        return rule.is_met_by(self.closed_form)

    def falls_short(self, target: float) -> bool:
        """Return whether the wedge has less than a target factor of safety.

        >>> WithoutBasal("slides_on_both", 1.2).falls_short(1.3), WithoutBasal("falls", None).falls_short(0.1)
        (True, True)
        """
        if self.closed_form is None:
            return self.status in ("lifted", "falls")
        return self.closed_form < target * (1.0 - ROUNDING)


@dataclass(frozen=True)
class Factors:
    """The factors of safety of a design by PRE-IE and by the closed form.

    Attributes
    ----------
    status : of PRE-IE, as `Result.status`; that of the closed form where PRE-IE was not asked; not_converged where
        neither settled to a factor nor to none
    limit : PRE-IE's factor of safety, None where nothing moves, or it was not asked
    closed_status, closed_form : of the closed form, None where the kind has none
    difference, agree : of the two on the same assumptions, None where they are not compared
    moments_govern : the limit lies below what the forces alone give
    notes : what a run says of the factor: how it was found, what it rests on, and what it leaves out
    also : what acceptance of a run is held against besides
    """

    status: str
    limit: float | None
    closed_status: str | None = field(metadata=NO_JSON)
    closed_form: float | None
    difference: float | None
    agree: bool | None
    moments_govern: bool
    notes: Sequence[Notice] = field(default=(), kw_only=True, metadata=NO_JSON)
    also: WithoutBasal | None = field(default=None, kw_only=True, metadata=NO_JSON)

    @property
    def factor(self) -> float | None:
        """The limit where there is one, else the closed form's factor."""
        return self.limit if self.limit is not None else self.closed_form


@dataclass(frozen=True, eq=False)
class LimitState:
    """The state at the limit.

    Attributes
    ----------
    node_pairs : their forces and modes; acting : the loads
    mechanism : of one block; None where nothing moves, or many blocks do
    balance : how well the forces of the node pairs balance the loads; None where there are none
    openings : by joint, where the elastic bed settles the limit: `pressed_share` of its area, `normal_kn`,
        `resultant_m` where that acts, `opens_at_m` the corner that opens most (None where all is pressed)
    curved_strength : by joint, of a curved law: `traction_kpa` its mean normal traction, `range_kpa` that of its node
        pairs, `cohesion_kpa` and `friction_angle_deg` of the line there
    """

    node_pairs: NodePairState = field(repr=False)
    acting: Arrows = field(repr=False)
    mechanism: Movement | None = None
    balance: "Balance | None" = None
    openings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    curved_strength: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


@dataclass(frozen=True)
class Displacements:
    """Displacements on the elastic bed: at full strength, by the criterion of all pairs, along a series of factors."""

    at_factor_one: AtFactorOne | None = None
    all_pairs: "AllPairsFailed | None" = None
    series: tuple[ReductionStep, ...] = ()


@dataclass(frozen=True)
class Comparisons:
    """Other factors of safety to compare the limit with.

    Attributes
    ----------
    forces_only : the limit without moments, None of many blocks
    on_pressed : the same with the part of each joint that is pressed at the limit, None where moments do not govern
    methods : the factors of other closed forms of the kind (columns) by name; None where one has no answer
    governs : changes of the input with the closed form's factor and status then
    without_basal : what the whole wedge does whose toe a basal joint cuts off, None where there is none such
    residual : on residual strength, None where no strength has one; elastic : of elastic blocks
    """

    forces_only: float | None = None
    on_pressed: float | None = field(default=None, kw_only=True)
    methods: Mapping[str, float | None] = field(default_factory=dict)
    governs: tuple[tuple[str, float | None, str], ...] = ()
    without_basal: WithoutBasal | None = None
    residual: Factors | None = None
    elastic: "ElasticBlocks | None" = None
