"""Closed forms over arrays of designs: their arguments, and the outcome and factor of each design."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, TypeAlias

import numpy as np

from slopekit.core.arrays import Floats, NDArray
from slopekit.core.errors import Fault, GeometryError
from slopekit.design.common import Design
from slopekit.design.ground_water import SlopeDesign
from slopekit.design.parts import Strength
from slopekit.kinds.protocol import ClosedForm, D
from slopekit.kinds.single_block.held_bolts import Bounds
from slopekit.kinds.single_block.secants import on_secants

if TYPE_CHECKING:
    from slopekit.kinds.water import FullWater

DILATES = "the closed form knows no dilation: it is printed, not compared"
#: Why values do not fit the blocks of planes: water over the rim of a crack, above the ground; two parts of a block.
MISFITS = ("E207", "E456", "E208")
#: The arguments of a closed form by name; None for what a design does not have.
Arguments: TypeAlias = dict[str, float | None]


@dataclass(frozen=True)
class ClosedForms:
    """A closed form of n designs.

    Attributes
    ----------
    names : of outcomes; outcome : the number of each design's (n,); factor : (n,) or nan
    normal_kn, areas_m2 : of each joint (n,): the effective normal force and the area it acts on; none where no strength
        of the kind can be curved
    """

    names: tuple[str, ...]
    outcome: NDArray[np.int8]
    factor: Floats
    normal_kn: Sequence[Floats] = ()
    areas_m2: Sequence[Floats] = ()

    def form(self, design: int = 0) -> ClosedForm:
        """Return the closed form of one of the designs.

        Raises
        ------
        GeometryError
            Its planes cut no block.
        """
        name, factor = self.names[self.outcome[design]], float(self.factor[design])
        if name.startswith("E"):
            message = (
                "the crack or its water does not fit the block"
                if name == "E207"
                else "the planes enclose no block"
            )
            raise GeometryError([Fault(name, message)])
        return ClosedForm(None if math.isnan(factor) else factor, name)

    def refused(self, misfit: Any, codes: Sequence[str]) -> "ClosedForms":
        """Return the closed forms with the code of a misfit for blocks that a value does not fit.

        Parameters
        ----------
        misfit : (n,) index into the codes, below 0 of those that fit; None where all do
        """
        if misfit is None:
            return self
        names = (*self.names, *(code for code in codes if code not in self.names))
        is_block = np.array([not name.startswith("E") for name in self.names])
        is_misfit = (np.asarray(misfit) >= 0) & is_block[self.outcome]
        numbers = np.array([names.index(code) for code in codes], dtype=np.int8)
        outcome = np.where(is_misfit, numbers[misfit], self.outcome)
        return replace(
            self, names=names, outcome=outcome, factor=np.where(is_misfit, np.nan, self.factor)
        )

    def tractions_kpa(self) -> list[Floats]:
        """Return the mean effective normal traction (n,) kPa on each joint."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return [
                normal / area for normal, area in zip(self.normal_kn, self.areas_m2, strict=True)
            ]


#: The closed form of a design without the block in question.
NONE = ClosedForms(("",), np.zeros(1, dtype=np.int8), np.full(1, np.nan))


@dataclass(frozen=True)
class OnArrays(Generic[D]):
    """A closed form that takes many designs in one call.

    Attributes
    ----------
    arguments : of a design, but for its passive bolts
    strength_arguments : the arguments that hold the cohesion and friction of its joints
    closed_forms : designs by their arguments and the bolts that they share; each of the arguments is one number for all
        of them or an array
    bounds : the planes that bound the blocks of a design, whose numbers may be arrays
    sizes : of the blocks of a design, whose numbers may be arrays, (n,) by key with its unit (`setback_m`), nan where
        there is none; `scale` of lengths where limits of size make blocks smaller; empty where they are not known
    whole_wedges : the wedge above a basal joint, of a design whose numbers may be arrays, with the strengths of its
        joints and the offsets of its bolt heads: a second block that acceptance is judged by, with the outcome ""
        where there is no such block; None where designs have none
    crack_reach_m : how far the place of a crack may lie (n,), of a design whose numbers may be arrays; not a number
        where the planes make no block
    full : the pressures of full water
    shaken : of such a design, the level unit vector (n, 3) that an earthquake without a trend acts along
    """

    arguments: Callable[[D], Arguments]
    strength_arguments: Callable[[Sequence[Strength]], Arguments]
    closed_forms: Callable[[Mapping[str, Any], Sequence[Sequence[Any]]], ClosedForms]
    bounds: Callable[[D], Bounds]
    sizes: Callable[[D], Mapping[str, Floats]]
    crack_reach_m: Callable[[D], Floats]
    whole_wedges: Callable[[D, Sequence[Strength], Floats | None], ClosedForms] | None
    full: "FullWater"
    shaken: Callable[[D], Floats]

    def closed_form(self, design: D) -> ClosedForm:
        """Return the closed form of one design, as PRE-IE is compared with it.

        Raises
        ------
        GeometryError
            Its planes cut no block.
        """
        strengths = design.joint_strengths
        dilates = any(strength.dilation_deg for strength in strengths)
        return replace(self.forms(design, strengths).form(), why_not=DILATES if dilates else "")

    def forms(self, design: D, strengths: Sequence[Strength]) -> ClosedForms:
        """Return the closed forms of designs, on the secants of their strengths where these are curved.

        Parameters
        ----------
        design : whose numbers may be arrays; strengths : of its joints, likewise
        """
        arguments, bolts = self.arguments(design), passive_bolts(design)

        def on_lines(lines: Sequence[Strength]) -> ClosedForms:
            return self.closed_forms(arguments | self.strength_arguments(lines), bolts)

        return on_secants(strengths, on_lines, ClosedForms.tractions_kpa)


def pressures_and_force(
    design: D, joints: int, bounds: Callable[[D], Bounds], full: "FullWater"
) -> tuple[list[Any], Arguments]:
    """Return the mean pressures (kPa) of the joints and the crack (None: by fill), and the force and misfit arguments.

    The force is the sum of forces and active bolts: east, north, up, None without any.

    Parameters
    ----------
    bounds, full : as `OnArrays` has them: a table, a pond, a depth in the crack and a surcharge are integrated over the
        faces of the blocks
    """
    assert isinstance(design, SlopeDesign)
    pulls = [*(force.components_kn for force in design.forces), *_bolts(design, "active")]
    sums: Iterable[Any] = map(sum, zip(*pulls, strict=True)) if pulls else [None] * 3
    force = dict(zip(("force_east", "force_north", "force_up"), sums, strict=True))
    pressures: list[Any] = [None] * (joints + 1)
    if design.water.mode == "pressures":
        pressures[:] = [*design.water.pressures_kpa, *[0.0] * joints][: joints + 1]
    if not design.is_cut_for_loads:
        return pressures, force | {"misfit": None}
    from slopekit.kinds.water import integrated_loads  # plain designs do not pay

    means, rest, misfit = integrated_loads(design, bounds(design), full)
    force = {
        name: rest[k] if force[name] is None else force[name] + rest[k]
        for k, name in enumerate(force)
    }
    is_by_faces = design.water.has_table or np.any(design.water.crack_water_m)
    return (means if is_by_faces else pressures), force | {"misfit": misfit}


def passive_bolts(design: Design) -> list[list[Any]]:
    """Return the components east, north and up of each passive bolt at full capacity, kN."""
    return _bolts(design, "passive")


def _bolts(design: Design, acts: str) -> list[list[Any]]:
    bolts = (bolt for bolt in design.bolts if bolt.acts == acts)
    return [[bolt.force_kn * component for component in bolt.toward.vector().T] for bolt in bolts]
