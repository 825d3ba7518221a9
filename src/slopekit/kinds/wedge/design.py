"""The design of a wedge: its keys, and how it is read from a file or the inputs of a call; all faults at once."""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, ClassVar, Self

import numpy as np

from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.core.orientation import Plane
from slopekit.core.orientation import number as number_text
from slopekit.core.units import is_unit_of, unit_of
from slopekit.design import words
from slopekit.design.fields import (
    Field,
    declare,
    fields_of,
    group,
    more_than_nothing,
    number,
    orientation,
    point,
    record_spec,
    text,
)
from slopekit.design.ground_water import WORST, SlopeDesign, read_table
from slopekit.design.joints import JOINTS, JointEntry, joints_of, refinements, strengths_of
from slopekit.design.parts import Strength, Water
from slopekit.design.reading.nodes import NOTHING, Document, Node, Place, from_python
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import check_structure, expand_short_form
from slopekit.design.sections import read_common, read_strength, read_water
from slopekit.kinds.single_block.secants import other_strengths, steeper

_DEPTH_OF_WATER = declare("water", "length", 0.0, code="E118", label="water in the crack")
#: The paper's wedge (Sheng et al. 2023, Tables 4 and 5): what is left out of a design takes these values.
PAPER_WEDGE: dict[str, Any] = {
    "face": Plane(60.0, 180.0),
    "upper": Plane(10.0, 180.0),
    "height": 64.89,
    "c": 50.0,
    "phi": 20.0,
    "density": 2600.0,
}


#: What JSON calls the strengths of all joints, by the attributes of one.
_BY_JOINT = {
    "cohesion_kpa": "cohesion_kpa",
    "friction_angle_deg": "friction_angle_deg",
    "dilation_deg": "dilation_deg",
    "tension_kpa": "tension_kpa",
    "law": "laws",
    "made_of": "made_of",
    "residual": "residuals",
}


@dataclass(frozen=True)
class Crack:
    """A tension crack: its plane, and its distance from the crest along the trace of plane 1 (m)."""

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare(
            "water",
            "ratio",
            0.0,
            1.0,
            or_measures=("pressure", "length"),
            axis="water in the crack",
            left_out="as the joints",
            doc="`dry`, `full`, `50 %`; a mean pressure with its unit, `5 kPa`; a depth over its lowest point with its "
            "unit, `3 m`, which wets the joints too",
        ),
    )

    plane: Plane = orientation("plane", label="crack", axis="the crack", example="80/180")
    distance_m: float = number(
        "distance",
        "length",
        above=0.0,
        code="E120",
        label="crack distance",
        example="5 m",
        words=("worst",),
        doc="from the crest along J1's trace; `worst`: where the closed form is lowest",
    )


@dataclass(frozen=True)
class Basal:
    """A third joint under the wedge: its plane, and its height (m) on the trace of J1 over the toe."""

    EXTRA_KEYS: ClassVar[tuple[Field, ...]] = (
        declare("strength", "text", left_out="the only one", doc="a name under strength"),
    )

    plane: Plane = orientation(
        "plane", label="the basal joint", axis="the basal joint", example="20/180"
    )
    height_m: float = number(
        "height",
        "length",
        least=-1e7,
        most=1e7,
        code="E447",
        label="height of the basal joint",
        example="5 m",
        axis="height of the basal joint",
        role="quantity",
        says="it lies between {least} and {most} m",
        doc="vertical, from where J1, J2 and the face meet to where it meets J1's trace on the face; below 0 the block "
        "lies under that point (a socket wedge)",
    )


@dataclass(frozen=True)
class SizeLimits:
    """Upper limits of the size of a wedge, m and m³; None, or no joints, without a limit. See `kinds.wedge.limits`."""

    trace_length_m: tuple[float | None, ...] = number(
        "trace_length",
        "length",
        default=(),
        above=0.0,
        code="E116",
        label="trace length",
        per_interface=True,
        left_out="no limit",
        doc="the longer trace of a joint, on face or upper slope: one for both, or by name",
    )
    persistence_m: tuple[float | None, ...] = number(
        "persistence",
        "length",
        default=(),
        above=0.0,
        code="E116",
        label="persistence",
        per_interface=True,
        left_out="no limit",
        doc="the longest edge of a joint in the wedge, alike",
    )
    slope_length_m: float | None = number(
        "slope_length",
        "length",
        default=None,
        above=0.0,
        code="E116",
        label="slope length",
        left_out="no limit",
        axis="slope length",
        doc="of the wedge along the crest",
    )
    bench_width_m: float | None = number(
        "bench_width",
        "length",
        default=None,
        above=0.0,
        code="E116",
        label="bench width",
        left_out="no limit",
        axis="bench width",
        doc="how far behind the crest the wedge reaches, horizontally and normal to it",
    )
    max_volume_m3: float | None = number(
        "max_volume",
        "volume",
        default=None,
        above=0.0,
        code="E116",
        label="max volume",
        left_out="no limit",
        axis="largest volume",
    )
    min_volume_m3: float | None = number(
        "min_volume",
        "volume",
        default=None,
        above=0.0,
        code="E116",
        label="min volume",
        left_out="no limit",
        axis="smallest volume",
        doc="a smaller wedge counts as none (E487)",
    )
    by: str = text(
        "by",
        default="scale",
        words=("scale", "filter"),
        code="E126",
        left_out="scale",
        example="scale",
        doc="`scale`: a larger wedge is made smaller, same shape, at the crest; `filter`: it counts as none (E486)",
    )


@dataclass(frozen=True, kw_only=True)
class WedgeDesign(SlopeDesign):
    """One wedge, complete and checked. Made by `read_wedge` and `wedge_design`.

    Strengths are those of J1, J2 and, where there is one, the basal joint.
    """

    EXTRA_KEYS = (JOINTS,)
    REQUIRED = ()
    ALLOWS_FILL = True
    ATTRIBUTE_OF_KEY = MappingProxyType({"crack.water": "water.crack_fill"})
    DEFAULTS = PAPER_WEDGE
    PAPER_KEYS = ("slope.", "strength.", "rock.density")
    CRACK_FROM = "behind the crest along J1's trace"
    OMITTED_IF_NONE = ("basal", "limits")
    HAS_CLOSED_FORM = True

    joints: tuple[Plane, Plane]
    face: Plane = orientation("slope.face", axis="the face", default=None, example="60/180")
    upper: Plane = orientation(
        "slope.upper", axis="the upper slope", default=None, example="60/180"
    )
    height_m: float = number(
        "slope.height",
        "length",
        default=None,
        least=1e-6,
        most=1e7,
        code="E116",
        example="64.89 m",
        check=more_than_nothing,
        says="out of range ({least} to {most})",
        doc="vertical, from the toe to where J1's trace meets the crest",
    )
    strengths: tuple[Strength, ...]
    basal: Basal | None = group("basal", Basal, default=None, left_out="no basal joint")
    crack: Crack | None = group("crack", Crack, default=None, left_out="no crack")
    limits: SizeLimits | None = group(
        "limits", SizeLimits, default=None, left_out="no limits of size"
    )
    refine: int = refinements()
    origin_m: tuple[float, float, float] = point(
        "slope.origin", default=(0.0, 0.0, 0.0), doc="map coordinates of the toe"
    )
    joint_names: tuple[str, str] = ("J1", "J2")

    @property
    def cohesion_kpa(self) -> tuple[float, ...]:
        """The cohesion of each joint."""
        return tuple(strength.cohesion_kpa for strength in self.strengths)

    @property
    def friction_angle_deg(self) -> tuple[float, ...]:
        """The friction angle of each joint."""
        return tuple(strength.friction_angle_deg for strength in self.strengths)

    @property
    def is_cut_for_loads(self) -> bool:
        """Whether water, of a depth in the crack too, or surcharge are integrated over the faces of the block."""
        return super().is_cut_for_loads or bool(np.any(self.water.crack_water_m))

    @property
    def wet_interfaces(self) -> tuple[str, ...]:
        """The joints, the basal joint and the crack where there are such."""
        further = [
            name
            for name, part_of_design in (("basal", self.basal), ("crack", self.crack))
            if part_of_design is not None
        ]
        return (*self.joint_names, *further)

    def in_own_names(self, sentence: str) -> str:
        """A sentence with the names of the two joints in place of J1 and J2."""
        return re.sub(r"\bJ([12])\b", lambda match: self.joint_names[int(match[1]) - 1], sentence)

    def changes(self) -> Iterator[tuple[str, Self]]:
        """Designs with one input a little changed, by name."""
        if self.water.mode == "dry" or (self.water.mode == "full" and self.water.fill < 1.0):
            yield (
                "full water",
                replace(self, water=Water("full", 1.0, crack_fill=self.water.crack_fill)),
            )
        yield from other_strengths(self)
        first, second = self.joints
        for name, joints in (("J1", (steeper(first), second)), ("J2", (first, steeper(second)))):
            if max(joints[0].dip_deg, joints[1].dip_deg) <= 90.0:
                yield f"dip of {name} +1°", replace(self, joints=joints)
        if self.basal is not None and self.basal.plane.dip_deg <= 89.0:
            yield (
                "dip of basal +1°",
                replace(self, basal=replace(self.basal, plane=steeper(self.basal.plane))),
            )

    def plain(self, exact: bool = False) -> dict[str, Any]:
        """The attributes as JSON values, those of the strengths as one list of each."""
        document = super().plain(exact)
        strengths = document.pop("strengths")
        for name, several in _BY_JOINT.items():
            if any(strength.get(name) is not None for strength in strengths):
                document[several] = [strength.get(name) for strength in strengths]
        return document

    def inputs(self) -> dict[str, Any]:
        """Every input as plain JSON values, the defaults written out."""
        document = super().inputs()
        document["joints"] = {f"J{k}": str(plane) for k, plane in enumerate(self.joints, 1)}
        return document


# -- files ------------------------------------------------------------------------------------------------------------


def read_wedge(reader: Reader) -> WedgeDesign:
    """A wedge from its document.

    Raises
    ------
    DesignError
        With every fault found.
    """
    joints = joints_of(reader, 2)
    values = reader.fields(WedgeDesign, only=("face", "upper", "height_m"))
    nodes = {
        key: node for key in ("basal", "crack") if (node := reader.find(key)).value is not None
    }
    basal_node, crack_node = (nodes.get(key, NOTHING) for key in ("basal", "crack"))
    basal, under = _basal(reader, basal_node, [joint.name for joint in joints])
    strengths = (
        strengths_of(reader, [*joints, *under]) if joints else _without_joints(reader, len(under))
    )
    crack = _crack(reader, crack_node) if crack_node else None
    names = tuple(joint.name for joint in joints) or ("J1", "J2")
    values |= reader.fields(WedgeDesign, only=(*SlopeDesign.ACTIONS, "refine", "origin_m"))
    water = _water(reader, crack_node, [*names, *nodes], 3 if basal_node else 2)
    common = read_common(reader)
    sound = tuple(strength or Strength(0.0, 0.0) for strength in strengths)
    design: WedgeDesign = reader.build(
        WedgeDesign,
        values,
        common,
        joints=tuple(joint.plane for joint in joints),
        joint_names=names,
        crack=crack,
        water=water,
        basal=basal,
        limits=_limits(reader, names, tuple(nodes)),
        strengths=sound,
    )
    if crack is None or not math.isinf(crack.distance_m):
        return design
    from slopekit.kinds.single_block.worst_crack import with_worst_crack
    from slopekit.kinds.wedge import ON_ARRAYS  # which judges designs, and is made of them

    return with_worst_crack(design, ON_ARRAYS, str(crack_node.place))


def _basal(
    reader: Reader, node: Node, names: Sequence[str]
) -> tuple[Basal | None, list[JointEntry]]:
    """The basal joint, and the same as a joint whose strength is read with those of the others."""
    if not node:
        return None, []
    if "basal" in names:
        message = "a joint is called basal, which is the name of the joint under the wedge"
        reader.fault("E146", message, reader.find("joints"), "Give it another name.")
    elif not node.is_mapping:
        message = f"basal is {node.text}, it is a group of keys"
        reader.fault("E447", message, node, "Write basal: {plane: 20/180, height: 5 m}.")
        return None, [JointEntry("basal", None, NOTHING, node, {})]
    values = reader.fields(Basal, node)
    for key in ("plane", "height"):
        if node.get(key).value is None:
            reader.fault(
                "E447",
                f"basal.{key} is missing",
                node,
                "Write basal: {plane: 20/180, height: 5 m}.",
            )
    joint = JointEntry("basal", values["plane"], node.get("strength"), node, {})
    return (None if None in values.values() else Basal(**values)), [joint]


def _limits(reader: Reader, names: Sequence[str], bounding: Sequence[str]) -> SizeLimits | None:
    """Limits of size: E116 a limit that is none, E197 of no joint, E112 beside what bounds the wedge, E126 a word."""
    node = reader.find("limits")
    if not node.items():
        return None
    if bounding:
        message = f"limits of size and {' and '.join(bounding)}: a wedge that keeps its shape cannot have both"
        reader.fault(
            "E112",
            message,
            node,
            "Leave limits out: the height, basal joint and crack bound the wedge.",
        )
    values = reader.fields(SizeLimits, node)
    fields = fields_of(SizeLimits)
    for key in ("trace_length_m", "persistence_m"):
        numbers = reader.per_interface(fields[key], node.get(fields[key].path), names)
        numbers *= len(names) if len(numbers) == 1 else 1
        values[key] = (*numbers, *[None] * (len(names) - len(numbers))) if numbers else ()
    least, most = values["min_volume_m3"], values["max_volume_m3"]
    if least is not None and most is not None and least > most:
        message = (
            f"min_volume is {number_text(least)} m³, more than max_volume {number_text(most)} "
            "m³: nothing would be left"
        )
        reader.fault("E116", message, node.get("min_volume"))
    return SizeLimits(**values)


def _without_joints(reader: Reader, under: int) -> list[Strength | None]:
    """Strengths whose joints are wrong: what is wrong with them is said all the same."""
    for name, node in reader.names("strength"):
        read_strength(reader, node, name, reader.record.DEFAULTS)
    return [None] * (2 + under)


def _crack(reader: Reader, node: Node) -> Crack | None:
    """The tension crack by its keys, or in a call as 80/180@5m; infinitely far where its worst place is asked for."""
    keys = expand_short_form(node, "crack")
    if not reader.is_sound(node):
        return None
    if not keys.is_mapping:
        reader.fault(
            "E120",
            f"crack is {words.value_text(reader.written(node))}, it is written 80/180@5m",
            node,
        )
        return None
    values, distance = reader.fields(Crack, keys), keys.get("distance")
    if distance.text == WORST:
        values["distance_m"] = math.inf  # looked for once the wedge is known
    return None if None in values.values() else Crack(**values)


def _water(reader: Reader, crack: Node, order: Sequence[str], joints: int) -> Water:
    """Water on the joints, with the crack's own word: how full it is, its pressure, or the depth that wets the joints.

    Parameters
    ----------
    order : the interfaces, so many `joints` first
    """
    node, table = crack.get("water"), read_table(reader)
    if table is not None:
        if node:
            message = "the crack's water and a water table both say how full it is"
            reader.fault("E112", message, node, "Keep one of them.")
        return table
    water, place = read_water(reader, order, joints)
    if node.value is None:
        return water
    if reader.is_sound(node) and is_unit_of(unit_of(reader.value(node)), "length"):
        if water != Water():
            message = f"the crack's water is {node.text}, which wets the joints, and water says another thing"
            reader.fault("E112", message, place, "Keep one of them.")
        return Water(crack_water_m=reader.number(_DEPTH_OF_WATER, node))
    value, on_joints = reader.value(node), water.pressures_kpa
    is_pressure = is_unit_of(unit_of(value), "pressure")
    if len(on_joints) > joints or (is_pressure and water.mode == "full"):
        advice = "Give the crack's water in one place; beside full joints it is a part of that: crack: {water: 50 %}."
        reader.fault(
            "E112", f"the crack's water is {node.text}, and water says another thing", node, advice
        )
        return Water()
    if is_pressure:
        pressure = reader.number(fields_of(Water)["pressures_kpa"], node, "water pressure")
        pressures = (*on_joints, *[0.0] * (joints - len(on_joints)), pressure or 0.0)
        return Water("pressures", 0.0, pressures) if any(pressures) else Water()
    return (
        water
        if value is None
        else replace(water, crack_fill=reader.faults.of(words.fill, value, str(node.place)))
    )


# -- calls ------------------------------------------------------------------------------------------------------------

#: Where the inputs of a call stand in a design, by their names; strengths are one for each joint.
_PATHS: Mapping[str, str] = {
    "face": "slope.face",
    "upper": "slope.upper",
    "height": "slope.height",
    "origin": "slope.origin",
    "crack": "crack",
    "density": "rock.density",
    "unit_weight": "rock.unit_weight",
    "gravity": "rock.gravity",
    "water": "water.mode",
    "water_unit_weight": "water.unit_weight",
    "seismic": "loads.seismic",
    "forces": "loads.forces",
    "bolts": "support.bolts",
    "criterion": "analysis.criterion",
    "accept": "acceptance.rules",
    "agree_within": "analysis.agree_within",
    "refine": "analysis.refine",
    "factors": "analysis.factors",
    "title": "title",
    "modulus": "rock.modulus",
    "poisson": "rock.poisson",
    "edge": "analysis.elastic.edge",
}
_JOINT_INPUTS = ("c", "phi", "dilation", "tension")
_STIFFNESS = {"normal_stiffness": "normal", "shear_stiffness": "shear"}
_KNOWN = ("dips", "basal", "limits", *_JOINT_INPUTS, *_STIFFNESS, *_PATHS)
_LISTS = ("forces", "bolts", "factors", "accept")


def wedge_design(
    inputs: Mapping[str, Any], option: Callable[[str], str] = lambda key: f"{key} ="
) -> WedgeDesign:
    """Check and convert the inputs of one wedge.

    Parameters
    ----------
    inputs : what the user gave, by the Python names of `slopekit.wedge`; None means not given
    option : how a key is called where the user wrote it (`--dips` on the command line)

    Raises
    ------
    DesignError
        With every fault found, not only the first.
    """
    faults: list[Fault] = []
    no_place = Place("", 0, 0, "")
    keys: dict[str, Any] = {}

    def put(path: str, node: Node) -> None:
        *groups, key = path.split(".")
        holder = keys
        for depth, name in enumerate(groups, 1):
            holder = holder.setdefault(
                name, Node({}, no_place, ".".join(groups[:depth]), no_place)
            ).value
        holder[key] = node

    def node(key: str, value: Any, number_text: Any = None) -> Node:
        place = Place(
            "",
            0,
            0,
            f"{option(key)} {words.value_text(value if number_text is None else number_text)}",
        )
        return from_python(value, key, lambda _path, _value: place, faults)

    values = {key: _as_python(value) for key, value in inputs.items() if value is not None}
    for key in values:
        if key not in _KNOWN:
            advice = did_you_mean(key, _KNOWN, f"Known: {', '.join(_KNOWN)}.")
            faults.append(Fault("E142", f"{key} is not an input of a wedge", key, advice))
    for name, plane in zip(
        ("J1", "J2"), _two_orientations(values.get("dips"), option, faults), strict=False
    ):
        put(f"joints.{name}.plane", node("dips", plane))
        put(f"joints.{name}.strength", node("dips", name))
    names = ["J1", "J2"]
    if "basal" in values:
        basal = expand_short_form(node("basal", values["basal"]))
        if basal.is_mapping:
            names.append("basal")
            put("basal", basal)
            put("basal.strength", node("basal", "basal"))
        else:
            advice = "The height is that over the toe, where it meets J1's trace on the face."
            message = f"basal is {words.value_text(values['basal'])}, it is written 20/180@5m"
            faults.append(Fault("E447", message, str(basal.place), advice))
    for key, entry in _limit_entries(values.get("limits"), option, faults).items():
        put(
            f"limits.{key}",
            node("limits", entry, f"{key}={','.join(entry) if isinstance(entry, list) else entry}"),
        )
    for key in _JOINT_INPUTS:
        for name, entry in zip(
            names, _values_by_joint(key, values.get(key), option, faults, len(names)), strict=False
        ):
            put(
                f"strength.{name}.{key}",
                entry if isinstance(entry, Node) else node(key, entry, values[key]),
            )
    for key, path in _STIFFNESS.items():
        for name in names if key in values else ():
            put(f"strength.{name}.stiffness.{path}", node(key, values[key]))
    for key, path in _PATHS.items():
        value = values.get(key)
        if value is None:
            continue
        if key in _LISTS:
            is_single = isinstance(value, str | Mapping) or (
                key == "forces" and words.is_point(value)
            )
            items = [value] if is_single or not isinstance(value, Sequence) else value
            put(path, replace(node(key, ""), value=[node(key, item) for item in items]))
        else:
            put(path, node(key, value))
    root = Node(keys, no_place, "", no_place)
    _check_mappings(values, root, option, faults)
    reader = Reader(Document(root, "call", option=option), WedgeDesign)
    reader.faults += faults
    return read_wedge(reader)


def _check_mappings(
    values: Mapping[str, Any], root: Node, option: Callable[[str], str], faults: Sequence[Fault]
) -> None:
    """Refuse a mapping with a key that means nothing, or without one that it needs; `faults` are said with those.

    Mappings are values, or stand in a list of them, as bolts do.
    """
    mappings = {
        f"{option(key)} {words.value_text(item)}": (key, item)
        for key, value in values.items()
        for item in (value if isinstance(value, list | tuple) else [value])
        if isinstance(item, Mapping)
    }
    if not mappings:
        return
    wrong = Faults(faults)
    wrong += [
        fault
        for fault in check_structure(root, record_spec(WedgeDesign, ()), "wedge")
        if fault.where in mappings
    ]
    for place, (key, mapping) in mappings.items():
        if key == "seismic" and mapping.get("k") is None:
            wrong.append(Fault("E143", "seismic.k is missing", place, "Add k: 0.1"))
        if key == "shear_stiffness" and not mapping:
            wrong.append(Fault("E144", "shear_stiffness is empty, a value is needed", place))
    if wrong:
        raise DesignError(dict.fromkeys(wrong))


def _as_python(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def _two_orientations(
    dips: Any, option: Callable[[str], str], faults: list[Fault]
) -> Sequence[Any]:
    advice = "Give 45/115 45/245."
    if dips is None:
        faults.append(Fault("E109", "the two joints are missing", option("dips"), advice))
        return ()
    if isinstance(dips, str) or not isinstance(dips, Sequence) or len(dips) != 2:
        message = f"a wedge has two joints, {words.value_text(dips)} is not two orientations"
        faults.append(Fault("E109", message, f"{option('dips')} {words.value_text(dips)}", advice))
        return ()
    return dips


def _limit_entries(
    value: Any, option: Callable[[str], str], faults: list[Fault]
) -> Mapping[str, Any]:
    """Return the limits of size by key, from a mapping or texts such as bench_width=6m; E142 for what is neither."""
    texts = [value] if isinstance(value, str) else value
    if value is None:
        return {}
    limits: dict[str, Any] = {}
    if isinstance(value, Mapping):
        limits = {str(key): entry for key, entry in value.items() if entry is not None}
    elif isinstance(texts, Sequence) and all(
        isinstance(text, str) and "=" in text for text in texts
    ):
        for text in texts:
            key, _, entry = (piece.strip() for piece in text.partition("="))
            limits[key.replace("-", "_")] = re.split(r"\s*,\s*", entry) if "," in entry else entry
    else:
        advice = 'Write bench_width=6m, in Python {"bench_width": 6}.'
        message = f"limits of size are {words.value_text(value)}, each is a key and a value"
        faults.append(
            Fault("E142", message, f"{option('limits')} {words.value_text(value)}", advice)
        )
    keys = [field.path for field in fields_of(SizeLimits).values()]
    for key in [key for key in limits if key not in keys]:
        advice = did_you_mean(key, keys, f"Known: {', '.join(keys)}.")
        faults.append(
            Fault(
                "E142",
                f"{key} is no limit of size",
                f"{option('limits')} {key}={limits.pop(key)}",
                advice,
            )
        )
    return limits


def _values_by_joint(
    key: str, value: Any, option: Callable[[str], str], faults: list[Fault], joints: int
) -> Sequence[Any]:
    """Return the values of an input for all joints, from one value for all or one for each; E109 for another number."""
    if value is None:
        return ()
    entries = re.split(r"\s*,\s*", value.strip()) if isinstance(value, str) else value
    entries = (
        list(entries)
        if isinstance(entries, Sequence) and not isinstance(entries, str)
        else [entries]
    )
    if len(entries) == 1 or (
        len(entries) == joints and all(entry == entries[0] for entry in entries)
    ):
        place = Place("", 0, 0, f"{option(key)} {words.value_text(value)}")
        shared = from_python(entries[0], key, lambda _path, _value: place, faults)
        return [shared] * joints  # the same node: what is wrong with it is said once
    if len(entries) != joints:
        expected = (
            "two joints: give one value or two"
            if joints == 2
            else "three joints: give one value or three"
        )
        message = (
            f"{key} has {len(entries)} values, a wedge {'has' if joints == 2 else 'with a basal joint has'} "
            f"{expected}"
        )
        faults.append(Fault("E109", message, f"{option(key)} {words.value_text(value)}"))
        return ()
    return entries
