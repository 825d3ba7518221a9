"""Wedges as manifold3d cuts them: a source that shares no line with `slopekit.geometry.polytopes`."""

from dataclasses import dataclass

import numpy as np

from slopekit.geometry.polytopes import Block
from slopekit.geometry.rock.cutting import far_box, half_space
from slopekit.geometry.rock.rockmass import wedge_corners

FAR = 1000


@dataclass(frozen=True)
class RockMass:
    """The planes of a wedge, J1, J2, face, upper slope and maybe a crack, and its corners without the crack."""

    normals: np.ndarray
    offsets: np.ndarray
    toe: np.ndarray
    back: np.ndarray
    crest1: np.ndarray
    crest2: np.ndarray

    @property
    def corners(self) -> np.ndarray:
        return np.array([self.toe, self.back, self.crest1, self.crest2])

    @property
    def line_of_intersection(self) -> np.ndarray:
        return -self.back / np.linalg.norm(self.back)


def wedge_rock_mass(joints, face, upper, height, crack=None, distance=0.0) -> RockMass:
    """The planes of a wedge with its corners. Raises GeometryError as `wedge_corners`."""
    back, crest1, crest2 = wedge_corners(joints, face, upper, height, crack, distance)
    planes, offsets = [*joints, face, upper], [0.0, 0.0, 0.0, upper @ crest1]
    if crack is not None:
        trace = back - crest1
        planes.append(crack)
        offsets.append(crack @ (crest1 + trace * (distance / np.linalg.norm(trace))))
    return RockMass(np.array(planes), np.array(offsets), np.zeros(3), back, crest1, crest2)


def cut_wedge(rock: RockMass) -> Block:
    """The wedge between joints, face and upper slope, cut out of the box about its corners, scaled to a cube."""
    lowest, highest = rock.corners.min(axis=0), rock.corners.max(axis=0)
    centre, half = (lowest + highest) / 2.0, (highest - lowest) / 2.0
    sides = np.sign(rock.offsets - rock.normals @ rock.corners.mean(axis=0))
    normals = rock.normals * sides[:, None] * half
    lengths = np.linalg.norm(normals, axis=1)
    offsets = (rock.offsets * sides - (rock.normals * sides[:, None]) @ centre) / lengths
    piece = far_box(1.5, FAR)
    for plane, normal in enumerate(normals / lengths[:, None]):
        piece = piece.split(half_space(normal, float(offsets[plane]), plane, 2 * FAR))[1]
    mesh = piece.to_mesh64()
    points = np.asarray(mesh.vert_properties) * half + centre
    triangles, made_by = (
        points[np.asarray(mesh.tri_verts, dtype=int)],
        np.asarray(mesh.face_id, dtype=int),
    )
    assert made_by.max() < FAR
    a, b, c = triangles.swapaxes(0, 1)
    parts = (np.cross(a - points[0], b - points[0]) * (c - points[0])).sum(axis=1) / 6.0
    centroid = (parts[:, None] * (a + b + c + points[0])).sum(axis=0) / 4.0 / parts.sum()
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
    planes = sorted(set(made_by.tolist()))
    return Block(
        faces={plane: triangles[made_by == plane].reshape(-1, 3) for plane in planes},
        areas={plane: float(areas[made_by == plane].sum()) for plane in planes},
        volume=float(parts.sum()),
        centroid=centroid,
    )
