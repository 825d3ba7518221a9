"""Notices with stable W-codes: what a reader must know in addition to the factor of safety."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from slopekit.core.errors import Notice
from slopekit.core.orientation import number
from slopekit.design.common import Design
from slopekit.design.parts import Strength
from slopekit.preie.tolerances import MESH_CHANGE

#: The code of the notice of inputs that took the example values of the paper's wedge.
EXAMPLE_INPUTS_CODE = "W379"
#: Codes about inputs, other methods and options of a run; studies repeat the codes about the factor alone.
_NOT_ABOUT_FACTORS = {"W320", "W332", "W366", "W373", EXAMPLE_INPUTS_CODE}
_SPREAD_SUFFIXES = (".sd", ".k")  # of distributions, beside their mean
_HEIGHTS_M = (0.02, 2500.0)
_INTACT_KPA = 5000.0  # a cohesion above this is that of intact rock
_STRONGEST_LAW_KPA = (
    2000.0  # shear strength of a curved law above which it is that of intact rock, at ...
)
_LAW_TRACTION_KPA = 100.0  # ... this normal traction
_STEEPEST_DEG = 75.0  # of friction: Barton (1976) ends at 70
_ARTESIAN_HEADS = 3.0  # columns of water as high as the blocks
_MOST_NAMED_BOLTS = 6  # bolts that are named
PERPENDICULAR = 1e-9  # of the movement: a bolt that is drawn out by less is perpendicular to it


LostCohesion = tuple[float, int, int]
"""Fraction of the cohesion that does not act, number of contacts with such a loss, number of contacts with cohesion."""


def lost_cohesion_notices(lost: LostCohesion, quantity: str) -> Iterator[Notice]:
    """Yield W307 where contacts of many blocks are open somewhere at a limit.

    Parameters
    ----------
    quantity : what the limit is of: the factor of safety, or a load
    """
    share, contacts, cohesive = lost
    if contacts:
        yield Notice(
            "W307",
            f"{contacts} of {cohesive} contacts with cohesion are open or partly open in the state "
            f"that gives the {quantity}, and carry none there: {_percent(share)} of the cohesion does not "
            "act",
        )


def _percent(fraction: float) -> str:
    """Return a fraction in percent, with two digits.

    >>> _percent(0.123), _percent(0.997)
    ('12 %', '100 %')
    """
    return f"{float(f'{fraction * 100:.2g}'):g} %"


def common_notices(design: Design, strengths: Sequence[Strength]) -> Iterator[Notice]:
    """Yield the notices about the inputs that all kinds of design share."""
    yield from defaulted_inputs(design)
    yield from mean_value_notices(design)
    least = [rule for rule in design.rules if rule.relation in (">=", ">")]
    required = max((rule.value for rule in least), default=0.0)
    if design.analysis.partial is not None and required > 1.0:
        yield Notice(
            "W332",
            f"a rule asks for {required:g} of the over-design factor, beside the partial factors: 1 is enough",
        )
    if design.analysis.partial is not None and getattr(design, "crack_searched", None):
        yield Notice("W332", "the crack stands where it is worst without the partial factors")
    yield from weight_notices(design)
    if any(rule.name == "fos.static_bound" for rule in least):
        yield Notice("W332", "a rule judges the upper bound, which is unsafe as an answer")
    if any(strength.tension_kpa for strength in strengths):
        yield Notice(
            "W329", "the tensile strength acts in the displacements only: the limit counts none"
        )
    yield from strength_notices(strengths)


def strength_notices(strengths: Sequence[Strength]) -> Iterator[Notice]:
    """Yield W302 where cohesion or friction are larger than those of any rock joint."""
    strongest = max(strength.cohesion_kpa for strength in strengths)
    if strongest > _INTACT_KPA:
        intact = f"a cohesion of {strongest:.6g} kPa is that of intact rock"
        yield Notice("W302", f"{intact}: is {strongest / 1000:.6g} kPa meant?")
    steepest = max(
        (strength.friction_angle_deg for strength in strengths if strength.law is None), default=0.0
    )
    if steepest > _STEEPEST_DEG:
        yield Notice(
            "W302",
            f"a friction angle of {steepest:.6g}° is that of no joint: rough ones have 70° at most",
        )
    for law in dict.fromkeys(strength.law for strength in strengths if strength.law is not None):
        resistance = float(law.resistance(np.array([_LAW_TRACTION_KPA]))[0])
        if resistance >= _STRONGEST_LAW_KPA:
            yield Notice(
                "W302",
                f"{law.in_words()} resists {resistance:.4g} kPa at a normal traction of {_LAW_TRACTION_KPA:g} kPa, "
                "as intact rock does: are its numbers in kPa?",
            )


def bolt_notices(design: Design) -> Iterator[Notice]:
    """Yield W311 for bolts without a head, and for active bolts that pull the block out of its face."""
    if any(bolt.head_m is None for bolt in design.bolts):
        yield Notice(
            "W311", "bolts without a head act through the centroid: their moments are not checked"
        )
    face = getattr(design, "face", None)
    if face is None:
        return
    outward = [
        k
        for k, bolt in enumerate(design.bolts, 1)
        if bolt.acts == "active" and float(bolt.toward.vector() @ face.normal()) > PERPENDICULAR
    ]
    if outward:
        bolt_names = (
            f"bolts {', '.join(map(str, outward[:_MOST_NAMED_BOLTS]))}"
            if len(outward) > 1
            else f"bolt {outward[0]}"
        )
        pull = "pull" if len(outward) > 1 else "pulls"
        remainder = (
            f" and {len(outward) - _MOST_NAMED_BOLTS} more"
            if len(outward) > _MOST_NAMED_BOLTS
            else ""
        )
        yield Notice(
            "W311",
            f"active {bolt_names}{remainder} {pull} out of the face: toward is the direction of the force on "
            "the block, into the rock",
        )


def undrawn_notice() -> Notice:
    """Return W311 for passive bolts that the movement does not draw out."""
    return Notice("W311", "the passive bolts add nothing: the movement does not draw them out")


def mesh_notices(change: float) -> Iterator[Notice]:
    """Yield W312 where the last refinement of the node pairs changed the limit by more than a fraction `change`."""
    if change > MESH_CHANGE:
        yield Notice(
            "W312",
            f"the last refinement of the node pairs still moved the limit by {change * 100:.1f} %",
        )


def size_notices(height_m: float) -> Iterator[Notice]:
    """Yield W302 where the blocks are higher than nearly any rock slope, or lower than a laboratory model."""
    if not _HEIGHTS_M[0] <= height_m <= _HEIGHTS_M[1]:
        height_text, comparison, unit = (
            number(float(f"{height_m:.4g}")),
            "lower than any slope",
            "km",
        )
        if height_m > _HEIGHTS_M[1]:
            comparison, unit = "higher than nearly any rock slope", "mm"
        yield Notice(
            "W302",
            f"the blocks are {height_text} m high, {comparison}: was a length typed in {unit}?",
        )


def pressure_notices(
    pressures_kpa: Sequence[float], height_m: float, water_unit_weight: float
) -> Iterator[Notice]:
    """Yield W302 where a water pressure (kPa) on an interface means a water level far above the blocks."""
    highest = max(pressures_kpa, default=0.0)
    head_m = highest / water_unit_weight
    if head_m > _ARTESIAN_HEADS * height_m:
        pressure, head, height = (
            number(float(f"{value:.4g}")) for value in (highest, head_m, height_m)
        )
        water = f"a mean water pressure of {pressure} kPa is that of {head} m of water"
        yield Notice("W302", f"{water}, on blocks {height} m high: was it typed in Pa?")


def mean_value_notices(design: Design, varied: Sequence[str] = ()) -> Iterator[Notice]:
    """Yield W320 for inputs with a distribution of which the mean is used; `varied` are the paths that a study varies.

    A distribution of which only the scatter is varied is used at its mean too.
    """
    means = [
        f"{name} {value}"
        for name, value in design.assumed
        if not any(
            path == name or (path.startswith(f"{name}.") and not path.endswith(_SPREAD_SUFFIXES))
            for path in varied
        )
    ]
    if means:
        yield Notice("W320", f"distributions are taken at their means: {', '.join(means)}")


def defaulted_inputs(design: Design, varied: Sequence[str] = ()) -> Iterator[Notice]:
    """Yield W379, W366, W373: inputs at example values, inputs that are not used, inputs that were reinterpreted.

    Parameters
    ----------
    varied : paths of inputs that a study varies
    """
    varied_keys = {key for path in varied for key in path.split(".")}
    if example_inputs := [name for name in design.example_inputs if name not in varied_keys]:
        yield Notice(
            EXAMPLE_INPUTS_CODE,
            f"not given, taken from the paper's wedge: {', '.join(example_inputs)}",
        )
    if design.reading.left_out:
        yield Notice("W366", f"not used: {'; '.join(design.reading.left_out)}")
    if design.reading.read_as:
        yield Notice("W373", f"read of {'; '.join(design.reading.read_as)}")


def weight_notices(design: Design) -> Iterator[Notice]:
    """Yield W302 where the unit weight is not that of a rock."""
    if design.rock.unit_weight_kn_m3 and not 15.0 <= design.rock.unit_weight_kn_m3 <= 50.0:
        yield Notice(
            "W302",
            f"a unit weight of {design.rock.unit_weight_kn_m3:.4g} kN/m³ is not that of rock",
        )


def new_notices(notices: Iterable[Notice], earlier: Sequence[Notice]) -> list[Notice]:
    """Return the notices that no earlier one repeats, alone or after the name of a case.

    >>> weight, height = Notice("W302", "a weight"), Notice("W302", "at k = 0.1: a height")
    >>> [notice.message for notice in new_notices([weight, Notice("W302", "a height")], [height])]
    ['a weight']
    """
    return [
        notice
        for notice in notices
        if not any(
            notice.code == old.code and old.message.endswith(notice.message) for old in earlier
        )
    ]


def factor_notices(notices: Iterable[Notice]) -> tuple[Notice, ...]:
    """Return the notices about the factor of safety, which studies repeat for the designs that they analyse."""
    return tuple(notice for notice in notices if notice.code not in _NOT_ABOUT_FACTORS)
