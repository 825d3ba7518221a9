"""The findings of an analysis of many blocks: mechanisms, contact modes, governing interfaces, checks."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import takewhile
from typing import Any, ClassVar

import numpy as np

from slopekit.block_scene import Contacts, Shapes, Sizes, Solids, joined, prism
from slopekit.core.arrays import Floats, Ints
from slopekit.core.codec import NO_JSON, json_of
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
_UNMEASURED = Sizes(math.nan, None, None, {})


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
    """A row of the table of mechanisms of a result.

    Attributes
    ----------
    status : as of a result; fos : None where there is none
    blocks, how, displacement, rotation : (n,), (n,), (n, 3), (n, 3) of the blocks that move, the fastest first: name, a
        key of `MOTIONS`, displacement of its centroid and rotation about it, the fastest motion of all (translation, or
        rotation times the size of a block) 1; of one block its name alone
    change : width of the bracket in which the factor lies, in parts of it; 0 of a limit
    interfaces : those that govern, the largest share first
    pairs_by_mode : node pairs that stick, slip and are open
    basis : what the factor is: limit (a limit state, exact), alone (one block slides by forces, no credit for turning),
        settled (the limit of the path, its motion settled), peak (where the path was last at rest; `change` then says
        how much stronger the blocks run), closed_form, or none
    size : of the blocks that move, together; None where it was not measured
    role : first, next, or single_block where one slides by forces; chip where it is too light to count;
        block_above_basal and whole_wedge of a wedge on a basal joint
    """

    status: str
    fos: float | None
    blocks: tuple[str, ...]
    how: tuple[str, ...] = ()
    displacement: Floats = field(default_factory=partial(np.zeros, (0, 3)))
    rotation: Floats = field(default_factory=partial(np.zeros, (0, 3)))
    change: float = 0.0
    interfaces: tuple[GoverningInterface, ...] = ()
    pairs_by_mode: Mapping[str, int] = field(default_factory=dict)
    basis: str = "none"
    size: Sizes | None = None
    role: str = "first"

    def to_dict(self) -> dict[str, Any]:
        """Return the mechanism as JSON values; sizes are null where they were not measured."""
        row = {
            name: json_of(value)
            for name, value in vars(self).items()
            if name not in ("size", "role")
        }
        return {"mechanism": self.role, **row, **json_of(self.size or _UNMEASURED)}


def counted_rows(document: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the mechanisms of many blocks in the JSON of a result, without those that are too light to count."""
    return [
        row
        for row in document.get("mechanisms") or ()
        if row["mechanism"] in ("first", "next", "single_block")
    ]


@dataclass(frozen=True)
class Findings:
    """The mechanisms and checks of an assembly of blocks.

    Attributes
    ----------
    mechanisms : in the order in which they happen, those too light to count among them
    standing : how many blocks are left after the last mechanism, and why the sequence ends there
    blocks, fixed : numbers of blocks, and of those that are bedrock; components : groups that touch only through it
    checks : what was checked with its figure (volume error, area error, largest unbalanced force, ...)
    table : Goodman & Bray's columns, empty for other kinds: `n` from the toe, y height and M, L arms of the forces on
        the upper and lower side (m), the rest in kN, their mode and that of PRE-IE
    shear_to_normal : k_t / k_n of the elastic joints of the path; None where there was none
    """

    mechanisms: tuple[Mechanism, ...] = field(metadata=NO_JSON)
    standing: str
    blocks: int
    fixed: int
    contacts: int
    components: int
    checks: Mapping[str, float]
    table: tuple[Mapping[str, Any], ...] = ()
    shear_to_normal: float | None = None

    @property
    def counted(self) -> tuple[Mechanism, ...]:
        """The mechanisms that are not too light to count."""
        return tuple(row for row in self.mechanisms if row.role != "chip")

    @property
    def first(self) -> Mechanism | None:
        """The first mechanism, which the result reports; None where all blocks are stable."""
        return next(iter(self.counted), None)

    @property
    def chips(self) -> tuple[Mechanism, ...]:
        """The mechanisms too light to count that were removed before the first mechanism."""
        return tuple(takewhile(lambda row: row.role == "chip", self.mechanisms))


@dataclass(frozen=True)
class AssemblyGeometry:
    """The size and shape of the analysed blocks of an assembly.

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
        """The number of blocks; a bench has thousands, so JSON has none of their shapes."""
        return len(self.names)

    @property
    def fixed_blocks(self) -> int:
        """The number of blocks that are bedrock."""
        return sum(self.fixed)

    def shapes(self, block: str) -> Shapes:
        """Return the blocks; bedrock of a section that is none of them is one more block at the end."""
        fixed = np.array(self.fixed, dtype=bool)
        if not self.outlines_m:
            vertices, triangles, triangle_block = welded(
                self.vertices_m, self.triangles, self.triangle_block
            )
            solids = Solids(vertices, triangles, triangle_block, np.full(len(triangles), -1))
            return Shapes(
                self.names, fixed, self.centroids_m, tuple(self.areas_m2), solids, self.contacts
            )
        thickness, centroids = self.thickness_m or 1.0, self.centroids_m
        rock = [name for name in self.outlines_m if name not in self.names]
        bodies = [prism(self.outlines_m[name], thickness) for name in (*self.names, *rock)]
        if rock:
            centroids = np.concatenate([centroids, bodies[-1][0].mean(axis=0)[None, :]])
        vertices, triangles, triangle_block = joined(bodies)
        ends = self.contacts.corners.reshape(-1, 2, 3)
        half = np.array([0.0, thickness / 2.0, 0.0])
        corners = np.stack(
            [ends[:, 0] - half, ends[:, 1] - half, ends[:, 1] + half, ends[:, 0] + half], axis=1
        )
        contacts = Contacts(
            corners.reshape(-1, 3),
            4 * np.arange(len(ends) + 1),
            self.contacts.joint,
            self.contacts.plus,
            self.contacts.minus,
        )
        return Shapes(
            (*self.names, *rock),
            np.append(fixed, [True] * len(rock)).astype(bool),
            centroids,
            tuple(self.areas_m2),
            Solids(vertices, triangles, triangle_block, np.full(len(triangles), -1)),
            contacts,
        )
