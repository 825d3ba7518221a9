"""Rigid motions along which a curved surface can slide without opening, and normals that agree with them.

A rigid mass slides on a surface without opening only along motions that are tangent to it everywhere: turning about a
sphere's centre, along and about a cylinder's axis. On a measured or meshed surface the normals scatter by part of a
degree, and at infinite slip the mass would ride on the few pairs where they lean against it, as on a ratchet
(docs/method.md). The motions are found as in slippage analysis (Gelfand & Guibas 2004), by the small eigenvalues of

    Σ A (n·v)² against Σ A |v|²,   v the velocity of a node pair,

whose roots are the sines of the angles between surface and motion. Each normal is then turned square to those that
come as near as the one on which the load works most.
"""

from dataclasses import dataclass, replace

import numpy as np

from slopekit.core.arrays import Bools, Floats, frozen
from slopekit.geometry.interfaces import NodePairs
from slopekit.preie.tolerances import ALIKE_MOTIONS, DRIVEN, FARTHEST_DEG, TANGENT_DEG, TINY, TURNED


@dataclass(frozen=True)
class Slippage:
    """The sliding motions of a surface.

    Attributes
    ----------
    pairs : node pairs with normals perpendicular to the motions
    motions : number of independent motions without opening (0: none, the motion that the load drives was taken)
    misfit_deg : root mean square angle by which the normals were turned; above `FARTHEST_DEG` no motion comes near,
        and the normals are left as they are
    """

    pairs: NodePairs
    motions: int
    misfit_deg: float


def slippable(pairs: NodePairs, centroid: Floats, load: Floats) -> Slippage:
    """Turn the normals of a curved surface perpendicular to the motions along which it slides without opening.

    Parameters
    ----------
    load : (6,) force and moment about `centroid`; it chooses the motion where the surface has none
    """
    arms = pairs.points - centroid
    length = float(np.sqrt((arms * arms).sum() / len(pairs)))
    arms = arms / length
    weight = pairs.control_areas / pairs.control_areas.sum()
    normal_rows = np.concatenate([pairs.normals, np.cross(arms, pairs.normals)], axis=1)
    point_rows = np.concatenate(
        [
            np.broadcast_to(np.eye(3), (len(arms), 3, 3)),
            np.cross(arms[:, None, :], np.eye(3)[None]),
        ],
        axis=2,
    )
    opening = (normal_rows.T * weight) @ normal_rows
    root = np.linalg.cholesky(np.einsum("n,niu,niv->uv", weight, point_rows, point_rows))
    half = np.linalg.solve(root, np.linalg.solve(root, opening).T)
    squares, axes = np.linalg.eigh((half + half.T) / 2.0)
    sines = np.sqrt(np.maximum(squares, 0.0))
    free: Bools = sines < np.sin(np.radians(TANGENT_DEG))
    motions = np.linalg.solve(root.T, axes)
    scaled = load * np.where(np.arange(6) < 3, 1.0, 1.0 / length)
    load_work = np.abs(motions.T @ scaled)
    if not (load_work[free] > DRIVEN * load_work.max()).any():
        free[:] = False
    if not free.any():
        chosen = motions @ ((motions.T @ scaled) / np.maximum(squares, TURNED**2))
        normals, angles = _tilted_to_motions(
            pairs.normals, np.einsum("niu,u->ni", point_rows, chosen)[:, :, None]
        )
    else:
        # a thin slice of a cylinder nearly lets tilting through: turned for that too, it would not turn on its axis
        first = int(np.argmax(np.where(free, load_work, 0.0)))
        free &= sines <= max(ALIKE_MOTIONS * float(sines[first]), TURNED)
        velocities = np.einsum("niu,uk->nik", point_rows, motions)
        normals, angles = _tilted_to_motions(pairs.normals, velocities[:, :, free])
        if not _are_tangent(
            normals, velocities[:, :, free]
        ):  # scattered normals: none is perpendicular to all motions
            driving = motions[:, free] @ (motions[:, free].T @ scaled)
            normals, angles = _tilted_to_motions(
                pairs.normals, np.einsum("niu,u->ni", point_rows, driving)[:, :, None]
            )
    misfit = float(np.sqrt(weight @ angles**2))
    if misfit < TURNED:
        return Slippage(pairs, int(free.sum()), 0.0)
    if np.degrees(misfit) > FARTHEST_DEG:
        return Slippage(pairs, 0, float(np.degrees(misfit)))
    return Slippage(
        replace(pairs, normals=frozen(normals)), int(free.sum()), float(np.degrees(misfit))
    )


def _are_tangent(normals: Floats, velocities: Floats) -> bool:
    """Return whether normals (n, 3) are perpendicular to velocities (n, 3, k)."""
    normal_speed = np.einsum("ni,nik->nk", normals, velocities)
    return float((normal_speed * normal_speed).sum()) <= TURNED**2 * float(
        (velocities * velocities).sum()
    )


def _tilted_to_motions(normals: Floats, velocities: Floats) -> tuple[Floats, Floats]:
    """Return normals (n, 3) turned perpendicular to velocities (n, 3, k) of rank <= 2, and the angles (n,) in rad."""
    normal = np.einsum("ni,nj->nij", normals, normals)
    tangential = velocities - np.einsum("nij,njk->nik", normal, velocities)
    # the two main directions of the tangential velocities; where there is but one, only that
    sizes, axes = np.linalg.eigh(np.einsum("nik,njk->nij", tangential, tangential))
    inverse = np.where(sizes > 1e-6 * sizes[:, -1:], 1.0 / np.maximum(sizes, TINY), 0.0)
    inverse[:, 0] = 0.0
    normal_speed = np.einsum("ni,nik->nk", normals, velocities)
    # least tilt t, tangential, with (n + t)·v = 0 for every velocity
    tilt = -np.einsum("nia,na,nja,njk,nk->ni", axes, inverse, axes, tangential, normal_speed)
    tilted = normals + tilt
    length = np.sqrt((tilted * tilted).sum(axis=1))
    return tilted / length[:, None], np.arctan(np.sqrt((tilt * tilt).sum(axis=1)))
