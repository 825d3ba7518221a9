"""Each way to solve with the stiffness of an assembly against SciPy's sparse LU of Σ Jᵀ S J, contact by contact.

With NumPy alone, and with the compiled kernels.
"""

import gc
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.sparse.linalg import spsolve

from slopekit.core.errors import SolverError
from slopekit.preie.solvers import fronts, stiffness
from slopekit.preie.solvers.fronts import Fronts
from slopekit.preie.solvers.stiffness import Band, Dense, SparseStiffness
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.block_scenes import Scene, bench, boxes_in_space, columns, stack, wall

BENCH = (("45/170", 6.0), ("80/350", 7.0), ("85/80", 7.0))
SCENES = {
    "wall": lambda: wall(7, 9),
    "columns": lambda: columns(),
    "boxes": lambda: boxes_in_space((5, 4, 4), (2.0, 3.0, 1.0), 25.0, 0.3),
    "bench": lambda: bench(BENCH, scatter=3.0),
    "single block": lambda: stack(1),
}
WAYS = (Dense, Band, Fronts)


@cache
def model_of(name: str, untouched: bool = False) -> AssemblyModel:
    """A model, one of whose blocks perhaps touches nothing."""
    scene: Scene = SCENES[name]()
    return (scene.with_untouched_block() if untouched else scene).model(30.0, 1.0)


def assembled(model: AssemblyModel, stiffness: np.ndarray) -> sparse.csc_matrix:
    """Σ Jᵀ S J."""
    n, u = model.load.shape
    blocks, rows, columns = [], [], []
    for k, local in enumerate(stiffness):
        sides = [(model.plus[k], model.plus_motion[k]), (model.minus[k], model.minus_motion[k])]
        for row, left in sides:
            for column, right in sides:
                if row >= 0 and column >= 0:
                    blocks.append(left.T @ local @ right)
                    rows.append(np.repeat(row * u + np.arange(u), u))
                    columns.append(np.tile(column * u + np.arange(u), u))
    at = np.concatenate(rows), np.concatenate(columns)
    return sparse.coo_matrix((np.concatenate(blocks, axis=None), at), (n * u, n * u)).tocsc()


def stiffness_of(model: AssemblyModel, symmetric: bool, seed: int) -> np.ndarray:
    """Random contact stiffnesses, (k, u, u), with a positive definite symmetric part."""
    half = np.random.default_rng(seed).normal(
        size=(len(model.plus), model.unknowns, model.unknowns)
    )
    found = np.matmul(half, half.transpose(0, 2, 1)) + 0.1 * np.eye(model.unknowns)
    return found if symmetric else found + 0.5 * (half - half.transpose(0, 2, 1))


@pytest.fixture(autouse=True)
def small_pieces(monkeypatch, kernels, request) -> None:
    """Pieces of two blocks in space, four in a section, so that small models make trees of many fronts.

    Fronts are compiled ones: without kernels the band is what there is.
    """
    if kernels == "numpy" and any(
        word in request.node.name for word in ("Fronts", "pivots", "factors_go")
    ):
        pytest.skip("fronts are compiled")
    monkeypatch.setattr(fronts, "_LEAF_UNKNOWNS", 12)


@pytest.mark.parametrize("way", [*WAYS, None])
@given(
    st.sampled_from(list(SCENES)),
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.integers(0, 10**6),
)
@settings(max_examples=5, deadline=None)
def test_each_way_against_a_sparse_solve(way, name, untouched, symmetric, heavy, seed) -> None:
    """Same matrix, same shift; both solutions may be off by their rounding, 1e-16 times the condition, below 1e6."""
    model = model_of(name, untouched)
    rng, shift, size = np.random.default_rng(seed), 1e-3, model.load.size
    stiffness = stiffness_of(model, symmetric, seed)
    inertia = rng.uniform(0.5, 2.0, size) if heavy else None
    full = assembled(model, stiffness) + sparse.diags(
        np.zeros(size) if inertia is None else inertia
    )
    diagonal = full.diagonal()
    full = (full + sparse.diags(shift * (diagonal + diagonal.mean()))).tocsc()
    solve = SparseStiffness(model, way).factored(stiffness, shift, symmetric, inertia)
    for right in (rng.normal(size=size), rng.normal(size=(size, 2)), rng.normal(size=(size, 1))):
        exact, kept = spsolve(full, right).reshape(right.shape), right.copy()
        found = solve(right)
        assert found.shape == right.shape
        assert np.array_equal(right, kept)
        assert np.abs(found - exact).max() < 1e-9 * np.abs(exact).max()


@pytest.mark.parametrize("way", WAYS)
def test_solvers_of_one_model_do_not_share_their_numbers(way) -> None:
    """A second factorisation leaves the first solver as it was."""
    solver, size = SparseStiffness(model_of("wall"), way), model_of("wall").load.size
    right = np.random.default_rng(3).normal(size=size)
    for symmetric in (True, False):
        first = solver.factored(stiffness_of(solver.model, symmetric, 1), 1e-6, symmetric)
        before = first(right)
        solver.factored(stiffness_of(solver.model, symmetric, 2), 1e-6, symmetric)(right)
        assert np.array_equal(first(right), before)


@pytest.mark.parametrize("way", WAYS)
def test_a_symmetric_stiffness_may_go_the_general_way(way) -> None:
    solver = SparseStiffness(model_of("wall"), way)
    stiffness, right = (
        stiffness_of(solver.model, True, 7),
        np.random.default_rng(8).normal(size=solver.model.load.size),
    )
    one, other = (solver.factored(stiffness, 1e-6, symmetric)(right) for symmetric in (True, False))
    assert one == pytest.approx(other, rel=1e-7, abs=1e-7 * np.abs(one).max())


@pytest.mark.parametrize("way", WAYS)
def test_ill_conditioned_as_near_the_end_of_an_interior_point_method(way) -> None:
    """Contacts 1e-6 to 1e6 stiff, shift 1e-13: what is left of b is rounding of K x."""
    model = model_of("bench")
    rng = np.random.default_rng(5)
    for symmetric in (True, False):
        spread = 10.0 ** rng.uniform(-6, 6, len(model.plus))
        stiffness = stiffness_of(model, symmetric, 5) * spread[:, None, None]
        full, right = assembled(model, stiffness), rng.normal(size=model.load.size)
        found = SparseStiffness(model, way).factored(stiffness, 1e-13, symmetric)(right)
        rounding = np.abs(full) @ np.abs(found) + np.abs(right)
        shifted = 1e-13 * float(full.diagonal().mean()) * np.abs(found)
        assert (np.abs(full @ found - right) <= 1e-9 * rounding.max() + 2.0 * shifted).all()


@pytest.mark.parametrize("way", WAYS)
def test_what_cannot_be_solved(way) -> None:
    solver = SparseStiffness(model_of("boxes"), way)
    nothing = np.zeros((len(solver.model.plus), 6, 6))
    for symmetric in (True, False):
        with pytest.raises(SolverError, match="E599"):
            solver.factored(nothing, 0.0, symmetric)
    with pytest.raises(SolverError, match="E599"):
        solver.factored(nothing - np.eye(6), 1e-13)


@pytest.mark.parametrize("way", WAYS)
def test_too_large_for_memory(way, monkeypatch) -> None:
    monkeypatch.setattr(stiffness, "_MAX_BYTES", 1000)
    with pytest.raises(SolverError, match="E504"):
        SparseStiffness(model_of("wall"), way)
    with pytest.raises(SolverError, match="E504"):
        SparseStiffness(model_of("wall"))


def test_pivots_that_a_front_does_not_have_are_found_in_the_band(monkeypatch) -> None:
    """No growth allowed, as if rows of a front had next to nothing among its own unknowns."""
    monkeypatch.setattr(
        SparseStiffness, "_fastest_storage", lambda self, symmetric: Fronts(self.model, symmetric)
    )
    monkeypatch.setattr(fronts, "PIVOT_GROWTH", 0.0)
    model = model_of("wall")
    stiffness, right = (
        stiffness_of(model, False, 4),
        np.random.default_rng(4).normal(size=model.load.size),
    )
    found = SparseStiffness(model).factored(stiffness, 0.0, False)(right)
    assert found == pytest.approx(spsolve(assembled(model, stiffness), right), rel=1e-8)
    with pytest.raises(SolverError, match="E599"):
        SparseStiffness(model, Fronts).factored(stiffness, 0.0, False)


def test_long_models_take_the_band_small_ones_are_dense_and_broad_ones_are_dissected(
    kernels,
) -> None:
    def chosen(scene: Scene) -> type:
        return type(SparseStiffness(scene.model(30.0)).plans[True].storage)

    assert chosen(columns()) is Dense
    assert chosen(stack(200)) is Band
    broad = chosen(boxes_in_space((9, 9, 9), (1.0, 1.0, 1.0), 10.0, 0.1))
    assert broad is (Band if kernels == "numpy" else Fronts)


def test_a_band_does_not_grow_with_the_length_of_a_wall() -> None:
    """10 courses need a band of some courses, however long the wall is and however its blocks are numbered."""
    reach = [Band(wall(10, long).model(30.0), True).half_bandwidth for long in (10, 40)]
    assert max(reach) < 3 * 2 * 11


def test_what_separates_a_cube_is_a_plane() -> None:
    """Of 9 x 9 x 9 boxes a plane of 81 separates the halves; fronts take less than half of the band's work."""
    model = boxes_in_space((9, 9, 9), (1.0, 1.0, 1.0), 0.0, 0.1).model(30.0)
    fronts, band = Fronts(model, True), Band(model, True)
    assert fronts.own_sizes.max() <= 6 * 81
    assert fronts.flops < band.unknowns * band.half_bandwidth**2 / 2.0
    assert sorted(fronts.place) == list(range(len(model.load)))


def test_factors_go_with_their_solver() -> None:
    """No cycle keeps them until the collector comes: of large models they are hundreds of megabytes."""
    model = model_of("wall")
    gc.freeze()  # the collector need not go through all that is there already
    for way in WAYS:
        solve = SparseStiffness(model, way).factored(stiffness_of(model, True, 1), 1e-6)
        gc.collect()
        gc.disable()
        try:
            del solve
            assert gc.collect() == 0
        finally:
            gc.enable()
