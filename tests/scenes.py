"""Scenes of the curved kinds for several tests: designs, their models, and meshes on disk."""

import math
from pathlib import Path
from typing import Any

import numpy as np

import slopekit as sk
from slopekit.geometry.solids.shapes import Cutter, Ellipsoid, profile_prism
from slopekit.kinds import surface
from slopekit.preie.one_block.slippage import Slippage, slippable
from slopekit.preie.system.model import Model, build_model

SLOPE = [[60, 0], [40, 0], [0, 40], [-20, 40]]  # the inferred slope of the paper's §4.2
PAPER = {"shape": "ellipsoid", "centre": [40, 0, 40], "radii": [40, 28.284271247461902, 40]}
SPHERE = {"shape": "sphere", "centre": [40, 0, 40], "radius": 40}
COARSE = {"edge": 16}  # 370 node pairs: four digits on a smooth cap


def inputs(
    slip: dict, slope: Any = SLOPE, c: float = 30.0, phi: float = 30.0, **more: Any
) -> dict[str, Any]:
    """A surface design as a mapping; `slope` is a profile, or the path of a mesh."""
    strength = {"c": c, "phi": phi} | {key: more.pop(key) for key in ("dilation",) if key in more}
    unit_weight = more.pop("unit_weight", 21.56)
    return {
        "slopekit": 1,
        "kind": "surface",
        "slip": slip,
        "strength": {"slip": strength},
        "slope": {"mesh": str(slope)} if isinstance(slope, str | Path) else {"profile": slope},
        "rock": {"unit_weight": unit_weight},
        **more,
    }


def run(slip: dict, slope: Any = SLOPE, **more: Any):
    """Analyse a surface."""
    return sk.run(inputs(slip, slope, **more))


def model_of(slip: dict, slope: Any = SLOPE, **more: Any) -> tuple[Model, Slippage]:
    """The model that an analysis would solve, and how its surface slides."""
    design = sk.load(inputs(slip, slope, **more))
    mass, pairs = surface._cut(design)
    loads = surface._loads(design, mass, pairs)
    slippage = slippable(pairs, mass.centroid, np.concatenate([loads.force, loads.moment]))
    strength = surface.joint_strength([design.strength])
    return build_model(slippage.pairs, loads, mass.centroid, strength), slippage


def tilted(distance: float, dip: float, reach: float) -> np.ndarray:
    """A straight profile at a distance (above: +) from the origin, dipping toward +x."""
    beta = math.radians(dip)
    normal, down = (
        np.array([math.sin(beta), math.cos(beta)]),
        np.array([math.cos(beta), -math.sin(beta)]),
    )
    return np.array([distance * normal - reach * down, distance * normal + reach * down])


def ground_about(body: Cutter, profile: Any) -> Cutter:
    """The ground below a profile around a slip body."""
    line = np.asarray(profile, dtype=float)
    low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
    margin = 0.1 * float((high - low).max())
    bottom = min(float(low[2]), float(line[:, 1].min())) - margin
    return profile_prism(
        line, bottom, float(high[1]) + margin, (float(low[0]) - margin, float(high[0]) + margin)
    )


def ellipsoid_mesh(level: int, radii=(40, 28.284271247461902, 40), centre=(40, 0, 40)):
    """Vertices and triangles of an ellipsoid."""
    body = Ellipsoid(np.array(radii, dtype=float)).cutter(level)
    return body.vertices + np.array(centre), body.triangles


def slab(profile: Any, half_width: float, low: float, reach: tuple[float, float]):
    """The ground as a closed mesh."""
    body = profile_prism(np.array(profile, dtype=float), low, half_width, reach)
    return body.vertices, body.triangles


def sheet(dip: float, width: float, length: float, through=(40.0, 0.0, 0.0), n: int = 8):
    """A flat sheet that dips toward +x."""
    beta = math.radians(dip)
    u, v = np.meshgrid(np.linspace(-0.3, 0.7, n + 1), np.linspace(-0.5, 0.5, n + 1))
    along = np.array([-math.cos(beta), 0.0, math.sin(beta)])
    points = (
        np.array(through)
        + length * u.reshape(-1, 1) * along
        + width * v.reshape(-1, 1) * [0.0, 1.0, 0.0]
    )
    grid = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(
        -1, 4
    )
    return points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def save(path: Path, mesh) -> Path:
    """Write vertices and triangles as a mesh file (OBJ keeps double precision, STL does not)."""
    import trimesh

    trimesh.Trimesh(*mesh, process=False).export(path)
    return path
