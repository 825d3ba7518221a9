"""What a reader must know beside the number: notices with stable W-codes."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from slopekit.core.errors import Notice
from slopekit.core.orientation import number
from slopekit.design.common import Design
from slopekit.design.parts import Strength
from slopekit.preie.tolerances import MESH_CHANGE

#: The code of inputs that nobody gave.
INVENTED = "W379"
#: Of the inputs, of other methods and of what a run asks besides: not of the factor, which studies repeat.
_NOT_OF_FACTORS = {"W320", "W332", "W366", "W373", INVENTED}
_SCATTER = (".sd", ".k")  # of distributions, beside their mean
_HEIGHTS_M = (0.02, 2500.0)
_INTACT_KPA = 5000.0  # of cohesion
_STRONGEST_LAW_KPA = 2000.0  # ... and of a curved law, at ...
_AT_KPA = 100.0
_STEEPEST_DEG = 75.0  # of friction: Barton (1976) ends at 70
_ARTESIAN = 3.0  # columns of water as high as the blocks
_FEW = 6  # bolts that are named
SQUARE = 1e-9  # drawn out by less than this part of the movement: square to it


LostCohesion = tuple[float, int, int]
"""The part of the cohesion of blocks that does not act, on how many contacts, and how many have any."""


def lost_cohesion_notices(lost: LostCohesion, quantity: str) -> Iterator[Notice]:
    """W307: contacts of many blocks that are open somewhere at a limit.

    Parameters
    ----------
    quantity : what the limit is of: the factor of safety, or a load
    """
    share, contacts, cohesive = lost
    if contacts:
        yield Notice("W307", f"{contacts} of {cohesive} contacts with cohesion are open or partly open in the state "
                     f"that gives the {quantity}, and carry none there: {_percent(share)} of the cohesion does not "
                     "act")  # fmt: skip


def _percent(part: float) -> str:
    """A part in two digits.

    >>> _percent(0.123), _percent(0.997)
    ('12 %', '100 %')
    """
    return f"{float(f'{part * 100:.2g}'):g} %"


def common_notices(design: Design, strengths: Sequence[Strength]) -> Iterator[Notice]:
    """What a reader must know of the inputs, whatever the kind."""
    yield from not_as_given(design)
    yield from means_taken(design)
    least = [rule for rule in design.rules if rule.relation in (">=", ">")]
    asks = max((rule.value for rule in least), default=0.0)
    if design.analysis.partial is not None and asks > 1.0:
        yield Notice(
            "W332", f"a rule asks for {asks:g} of the over-design factor, beside the partial factors: 1 is enough"
        )
    if design.analysis.partial is not None and getattr(design, "crack_searched", None):
        yield Notice("W332", "the crack stands where it is worst without the partial factors")
    yield from weight_notices(design)
    if any(rule.name == "fos.static_bound" for rule in least):
        yield Notice("W332", "a rule judges the upper bound, which is unsafe as an answer")
    if any(strength.tension_kpa for strength in strengths):
        yield Notice("W329", "the tensile strength acts in the displacements only: the limit counts none")
    yield from strength_notices(strengths)


def strength_notices(strengths: Sequence[Strength]) -> Iterator[Notice]:
    """Yield W302 of cohesion and friction that no joint has."""
    strongest = max(strength.cohesion_kpa for strength in strengths)
    if strongest > _INTACT_KPA:
        intact = f"a cohesion of {strongest:.6g} kPa is that of intact rock"
        yield Notice("W302", f"{intact}: is {strongest / 1000:.6g} kPa meant?")
    steepest = max((strength.friction_angle_deg for strength in strengths if strength.law is None), default=0.0)
    if steepest > _STEEPEST_DEG:
        yield Notice("W302", f"a friction angle of {steepest:.6g}° is that of no joint: rough ones have 70° at most")
    for law in dict.fromkeys(strength.law for strength in strengths if strength.law is not None):
        resists = float(law.resistance(np.array([_AT_KPA]))[0])
        if resists >= _STRONGEST_LAW_KPA:
            yield Notice("W302", f"{law.in_words()} resists {resists:.4g} kPa at a normal traction of {_AT_KPA:g} kPa, "
                                 "as intact rock does: are its numbers in kPa?")  # fmt: skip


def bolt_notices(design: Design) -> Iterator[Notice]:
    """Yield W311 of bolts whose moments are not known and of active ones that pull the block out of its face."""
    if any(bolt.head_m is None for bolt in design.bolts):
        yield Notice("W311", "bolts without a head act through the centroid: their moments are not checked")
    face = getattr(design, "face", None)
    if face is None:
        return
    outward = [
        k for k, bolt in enumerate(design.bolts, 1)
        if bolt.acts == "active" and float(bolt.toward.vector() @ face.normal()) > SQUARE
    ]  # fmt: skip
    if outward:
        named = f"bolts {', '.join(map(str, outward[:_FEW]))}" if len(outward) > 1 else f"bolt {outward[0]}"
        pull = "pull" if len(outward) > 1 else "pulls"
        more = f" and {len(outward) - _FEW} more" if len(outward) > _FEW else ""
        yield Notice("W311", f"active {named}{more} {pull} out of the face: toward is the direction of the force on "
                     "the block, into the rock")  # fmt: skip


def undrawn_notice() -> Notice:
    """Passive bolts that no block pulls at."""
    return Notice("W311", "the passive bolts add nothing: the movement does not draw them out")


def mesh_notices(change: float) -> Iterator[Notice]:
    """A limit that the last refinement of its node pairs still moved, by that part of it."""
    if change > MESH_CHANGE:
        yield Notice("W312", f"the last refinement of the node pairs still moved the limit by {change * 100:.1f} %")


def size_notices(height_m: float) -> Iterator[Notice]:
    """W302: the blocks are higher than nearly any rock slope, or lower than a model of one in a laboratory."""
    if not _HEIGHTS_M[0] <= height_m <= _HEIGHTS_M[1]:
        shown, what, unit = number(float(f"{height_m:.4g}")), "lower than any slope", "km"
        if height_m > _HEIGHTS_M[1]:
            what, unit = "higher than nearly any rock slope", "mm"
        yield Notice("W302", f"the blocks are {shown} m high, {what}: was a length typed in {unit}?")


def pressure_notices(pressures_kpa: Sequence[float], height_m: float, water_unit_weight: float) -> Iterator[Notice]:
    """W302: the water on an interface would stand far above the blocks."""
    highest = max(pressures_kpa, default=0.0)
    head_m = highest / water_unit_weight
    if head_m > _ARTESIAN * height_m:
        pressure, head, height = (number(float(f"{value:.4g}")) for value in (highest, head_m, height_m))
        water = f"a mean water pressure of {pressure} kPa is that of {head} m of water"
        yield Notice("W302", f"{water}, on blocks {height} m high: was it typed in Pa?")


def means_taken(design: Design, varied: Sequence[str] = ()) -> Iterator[Notice]:
    """W320: what scatters and is taken at its mean, but for what a study gives other values, by their paths.

    Of a distribution whose scatter alone is varied the mean is taken all the same.
    """
    means = [
        f"{name} {value}" for name, value in design.assumed
        if not any(path == name or (path.startswith(f"{name}.") and not path.endswith(_SCATTER)) for path in varied)
    ]  # fmt: skip
    if means:
        yield Notice("W320", f"distributions are taken at their means: {', '.join(means)}")


def not_as_given(design: Design, varied: Sequence[str] = ()) -> Iterator[Notice]:
    """W379, W366, W373: what was not given, what is not used and what was read in another way than it stands there.

    Parameters
    ----------
    varied : the paths that a study gives values of its own
    """
    own = {part for path in varied for part in path.split(".")}
    if invented := [name for name in design.invented if name not in own]:
        yield Notice(INVENTED, f"not given, taken from the paper's wedge: {', '.join(invented)}")
    if design.reading.left_out:
        yield Notice("W366", f"not used: {'; '.join(design.reading.left_out)}")
    if design.reading.read_as:
        yield Notice("W373", f"read of {'; '.join(design.reading.read_as)}")


def weight_notices(design: Design) -> Iterator[Notice]:
    """Yield W302 of a weight that no rock has."""
    if design.rock.unit_weight_kn_m3 and not 15.0 <= design.rock.unit_weight_kn_m3 <= 50.0:
        yield Notice("W302", f"a unit weight of {design.rock.unit_weight_kn_m3:.4g} kN/m³ is not that of rock")


def new_notices(notices: Iterable[Notice], earlier: Sequence[Notice]) -> list[Notice]:
    """Return the notices that no earlier one has, by itself or behind the place where it holds.

    >>> weight, height = Notice("W302", "a weight"), Notice("W302", "at k = 0.1: a height")
    >>> [notice.message for notice in new_notices([weight, Notice("W302", "a height")], [height])]
    ['a weight']
    """
    return [
        notice
        for notice in notices
        if not any(notice.code == old.code and old.message.endswith(notice.message) for old in earlier)
    ]


def those_of_factors(said: Iterable[Notice]) -> tuple[Notice, ...]:
    """Of the notices of an analysis those of the factor, which studies say too of the designs that they analyse."""
    return tuple(notice for notice in said if notice.code not in _NOT_OF_FACTORS)
