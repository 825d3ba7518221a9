"""From what a user wrote (command line, Python, a design file) to a checked wedge: all faults at once."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from slopekit.design import words
from slopekit.design.common import Water
from slopekit.design.reader import CallSpelling, Reader, Spelling
from slopekit.design.wedge import PAPER_WEDGE, WedgeDesign
from slopekit.errors import DesignError, Fault
from slopekit.orientation import Plane, number, parse_plane

_KEYS = (
    "dips", "face", "upper", "height", "c", "phi", "dilation", "tension", "crack", "refine", "origin",
    "joint_names", "crack_fill",
)  # fmt: skip


def wedge_design(
    given: dict[str, Any], option: Callable[[str], str] = lambda key: f"{key} =", spelling: Spelling | None = None
) -> WedgeDesign:
    """Check and convert the inputs of one wedge.

    Parameters
    ----------
    given : what the user gave, by the Python names of `slopekit.wedge`; None means not given
    option : how a key is called where the user wrote it (`--dips` on the command line)
    spelling : the same for inputs that stand in a file

    Raises
    ------
    DesignError
        With every fault found, not only the first.
    """
    reader = Reader(given, spelling or CallSpelling(option), "wedge", _KEYS, PAPER_WEDGE)
    joints = _joints(reader)
    face, upper = reader.plane("face"), reader.plane("upper")
    height = reader.positive("height", "length", "E116")
    if height is not None and not 1e-6 <= height <= 1e7:
        message = f"height is {number(height)} m, out of range (1e-6 to 1e7)"
        reader.faults.append(Fault("E116", message, reader.where("height", reader.given["height"])))
    cohesion = reader.pair("c", "pressure", reader.check_cohesion)
    friction = reader.pair("phi", "angle", reader.check_friction)
    dilation: tuple[float, float] | None = (0.0, 0.0)
    tension = dilation
    if "dilation" in reader.given:
        dilation = reader.pair("dilation", "angle", None)
        reader.check_dilation(dilation, friction)
    if "tension" in reader.given:
        tension = reader.pair("tension", "pressure", reader.check_tension)
    crack = reader.read("crack", words.crack)
    water = reader.read("water", lambda value, where: words.water(value, where, crack is not None)) or Water()
    crack_fill = reader.read("crack_fill", words.fill)
    if crack_fill is not None:
        water = replace(water, crack_fill=crack_fill)
    refine = reader.read("refine", reader.refine) or 0
    origin = reader.read("origin", lambda value, where: words.point(value, "origin", where)) or (0.0, 0.0, 0.0)
    common = reader.common()
    if reader.faults:
        raise DesignError(reader.faults)
    # no fault, so nothing is missing: what follows only tells the type checker
    assert joints is not None and face is not None and upper is not None and height is not None  # noqa: PT018
    assert cohesion is not None and friction is not None and dilation is not None and tension is not None  # noqa: PT018
    return WedgeDesign(
        joints=joints, face=face, upper=upper, height_m=height, cohesion_kpa=cohesion, friction_angle_deg=friction,
        dilation_deg=dilation, tension_kpa=tension, water=water, crack=crack, refine=refine, origin_m=origin,
        joint_names=reader.given.get("joint_names", ("J1", "J2")), **common,
    )  # fmt: skip


def _joints(reader: Reader) -> tuple[Plane, Plane] | None:
    if "dips" not in reader.given:
        reader.faults.append(
            Fault("E109", "the two joints are missing", reader.spelling.key("dips"), "Give 45/115 45/245.")
        )
        return None
    value = reader.given["dips"]
    if isinstance(value, str) or not isinstance(value, Sequence) or len(value) != 2:
        message = f"a wedge has two joints, {words.shown(value)} is not two orientations"
        reader.faults.append(Fault("E109", message, reader.where("dips", value), "Give 45/115 45/245."))
        return None
    planes = []
    for k, item in enumerate(value):
        try:
            planes.append(parse_plane(item, f"J{k + 1}", reader.where("dips", item, k)))
        except DesignError as error:
            reader.faults += error.faults
    return (planes[0], planes[1]) if len(planes) == 2 else None
