"""What all scenes of one result share: the blocks with their sizes, the rock about them, where they are seen from."""

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
from slopekit.result import JUDGED
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
_CROWDED = 0.4  # of the distance to the nearest head: the most that a plate takes


class Stage(ExportSource):
    """The document of a result with its scene."""

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> "Stage":
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
    def alone(self) -> bool:
        """Whether there is one block and the bedrock."""
        return len(self.scene.shapes.names) == 1

    @cached_property
    def free(self) -> Bools:
        """Blocks that are no bedrock, (n,)."""
        return ~self.scene.shapes.fixed

    @cached_property
    def of_vertex(self) -> Ints:
        """The block of each vertex, (v,)."""
        return block_of_vertex(self.scene.shapes)

    @cached_property
    def size(self) -> float:
        """The largest extent of the blocks that can move, m."""
        vertices = self.scene.shapes.solids.vertices
        own = self.free[self.of_vertex]
        return float(np.ptp(vertices[own] if own.any() else vertices, axis=0).max())

    @cached_property
    def sizes(self) -> Floats:
        """The extent of each block, (n,) m."""
        count, vertices = len(self.scene.shapes.names), self.scene.shapes.solids.vertices
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        np.minimum.at(low, self.of_vertex, vertices)
        np.maximum.at(high, self.of_vertex, vertices)
        extents: Floats = np.where(np.isfinite(high - low), high - low, 0.0).max(axis=1)
        return extents

    @property
    def in_section(self) -> bool:
        """Whether everything repeats along the strike, and one slice shows it all."""
        if self._given("geometry", "thickness_m") is None or not self.free.any():
            return False
        y = self.scene.shapes.centroids[self.free, 1]
        return not np.ptp(y) > 1e-9 * self.size  # columns may stand in several rows

    def _given(self, part: str, key: str) -> Any:
        section = self.document.get(part)
        return section.get(key) if isinstance(section, Mapping) else None

    @cached_property
    def touched(self) -> Bools:
        """Blocks that node pairs lie on, (n,)."""
        is_touched = np.zeros(len(self.scene.shapes.names) + 1, dtype=bool)
        is_touched[self.scene.pairs.plus] = is_touched[self.scene.pairs.minus] = True
        return is_touched[:-1]

    @cached_property
    def balanced(self) -> Bools:
        """Blocks whose loads and contact forces are all known: they cancel. (n,)"""
        scene = self.scene
        count = len(scene.shapes.names)
        left, load = np.zeros((count + 1, 3)), np.zeros(count + 1)
        force = scene.pairs.normal_kn[:, None] * scene.pairs.normals + scene.pairs.shear_kn
        np.add.at(left, scene.pairs.plus, force)
        np.subtract.at(left, scene.pairs.minus, force)
        np.add.at(left, scene.loads.block, scene.loads.force_kn)
        np.maximum.at(load, scene.loads.block, np.sqrt((scene.loads.force_kn**2).sum(axis=1)))
        off = np.sqrt((left * left).sum(axis=1))
        known: Bools = self.free & self.touched & (off[:-1] < _BALANCED * np.maximum(load[:-1], 1e-300))
        return known

    def neighbourhood(self, shown: Bools) -> float:
        """A length (m) that arrows and node pairs are drawn by: the extent of blocks shown (n,), or a few of them."""
        own = shown & (self.sizes > 0.0)
        if self.alone or not own.any():
            return self.size
        extent = np.ptp(self.scene.shapes.solids.vertices[own[self.of_vertex]], axis=0).max()
        return min(float(extent), 2.5 * float(np.median(self.sizes[own])))

    @cached_property
    def plate_width(self) -> float:
        """How wide plates are drawn, m: so that they are seen and do not touch; 0 without bolts."""
        if self.scene.bolts is None:
            return 0.0
        size = min(self.size, self.neighbourhood(self.free))
        return min(_PLATE * size, _CROWDED * nearest(self.scene.known_bolts.heads_m))

    @cached_property
    def apart(self) -> Floats:
        """Which way and how far each block is from the others, (n, 3) m: a lone one out of the slope by its size."""
        shapes = self.scene.shapes
        if self.alone:
            return np.array([self.size * free_normal(shapes)])
        own = shapes.fixed if shapes.fixed.any() else self.free
        away: Floats = shapes.centroids - shapes.centroids[own].mean(axis=0)
        if self.in_section:
            away[shapes.fixed] = 0.0
        return away

    # -- how the blocks fail ------------------------------------------------------------------------------------------

    @property
    def mechanisms(self) -> Sequence[Mapping[str, Any]]:
        """The mechanisms of many blocks in their order."""
        return counted_rows(self.document)

    @cached_property
    def without_strength(self) -> Bools:
        """Blocks that fail whatever the strength: they move in a mechanism that has no factor, (n,)."""
        return self._of_mechanisms(lambda one: one.get("fos") is None and one.get("status") != "not_converged")

    @cached_property
    def unsettled(self) -> Bools:
        """Blocks of mechanisms that did not settle, (n,)."""
        return self._of_mechanisms(lambda one: one.get("status") == "not_converged")

    def _of_mechanisms(self, wanted: Callable[[Mapping[str, Any]], bool]) -> Bools:
        numbers = [k for k, one in enumerate(self.mechanisms, 1) if wanted(one)]
        return np.isin(self.scene.order, numbers)

    def ways(self, step: int) -> dict[str, str]:
        """How the blocks of a mechanism move, by name."""
        if not 0 < step <= len(self.mechanisms):
            return {}
        return dict(zip(self.mechanisms[step - 1]["blocks"], self.mechanisms[step - 1]["how"], strict=True))

    # -- where it is seen from ----------------------------------------------------------------------------------------

    @cached_property
    def out(self) -> Floats:
        """(3,) unit and level: out of the slope."""
        face = self._given("inputs", "face")
        if isinstance(face, str):
            return Line(parse_plane(face, "face").dip_direction_deg, 0.0).vector()
        profile = self._given("inputs", "profile_m")
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
            along = cross(np.array([0.0, 0.0, 1.0]), self.out)
            if not isinstance(self._given("inputs", "face"), str):
                along = np.array([0.0, 1.0, 0.0])  # x to the right, z up
            return _seen(-along, 12.0 if along @ cross(np.array([0.0, 0.0, 1.0]), self.out) > 0 else -12.0, 9.0)
        return _seen(self.out, 32.0, 27.0)

    # -- words --------------------------------------------------------------------------------------------------------

    @property
    def title(self) -> str:
        """What was analysed."""
        title = str(self.document.get("title") or "")
        return title if len(title) <= _LETTERS else title[: _LETTERS - 1] + "…"

    @property
    def answer(self) -> str:
        """Status, factor and check: never a bare factor of safety."""
        document, fos, leading = self.document, self.document.get("fos") or {}, self.document.get("leading") or {}
        limit, closed, lowest, searched = (
            fos.get(name) for name in ("limit", "closed_form", "lowest", "all_pairs_failed")
        )
        name, agree, accepted = str(leading.get("name")), document.get("agree"), document.get("accepted")
        compared = {True: "agree", False: "DO NOT AGREE", None: "not compared"}[agree]
        said = [
            (str(document.get("status_text", "")), True),
            (f"FoS {factor_text(leading.get('fos'))} ({JUDGED.get(name)}, judged by ACCEPT)", name in JUDGED),
            ("no factor of safety", limit is None),
            (f"FoS {factor_text(limit)} ({'limit' if leading else 'PRE-IE'})", limit is not None),
            (f"lowest estimate {factor_text(lowest)}",
             name != "lowest" and lowest is not None and limit is not None and lowest <= 0.99 * limit),
            (f"all pairs failed {factor_text(searched)}", searched is not None and name != "all_pairs_failed"),
            (f"closed form {factor_text(closed)}", closed is not None),
            ("no closed form to compare with" if closed is None and agree is None else compared,
             document.get("status") != "not_converged"),
            ("moments govern", bool(document.get("moments_govern")) and limit is not None),
            (f"acceptance {'met' if accepted else 'NOT MET'}", accepted is not None),
        ]  # fmt: skip
        return " · ".join(text for text, is_said in said if is_said)

    # -- what stands about the blocks ---------------------------------------------------------------------------------

    def rock(self, opacity: float = 1.0) -> list[Layer]:
        """The bedrock: that of the model, or what lies about its one block."""
        shapes = self.scene.shapes
        if not self.alone:
            if not shapes.fixed.any():
                return []
            colours = np.tile(np.array(ROCK), (len(shapes.names), 1))
            return [blocks_layer("bedrock", shapes, shapes.fixed, colours, opacity=opacity)]
        body, shortest = None, 0.0
        if self.is_curved:
            profile = self._given("inputs", "profile_m")
            body, shortest = ground_below(shapes, profile) if profile else None, 0.03 * self.size
        elif self.document.get("assembly") is None:
            body = rock_around(shapes)
        return [] if body is None else [layer("rock", body, ROCK, opacity, outlined=True, shortest=shortest)]

    def block_colours(self) -> Ints:
        """Blocks that move in the first mechanism, and the others, (n, 3)."""
        colours = np.tile(np.array(STANDS), (len(self.scene.shapes.names), 1))
        colours[self.scene.order == 1] = BLOCK
        if self.alone:
            colours[:] = BLOCK
        return colours

    def joint_names(self) -> list[str]:
        """Joints as the legend has them: with their orientation where the design gives one."""
        from slopekit.views.charts.orientation_charts import orientations_of  # few pictures name joints

        planes = orientations_of(self.document).joints
        return [f"{name} {planes[name]}" if name in planes else name for name in self.scene.shapes.joints]


def joint_colour(joint: int) -> tuple[int, int, int]:
    """The colour of a joint by its index."""
    return JOINTS[joint % len(JOINTS)]


def _seen(before: Floats, turned_deg: float, above_deg: float) -> Floats:
    """A direction turned about the vertical and raised."""
    turn, rise = math.radians(turned_deg), math.radians(above_deg)
    x, y = float(before[0]), float(before[1])
    level = np.array([x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), 0.0])
    direction: Floats = math.cos(rise) * level + np.array([0.0, 0.0, math.sin(rise)])
    return direction
