"""The path of rounded joints in space: its linearised equations, its sharp states, and where it leads nowhere."""

from types import SimpleNamespace

import numpy as np
import pytest

import slopekit as sk
from benchmarks import populations
from slopekit.preie.elastic_path import traced as traced_room
from slopekit.preie.elastic_path.bed import Bed
from slopekit.preie.elastic_path.bed_states import Drive
from slopekit.preie.elastic_path.flow import stepped
from slopekit.preie.elastic_path.rounded import RoundedPath
from slopekit.preie.many_blocks import ravelling
from slopekit.preie.programs.bounds import static_bound
from slopekit.preie.system.assembly import AssemblyModel
from tests.preie.block_scenes import boxes_in_space


def bed_of(model: AssemblyModel) -> Bed:
    return Bed(model, Drive(model.load.ravel()))


def begun(counts):
    """The bed of boxes in space, and its rounded path from rest at twice the strength of the static bound."""
    model = boxes_in_space(counts, (2.0, 3.0, 1.0), 25.0, 0.3).model(35.0, 1.0)
    bed = bed_of(model)
    path = RoundedPath(bed, 1e-2)
    strength = 2.0 / static_bound(model).factor
    step = stepped(bed, bed.elastic_displacement, bed.elastic_displacement, strength, 0.0)
    assert path.begin(step.at, strength)
    return bed, path


def test_the_equations_are_solved_by_newtons_method() -> None:
    """What is off after a step in a small part of what Newton's equations say falls by that part: first order."""
    _, path = begun((2, 1, 2))
    work, product = path._work + 0.3, path._product(path._work, path._rounding)
    off, solve = path._linear(path._at, work, product)
    change = solve(off)
    for part in (1e-3, 1e-4):
        left, _ = path._linear(path._at.plus(change, part), work, product)
        for name in ("balance", "opening", "shear", "pressing", "sliding", "across", "work"):
            before, after = np.asarray(getattr(off, name)), np.asarray(getattr(left, name))
            slope = (after - before) / part
            scale = max(float(np.abs(before).max()), product)
            assert slope == pytest.approx(-before, abs=200.0 * part * scale), name


def test_sharpened_states_are_those_of_the_joints() -> None:
    """Newton's method on the joints of `elastic_path.bed` changes λ by no more than what the rounding has left."""
    bed, path = begun((2, 2, 2))
    assert path.onto(1e3, 400)
    sharp = path.sharpened(400)
    assert sharp is not None
    at = sharp.displacement
    exact = stepped(bed, at, at, sharp.reduction, 0.0, float(bed.working @ at))
    assert exact.settled
    assert exact.parameter == pytest.approx(sharp.reduction, rel=1e-7)


def test_a_motion_that_runs_far_below_the_last_rest_has_its_own_limit() -> None:
    """Bench 50: two blocks rest at 2.13, and run to a limit of 1.79, the only one that their motion can have.

    On finer node pairs only a rest is found, 18.6 % higher: it raises nothing, and is said.
    """
    found = sk.run(populations.bench(50))
    assert found.fos.limit == pytest.approx(1.7917646, rel=1e-6)
    assert "by 18.6 %" in {notice.code: notice.message for notice in found.warnings}["W312"]
    assert found.fos.lowest == pytest.approx(found.fos.limit, rel=1e-4)
    assert found.fos.highest == pytest.approx(found.fos.limit, rel=1e-4)


@pytest.mark.parametrize(
    ("size", "reached", "tried"), [(99, False, 2), (100, False, 2), (101, False, 1), (101, True, 2)]
)
def test_of_many_blocks_no_other_rounding_is_tried_where_the_least_gets_nowhere(
    size, reached, tried, monkeypatch
) -> None:
    begun = []

    class Curve:
        reduction = 1.0

        def __init__(self, bed, rounding):
            begun.append(rounding)

        def begin(self, at, parameter):
            return True

        def onto(self, mark, most):
            return reached

        def sharpened(self, most):
            return None

    monkeypatch.setattr(traced_room, "RoundedPath", Curve)
    assert traced_room.traced(SimpleNamespace(size=size), np.zeros(6), 1.0) is None
    assert len(begun) == tried


def test_a_path_that_is_thrown_far_off_is_none(monkeypatch) -> None:
    """Bench 619: Newton's method went to slips of 1e270, where strength does no work, and there divided by zero.

    That was on contacts split twice; splitting them once more says nothing of it.
    """
    monkeypatch.setattr(ravelling, "_MOST_SPLIT", 2)
    design = populations.bench(619, 40) | {"analysis": {"smallest_block": 0}}
    design["strength"]["joint"]["c"] = 0.0
    found = sk.run(design)
    assert "W317" in [notice.code for notice in found.warnings]
    assert 0.0 < found.fos.limit <= found.fos.static_bound
