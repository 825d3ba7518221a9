"""What the columns of joint lists are called, in English and German, which of them give a plane, what lines above say.

A new name, a new way to give a plane, a new program whose lists are known: one line in one of these tables.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.design.reading.nodes import cut

RIGHT, LEFT = "right-hand-rule", "left-hand-rule"
#: Dip direction less strike by each convention.
STRIKE_TO_DIP_DIRECTION: Mapping[str, float] = {RIGHT: 90.0, LEFT: -90.0}
#: What a convention may be called besides its own name.
_CONVENTIONS: Mapping[str, str] = {
    "rhr": RIGHT, "right": RIGHT, "right_hand_rule": RIGHT, "r": RIGHT,
    "lhr": LEFT, "left": LEFT, "left_hand_rule": LEFT, "l": LEFT,
}  # fmt: skip
_SHORT = ("rhr", "lhr")

#: What a column may be called, as `spelled` writes it; of several columns of names the first name given here wins.
COLUMNS: Mapping[str, tuple[str, ...]] = {
    "dip": ("dip", "dip_angle", "dip_deg", "disc_dip", "fallwinkel", "einfallwinkel", "einfallen", "neigung"),
    "dip_direction": (
        "dip_direction", "dipdirection", "dip_dir", "dipdir", "dip_dirn", "dipdirn", "dd", "ddr", "dip_azimuth",
        "dipazimuth", "azimuth", "azi", "direction", "dip_direction_deg", "disc_dir", "fallrichtung",
        "einfallrichtung", "einfallsrichtung", "fallazimut", "azimut",
    ),
    "strike": (
        "strike", "strike_deg", "streichen", "streichrichtung", "strike_right", "strike_rhr", "strike_r", "strike_left",
        "strike_lhr", "strike_l",
    ),
    "trend": ("trend", "pole_trend", "trend_of_pole", "poltrend"),
    "plunge": ("plunge", "pole_plunge", "plunge_of_pole", "polplunge"),
    "plane": (
        "plane", "orientation", "attitude", "dip/dip_direction", "dip/dipdirection", "dip/dipdir", "dip/dd", "lage",
        "raumlage",
    ),
    "clar": ("clar", "clarwert", "dd/dip", "dip_direction/dip", "dipdir/dip", "fallrichtung/fallwinkel"),
    "strike/dip": ("strike/dip", "streichen/fallen", "streichen/einfallen"),
    "name": (
        "name", "id", "joint", "joint_id", "kluft", "trennfläche", "bezeichnung", "nr", "index", "disc_numb",
    ),
    "set": (
        "set", "joint_set", "set_id", "family", "family_ind", "frac_set", "disc_set", "schar", "kluftschar", "kluftset",
    ),
    "c": ("c", "cohesion", "c_kpa", "cohesion_kpa", "kohäsion"),
    "phi": ("phi", "φ", "friction", "friction_angle", "phi_deg", "reibungswinkel"),
    "quantity": ("quantity", "qty", "count", "anzahl", "häufigkeit", "weight", "terzaghi_weight", "disc_weight"),
    "alpha": ("alpha", "alpha_angle", "alpha_deg", "α", "core_angle", "angle_to_core_axis", "tca"),
    "beta": ("beta", "beta_angle", "beta_deg", "β", "beta_bottom", "beta_top"),
    "hole_trend": (
        "hole_trend", "trend_of_hole", "borehole_trend", "drillhole_trend", "core_trend", "hole_azimuth",
        "borehole_azimuth", "drillhole_azimuth", "core_azimuth",
    ),
    "hole_plunge": (
        "hole_plunge", "plunge_of_hole", "borehole_plunge", "drillhole_plunge", "core_plunge", "hole_dip",
        "borehole_dip", "drillhole_dip",
    ),
    "reference": (
        "reference", "reference_line", "reference_mark", "ref", "ref_line", "orientation_line", "orientation_mark",
    ),
    "hole": (
        "hole", "hole_id", "holeid", "borehole", "borehole_id", "drillhole", "drillhole_id", "bhid", "bh_id", "bh",
        "loca_id", "bohrung",
    ),
    "spacing": ("spacing", "spacing_m", "joint_spacing", "true_spacing", "abstand", "kluftabstand"),
    "position": (
        "position", "position_m", "distance", "distance_m", "chainage", "station", "scanline_position", "depth",
        "depth_m", "meter", "stationierung", "disc_top",
    ),
    "trace": (
        "trace", "trace_m", "trace_length", "trace_length_m", "length", "length_m", "spurlänge", "länge", "disc_pers",
    ),
    "ends": ("ends", "ends_seen", "visible_ends", "ends_visible", "sichtbare_enden"),
}  # fmt: skip
#: Columns of the sizes of joints, which only a study that asks for them reads.
SIZES = ("spacing", "position", "trace", "ends")
#: Of these, two columns may stand in a list: the name that is given first above is taken.
RANKED = ("name", "quantity", "hole", "reference")
#: Numbers that are names only where each stands once.
COUNTERS = ("nr", "index", "disc_numb")
ORIENTATIONS = (
    "dip", "dip_direction", "strike", "trend", "plunge", "alpha", "beta", "hole_trend", "hole_plunge",
)  # fmt: skip
#: Columns of oriented core, with the line that beta is measured from.
CORE = ("alpha", "beta", "hole_trend", "hole_plunge", "reference")
BOTTOM, TOP = "bottom", "top"
#: What the line that beta is measured from may be called.
REFERENCE_LINES: Mapping[str, str] = {
    "bottom": BOTTOM, "bottom_of_core": BOTTOM, "boc": BOTTOM, "boh": BOTTOM, "low": BOTTOM, "low_side": BOTTOM,
    "lower": BOTTOM, "unten": BOTTOM, "top": TOP, "top_of_core": TOP, "toc": TOP, "toh": TOP, "high": TOP,
    "high_side": TOP, "upper": TOP, "oben": TOP,
}  # fmt: skip
#: Columns that give a plane together, best first.
WAYS: tuple[tuple[str, ...], ...] = (
    ("dip", "dip_direction"), ("strike", "dip"), ("plane",), ("clar",), ("strike/dip",), CORE[:4],
    ("trend", "plunge"),
)  # fmt: skip
#: Headings of a dip direction that might be meant for a strike, or beside core for the hole: how they are read is said.
AMBIGUOUS_DIRECTIONS = ("azimuth", "azi", "azimut", "direction")
#: A strike, a dip, and the side it dips to where a dip direction would stand.
STRIKE_WITH_SIDE = ("strike", "dip", "dip_direction")
WORDS: Mapping[str, str] = {key: key.replace("_", " ") for key in COLUMNS}
_DEGREES = ("", "°", "deg", "degree", "degrees", "º")
_GERMAN = re.compile(r"fall|neigung|streich|azimut\b|pol(trend|plunge)|reibung|lage", re.IGNORECASE)
#: Columns whose heading may hold a convention, and the words for it.
_WORDS_IN_HEADING: Mapping[str, Mapping[str, str]] = {"strike": _CONVENTIONS, "beta": REFERENCE_LINES}
#: A number as it stands in a cell, with a decimal point or comma, in degrees or without a unit.
NUMBER = re.compile(r"^\s*[+-]?(\d+([.,]\d*)?|[.,]\d+)\s*°?\s*$")
_HEADER = re.compile(r"^(.*?)\s*(?:\(([^)]*)\)|\[([^\]]*)\])?\s*$")


@dataclass(frozen=True)
class SurveyColumn:
    """Where a column stands, what it is called in the list, the unit or the convention in its header."""

    index: int
    heading: str = ""
    unit: str = ""
    convention: str | None = None


#: All of these columns stand in the header of planes by CloudCompare Compass, whose names may stand twice.
_COMPASS_PLANES = frozenset(("strike", "dip", "dip_dir", "nx", "ny", "nz"))
#: Why lists whose headers have all of these columns hold no joints: other files of CloudCompare Compass.
_NO_JOINTS: Mapping[frozenset[str], str] = {
    frozenset(("sx", "sy", "sz", "ex", "ey", "ez", "trend", "plunge")):
        "are lines between two points: lineations or thicknesses, no poles of joints",
    frozenset(("trace_id", "start_x", "end_x", "cost")):
        "are the segments of traces, no joints: its planes stand in the file that ends in _planes",
}  # fmt: skip


def checked_convention(word: str, where: str) -> str:
    """The strike convention that a word means: a long name, RHR, LHR. Raises DesignError E192 where it is not known.

    >>> checked_convention("RHR", ""), checked_convention("left-hand-rule", "")
    ('right-hand-rule', 'left-hand-rule')
    """
    lower = word.strip().lower()
    convention = _CONVENTIONS[lower] if lower in _SHORT else lower
    if convention not in STRIKE_TO_DIP_DIRECTION:
        advice = did_you_mean(word.lower()[:80], STRIKE_TO_DIP_DIRECTION, "It is right-hand-rule or left-hand-rule.")
        message = f"the strike convention {cut(repr(word))} is not known"
        raise DesignError([Fault("E192", message, where, advice)])
    return convention


def number_in(text: str) -> float | None:
    """The number that a cell holds, None for any other text.

    >>> number_in("45,5°"), number_in("N25E")
    (45.5, None)
    """
    return float(text.replace(",", ".").strip(" °")) if NUMBER.match(text) else None


def spelled(heading: str) -> str:
    """A heading without its unit, in lower case, with _ for blanks and hyphens.

    >>> spelled(" Dip-Direction (°)"), spelled("Family ind."), spelled("DIP / DIP DIRECTION")
    ('dip_direction', 'family_ind', 'dip/dip_direction')
    """
    bare = _split(heading)[0].strip().lower().lstrip("#* ").rstrip(".")
    return re.sub(r"_*/_*", "/", re.sub(r"[\s\-]+", "_", bare))


def key_of(heading: str) -> str | None:
    """What a column holds, None where its name is not known."""
    name = spelled(heading)
    return next((key for key, names in COLUMNS.items() if name in names), None)


def column_of(index: int, heading: str) -> SurveyColumn:
    """A column from its heading; `Strike (RHR)`, `strike_right` and `beta (bottom)` carry their convention.

    Grad in a German heading are degrees; in an English one they are gon.
    """
    bare, within = _split(heading)
    last = spelled(within) if within else spelled(bare).rpartition("_")[2]
    convention = _WORDS_IN_HEADING.get(key_of(bare) or "", {}).get(last)
    is_degrees = within.lower() in _DEGREES or (within.lower() == "grad" and _GERMAN.search(bare) is not None)
    return SurveyColumn(index, heading, "" if is_degrees or (within and convention) else within, convention)


def unit_in_heading(heading: str) -> str:
    """What stands in brackets behind a heading, empty where there is nothing."""
    return _split(heading)[1]


def plane_columns(keys: Iterable[str | None]) -> tuple[str, ...] | None:
    """The columns that give the plane, None where they do not suffice."""
    there = set(keys)
    return next((way for way in WAYS if there.issuperset(way)), None)


def names_may_repeat(headings: Sequence[str]) -> bool:
    """Whether the program that wrote a list with these headings gives a name twice."""
    return set(map(spelled, headings)) >= _COMPASS_PLANES


def why_no_joints(headings: Sequence[str]) -> str:
    """Why a list with these headings holds no joints, empty where it may."""
    there = set(map(spelled, headings))
    return next((why for columns, why in _NO_JOINTS.items() if columns <= there), "")


def _split(heading: str) -> tuple[str, str]:
    match = _HEADER.match(heading)
    if match is None:  # a line break in a cell
        return heading, ""
    return match.group(1), (match.group(2) or match.group(3) or "").strip()


def named_in_order(columns: str | Sequence[str] | None) -> tuple[str, ...]:
    """The names of columns as the user lists them, () where none are: `dip_direction,dip`, or a list.

    >>> named_in_order("dip_direction, dip"), named_in_order(["dip", "dip direction"]), named_in_order(None)
    (('dip_direction', 'dip'), ('dip', 'dip direction'), ())
    """
    if columns is None:
        return ()
    parts = re.split("[,;]", columns) if isinstance(columns, str) else columns
    if not isinstance(parts, Sequence) or not all(isinstance(part, str) for part in parts):
        message = f"columns are {type(columns).__name__}, their names in order are needed"
        raise DesignError([Fault("E191", message, "columns", 'Give "dip_direction,dip".')])
    return tuple(part.strip() for part in parts)


def columns_advice(option: str, columns: Sequence[str]) -> str:
    """How the user names columns, by what a convention is given by: an option, a key, an argument, nothing.

    >>> columns_advice("--convention", ["dip", "dip_direction"]), columns_advice("convention:", ["clar"])
    ('--columns dip,dip_direction', 'columns: [clar]')
    """
    if not option:
        return f"name its columns {','.join(columns)}"
    if option.startswith("--"):
        return f"--columns {','.join(columns)}"
    if option.endswith(":"):
        return f"columns: [{', '.join(columns)}]"
    return f'columns = "{",".join(columns)}"'


# -- what stands above the header -------------------------------------------------------------------------------------

#: Of Dips: orientation format, declination, quantities, traverses. Declination is added to every azimuth (Rocscience,
#: Dips documentation, Declination: east positive).
_DIP = r"\bDIP\s*/\s*DIP\s*-?\s*DIR(?:ECTION|N)?\b"
#: Formats of the two orientation columns: how they are written, the columns, the convention of the strike.
FORMATS: tuple[tuple[str, tuple[str, ...], str | None], ...] = (
    (_DIP, ("dip", "dip_direction"), None),
    (r"\bSTRIKE\s*(?:\(?\s*RIGHT\s*\)?)\s*/\s*DIP\b|\bSTRIKE\s*/\s*DIPR\b", ("strike", "dip"), RIGHT),
    (r"\bSTRIKE\s*(?:\(?\s*LEFT\s*\)?)\s*/\s*DIP\b|\bSTRIKE\s*/\s*DIPL\b", ("strike", "dip"), LEFT),
    (r"\bSTRIKE\s*/\s*DIP\b", ("strike", "dip"), None),
    (r"\bTREND\s*/\s*PLUNGE\b", ("trend", "plunge"), None),
)
_DECLINED = r"([+-]?\d+(?:[.,]\d+)?)"
_DECLINATION = re.compile(rf"DECLINATION\b[^\d+\-]*{_DECLINED}|^\s*{_DECLINED}\s*\(?\s*DECLINATION", re.IGNORECASE)
_TRAVERSES = re.compile(r"TRAVERSES\b[^\d]*(\d+)|^\s*(\d+)\s*\(?\s*TRAVERSES", re.IGNORECASE)
_QUANTITY = re.compile(r"\bQUANTIT", re.IGNORECASE)
_NO = re.compile(r"\bNO\b|\bNONE\b|\bOFF\b|\b0\b", re.IGNORECASE)
_OF_CORE = re.compile(r"\bORIENTED\s+CORE\b|\bALPHA\s*/\s*BETA\b", re.IGNORECASE)


@dataclass(frozen=True)
class Preamble:
    """What a preamble says.

    Attributes
    ----------
    columns, convention, written : of the orientation format, and how it is written; () where none is named
    others : further formats, of traverses; core : measured on oriented core
    declination_deg : added to azimuths; has_quantity : a third column of quantities; traverses : how many
    """

    columns: tuple[str, ...] = ()
    convention: str | None = None
    written: str = ""
    others: tuple[str, ...] = ()
    core: bool = False
    declination_deg: float = 0.0
    has_quantity: bool = False
    traverses: int = 0


def preamble_of(lines: Sequence[str]) -> Preamble:
    """Read the lines above a header.

    >>> found = preamble_of(["Global Orientation is:", "STRIKE/DIPR", "Declination: -7.5", "NO QUANTITY"])
    >>> found.columns, found.convention, found.declination_deg, found.has_quantity
    (('strike', 'dip'), 'right-hand-rule', -7.5, False)
    """
    formats: dict[str, tuple[tuple[str, ...], str | None]] = {}
    declination, traverses, has_quantity = 0.0, 0, False
    for line in lines:
        for pattern, columns, convention in FORMATS:
            if match := re.search(pattern, line, re.IGNORECASE):
                formats.setdefault("".join(match.group().split()).upper(), (columns, convention))
                break
        if match := _DECLINATION.search(line):
            declination = float((match.group(1) or match.group(2)).replace(",", "."))
        if match := _TRAVERSES.search(line):
            traverses = int(match.group(1) or match.group(2))
        if _QUANTITY.search(line):
            has_quantity = not _NO.search(line)
    core = any(_OF_CORE.search(line) for line in lines)
    if not formats:
        return Preamble((), None, "", (), core, declination, has_quantity, traverses)
    (written, (columns, convention)), *rest = formats.items()
    others = tuple(word for word, meant in rest if meant != (columns, convention))
    return Preamble(columns, convention, written, others, core, declination, has_quantity, traverses)
