"""The columns of joint lists: their names in English and German, those that give a plane, and preambles above them.

A new name, a new set of columns that gives a plane, or a new program needs one line in one of these tables.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.design.reading.nodes import cut

RIGHT, LEFT = "right-hand-rule", "left-hand-rule"
#: Dip direction minus strike in degrees, by convention.
STRIKE_TO_DIP_DIRECTION: Mapping[str, float] = {RIGHT: 90.0, LEFT: -90.0}
#: Other names of the conventions.
_CONVENTIONS: Mapping[str, str] = {
    "rhr": RIGHT,
    "right": RIGHT,
    "right_hand_rule": RIGHT,
    "r": RIGHT,
    "lhr": LEFT,
    "left": LEFT,
    "left_hand_rule": LEFT,
    "l": LEFT,
}
_SHORT = ("rhr", "lhr")

#: Names of the columns as `normalized_heading` gives them; of several columns with a key, the first name here wins.
COLUMNS: Mapping[str, tuple[str, ...]] = {
    "dip": (
        "dip",
        "dip_angle",
        "dip_deg",
        "disc_dip",
        "fallwinkel",
        "einfallwinkel",
        "einfallen",
        "neigung",
    ),
    "dip_direction": (
        "dip_direction",
        "dipdirection",
        "dip_dir",
        "dipdir",
        "dip_dirn",
        "dipdirn",
        "dd",
        "ddr",
        "dip_azimuth",
        "dipazimuth",
        "azimuth",
        "azi",
        "direction",
        "dip_direction_deg",
        "disc_dir",
        "fallrichtung",
        "einfallrichtung",
        "einfallsrichtung",
        "fallazimut",
        "azimut",
    ),
    "strike": (
        "strike",
        "strike_deg",
        "streichen",
        "streichrichtung",
        "strike_right",
        "strike_rhr",
        "strike_r",
        "strike_left",
        "strike_lhr",
        "strike_l",
    ),
    "trend": ("trend", "pole_trend", "trend_of_pole", "poltrend"),
    "plunge": ("plunge", "pole_plunge", "plunge_of_pole", "polplunge"),
    "plane": (
        "plane",
        "orientation",
        "attitude",
        "dip/dip_direction",
        "dip/dipdirection",
        "dip/dipdir",
        "dip/dd",
        "lage",
        "raumlage",
    ),
    "clar": (
        "clar",
        "clarwert",
        "dd/dip",
        "dip_direction/dip",
        "dipdir/dip",
        "fallrichtung/fallwinkel",
    ),
    "strike/dip": ("strike/dip", "streichen/fallen", "streichen/einfallen"),
    "name": (
        "name",
        "id",
        "joint",
        "joint_id",
        "kluft",
        "trennfläche",
        "bezeichnung",
        "nr",
        "index",
        "disc_numb",
    ),
    "set": (
        "set",
        "joint_set",
        "set_id",
        "family",
        "family_ind",
        "frac_set",
        "disc_set",
        "schar",
        "kluftschar",
        "kluftset",
    ),
    "c": ("c", "cohesion", "c_kpa", "cohesion_kpa", "kohäsion"),
    "phi": ("phi", "φ", "friction", "friction_angle", "phi_deg", "reibungswinkel"),
    "quantity": (
        "quantity",
        "qty",
        "count",
        "anzahl",
        "häufigkeit",
        "weight",
        "terzaghi_weight",
        "disc_weight",
    ),
    "alpha": ("alpha", "alpha_angle", "alpha_deg", "α", "core_angle", "angle_to_core_axis", "tca"),
    "beta": ("beta", "beta_angle", "beta_deg", "β", "beta_bottom", "beta_top"),
    "hole_trend": (
        "hole_trend",
        "trend_of_hole",
        "borehole_trend",
        "drillhole_trend",
        "core_trend",
        "hole_azimuth",
        "borehole_azimuth",
        "drillhole_azimuth",
        "core_azimuth",
    ),
    "hole_plunge": (
        "hole_plunge",
        "plunge_of_hole",
        "borehole_plunge",
        "drillhole_plunge",
        "core_plunge",
        "hole_dip",
        "borehole_dip",
        "drillhole_dip",
    ),
    "reference": (
        "reference",
        "reference_line",
        "reference_mark",
        "ref",
        "ref_line",
        "orientation_line",
        "orientation_mark",
    ),
    "hole": (
        "hole",
        "hole_id",
        "holeid",
        "borehole",
        "borehole_id",
        "drillhole",
        "drillhole_id",
        "bhid",
        "bh_id",
        "bh",
        "loca_id",
        "bohrung",
    ),
    "spacing": ("spacing", "spacing_m", "joint_spacing", "true_spacing", "abstand", "kluftabstand"),
    "position": (
        "position",
        "position_m",
        "distance",
        "distance_m",
        "chainage",
        "station",
        "scanline_position",
        "depth",
        "depth_m",
        "meter",
        "stationierung",
        "disc_top",
    ),
    "trace": (
        "trace",
        "trace_m",
        "trace_length",
        "trace_length_m",
        "length",
        "length_m",
        "spurlänge",
        "länge",
        "disc_pers",
    ),
    "ends": ("ends", "ends_seen", "visible_ends", "ends_visible", "sichtbare_enden"),
}
#: Columns of the sizes of joints, read only for studies that need them.
SIZES = ("spacing", "position", "trace", "ends")
#: Keys that may have two columns in a list: the column whose name comes first above is used.
RANKED = ("name", "quantity", "hole", "reference")
#: Counters, which are names of joints only where each number is unique.
COUNTERS = ("nr", "index", "disc_numb")
ORIENTATIONS = (
    "dip",
    "dip_direction",
    "strike",
    "trend",
    "plunge",
    "alpha",
    "beta",
    "hole_trend",
    "hole_plunge",
)
#: Columns of oriented core, with the line that beta is measured from.
CORE = ("alpha", "beta", "hole_trend", "hole_plunge", "reference")
BOTTOM, TOP = "bottom", "top"
#: Names of the reference line that beta is measured from.
REFERENCE_LINES: Mapping[str, str] = {
    "bottom": BOTTOM,
    "bottom_of_core": BOTTOM,
    "boc": BOTTOM,
    "boh": BOTTOM,
    "low": BOTTOM,
    "low_side": BOTTOM,
    "lower": BOTTOM,
    "unten": BOTTOM,
    "top": TOP,
    "top_of_core": TOP,
    "toc": TOP,
    "toh": TOP,
    "high": TOP,
    "high_side": TOP,
    "upper": TOP,
    "oben": TOP,
}
#: Sets of columns that give a plane, the preferred first.
PLANE_COLUMNS: tuple[tuple[str, ...], ...] = (
    ("dip", "dip_direction"),
    ("strike", "dip"),
    ("plane",),
    ("clar",),
    ("strike/dip",),
    CORE[:4],
    ("trend", "plunge"),
)
#: Headings read as a dip direction, with a note, as they might mean a strike or, in a list of core, the hole.
AMBIGUOUS_DIRECTIONS = ("azimuth", "azi", "azimut", "direction")
#: A strike, a dip, and the side it dips to in the column of the dip direction.
STRIKE_WITH_SIDE = ("strike", "dip", "dip_direction")
WORDS: Mapping[str, str] = {key: key.replace("_", " ") for key in COLUMNS}
_DEGREES = ("", "°", "deg", "degree", "degrees", "º")
_GERMAN = re.compile(r"fall|neigung|streich|azimut\b|pol(trend|plunge)|reibung|lage", re.IGNORECASE)
#: Columns whose headings may hold a convention, with the words for it.
_WORDS_IN_HEADING: Mapping[str, Mapping[str, str]] = {
    "strike": _CONVENTIONS,
    "beta": REFERENCE_LINES,
}
#: A number in a cell, with a decimal point or comma, in degrees or without a unit.
NUMBER = re.compile(r"^\s*[+-]?(\d+([.,]\d*)?|[.,]\d+)\s*°?\s*$")
_HEADER = re.compile(r"^(.*?)\s*(?:\(([^)]*)\)|\[([^\]]*)\])?\s*$")


@dataclass(frozen=True)
class SurveyColumn:
    """A column of a joint list: its index and heading, with the unit or the convention in the heading."""

    index: int
    heading: str = ""
    unit: str = ""
    convention: str | None = None


#: Columns in the headers of planes by CloudCompare Compass, whose names may be repeated.
_COMPASS_PLANES = frozenset(("strike", "dip", "dip_dir", "nx", "ny", "nz"))
#: Other files of CloudCompare Compass, by their columns, with the reason why they hold no joints.
_LISTS_WITHOUT_JOINTS: Mapping[frozenset[str], str] = {
    frozenset(
        ("sx", "sy", "sz", "ex", "ey", "ez", "trend", "plunge")
    ): "are lines between two points: lineations or thicknesses, no poles of joints",
    frozenset(
        ("trace_id", "start_x", "end_x", "cost")
    ): "are the segments of traces, no joints: its planes stand in the file that ends in _planes",
}


def checked_convention(word: str, location: str) -> str:
    """Return the strike convention of a word: a long name, RHR, LHR. Raises DesignError E192 for an unknown word.

    >>> checked_convention("RHR", ""), checked_convention("left-hand-rule", "")
    ('right-hand-rule', 'left-hand-rule')
    """
    lower = word.strip().lower()
    convention = _CONVENTIONS[lower] if lower in _SHORT else lower
    if convention not in STRIKE_TO_DIP_DIRECTION:
        advice = did_you_mean(
            word.lower()[:80], STRIKE_TO_DIP_DIRECTION, "It is right-hand-rule or left-hand-rule."
        )
        message = f"the strike convention {cut(repr(word))} is not known"
        raise DesignError([Fault("E192", message, location, advice)])
    return convention


def number_in(text: str) -> float | None:
    """Return the number in a cell; None for any other text.

    >>> number_in("45,5°"), number_in("N25E")
    (45.5, None)
    """
    return float(text.replace(",", ".").strip(" °")) if NUMBER.match(text) else None


def normalized_heading(heading: str) -> str:
    """Return a heading without its unit, in lower case, with _ for blanks and hyphens.

    >>> normalized_heading(" Dip-Direction (°)"), normalized_heading("DIP / DIP DIRECTION")
    ('dip_direction', 'dip/dip_direction')
    >>> normalized_heading("Family ind.")
    'family_ind'
    """
    bare = _split(heading)[0].strip().lower().lstrip("#* ").rstrip(".")
    return re.sub(r"_*/_*", "/", re.sub(r"[\s\-]+", "_", bare))


def key_of(heading: str) -> str | None:
    """Return the key of a column in `COLUMNS`; None where its heading is unknown."""
    name = normalized_heading(heading)
    return next((key for key, names in COLUMNS.items() if name in names), None)


def column_of(index: int, heading: str) -> SurveyColumn:
    """Return a column from its heading; `Strike (RHR)`, `strike_right` and `beta (bottom)` give their convention.

    Grad means degrees in a German heading, and gon in an English one.
    """
    name, bracket_text = _split(heading)
    last = (
        normalized_heading(bracket_text)
        if bracket_text
        else normalized_heading(name).rpartition("_")[2]
    )
    convention = _WORDS_IN_HEADING.get(key_of(name) or "", {}).get(last)
    is_degrees = bracket_text.lower() in _DEGREES or (
        bracket_text.lower() == "grad" and _GERMAN.search(name) is not None
    )
    return SurveyColumn(
        index,
        heading,
        "" if is_degrees or (bracket_text and convention) else bracket_text,
        convention,
    )


def unit_in_heading(heading: str) -> str:
    """Return the text in brackets after a heading, empty without one."""
    return _split(heading)[1]


def plane_columns(keys: Iterable[str | None]) -> tuple[str, ...] | None:
    """Return the keys of the columns that give the plane; None where they do not suffice."""
    present = set(keys)
    return next(
        (plane_keys for plane_keys in PLANE_COLUMNS if present.issuperset(plane_keys)), None
    )


def names_may_repeat(headings: Sequence[str]) -> bool:
    """Return whether a list with these headings comes from a program that repeats names."""
    return set(map(normalized_heading, headings)) >= _COMPASS_PLANES


def reason_without_joints(headings: Sequence[str]) -> str:
    """Return the reason why a list with these headings holds no joints; empty where it may hold some."""
    names = set(map(normalized_heading, headings))
    return next(
        (reason for columns, reason in _LISTS_WITHOUT_JOINTS.items() if columns <= names), ""
    )


def _split(heading: str) -> tuple[str, str]:
    match = _HEADER.match(heading)
    if match is None:  # a line break in a cell
        return heading, ""
    return match.group(1), (match.group(2) or match.group(3) or "").strip()


def headings_in_order(columns: str | Sequence[str] | None) -> tuple[str, ...]:
    """Return the headings that the user gives for the columns, `dip_direction,dip` or a list; () for None.

    >>> headings_in_order("dip_direction, dip"), headings_in_order(["dip", "dip direction"]), headings_in_order(None)
    (('dip_direction', 'dip'), ('dip', 'dip direction'), ())
    """
    if columns is None:
        return ()
    names = re.split("[,;]", columns) if isinstance(columns, str) else columns
    if not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        message = f"columns are {type(columns).__name__}, their names in order are needed"
        raise DesignError([Fault("E191", message, "columns", 'Give "dip_direction,dip".')])
    return tuple(name.strip() for name in names)


def columns_advice(option: str, columns: Sequence[str]) -> str:
    """Return the advice how to name columns, in the style of `option`: an option, a key, an argument, or empty.

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


# -- the preamble above the header ------------------------------------------------------------------------------------

#: Preambles of Dips have the orientation format, declination, quantities and traverses. Declination is added to every
#: azimuth (Rocscience, Dips documentation, Declination: east positive).
_DIP = r"\bDIP\s*/\s*DIP\s*-?\s*DIR(?:ECTION|N)?\b"
#: Formats of the two orientation columns: pattern, keys of the columns, convention of the strike.
FORMATS: tuple[tuple[str, tuple[str, ...], str | None], ...] = (
    (_DIP, ("dip", "dip_direction"), None),
    (
        r"\bSTRIKE\s*(?:\(?\s*RIGHT\s*\)?)\s*/\s*DIP\b|\bSTRIKE\s*/\s*DIPR\b",
        ("strike", "dip"),
        RIGHT,
    ),
    (r"\bSTRIKE\s*(?:\(?\s*LEFT\s*\)?)\s*/\s*DIP\b|\bSTRIKE\s*/\s*DIPL\b", ("strike", "dip"), LEFT),
    (r"\bSTRIKE\s*/\s*DIP\b", ("strike", "dip"), None),
    (r"\bTREND\s*/\s*PLUNGE\b", ("trend", "plunge"), None),
)
_DECLINATION_ANGLE = r"([+-]?\d+(?:[.,]\d+)?)"
_DECLINATION = re.compile(
    rf"DECLINATION\b[^\d+\-]*{_DECLINATION_ANGLE}|^\s*{_DECLINATION_ANGLE}\s*\(?\s*DECLINATION",
    re.IGNORECASE,
)
_TRAVERSES = re.compile(r"TRAVERSES\b[^\d]*(\d+)|^\s*(\d+)\s*\(?\s*TRAVERSES", re.IGNORECASE)
_QUANTITY = re.compile(r"\bQUANTIT", re.IGNORECASE)
_NEGATION = re.compile(r"\bNO\b|\bNONE\b|\bOFF\b|\b0\b", re.IGNORECASE)
_CORE_FORMAT = re.compile(r"\bORIENTED\s+CORE\b|\bALPHA\s*/\s*BETA\b", re.IGNORECASE)


@dataclass(frozen=True)
class Preamble:
    """The contents of a preamble.

    Attributes
    ----------
    columns, convention, written : keys, strike convention and text of the orientation format; () without one
    other_formats : texts of further formats, of traverses
    core : whether the orientations are measured on oriented core
    declination_deg : declination, added to azimuths
    has_quantity : whether the third column has quantities
    traverses : number of traverses
    """

    columns: tuple[str, ...] = ()
    convention: str | None = None
    written: str = ""
    other_formats: tuple[str, ...] = ()
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
            has_quantity = not _NEGATION.search(line)
    core = any(_CORE_FORMAT.search(line) for line in lines)
    if not formats:
        return Preamble((), None, "", (), core, declination, has_quantity, traverses)
    (written, (columns, convention)), *rest = formats.items()
    other_formats = tuple(word for word, meaning in rest if meaning != (columns, convention))
    return Preamble(
        columns, convention, written, other_formats, core, declination, has_quantity, traverses
    )
