"""The common part of designs of many blocks: keys, named strengths, water by pressures, loads on named blocks."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from slopekit.core.orientation import number
from slopekit.design.common import Design
from slopekit.design.fields import Field, count, declare, fields_of, group, keys_of, record_spec
from slopekit.design.fields import number as number_field
from slopekit.design.ground_water import TABLE, read_table
from slopekit.design.parts import (
    Action,
    Bolt,
    Force,
    Seismic,
    Strength,
    Water,
    bolts_without,
    forces_without,
)
from slopekit.design.reading.nodes import Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import Spec
from slopekit.design.sections import read_bolt, read_common, read_force, read_strength, read_water
from slopekit.kinds.words import shortened

Point2 = tuple[float, float]
MOST_BLOCKS = 200_000
_MOST_PRINTED_SURCHARGES = 6  # surcharges that the sheet prints
_SECTION_TRENDS = (90.0, 270.0)
_TREND_TOLERANCE = 1e-6
_SECTION_TOLERANCE = 1e-9  # of a force, across the section: what rounding leaves of toward: 270/00


def water_by(*pressures: Field, excluded_keys: tuple[str, ...] = ()) -> Any:
    """Return the declaration of water of blocks, by pressures or a table, without the keys of a table `excluded_keys`.

    Mode and fill are declared so that the reader can say why they are refused.
    """
    keys = keys_of(
        "WaterOfBlocks",
        declare("mode", "text", example="dry", is_refused=True),
        declare("fill", "ratio", 0.0, 1.0, is_refused=True),
        *pressures,
        *(field for name, field in fields_of(Water).items() if name in Water.OMITTED_IF_NONE),
    )
    return group(
        "water",
        keys,
        default=Water(),
        forms=(Spec("value", example="dry"),),
        omitted_keys=excluded_keys,
    )


@dataclass(frozen=True, kw_only=True)
class AssemblyDesign(Design):
    """The common attributes of designs of many blocks.

    Attributes
    ----------
    strengths : by name, in the order of the file
    mechanisms : how many successive mechanisms are wanted: what fails first is taken away, and so on
    smallest_block : weight of the lightest mechanism that counts, in parts of that of the median block that can move
    seed : of all random numbers
    """

    WITHOUT: ClassVar[tuple[str, ...]] = ("analysis.factors",)

    strengths: tuple[tuple[str, Strength], ...]
    forces: tuple[Force, ...] = forces_without()
    bolts: tuple[Bolt, ...] = bolts_without()
    water_unit_weight_kn_m3: float = 9.81
    mechanisms: int = count(
        "analysis.mechanisms",
        1,
        1000,
        default=1,
        doc="successive mechanisms: what fails first is taken away, and so on",
    )
    smallest_block: float = number_field(
        "analysis.smallest_block",
        "ratio",
        default=0.02,
        least=0.0,
        most=1.0,
        code="E137",
        scatters=False,
        role="setting",
        doc="of the weight of the median block: a lighter mechanism is a chip, taken away first and said",
    )
    seed: int = 0

    def strength(self, name: str) -> Strength:
        """Return a strength by its name."""
        return dict(self.strengths)[name]


@dataclass(frozen=True, kw_only=True)
class NamedDesign(AssemblyDesign):
    """Blocks with names: a surcharge stands on those that it names."""

    ACTIONS: ClassVar[Mapping[str, Action]] = {"surcharges_kpa": "surcharge"}
    OMITTED_IF_NONE: ClassVar[tuple[str, ...]] = ("surcharges_kpa",)

    surcharges_kpa: tuple[tuple[str, float], ...] = number_field(
        "loads.surcharge",
        "pressure",
        default=(),
        least=0.0,
        code="E123",
        many="names",
        axis="surcharge",
        says="a surcharge presses: it is never negative",
        example="{B1: 20 kPa}",
        left_out="none",
        doc="by block: downward per plan area, on what of it looks up and touches no other",
    )

    def ground_in_words(self) -> list[str]:
        """Return table, pond and surcharges as the sheet prints them."""
        listed = [f"{number(value)} kPa on {name}" for name, value in self.surcharges_kpa]
        load = (
            ["surcharge " + ", ".join(shortened(listed, _MOST_PRINTED_SURCHARGES))]
            if listed
            else []
        )
        return [*super().ground_in_words(), *load]


def read_surcharges(reader: Reader, blocks: Mapping[str, bool]) -> Iterator[tuple[str, float]]:
    """Yield surcharges (kPa) by the names of blocks; E250 on a block that does not exist or is fixed.

    Parameters
    ----------
    blocks : whether each moves, by name
    """
    field, node = fields_of(NamedDesign)["surcharges_kpa"], reader.find("loads.surcharge")
    for name, below in node.items():
        if not blocks.get(name, False):
            message = (
                f"a surcharge stands on {name}, "
                f"{'which is fixed' if name in blocks else 'there is no such block'}"
            )
            moving = [block for block, moves in blocks.items() if moves]
            reader.fault("E250", message, below, reader.nearest(name, moving))
        elif below.value is not None and (
            value := reader.number(field, below, f"surcharge on {name}")
        ):
            yield name, value


def read_pressures(reader: Reader, interfaces: Sequence[str]) -> Water:
    """Read the water of a design: a table, or mean pressures on these interfaces; E118 for a fraction of full water."""
    node = reader.find("water")
    mode_node = node.get("mode") or node.get("fill") if node.is_mapping else node
    if mode_node.text not in (None, "dry", TABLE):
        example = (
            record_spec(fields_of(reader.record)["water"].record_type).keys["pressures"].example
        )
        message = f"water is {mode_node.text}: in a {reader.kind} design it is dry, or given by its pressures"
        reader.fault("E118", message, mode_node, f"Write water: {{pressures: {example}}}.")
        return Water()
    return read_table(reader) or read_water(reader, interfaces, len(interfaces))[0]


def named_pressures(reader: Reader) -> list[tuple[str, Node]]:
    """Return the nodes of mean pressures with the names of their interfaces in the file."""
    return list(reader.find("water.pressures").items())


def common_attributes(
    reader: Reader,
    blocks: Mapping[str, bool] | None,
    in_section: bool,
    toward: float | None,
    water: Water,
) -> dict[str, Any]:
    """Read the attributes that all designs of many blocks share, by name; call it last.

    Parameters
    ----------
    blocks : whether each moves, by name; None where they are not cut yet
    toward : default trend of a seismic load, °
    water : from `read_pressures`
    """
    read = [(name, read_strength(reader, node, name)) for name, node in reader.names("strength")]
    attributes = read_common(reader, on_blocks=True)
    attributes["seismic"] = _seismic(reader, attributes["seismic"], in_section, toward)
    attributes["forces"] = tuple(
        _loads_on_blocks(reader, "loads.forces", "force", read_force, blocks, in_section)
    )
    attributes["bolts"] = tuple(
        _loads_on_blocks(reader, "support.bolts", "bolt", read_bolt, blocks, in_section)
    )
    attributes["strengths"] = tuple(
        (name, strength) for name, strength in read if strength is not None
    )
    return attributes | {"water": water}


def _seismic(reader: Reader, seismic: Seismic, in_section: bool, toward: float | None) -> Seismic:
    """Return the seismic load with its direction; E253 where that is missing or leaves the section."""
    trend = toward if seismic.trend_deg is None else seismic.trend_deg
    node = reader.find("loads.seismic")
    if not seismic.coefficient or not node:
        return seismic
    if trend is None:
        message = (
            "the seismic load has no direction, and the blocks do not say which way the slope falls"
        )
        advice = "Write seismic: {k: 0.1, toward: 270}, or add --set loads.seismic.toward=270."
        reader.fault("E253", message, node, advice)
    elif (
        in_section
        and min(abs(trend - section_trend) for section_trend in _SECTION_TRENDS) > _TREND_TOLERANCE
    ):
        message = (
            f"the seismic load acts toward {number(trend)}, in a section it acts toward 090 or 270"
        )
        reader.fault("E253", message, node.get("toward") or node, "x is east (090), -x west (270).")
    return replace(seismic, trend_deg=trend)


def _loads_on_blocks(
    reader: Reader,
    path: str,
    load_name: str,
    read: Callable[[Reader, Node], Any],
    blocks: Mapping[str, bool] | None,
    in_section: bool,
) -> Iterator[Any]:
    """Yield forces or bolts with the blocks they act on; E252 for one that leaves the section."""
    for node in reader.items(path):
        if node.value is None or not reader.is_sound(node):
            continue
        load, block = read(reader, node), _block_of(reader, node, load_name, blocks)
        if load is None:
            continue
        vector = (
            load.components_kn if isinstance(load, Force) else tuple(load.toward.vector().tolist())
        )
        if (
            in_section
            and abs(vector[1])
            > _SECTION_TOLERANCE * sum(component * component for component in vector) ** 0.5
        ):
            message = (
                f"a {load_name} leaves the section: x is east, z is up, and nothing acts along y"
            )
            advice = "Point it toward 090 or 270 (any plunge), or give [x, 0, z]."
            reader.fault("E252", message, node.get("toward") or node, advice)
        yield replace(load, block=block)


def _block_of(
    reader: Reader, node: Node, load_name: str, blocks: Mapping[str, bool] | None
) -> str | None:
    """Return the block of a load: that which it names, or the only one that moves; E250."""
    block = node.get("block")
    moving = [name for name, moves in (blocks or {}).items() if moves]
    if block.text is not None:
        if blocks and not blocks.get(block.text, False):
            reason = "which is fixed" if block.text in blocks else "there is no such block"
            message = f"a {load_name} acts on {block.text}, {reason}"
            reader.fault("E250", message, block, reader.nearest(block.text, moving))
        return block.text
    if len(moving) == 1:
        return moving[0]
    key = "head" if load_name == "bolt" else "at"
    if blocks is None and not node.get(key):
        message = f"a {load_name} does not say where it acts: the bench has many blocks"
        reader.fault(
            "E250", message, node, f"Add {key}: a point in its block (or block: its name)."
        )
    elif blocks is not None and moving:
        advice = (
            f"Add block: {moving[0]}."
            if node.is_mapping
            else f"Write {{force: …, block: {moving[0]}}}."
        )
        reader.fault(
            "E250", f"a {load_name} names no block, and {len(moving)} can move", node, advice
        )
    return None
