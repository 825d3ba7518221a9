"""What a row of toppling columns needs: by column, by method, its JSON (a contract)."""

from dataclasses import field
from typing import Any, ClassVar, Literal

from slopekit.core.errors import Notice
from slopekit.core.orientation import Line
from slopekit.core.records import dataclass
from slopekit.design.common import Design
from slopekit.design.parts import Bolt
from slopekit.studies.support.records import Acts, Need, SupportOptions, SupportOutcome, bolt_words, snippet
from slopekit.studies.support.search import Answer

Where = Literal["toe", "crest", "least", "column"]


@dataclass(frozen=True, slots=True)
class HoldingForce:
    """What one column has to be held with.

    Attributes
    ----------
    acts, column : how the anchor acts, and the name of the column; where : toe, crest (the tallest column) or the
        column that needs least of all by Goodman & Bray
    height : m above its base, at its outer side; at : the same point in the coordinates of the design
    closed_form, pre_ie : kN per metre; None where the closed form does not take the design
    bolt : as a design takes it, with the larger of both; None where the target is out of reach
    notices : what is to be known of the two
    """

    JSON_ALSO: ClassVar = ("reached", "use_kn", "support")
    acts: Acts
    column: str
    where: Where
    height: float = field(metadata={"json": "height_m"})
    at: tuple[float, float, float] = field(metadata={"json": "at_m"})
    toward: Line
    closed_form: Need | None
    pre_ie: Need
    bolt: Bolt | None = field(default=None, metadata={"json": None})
    notices: tuple[Notice, ...] = ()

    @property
    def reached(self) -> bool:
        """Whether every method that takes the design reaches the target."""
        return self.use_kn is not None

    @property
    def use_kn(self) -> float | None:
        """The force to use, kN per metre: the larger of both methods'; None where one of them has none."""
        forces = [need.force for need in (self.closed_form, self.pre_ie) if need is not None]
        return None if None in forces else max(force for force in forces if force is not None)

    @property
    def support(self) -> dict[str, Any] | None:
        """The bolt as `support` of a design."""
        return None if self.bolt is None else {"bolts": [bolt_words(self.bolt)]}


@dataclass(frozen=True, slots=True)
class ByColumn:
    """What Goodman & Bray's table asks of one column: its place, its height of action and kN per metre."""

    column: str
    height: float = field(metadata={"json": "height_m"})
    force: float | None = field(metadata={"json": "force_kn"})


@dataclass(frozen=True, slots=True, repr=False)
class ColumnSupport(SupportOutcome):
    """What a row of columns needs.

    Attributes
    ----------
    target : factor of safety; options : what was asked for
    closed_form, pre_ie : without more support; why_no_closed_form : why Goodman & Bray's table is not asked
    held : by how the anchor acts and its column, empty where nothing is needed
    columns : of Goodman & Bray, every column by itself; empty for long rows
    thickness : m, of the design: its own forces are those per metre times this
    """

    JSON_ALSO: ClassVar = ("reached", "needed", "without")
    design: Design = field(metadata={"json": None})
    target: float = field(metadata={"json": "target_fos"})
    options: SupportOptions = field(metadata={"json": None})
    closed_form: Answer | None = field(metadata={"json": None})
    pre_ie: Answer = field(metadata={"json": None})
    why_no_closed_form: str
    held: tuple[HoldingForce, ...]
    columns: tuple[ByColumn, ...]
    unit: str
    thickness: float = field(metadata={"json": "thickness_m"})
    warnings: tuple[Notice, ...]
    seconds: float = field(default=0.0, compare=False, metadata={"json": None})

    @property
    def reached(self) -> bool:
        """Whether nothing is needed, or the force on some column gives the target."""
        return self.stands or any(one.reached for one in self.held)

    def least(self, acts: Acts) -> HoldingForce | None:
        """The column that takes the least force of those that reach the target."""
        able = [one for one in self.held if one.acts == acts and one.bolt is not None]
        return min(able, key=lambda one: one.use_kn or 0.0, default=None)

    def files(self) -> dict[str, str]:
        """The least anchor of each way to act as `support:` of a design file, by the name of a file."""
        best = [one for acts in self.options.acts if (one := self.least(acts)) is not None]
        bolts = self.design.bolts
        return {f"support-{one.acts}.yaml": snippet((*bolts, one.bolt)) for one in best if one.bolt is not None}

    @property
    def exit_code(self) -> int:
        """0 reached, 1 not reached, 4 PRE-IE did not converge."""
        if self.pre_ie.status == "not_converged":
            return 4
        return 0 if self.reached else 1
