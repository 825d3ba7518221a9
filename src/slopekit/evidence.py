"""What stands beside the status of a result: its factors of safety, forces, movements and what they rest on."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.design.parts import Rule

_ROUNDING = 1e-9  # of a factor that was solved for


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class Forces:
    """Forces in kN: effective normal forces by interface, along the sliding direction what drives and what resists."""

    weight: float
    normal: Mapping[str, float | None]
    water: Mapping[str, float]
    driving: float | None
    resisting: float | None


@dataclass(frozen=True, slots=True)
class ModelSize:
    """What was modelled and what was left out."""

    moving_blocks: int
    unknowns: int
    node_pairs: int
    refined: int
    mesh_change: float | None
    left_out: tuple[str, ...]
    passes: int
    residual: float


@dataclass(frozen=True, slots=True)
class Movement:
    """A movement of the block: displacement of its centroid and rotation about it, (3,) each."""

    displacement: Floats
    rotation: Floats

    def vector(self) -> Floats:
        """Displacement and rotation in one, (6,)."""
        return np.concatenate([self.displacement, self.rotation])


@dataclass(frozen=True, slots=True)
class AtFactorOne:
    """The blocks at rest at full strength on the elastic bed.

    `movement` in m and radians of the block, of many blocks that of the one that moves most: `block` then names it, and
    `every` (n, 6) has the displacements and rotations of all; `failed_pairs` slip or are open.
    """

    movement: Movement
    failed_pairs: int
    residual: float
    block: str | None = None
    every: Floats | None = None


@dataclass(frozen=True, slots=True)
class AllPairs:
    """The paper's search: its bracket, whether equilibrium was lost at the upper end, every trial."""

    bracket: tuple[float, float]
    lost_equilibrium: bool
    history: tuple[tuple[float, int], ...]


@dataclass(frozen=True, slots=True)
class ReductionStep:
    """The block at one strength reduction factor (a row of the paper's Table 3).

    `movement` is None where it does not come to rest; then every pair counts as failed.
    """

    factor: float
    stands: bool
    movement: Movement | None
    failed_pairs: int


@dataclass(frozen=True, slots=True)
class ContactOpening:
    """What of a joint is pressed at the limit on its elastic bed; places (3,) in the user's coordinates.

    `resultant_m` is where its normal force acts, `opens_at_m` the corner that opens most, None where all is pressed.
    """

    pressed_share: float
    normal_kn: float
    resultant_m: Floats | None
    opens_at_m: Floats | None


@dataclass(frozen=True, slots=True)
class SecantLine:
    """The line of a curved law at the mean normal traction of a joint: kPa and degrees.

    `range_kpa` are the lowest and highest traction of the node pairs at the limit.
    """

    traction_kpa: float
    range_kpa: tuple[float, float]
    cohesion_kpa: float
    friction_angle_deg: float


@dataclass(frozen=True, slots=True)
class ResidualFactors:
    """The factors on residual strength, after slip: both methods, and whether they agree."""

    status: str
    limit: float | None
    closed_form: float | None
    difference: float | None
    agree: bool | None


@dataclass(frozen=True, slots=True)
class WithoutBasal:
    """What the whole wedge on J1 and J2 does by its closed form, where a basal joint cuts its toe off.

    `closed_form` is None where it has no factor.
    """

    NAME: ClassVar = "whole_wedge"
    BRIEF: ClassVar = "whole wedge"
    WHAT: ClassVar = "the whole wedge without the basal joint"
    status: str
    closed_form: float | None

    @property
    def factor(self) -> float | None:
        """What it is judged by."""
        return self.closed_form

    @property
    def what(self) -> str:
        """What it is, in words."""
        return self.WHAT

    @property
    def alone(self) -> str:
        """By whom, and what has more, in words."""
        return " by the closed form; the block above the basal joint alone has it"

    def in_words(self) -> str:
        """Status and factor."""
        said = self.status.replace("_", " ")
        return said if self.closed_form is None else f"{said}, F {self.closed_form:.4g}"

    def asks(self, rule: Rule) -> bool:
        """Whether a rule is held against it: every least factor of safety."""
        return rule.is_least

    def meets(self, rule: Rule) -> bool:
        """Whether it keeps a least factor of safety: what is lifted or falls keeps none."""
        if not self.asks(rule):
            return True
        if self.closed_form is None:
            return self.status not in ("lifted", "falls")
        return rule.met(self.closed_form)

    def falls_short(self, target: float) -> bool:
        """Whether it has less than a factor of safety.

        >>> WithoutBasal("slides_on_both", 1.2).falls_short(1.3), WithoutBasal("falls", None).falls_short(0.1)
        (True, True)
        """
        if self.closed_form is None:
            return self.status in ("lifted", "falls")
        return self.closed_form < target * (1.0 - _ROUNDING)
