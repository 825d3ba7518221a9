"""Parts that scenes are put together from: coloured joints, names of blocks, resultants, words of the legend."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from slopekit.block_scene import Contacts, joined
from slopekit.bolts import plates, rods
from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.exchange.bodies import triangles_of
from slopekit.exchange.source import NUMBERED, bolt_of_load
from slopekit.kinds.sheets.bolts import forces_in_words, schedule, without_head
from slopekit.kinds.words import short
from slopekit.views.solid.layers import (
    ACTIVE_BOLT,
    BLOCK,
    PASSIVE_BOLT,
    ROCK,
    STANDS,
    Bar,
    Colour,
    Layer,
    Picture,
    blocks_layer,
    layer,
)
from slopekit.views.solid.stage import Stage

Legend = list[tuple[str, Colour, float]]
_MOST_ARROWS = 400
_MOST_LABELS, _FEW_LABELS = 60, 12
_RIBBON, _RIBBON_OFFSET = (
    8e-3,
    0.2,
)  # of the size: how wide contacts of a section are drawn; of that: how far before it
_JOINT_OFFSET = (
    2e-3  # of the size: how far the coloured joints lie before the blocks they belong to
)
_ROD = 4e-3 / 0.024  # radius of rods, of the width of their plates


class Scenery:
    """A picture as it is put together: what is drawn and what the legend says of it, in one call."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.layers: list[Layer] = []
        self.legend: Legend = []
        self.notes: list[str] = []

    def rock(self, opacity: float = 1.0) -> None:
        """The bedrock, or the rock about one block."""
        self.layers += self.stage.rock(opacity)

    def blocks(
        self,
        name: str,
        chosen: Bools,
        legend_text: str = "",
        *,
        offset: Floats | None = None,
        opacity: float = 1.0,
        colours: Ints | None = None,
        shade: float = 0.0,
    ) -> None:
        """Blocks `chosen` (n,), each vertex moved by `offset` (v, 3) m; in `colours` (n, 3) or those of the stage.

        The legend shows `legend_text` in the colour of moving blocks, as dark as they are or as `shade`.
        """
        stage = self.stage
        colours = stage.block_colours() if colours is None else colours
        self.layers.append(blocks_layer(name, stage.scene.shapes, chosen, colours, offset, opacity))
        if legend_text:
            self.legend.append((legend_text, BLOCK, shade or opacity))

    def add(
        self,
        name: str,
        body: tuple[Floats, Ints],
        colour: Colour,
        legend_text: str = "",
        *,
        opacity: float = 1.0,
        front: int = 0,
    ) -> None:
        """A body, its vertices and triangles, in one colour, and what the legend says of it."""
        self.layers.append(layer(name, body, colour, opacity, front=front))
        if legend_text:
            self.legend.append((legend_text, colour, opacity))

    def bolts(self, block_offset: Floats | None = None, rods_note: str = "") -> None:
        """Bolts as rods with plates, in front of what they lie in, in the legend or with a note of their own.

        Parameters
        ----------
        block_offset : (n, 3) m by which each block is drawn elsewhere: a bolt goes with the block of its head
        rods_note : the note, in place of what the legend says of each sort
        """
        bolts, headless_note = self.stage.scene.bolts, without_head(schedule(self.stage.document))
        if bolts is not None:
            width = self.stage.plate_width
            bolt_offset = (
                np.zeros((1, 3))
                if block_offset is None
                else np.append(block_offset, np.zeros((1, 3)), axis=0)[bolts.block]
            )
            heads, ends = bolts.heads_m + bolt_offset, bolts.ends_m + bolt_offset
            for acts, colour, chosen in (
                ("active", ACTIVE_BOLT, ~bolts.passive),
                ("passive", PASSIVE_BOLT, bolts.passive),
            ):
                if chosen.any():
                    count = int(chosen.sum())
                    legend_text = (
                        f"{count} {acts} bolt{'s' * (count > 1)}, "
                        f"{forces_in_words(bolts.force_kn[chosen].tolist())}"
                    )
                    body = rods(heads[chosen], ends[chosen], _ROD * width)
                    self.add(f"bolts, {acts}: rods", body, colour, front=1)
                    body = plates(heads[chosen], bolts.plates[chosen], width)
                    self.add(
                        f"bolts, {acts}: plates",
                        body,
                        colour,
                        "" if rods_note else legend_text,
                        front=1,
                    )
        open_ended = bolts is not None and bool(np.isnan(bolts.length_m).any())
        self.notes += [rods_note] if rods_note and bolts is not None and len(bolts) else []
        self.notes += [headless_note] if headless_note else []
        self.notes += (
            ["bolts without a length are drawn to where they leave their block"]
            if open_ended
            else []
        )

    def block_legend(self, rock: bool) -> Legend:
        """Return the legend of `Stage.block_colours`."""
        legend: Legend = []
        if self.stage.has_single_block:
            legend.append((self.stage.scene.shapes.names[0], BLOCK, 1.0))
        else:
            first, free = int((self.stage.scene.order == 1).sum()), int(self.stage.free.sum())
            legend += [(f"moves first ({first})", BLOCK, 1.0)] if first else []
            legend += [(f"other blocks ({free - first})", STANDS, 1.0)] if free > first else []
            rock = bool(self.stage.scene.shapes.fixed.any())
        return [*legend, ("bedrock", ROCK, 1.0)] if rock else legend

    def names(
        self, block_offset: Floats | None = None, restricted_to: Bools | None = None
    ) -> list[tuple[Floats, str]]:
        """Return the names of blocks at their centroids plus `block_offset` (n, 3) m, if few enough to read.

        In a section every block is seen; in space a name could stand on another block: only those that move have one.
        """
        chosen = self.stage.free & (
            np.ones_like(self.stage.free) if restricted_to is None else restricted_to
        )
        if not self.stage.in_section:
            chosen &= self.stage.scene.order > 0
        if self.stage.has_single_block or int(chosen.sum()) > (
            _MOST_LABELS if self.stage.in_section else _FEW_LABELS
        ):
            return []
        shapes = self.stage.scene.shapes
        positions = shapes.centroids if block_offset is None else shapes.centroids + block_offset
        return [(positions[k], shapes.names[k]) for k in np.flatnonzero(chosen).tolist()]

    def measures(self) -> str:
        """Volume and height in words."""
        geometry = self.stage.document.get("geometry") or {}
        volume, height = geometry.get("volume_m3"), geometry.get("total_height_m")
        phrases = [] if volume is None else [f"volume {short(volume)} m³"]
        phrases += [] if height is None else [f"total height {short(height)} m"]
        if self.stage.document.get("assembly") is not None:
            count = int(self.stage.free.sum())
            phrases.append(f"{count} {'block' if count == 1 else 'blocks'} that may move")
        elif geometry.get("thickness_m"):
            phrases.append(f"a slice of {geometry['thickness_m']:g} m")
        return ", ".join(phrases)

    def load_names(self) -> list[str]:
        """The loads by name, bolts with the numbers that the design lists them by."""
        load_names = []
        for name in self.stage.scene.loads.names:
            bolt = bolt_of_load(self.stage.document, name)
            load_names.append(
                name
                if bolt is None
                else f"{bolt[0]} bolt {bolt[1]}{''.join(name.partition(',')[1:])}"
            )
        return load_names

    def picture(
        self,
        subject: str,
        *,
        bar: Bar | None = None,
        labels: Sequence[tuple[Floats, str]] | None = None,
        answer: str = "",
    ) -> Picture:
        """The picture with its title, the first digits of the input's hash, the answer of its result or another.

        `labels` are the names of the blocks where they are not given.
        """
        stage = self.stage
        digest = str(stage.document.get("input_sha256") or "")[:6]
        title = f"{stage.title or stage.kind} — {subject}" + (f"  (sha {digest})" if digest else "")
        return Picture(
            title,
            answer or stage.answer,
            tuple(self.layers),
            tuple(self.legend),
            stage.eye,
            tuple(self.notes),
            bar,
            tuple(self.names() if labels is None else labels),
            not stage.in_section,
        )


def widened_joint(stage: Stage, joint: int, factor: float) -> tuple[Floats, Ints]:
    """A joint of one block as a plane wider than the block."""
    contacts = stage.scene.shapes.contacts
    corners = contacts.corners.copy()
    for k in np.flatnonzero(contacts.joint == joint).tolist():
        polygon = slice(int(contacts.first[k]), int(contacts.first[k + 1]))
        middle = corners[polygon].mean(axis=0)
        corners[polygon] = middle + factor * (corners[polygon] - middle)
    triangles, panel = triangles_of(contacts)
    return corners, triangles[contacts.joint[panel] == joint]


def joint_faces(stage: Stage, block_offset: Floats) -> Iterator[tuple[int, tuple[Floats, Ints]]]:
    """The contacts of each joint on the faces of their two blocks, each where `block_offset` (n, 3) takes the block."""
    shapes = stage.scene.shapes
    contacts = shapes.contacts
    if len(contacts) == 0:
        return
    counts, (triangles, panel) = np.diff(contacts.first), triangles_of(contacts)
    middle = np.add.reduceat(contacts.corners, contacts.first[:-1]) / counts[:, None]
    normal, (a, b, c) = np.zeros_like(middle), (contacts.corners[triangles[:, k]] for k in range(3))
    np.add.at(normal, panel, cross(b - a, c - a))
    toward = shapes.centroids[contacts.plus] - middle
    normal = (
        normal * np.where((normal * toward).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
    )  # into the plus block
    normal = normal / np.maximum(np.sqrt((normal * normal).sum(axis=1)), 1e-300)[:, None]
    lift = _JOINT_OFFSET * stage.size * normal
    block_offset = np.concatenate([block_offset, np.zeros((1, 3))])  # bedrock, -1, stays
    for joint in np.unique(contacts.joint).tolist():
        joint_contacts, joint_triangles = (
            np.flatnonzero(contacts.joint == joint),
            triangles[contacts.joint[panel] == joint],
        )
        sides = [block_offset[contacts.plus] - lift, block_offset[contacts.minus] + lift]
        bodies = [
            (contacts.corners + np.repeat(side, counts, axis=0), joint_triangles) for side in sides
        ]
        if stage.in_section:
            sides = [block_offset[contacts.plus], block_offset[contacts.minus]]
            ribbon_width = _RIBBON * stage.size * normal
            bodies += [
                _ribbons(
                    contacts,
                    joint_contacts,
                    side[joint_contacts],
                    sign * ribbon_width[joint_contacts],
                )
                for side, sign in zip(sides, (1.0, -1.0), strict=True)
            ]
        yield joint, joined(bodies)[:2]


def _ribbons(
    contacts: Contacts, joint_contacts: Ints, offset: Floats, wide: Floats
) -> tuple[Floats, Ints]:
    """Contacts of a section as ribbons on the side of their block, `wide` (k, 3) m: edge-on they could not be seen."""
    first = contacts.first[joint_contacts]
    ends = (
        np.stack([contacts.corners[first], contacts.corners[first + 1]], axis=1)
        + offset[:, None, :]
    )
    ends[:, :, 1] -= _RIBBON_OFFSET * np.abs(wide).max()
    quads = np.concatenate([ends, ends[:, ::-1] + wide[:, None, :]], axis=1)
    fan = np.array([[0, 1, 2], [0, 2, 3]])
    return quads.reshape(-1, 3), (4 * np.arange(len(joint_contacts))[:, None, None] + fan).reshape(
        -1, 3
    )


def drawn_arrows(size: Floats) -> Ints:
    """Return the indices of the arrows (n,) to draw: all with a size, or every second, third ... of them."""
    arrows = np.flatnonzero(size > 0.0)
    return arrows[:: max(1, -(-len(arrows) // _MOST_ARROWS))]


def pair_spacing(areas: Floats) -> float:
    """Return the spacing of node pairs with control areas (n,) in m²: m."""
    return math.sqrt(float(np.median(areas))) if len(areas) else 1.0


def resultants(stage: Stage, chosen: Bools) -> tuple[Floats, Floats, Ints]:
    """Forces of the joints on the blocks at the limit: points (k, 3) m, forces (k, 3) kN, joints (k,).

    One for each contact of the blocks `chosen` (n,), through the mean of its node pairs weighted by their forces.
    """
    pairs = stage.scene.pairs
    force = pairs.normal_kn[:, None] * pairs.normals + pairs.shear_kn
    sides = []
    for side, opposite, sign in ((pairs.plus, pairs.minus, 1.0), (pairs.minus, pairs.plus, -1.0)):
        on_chosen = np.flatnonzero(np.append(chosen, False)[side])
        contact = np.stack([side[on_chosen], opposite[on_chosen], pairs.joint[on_chosen]], axis=1)
        sides.append(
            (
                contact,
                sign * force[on_chosen],
                pairs.points_m[on_chosen],
                pairs.normal_kn[on_chosen],
            )
        )
    contact, forces, points, weight = (
        np.concatenate([side[k] for side in sides]) for k in range(4)
    )
    if len(contact) == 0:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
    _, first, contact_index = np.unique(contact, axis=0, return_index=True, return_inverse=True)
    contact_index = contact_index.ravel()
    weight = np.maximum(weight, 0.0) + 1e-9 * max(float(np.abs(weight).max()), 1e-300)
    total = np.bincount(contact_index, weight)

    def summed(values: Floats) -> Floats:
        return np.stack([np.bincount(contact_index, values[:, k]) for k in range(3)], axis=1)

    return summed(points * weight[:, None]) / total[:, None], summed(forces), contact[first, 2]


def bolt_colour(name: str) -> Colour | None:
    """The colour of a load that is a bolt."""
    return (
        ACTIVE_BOLT
        if name.startswith("active bolt")
        else PASSIVE_BOLT
        if name.startswith("passive bolt")
        else None
    )


def grouped_loads(names: Sequence[str]) -> list[tuple[str, list[int]]]:
    """Which loads stand in one line of the legend: the words before their sizes, and their indices.

    >>> grouped_loads(["weight", "active bolt 1", "active bolt 2"])
    [('weight', [0]), ('2 active bolts', [1, 2])]
    """
    lines: dict[str, list[int]] = {}
    for k, name in enumerate(names):
        match = NUMBERED.match(name)
        lines.setdefault(f"{match[1]}s{match[3] or ''}" if match else name, []).append(k)
    return [
        (names[indices[0]] if len(indices) == 1 else f"{len(indices)} {kind}", indices)
        for kind, indices in lines.items()
    ]


def loads_summary(name: str, load_sizes: Sequence[Floats]) -> str:
    """Loads of one line of the legend: the size of one, or what several have alike."""
    if len(load_sizes) == 1:
        return load_summary(name, load_sizes[0])
    largest = [float(sizes.max(initial=0.0)) for sizes in load_sizes]
    low, high = kilonewtons(min(largest)), kilonewtons(max(largest))
    return f"{name}: {high} each" if low == high else f"{name}: {low} to {high}"


def load_summary(name: str, sizes: Floats) -> str:
    """A load in the legend: its size, or the sizes of several."""
    if len(sizes) == 1:
        return f"{name}: {kilonewtons(float(sizes[0]))}"
    return f"{name}: up to {kilonewtons(float(sizes.max()))} ({len(sizes)} forces)"


def kilonewtons(force: float) -> str:
    """A force in words.

    >>> kilonewtons(5342524.8), kilonewtons(0.12345)
    ('5,342,525 kN', '0.1235 kN')
    """
    return f"{force:,.0f} kN" if force >= 1000.0 else f"{force:.4g} kN"


def rounded_down_125(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above a value.

    >>> rounded_down_125(2345.0), rounded_down_125(0.8)
    (2000.0, 0.5)
    """
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= value * (1.0 + 1e-12))


def millimetres(metres: float) -> str:
    """A displacement in words.

    >>> millimetres(0.00185)
    '1.85 mm'
    """
    return f"{metres * 1e3:.3g} mm"


def movement_counts(
    movement_of_block: Mapping[str, str], block_names: Sequence[str], chosen: Bools
) -> Iterator[tuple[str, int]]:
    """The ways in which chosen blocks move, with how many do."""
    movements = [movement_of_block.get(block_names[k], "") for k in np.flatnonzero(chosen).tolist()]
    for movement in dict.fromkeys(movements):
        yield movement, movements.count(movement)


def colour_bar_range(values: Floats) -> tuple[float, float]:
    """The ends of a colour bar for values."""
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > low * (1.0 + 1e-9) else (0.95 * low, 1.05 * low)
