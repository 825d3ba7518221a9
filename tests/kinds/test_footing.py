"""The footing on a weak plane: the paper's §3.3 and Table 3, and the rule of the middle third."""

import math
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk

LENGTH = 5.0 * math.sqrt(2.0)
TEMPLATE = Path(__file__).parents[2] / "templates" / "paper-footing.yaml"


def run(load=1500.0, at="middle", dip=45.0, length=LENGTH, c=200.0, phi=0.0, **more):
    return sk.run(
        {
            "slopekit": 1,
            "kind": "footing",
            "footing": {"load": load, "at": at},
            "weak_plane": {"dip": dip, "length": length, "pairs": more.pop("pairs", 9)},
            "strength": {"seam": {"c": c, "phi": phi}},
            **more,
        }
    )


def test_the_paper_s_factor() -> None:
    """K* = 200 · 5√2 / (1500 sin 45°) = 4/3 (Sheng et al. 2023, §3.3), exact."""
    result = run()
    assert result.fos.limit == pytest.approx(4.0 / 3.0, rel=1e-12)
    assert result.fos.closed_form == pytest.approx(4.0 / 3.0, rel=1e-12)
    assert (result.status, result.agree) == ("slides_on_J1", True)


@pytest.mark.parametrize(
    ("dip", "friction", "weight"), [(20.0, 0.0, None), (45.0, 30.0, 20.0), (70.0, 10.0, 26.0)]
)
def test_two_equations_of_a_free_body(dip, friction, weight) -> None:
    """N and T from horizontal and vertical equilibrium, to rounding."""
    angle = math.radians(dip)
    # the plane pushes along (sin, cos) and holds along (-cos, sin)
    columns = np.array([[math.sin(angle), -math.cos(angle)], [math.cos(angle), math.sin(angle)]])
    block = (weight or 0.0) * 18.0 * math.sin(angle) * math.cos(angle)
    normal, shear = np.linalg.solve(columns, [0.0, 700.0 + block])
    rock = {} if weight is None else {"rock": {"unit_weight": weight}}
    found = run(load=700.0, dip=dip, length=6.0, c=40.0, phi=friction, **rock)
    expected = (240.0 + normal * math.tan(math.radians(friction))) / shear
    assert found.fos.closed_form == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("dip", "c", "phi"), [(20, 50, 10), (40, 120, 25), (70, 300, 40), (45, 0, 50)]
)
@pytest.mark.parametrize("unit_weight", [None, 24.0])
def test_two_forces_by_hand(dip, c, phi, unit_weight) -> None:
    """F = (c L + P cos δ tan φ) / (P sin δ), P with the weight of the triangle L² sin δ cos δ / 2."""
    a = math.radians(dip)
    rock = {"rock": {"unit_weight": unit_weight}} if unit_weight else {}
    total = 1500.0 + (unit_weight or 0.0) * 64.0 * math.sin(a) * math.cos(a) / 2.0
    exact = (c * 8.0 + total * math.cos(a) * math.tan(math.radians(phi))) / (total * math.sin(a))
    result = run(dip=dip, length=8.0, c=c, phi=phi, **rock)
    assert result.fos.limit == pytest.approx(exact, rel=1e-9)


def test_the_series_of_the_template() -> None:
    """Table 3: no pair fails at 1.0, one after the other up to all nine at 1.334; no rest beyond 4/3."""
    result = sk.run(TEMPLATE)
    failed = {step.factor: step.failed_pairs for step in result.series}
    counts = [failed[factor] for factor in sorted(failed)]
    assert failed[1.0] == 0
    assert failed[1.334] == 9
    assert counts == sorted(counts)
    assert len(set(counts)) >= 4  # gradual, as in the paper
    for step in result.series:
        assert step.stands == (step.factor <= 1.333)
        assert (step.movement is None) == (step.factor > 4.0 / 3.0)
    down = [-step.movement.displacement[2] for step in result.series if step.movement is not None]
    assert down == sorted(down)
    assert 0.0 < down[0] < down[-1] < 1.0
    at_one = 1e3 * result.series[0].movement.displacement[[0, 2]]
    assert at_one == pytest.approx(
        [11.2, -17.0], abs=0.1
    )  # Table 3 (mm); the stiffness was chosen to give it


def test_a_load_in_the_middle_fails_all_pairs_at_once() -> None:
    """The shear of a rigid block that does not turn is even: 0 or 9."""
    series = run(analysis={"factors": [1.0, 1.3, 1.333, 1.334]}).series
    assert [step.failed_pairs for step in series] == [0, 0, 0, 9]


@pytest.mark.parametrize("at", [1.0, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("pairs", [3, 9, 33])
def test_cohesion_acts_where_the_load_presses_the_seam(at, pairs) -> None:
    """φ = 0: 4/3 within the middle third, beyond it on the 3 (L/2 - e) that are pressed, as under a dam. By hand."""
    length, off = 5.0 * math.sqrt(2.0), abs(at - 2.5) / math.cos(math.pi / 4)
    pressed = min(length, 3.0 * (length / 2.0 - off))
    found = run(at=at, pairs=pairs)
    assert found.fos.limit == pytest.approx(4.0 / 3.0 * pressed / length, rel=1e-9)
    assert found.comparisons.forces_only == pytest.approx(4.0 / 3.0, rel=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.16, 0.17, 0.3])
def test_the_middle_third(share) -> None:
    """On an elastic bed an edge opens where the load passes more than L/6 from the middle; it then loses its cohesion.

    The load passes (at - b/2) / cos δ along the plane from its middle; level, it would be the rule of the middle third.
    Here the push square to the plane is P cos δ at that place.
    """
    width = 5.0
    result = run(load=900.0, at=width * (0.5 + share), phi=30.0)
    rest = result.displacements.at_factor_one
    opens = share > 1.0 / 6.0
    if not opens:
        assert rest is not None
        assert rest.failed_pairs == 0
    assert result.limit_state.node_pairs.normal_kn.min() >= 0.0
    idle = (
        result.limit_state.node_pairs.normal_kn
        <= 1e-9 * result.limit_state.node_pairs.normal_kn.sum()
    ).any()
    assert idle == opens


@pytest.mark.parametrize("at", [5.2, 100.0])
def test_a_load_beside_the_block(at) -> None:
    with pytest.raises(sk.GeometryError) as caught:
        run(at=at)
    assert caught.value.codes == ("E219",)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("at", [0.0, 5.0])
def test_a_load_on_the_edge_is_still_on_the_block(at) -> None:
    assert run(at=at).status != "not_converged"


def test_displacement_of_an_even_load_by_hand() -> None:
    """u_n = N / (k_n L), u_t = T / (k_t L): springs in a row (1e-6: Newton's residual)."""
    result = sk.run(
        {
            "slopekit": 1,
            "kind": "footing",
            "footing": {"load": 1500},
            "weak_plane": {"dip": 30, "length": 6},
            "strength": {"seam": {"c": 500, "phi": 0, "stiffness": {"normal": 4e4, "shear": 1e4}}},
        }
    )
    sine, cosine = 0.5, math.sqrt(0.75)
    closes, slips = 1500.0 * cosine / (4e4 * 6.0), 1500.0 * sine / (1e4 * 6.0)
    x, _, z = result.displacements.at_factor_one.movement.displacement
    assert x == pytest.approx(slips * cosine - closes * sine, rel=1e-6)
    assert z == pytest.approx(-slips * sine - closes * cosine, rel=1e-6)


def test_what_governs_is_the_closed_form_of_the_changed_design() -> None:
    """The block has another weight where the plane is steeper."""
    rock = {"rock": {"unit_weight": 24.0}}
    said = {
        change: factor for change, factor, _ in run(dip=40.0, phi=30.0, **rock).comparisons.governs
    }
    assert said["dip +1°"] == pytest.approx(
        run(dip=41.0, phi=30.0, **rock).fos.closed_form, rel=1e-12
    )
    assert said["load +10 %"] == pytest.approx(
        run(load=1650.0, dip=40.0, phi=30.0, **rock).fos.closed_form, rel=1e-12
    )
