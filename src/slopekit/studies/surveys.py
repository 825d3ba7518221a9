"""Common parts of the studies of joint lists: options, heads of documents and sheets, strengths, the slope."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Any, Literal

from slopekit._version import FORMAT, __version__
from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault, Faults, Notice
from slopekit.core.orientation import number
from slopekit.core.sheet import Section, Sheet, Table, counted
from slopekit.design.fields import Field, declare
from slopekit.design.joint_lists import JointList, measured_or_common
from slopekit.design.words import value_text
from slopekit.kinds.wedge.design import WedgeDesign, wedge_design
from slopekit.studies.protocol import Argument, Option

MOST_JOINTS = 100_000  # most joints of studies that do not check every pair
MOST_NAMES = 24  # most names of joints that a sheet lists
_STRENGTHS: tuple[Literal["c", "phi"], ...] = ("c", "phi")


def _conventions(incomplete: str) -> list[str]:
    """Return the strike conventions that begin with a text, for completion in the shell."""
    from slopekit.design.survey.columns import STRIKE_TO_DIP_DIRECTION

    return [name for name in STRIKE_TO_DIP_DIRECTION if name.startswith(incomplete.lower())]


#: A survey: a file on a command line; in Python also a pandas or polars frame with such columns, planes ("45/115",
#: (45, 115)), an (n, 2) array or {name: plane}.
AJointList = Annotated[
    Any,
    Argument(
        "A joint list (CSV, .xlsx, AGS 4, Dips, CloudCompare): dips, strikes, poles, drill core.",
        "JOINTS",
    ),
]
AFace = Annotated[Any, Option("Slope face, D/DD: has to be given.")]
Convention = Annotated[
    str | None,
    Option(
        "What a strike column means: right-hand-rule (RHR) or left-hand-rule (LHR).",
        completes=_conventions,
    ),
]
Columns = Annotated[
    Any, Option("What the columns hold, in order, in place of the header: dip_direction,dip.")
]
SkipBad = Annotated[bool, Option("Leave bad rows out, listed, where they would stop the run.")]


LATERAL_DEG = 20.0
#: Limits beside the dip direction of the face.
_LATERAL_ADVICE = "It is an angle beside the dip direction of the face."
LATERAL_LIMITS: Mapping[str, Field] = {
    "lateral": declare(
        "lateral", "angle", 0.0, 90.0, default=LATERAL_DEG, code="E307", advice=_LATERAL_ADVICE
    ),
    "lateral_toppling": declare(
        "lateral toppling", "angle", 0.0, 90.0, default=30.0, code="E307", advice=_LATERAL_ADVICE
    ),
}


def survey_head(study: str, joints: JointList, sha: str) -> dict[str, Any]:
    """Return the first entries of the JSON of every study of a survey."""
    return {
        "slopekit": __version__,
        "format": FORMAT,
        "study": study,
        "kind": study,
        "survey": {"name": joints.name, "joints": len(joints), "left_out": list(joints.left_out)}
        | ({"quantity": float(joints.quantities.sum())} if joints.has_quantities else {}),
        "input_sha256": sha,
    }


def study_sheet(
    study: str,
    joints: JointList,
    sha: str,
    sections: Sequence[Section],
    tables: Mapping[str, Table[Any]] = MappingProxyType({}),
) -> Sheet:
    """Return the sheet of a study of a survey."""
    return Sheet(f"slopekit {__version__}   {study}   {joints.name}", sections, tables, sha)


def survey_entry(joints: JointList) -> str:
    """Return the numbers of joints, sets and pairs in words."""
    n, sets = len(joints), len(joints.sets())
    in_sets = f" in {counted(sets, 'set')}" if sets else ""
    return f"{counted(n, 'joint')}{in_sets}, {counted(n * (n - 1) // 2, 'pair')}"


_OPTIONS = {"friction": "phi", "cohesion": "c"}  # options, and the keys that they set
_UNITS = {
    "_kn_m3": " kN/m³",
    "_kg_m3": " kg/m³",
    "_kpa": " kPa",
    "_deg": "°",
    "_m3": " m³",
    "_m": " m",
}


def inputs_in_words(
    inputs: Mapping[str, Any],
    defaults: Sequence[str] = (),
    units: Mapping[str, str] = MappingProxyType({}),
) -> list[str]:
    """Return the inputs of a document as lines with units; defaults are marked, null values left out.

    >>> inputs_in_words({"height_m": 15.0, "water": {"mode": "dry", "fill": 0.0}}, ["height"])
    ['height 15 m (default)', 'water: mode dry, fill 0']
    """
    plain, groups = list[str](), list[str]()
    for key, value in inputs.items():
        if value is None or value == []:
            continue
        ending = next((suffix for suffix in _UNITS if key.endswith(suffix)), "")
        name = key.removesuffix(ending)
        words, unit = name.replace("_", " "), _UNITS.get(ending, units.get(key, ""))
        if isinstance(value, Mapping) and "least" not in value:
            groups += [f"{words}: {entry}" for entry in inputs_in_words(value)]
        else:
            default = " (default)" if _OPTIONS.get(name, name) in defaults else ""
            plain.append(f"{words} {_in_words(value)}{unit}{default}")
    return [*([", ".join(plain)] if plain else []), *groups]


def _in_words(value: Any) -> str:
    """Return a number, a text, several of them, or a range of strengths in words."""
    if isinstance(value, Mapping):
        ends = dict.fromkeys((number(value["least"]), number(value["most"])))
        return " to ".join(ends)
    if isinstance(value, list | tuple):
        return "; ".join(map(_in_words, value))
    return number(float(f"{value:.6g}")) if isinstance(value, float) else str(value)


def range_of(values: Floats, own_count: int) -> dict[str, float | int]:
    """Return the range of strengths (n,) of joints as JSON values; `own_count` of them are from the joint list."""
    return {
        "least": float(values.min()),
        "most": float(values.max()),
        "own": own_count,
        "given": len(values) - own_count,
    }


def strengths_of_joints(
    joints: JointList,
    inputs: Mapping[str, Any],
    slope: WedgeDesign | None,
    option: Callable[[str], str],
) -> tuple[list[tuple[Floats, int]], list[Fault]]:
    """Return cohesion and friction of every joint (n,), the number of values from the list, and faults E143.

    Parameters
    ----------
    inputs : by parameter, `c` and `phi` among them; slope : these as they were read, None where it is faulty: what is
        missing is said all the same
    """
    strengths, faults = [], []
    for key in _STRENGTHS:
        common = None if inputs.get(key) is None else 0.0
        if slope is not None and common is not None:
            common = (slope.cohesion_kpa if key == "c" else slope.friction_angle_deg)[0]
        values, own_count, fault = measured_or_common(joints, key, common, option(key))
        strengths.append((values, own_count))
        faults += [] if fault is None else [fault]
    return strengths, faults


def slope_of(inputs: Mapping[str, Any], option: Callable[[str], str]) -> tuple[WedgeDesign, Faults]:
    """Return the slope and loads of a survey as a wedge with placeholders for joints, and the faults E109.

    These are for keys with two values, one for each joint: the joints of a list are no J1 and J2.

    Raises
    ------
    DesignError
        Those of a wedge, with E109.
    """
    wedge_inputs, faults = dict(inputs), Faults()
    for key in ("c", "phi", "water"):
        value = wedge_inputs[key]
        values = (
            value.split(",")
            if isinstance(value, str)
            else value
            if isinstance(value, list | tuple)
            else ()
        )
        if any(entry != values[0] for entry in values):
            faults.add(
                "E109",
                f"{key} has two values: the joints of a list are no J1 and J2",
                f"{option(key)} {value_text(value)}",
                "Give one value for all; columns c and phi of the list give each joint its own.",
            )
            wedge_inputs[key] = None
    try:
        return wedge_design(wedge_inputs, option), faults
    except DesignError as error:
        wedge_faults = [
            replace(fault, message=fault.message.replace(" of J1", "")) for fault in error.faults
        ]
        raise DesignError([*faults, *wedge_faults]) from None


def codes_of(notices: Sequence[Notice]) -> list[str]:
    """Return the codes of notices, each once, with which the line of a study ends."""
    return list(dict.fromkeys(notice.code for notice in notices))


def joint_list_notices(joints: JointList) -> Iterator[Notice]:
    """Yield the notices on rows of a joint list that are not used, and on how it was read."""
    if joints.left_out:
        yield Notice("W366", f"not used of {joints.name}: {'; '.join(joints.left_out)}")
    if joints.read_as:
        yield Notice("W373", f"read of {joints.name}: {'; '.join(joints.read_as)}")
