"""Contact patches: the flat pieces of joint through which the blocks of an assembly press on each other."""

from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints
from slopekit.geometry.interfaces import BEDROCK

__all__ = ["BEDROCK", "Assembly", "Patches"]


@dataclass(frozen=True)
class Patches:
    """Flat convex contact patches between blocks.

    Attributes
    ----------
    plus, minus : (k,) indices of the two blocks, -1 for bedrock
    joint : (k,) which joint (set, pair of blocks) the patch belongs to
    normals : (k, 3) unit, into the block on the plus side
    areas : (k,) m²
    centroids : (k, 3) m
    corners : (c, 3) m; first : (k + 1,) patch i has the corners first[i] to first[i + 1], in order about the normal. In
        a vertical section a patch has two corners, the ends of the contact, and its area is length times thickness
    """

    plus: Ints
    minus: Ints
    joint: Ints
    normals: Floats
    areas: Floats
    centroids: Floats
    corners: Floats
    first: Ints

    def __len__(self) -> int:
        return len(self.areas)


@dataclass(frozen=True)
class Assembly:
    """Blocks and the patches where they touch.

    Attributes
    ----------
    volumes : (n,) m³; centroids : (n, 3) m
    fixed : (n,) blocks that are bedrock: they have no unknowns
    patches : between blocks, indices into the n blocks; -1 for bedrock that is none of them
    in_section : everything repeats along y, and the patches are segments
    vertices : (v, 3) m; triangles : (t, 3) of the blocks' boundaries, anticlockwise seen from outside, with
        triangle_block : (t,) (empty arrays where the blocks are given by their outlines)
    """

    volumes: Floats
    centroids: Floats
    fixed: Bools
    patches: Patches
    in_section: bool
    vertices: Floats
    triangles: Ints
    triangle_block: Ints

    def __len__(self) -> int:
        return len(self.volumes)

    def without_blocks(self, removed: Bools) -> "Assembly":
        """Return the assembly without some blocks (n,): they keep their numbers, cannot move and touch nothing."""
        is_removed = np.append(removed, False)
        is_open = is_removed[self.patches.plus] | is_removed[self.patches.minus]
        plus, minus = (
            np.where(is_open, BEDROCK, side) for side in (self.patches.plus, self.patches.minus)
        )
        patches = replace(self.patches, plus=plus, minus=minus)
        return replace(self, fixed=self.fixed | removed, patches=patches)
