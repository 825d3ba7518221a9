"""The contact law against Tables 1 and 2 and eqs. 31-33 of Sheng et al. (2023), and its slopes by differences."""

import numpy as np
import pytest

from slopekit.preie.system.contact import (
    CloughDuncan,
    ContactMode,
    JointStiffness,
    breaks,
    tractions,
)

STIFF = JointStiffness(tangential=1e6)


def law(
    relative,
    stiffness=STIFF,
    c=50.0,
    phi=20.0,
    psi=0.0,
    factor=1.0,
    debonded=False,
):
    rows = np.atleast_2d(np.asarray(relative, dtype=float))
    full = np.full(len(rows), 1.0)
    return tractions(
        rows,
        stiffness,
        c * full,
        np.tan(np.radians(phi)) * full,
        np.tan(np.radians(psi)) * full,
        factor,
        np.full(len(rows), debonded),
    )


def test_modes_of_table_1() -> None:
    assert law([[-1e-5, 1e-6, 0.0], [-1e-5, 1e-3, 0.0]]).modes.tolist() == [
        ContactMode.STICK,
        ContactMode.SLIP,
    ]
    assert law([1e-5, 1e-3, 0.0], debonded=True).modes.tolist() == [ContactMode.DEBOND]


def test_slip_carries_the_reduced_mohr_coulomb_strength_against_the_slip() -> None:
    """τ = (c + σ tan φ) / F (eqs. 32, 33), σ = 1e7 kN/m³ x 1e-5 m = 100 kPa."""
    out = law([-1e-5, 3e-3, 4e-3], factor=1.25).tractions[0]
    strength = (50.0 + 100.0 * np.tan(np.radians(20.0))) / 1.25
    assert out == pytest.approx([100.0, -0.6 * strength, -0.8 * strength], rel=1e-12)


def test_debonded_pair_carries_almost_nothing_until_it_closes() -> None:
    """k_zz = 10 kN/m³ once debonded (paper, §2.4), no shear; closed again it has friction, no cohesion."""
    assert law([1e-3, 1e-3, 0.0], debonded=True).tractions[0] == pytest.approx([-1e-2, 0.0, 0.0])
    closed = law([-1e-5, 1e-2, 0.0], debonded=True).tractions[0]
    assert closed == pytest.approx([100.0, -100.0 * np.tan(np.radians(20.0)), 0.0])


@pytest.mark.parametrize(
    ("opening", "factor", "parts"),
    [
        (1e-6, 1.0, False),
        (3e-6, 1.0, True),
        (1e-6, 4.0, True),
        (1.996e-6, 1.0, False),
        (2.004e-6, 1.0, True),
    ],
)
def test_tension_holds_until_its_reduced_strength(opening, factor, parts) -> None:
    """σ_t = 20 kPa against k_zz x opening: 10 or 30 kPa, and a five-hundredth to either side of its strength."""
    bonded = law([opening, 0.0, 0.0], factor=factor)
    assert breaks(bonded, np.array([20.0]), factor, 0.0).tolist() == [parts]


def test_clough_duncan_starts_at_eq_31_and_bends_to_its_ceiling() -> None:
    """k at τ = 0 is k₁ γ_w (σ/P_a)ⁿ; at τ the tangent is k (1 - R_f τ / (σ tan φ₁))²."""
    cd = CloughDuncan()
    stiffness = JointStiffness(tangential=cd)
    initial = 4800 * 9.81 * (300.0 / cd.atmospheric_kpa) ** 0.56
    at_rest = law([-3e-5, 1e-9, 0.0], stiffness).slopes[0]
    assert -at_rest[1, 1] == pytest.approx(initial, rel=1e-4)
    bent = law([-3e-5, 1e-3, 0.0], stiffness, c=1e4)
    tau = -bent.tractions[0, 1]
    tangent = initial * (1.0 - 0.74 * tau / (300.0 * np.tan(np.radians(36.0)))) ** 2
    assert -bent.slopes[0, 1, 1] == pytest.approx(tangent, rel=1e-9)


@pytest.mark.parametrize(
    "tangential", [1e6, 4e6, CloughDuncan()], ids=["soft", "stiff", "clough-duncan"]
)
@pytest.mark.parametrize("psi", [0.0, 8.0, 20.0])
def test_slopes_are_the_derivatives(tangential, psi) -> None:
    """Central differences of the tractions, away from the kinks."""
    rng = np.random.default_rng(3)
    reach = 2e-4 if isinstance(tangential, float) else 4e-3
    relative = rng.normal(size=(400, 3)) * [3e-5, reach, reach]
    stiffness = JointStiffness(tangential=tangential)
    debonded = relative[:, 0] > 0.0
    at = law(relative, stiffness, psi=psi, debonded=debonded)
    slopes = np.empty((400, 3, 3))
    keeps_mode = np.ones(400, dtype=bool)
    for k in range(3):
        step = np.zeros(3)
        step[k] = 1e-10
        before, after = (
            law(relative + sign * step, stiffness, psi=psi, debonded=debonded)
            for sign in (-1.0, 1.0)
        )
        slopes[:, :, k] = (after.tractions - before.tractions) / 2e-10
        keeps_mode &= (before.modes == at.modes) & (after.modes == at.modes)
    assert set(at.modes[keeps_mode].tolist()) == {0, 1, 2}
    scale = np.abs(slopes).max()
    assert np.abs(slopes - at.slopes)[keeps_mode].max() < 2e-5 * scale


@pytest.mark.parametrize("psi", [3.0, 10.0])
def test_plastic_slip_closes_a_joint_that_dilates(psi) -> None:
    """By hand, step by step: what slips beyond τ / k_t opens by tan ψ of it, and presses with k_n on what it cannot."""
    k_n, k_t, slip, elastic = 1e7, 1e6, 3e-4, 100.0
    normal = elastic
    for _ in range(
        20_000
    ):  # a small part of the way each time: the plain iteration runs away at k_n tan ψ > k_t
        strength = 50.0 + normal * np.tan(np.radians(20.0))
        normal += 1e-2 * (
            elastic + k_n * np.tan(np.radians(psi)) * (slip - strength / k_t) - normal
        )
    out = law([-elastic / k_n, slip, 0.0], psi=psi).tractions[0]
    assert out == pytest.approx([normal, -strength, 0.0], rel=1e-9)
