"""The limit on curved surfaces against a section's equilibrium by quadrature, Clarabel, and what must not change it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

import slopekit as sk
from slopekit.closed_form.rotation import rotational_failure
from slopekit.preie.motion.balance import balances_of_block, worst_balance
from slopekit.preie.one_block import pairs_limit as pairs_module
from slopekit.preie.one_block.intact_limit import intact_limit
from slopekit.preie.one_block.limit import LimitAnalysis
from slopekit.preie.one_block.pairs_limit import (
    _elastic_path_limit,
    elastic_displacement,
    pairs_limit,
)
from slopekit.preie.outcome import Outcome
from tests.closed_form.scalar_plane import plane_failure
from tests.preie import conic_oracle
from tests.scenes import (
    COARSE,
    PAPER,
    SLOPE,
    SPHERE,
    ellipsoid_mesh,
    inputs,
    model_of,
    run,
    save,
    sheet,
    slab,
    tilted,
)


def turning_cap(radius, half_width, distance, dip, c, phi, weight, pressure=0.0, seismic=0.0):
    """F of a cap of a surface of revolution about y that turns about that axis, by Gauss's rule over the surface.

    Normal stresses of an even elastic bed without tension under a mass that turns freely: n·q where that presses, q in
    the x-z plane. Three equations of equilibrium (x, z, moment about the axis) for q and λ = 1/F, by SciPy.
    `half_width` None: per metre of a cylinder.
    """
    u, wu = np.polynomial.legendre.leggauss(80)
    beta = math.radians(dip)
    if half_width is None:
        t, wt, rho = np.zeros(1), np.ones(1), np.array([radius])
        stretch, side = np.ones(1), np.zeros(1)
    else:
        end = math.acos(
            min(1.0, abs(distance) / radius)
        )  # beyond it a section does not meet the cut
        t, wt = end * u, end * wu
        rho = radius * np.cos(t)
        stretch = np.hypot(radius * np.sin(t), half_width * np.cos(t))
        side = radius * np.sin(t) / stretch
    open_angle = np.arccos(
        np.clip(-distance / rho, -1.0, 1.0)
    )  # of the arc about the cut's downward normal
    angle = open_angle[:, None] * u + (-math.pi / 2 - beta)
    area = (wt * rho * stretch * open_angle)[:, None] * wu
    ex, ez = np.cos(angle), np.sin(angle)
    nx, nz = (
        -np.sqrt(1.0 - side**2)[:, None] * ex,
        -np.sqrt(1.0 - side**2)[:, None] * ez,
    )  # into the mass
    if half_width is None:
        omega = float(open_angle[0])
        volume = radius**2 * (omega - math.sin(omega) * math.cos(omega))
        depth = 2.0 * radius**3 * math.sin(omega) ** 3 / 3.0 / volume
    else:
        h = radius + distance
        volume = math.pi * h * h * (3.0 * radius - h) / 3.0 * half_width / radius
        depth = 3.0 * (2.0 * radius - h) ** 2 / (4.0 * (3.0 * radius - h))
    x, z = -depth * math.sin(beta), -depth * math.cos(beta)
    load = weight * volume * np.array([seismic, -1.0])
    moment = z * load[0] - x * load[1]
    turns = math.copysign(1.0, moment)
    arm = np.broadcast_to(rho[:, None], angle.shape)

    def out(unknown):
        stress = np.maximum(unknown[0] * nx + unknown[1] * nz, 0.0)
        shear = -unknown[2] * (c + stress * math.tan(math.radians(phi))) * turns
        push = stress + pressure
        return [
            float((area * (push * nx + shear * ez)).sum() + load[0]) / abs(load[1]),
            float((area * (push * nz - shear * ex)).sum() + load[1]) / abs(load[1]),
            float((area * shear * arm).sum() + moment) / abs(moment),
        ]

    solved, _, found, _ = fsolve(out, [0.1, weight * depth, 1.0], full_output=True, xtol=1e-13)
    assert found == 1
    return 1.0 / solved[2]


def line_of(radius, distance, dip, centre):
    return (tilted(distance, dip, 4.0 * radius) + np.array(centre)).tolist()


CAPS = [
    (10.0, 10.0, -5.0, 26.565051, 20.0, 0.0),
    (10.0, 10.0, -5.0, 26.565051, 20.0, 20.0),
    (40.0, 28.284271247461902, -40.0 / math.sqrt(2.0), 45.0, 30.0, 30.0),
    (10.0, 25.0, -6.0, 20.0, 10.0, 35.0),
    (10.0, 3.0, -3.0, 15.0, 5.0, 20.0),
    (10.0, None, -5.0, 30.0, 20.0, 0.0),
    (10.0, None, -5.0, 30.0, 5.0, 30.0),
]


@pytest.mark.parametrize(("radius", "half_width", "distance", "dip", "c", "phi"), CAPS)
@pytest.mark.parametrize("loads", [{}, {"pressure": 5.0}, {"seismic": 0.1}])
def test_caps_of_surfaces_of_revolution(radius, half_width, distance, dip, c, phi, loads) -> None:
    """Limits to 1e-4 (the mesh: areas to 3e-5; the edge of contact between node pairs), true normals."""
    exact = turning_cap(radius, half_width, distance, dip, c, phi, 20.0, **loads)
    slip = {"shape": "ellipsoid", "centre": [3, 0, 7], "radii": [radius, half_width, radius]}
    if half_width is None:
        slip = {"shape": "cylinder", "centre": [3, 7], "radius": radius, "length": 6}
    more = {"water": {"pressures": loads["pressure"]}} if "pressure" in loads else {}
    more |= {"loads": {"seismic": loads["seismic"]}} if "seismic" in loads else {}
    model, _ = model_of(
        slip, line_of(radius, distance, dip, (3, 7)), c=c, phi=phi, unit_weight=20.0, **more
    )
    limit = pairs_limit(model).governing
    assert limit.outcome is Outcome.SLIDES
    assert limit.factor == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("phi", [0.0, 20.0])
def test_the_oracle_itself(phi) -> None:
    """φ = 0: the closed form (1.401599); φ = 20: 2.673 of a prototype with 512 points (cases.json, 6d)."""
    found = turning_cap(10.0, 10.0, -5.0, 26.565051, 20.0, phi, 20.0)
    closed = rotational_failure(
        (0, 0, 0), 10.0, 10.0, tilted(-5.0, 26.565051, 40.0), 20.0, 20.0
    ).factor
    assert found == pytest.approx(2.673 if phi else closed, abs=5e-4 if phi else 1e-6)


def test_the_paper_s_ellipsoid_at_any_mesh() -> None:
    """1.3436 ± 0.001 (METHOD.md §6); the mesh moves it by less than 5e-5."""
    for edge in (20.0, 5.0, 2.5, 1.3):
        found = pairs_limit(model_of({**PAPER, "edge": edge})[0]).governing
        assert found.factor == pytest.approx(1.34355, abs=5e-5)


def test_a_long_cylinder_is_a_plane_section() -> None:
    """The same factor at any length: what a section per metre has."""
    slip = {"shape": "cylinder", "centre": [40, 40], "radius": 42}
    short, long = (
        pairs_limit(model_of({**slip, "length": length, "edge": edge})[0]).governing.factor
        for length, edge in ((1.0, 4.0), (200.0, 8.0))
    )
    assert long == pytest.approx(short, rel=1e-4)


# -- a tilted flat sheet: plane failure ---------------------------------------------------------------


CLIFF = [(70, -60), (40, 0), (0, 40), (-60, 40)]


def flat_sheet(folder, turn: float = 0.0):
    """A sheet dipping 30° through the toe of a slab 10 m wide whose face falls away below it."""
    c, s = math.cos(turn), math.sin(turn)
    matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    points, triangles = sheet(30.0, 20.0, 200.0)
    vertices, faces = slab(CLIFF, 5.0, -80.0, (-90.0, 100.0))
    return (
        {"mesh": str(save(folder / "slip.obj", (points @ matrix.T, triangles)))},
        save(folder / "slope.obj", (vertices @ matrix.T, faces)),
    )


@pytest.mark.parametrize("turn", [0.0, 2.3])
@pytest.mark.parametrize(
    ("c", "phi", "pressure"), [(30, 25, 0), (0, 25, 0), (30, 0, 0), (30, 25, 40)]
)
def test_a_flat_sheet_is_a_plane(tmp_path, turn, c, phi, pressure) -> None:
    """Hoek & Bray's plane failure of a face at 45°, plane at 30°, 40 m high: to rounding, turned too."""
    slip, slope = flat_sheet(tmp_path, turn)
    model, slippage = model_of(slip, slope, c=c, phi=phi, water={"pressures": pressure})
    exact = plane_failure(
        45, 0, 30, 40.0, c, phi, 21.56, crack_distance_m=None, mean_pressure_kpa=pressure
    )
    assert slippage.misfit_deg == pytest.approx(0.0, abs=1e-6)
    assert pairs_limit(model).governing.factor == pytest.approx(exact.factor, rel=1e-7)


# -- what must not change it --------------------------------------------------------------------------


MIRRORED = [[-x, z] for x, z in SLOPE]
FAR = [[x + 5e5, z + 4e6] for x, z in SLOPE]


@pytest.mark.parametrize(
    ("slip", "slope"),
    [
        (PAPER, SLOPE[::-1]),
        ({**PAPER, "centre": [-40, 0, 40]}, MIRRORED),
        ({**PAPER, "centre": [500040, 4e6, 4000040]}, FAR),
        ({**PAPER, "centre": [40, -3e5, 40]}, SLOPE),
    ],
    ids=["turned about", "mirrored", "map", "along the slope"],
)
@pytest.mark.parametrize("more", [{"loads": {"seismic": 0.05}, "water": {"pressures": 20}}])
def test_order_mirror_and_place(slip, slope, more) -> None:
    """To 1e-6: the map's coordinates have 1e-9 m of rounding, the mirrored octahedron is the same."""
    one = pairs_limit(model_of(PAPER, **more)[0]).governing
    two = pairs_limit(model_of(slip, slope, **more)[0]).governing
    assert two.outcome is one.outcome
    assert two.factor == pytest.approx(one.factor, rel=1e-6)


@pytest.mark.parametrize("scale", [2.5e-5, 25.0])
@pytest.mark.parametrize("c", [0.0, 30.0])
def test_a_millimetre_and_a_kilometre(scale, c) -> None:
    """Cohesion scaled with the size: 1 mm and 1 km high, to 1e-7."""
    slip = PAPER | {key: [scale * value for value in PAPER[key]] for key in ("centre", "radii")}
    slope = [[scale * x, scale * z] for x, z in SLOPE]
    one, two = model_of(PAPER, c=c)[0], model_of(slip, slope, c=c * scale)[0]
    factors = [pairs_limit(model).governing.factor for model in (one, two)]
    assert factors[1] == pytest.approx(factors[0], rel=1e-7)


@pytest.mark.parametrize("turn", [0.4, 1.9])
def test_meshes_turned_about_the_vertical(tmp_path, turn) -> None:
    c, s = math.cos(turn), math.sin(turn)
    matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    factors = []
    for k, by in enumerate((np.eye(3), matrix)):
        (vertices, triangles), (points, faces) = (
            ellipsoid_mesh(3),
            slab(SLOPE, 50.0, -20.0, (-60.0, 100.0)),
        )
        slip = save(tmp_path / f"slip{k}.obj", (vertices @ by.T, triangles))
        slope = save(tmp_path / f"slope{k}.obj", (points @ by.T, faces))
        factors.append(pairs_limit(model_of({"mesh": str(slip)}, slope)[0]).governing.factor)
    assert factors[1] == pytest.approx(factors[0], rel=1e-6)


@pytest.mark.parametrize("toward", [0.0, 30.0, 200.0])
def test_a_sphere_turns_whichever_way_it_is_pushed(toward) -> None:
    """Level ground: a push toward any side gives the same factor (the mesh has four-fold symmetry: 1e-4 between)."""
    slip = {"shape": "sphere", "centre": [0, 0, 12], "radius": 20}

    def pushed(trend: float) -> float:
        loads = {"seismic": {"k": 0.3, "toward": trend}}
        return pairs_limit(model_of(slip, [[-40, 0], [40, 0]], loads=loads)[0]).governing.factor

    assert pushed(toward) == pytest.approx(pushed(90.0), rel=1e-4)


def random_scene(seed: int) -> dict:
    """Random ellipsoids and cylinders in random slopes, strengths and loads."""
    rng = np.random.default_rng(seed)
    while True:
        radii = rng.uniform(15.0, 50.0, 3)
        if rng.random() < 0.3:
            radii[2] = radii[0]
        face, height = rng.uniform(20.0, 80.0), rng.uniform(10.0, 40.0)
        run_ = height / math.tan(math.radians(face))
        slope = [[run_ + 60, 0], [run_, 0], [0, height], [-60, height + rng.uniform(0.0, 5.0)]]
        centre = np.array(
            [
                run_ / 2 + rng.uniform(0.0, 10.0),
                rng.uniform(-5.0, 5.0),
                height / 2 + rng.uniform(5.0, 25.0),
            ]
        )
        slip = {
            "shape": "ellipsoid",
            "centre": centre.tolist(),
            "radii": radii.tolist(),
            "edge": 14,
        }
        if rng.random() < 0.25:
            slip = {
                "shape": "cylinder",
                "centre": centre[[0, 2]].tolist(),
                "radius": radii[0],
                "length": 20,
                "edge": 14,
            }
        more = {"c": rng.uniform(0.0, 60.0) * (rng.random() < 0.8), "phi": rng.uniform(3.0, 45.0)}
        if rng.random() < 0.3:
            more["water"] = {"pressures": rng.uniform(1.0, 60.0)}
        if rng.random() < 0.3:
            more["loads"] = {
                "seismic": {"k": rng.uniform(0.0, 0.3), "toward": rng.choice([90.0, 0.0, 45.0])}
            }
        if rng.random() < 0.3:
            bolt = {
                "force": rng.uniform(1e3, 2e4),
                "toward": f"{rng.uniform(230.0, 310.0):.1f}/{rng.uniform(-10.0, 50.0):.1f}",
            }
            more["support"] = {
                "bolts": [
                    bolt | {"acts": str(rng.choice(["active", "passive"])), "head": [run_, 0, 1]}
                ]
            }
        try:
            sk.load(inputs(slip, slope, **more))
            return {"slip": slip, "slope": slope, **more, "model": model_of(slip, slope, **more)[0]}
        except sk.GeometryError:
            continue


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(20), 32, 35, 36, 41, 59])  # every branch that sixty take
def test_random_scenes(seed) -> None:
    """Forces that balance at the limit exist (Clarabel): limit <= static bound; strength / F leaves F = 1."""
    scene = random_scene(seed)
    model = scene["model"]
    limit = pairs_limit(model).governing
    assert limit.outcome is not Outcome.NOT_CONVERGED
    if not limit.factor:
        assert limit.outcome in (Outcome.LIFTED, Outcome.NO_STRENGTH, Outcome.NO_DRIVING_FORCE)
        return
    assert conic_oracle.sparse_shortfall(model, (1.0 + 1e-4) / limit.factor) < 1e-7
    f = limit.factor
    weaker = replace(
        model,
        cohesion=model.cohesion / f,
        tan_friction=model.tan_friction / f,
        bolt_capacity=model.bolt_capacity / f,
    )
    again = pairs_limit(weaker).governing
    assert again.factor == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("seed", [0, 4, 5, 9, 13, 19, 25, 27, 31, 39])
def test_the_exact_start_and_the_path_are_two_ways_to_one_limit(seed) -> None:
    """Newton's method on six unknowns, and elastic joints on their way to failure: 1e-6, forces within the law."""
    model = random_scene(seed)["model"]
    displacement = elastic_displacement(model)
    exact = intact_limit(model, displacement)
    assert exact is not None
    path = _elastic_path_limit(model, model.cohesion, displacement)
    assert path.factor == pytest.approx(exact.factor, rel=1e-6)
    assert path.normal_force == pytest.approx(exact.normal_force, rel=1e-4, abs=1e-6)
    found = worst_balance(balances_of_block(model, LimitAnalysis(exact, exact, exact, False)))
    assert max(found.force, found.moment) < 1e-9
    assert found.admissible_within(1e-9)


def test_a_search_that_takes_too_long_is_no_limit(monkeypatch) -> None:
    monkeypatch.setattr(pairs_module, "intact_limit", lambda *_: None)
    monkeypatch.setattr(pairs_module, "_WORK", 1e5)
    found = limit_of()
    assert (found.outcome, found.factor) == (Outcome.NOT_CONVERGED, None)


# -- statuses, water, bolts, dilation -----------------------------------------------------------------


def limit_of(slip=PAPER, slope=SLOPE, **more):
    return pairs_limit(model_of({**slip, **COARSE}, slope, **more)[0]).governing


def test_level_ground_is_driven_by_nothing() -> None:
    for slip in (SPHERE | {"centre": [0, 0, 20]}, PAPER | {"centre": [1, 2, 20]}):
        assert limit_of(slip, [[-60, 0], [60, 0]]).outcome is Outcome.NO_DRIVING_FORCE


def test_water_lifts_it_off_and_a_pull_too() -> None:
    """On the cap's cut, an ellipse of 20 and 28.28 m, the push p A against W cos 45° across it.

    Well below that it slides. Above it the mass leaves the surface, and with twice as much at once everywhere.
    """
    lifts = 237283.0 * math.cos(math.radians(45.0)) / (math.pi * 20.0 * 28.284)
    assert limit_of(water={"pressures": 0.3 * lifts}).outcome is Outcome.SLIDES
    assert limit_of(water={"pressures": 1.25 * lifts}).outcome is Outcome.NO_STRENGTH
    assert limit_of(water={"pressures": 2.2 * lifts}).outcome is Outcome.LIFTED
    assert limit_of(loads={"forces": [[0, 0, 3e5]]}).outcome is Outcome.LIFTED


def test_no_strength_is_an_outcome() -> None:
    assert limit_of(c=0.0, phi=0.0).outcome is Outcome.NO_STRENGTH


def test_water_falls_and_bolts_rise() -> None:
    plain = limit_of().factor
    falling = [limit_of(water={"pressures": p}).factor for p in (5.0, 20.0, 40.0)]
    assert [plain, *falling] == sorted([plain, *falling], reverse=True)
    bolts = [
        limit_of(
            support={
                "bolts": [
                    {"force": force, "toward": "270/20", "acts": "passive", "head": [20, 0, 20]}
                ]
            }
        ).factor
        for force in (0.1, 1e4, 3e4)
    ]
    assert bolts[0] == pytest.approx(plain, rel=1e-5)
    assert plain < bolts[1] < bolts[2]


@pytest.mark.parametrize("acts", ["active", "passive"])
@pytest.mark.parametrize("head", [[20, 0, 20], [30, 0, 10]])
def test_bolts_turn_about_the_axis(acts, head) -> None:
    """φ = 0 on the paper's ellipsoid: F = (M_c + M_b) / M or M_c / (M - M_b), the moments by hand."""
    toward = np.array([-math.cos(math.radians(20.0)), 0.0, -math.sin(math.radians(20.0))])
    arm = np.array(head, dtype=float) - [40.0, 0.0, 40.0]
    lever = arm[2] * toward[0] - arm[0] * toward[2]  # against the turning of the mass
    exact = rotational_failure((40, 0, 40), 40.0, 28.284271247461902, SLOPE, 100.0, 21.56)
    resists, drives, bolt = exact.resisting_moment_knm, exact.driving_moment_knm, 2e4 * lever
    expected = (resists + bolt) / drives if acts == "passive" else resists / (drives - bolt)
    support = {"bolts": [{"force": 2e4, "toward": "270/20", "acts": acts, "head": head}]}
    found = pairs_limit(model_of(PAPER, c=100.0, phi=0.0, support=support)[0]).governing
    assert found.factor == pytest.approx(expected, rel=2e-5)


def test_the_turned_moment_of_water_on_an_uneven_ground(tmp_path) -> None:
    """Pressure on the slip surface balances the same pressure on the ground above it: force and moment (to O(h²))."""
    from slopekit.kinds import surface

    top = np.array([[-60, -60, 10], [60, -60, 0], [60, 60, 25], [-60, 60, 60]], dtype=float)
    vertices = np.concatenate([top, top * [1, 1, 0] + [0, 0, -80]])
    faces = [
        [0, 1, 2],
        [0, 2, 3],
        [4, 6, 5],
        [4, 7, 6],
        [0, 4, 5],
        [0, 5, 1],
        [1, 5, 6],
        [1, 6, 2],
        [2, 6, 7],
        [2, 7, 3],
        [3, 7, 4],
        [3, 4, 0],
    ]
    slope = save(tmp_path / "slope.obj", (vertices, np.array(faces)))
    slip = {"shape": "ellipsoid", "centre": [5, 8, 40], "radii": [40, 30, 35]}
    design = sk.load(inputs(slip, slope, water={"pressures": 20}))
    mass, pairs = surface._cut(design)
    loads = surface._loads(design, mass, pairs)
    free = mass.triangles[mass.face_kinds != 0]
    a, b, c = (mass.vertices[free[:, k]] for k in range(3))
    pushes = 20.0 * np.cross(b - a, c - a) / 2.0
    moment = np.cross((a + b + c) / 3.0 - mass.centroid, pushes).sum(axis=0)
    assert loads.components["water 0"] == pytest.approx(pushes.sum(axis=0), rel=5e-3)
    assert loads.moment == pytest.approx(moment, abs=5e-3 * float(np.abs(moment).max()))


def test_the_result_carries_the_limit() -> None:
    result = run({**PAPER, **COARSE})
    assert result.fos.limit == pytest.approx(limit_of().factor, rel=1e-12)
    assert result.fos.limit < result.fos.static_bound
