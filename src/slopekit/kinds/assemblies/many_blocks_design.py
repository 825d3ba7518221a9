"""What designs of many blocks share: their keys, named strengths, water by pressures, loads on named blocks."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from slopekit.core.orientation import number
from slopekit.design.common import Design
from slopekit.design.fields import Field, count, declare, fields_of, group, keys_of, record_spec
from slopekit.design.fields import number as number_field
from slopekit.design.ground_water import TABLE, read_table
from slopekit.design.parts import Action, Bolt, Force, Seismic, Strength, Water, bolts_without, forces_without
from slopekit.design.reading.nodes import Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import Spec
from slopekit.design.sections import read_bolt, read_common, read_force, read_strength, read_water
from slopekit.kinds.words import shortened

Point2 = tuple[float, float]
MOST_BLOCKS = 200_000
_MOST_NAMED = 6  # surcharges that the sheet prints
_SECTION_TRENDS = (90.0, 270.0)
_TREND_TOLERANCE = 1e-6
_OFF_SECTION = 1e-9  # of a force, across the section: what rounding leaves of toward: 270/00


def water_by(*pressures: Field, without: tuple[str, ...] = ()) -> Any:
    """Water of blocks, by its pressures or a table, which has no keys `without`.

    Mode and fill are known so that the reader can say why they are not taken.
    """
    keys = keys_of(
        "WaterOfBlocks",
        declare("mode", "text", example="dry", is_refused=True),
        declare("fill", "ratio", 0.0, 1.0, is_refused=True),
        *pressures,
        *(field for name, field in fields_of(Water).items() if name in Water.UNSAID),
    )
    return group("water", keys, default=Water(), forms=(Spec("value", example="dry"),), without=without)


@dataclass(frozen=True, kw_only=True)
class AssemblyDesign(Design):
    """What designs of many blocks share, a water table and a pond that may wet them among it.

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
        """A strength by its name."""
        return dict(self.strengths)[name]


@dataclass(frozen=True, kw_only=True)
class NamedDesign(AssemblyDesign):
    """Blocks with names: a surcharge stands on those that it names."""

    ACTIONS: ClassVar[Mapping[str, Action]] = {"surcharges_kpa": "surcharge"}
    UNSAID: ClassVar[tuple[str, ...]] = ("surcharges_kpa",)

    surcharges_kpa: tuple[tuple[str, float], ...] = number_field(
        "loads.surcharge", "pressure", default=(), least=0.0, code="E123", many="names", axis="surcharge",
        says="a surcharge presses: it is never negative", example="{B1: 20 kPa}", left_out="none",
        doc="by block: downward per plan area, on what of it looks up and touches no other",
    )  # fmt: skip

    def ground_in_words(self) -> list[str]:
        """Table, pond and surcharges as the sheet prints them."""
        listed = [f"{number(value)} kPa on {name}" for name, value in self.surcharges_kpa]
        load = ["surcharge " + ", ".join(shortened(listed, _MOST_NAMED))] if listed else []
        return [*super().ground_in_words(), *load]


def read_surcharges(reader: Reader, blocks: Mapping[str, bool]) -> Iterator[tuple[str, float]]:
    """Surcharges by the names of blocks; E250 on a block that is not there or fixed.

    Parameters
    ----------
    blocks : whether each moves, by name
    """
    field, node = fields_of(NamedDesign)["surcharges_kpa"], reader.at("loads.surcharge")
    for name, below in node.items():
        if not blocks.get(name, False):
            message = (
                f"a surcharge stands on {name}, {'which is fixed' if name in blocks else 'there is no such block'}"
            )
            moving = [name_of_block for name_of_block, moves in blocks.items() if moves]
            reader.fault("E250", message, below, reader.nearest(name, moving))
        elif below.value is not None and (value := reader.number(field, below, f"surcharge on {name}")):
            yield name, value


def read_pressures(reader: Reader, interfaces: Sequence[str]) -> Water:
    """Water of a table, or by mean pressures on these interfaces; E118 for a part of full water."""
    node = reader.at("water")
    part = node.get("mode") or node.get("fill") if node.is_mapping else node
    if part.text not in (None, "dry", TABLE):
        example = record_spec(fields_of(reader.record)["water"].of).keys["pressures"].example
        message = f"water is {part.text}: in a {reader.kind} design it is dry, or given by its pressures"
        reader.fault("E118", message, part, f"Write water: {{pressures: {example}}}.")
        return Water()
    return read_table(reader) or read_water(reader, interfaces, len(interfaces))[0]


def named_pressures(reader: Reader) -> list[tuple[str, Node]]:
    """The nodes of mean pressures by the names that the file has for their interfaces."""
    return list(reader.at("water.pressures").items())


def common(
    reader: Reader, blocks: Mapping[str, bool] | None, in_section: bool, toward: float | None, water: Water
) -> dict[str, Any]:
    """What every design of many blocks takes, by attribute; call it last.

    Parameters
    ----------
    blocks : whether each moves, by name; None where they are not cut yet
    toward : what a seismic load acts toward where the file does not say
    water : as `read_pressures` has it
    """
    read = [(name, read_strength(reader, node, name)) for name, node in reader.names("strength")]
    attributes = read_common(reader, on_blocks=True)
    attributes["seismic"] = _seismic(reader, attributes["seismic"], in_section, toward)
    attributes["forces"] = tuple(_on_blocks(reader, "loads.forces", "force", read_force, blocks, in_section))
    attributes["bolts"] = tuple(_on_blocks(reader, "support.bolts", "bolt", read_bolt, blocks, in_section))
    attributes["strengths"] = tuple((name, strength) for name, strength in read if strength is not None)
    return attributes | {"water": water}


def _seismic(reader: Reader, seismic: Seismic, in_section: bool, toward: float | None) -> Seismic:
    """The seismic load with its direction; E253 where that is missing or leaves the section."""
    trend = toward if seismic.trend_deg is None else seismic.trend_deg
    node = reader.at("loads.seismic")
    if not seismic.coefficient or not node:
        return seismic
    if trend is None:
        message = "the seismic load has no direction, and the blocks do not say which way the slope falls"
        advice = "Write seismic: {k: 0.1, toward: 270}, or add --set loads.seismic.toward=270."
        reader.fault("E253", message, node, advice)
    elif in_section and min(abs(trend - trend_of_section) for trend_of_section in _SECTION_TRENDS) > _TREND_TOLERANCE:
        message = f"the seismic load acts toward {number(trend)}, in a section it acts toward 090 or 270"
        reader.fault("E253", message, node.get("toward") or node, "x is east (090), -x west (270).")
    return replace(seismic, trend_deg=trend)


def _on_blocks(
    reader: Reader, path: str, what: str, read: Callable[[Reader, Node], Any], blocks: Mapping[str, bool] | None,
    in_section: bool,
) -> Iterator[Any]:  # fmt: skip
    """Forces or bolts with the blocks they act on; E252 for one that leaves the section."""
    for node in reader.items(path):
        if node.value is None or not reader.is_sound(node):
            continue
        load, block = read(reader, node), _block_of(reader, node, what, blocks)
        if load is None:
            continue
        vector = load.components_kn if isinstance(load, Force) else tuple(load.toward.vector().tolist())
        if in_section and abs(vector[1]) > _OFF_SECTION * sum(component * component for component in vector) ** 0.5:
            message = f"a {what} leaves the section: x is east, z is up, and nothing acts along y"
            advice = "Point it toward 090 or 270 (any plunge), or give [x, 0, z]."
            reader.fault("E252", message, node.get("toward") or node, advice)
        yield replace(load, block=block)


def _block_of(reader: Reader, node: Node, what: str, blocks: Mapping[str, bool] | None) -> str | None:
    """The block of a load: the one it names, or the only one that moves; E250."""
    block = node.get("block")
    moving = [name for name, moves in (blocks or {}).items() if moves]
    if block.text is not None:
        if blocks and not blocks.get(block.text, False):
            is_fixed = block.text in blocks
            message = f"a {what} acts on {block.text}, {'which is fixed' if is_fixed else 'there is no such block'}"
            reader.fault("E250", message, block, reader.nearest(block.text, moving))
        return block.text
    if len(moving) == 1:
        return moving[0]
    key = "head" if what == "bolt" else "at"
    if blocks is None and not node.get(key):
        message = f"a {what} does not say where it acts: the bench has many blocks"
        reader.fault("E250", message, node, f"Add {key}: a point in its block (or block: its name).")
    elif blocks is not None and moving:
        advice = f"Add block: {moving[0]}." if node.is_mapping else f"Write {{force: …, block: {moving[0]}}}."
        reader.fault("E250", f"a {what} names no block, and {len(moving)} can move", node, advice)
    return None
