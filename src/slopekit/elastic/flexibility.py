"""The flexibility of an elastic block at the node pairs of its contacts: small strains, P1 or P2 elements (scikit-fem).

    K u = Lᵀ f + G q,   d = L u

f are the forces at the pairs, q the load of the block: six numbers (three in a section), spread over its volume as the
field a + ω x r that has this force and moment, which for a weight is the unit weight itself. L are the shape functions
at the pairs: the mesh of the block need not match them. All u but those of nodes with an entry in L are eliminated.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from slopekit.core.arrays import Floats, Ints, frozen

ORDER = 2  # of the elements
_CHUNK = 2_000_000  # barycentric coordinates at a time
#: Value below which a shape function is zero: rounding of coordinates with nine digits, at nodes off a contact.
_NO_SHAPE = 1e-7


@dataclass(frozen=True)
class CondensedBlock:
    """A block, statically condensed to the k unknowns of its elements at its contacts.

    Attributes
    ----------
    shapes : (3m, k) sparse, displacement of its m node pairs per unknown
    nodes : (k / d, d) m, coordinates of the nodes of those unknowns
    stiffness : (k, k) kN/m, the Schur complement of K once all other unknowns are eliminated
    load : (k, u), condensed forces of a unit load on the block
    rigid : (k, u), displacements of a unit rigid motion
    mean_displacement, mean_by_load : (3, k), (3, u) mean displacement of the block per unknown and per unit load
    degrees : number of unknowns of the finite elements
    cells : number of finite elements
    """

    shapes: Any
    nodes: Floats
    stiffness: Floats
    load: Floats
    rigid: Floats
    mean_displacement: Floats
    mean_by_load: Floats
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
        self,
        mesh: Any,
        modulus_kpa: float,
        poisson: float,
        thickness: float = 1.0,
        order: int = ORDER,
    ) -> None:
        import skfem

        self.mesh, self.thickness = mesh, thickness
        self.space = [0, 2] if len(mesh.p) == 2 else [0, 1, 2]
        kinds = {(2, 1): "TriP1", (2, 2): "TriP2", (3, 1): "TetP1", (3, 2): "TetP2"}
        self.basis = skfem.Basis(mesh, getattr(skfem, f"Element{kinds[len(mesh.p), order]}")())
        self.stiffness = self._stiffness(modulus_kpa, poisson) * thickness
        cells, corners = mesh.t.T, mesh.p.T[mesh.t.T]
        volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / (
            2.0 if len(mesh.p) == 2 else 6.0
        )
        self.volume = float(volumes.sum()) * thickness
        self.centroid = volumes @ corners.mean(axis=1) / volumes.sum()
        around = corners - self.centroid
        sums, k = around.sum(axis=1), cells.shape[1]
        self.second = (
            thickness
            / (k * (k + 1))
            * (
                np.einsum("c,cki,ckj->ij", volumes, around, around)
                + np.einsum("c,ci,cj->ij", volumes, sums, sums)
            )
        )

    @property
    def degrees(self) -> int:
        """Number of unknowns of the finite elements."""
        return int(self.stiffness.shape[0])

    def centroid_point(self) -> Floats:
        """Return the centroid (3,) m; that of a section has y = 0."""
        point = np.zeros(3)
        point[self.space] = self.centroid
        return point

    def _stiffness(self, modulus_kpa: float, poisson: float) -> Any:
        """Return K (degrees, degrees): ∫ λ div u div v + 2 μ ε(u) ε(v), in a section with plane strain.

        All pairs of shape functions are integrated at once: scikit-fem's assembly takes twenty times as long.
        """
        shear = modulus_kpa / (2.0 * (1.0 + poisson))
        bulk = modulus_kpa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        slopes = np.stack([np.asarray(shape[0].grad) for shape in self.basis.basis])  # (k, d, c, q)
        weighted = slopes * np.asarray(self.basis.dx)
        (k, dim, cells, _), identity = slopes.shape, np.eye(len(self.space))
        weighted_rows, gradient_rows = (
            gradients.reshape(k * dim, cells, -1) for gradients in (weighted, slopes)
        )
        products = np.matmul(
            weighted_rows.transpose(1, 0, 2), gradient_rows.transpose(1, 2, 0)
        ).reshape(cells, k, dim, k, dim)
        stiffness = bulk * products + shear * products.transpose(0, 1, 4, 3, 2)
        stiffness += shear * np.einsum("ciaja,bd->cibjd", products, identity)
        place = (dim * self.basis.element_dofs.T[:, :, None] + np.arange(dim)).reshape(cells, -1)
        rows, columns = np.broadcast_arrays(place[:, :, None], place[:, None])
        size = dim * self.basis.N
        return sparse.coo_matrix(
            (stiffness.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size)
        ).tocsc()

    def shapes(self, points: Floats) -> Any:
        """Return L (3q, degrees), sparse: the displacement (east, north, up) of points (q, 3) m per unknown.

        Rows out of the plane of a section are empty.
        """
        basis, dim = self.basis, len(self.space)
        cells, local = self._cells_of_points(points[:, self.space])
        local_points = local.T[:, :, None]
        rows, columns, values = [], [], []
        for k in range(basis.Nbfun):
            shape = np.asarray(basis.elem.gbasis(basis.mapping, local_points, k, tind=cells)[0])[
                :, 0
            ]
            for i in range(dim):
                rows.append(3 * np.arange(len(points)) + self.space[i])
                columns.append(dim * basis.element_dofs[k, cells] + i)
                values.append(shape)
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return sparse.coo_matrix(entries, shape=(3 * len(points), self.degrees)).tocsr()

    def _cells_of_points(self, points: Floats) -> tuple[Ints, Floats]:
        """Return the cell in which each point (q, d) lies deepest, and its coordinates in the reference cell."""
        mesh = self.mesh
        origin = mesh.p[:, mesh.t[0]].T
        sides = np.linalg.inv((mesh.p[:, mesh.t[1:]] - mesh.p[:, mesh.t[:1]]).transpose(2, 0, 1))
        cells, local = [], []
        for chunk in np.array_split(points, 1 + len(points) * len(origin) // _CHUNK):
            barycentric = np.einsum("cij,pcj->pci", sides, chunk[:, None, :] - origin[None])
            depth = np.minimum(barycentric.min(axis=2), 1.0 - barycentric.sum(axis=2))
            best = np.argmax(depth, axis=1)
            cells.append(best)
            local.append(barycentric[np.arange(len(chunk)), best])
        return np.concatenate(cells), np.concatenate(local)

    def mean(self) -> Any:
        """Return the mean displacement of the body per unknown, (3, degrees), sparse."""
        weights = np.zeros((3, self.degrees))
        weights[self.space] = (
            self._work_of_fields(np.eye(len(self.space))[:, :, None, None]).T
            * self.thickness
            / self.volume
        )
        return sparse.csr_matrix(weights)

    def spread(self, length: float) -> Floats:
        """Return G (degrees, u): nodal forces of unit loads (kN; moments over a `length`, m) spread over the body."""
        dim = len(self.space)
        quadrature_points = np.asarray(self.basis.global_coordinates())  # (d, c, q)
        r = quadrature_points - self.centroid[:, None, None]
        constant = np.broadcast_to(
            np.eye(dim)[:, :, None, None] / self.volume, (dim, dim, *r.shape[1:])
        )
        if dim == 2:  # about y, which turns z into x
            turning = np.stack([r[1], -r[0]])[None] / np.trace(self.second)
        else:
            inertia = np.trace(self.second) * np.eye(3) - self.second
            turning = np.stack(
                [
                    np.cross(acceleration, r, axisb=0, axisc=0)
                    for acceleration in np.linalg.inv(inertia)
                ]
            )
        return self._work_of_fields(np.concatenate([constant, turning * length])) * self.thickness

    def _work_of_fields(self, fields: Floats) -> Floats:
        """Return the virtual work (degrees, f) of f body force fields (f, d, c, q), at the quadrature points."""
        basis, dim = self.basis, len(self.space)
        values = (
            np.stack(
                [
                    np.broadcast_to(np.asarray(shape_function[0]), basis.dx.shape)
                    for shape_function in basis.basis
                ]
            )
            * basis.dx
        )
        nodal_work = np.zeros((basis.N, dim, len(fields)))
        for k, shape in enumerate(values):
            work = (fields * shape).sum(axis=3)  # (f, d, c)
            np.add.at(nodal_work, basis.element_dofs[k], work.transpose(2, 1, 0))
        return nodal_work.reshape(basis.N * dim, -1)

    def rigid(self, points: Floats, centre: Floats, length: float) -> Floats:
        """Return the displacements (3q, u) of points (q, 3) by unit rigid motions of a body about its centre (3,)."""
        r = (points - centre) / length
        q = len(points)
        turns = np.zeros((q, 3, 3))
        turns[:, 1, 0], turns[:, 2, 0] = -r[:, 2], r[:, 1]
        turns[:, 0, 1], turns[:, 2, 1] = r[:, 2], -r[:, 0]
        turns[:, 0, 2], turns[:, 1, 2] = -r[:, 1], r[:, 0]
        motions = np.concatenate([np.tile(np.eye(3), (q, 1, 1)), turns], axis=2)
        if len(self.space) == 2:
            motions = motions[:, :, [0, 2, 4]]
        return motions.reshape(3 * q, -1)

    def condensed(
        self, retained: Ints, loads: Floats, output_rows: Any
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Return the Schur complement of K at the unknowns retained (k,), with the loads and output rows condensed.

        Parameters
        ----------
        loads : (degrees, u) nodal forces
        output_rows : (q, degrees) sparse, linear functions of the displacements to evaluate

        Returns
        -------
        K (k, k), symmetric; loads (k, u); outputs per displacement retained (q, k) and per load (q, u)
        """
        eliminated = np.setdiff1d(np.arange(self.degrees), retained)
        retained_stiffness, coupling = (
            self.stiffness[retained][:, retained].toarray(),
            self.stiffness[eliminated][:, retained].toarray(),
        )
        load, outputs, outputs_by_load = (
            loads[retained],
            output_rows[:, retained].toarray(),
            np.zeros((output_rows.shape[0], loads.shape[1])),
        )
        if len(eliminated):
            inner = self.stiffness[eliminated][:, eliminated].tocsc()
            factor = splu(
                inner,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
            by_retained, by_loads = (
                factor.solve(coupling),
                factor.solve(np.ascontiguousarray(loads[eliminated])),
            )
            retained_stiffness, load = (
                retained_stiffness - coupling.T @ by_retained,
                load - by_retained.T @ loads[eliminated],
            )
            outputs, outputs_by_load = (
                outputs - output_rows[:, eliminated] @ by_retained,
                output_rows[:, eliminated] @ by_loads,
            )
        stiffness: Floats = 0.5 * (retained_stiffness + retained_stiffness.T)
        return stiffness, load, outputs, outputs_by_load


def _contact_shapes(shapes: Any) -> Any:
    """Return shape functions (3q, degrees) with entries of nodes off the contact removed and row sums unchanged."""
    cleaned = shapes.copy()
    cleaned.data[np.abs(cleaned.data) < _NO_SHAPE] = 0.0
    cleaned.eliminate_zeros()
    sums, cleaned_sums = (np.asarray(matrix.sum(axis=1)).ravel() for matrix in (shapes, cleaned))
    return (
        sparse.diags(
            np.divide(sums, cleaned_sums, out=np.ones_like(sums), where=cleaned_sums != 0.0)
        )
        @ cleaned
    )


def body(elements: Elements, points: Floats, axes: Floats, length: float) -> CondensedBlock:
    """Return a block condensed to the unknowns at its node pairs.

    Parameters
    ----------
    points : (m, 3) m, its node pairs
    axes : (m, 3, 3) their local axes, one a row, reversed where the block is on the minus side
    length : m, unit of a rotation's displacement
    """
    dim, centre = len(elements.space), elements.centroid_point()
    shapes = (
        sparse.block_diag(list(axes), format="csr") @ _contact_shapes(elements.shapes(points))
    ).tocsr()
    nodes = np.unique(shapes.tocoo().col // dim)
    unknowns = (dim * nodes[:, None] + np.arange(dim)).ravel()
    node_points = np.asarray(elements.basis.doflocs)[:, nodes].T
    node_points_in_space = np.zeros((len(nodes), 3))
    node_points_in_space[:, elements.space] = node_points
    rigid = (
        elements.rigid(node_points_in_space, centre, length)
        .reshape(len(nodes), 3, -1)[:, elements.space]
        .reshape(len(unknowns), -1)
    )
    stiffness, load, mean_displacement, mean_by_load = elements.condensed(
        unknowns, elements.spread(length), elements.mean()
    )
    return CondensedBlock(
        shapes[:, unknowns],
        frozen(node_points),
        frozen(stiffness),
        frozen(load),
        frozen(rigid),
        frozen(mean_displacement),
        frozen(mean_by_load),
        elements.degrees,
        int(elements.mesh.t.shape[1]),
    )


def rigid_body(rows: Any, node: Floats) -> CondensedBlock:
    """Return a rigid block as a condensed one: a single node (d,), whose unknowns are the motion of the block.

    Parameters
    ----------
    rows : (3m, u) sparse, relative displacement of its pairs per unknown
    """
    motion = np.eye(rows.shape[1])
    none = np.zeros((3, len(motion)))
    return CondensedBlock(rows, node[None], 0.0 * motion, motion, motion, none, none, 0, 0)
