"""The compiled kernels against NumPy, term by term and to the last factor, and how they are chosen.

Sums are taken in another order: terms agree to some hundred roundings of the largest, factors to 1e-9.
"""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks import populations
from slopekit.core.errors import SlopekitError
from slopekit.preie import kernels as module
from slopekit.preie.elastic_path.contact_model import ElasticContactModel
from slopekit.preie.elastic_path.contact_states import ContactState, Drive, PressedShare
from slopekit.preie.many_blocks.blocks import limit_of_blocks
from slopekit.preie.one_block.bed_path import BedPath
from slopekit.preie.one_block.polygon_bed import Beds, BedSprings, contact_rows
from slopekit.preie.programs.bound_of_many import bound_in_one_run
from slopekit.preie.programs.distance import bound_by_programs
from slopekit.preie.solvers.fronts import Fronts
from slopekit.preie.solvers.stiffness import Band, SparseStiffness
from slopekit.preie.system.patterns import ContactPattern, compiled_contacts
from slopekit.strength.barton_bandis import BartonBandis
from slopekit.strength.bilinear import Bilinear
from tests.preie.block_scenes import boxes_in_space, columns, random_bench, stack, wall
from tests.preie.path_oracle import model_of
from tests.preie.test_bound_of_many import MODELS, bolted
from tests.preie.test_cracked import dam, limit_on, unbalanced
from tests.preie.test_path import BEDS
from tests.preie.test_stiffness import stiffness_of

compiled_only = pytest.mark.skipif(module.chosen()[0] is None, reason=module.chosen()[1])
ROUNDING = 1e-13


def both_ways(make: Callable[[], Any]) -> list[Any]:
    """What `make` gives with NumPy and with the compiled kernels."""
    found = []
    for way in ("numpy", "compiled"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("SLOPEKIT_KERNELS", way)
            found.append(make())
    return found


def close(found: np.ndarray, exact: np.ndarray, rounding: float = ROUNDING) -> bool:
    found, exact = np.asarray(found, dtype=float), np.asarray(exact, dtype=float)
    return bool(np.abs(found - exact).max() <= rounding * max(float(np.abs(exact).max()), 1e-300))


def _arrays_of(record: ContactState | PressedShare) -> list[np.ndarray]:
    """Return all fields of forces, those of the pressed shares after them."""
    values = [getattr(record, field.name) for field in dataclasses.fields(record)]
    plain = [
        np.asarray(value)
        for value in values
        if value is not None and not isinstance(value, PressedShare)
    ]
    return plain + [
        array for value in values if isinstance(value, PressedShare) for array in _arrays_of(value)
    ]


@compiled_only
@pytest.mark.parametrize("name", BEDS)
@given(st.integers(0, 10**6), st.booleans(), st.booleans())
@settings(max_examples=15, deadline=None)
def test_the_law_and_its_tangent(name, seed, turning, flows) -> None:
    """Forces, modes, pressed shares, stiffness of the contacts and viscous forces at a random displacement."""
    model, rng = BEDS[name](0.0), np.random.default_rng(seed)
    plain, bed = both_ways(lambda: ElasticContactModel(model, Drive(model.load.ravel())))
    assert plain._kernels is None
    assert bed._kernels is not None
    at = (
        plain.elastic_displacement
        + rng.uniform(0.0, 3.0)
        * rng.normal(size=bed.size)
        * np.abs(plain.elastic_displacement).mean()
    )
    there, exact = (each.forces(at, 0.6) for each in (bed, plain))
    assert there.same_modes(exact)
    for one, other in zip(_arrays_of(there), _arrays_of(exact), strict=True):
        assert np.shape(one) == np.shape(other)
        assert close(one, other)
    viscosity = 0.3 if flows else 0.0
    one, other = (each.tangent(exact, 0.6, viscosity, turning) for each in (bed, plain))
    assert close(one, other)
    assert close(bed.viscous(at), plain.viscous(at))
    modes = plain.with_slip_directions(
        exact, at
    )  # along given modes all is linear, and NumPy's in both
    assert close(
        bed.forces(at, 0.6, modes=modes).unbalanced, plain.forces(at, 0.6, modes=modes).unbalanced
    )


@compiled_only
@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize(
    "make", [lambda: random_bench(3)[0], lambda: wall(12, 12), lambda: columns()]
)
def test_factors_and_the_stiffness_of_contacts(make, symmetric) -> None:
    """One matrix, in compiled fronts and in a band: solutions differ by rounding, 1e-16 times a condition below 1e6."""
    model = make().model(30.0, 1.0)
    stiffness, rng = stiffness_of(model, symmetric, 2), np.random.default_rng(2)
    right = rng.normal(size=(model.load.size, 2))

    def solve(way: type) -> np.ndarray:
        return SparseStiffness(model, way).factored(stiffness, 1e-6, symmetric)(right)

    exact, found = both_ways(lambda: solve(Band))[0], solve(Fronts)
    assert close(found, exact, 1e-9)
    springs, t = rng.uniform(0.0, 1.0, len(model.control_area)), model.slip_rows.shape[1]
    tangent = rng.normal(size=(len(model.group_first), t, t))
    tangent = tangent + tangent.transpose(0, 2, 1)
    exact, found = both_ways(lambda: ContactPattern(model).stiffness(springs, tangent))
    assert close(found, exact)


def cut_square(cohesion: float = 0.4) -> Beds:
    """A block on a square and on a triangle upright beside it, in space: each its own strength."""
    square = np.array([[-0.9, -0.8, -0.5], [-0.9, 0.7, -0.5], [0.8, 0.9, -0.5], [0.7, -0.9, -0.5]])
    triangle = np.array([[-0.9, -0.8, -0.5], [-0.9, 0.2, 0.7], [-0.9, 0.7, -0.5]])
    axes = np.array([np.eye(3)[[2, 0, 1]], np.eye(3)[[0, 1, 2]]])
    corner = np.array([0, 4, 7])
    middle, rows, plane = contact_rows(
        np.concatenate([square, triangle]), corner, axes, np.arange(6)
    )
    return Beds(
        contact=np.array([0, 2]),
        corner=corner,
        axes=axes,
        middle=middle,
        rows=rows,
        plane=plane,
        line=np.array([[0.3, cohesion, 0.6], [0.4, 0.2, 0.3]]),
        load=np.array([[-0.3, 0.2, -0.9, 0.05, 0.2, 0.1]]),
        bolt_rows=np.array([[[0.1, 0.2, 0.4, 0.0, -0.3, 0.1]]]),
        bolt_capacity=np.array([[0.2]]),
        length=np.ones(1),
    )


def springs_on(bed: Beds, split: int) -> BedSprings:
    """The springs of a bed, with the kernels that the environment chooses now."""
    springs = BedSprings(bed, split)
    assert springs.kernels is None or springs.polygons is not None
    return springs


def curved_square() -> Beds:
    """The same with a curved law on the square, and on the triangle one with a kink."""
    laws = (BartonBandis(8.0, 60000.0, 30.0), Bilinear(25.0, 15.0, 80.0))
    return dataclasses.replace(cut_square(), laws=laws, stress_scale=np.full(2, 120.0))


CRACKED = {
    "in space": cut_square,
    "curved": curved_square,
    "without cohesion": lambda: cut_square(0.0),
    "section": lambda: dam(2.0, 150.0, 40.0, 1500.0, True, 17.0),
    "dam": lambda: dam(2.0, 150.0, 40.0, 1500.0, False),
}


@compiled_only
@pytest.mark.parametrize("name", CRACKED)
def test_the_forces_of_a_cracked_base(name) -> None:
    """And their slopes, with contacts that are whole, cut and open, where blocks rest, run and stick."""
    bed, rng, cuts = CRACKED[name](), np.random.default_rng(5), set()
    for split in (0, 2):
        plain, found = both_ways(lambda split=split: springs_on(bed, split))
        assert plain.kernels is None
        assert found.kernels is not None
        bonded = plain.beds.bonded[0]
        for running, sticks in ((False, False), (True, False), (False, True)):
            for number in range(40):
                size = np.abs(bonded).mean() * rng.uniform(0.0, 5.0)
                opening, slip = bonded + size * rng.normal(size=(2, len(bonded)))
                slip *= number > 3  # nothing has slipped yet
                reduction = rng.uniform(0.1, 2.0)
                gaps = bed.motions(opening[None])[:, 0]
                cuts.update(
                    int((part < 0.0).sum()) - len(part) for part in np.split(gaps, bed.corner[1:-1])
                )
                exact, one = (
                    unbalanced(each, opening, slip, reduction, running, sticks)
                    for each in (plain, found)
                )
                for field in dataclasses.fields(exact):
                    slope, by_steps = getattr(one, field.name), getattr(exact, field.name)
                    # slopes that are none have the rounding of terms of some one
                    assert (
                        close(slope, by_steps, 1e-12) or np.abs(slope - by_steps).max() < 1e-14
                    ), field.name
    assert {0, -1, -2} <= cuts


@compiled_only
def test_limits_of_cracked_bases_are_the_same() -> None:
    """To 1e-9, by paths that end alike."""
    for bed in (
        dam(2.0, 150.0, 40.0, 1500.0, True, 17.0),
        dam(3.0, 150.0, 40.0, 1500.0, False),
        cut_square(),
        curved_square(),
    ):
        plain, found = both_ways(lambda bed=bed: limit_on(bed, 1.0, (2,)))
        assert np.isfinite(plain.factor).all()
        assert found.factor == pytest.approx(plain.factor, rel=1e-9)
        assert found.status == plain.status


@compiled_only
def test_a_law_that_fails_raises_its_error_and_may_be_asked_again() -> None:
    class Broken(BartonBandis):
        is_broken = True

        def resistance(self, normal: np.ndarray) -> np.ndarray:
            if self.is_broken:
                raise ArithmeticError("no strength")
            return super().resistance(normal)

    law = Broken(8.0, 60000.0, 30.0)
    springs = springs_on(
        dataclasses.replace(cut_square(), laws=(law, None), stress_scale=np.full(2, 120.0)), 1
    )
    at = springs.beds.bonded[0], springs.beds.bonded[0], 0.5
    with pytest.raises(ArithmeticError, match="no strength"):
        unbalanced(springs, *at)
    with pytest.raises(ArithmeticError, match="no strength"):
        BedPath(springs).rests(np.zeros(1, dtype=np.int64), springs.beds.bonded, np.ones(1))
    Broken.is_broken = False
    assert np.isfinite(unbalanced(springs, *at).force).all()


LIMITS = {
    "stack": lambda: stack(5, width=8.0).model(35.0),
    "columns": lambda: columns().model(38.15),
    "boxes": lambda: boxes_in_space((2, 2, 2), (2.0, 3.0, 1.0), 25.0, 0.3).model(30.0, 1.0),
    "bolted": lambda: BEDS["bolted section"](0.0),
    "dilating": lambda: BEDS["section"](8.0),
    **{f"section {k}": lambda k=k: model_of(populations.section(k)) for k in (0, 4, 7, 13)},
}


@compiled_only
@pytest.mark.parametrize("name", LIMITS)
def test_factors_of_safety_are_the_same(name) -> None:
    model = LIMITS[name]()
    plain, found = both_ways(lambda: limit_of_blocks(model))
    assert plain.factor is not None
    assert found.factor == pytest.approx(plain.factor, rel=1e-9)
    assert found.static_bound == pytest.approx(plain.static_bound, rel=1e-9)
    assert (found.outcome, found.basis) == (plain.outcome, plain.basis)


@compiled_only
def test_arrays_of_another_size_are_refused() -> None:
    """Before anything is read or written outside of them."""
    model = wall(3, 3).model(30.0)
    kernels, contacts = module.compiled(), compiled_contacts(model)
    pairs, groups, k = len(model.control_area), len(model.group_first), len(model.plus)
    springs, tangent, out = np.ones(pairs), np.ones((groups, 1, 1)), np.zeros((k, 3, 3))
    kernels.stiffness(contacts, springs, tangent, out)
    for wrong in (
        (springs[:-1], tangent, out),
        (springs, tangent[1:], out),
        (springs, tangent, out[1:]),
    ):
        with pytest.raises(ValueError, match="bytes where"):
            kernels.stiffness(contacts, *wrong)
    with pytest.raises(ValueError, match="bytes where"):
        kernels.stiffness(contacts, springs.astype(np.float32), tangent, out)
    with pytest.raises((ValueError, BufferError)):
        kernels.stiffness(contacts, np.ones(2 * pairs)[::2], tangent, out)
    out.setflags(write=False)
    with pytest.raises((ValueError, BufferError)):
        kernels.stiffness(contacts, springs, tangent, out)
    with pytest.raises(ValueError, match="PyCapsule"):
        kernels.stiffness(
            SparseStiffness(model).plans[True]._plan, springs, tangent, np.zeros((k, 3, 3))
        )
    springs_of_bed, six, block = (
        BedSprings(cut_square(), 1),
        np.zeros((6, 6)),
        np.zeros(1, dtype=np.int64),
    )
    for count, slopes, blocks, match in (
        (5, six, block, "bytes where"),
        (6, six[:5], block, "bytes where"),
        (6, six, block + 1, "no such block"),
    ):
        with pytest.raises(ValueError, match=match):
            kernels.pressed(
                springs_of_bed.polygons,
                blocks,
                np.zeros(6),
                np.zeros(count),
                np.ones(1),
                False,
                False,
                np.zeros(6),
                six,
                slopes,
                np.zeros(6),
            )


# -- the choice -------------------------------------------------------------------------------------------------------


def test_numpy_when_it_is_asked_for(monkeypatch) -> None:
    monkeypatch.setenv("SLOPEKIT_KERNELS", "numpy")
    assert module.compiled() is None
    model = stack(2).model(30.0)
    assert ElasticContactModel(model, Drive(model.load.ravel()))._kernels is None
    assert SparseStiffness(model).contacts is None


def test_kernels_that_are_asked_for_and_missing_are_an_error(monkeypatch) -> None:
    monkeypatch.setattr(module, "_bound_to_lapack", lambda: (None, "they were not compiled"))
    monkeypatch.delenv("SLOPEKIT_KERNELS", raising=False)
    assert module.compiled() is None
    monkeypatch.setenv("SLOPEKIT_KERNELS", "compiled")
    with pytest.raises(SlopekitError, match=r"E506 .* not compiled"):
        module.compiled()


def test_another_word_is_an_error(monkeypatch) -> None:
    monkeypatch.setenv("SLOPEKIT_KERNELS", "fast")
    with pytest.raises(SlopekitError, match=r"E506 .* numpy or compiled"):
        module.compiled()


@compiled_only
def test_kernels_of_another_source_are_not_used(monkeypatch) -> None:
    """As in an editable install whose source has changed since; the BLAS is asked for no more then."""
    found, _ = module.chosen()
    monkeypatch.setattr(found, "SOURCE", found.SOURCE + 1)
    kernels, missing = module._imported.__wrapped__()
    assert kernels is None
    assert "another" in missing
    monkeypatch.setattr(module, "_imported", module._imported.__wrapped__)
    assert module._bound_to_lapack.__wrapped__() == (None, missing)


@compiled_only
@pytest.mark.parametrize(
    "make",
    [MODELS["bench with cohesion"], MODELS["slivers"], bolted],
    ids=["bench", "slivers", "bolts"],
)
def test_the_static_bound_by_kernels(make) -> None:
    """One run, which there is none of without kernels, and programs at one λ each, to 4e-6."""
    model = make()
    without, found = both_ways(lambda: bound_in_one_run(model))
    assert without is None
    assert found.factor == pytest.approx(bound_by_programs(model).factor, rel=4e-6)


@compiled_only
def test_steps_in_a_section_are_not_those_of_the_kernels() -> None:
    """There node pairs share their friction."""
    model, kernels = stack(3).model(30.0), module.compiled()
    with pytest.raises(ValueError, match="not blocks in space"):
        kernels.cone_springs(compiled_contacts(model), *[np.zeros(1)] * 11)
