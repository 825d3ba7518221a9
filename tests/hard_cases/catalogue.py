"""The sweeps: every condition of METHOD.md §7 as one parameter, for each kind to which it applies."""

import math

from tests.hard_cases.cases import (
    PAPER,
    STEEP,
    WYLLIE,
    Case,
    bench,
    columns,
    footing,
    plane,
    sphere,
    stack,
    wedge,
)
from tests.hard_cases.exact import line_vector, plane_normal
from tests.hard_cases.exact import wedge as exact_wedge
from tests.hard_cases.sweeps import LAST_DIGITS, MESH, PASSES, ROUNDING, SECTION, SPACE, Sweep

FLOATS = tuple[float, ...]


def geometric(first: float, last: float, many: int) -> FLOATS:
    """Values in a constant ratio."""
    return (*(first * (last / first) ** (k / (many - 1)) for k in range(many - 1)), last)


def even(first: float, last: float, many: int) -> FLOATS:
    """Values at a constant distance."""
    return tuple(first + (last - first) * k / (many - 1) for k in range(many))


# -- angle between the joints ---------------------------------------------------------------------------


def apart(angle: float, c: float = 20.0) -> Case:
    """Two joints that dip 45°, their dip directions `angle` apart."""
    return wedge(dips=((45, 180 - angle / 2), (45, 180 + angle / 2)), c=c)


def dihedral(angle: float) -> Case:
    """Two joints that dip 60°, their normals `angle` apart: sin(angle/2) = sin 60° sin(half the dip directions)."""
    half = math.degrees(math.asin(math.sin(math.radians(angle / 2)) / math.sin(math.radians(60))))
    return wedge(dips=((60, 180 - half), (60, 180 + half)), face=(75, 180))


def skewed(angle: float) -> Case:
    """Two joints apart both in dip and in dip direction: one of them carries the wedge alone."""
    return wedge(dips=((45 + 0.3 * angle, 180 - angle / 2), (45 - 0.3 * angle, 180 + angle / 2)))


ANGLES = geometric(90.0, 0.01, 41)
BETWEEN = "angle between the joints, degrees"
ANGLE = [
    Sweep("dip directions apart", BETWEEN, apart, ANGLES, ROUNDING, "angle"),
    Sweep(
        "dip directions apart, c = 0", BETWEEN, lambda x: apart(x, 0.0), ANGLES, ROUNDING, "angle"
    ),
    Sweep("normals apart", BETWEEN, dihedral, ANGLES, ROUNDING, "angle"),
    Sweep(
        "apart in dip and direction",
        BETWEEN,
        skewed,
        ANGLES[6:],
        ROUNDING,
        "angle",
        statuses=("rotates",),
        left_out=11,
    ),
    Sweep("volume", BETWEEN, apart, ANGLES, ROUNDING, "angle", "volume"),
]

# -- size -------------------------------------------------------------------------------------------------

SIZES = geometric(1e-3, 1e5, 33)
TIMES = "size, times that of the design"


def sized(size: float) -> Case:
    """The plane failure with its crack and water, scaled with its cohesion."""
    return plane(height=12 * size, c=25 * size, crack=4.35 * size, water=3 * size)


SIZE = [
    Sweep(
        "wedge, c with the size",
        TIMES,
        lambda s: wedge(PAPER, height=64.89 * s, c=50 * s),
        SIZES,
        ROUNDING,
        "size",
    ),
    Sweep(
        "wedge, c = 0",
        TIMES,
        lambda s: wedge(PAPER, height=64.89 * s, c=0),
        SIZES,
        ROUNDING,
        "size",
    ),
    Sweep(
        "wedge, c stays", TIMES, lambda s: wedge(WYLLIE, height=30.0 * s), SIZES, ROUNDING, "size"
    ),
    Sweep("plane, crack, water", TIMES, sized, SIZES, ROUNDING, "size"),
    Sweep(
        "footing",
        TIMES,
        lambda s: footing(2000 * s * s, 40, 8 * s, 120 * s),
        SIZES,
        ROUNDING,
        "size",
    ),
    Sweep("sphere, φ = 0", TIMES, lambda s: sphere(10 * s, 20 * s), SIZES[::4], MESH, "size"),
    Sweep("block", TIMES, lambda s: stack(c=3 * s, size=s), SIZES, SECTION, "size-blocks"),
    Sweep(
        "stack of six",
        TIMES,
        lambda s: stack(30, 1, 30, many=6, size=s),
        SIZES,
        SECTION,
        "size-blocks",
    ),
    Sweep(
        "toppling columns",
        TIMES,
        lambda s: columns(size=s),
        SIZES[::2],
        SECTION,
        "size-blocks",
        statuses=("slides",),
    ),
    Sweep("bench", TIMES, bench, SIZES[::4], SPACE, "size-blocks"),
]

# -- offset -----------------------------------------------------------------------------------------------

OFFSETS = (0.1, *geometric(1.0, 1e7, 29))
FAR = "offset of the coordinates, m"
OFFSET = [
    Sweep("wedge", FAR, lambda x: wedge(WYLLIE, x), OFFSETS, ROUNDING, "offset"),
    Sweep("wedge: volume", FAR, lambda x: wedge(WYLLIE, x), OFFSETS, ROUNDING, "offset", "volume"),
    Sweep(
        "wedge: coordinates",
        FAR,
        lambda x: wedge(WYLLIE, x),
        OFFSETS,
        LAST_DIGITS,
        "offset",
        "coordinates",
    ),
    Sweep(
        "stack of six", FAR, lambda x: stack(30, 1, 30, many=6, shift=x), OFFSETS, SECTION, "offset"
    ),
    Sweep(
        "stack: volume",
        FAR,
        lambda x: stack(30, 1, 30, many=6, shift=x),
        OFFSETS,
        (1e-8, "corners of 1 m given as floats at 1e7 m: 2e-9 of a side"),
        "offset",
        "volume",
    ),
    Sweep("sphere, φ = 0", FAR, lambda x: sphere(shift=x), OFFSETS[1::4], MESH, "offset"),
    Sweep("bench", FAR, lambda x: bench(shift=x), OFFSETS[1::7], SPACE, "offset"),
]

# -- aspect -----------------------------------------------------------------------------------------------

ASPECTS = geometric(1.0, 1e5, 31)
SLENDER = "aspect: how many times as long, thin or slender"


def long_wedge(aspect: float) -> Case:
    """A wedge whose line of intersection meets the upper slope `aspect` times as far away as on level ground."""
    line = math.tan(math.radians(45)) * math.cos(math.radians(65))
    return wedge(upper=(math.degrees(math.atan(line * (1 - 1 / aspect))), 180))


def thin_wedge(aspect: float) -> Case:
    """A wedge whose line of intersection plunges 1/aspect (in radians, at most 0.5) less than the face dips."""
    return beneath_the_face(math.degrees(0.5 / aspect))


def beneath_the_face(gap: float) -> Case:
    """A wedge whose line of intersection plunges `gap` degrees less than the face (60°) dips."""
    dip = math.degrees(math.atan(math.tan(math.radians(60 - gap)) / math.cos(math.radians(30))))
    return wedge(dips=((dip, 150), (dip, 210)))


def leaning(aspect: float) -> Case:
    """A column `aspect` times as high as wide that leans half as far as tips it."""
    return stack(1, aspect, math.degrees(math.atan(0.5 / aspect)))


ASPECT = [
    Sweep("long wedge", SLENDER, long_wedge, ASPECTS, ROUNDING, "aspect"),
    Sweep("long wedge: volume", SLENDER, long_wedge, ASPECTS, ROUNDING, "aspect", "volume"),
    Sweep("thin wedge", SLENDER, thin_wedge, ASPECTS, ROUNDING, "aspect"),
    Sweep("long plane", SLENDER, lambda a: plane(upper=35 - 20 / a), ASPECTS, ROUNDING, "aspect"),
    Sweep("thin plane", SLENDER, lambda a: plane(dip=60 - 25 / a), ASPECTS, ROUNDING, "aspect"),
    Sweep("long plate", SLENDER, lambda a: stack(1.1 * a, 1, c=3), ASPECTS, SECTION, "aspect"),
    Sweep("slender column", SLENDER, leaning, ASPECTS, SECTION, "aspect", statuses=("topples",)),
    Sweep(
        "stack of six plates",
        SLENDER,
        lambda a: stack(30 * a, 1, 30, many=6),
        geometric(1.0, 1e4, 21),
        SECTION,
        "aspect",
    ),
    Sweep(
        "bench: length",
        SLENDER,
        lambda a: bench(length=30 * a, spacings=(9, 12, 14 * a)),
        geometric(1.0, 5.0, 5),
        SPACE,
        "aspect",
        statuses=("topples", "rotates"),
    ),
]

# -- stiffness --------------------------------------------------------------------------------------------

RATIOS = geometric(1.0, 1e6, 31)
STIFFER = "k_n / k_t"


def sheared(base: object, ratio: float) -> Case:
    """A wedge with the paper's search for the factor at which all pairs have failed."""
    assert isinstance(base, dict)
    return wedge(base, normal_stiffness=1e7, shear_stiffness=1e7 / ratio, criterion="all-pairs")


STIFFNESS = [
    Sweep("paper's wedge", STIFFER, lambda r: sheared(PAPER, r), RATIOS, ROUNDING, "stiffness"),
    Sweep(
        "Wyllie & Mah's wedge", STIFFER, lambda r: sheared(WYLLIE, r), RATIOS, ROUNDING, "stiffness"
    ),
    Sweep(
        "plane",
        STIFFER,
        lambda r: plane(stiffness=r, criterion="all-pairs"),
        RATIOS,
        ROUNDING,
        "stiffness",
    ),
]

# -- water ------------------------------------------------------------------------------------------------

#: With moments a block may turn where the closed form still has it slide.
TURNS = ("rotates", "topples", "slides_on_J1", "slides_on_J2", "slides_up")
WATER_LABEL = "mean water pressure, kPa"
WATER = [
    Sweep(
        "wedge: both joints",
        WATER_LABEL,
        lambda u: wedge(WYLLIE, water=(u, u)),
        even(0.0, 200.0, 41),
        PASSES,
        "water",
        logarithmic=False,
        statuses=TURNS,
    ),
    Sweep(
        "wedge: J1",
        WATER_LABEL,
        lambda u: wedge(WYLLIE, water=(u, 0.0)),
        even(0.0, 400.0, 41),
        PASSES,
        "water",
        logarithmic=False,
        statuses=TURNS,
    ),
    Sweep(
        "wedge: J2",
        WATER_LABEL,
        lambda u: wedge(WYLLIE, water=(0.0, u)),
        even(0.0, 400.0, 41),
        PASSES,
        "water",
        logarithmic=False,
        statuses=TURNS,
    ),
    Sweep(
        "symmetric wedge",
        WATER_LABEL,
        lambda u: wedge(PAPER, water=(u, u)),
        even(0.0, 500.0, 41),
        PASSES,
        "water",
        logarithmic=False,
        statuses=TURNS,
    ),
    Sweep(
        "plane",
        WATER_LABEL,
        lambda u: plane(pressure=u),
        even(0.0, 80.0, 41),
        PASSES,
        "water",
        logarithmic=False,
        statuses=TURNS,
    ),
    Sweep(
        "block",
        WATER_LABEL,
        lambda u: stack(c=3, pressure=u),
        even(0.0, 30.0, 31),
        SECTION,
        "water",
        logarithmic=False,
        statuses=("topples", "falls"),
    ),
]

# -- a pull uphill, off one plane, an earthquake ------------------------------------------------------------

_EXACT = exact_wedge(**PAPER)
_WEIGHT = float(_EXACT.weight)


def pulled(share: float) -> Case:
    """The paper's wedge pulled uphill, 20° above the horizontal, with a share of its weight."""
    up = [float(x) for x in line_vector(0, -20)]
    return wedge(PAPER, forces=[tuple(share * _WEIGHT * x for x in up)])


def unloaded(left: float) -> Case:
    """The paper's wedge with J2 pulled off (square to it, outward) but for a part of its normal force."""
    outward = [float(x * _EXACT.normal[1]) for x in plane_normal(PAPER["dips"][1])]
    return wedge(PAPER, forces=[tuple((1.0 - left) * x for x in outward)])


def facing(direction: float) -> Case:
    """A steep second joint whose dip direction turns until it leaves the first one alone in contact."""
    return wedge(dips=((40, 160), (80, direction)), face=(65, 180))


LOADS = [
    Sweep(
        "wedge pulled uphill",
        "pull, parts of the weight",
        pulled,
        even(0.0, 1.2, 49),
        ROUNDING,
        "pull",
        logarithmic=False,
    ),
    Sweep(
        "plane pulled uphill",
        "pull, parts of the weight",
        lambda x: plane(force=(-1835.0 * x, 0.0)),
        even(0.0, 1.2, 49),
        ROUNDING,
        "pull",
        logarithmic=False,
    ),
    Sweep(
        "normal force on J2 towards nothing",
        "what is left of the normal force on J2",
        unloaded,
        geometric(1.0, 1e-12, 37),
        PASSES,
        "unloaded",
        statuses=TURNS,
    ),
    Sweep(
        "dip direction of J2",
        "dip direction of J2, degrees",
        facing,
        even(196.0, 300.0, 53),
        PASSES,
        "facing",
        logarithmic=False,
        statuses=TURNS,
    ),
    Sweep(
        "steep wedge, earthquake",
        "seismic coefficient",
        lambda k: wedge(STEEP, seismic=(k, 180.0)),
        even(0.0, 2.0, 41),
        PASSES,
        "seismic",
        logarithmic=False,
        statuses=TURNS,
    ),
    Sweep(
        "plane, earthquake",
        "seismic coefficient",
        lambda k: plane(seismic=k),
        even(0.0, 2.0, 41),
        PASSES,
        "seismic",
        logarithmic=False,
        statuses=TURNS,
    ),
]

# -- plunge and dips ----------------------------------------------------------------------------------------


def upright(short: float) -> Case:
    """Joints that dip `short` degrees less than 90 below a face that is steeper still, by 0.6 of that."""
    return wedge(
        dips=((90 - 1.01 * short, 120), (90 - 1.01 * short, 240)), face=(90 - 0.4 * short, 180)
    )


DIPS = [
    Sweep(
        "wedge: plunge below the face",
        "plunge less than the dip of the face, degrees",
        beneath_the_face,
        geometric(30.0, 1e-3, 41),
        ROUNDING,
        "plunge",
    ),
    Sweep(
        "wedge: volume",
        "plunge less than the dip of the face, degrees",
        beneath_the_face,
        geometric(30.0, 1e-3, 41),
        ROUNDING,
        "plunge",
        "volume",
    ),
    Sweep(
        "plane: dip below the face",
        "plunge less than the dip of the face, degrees",
        lambda x: plane(dip=60 - x),
        geometric(30.0, 1e-3, 41),
        ROUNDING,
        "plunge",
    ),
    Sweep(
        "flat wedge",
        "dip of the joints, degrees",
        lambda d: wedge(dips=((d, 100), (d, 260))),
        geometric(0.05, 55.0, 41),
        ROUNDING,
        "flat",
    ),
    Sweep(
        "flat plane",
        "dip of the joints, degrees",
        lambda d: plane(dip=d),
        geometric(0.05, 55.0, 41),
        ROUNDING,
        "flat",
    ),
    Sweep(
        "flat footing",
        "dip of the joints, degrees",
        lambda d: footing(dip=d),
        geometric(0.05, 55.0, 41),
        ROUNDING,
        "flat",
    ),
    Sweep(
        "flat block",
        "dip of the joints, degrees",
        lambda d: stack(dip=d),
        geometric(1e-4, 14.0, 31),
        SECTION,
        "flat",
    ),
    Sweep(
        "steep wedge",
        "dip short of 90 degrees",
        upright,
        geometric(40.0, 0.05, 41),
        ROUNDING,
        "steep",
    ),
    Sweep(
        "steep plane",
        "dip short of 90 degrees",
        lambda x: plane(face=90 - x / 2, dip=90 - x),
        geometric(40.0, 1e-3, 41),
        ROUNDING,
        "steep",
    ),
    Sweep(
        "steep footing",
        "dip short of 90 degrees",
        lambda x: footing(dip=90 - x),
        geometric(40.0, 0.1, 31),
        ROUNDING,
        "steep",
    ),
]

# -- strength -----------------------------------------------------------------------------------------------

FRICTIONS = (0.0, *even(2.0, 88.0, 44), 88.5, 89.0)
COHESIONS = (0.0, *geometric(1e-6, 1e6, 37))
STRENGTH = [
    Sweep(
        "wedge",
        "φ, degrees",
        lambda f: wedge(WYLLIE, phi=f),
        FRICTIONS,
        ROUNDING,
        "friction",
        logarithmic=False,
    ),
    Sweep(
        "wedge, c = 0",
        "φ, degrees",
        lambda f: wedge(PAPER, c=0, phi=f),
        FRICTIONS,
        ROUNDING,
        "friction",
        logarithmic=False,
    ),
    Sweep(
        "plane",
        "φ, degrees",
        lambda f: plane(phi=f),
        FRICTIONS,
        ROUNDING,
        "friction",
        logarithmic=False,
    ),
    Sweep(
        "block",
        "φ, degrees",
        lambda f: stack(phi=f),
        FRICTIONS,
        SECTION,
        "friction",
        logarithmic=False,
        statuses=("falls",),
    ),
    Sweep("wedge", "c, kPa", lambda c: wedge(WYLLIE, c=c), COHESIONS, ROUNDING, "cohesion"),
    Sweep(
        "wedge, φ = 0",
        "c, kPa",
        lambda c: wedge(WYLLIE, c=c, phi=0),
        COHESIONS,
        ROUNDING,
        "cohesion",
    ),
    Sweep("plane, φ = 0", "c, kPa", lambda c: plane(c=c, phi=0), COHESIONS, ROUNDING, "cohesion"),
    Sweep("block", "c, kPa", lambda c: stack(c=c), COHESIONS, SECTION, "cohesion"),
]

SWEEPS = [*ANGLE, *SIZE, *OFFSET, *ASPECT, *STIFFNESS, *WATER, *LOADS, *DIPS, *STRENGTH]
