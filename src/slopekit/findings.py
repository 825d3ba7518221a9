"""What an analysis of many blocks finds beside a factor of safety: mechanisms, modes of contact, what was checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from slopekit.block_scene import Contacts, Shapes, Sizes, Solids, joined, prism
from slopekit.core.arrays import Floats, Ints
from slopekit.core.codec import NO_JSON
from slopekit.geometry.solids.welding import welded

#: Factors that differ by less than this part look the same.
SAME_FACTOR = 2e-5
#: How a block can move, in words.
MOTIONS: Mapping[str, str] = {
    "slides": "slides",
    "topples": "topples",
    "rotates": "turns",
    "falls": "falls",
    "lifts": "is lifted",
}


@dataclass(frozen=True)
class BlockMotion:
    """A moving block: how it moves (a key of `MOTIONS`), displacement of its centroid and rotation about it, (3,) each.

    The fastest motion of the mechanism (translation, or rotation times the size of a block) is 1.
    """

    name: str
    how: str
    displacement: Floats
    rotation: Floats


@dataclass(frozen=True)
class GoverningInterface:
    """An interface or a passive bolt that resists the mechanism.

    Attributes
    ----------
    name : the two blocks; joint : its strength or set; of a bolt its name, and the block of its head
    mode : slip, or open where it opens on part of its area; pull of a bolt
    share : of the work that the mechanism loses in friction, cohesion and bolts
    normal_kn : normal force, of a bolt its pull; area_m2 : 0 of a bolt
    """

    name: str
    joint: str
    mode: str
    share: float
    normal_kn: float
    area_m2: float


@dataclass(frozen=True)
class Mechanism:
    """One mechanism of a sequence.

    Attributes
    ----------
    status : as of a result; fos : None where there is none
    change : relative change of the factor in the last passes; 0 where Newton settled it
    blocks : those that move, the fastest first; interfaces : those that govern, the largest share first
    pairs_by_mode : node pairs that stick, slip and are open
    basis : what the factor is: limit (a limit state, exact), alone (one block slides by forces, no credit for turning),
        settled (the limit of the path, its motion settled), peak (where the path was last at rest; `change` then says
        how much stronger the blocks run), or none
    size : of the blocks that move, together; None where it was not measured
    """

    status: str
    fos: float | None
    change: float
    blocks: tuple[BlockMotion, ...]
    interfaces: tuple[GoverningInterface, ...]
    pairs_by_mode: Mapping[str, int]
    basis: str = "none"
    size: Sizes | None = None


@dataclass(frozen=True)
class Findings:
    """What was found of an assembly.

    Attributes
    ----------
    mechanisms : in the order in which they happen; the first is the result's
    factor_by_block : the factor at which each block fails, by name, in the order of failure; None: without a number
    standing : how many blocks are left after the last mechanism, and why the sequence ends there
    blocks, fixed : numbers of blocks, and of those that are bedrock; components : groups that touch only through it
    checks : what was checked with its figure (volume error, area error, largest unbalanced force, ...)
    table : Goodman & Bray's columns, empty for other kinds: `n` from the toe, y height and M, L arms of the forces on
        the upper and lower side (m), the rest in kN, their mode and that of PRE-IE
    shear_to_normal : k_t / k_n of the elastic joints of the path; None where there was none
    chips : blocks in mechanisms too light to count before the first that does, which were taken away; None without any:
        `blocks` in the order in which they fail, `below_t` the mass of the lightest that counts, `fos` from which they
        fail, None where one falls whatever its strength
    """

    mechanisms: tuple[Mechanism, ...]
    factor_by_block: Mapping[str, float | None]
    standing: str
    blocks: int
    fixed: int
    contacts: int
    components: int
    checks: Mapping[str, float]
    table: tuple[Mapping[str, Any], ...] = ()
    shear_to_normal: float | None = None
    chips: Mapping[str, Any] | None = None

    @property
    def rows(self) -> tuple[Mapping[str, Any], ...]:
        """The mechanisms as a table, see `mechanism_row`: first, next, or single_block where one slides by forces."""
        return tuple(
            mechanism_row(
                "single_block" if one.basis == "alone" else "next" if k else "first", one.status, one.fos,
                tuple(block.name for block in one.blocks),
                None if one.size is None else one.size.volume_m3, None if one.size is None else one.size.mass_t,
            )
            for k, one in enumerate(self.mechanisms)
        )  # fmt: skip


def mechanism_row(
    mechanism: str, status: str, fos: float | None, blocks: tuple[str, ...], volume_m3: float | None = None,
    mass_t: float | None = None,
) -> Mapping[str, Any]:  # fmt: skip
    """A row of the table of mechanisms of a result: None where there is no factor, or no size was measured."""
    return {
        "mechanism": mechanism, "status": status, "fos": fos, "blocks": blocks, "volume_m3": volume_m3,
        "mass_t": mass_t,
    }  # fmt: skip


@dataclass(frozen=True)
class AssemblyGeometry:
    """The blocks that were analysed.

    Attributes
    ----------
    volume_m3 : of the moving blocks; total_height_m : of them all
    areas_m2 : contact area by joint
    outlines_m : (k, 2) x, z of each block by name, for sections; empty in space
    vertices_m, triangles, triangle_block : of the blocks' boundaries in space
    centroids_m : (n, 3); names : (n,); fixed : which of them are bedrock
    contacts : between the blocks; in a section the polygons have two corners, their ends
    """

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    names: tuple[str, ...] = field(metadata=NO_JSON)
    fixed: tuple[bool, ...] = field(metadata=NO_JSON)
    thickness_m: float | None
    centroids_m: Floats = field(repr=False, metadata=NO_JSON)
    outlines_m: Mapping[str, Floats] = field(repr=False, metadata=NO_JSON)
    vertices_m: Floats = field(repr=False, metadata=NO_JSON)
    triangles: Ints = field(repr=False, metadata=NO_JSON)
    triangle_block: Ints = field(repr=False, metadata=NO_JSON)
    contacts: Contacts = field(repr=False, metadata=NO_JSON)
    JSON_ALSO: ClassVar = ("blocks", "fixed_blocks")

    @property
    def blocks(self) -> int:
        """How many there are; a bench has thousands, JSON has none of their shapes."""
        return len(self.names)

    @property
    def fixed_blocks(self) -> int:
        """How many of them are bedrock."""
        return sum(self.fixed)

    def shapes(self, block: str) -> Shapes:
        """The blocks; of a section's bedrock that is none of them one block more, at the end."""
        fixed = np.array(self.fixed, dtype=bool)
        if not self.outlines_m:
            vertices, triangles, of = welded(self.vertices_m, self.triangles, self.triangle_block)
            solids = Solids(vertices, triangles, of, np.full(len(triangles), -1))
            return Shapes(self.names, fixed, self.centroids_m, tuple(self.areas_m2), solids, self.contacts)
        thickness, centroids = self.thickness_m or 1.0, self.centroids_m
        rock = [name for name in self.outlines_m if name not in self.names]
        bodies = [prism(self.outlines_m[name], thickness) for name in (*self.names, *rock)]
        if rock:
            centroids = np.concatenate([centroids, bodies[-1][0].mean(axis=0)[None, :]])
        vertices, triangles, of = joined(bodies)
        ends = self.contacts.corners.reshape(-1, 2, 3)
        half = np.array([0.0, thickness / 2.0, 0.0])
        corners = np.stack([ends[:, 0] - half, ends[:, 1] - half, ends[:, 1] + half, ends[:, 0] + half], axis=1)
        contacts = Contacts(
            corners.reshape(-1, 3), 4 * np.arange(len(ends) + 1), self.contacts.joint, self.contacts.plus,
            self.contacts.minus,
        )  # fmt: skip
        return Shapes(
            (*self.names, *rock), np.append(fixed, [True] * len(rock)).astype(bool), centroids,
            tuple(self.areas_m2), Solids(vertices, triangles, of, np.full(len(triangles), -1)), contacts,
        )  # fmt: skip
