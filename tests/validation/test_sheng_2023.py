"""Sheng, Li, Liu & Qi (2023), Appl. Sci. 13, 7301, §4.1: the symmetric wedge, Tables 4 to 6."""

import pytest

import slopekit as sk


@pytest.fixture(scope="module")
def all_pairs() -> "sk.wedge":
    return sk.wedge(dips=("45/115", "45/245"), criterion="all-pairs")


def test_the_example_alone() -> None:
    """METHOD.md §6: closed form 1.5574 at g = 9.81 and 1.5578 at 9.8; static bound 1.5868."""
    result = sk.wedge(dips=("45/115", "45/245"))
    assert round(result.fos.limit, 4) == 1.5574
    assert round(result.fos.closed_form, 4) == 1.5574
    assert round(result.fos.static_bound, 4) == 1.5868
    assert result.difference <= 1e-6
    assert result.design.reading.defaults == ("face", "upper", "height", "c", "phi", "density")
    assert round(sk.wedge(dips=("45/115", "45/245"), gravity=9.8).fos.limit, 4) == 1.5578


def test_all_pairs_failed_is_the_papers_1_554(all_pairs) -> None:
    """Table 6 prints 1.554, three decimals, with Clough-Duncan shear stiffness and k_zz = 1e7 kN/m³."""
    assert all_pairs.fos.all_pairs_failed == pytest.approx(1.554, abs=5e-4)
    low, high = all_pairs.all_pairs.bracket
    assert low < high <= low * (1.0 + 1e-5)


def test_pairs_fail_before_the_wedge_moves(all_pairs) -> None:
    assert all_pairs.fos.all_pairs_failed < all_pairs.fos.limit
    assert not all_pairs.all_pairs.lost_equilibrium
    counts = [count for _, count in sorted(all_pairs.all_pairs.history)]
    assert counts == sorted(counts)
    assert counts[0] == 0
    assert counts[-1] == all_pairs.model.node_pairs


@pytest.mark.parametrize(("ratio", "published"), [(0.4, 1.10), (0.01, 1.552)])
def test_all_pairs_failed_depends_on_the_stiffness(ratio, published) -> None:
    """METHOD.md §3, a prototype: 1.10 at k_t/k_n = 0.4 and 1.552 at 0.01, to 2 % (its node pairs were others)."""
    result = sk.wedge(dips=("45/115", "45/245"), criterion="all-pairs", shear_stiffness=ratio * 1e7)
    assert result.fos.all_pairs_failed == pytest.approx(published, rel=0.02)
    assert result.fos.limit == pytest.approx(1.5573963, abs=1e-6)


def test_the_wedge_settles_evenly_at_full_strength(all_pairs) -> None:
    """By symmetry the displacement has no part across the slope."""
    east, north, up = all_pairs.displacements.at_factor_one.movement.displacement
    assert abs(east) < 1e-12
    assert north < 0.0
    assert up < 0.0
    assert all_pairs.displacements.at_factor_one.residual < 1e-9
