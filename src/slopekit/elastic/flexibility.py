"""How an elastic block gives at the node pairs of its contacts: small strains, P1 or P2 elements (scikit-fem).

    K u = Lᵀ f + G q,   d = L u

f are the forces at the pairs, q the load of the block: six numbers (three in a section), spread over its volume as the
field a + ω x r that has this force and moment, which for a weight is the unit weight itself. L are the shape functions
at the pairs: the mesh of the block need not match them. K is inverted on supports that hold the block and nothing
more. The rigid motion that fits best at the pairs is taken out of d and given to the block's own unknowns:

    d = Π D Π f + Π (D F + L K⁺ G) q,   Π = I - B (BᵀB)⁻¹ Bᵀ,   F = -B (BᵀB)⁻¹
"""

from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import qr
from scipy.sparse.linalg import splu

from slopekit.core.arrays import Floats, Ints, frozen
from slopekit.core.records import dataclass

_CHUNK = 2_000_000  # barycentric coordinates at a time
_NO_SHAPE = 1e-7  # a shape function that is none: what coordinates of nine digits leave of nodes off a contact
_COLUMNS = 64  # right sides at a time: they stay in the cache, all at once take twice as long


@dataclass(frozen=True, slots=True)
class Rock:
    """The rock of a block: Young's modulus (kPa), Poisson's ratio; order of its elements."""

    modulus_kpa: float
    poisson: float
    order: int = 2


@dataclass(frozen=True, slots=True)
class Flexibility:
    """What a block does elastically.

    Attributes
    ----------
    by_force : (3m, 3m) relative displacement of its m pairs per force there, m/kN; by_load : (3m, u) per load
    seen_by_force : (3q, 3m), seen_by_load : (3q, u) displacement east, north, up: the block's mean, then of points
    degrees : unknowns of the finite elements; cells : their number
    """

    by_force: Floats
    by_load: Floats
    seen_by_force: Floats
    seen_by_load: Floats
    degrees: int
    cells: int


@dataclass(frozen=True, slots=True)
class CondensedBlock:
    """A block of many, condensed to the k unknowns of its elements at its contacts.

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
    """

    def __init__(self, mesh: Any, rock: Rock, thickness: float = 1.0) -> None:
        import skfem

        self.mesh, self.thickness = mesh, thickness
        self.space = [0, 2] if len(mesh.p) == 2 else [0, 1, 2]
        kinds = {(2, 1): "TriP1", (2, 2): "TriP2", (3, 1): "TetP1", (3, 2): "TetP2"}
        self.basis = skfem.Basis(mesh, getattr(skfem, f"Element{kinds[len(mesh.p), rock.order]}")())
        self.stiffness = self._stiffness(rock) * thickness
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

    def _stiffness(self, rock: Rock) -> Any:
        """K (degrees, degrees): ∫ λ div u div v + 2 μ ε(u) ε(v), in a section with plane strain.

        All pairs of shape functions at once: scikit-fem's own assembly of vectors takes twenty times as long.
        """
        shear = rock.modulus_kpa / (2.0 * (1.0 + rock.poisson))
        bulk = rock.modulus_kpa * rock.poisson / ((1.0 + rock.poisson) * (1.0 - 2.0 * rock.poisson))
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
        nodal_work: Floats = out.reshape(basis.N * dim, -1)
        return nodal_work

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
        out: Floats = whole.reshape(3 * q, -1)
        return out

    def supports(self) -> Ints:
        """Degrees of freedom of corners that hold the body and do no more: the six (three) most independent."""
        dim, p = len(self.space), self.mesh.p
        at = np.zeros((p.shape[1], 3))
        at[:, self.space] = p.T
        motions = self.rigid(at, at.mean(axis=0), float(np.ptp(p))).reshape(len(at), 3, -1)[:, self.space]
        flat = motions.reshape(-1, motions.shape[2])
        _, pivots = qr(flat.T, mode="r", pivoting=True)
        chosen = pivots[: flat.shape[1]]
        held: Ints = dim * np.asarray(self.basis.nodal_dofs)[0, chosen // dim] + chosen % dim
        return held

    def held(self, fixed: Ints) -> Any:
        """A solver of K u = right (degrees, r) with some degrees of freedom held."""
        free = np.setdiff1d(np.arange(self.degrees), fixed)
        inner = self.stiffness[free][:, free].tocsc()
        factor = splu(inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

        def solve(right: Floats) -> Floats:
            out = np.zeros(right.shape)
            for first in range(0, right.shape[1], _COLUMNS):
                own = slice(first, first + _COLUMNS)
                out[free, own] = factor.solve(np.asfortranarray(right[free, own]))
            return out

        return solve

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


def flexibility(
    elements: Elements, points: Floats, axes: Floats, rows: Floats, length: float, also: Floats | None = None
) -> Flexibility:
    """How a free block gives at its node pairs.

    Parameters
    ----------
    points : (m, 3); axes : (m, 3, 3) local axes, one a row, turned round where the block is on the minus side
    rows : (3m, u) relative displacement of the pairs per unknown of the block, turns in parts of `length`
    also : (q, 3) points whose displacement is wanted too
    """
    local = sparse.block_diag(list(axes), format="csr")
    at_pairs = local @ elements.shapes(points)
    wanted = elements.centroid_point()[None] if also is None else np.vstack([elements.centroid_point(), also])
    seen = elements.mean() if also is None else sparse.vstack([elements.mean(), elements.shapes(also)]).tocsr()
    solve = elements.held(elements.supports())
    by_force, by_load = solve(at_pairs.T.toarray()), solve(elements.spread(length))
    normal = np.linalg.pinv(rows)  # (BᵀB)⁻¹ Bᵀ
    there = elements.rigid(wanted, elements.centroid_point(), length)

    def without_rigid(field: Floats) -> tuple[Floats, Floats]:
        at, out = at_pairs @ field, seen @ field
        motion = normal @ at
        return at - rows @ motion, out - there @ motion

    give, seen_give = without_rigid(by_force)
    give_load, seen_load = without_rigid(by_load)
    balancing = -normal.T
    projected = give - (give @ rows) @ normal
    return Flexibility(
        frozen(0.5 * (projected + projected.T)), frozen(give_load + give @ balancing),
        frozen(seen_give - (seen_give @ rows) @ normal), frozen(seen_load + seen_give @ balancing),
        elements.degrees, int(elements.mesh.t.shape[1]),
    )  # fmt: skip


def body(elements: Elements, points: Floats, axes: Floats, length: float) -> CondensedBlock:
    """A block of many, by its node pairs: points (m, 3), axes (m, 3, 3) and length as `flexibility` has them."""
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
