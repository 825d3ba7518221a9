"""Faces of mesh files with three corners or more, cut into triangles."""

from collections.abc import Sequence

import numpy as np

from slopekit.core.arrays import Bools, Floats, Ints

_CROSSED = 1e-6  # of the square of a face's size: areas that differ by less are rounding of its corners
_NOTHING = 1e-12  # of the same: outlines that cross themselves can have a vector area of nothing


#: The corners of a face in the order in which it is cut, and whether that is backward in the file.
_Outline = tuple[list[int], bool]


class CrossedFaceError(ValueError):
    """A face whose outline crosses itself bounds no area."""


def triangulated(vertices: Floats, faces: Sequence[Sequence[int]]) -> Ints:
    """Triangles (t, 3) of faces that are convex or not, in their order and with their sense of rotation.

    A face is cut in the plane of its Newell normal, from the corner and in the direction that the coordinates of its
    corners decide: a warped face that two blocks share has the same diagonals in both.

    Parameters
    ----------
    vertices : (v, 3) m; faces : the vertices of each face, in order around it

    Raises
    ------
    CrossedFaceError
        A face crosses itself. ValueError a face has fewer than three corners, or a coordinate is no number.

    >>> ell = np.array([[0, 0, 0], [3, 0, 0], [3, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]], dtype=float)
    >>> a, b, c = ell[triangulated(ell, [[0, 1, 2, 3, 4, 5]])].transpose(1, 0, 2)
    >>> (np.cross(b - a, c - a) / 2.0).sum(axis=0).tolist()
    [0.0, 0.0, 5.0]
    """
    sizes = np.fromiter(map(len, faces), dtype=np.int64, count=len(faces))
    if (sizes < 3).any():
        raise ValueError(f"face {int((sizes < 3).argmax()) + 1} has fewer than three corners")
    if not np.isfinite(vertices).all():
        raise ValueError("a coordinate is no number")
    plain = np.flatnonzero(sizes == 3)
    triangles = [np.array([faces[k] for k in plain.tolist()], dtype=np.int64).reshape(-1, 3)]
    owners = [plain]
    polygons = np.flatnonzero(sizes > 3).tolist()
    place = _places(vertices).tolist() if polygons else []
    by_size: dict[int, list[tuple[int, _Outline]]] = {}
    for k in polygons:
        outline = _from_least_corner(faces[k], place)
        by_size.setdefault(len(outline[0]), []).append((k, outline))
    for size, group in by_size.items():
        if size >= 3:  # fewer are left of a face whose corners lie at two places
            triangles.append(_cut(vertices, [outline for _, outline in group]))
            owners.append(np.repeat([k for k, _ in group], size - 2))
    return np.concatenate(triangles)[np.argsort(np.concatenate(owners), kind="stable")]


def _cut(vertices: Floats, outlines: Sequence[_Outline]) -> Ints:
    """Triangles (t, 3) of faces of n corners, n - 2 of each."""
    from manifold3d import triangulate

    corners = np.array([ordered for ordered, _ in outlines])
    backward = np.array([is_backward for _, is_backward in outlines])
    flat = _in_newell_plane(vertices[corners])
    if (crossed := _crossed(flat)).any():
        raise CrossedFaceError(_in_words(vertices[corners[crossed.argmax()]]))
    cuts = np.array([triangulate([outline]) for outline in flat], dtype=np.int64)
    cuts[backward] = cuts[backward, :, ::-1]
    return np.take_along_axis(corners, cuts.reshape(len(corners), -1), axis=1).reshape(-1, 3)


def _places(vertices: Floats) -> Ints:
    """The place (v,) of each vertex among all, sorted by x, y and z; vertices with equal coordinates share it."""
    order = np.lexsort(vertices.T[::-1])
    place = np.zeros(len(vertices), dtype=np.int64)
    place[order[1:]] = np.cumsum((np.diff(vertices[order], axis=0) != 0.0).any(axis=1))
    return place


def _from_least_corner(face: Sequence[int], place: Sequence[int]) -> _Outline:
    """The corners of a face from its least place on toward the lesser neighbour, and whether that runs backward.

    Corners that repeat the one before them are dropped. An outline that passes its least place twice, as around a hole
    that a slit joins to the rim, begins with the lesser of the sequences of places.
    """
    corners = [corner for k, corner in enumerate(face) if place[corner] != place[face[k - 1]]]
    places = [place[corner] for corner in corners]
    least = min(places, default=0)
    orders = [
        (corners[k::step] + corners[:k:step] if step > 0 else corners[k::-1] + corners[:k:-1], step < 0)
        for k, number in enumerate(places) if number == least for step in (1, -1)
    ]  # fmt: skip
    return min(orders, key=lambda order: [place[corner] for corner in order[0]], default=([], False))


def _in_words(corners: Floats) -> str:
    """The first corners (n, 3) of a face, to find it by."""
    coordinates = ", ".join("({:.3f}, {:.3f}, {:.3f})".format(*corner) for corner in corners[:4].tolist())
    return f"{len(corners)} corners, {coordinates}{', …' if len(corners) > 4 else ''}"


def _in_newell_plane(points: Floats) -> Floats:
    """Corners (f, n, 2) of faces (f, n, 3), seen against their normals, in units of their sizes."""
    local = points - points[:, :1]
    local = local / np.maximum(np.abs(local).max(axis=(1, 2), keepdims=True), np.finfo(float).tiny)
    fan = np.cross(local[:, 1:-1], local[:, 2:])
    total, largest = fan.sum(axis=1), np.abs(fan).max(axis=2).argmax(axis=1)
    is_nothing = np.abs(total).max(axis=1, keepdims=True) <= _NOTHING
    normal = _unit(np.where(is_nothing, fan[np.arange(len(fan)), largest], total))
    across = _unit(np.cross(np.eye(3)[np.abs(normal).argmin(axis=1)], normal))
    upward = np.cross(normal, across)
    return np.stack([(local * axis[:, None]).sum(axis=2) for axis in (across, upward)], axis=2)


def _unit(vectors: Floats) -> Floats:
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    unit: Floats = vectors / np.maximum(length, np.finfo(float).tiny)
    return unit


def _crossed(outlines: Floats) -> Bools:
    """Which anticlockwise outlines (f, n, 2) of size 1 wind around some of their area not once.

    The signed area counts that as often as it is wound around: it is none of the two that count it once or by turns.
    """
    from manifold3d import CrossSection, FillRule

    x, y = np.moveaxis(outlines - outlines[:, :1], 2, 0)
    signed = (x[:, 1:-1] * y[:, 2:] - x[:, 2:] * y[:, 1:-1]).sum(axis=1) / 2.0
    rules = (FillRule.NonZero, FillRule.EvenOdd)
    covered = np.array([[CrossSection([outline], rule).area() for rule in rules] for outline in outlines])
    crossed: Bools = np.abs(covered - signed[:, None]).max(axis=1) > _CROSSED
    return crossed
