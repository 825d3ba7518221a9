"""Plane failure from design to result: free bodies by hand, the books' cases, and faults with their codes."""

import math

import numpy as np
import pytest

import slopekit as sk


def inputs(joint=(35, 180), face=(60, 180), upper=(0, 180), height=12.0, c=25.0, phi=37.0, **more):
    return {
        "slopekit": 1,
        "kind": "plane",
        "slope": {"face": list(face), "upper": list(upper), "height": height},
        "joints": {"J1": {"plane": list(joint)}},
        "strength": {"s": {"c": c, "phi": phi}},
        "rock": {"unit_weight": more.pop("unit_weight", 26.0)},
        **more,
    }


def run(*args, **more):
    return sk.run(inputs(*args, **more))


@pytest.mark.parametrize(
    ("c", "water", "exact"),
    [(25, 3, 1.24666), (25, 0, 1.54448), (0, 0, 1.07619)],
    ids=["4a_wm6", "4c_wm6", "4d_wm6"],
)
def test_the_cases_of_wyllie_and_mah(c, water, exact) -> None:
    """Wyllie & Mah (2004), ch. 6: to 1e-4 of the recomputed five digits; closed form and PRE-IE to 1e-9."""
    result = run(c=c, crack={"depth": 4.35, "water": water})
    assert result.fos.limit == pytest.approx(exact, abs=1e-4)
    assert result.fos.closed_form == pytest.approx(exact, abs=1e-4)
    assert result.fos.limit == pytest.approx(result.fos.closed_form, rel=1e-9)


def free_body(plane, face, upper, height, c, phi, weight, crack, water, seismic, pulls):
    """F from two equations of equilibrium in x and z, every push resolved by hand; toe at 0, x out of the slope."""
    tp, tf, tu = (math.tan(math.radians(dip)) for dip in (plane, face, upper))
    crest = -height / tf
    at = crest - crack if crack is not None else -(height + tu * crest) / (tp - tu)
    ring = [(0.0, 0.0)]
    if crack is None or crack > 0.0:
        ring.append((crest, height))
    if crack is not None:
        ring.append((at, height + crack * tu if crack >= 0.0 else -at * tf))
    ring.append((at, -at * tp))
    area = (
        abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:] + ring[:1], strict=True)))
        / 2.0
    )
    length = math.hypot(*ring[-1])
    sine, cosine = math.sin(math.radians(plane)), math.cos(math.radians(plane))
    if crack is None:  # highest halfway along, nothing at both ends
        uplift, thrust = 0.25 * water * 9.81 * max(z for _, z in ring) * length, 0.0
    else:
        deep = ring[-2][1] - ring[-1][1]
        uplift, thrust = 0.5 * 9.81 * water * deep * length, 0.5 * 9.81 * water * deep**2
    x = thrust + seismic * weight * area + uplift * sine + sum(pull[0] for pull in pulls)
    z = -weight * area + uplift * cosine + sum(pull[1] for pull in pulls)
    normal, shear = np.linalg.solve([[sine, -cosine], [cosine, sine]], [-x, -z])
    if normal <= 0.0 or shear <= 0.0:
        return None
    return (c * length + normal * math.tan(math.radians(phi))) / shear


def random_plane(seed: int):
    rng = np.random.default_rng(seed)
    face = rng.uniform(30.0, 89.0)
    plane = rng.uniform(10.0, face - 3.0)
    upper = rng.uniform(-15.0, min(plane - 3.0, 30.0))
    height, azimuth = 10.0 ** rng.uniform(0.0, 2.0), rng.uniform(0.0, 360.0)
    behind = height / math.tan(math.radians(plane)) - height / math.tan(math.radians(face))
    crack = rng.uniform(-0.1, 0.7) * min(behind, height) if rng.random() < 0.5 else None
    water = rng.uniform(0.0, 1.0) if rng.random() < 0.5 else 0.0
    seismic = rng.uniform(0.0, 0.3) if rng.random() < 0.3 else 0.0
    force, plunge = rng.uniform(0.0, 0.1) * 25.0 * height**2, rng.uniform(-20.0, 50.0)
    acts = rng.choice(["active", "passive", "none"])
    return (
        (
            plane,
            face,
            upper,
            height,
            rng.uniform(0.0, 100.0),
            rng.uniform(5.0, 50.0),
            rng.uniform(20.0, 30.0),
            crack,
            water,
            seismic,
        ),
        azimuth,
        force,
        plunge,
        str(acts),
    )


@pytest.mark.parametrize(
    "seed", [*range(32), 50, 55, 64, 65, 76, 82, 96]
)  # every branch that a hundred take
def test_random_planes(seed) -> None:
    """Hand equilibrium and closed form to 1e-8 where moments do not govern; below them where they do."""
    (
        (plane, face, upper, height, c, phi, weight, crack, water, seismic),
        azimuth,
        force,
        plunge,
        acts,
    ) = random_plane(seed)
    back = (azimuth + 180.0) % 360.0
    more = {"water": {"mode": "full", "fill": water}} if water else {}
    more |= {"crack": {"distance": crack}} if crack is not None else {}
    more |= {"loads": {"seismic": seismic}} if seismic else {}
    if acts != "none":
        more["support"] = {"bolts": [{"force": force, "toward": [back, plunge], "acts": acts}]}
    try:
        result = run(
            (plane, azimuth),
            (face, azimuth),
            (abs(upper), azimuth if upper >= 0.0 else back),
            height,
            c,
            phi,
            unit_weight=weight,
            **more,
        )
    except sk.GeometryError:  # E207: the crack lies in front of the toe or behind the block
        if crack is None:
            raise
        return
    assert result.status != "not_converged"
    assert result.agree is not False
    pull = force * np.array([-math.cos(math.radians(plunge)), -math.sin(math.radians(plunge))])
    if acts != "passive":
        pulls = [pull] if acts == "active" else []
        exact = free_body(plane, face, upper, height, c, phi, weight, crack, water, seismic, pulls)
        if exact is not None:
            assert result.fos.closed_form == pytest.approx(exact, rel=1e-9)
    if result.fos.limit:
        assert result.fos.static_bound is None or result.fos.limit <= result.fos.static_bound * (
            1.0 + 1e-9
        )
        if result.moments_govern:
            assert result.fos.limit < result.comparisons.forces_only
            assert result.comparisons.forces_only == pytest.approx(result.fos.closed_form, rel=1e-8)
        else:
            assert result.fos.limit == pytest.approx(result.fos.closed_form, rel=1e-8)


@pytest.mark.parametrize("phi", [5.0, 35.0])
@pytest.mark.parametrize("water", [0.0, 2.0])
def test_a_passive_bolt_is_divided_with_the_strength(phi, water) -> None:
    """F (D - T_s/F) = c L + (N + T_n/F) tan φ: a quadratic in F, by hand."""
    tangent = math.tan(math.radians(phi))
    bare = run(phi=phi, crack={"depth": 4.35, "water": water})
    support = {"bolts": [{"force": 300.0, "toward": [0, 10], "acts": "passive"}]}
    found = run(phi=phi, crack={"depth": 4.35, "water": water}, support=support)
    turn = math.radians(35.0 + 10.0)
    along, across = 300.0 * math.cos(turn), 300.0 * math.sin(turn)
    normal, driving = bare.forces.normal["J1"], bare.forces.driving
    cohesion = 25.0 * bare.geometry.areas_m2["J1"]
    f = np.roots([driving, -(along + cohesion + normal * tangent), -across * tangent]).max()
    assert found.fos.limit == pytest.approx(f, rel=1e-9)


def column(seismic: float):
    """A slab 2 m thick and about 12 m high on a plane at 20°, in front of a dry crack, pushed outward."""
    return run(
        (20, 180),
        (90, 180),
        height=12.0,
        c=0.0,
        phi=60.0,
        crack={"distance": 2.0},
        loads={"seismic": seismic},
    )


def test_a_slab_tips_at_its_geometric_limit() -> None:
    """It turns about the toe where k W z = W |x|: k = |x| / z of its centroid, a trapezium by hand, at any strength."""
    rear = 12.0 - 2.0 * math.tan(math.radians(20.0))  # height at the crack
    area = (12.0 + rear) / 2.0 * 2.0
    x = (2.0 * rear + 12.0) / (3.0 * (12.0 + rear)) * 2.0  # behind the face
    # z: rectangle above the foot of the crack, triangle below it
    foot = 12.0 - rear
    z = (2.0 * rear * (foot + rear / 2.0) + foot * (2.0 / 3.0 * foot)) / (2.0 * rear + foot)
    limit = x / z
    assert area == pytest.approx(column(0.0).geometry.volume_m3, rel=1e-12)
    below, above = column(0.999 * limit), column(1.001 * limit)
    assert above.status == "topples"
    assert above.fos.limit is None
    assert "they turn the block over" in " ".join(str(above.sheet).split())
    assert below.status != "topples"
    assert below.fos.limit
    assert (
        run(
            (20, 180),
            (90, 180),
            height=12.0,
            c=0.0,
            phi=85.0,
            crack={"distance": 2.0},
            loads={"seismic": 1.001 * limit},
        ).status
        == "topples"
    )


@pytest.mark.parametrize("water", [5.0, 6.5])
def test_water_tips_a_slab_at_its_place(water) -> None:
    """About the toe: W |x| = V (foot + z_w / 3) + U 2 L / 3; the unit weight at which they balance, to 2e-4."""
    rear = 12.0 - 2.0 * math.tan(math.radians(20.0))
    foot, length = 12.0 - rear, 2.0 / math.cos(math.radians(20.0))
    x = (2.0 * rear + 12.0) / (3.0 * (12.0 + rear)) * 2.0
    turns = (
        0.5 * 9.81 * water**2 * (foot + water / 3.0)
        + 0.5 * 9.81 * water * length * (2.0 / 3.0) * length
    )
    balance = turns / (x * (12.0 + rear))

    def status(unit_weight: float) -> str:
        crack = {"distance": 2.0, "water": water}
        return run(
            (20, 180), (90, 180), c=0.0, phi=85.0, unit_weight=unit_weight, crack=crack
        ).status

    assert status(balance * (1.0 - 2e-4)) == "topples"
    assert status(balance * (1.0 + 2e-4)) != "topples"


def test_a_crack_in_the_face() -> None:
    """W = ½ γ H² (1 - z/H)² cot ψ (cot ψ tan ψ_f - 1), z from the top down to its foot (Hoek & Bray 1981, eq. 7.4)."""
    result = run(crack={"distance": -3.0})
    tf, tp = math.tan(math.radians(60)), math.tan(math.radians(35))
    share = 1.0 - (12.0 - (12.0 / tf - 3.0) * tp) / 12.0
    weight = 0.5 * 26.0 * 144.0 * share**2 / tp * (tf / tp - 1.0)
    assert result.forces.weight == pytest.approx(weight, rel=1e-9)
    assert result.agree


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"joint": (61, 180)}, "E203"),
        ({"joint": (35, 0)}, "E204"),
        ({"joint": (0, 180)}, "E204"),
        ({"joint": (20, 180), "upper": (25, 180)}, "E205"),
        ({"crack": {"distance": 50}}, "E207"),
        ({"crack": {"distance": -8}}, "E207"),
        ({"crack": {"depth": 10}}, "E207"),
        ({"crack": {"depth": 4.35, "distance": 9}}, "E207"),
        ({"crack": {"depth": 4.35, "water": 5}}, "E207"),
        ({"upper": (60, 180)}, "E209"),
        ({"joint": (35, 201)}, "E213"),
        ({"upper": (10, 230)}, "E213"),
    ],
)
def test_faults(changes, code) -> None:
    with pytest.raises(sk.GeometryError) as caught:
        run(**changes)
    assert caught.value.codes == (code,)


def test_a_plane_into_the_slope_is_said_to_dip_by_what_it_dips() -> None:
    with pytest.raises(sk.GeometryError, match="the plane dips 35° into the slope"):
        run(joint=(35, 0))


def test_strike_within_twenty_degrees_is_taken_as_parallel() -> None:
    result = run((35, 199))
    assert result.fos.limit == pytest.approx(run().fos.limit, rel=1e-12)


BOLT = {"force": 300, "toward": [0, 10], "acts": "passive"}


@pytest.mark.parametrize("east", [-40.0, 7.0])
def test_where_along_the_slope_a_bolt_stands_does_not_matter(east) -> None:
    """Per metre of slope; a head 10 m along the face missed the block once."""
    result = run(support={"bolts": [{**BOLT, "head": [east, -3, 6]}]})
    assert result.fos.limit == pytest.approx(run(support={"bolts": [BOLT]}).fos.limit, rel=1e-9)


@pytest.mark.parametrize("toward", [[10, 10], [90, 0]])
@pytest.mark.parametrize("acts", ["active", "passive"])
def test_what_acts_along_the_slope_is_left_out(toward, acts) -> None:
    """W323; the part in the section by hand: cos of the horizontal angle."""
    result = (
        run(
            support={
                "bolts": [{"force": 300, "toward": toward, "acts": acts, "head": [5, -3.4641, 6]}]
            }
        )
        if (toward[0] == 10)
        else run(support={"bolts": [{"force": 300, "toward": toward, "acts": acts}]})
    )
    assert "W323" in [notice.code for notice in result.warnings]
    plunge = math.radians(toward[1])
    level, down = (
        300.0 * math.cos(plunge) * math.cos(math.radians(toward[0])),
        300.0 * math.sin(plunge),
    )
    if level < 1e-9:
        assert result.fos.limit == pytest.approx(run().fos.limit, rel=1e-12)
        return
    same = {
        "force": math.hypot(level, down),
        "toward": [0, math.degrees(math.atan2(down, level))],
        "acts": acts,
    }
    assert result.fos.limit == pytest.approx(run(support={"bolts": [same]}).fos.limit, rel=1e-9)


@pytest.mark.parametrize(
    ("head", "length", "code"), [([0, 3, 20], 9, "E211"), ([0, -3.4641, 6], 2, "E212")]
)
def test_bolts_that_hold_nothing(head, length, code) -> None:
    with pytest.raises(sk.GeometryError) as caught:
        run(support={"bolts": [{**BOLT, "head": head, "length": length}]})
    assert caught.value.codes == (code,)
