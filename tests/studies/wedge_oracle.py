"""Limit equilibrium of a wedge from corner points and force vectors, apart from slopekit: the source `lem`."""

import math
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull


def upward_normal(plane: Any) -> np.ndarray:
    """Upward unit normal of (dip, dip direction)."""
    dip, direction = math.radians(plane[0]), math.radians(plane[1])
    return np.array(
        [math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)]
    )


def wedge_factor(
    joints, face, upper, height, c, phi, unit_weight, pressures=(), force=(0, 0, 0), crack=None
) -> dict:
    """Factor, resisting and driving force, weight, volume, total height, plunge; crack: (plane, distance).

    `pressures` on J1, J2 (and the crack), kPa; a crack's water: "full", γ_w times a third of its depth.
    """
    n1, n2, nf, nu = (upward_normal(plane) for plane in (*joints, face, upper))
    trace1, trace2, line = np.cross(n1, nf), np.cross(n2, nf), np.cross(n1, n2)
    crest1 = trace1 * height / trace1[2]
    crest2, back = (axis * (nu @ crest1) / (nu @ axis) for axis in (trace2, line))
    corners = np.array([np.zeros(3), crest1, crest2, back])
    normals, found = [n1, n2], {"total_height": float(np.ptp(corners[:, 2]))}
    if crack is None:
        found["volume"] = abs(float(np.linalg.det(corners[1:]))) / 6.0
        areas = [float(np.linalg.norm(np.cross(crest, back))) / 2.0 for crest in (crest1, crest2)]
    else:
        n5 = upward_normal(crack[0])
        at = crest1 + (back - crest1) / np.linalg.norm(back - crest1) * crack[1]
        side = (corners - at) @ n5
        side *= np.sign(side[0])
        cuts = [
            corners[i] + (corners[j] - corners[i]) * side[i] / (side[i] - side[j])
            for i in range(4)
            for j in range(i)
            if side[i] * side[j] < 0.0
        ]
        kept = np.concatenate([corners[side > 0.0], cuts])
        found["volume"] = float(ConvexHull(kept).volume)
        areas = [_area(kept, n1, 0.0), _area(kept, n2, 0.0), _area(kept, n5, n5 @ at)]
        normals.append(
            n5 * np.sign((corners[0] - at) @ n5)
        )  # water in the crack pushes toward the toe
        lowest = min(cuts, key=lambda point: point[2])
        found["crack_depth"] = float(nu @ crest1 - nu @ lowest) / nu[2]
    found["weight"] = unit_weight * found["volume"]
    load = np.array(force, dtype=float) - [0.0, 0.0, found["weight"]]
    for normal, area, pressure in zip(normals, areas, pressures, strict=False):
        load = load + pressure * area * normal
    along = back / np.linalg.norm(back)
    found["plunge"] = math.degrees(math.asin(along[2]))
    across = -(load - (load @ along) * along)
    normal_forces = np.linalg.lstsq(np.column_stack([n1, n2]), across, rcond=None)[0]
    rough = [math.tan(math.radians(angle)) for angle in phi]
    if min(normal_forces) > 0.0:
        found["status"] = "slides_on_both" if load @ along < 0.0 else "slides_up"
        found["resisting"] = float(
            sum(c[k] * areas[k] + normal_forces[k] * rough[k] for k in (0, 1))
        )
        found["driving"] = abs(float(load @ along))
    else:
        for k, (own, other) in enumerate(((n1, n2), (n2, n1))):
            pressed = float(-load @ own)
            slides = load + pressed * own
            if pressed > 0.0 and slides @ other > 0.0:
                found["status"] = f"slides_on_J{k + 1}"
                found["resisting"] = c[k] * areas[k] + pressed * rough[k]
                found["driving"] = float(np.linalg.norm(slides))
    return found | {"factor": found["resisting"] / found["driving"]}


def _area(points: np.ndarray, normal: np.ndarray, offset: float) -> float:
    on = points[np.abs(points @ normal - offset) < 1e-9 * np.abs(points).max()]
    first = (on[1] - on[0]) / np.linalg.norm(on[1] - on[0])
    return float(ConvexHull(np.column_stack([on @ first, on @ np.cross(normal, first)])).volume)
