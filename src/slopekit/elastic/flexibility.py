"""How an elastic block gives at the node pairs of its contacts: small strains, P1 or P2 elements (scikit-fem).

    K u = Lᵀ f + G q,   d = L u

f are the forces at the pairs, q the load of the block: six numbers (three in a section), spread over its volume as the
field a + ω x r that has this force and moment, which for a weight is the unit weight itself. L are the shape functions
at the pairs: the mesh of the block need not match them. All u but those of the nodes that L sees are eliminated.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from slopekit.core.arrays import Floats, Ints, frozen

ORDER = 2  # of the elements
_CHUNK = 2_000_000  # barycentric coordinates at a time
_NO_SHAPE = 1e-7  # a shape function that is none: what coordinates of nine digits leave of nodes off a contact


@dataclass(frozen=True)
class CondensedBlock:
    """A block, condensed to the k unknowns of its elements at its contacts.

    Attributes
    ----------
    shapes : (3m, k) sparse, displacement of its m pairs by them; where : (k / d, d) m, their nodes
    stiffness : (k, k) kN/m, what is left of K once all others are eliminated; load : (k, u), of a unit load
    rigid : (k, u), of a unit motion as a whole
    seen, seen_by_load : (3, k), (3, u) its mean displacement by them and by a unit load
    degrees : unknowns of the finite elements; cells : their number
    """

    shapes: Any
    where: Floats
    stiffness: Floats
    load: Floats
    rigid: Floats
    seen: Floats
    seen_by_load: Floats
    degrees: int
    cells: int


class Elements:
    """The finite elements of a body: its stiffness and its shape functions at points.

    Parameters
    ----------
    mesh : tetrahedra in space, triangles in the x-z plane of a section of a thickness (m)
    modulus_kpa, poisson : Young's modulus and Poisson's ratio of the rock; order : of the elements
    """

    def __init__(
        self, mesh: Any, modulus_kpa: float, poisson: float, thickness: float = 1.0, order: int = ORDER
    ) -> None:
        import skfem

        self.mesh, self.thickness = mesh, thickness
        self.space = [0, 2] if len(mesh.p) == 2 else [0, 1, 2]
        kinds = {(2, 1): "TriP1", (2, 2): "TriP2", (3, 1): "TetP1", (3, 2): "TetP2"}
        self.basis = skfem.Basis(mesh, getattr(skfem, f"Element{kinds[len(mesh.p), order]}")())
        self.stiffness = self._stiffness(modulus_kpa, poisson) * thickness
        cells, corners = mesh.t.T, mesh.p.T[mesh.t.T]
        volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / (2.0 if len(mesh.p) == 2 else 6.0)
        self.volume = float(volumes.sum()) * thickness
        self.centroid = volumes @ corners.mean(axis=1) / volumes.sum()
        around = corners - self.centroid
        sums, k = around.sum(axis=1), cells.shape[1]
        self.second = thickness / (k * (k + 1)) * (
            np.einsum("c,cki,ckj->ij", volumes, around, around) + np.einsum("c,ci,cj->ij", volumes, sums, sums)
        )  # fmt: skip

    @property
    def degrees(self) -> int:
        """Unknowns."""
        return int(self.stiffness.shape[0])

    def centroid_point(self) -> Floats:
        """The centroid (3,), in the plane of a section y = 0."""
        out = np.zeros(3)
        out[self.space] = self.centroid
        return out

    def _stiffness(self, modulus_kpa: float, poisson: float) -> Any:
        """K (degrees, degrees): ∫ λ div u div v + 2 μ ε(u) ε(v), in a section with plane strain.

        All pairs of shape functions at once: scikit-fem's own assembly of vectors takes twenty times as long.
        """
        shear = modulus_kpa / (2.0 * (1.0 + poisson))
        bulk = modulus_kpa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        slopes = np.stack([np.asarray(one[0].grad) for one in self.basis.basis])  # (k, d, c, q)
        weighted = slopes * np.asarray(self.basis.dx)
        (k, dim, cells, _), same = slopes.shape, np.eye(len(self.space))
        left, right = (one.reshape(k * dim, cells, -1) for one in (weighted, slopes))
        products = np.matmul(left.transpose(1, 0, 2), right.transpose(1, 2, 0)).reshape(cells, k, dim, k, dim)
        whole = bulk * products + shear * products.transpose(0, 1, 4, 3, 2)
        whole += shear * np.einsum("ciaja,bd->cibjd", products, same)
        place = (dim * self.basis.element_dofs.T[:, :, None] + np.arange(dim)).reshape(cells, -1)
        rows, columns = np.broadcast_arrays(place[:, :, None], place[:, None])
        size = dim * self.basis.N
        return sparse.coo_matrix((whole.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size)).tocsc()

    def shapes(self, points: Floats) -> Any:
        """L (3q, degrees) sparse: displacement east, north, up at points (q, 3) of the body, none out of a section."""
        basis, dim = self.basis, len(self.space)
        cells, local = self._places(points[:, self.space])
        where = local.T[:, :, None]
        rows, columns, values = [], [], []
        for k in range(basis.Nbfun):
            shape = np.asarray(basis.elem.gbasis(basis.mapping, where, k, tind=cells)[0])[:, 0]
            for i in range(dim):
                rows.append(3 * np.arange(len(points)) + self.space[i])
                columns.append(dim * basis.element_dofs[k, cells] + i)
                values.append(shape)
        joined = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return sparse.coo_matrix(joined, shape=(3 * len(points), self.degrees)).tocsr()

    def _places(self, points: Floats) -> tuple[Ints, Floats]:
        """The cell of each point, and its place in the reference cell: the cell that it is deepest in."""
        mesh = self.mesh
        origin = mesh.p[:, mesh.t[0]].T
        sides = np.linalg.inv((mesh.p[:, mesh.t[1:]] - mesh.p[:, mesh.t[:1]]).transpose(2, 0, 1))
        cells, local = [], []
        for part in np.array_split(points, 1 + len(points) * len(origin) // _CHUNK):
            at = np.einsum("cij,pcj->pci", sides, part[:, None, :] - origin[None])
            depth = np.minimum(at.min(axis=2), 1.0 - at.sum(axis=2))
            best = np.argmax(depth, axis=1)
            cells.append(best)
            local.append(at[np.arange(len(part)), best])
        return np.concatenate(cells), np.concatenate(local)

    def mean(self) -> Any:
        """(3, degrees) sparse: the mean displacement of the body."""
        out = np.zeros((3, self.degrees))
        out[self.space] = self._by_fields(np.eye(len(self.space))[:, :, None, None]).T * self.thickness / self.volume
        return sparse.csr_matrix(out)

    def spread(self, length: float) -> Floats:
        """G (degrees, u): a unit load (kN; moments about the centroid in parts of a length, m) spread over the body."""
        dim = len(self.space)
        where = np.asarray(self.basis.global_coordinates())  # (d, c, q)
        r = where - self.centroid[:, None, None]
        constant = np.broadcast_to(np.eye(dim)[:, :, None, None] / self.volume, (dim, dim, *r.shape[1:]))
        if dim == 2:  # about y, which turns z into x
            turning = np.stack([r[1], -r[0]])[None] / np.trace(self.second)
        else:
            inertia = np.trace(self.second) * np.eye(3) - self.second
            turning = np.stack([np.cross(own, r, axisb=0, axisc=0) for own in np.linalg.inv(inertia)])
        return self._by_fields(np.concatenate([constant, turning * length])) * self.thickness

    def _by_fields(self, fields: Floats) -> Floats:
        """Work (degrees, f) of body forces, (f, d, c, q) at the points of quadrature."""
        basis, dim = self.basis, len(self.space)
        values = np.stack([np.broadcast_to(np.asarray(one[0]), basis.dx.shape) for one in basis.basis]) * basis.dx
        out = np.zeros((basis.N, dim, len(fields)))
        for k, shape in enumerate(values):
            work = (fields * shape).sum(axis=3)  # (f, d, c)
            np.add.at(out, basis.element_dofs[k], work.transpose(2, 1, 0))
        return out.reshape(basis.N * dim, -1)

    def rigid(self, points: Floats, about: Floats, length: float) -> Floats:
        """Displacements (3q, u) of points (q, 3) by unit rigid motions of a body about a point (3,)."""
        r = (points - about) / length
        q = len(points)
        turns = np.zeros((q, 3, 3))
        turns[:, 1, 0], turns[:, 2, 0] = -r[:, 2], r[:, 1]
        turns[:, 0, 1], turns[:, 2, 1] = r[:, 2], -r[:, 0]
        turns[:, 0, 2], turns[:, 1, 2] = -r[:, 1], r[:, 0]
        whole = np.concatenate([np.tile(np.eye(3), (q, 1, 1)), turns], axis=2)
        if len(self.space) == 2:
            whole = whole[:, :, [0, 2, 4]]
        return whole.reshape(3 * q, -1)

    def condensed(self, kept: Ints, loads: Floats, seen: Any) -> tuple[Floats, Floats, Floats, Floats]:
        """What is left at the unknowns kept (k,) once all others are eliminated.

        Parameters
        ----------
        loads : (degrees, u); seen : (q, degrees) sparse, what is wanted of the displacements

        Returns K (k, k), symmetric, the loads (k, u), and what is seen by the displacements kept (q, k) and by the
        loads (q, u).
        """
        others = np.setdiff1d(np.arange(self.degrees), kept)
        own, beside = self.stiffness[kept][:, kept].toarray(), self.stiffness[others][:, kept].toarray()
        load, mean, by_load = loads[kept], seen[:, kept].toarray(), np.zeros((seen.shape[0], loads.shape[1]))
        if len(others):
            inner = self.stiffness[others][:, others].tocsc()
            factor = splu(inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
            by_kept, by_loads = factor.solve(beside), factor.solve(np.ascontiguousarray(loads[others]))
            own, load = own - beside.T @ by_kept, load - by_kept.T @ loads[others]
            mean, by_load = mean - seen[:, others] @ by_kept, seen[:, others] @ by_loads
        stiffness: Floats = 0.5 * (own + own.T)
        return stiffness, load, mean, by_load


def _cleaned(shapes: Any) -> Any:
    """Shape functions (3q, degrees) of the nodes on a contact alone, their sum kept."""
    out = shapes.copy()
    out.data[np.abs(out.data) < _NO_SHAPE] = 0.0
    out.eliminate_zeros()
    whole, kept = (np.asarray(one.sum(axis=1)).ravel() for one in (shapes, out))
    return sparse.diags(np.divide(whole, kept, out=np.ones_like(whole), where=kept != 0.0)) @ out


def body(elements: Elements, points: Floats, axes: Floats, length: float) -> CondensedBlock:
    """A block by its node pairs.

    Parameters
    ----------
    points : (m, 3); axes : (m, 3, 3) local axes, one a row, turned round where the block is on the minus side
    length : m, of which turns are parts
    """
    dim, centre = len(elements.space), elements.centroid_point()
    shapes = (sparse.block_diag(list(axes), format="csr") @ _cleaned(elements.shapes(points))).tocsr()
    nodes = np.unique(shapes.tocoo().col // dim)
    kept = (dim * nodes[:, None] + np.arange(dim)).ravel()
    where = np.asarray(elements.basis.doflocs)[:, nodes].T
    at = np.zeros((len(nodes), 3))
    at[:, elements.space] = where
    rigid = elements.rigid(at, centre, length).reshape(len(nodes), 3, -1)[:, elements.space].reshape(len(kept), -1)
    stiffness, load, seen, by_load = elements.condensed(kept, elements.spread(length), elements.mean())
    return CondensedBlock(
        shapes[:, kept], frozen(where), frozen(stiffness), frozen(load), frozen(rigid), frozen(seen), frozen(by_load),
        elements.degrees, int(elements.mesh.t.shape[1]),
    )  # fmt: skip


def rigid_body(rows: Any, where: Floats) -> CondensedBlock:
    """A rigid block in the same form: one node at a point (d,), whose unknowns are the motion of the block.

    Parameters
    ----------
    rows : (3m, u) sparse, relative displacement of its pairs per unknown
    """
    motion = np.eye(rows.shape[1])
    none = np.zeros((3, len(motion)))
    return CondensedBlock(rows, where[None], 0.0 * motion, motion, motion, none, none, 0, 0)
