"""What studies of joint lists share: how a list is given, what its document and its sheet say of it first."""

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
from slopekit.design.joint_lists import JointList, own_or_given
from slopekit.design.words import shown
from slopekit.kinds.wedge.design import WedgeDesign
from slopekit.studies.protocol import Argument, Option

MOST_JOINTS = 100_000  # that studies take which need not look at every pair
MOST_NAMES = 24  # of joints, that a sheet lists
_STRENGTHS: tuple[Literal["c", "phi"], ...] = ("c", "phi")


def _conventions(incomplete: str) -> list[str]:
    """The strike conventions that begin so, for the shell."""
    from slopekit.design.survey.columns import STRIKE_TO_DIP_DIRECTION

    return [name for name in STRIKE_TO_DIP_DIRECTION if name.startswith(incomplete.lower())]


#: A survey: a file on a command line; in Python also a pandas or polars frame with such columns, planes ("45/115",
#: (45, 115)), an (n, 2) array or {name: plane}.
AJointList = Annotated[
    Any, Argument("A joint list (CSV, .xlsx, AGS 4, Dips, CloudCompare): dips, strikes, poles, drill core.", "JOINTS")
]  # fmt: skip
AFace = Annotated[Any, Option("Slope face, D/DD: has to be given.")]
Convention = Annotated[str | None, Option(
    "What a strike column means: right-hand-rule (RHR) or left-hand-rule (LHR).", completes=_conventions
)]  # fmt: skip
Columns = Annotated[Any, Option("What the columns hold, in order, in place of the header: dip_direction,dip.")]
SkipBad = Annotated[bool, Option("Leave bad rows out, listed, where they would stop the run.")]


LATERAL_DEG = 20.0
#: Limits beside the dip direction of the face.
_BESIDE = "It is an angle beside the dip direction of the face."
LATERAL_LIMITS: Mapping[str, Field] = {
    "lateral": declare("lateral", "angle", 0.0, 90.0, default=LATERAL_DEG, code="E307", advice=_BESIDE),
    "lateral_toppling": declare("lateral toppling", "angle", 0.0, 90.0, default=30.0, code="E307", advice=_BESIDE),
}


def survey_head(study: str, joints: JointList, sha: str) -> dict[str, Any]:
    """What the JSON of every study of a survey begins with."""
    return {
        "slopekit": __version__, "format": FORMAT, "study": study, "kind": study,
        "survey": {"name": joints.name, "joints": len(joints), "left_out": list(joints.left_out)}
        | ({"quantity": float(joints.quantities.sum())} if joints.has_quantities else {}),
        "input_sha256": sha,
    }  # fmt: skip


def study_sheet(
    study: str, joints: JointList, sha: str, sections: Sequence[Section],
    tables: Mapping[str, Table[Any]] = MappingProxyType({}),
) -> Sheet:  # fmt: skip
    """The sheet of a study of a survey."""
    return Sheet(f"slopekit {__version__}   {study}   {joints.name}", sections, tables, sha)


def survey_entry(joints: JointList) -> str:
    """How many joints, sets and pairs there are."""
    n, sets = len(joints), len(joints.sets())
    in_sets = f" in {counted(sets, 'set')}" if sets else ""
    return f"{counted(n, 'joint')}{in_sets}, {counted(n * (n - 1) // 2, 'pair')}"


_OPTIONS = {"friction": "phi", "cohesion": "c"}  # by what they give
_UNITS = {"_kn_m3": " kN/m³", "_kg_m3": " kg/m³", "_kpa": " kPa", "_deg": "°", "_m3": " m³", "_m": " m"}


def inputs_in_words(
    inputs: Mapping[str, Any], defaults: Sequence[str] = (), units: Mapping[str, str] = MappingProxyType({})
) -> list[str]:
    """The inputs of a document by name, with units; what was left to the study is marked, what is null left out.

    >>> inputs_in_words({"height_m": 15.0, "water": {"mode": "dry", "fill": 0.0}}, ["height"])
    ['height 15 m (default)', 'water: mode dry, fill 0']
    """
    plain, groups = list[str](), list[str]()
    for key, value in inputs.items():
        if value is None or value == []:
            continue
        ending = next((one for one in _UNITS if key.endswith(one)), "")
        name = key.removesuffix(ending)
        words, unit = name.replace("_", " "), _UNITS.get(ending, units.get(key, ""))
        if isinstance(value, Mapping) and "least" not in value:
            groups += [f"{words}: {entry}" for entry in inputs_in_words(value)]
        else:
            default = " (default)" if _OPTIONS.get(name, name) in defaults else ""
            plain.append(f"{words} {_in_words(value)}{unit}{default}")
    return [*([", ".join(plain)] if plain else []), *groups]


def _in_words(value: Any) -> str:
    """A number, a text, several of them, or the least and the most of strengths."""
    if isinstance(value, Mapping):
        ends = dict.fromkeys((number(value["least"]), number(value["most"])))
        return " to ".join(ends)
    if isinstance(value, list | tuple):
        return "; ".join(map(_in_words, value))
    return number(float(f"{value:.6g}")) if isinstance(value, float) else str(value)


def range_of(values: Floats, own: int) -> dict[str, float | int]:
    """Strengths (n,) of joints, of which `own` are the joints' own, as JSON values."""
    return {"least": float(values.min()), "most": float(values.max()), "own": own, "given": len(values) - own}


def strengths_of_joints(
    joints: JointList, given: Mapping[str, Any], slope: WedgeDesign | None, option: Callable[[str], str]
) -> tuple[list[tuple[Floats, int]], list[Fault]]:
    """Cohesion and friction of every joint (n,), how many have their own, and the faults E143 of those without.

    Parameters
    ----------
    given : by parameter, `c` and `phi` among them; slope : these as they were read, None where it is faulty: what is
        missing is said all the same
    """
    strengths, faults = [], []
    for key in _STRENGTHS:
        common = None if given.get(key) is None else 0.0
        if slope is not None and common is not None:
            common = (slope.cohesion_kpa if key == "c" else slope.friction_angle_deg)[0]
        values, own, fault = own_or_given(joints, key, common, option(key))
        strengths.append((values, own))
        faults += [] if fault is None else [fault]
    return strengths, faults


def slope_of(given: Mapping[str, Any], option: Callable[[str], str]) -> tuple[WedgeDesign, Faults]:
    """The slope and loads of a survey, read as a wedge whose joints mean nothing, and the faults E109.

    These are of two values where the joints are no J1 and J2.

    Raises
    ------
    DesignError
        Those of a wedge, with E109.
    """
    from slopekit.kinds.wedge.design import wedge_design

    own, faults = dict(given), Faults()
    for key in ("c", "phi", "water"):
        value = own[key]
        parts = value.split(",") if isinstance(value, str) else value if isinstance(value, list | tuple) else ()
        if any(part != parts[0] for part in parts):
            faults.add(
                "E109",
                f"{key} has two values: the joints of a list are no J1 and J2",
                f"{option(key)} {shown(value)}",
                "Give one value for all; columns c and phi of the list give each joint its own.",
            )
            own[key] = None
    try:
        return wedge_design(own, option), faults
    except DesignError as error:
        told = [replace(fault, message=fault.message.replace(" of J1", "")) for fault in error.faults]
        raise DesignError([*faults, *told]) from None


def codes_of(notices: Sequence[Notice]) -> list[str]:
    """The codes of notices that a line of a study ends with: those that ask for something, each once."""
    return list(dict.fromkeys(notice.code for notice in notices))


def left_out(joints: JointList) -> Iterator[Notice]:
    """Yield what is not used of the list, and how it was read."""
    if joints.left_out:
        yield Notice("W366", f"not used of {joints.name}: {'; '.join(joints.left_out)}")
    if joints.read_as:
        yield Notice("W373", f"read of {joints.name}: {'; '.join(joints.read_as)}")
