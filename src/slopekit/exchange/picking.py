"""What of a scene is written: bodies, flat pieces of interfaces, node pairs."""

from collections.abc import Iterator, Sequence
from dataclasses import field, replace

import numpy as np

from slopekit.block_scene import MODES, BlockScene, Contacts, NodePairState
from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.core.records import dataclass

#: What can be written.
WHAT = ("blocks", "interfaces", "pairs", "bolts")
_SHOWN = 8


@dataclass(frozen=True, slots=True)
class WrittenBlock:
    """A block to write: its index in the scene, -1 for a slab of bedrock that is none of its blocks; its surface."""

    index: int
    name: str
    vertices: Floats
    triangles: Ints

    @property
    def middle(self) -> Floats:
        """The middle (3,) of its bounds, m."""
        middle: Floats = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2.0
        return middle

    @property
    def local(self) -> Floats:
        """Its vertices from its own middle, m."""
        return self.vertices - self.middle

    @property
    def volume(self) -> float:
        """m³, about its own middle."""
        return volume_of(self.vertices, self.triangles)


@dataclass(frozen=True, slots=True)
class Picked:
    """What is written of a scene.

    Attributes
    ----------
    bodies : the blocks; contacts, pairs, bolts : indices into the scene's; what : words of `WHAT`
    line : (2, 3) ends of the line of intersection of a wedge, None for others
    outlines : (k, 3) of the bodies of a section, in their order; else empty
    """

    scene: BlockScene
    what: tuple[str, ...]
    bodies: tuple[WrittenBlock, ...]
    contacts: Ints
    pairs: Ints
    line: Floats | None
    outlines: tuple[Floats, ...]
    bolts: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @property
    def middle(self) -> Floats:
        """The middle (3,) of all blocks of the scene, rounded to 1 m."""
        vertices = self.scene.shapes.solids.vertices
        middle: Floats = np.round((vertices.min(axis=0) + vertices.max(axis=0)) / 2.0)
        return middle

    @property
    def smallest(self) -> float:
        """The size (m) of the smallest body: cube root of its volume."""
        return min((abs(body.volume) ** (1.0 / 3.0) for body in self.bodies), default=np.inf)

    def state_of(self, body: WrittenBlock) -> int:
        """Whether a block is bedrock, 0, stands, 1, or moves in a mechanism, 2."""
        return 0 if self.scene.shapes.fixed[body.index] else 2 if self.scene.order[body.index] else 1

    def by_joint(self) -> Iterator[tuple[int, str, Ints]]:
        """The joints with interfaces to write: index, name, indices of the contacts."""
        joint = self.scene.shapes.contacts.joint[self.contacts]
        for k, name in enumerate(self.scene.shapes.joints):
            if (joint == k).any():
                yield k, name, self.contacts[joint == k]

    def by_mode(self) -> Iterator[tuple[int, str, Floats]]:
        """The contact modes with node pairs to write: index, name, points (n, 3) m."""
        pairs, mode = self.scene.pairs, self.scene.pairs.mode[self.pairs]
        for k, name in enumerate(MODES):
            if (mode == k).any():
                yield k, name, pairs.points_m[self.pairs[mode == k]]


def volume_of(vertices: Floats, triangles: Ints) -> float:
    """The volume (m³) that a closed surface encloses."""
    a, b, c = ((vertices - vertices.mean(axis=0))[triangles[:, k]] for k in range(3))
    return float(np.einsum("ti,ti->", a, np.cross(b, c))) / 6.0


def words_of_what(what: str | Sequence[str]) -> tuple[str, ...]:
    """What is wanted, in the order of `WHAT`.

    Raises
    ------
    DesignError
        E313 for another word.

    >>> words_of_what("pairs, blocks")
    ('blocks', 'pairs')
    """
    said = what.split(",") if isinstance(what, str) else list(what)
    words = [word for one in said if (word := str(one).strip().lower())]
    for word in words:
        if word not in WHAT:
            advice = did_you_mean(word, WHAT, f"There are: {', '.join(WHAT)}.")
            raise DesignError([Fault("E313", f"{word} is not a part that can be written", "--what", advice)])
    if not words:
        raise DesignError([Fault("E313", "no part to write is named", "--what", f"There are: {', '.join(WHAT)}.")])
    return tuple(word for word in WHAT if word in words)


def names_of(blocks: str | Sequence[str] | None) -> tuple[str, ...] | None:
    """Names of blocks from a text with commas or a sequence; None for all.

    >>> names_of("B1, B7"), names_of(["B1"])
    (('B1', 'B7'), ('B1',))
    """
    if blocks is None:
        return None
    if isinstance(blocks, str):
        return tuple(name.strip() for name in blocks.split(",") if name.strip())
    return tuple(str(name) for name in blocks)


def picked(
    scene: BlockScene, what: Sequence[str], blocks: Sequence[str] | None, moving: bool, is_section: bool
) -> Picked:
    """What is asked for of a scene.

    Parameters
    ----------
    what : words of `WHAT`; blocks : names, None for all; moving : leave bedrock out
    is_section : the blocks are prisms of a section

    Interfaces and node pairs are those with at least one of the blocks, bolts those with their heads in one.

    Raises
    ------
    DesignError
        E197 no such block, E273 nothing is left.
    """
    shapes = scene.shapes
    chosen = _chosen(scene, blocks, moving)
    every = {
        "blocks": np.flatnonzero(chosen), "interfaces": _touching(chosen, shapes.contacts),
        "pairs": _touching(chosen, scene.pairs), "bolts": _bolts_of(scene, chosen, blocks is None),
    }  # fmt: skip
    own = {word: indices if word in what else indices[:0] for word, indices in every.items()}
    missing = next((word for word, indices in own.items() if word in what and not len(indices)), None)
    if missing is not None:
        raise DesignError([Fault("E273", f"there are no {missing} to write", "", _why(missing, blocks, moving))])
    bodies = tuple(WrittenBlock(k, shapes.names[k], *shapes.solids.of(k)) for k in own["blocks"].tolist())
    outlines = tuple(outline_of(body) for body in bodies) if is_section else ()
    line = _line(scene)
    return Picked(scene, tuple(what), bodies, own["interfaces"], own["pairs"], line, outlines, own["bolts"])


def with_bolts(selection: Picked, blocks: Sequence[str] | None, moving: bool) -> Picked:
    """What was picked, with the bolts of the blocks where there are any."""
    bolts = _bolts_of(selection.scene, _chosen(selection.scene, blocks, moving), blocks is None)
    return replace(selection, what=(*selection.what, "bolts"), bolts=bolts) if len(bolts) else selection


def _chosen(scene: BlockScene, blocks: Sequence[str] | None, moving: bool) -> Bools:
    """Which blocks (n,) are asked for."""
    shapes = scene.shapes
    chosen = np.ones(len(shapes.names), dtype=np.bool_)
    if blocks is not None:
        index = {name: k for k, name in enumerate(shapes.names)}
        faults = [_unknown(name, shapes.names) for name in dict.fromkeys(blocks) if name not in index]
        if faults:
            raise DesignError(faults)
        chosen[:] = False
        chosen[[index[name] for name in blocks]] = True
    return chosen & ~shapes.fixed if moving else chosen


def _bolts_of(scene: BlockScene, chosen: Bools, every: bool) -> Ints:
    """The bolts with their heads in chosen blocks (n,), of `every` block those too whose head lies in none."""
    return np.flatnonzero(np.append(chosen, every)[scene.known_bolts.block])


def outline_of(body: WrittenBlock) -> Floats:
    """The near end (k, 3) of a block drawn out of a section: `prism` lists it first."""
    return body.vertices[: len(body.vertices) // 2]


def _touching(chosen: Bools, sides: Contacts | NodePairState) -> Ints:
    """Those of contacts or node pairs that have a chosen block on one side."""
    last = np.append(chosen, False)  # -1: bedrock that is none of the blocks
    return np.flatnonzero(last[sides.plus] | last[sides.minus])


def _unknown(name: str, names: Sequence[str]) -> Fault:
    more = ", …" if len(names) > _SHOWN else ""
    advice = did_you_mean(name, names, f"There are: {', '.join(names[:_SHOWN])}{more}.")
    return Fault("E197", f"there is no block {name}", "--blocks", advice)


def _why(word: str, blocks: Sequence[str] | None, moving: bool) -> str:
    if word == "bolts":
        none = "The design has no bolts with a head" if blocks is None else "No bolt has its head in the blocks named"
        return f"{none}."
    if word == "pairs":
        return "Node pairs stand where the limit was solved: nothing was solved here."
    if blocks is not None and not blocks:
        return "No block is named: leave --blocks out for all."
    if moving and blocks is not None:
        return "The blocks named are bedrock: leave --moving out."
    return "All blocks are bedrock: leave --moving out." if moving else "The blocks named touch no others."


def _line(scene: BlockScene) -> Floats | None:
    """The line of intersection of the two joints of a wedge: the corners their polygons share."""
    contacts = scene.shapes.contacts
    if len(scene.shapes.names) != 1 or len(contacts) < 2:
        return None
    first, second = (contacts.corners[contacts.first[k] : contacts.first[k + 1]] for k in range(2))
    size = float(np.ptp(contacts.corners, axis=0).max())
    near = np.sqrt(((first[:, None] - second[None]) ** 2).sum(axis=2)) <= 1e-9 * size + 1e-8
    shared = first[near.any(axis=1)]
    return shared if len(shared) == 2 and len(contacts) <= 3 else None
