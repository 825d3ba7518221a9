"""The stage of a result's scenes: blocks with their sizes, the rock about them, the viewpoint."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from slopekit.bolts import nearest
from slopekit.core.arrays import Bools, Floats, Ints, cross
from slopekit.core.orientation import Line, parse_plane
from slopekit.core.sheet import factor_text
from slopekit.exchange.source import ExportSource, export_source
from slopekit.findings import counted_rows
from slopekit.kinds import known_kind
from slopekit.result import RULE_QUANTITIES
from slopekit.views.solid.layers import (
    BLOCK,
    JOINTS,
    ROCK,
    STANDS,
    Layer,
    block_of_vertex,
    blocks_layer,
    free_normal,
    ground_below,
    layer,
    rock_around,
)

_LETTERS = 72  # of a title
_BALANCED = 0.01  # of the largest load on a block
_PLATE = 0.024  # of the size: width of plates of bolts that stand far enough apart
_PLATE_SPACING = 0.4  # of the distance to the nearest head: the most that a plate takes


class Stage(ExportSource):
    """The document of a result with its scene."""

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "Stage":
        """The stage of a document.

        Raises
        ------
        DesignError
            E350 where it holds no scene.
        """
        return cls(document, export_source(document, "the file").scene)

    @property
    def kind(self) -> str:
        """The kind of design."""
        return str(self.document.get("kind", ""))

    @property
    def has_single_block(self) -> bool:
        """Whether there is one block and the bedrock."""
        return len(self.scene.shapes.names) == 1

    @cached_property
    def free(self) -> Bools:
        """Blocks that are no bedrock, (n,)."""
        return ~self.scene.shapes.fixed

    @cached_property
    def vertex_block(self) -> Ints:
        """The block of each vertex, (v,)."""
        return block_of_vertex(self.scene.shapes)

    @cached_property
    def size(self) -> float:
        """The largest extent of the blocks that can move, m."""
        vertices = self.scene.shapes.solids.vertices
        is_free = self.free[self.vertex_block]
        return float(np.ptp(vertices[is_free] if is_free.any() else vertices, axis=0).max())

    @cached_property
    def sizes(self) -> Floats:
        """The extent of each block, (n,) m."""
        count, vertices = len(self.scene.shapes.names), self.scene.shapes.solids.vertices
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        np.minimum.at(low, self.vertex_block, vertices)
        np.maximum.at(high, self.vertex_block, vertices)
        extents: Floats = np.where(np.isfinite(high - low), high - low, 0.0).max(axis=1)
        return extents

    @property
    def in_section(self) -> bool:
        """Whether everything repeats along the strike, and one slice shows it all."""
        if self._document_value("geometry", "thickness_m") is None or not self.free.any():
            return False
        y = self.scene.shapes.centroids[self.free, 1]
        return not np.ptp(y) > 1e-9 * self.size  # columns may stand in several rows

    def _document_value(self, section_name: str, key: str) -> Any:
        section = self.document.get(section_name)
        return section.get(key) if isinstance(section, Mapping) else None

    @cached_property
    def has_node_pairs(self) -> Bools:
        """Blocks that node pairs lie on, (n,)."""
        is_touched = np.zeros(len(self.scene.shapes.names) + 1, dtype=bool)
        is_touched[self.scene.pairs.plus] = is_touched[self.scene.pairs.minus] = True
        return is_touched[:-1]

    @cached_property
    def balanced(self) -> Bools:
        """Whether all loads and contact forces of each block (n,) are known, so that they cancel."""
        scene = self.scene
        count = len(scene.shapes.names)
        unbalanced_kn, load = np.zeros((count + 1, 3)), np.zeros(count + 1)
        force = scene.pairs.normal_kn[:, None] * scene.pairs.normals + scene.pairs.shear_kn
        np.add.at(unbalanced_kn, scene.pairs.plus, force)
        np.subtract.at(unbalanced_kn, scene.pairs.minus, force)
        np.add.at(unbalanced_kn, scene.loads.block, scene.loads.force_kn)
        np.maximum.at(load, scene.loads.block, np.sqrt((scene.loads.force_kn**2).sum(axis=1)))
        unbalanced_size = np.sqrt((unbalanced_kn * unbalanced_kn).sum(axis=1))
        balanced: Bools = (
            self.free
            & self.has_node_pairs
            & (unbalanced_size[:-1] < _BALANCED * np.maximum(load[:-1], 1e-300))
        )
        return balanced

    def neighbourhood(self, chosen: Bools) -> float:
        """A length (m) that arrows and node pairs are drawn by: the extent of blocks shown (n,), or a few of them."""
        has_extent = chosen & (self.sizes > 0.0)
        if self.has_single_block or not has_extent.any():
            return self.size
        extent = np.ptp(
            self.scene.shapes.solids.vertices[has_extent[self.vertex_block]], axis=0
        ).max()
        return min(float(extent), 2.5 * float(np.median(self.sizes[has_extent])))

    @cached_property
    def plate_width(self) -> float:
        """The width of drawn plates, m: visible, and not touching; 0 without bolts."""
        if self.scene.bolts is None:
            return 0.0
        size = min(self.size, self.neighbourhood(self.free))
        return min(_PLATE * size, _PLATE_SPACING * nearest(self.scene.known_bolts.heads_m))

    @cached_property
    def explosion_vectors(self) -> Floats:
        """Which way and how far each block is from the others, (n, 3) m: a lone one out of the slope by its size."""
        shapes = self.scene.shapes
        if self.has_single_block:
            return np.array([self.size * free_normal(shapes)])
        is_reference = shapes.fixed if shapes.fixed.any() else self.free
        vectors: Floats = shapes.centroids - shapes.centroids[is_reference].mean(axis=0)
        if self.in_section:
            vectors[shapes.fixed] = 0.0
        return vectors

    # -- how the blocks fail ------------------------------------------------------------------------------------------

    @property
    def mechanisms(self) -> Sequence[Mapping[str, Any]]:
        """The mechanisms of many blocks in their order."""
        return counted_rows(self.document)

    @cached_property
    def without_strength(self) -> Bools:
        """Blocks that fail whatever the strength: they move in a mechanism that has no factor, (n,)."""
        return self._blocks_in_mechanisms(
            lambda mechanism: (
                mechanism.get("fos") is None and mechanism.get("status") != "not_converged"
            )
        )

    @cached_property
    def unsettled(self) -> Bools:
        """Blocks of mechanisms that did not settle, (n,)."""
        return self._blocks_in_mechanisms(
            lambda mechanism: mechanism.get("status") == "not_converged"
        )

    def _blocks_in_mechanisms(self, condition: Callable[[Mapping[str, Any]], bool]) -> Bools:
        numbers = [k for k, mechanism in enumerate(self.mechanisms, 1) if condition(mechanism)]
        return np.isin(self.scene.order, numbers)

    def movements(self, step: int) -> dict[str, str]:
        """Return how the blocks of a mechanism move, by name."""
        if not 0 < step <= len(self.mechanisms):
            return {}
        return dict(
            zip(self.mechanisms[step - 1]["blocks"], self.mechanisms[step - 1]["how"], strict=True)
        )

    # -- where it is seen from ----------------------------------------------------------------------------------------

    @cached_property
    def outward(self) -> Floats:
        """(3,) unit and level: out of the slope."""
        face = self._document_value("inputs", "face")
        if isinstance(face, str):
            return Line(parse_plane(face, "face").dip_direction_deg, 0.0).vector()
        profile = self._document_value("inputs", "profile_m")
        if profile:
            ends = sorted(profile)
            return np.array([1.0 if ends[-1][1] <= ends[0][1] else -1.0, 0.0, 0.0])
        level = self.scene.velocity[:, :3].sum(axis=0) * [1.0, 1.0, 0.0]
        length = math.sqrt(float(level @ level))
        if length > 0.0:
            unit: Floats = level / length
            return unit
        kind = known_kind(self.kind)
        return np.array([-1.0 if kind is not None and kind.record.FALLS_WEST else 1.0, 0.0, 0.0])

    @cached_property
    def eye(self) -> Floats:
        """(3,) unit, toward the eye: before the slope, or beside a section."""
        if self.in_section:
            along = cross(np.array([0.0, 0.0, 1.0]), self.outward)
            if not isinstance(self._document_value("inputs", "face"), str):
                along = np.array([0.0, 1.0, 0.0])  # x to the right, z up
            return _raised_direction(
                -along,
                12.0 if along @ cross(np.array([0.0, 0.0, 1.0]), self.outward) > 0 else -12.0,
                9.0,
            )
        return _raised_direction(self.outward, 32.0, 27.0)

    # -- words --------------------------------------------------------------------------------------------------------

    @property
    def title(self) -> str:
        """The title of the analysis."""
        title = str(self.document.get("title") or "")
        return title if len(title) <= _LETTERS else title[: _LETTERS - 1] + "…"

    @property
    def answer(self) -> str:
        """Status, factor and check: never a bare factor of safety."""
        document, fos, leading = (
            self.document,
            self.document.get("fos") or {},
            self.document.get("leading") or {},
        )
        limit, closed, lowest, searched = (
            fos.get(name) for name in ("limit", "closed_form", "lowest", "all_pairs_failed")
        )
        name, agree, accepted = (
            str(leading.get("name")),
            document.get("agree"),
            document.get("accepted"),
        )
        compared = {True: "agree", False: "DO NOT AGREE", None: "not compared"}[agree]
        statements = [
            (str(document.get("status_text", "")), True),
            (
                f"FoS {factor_text(leading.get('fos'))} ({RULE_QUANTITIES.get(name)}, judged by ACCEPT)",
                name in RULE_QUANTITIES,
            ),
            ("no factor of safety", limit is None),
            (f"FoS {factor_text(limit)} ({'limit' if leading else 'PRE-IE'})", limit is not None),
            (
                f"lowest estimate {factor_text(lowest)}",
                name != "lowest"
                and lowest is not None
                and limit is not None
                and lowest <= 0.99 * limit,
            ),
            (
                f"all pairs failed {factor_text(searched)}",
                searched is not None and name != "all_pairs_failed",
            ),
            (f"closed form {factor_text(closed)}", closed is not None),
            (
                "no closed form to compare with" if closed is None and agree is None else compared,
                document.get("status") != "not_converged",
            ),
            ("moments govern", bool(document.get("moments_govern")) and limit is not None),
            (f"acceptance {'met' if accepted else 'NOT MET'}", accepted is not None),
        ]
        return " · ".join(text for text, applies in statements if applies)

    # -- what stands about the blocks ---------------------------------------------------------------------------------

    def rock(self, opacity: float = 1.0) -> list[Layer]:
        """The bedrock: that of the model, or what lies about its one block."""
        shapes = self.scene.shapes
        if not self.has_single_block:
            if not shapes.fixed.any():
                return []
            colours = np.tile(np.array(ROCK), (len(shapes.names), 1))
            return [blocks_layer("bedrock", shapes, shapes.fixed, colours, opacity=opacity)]
        body, shortest = None, 0.0
        if self.is_curved:
            profile = self._document_value("inputs", "profile_m")
            body, shortest = ground_below(shapes, profile) if profile else None, 0.03 * self.size
        elif self.document.get("assembly") is None:
            body = rock_around(shapes)
        return (
            []
            if body is None
            else [layer("rock", body, ROCK, opacity, outlined=True, shortest=shortest)]
        )

    def block_colours(self) -> Ints:
        """Blocks that move in the first mechanism, and the others, (n, 3)."""
        colours = np.tile(np.array(STANDS), (len(self.scene.shapes.names), 1))
        colours[self.scene.order == 1] = BLOCK
        if self.has_single_block:
            colours[:] = BLOCK
        return colours

    def joint_names(self) -> list[str]:
        """Joints as the legend has them: with their orientation where the design gives one."""
        from slopekit.views.charts.orientation_charts import (
            orientations_of,
        )  # few pictures name joints

        planes = orientations_of(self.document).joints
        return [
            f"{name} {planes[name]}" if name in planes else name
            for name in self.scene.shapes.joints
        ]


def joint_colour(joint: int) -> tuple[int, int, int]:
    """The colour of a joint by its index."""
    return JOINTS[joint % len(JOINTS)]


def _raised_direction(initial: Floats, azimuth_deg: float, elevation_deg: float) -> Floats:
    """A direction turned about the vertical and raised."""
    turn, rise = math.radians(azimuth_deg), math.radians(elevation_deg)
    x, y = float(initial[0]), float(initial[1])
    level = np.array(
        [x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), 0.0]
    )
    direction: Floats = math.cos(rise) * level + np.array([0.0, 0.0, math.sin(rise)])
    return direction
