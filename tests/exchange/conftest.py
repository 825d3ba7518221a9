"""Scenes that several tests export, each made once: assemblies without solving them."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.block_scene import Arrows, BlockScene, NodePairState
from slopekit.core.codec import json_of
from slopekit.kinds import cut
from slopekit.kinds.assemblies.many_blocks import _geometry
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign

TEMPLATES = Path(__file__).parents[2] / "templates"
#: Map coordinates of the toe, m.
EAST, NORTH = 4_000_000.0, 5_500_000.0


def unsolved(design: AssemblyDesign) -> dict[str, Any]:
    """The JSON of an assembly that was cut and not solved: no node pairs, no factor."""
    geometry = _geometry(cut(design))
    shapes = geometry.shapes("block")
    count = len(shapes.names)
    none, whole = np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
    pairs = NodePairState(none, whole, np.zeros(0), none, whole, whole, np.zeros(0), none, whole)
    scene = BlockScene(
        shapes,
        pairs,
        Arrows((), whole, whole, none, none),
        np.zeros((count, 6)),
        np.zeros(count, dtype=np.int64),
        np.full(count, np.nan),
    )
    return {
        "slopekit": "0",
        "kind": design.kind,
        "inputs": {},
        "geometry": json_of(geometry),
        "scene": scene.to_dict(),
    }


@cache
def made(name: str) -> dict[str, Any]:
    """The JSON of a template, assemblies unsolved, or of the paper's wedge at map coordinates."""
    if name == "map":
        return sk.wedge(dips=("45/115", "45/245"), origin=(EAST, NORTH, 300.0)).to_dict()
    changes: dict[str, Any] = {"slip.edge": 6.0} if name == "paper-ellipsoid" else {}
    if name == "map-bench":
        changes["slope.origin"] = [EAST, NORTH, 300.0]
    design = sk.load(TEMPLATES / f"{name.removeprefix('map-')}.yaml", set=changes)
    if isinstance(design, AssemblyDesign):
        return unsolved(design)
    return sk.analyse(design).to_dict()


@pytest.fixture(scope="session")
def result():
    return made
