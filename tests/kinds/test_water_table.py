"""Water tables, ponds, surcharge and the worst crack: against hydrostatics by hand, quadrature and Hoek & Bray."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError, GeometryError, MisfitError
from slopekit.geometry.pressure import Height, Pressure, table_below_planes, table_through_points
from slopekit.kinds import kind_named

WATER = 9.81
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "0/185", "height": "20 m"},
    "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "60/235"}},
    "strength": {"s": {"c": 20, "phi": 30}},
    "rock": {"unit_weight": 26},
}
PLANE = {
    "slopekit": 1,
    "kind": "plane",
    "slope": {"face": "60/180", "height": "12 m"},
    "joints": {"J1": {"plane": "35/180"}},
    "strength": {"s": {"c": 25, "phi": 37}},
    "rock": {"unit_weight": 26},
}


def pressures():
    """A table of each form, with and without a pond."""
    slopes = np.array([[0.1, -0.8, 0.6], [0.0, -0.17, 0.98]])
    forms = (
        table_below_planes(slopes, np.array([0.0, 10.0]), 1.0),
        table_through_points(np.array([0.0, 1.0, 0.0]), [0.0, 5.0, 12.0], [1.0, 3.0, 9.0]),
        (Height(np.array([0.1, -0.2, 0.0]), 2.0),),
    )
    return [Pressure(form, pond, WATER) for form in forms for pond in (None, 2.0)]


@pytest.mark.parametrize("water", pressures())
def test_the_integral_over_a_triangle_is_that_of_quadrature(water) -> None:
    """Force and moment by 80,000 equal triangles: pressure at their middles, so that kinks alone cost (0.2 %)."""
    rng = np.random.default_rng(3)
    n = 283
    u, v = np.meshgrid(np.arange(n) / n, np.arange(n) / n)
    upward = (u + v < 1.0 - 0.5 / n).ravel()
    downward = (u + v < 1.0 - 1.5 / n).ravel()
    middles = np.concatenate(
        [
            np.stack([u.ravel()[upward], v.ravel()[upward]], 1) + 1.0 / 3.0 / n,
            np.stack([u.ravel()[downward], v.ravel()[downward]], 1) + 2.0 / 3.0 / n,
        ]
    )
    for _ in range(3):
        corners = rng.normal(size=(3, 3)) * 8.0
        sides = corners[1:] - corners[0]
        points = corners[0] + middles @ sides
        share = water.pressure(points) * float(np.linalg.norm(np.cross(*sides))) / 2.0 / len(points)
        (thrust,), (at,) = water.resultants(corners[None])
        assert thrust == pytest.approx(float(share.sum()), rel=2e-3, abs=1e-6)
        assert thrust * at == pytest.approx(
            share @ points, rel=5e-3, abs=2e-2 * (1.0 + abs(thrust))
        )


def test_a_polygon_in_the_border_of_two_pieces_counts_once() -> None:
    """A vertical crack at a corner of the table: γ h² / 2 at a third of its height, not twice that."""
    wall = np.array([[0.0, 5.0, 0.0], [1.0, 5.0, 0.0], [1.0, 5.0, 6.0], [0.0, 5.0, 6.0]])
    table = table_through_points(np.array([0.0, 1.0, 0.0]), [0.0, 5.0, 12.0], [1.0, 3.0, 9.0])
    (thrust,), (at,) = Pressure(table, None, WATER).resultants(wall[None])
    assert thrust == pytest.approx(WATER * 4.5, rel=1e-13)
    assert at == pytest.approx([0.5, 5.0, 1.0], rel=1e-13)


@pytest.mark.parametrize(
    "design",
    [WEDGE, PLANE, {**WEDGE, "crack": {"plane": "80/185", "distance": "2 m"}}],
    ids=["wedge", "plane", "cracked wedge"],
)
def test_a_drowned_block_has_its_buoyant_weight(design) -> None:
    """Archimedes: the water's forces add up to γ_w V through the centroid, F is that of a rock of weight γ - γ_w."""
    height = float(design["slope"]["height"].split()[0])
    drowned = sk.load({**design, "water": {"pond": height}})
    loads, block = (made := kind_named(drowned.kind).cut(drowned)).loads, made.block
    water = sum(force for name, force in loads.components.items() if name.startswith("water"))
    assert water == pytest.approx(
        [0.0, 0.0, WATER * block.volume], rel=1e-12, abs=1e-11 * WATER * block.volume
    )
    assert loads.moment == pytest.approx(np.zeros(3), abs=1e-11 * WATER * block.volume * height)
    result = sk.analyse(drowned)
    buoyant = sk.run({**design, "rock": {"unit_weight": 26 - WATER}})
    assert result.fos.limit == pytest.approx(buoyant.fos.limit, rel=1e-9)
    assert result.fos.closed_form == pytest.approx(buoyant.fos.closed_form, rel=1e-12)


def test_a_depth_behind_a_vertical_face_is_below_the_upper_slope() -> None:
    """U = γ_w h² / (2 sin ψ_p), h the table's height over the toe: what a face of nearly 90° has, and a wedge's too."""
    water = {"water": {"mode": "table", "depth": 4.0}}
    slope = {"height": 12.0, "upper": "0/180"}
    result = sk.run({**PLANE, **water, "slope": {**slope, "face": "90/180"}})
    assert result.forces.water["J1"] == pytest.approx(
        WATER * 8.0**2 / 2.0 / math.sin(math.radians(35.0)), rel=1e-12
    )
    for kind in (PLANE, WEDGE):
        upright, steep = (
            sk.run({**kind, **water, "slope": {**slope, "face": f"{dip}/180"}})
            for dip in (90, 89.9999)
        )
        assert upright.fos.limit == pytest.approx(steep.fos.limit, rel=1e-4)
        assert upright.fos.closed_form == pytest.approx(steep.fos.closed_form, rel=1e-4)


@pytest.mark.parametrize("level", [3.0, 8.0])
@pytest.mark.parametrize("is_ponded", [False, True])
def test_a_level_table_on_a_plane_by_hand(level, is_ponded) -> None:
    """U = γ_w h² / (2 sin ψ_p) on the plane; a pond of that level presses on the face with γ_w h² / (2 sin ψ_f)."""
    water = {"pond": level} if is_ponded else {"mode": "table", "plane": f"0/180@{level} m"}
    if (
        not is_ponded
    ):  # level ground water would stand above the face: it is refused, and points end at the face
        with pytest.raises(MisfitError, match="E456"):
            sk.run({**PLANE, "water": water})
        water = {"mode": "table", "points": [[0, 0], [level / math.tan(math.radians(60.0)), level]]}
    result = sk.run({**PLANE, "water": water})
    dip, face, phi = (math.radians(angle) for angle in (35.0, 60.0, 37.0))
    weight = 13.0 * 144.0 * (1.0 / math.tan(dip) - 1.0 / math.tan(face))
    uplift, push = WATER * level**2 / 2.0 / math.sin(dip), 0.0
    if is_ponded:
        push = WATER * level**2 / 2.0 / math.sin(face)
    else:  # below the face the head over the plane falls from the front to the toe
        front = level / math.tan(face)
        uplift = (
            WATER
            * (
                front * (level - front * math.tan(dip)) / 2.0
                + (level - front * math.tan(dip)) ** 2 / math.tan(dip) / 2.0
            )
            / math.cos(dip)
        )
    normal = weight * math.cos(dip) - uplift + push * math.cos(face - dip)
    driving = weight * math.sin(dip) - push * math.sin(face - dip)
    exact = (25.0 * 12.0 / math.sin(dip) + normal * math.tan(phi)) / driving
    assert result.forces.water["J1"] == pytest.approx(uplift, rel=1e-12)
    assert result.forces.water.get("face", 0.0) == pytest.approx(push, rel=1e-12)
    assert result.fos.closed_form == pytest.approx(exact, rel=1e-12)
    assert result.comparisons.forces_only == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize(
    "water",
    [
        {"mode": "table", "depth": "4 m"},
        {"mode": "table", "points": [[0, 0], [6, 5], [20, 12]]},
        {"mode": "table", "plane": "10/185@0m", "pond": 2},
    ],
    ids=str,
)
@pytest.mark.parametrize(
    "crack",
    [
        None,
        {
            "plane": "80/185",
            "distance": "2 m",
        },
    ],
)
def test_both_methods_judge_the_same_water(water, crack) -> None:
    """The closed form on mean pressures, PRE-IE on resultants where they act: the same factor where nothing turns."""
    design = {**WEDGE, "water": water, "loads": {"surcharge": "20 kPa"}} | (
        {"crack": crack} if crack else {}
    )
    result = sk.run(design)
    assert result.comparisons.forces_only == pytest.approx(result.fos.closed_form, rel=1e-9)
    assert result.forces.water["J1"] > 0.0


def test_a_surcharge_is_a_force_on_the_plan_of_the_upper_slope() -> None:
    """The same as its resultant typed as a force through the middle of the upper slope, moments included."""
    upper = sk.run(WEDGE).geometry.faces_m["upper slope"]
    middle, area = (
        upper.mean(axis=0),
        0.5 * abs(float(np.cross(upper[1] - upper[0], upper[2] - upper[0])[2])),
    )
    assert len(upper) == 3
    pressed = sk.run({**WEDGE, "loads": {"surcharge": "50 kPa"}})
    forced = sk.run(
        {**WEDGE, "loads": {"forces": [{"force": [0, 0, -50.0 * area], "at": middle.tolist()}]}}
    )
    assert pressed.fos.limit == pytest.approx(forced.fos.limit, rel=1e-10)
    assert pressed.fos.closed_form == pytest.approx(forced.fos.closed_form, rel=1e-12)


@pytest.mark.parametrize(
    ("water", "origin"),
    [
        ({"mode": "table", "points": [[0, 0], [6, 5], [20, 12]], "pond": 3}, 0),
        ({"mode": "table", "plane": "10/185@-1m"}, 1),
    ],
)
def test_turned_and_moved(water, origin) -> None:
    """Turned about the vertical, and moved to map coordinates with its elevations, a wedge keeps its factor."""
    design = {**WEDGE, "water": water}
    found = sk.run(design).fos
    up = 250.0
    moved = {key: value for key, value in water.items() if key == "mode"}
    if "points" in water:
        moved |= {"points": [[x, z + up] for x, z in water["points"]], "pond": water["pond"] + up}
    else:
        moved |= {"plane": f"10/225@{up - 1.0} m"}
    turned = sk.run(
        {
            **design,
            "slope": {
                "face": "65/225",
                "upper": "0/185",
                "height": "20 m",
                "origin": [5e5, 4e6, up],
            },
            "joints": {"J1": {"plane": "45/145"}, "J2": {"plane": "60/275"}},
            "water": moved,
        }
    ).fos
    assert (turned.limit, turned.closed_form) == pytest.approx(
        (found.limit, found.closed_form), rel=1e-9
    )


# -- the worst crack ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("face", "dip", "height"), [(60.0, 35.0, 12.0), (75.0, 40.0, 30.0), (50.0, 30.0, 5.0)]
)
def test_the_worst_crack_of_a_dry_plane_is_hoek_and_brays(face, dip, height) -> None:
    """Hoek & Bray (1981), ch. 7: b_c/H = sqrt(cot ψ_f cot ψ_p) - cot ψ_f, z_c/H = 1 - sqrt(cot ψ_f tan ψ_p)."""
    design = sk.load(
        {
            **PLANE,
            "slope": {"face": [face, 180], "height": height},
            "joints": {"J1": {"plane": [dip, 180]}},
            "crack": {"distance": "worst"},
        }
    )
    cot_f, cot_p = 1.0 / math.tan(math.radians(face)), 1.0 / math.tan(math.radians(dip))
    result = sk.analyse(design)
    assert design.crack.distance_m / height == pytest.approx(
        math.sqrt(cot_f * cot_p) - cot_f, rel=1e-6
    )
    assert result.geometry.crack_depth_m / height == pytest.approx(
        1.0 - math.sqrt(cot_f / cot_p), rel=1e-6
    )
    assert "the worst place by the closed form" in " ".join(str(result.sheet).split())


@pytest.mark.slow
@pytest.mark.parametrize(
    "more",
    [
        {},
        {"water": "full"},
        {"water": {"mode": "table", "depth": "5 m"}, "loads": {"surcharge": "30 kPa"}},
    ],
    ids=str,
)
def test_no_place_of_a_dense_sweep_is_worse(more) -> None:
    """Designs with the crack at places of their own, one by one, by the closed form: none has a lower factor."""
    crack = {"plane": "80/185", "distance": "worst"}
    worst = sk.load({**WEDGE, "crack": crack, **more})
    form = kind_named("wedge").closed_form
    lowest, factors = form(worst).factor, []
    for distance in np.linspace(0.05, 9.0, 60):
        try:
            found = form(
                sk.load({**WEDGE, "crack": {**crack, "distance": float(distance)}, **more})
            )
        except GeometryError:
            break
        factors.append(found.factor)
    assert len(factors) > 20
    assert lowest <= min(factors) * (1.0 + 1e-12)
    assert worst.crack_searched == (
        "end" if "water" in more and more["water"] == "full" else "inside"
    )
    if worst.crack_searched == "inside":
        assert lowest == pytest.approx(min(factors), rel=5e-3)


@pytest.mark.parametrize(
    ("design", "crack"), [(PLANE, {}), (WEDGE, {"plane": "80/185"})], ids=["plane", "wedge"]
)
def test_a_table_that_fits_the_block_with_its_crack_alone(design, crack) -> None:
    """Far behind the crest the table lies above the ground: there the crack cuts the block off."""
    wet = {
        **design,
        "water": {"mode": "table", "points": [[0, 0], [6, 6], [9, 8], [14, 14], [40, 45]]},
    }
    with pytest.raises(GeometryError, match="E456"):
        sk.run(wet)
    found = sk.load(wet | {"crack": {**crack, "distance": "worst"}})
    assert found.crack_searched == "back"
    own = {**crack, "distance": found.crack.distance_m}
    assert (
        sk.run(wet | {"crack": own}).fos.closed_form
        < kind_named(design["kind"]).closed_form(sk.load(design)).factor
    )


#: Cracks that are worst where their range ends, without a factor at the last place and with one, and where it begins.
_SHAKEN = {"loads": {"seismic": {"k": 0.1, "toward": 180}}}
ENDS = {
    "basal": (
        {
            **_SHAKEN,
            "slope": {"face": "56/180", "upper": "8/180", "height": "20 m"},
            "joints": {"J1": {"plane": "46/145"}, "J2": {"plane": "74/267"}},
            "strength": {"s": {"c": 10, "phi": 27}},
            "basal": {"plane": "9/180", "height": "3 m"},
            "crack": {"plane": "83/169", "distance": "worst"},
        },
        "back",
        "ends, 25.23 m behind the crest along J1's trace:",
    ),
    "bolted": (
        {
            **_SHAKEN,
            "slope": {"face": "68/180", "upper": "25/200", "height": "20 m"},
            "joints": {"J1": {"plane": "39/139"}, "J2": {"plane": "79/215"}},
            "strength": {"s": {"c": 0, "phi": 31}},
            "support": {"bolts": [{"force": "20 MN", "toward": "000/10"}]},
            "crack": {"plane": "81/164", "distance": "worst"},
        },
        "back",
        "ends, 17.67 m behind the crest along J1's trace:",
    ),
    "begins": (
        {
            **_SHAKEN,
            "slope": {"face": "86/180", "upper": "19/180", "height": "20 m"},
            "water": "30 %",
            "joints": {"J1": {"plane": "62/098"}, "J2": {"plane": "74/214"}},
            "strength": {"s": {"c": 50, "phi": 42}},
            "crack": {"plane": "68/204", "distance": "worst"},
        },
        "end",
        "begins, 15.52 m behind the crest along J1's trace:",
    ),
}


@pytest.mark.parametrize("name", ENDS)
def test_the_range_of_the_worst_crack_is_said_to_end(name) -> None:
    """Places swept on both sides, each by itself: lower and lower toward it, none cuts the block beyond."""
    design, where, says = ENDS[name]
    found = sk.load(WEDGE | design)
    place, form = found.crack.distance_m, kind_named("wedge").closed_form

    def factor_at(part: float) -> float | None:
        try:
            crack = {**design["crack"], "distance": place * part}
            return form(sk.load(WEDGE | design | {"crack": crack})).factor
        except GeometryError:
            return None

    toward = -1.0 if where == "back" else 1.0  # into the range
    inside = [factor_at(1.0 + toward * part) for part in (0.008, 0.004, 0.002, 0.001, 0.0)]
    assert inside == sorted(inside, reverse=True)
    assert inside[-2] == pytest.approx(inside[-1], rel=0.03)
    assert factor_at(1.0 - toward * 1e-3) is None
    assert found.crack_searched == where
    says = f"W421 the factor is lowest where the range of the crack {says}"
    assert [str(one).startswith(says) for one in found.ground_notices(0.0, 20.0, place)] == [True]


@pytest.mark.parametrize("law", [{}, {"waviness": 1}], ids=["together", "one by one"])
def test_a_crack_that_lets_the_block_go_is_worse_than_any_factor(law) -> None:
    """W421: water in a crack near the crest lifts this wedge; farther back factors rise from 0.2 on."""
    design = {
        "slopekit": 1,
        "kind": "wedge",
        "slope": {"face": "75/180", "upper": "0/180", "height": 20},
        "joints": {"J1": {"plane": "60/120"}, "J2": {"plane": "60/240"}},
        "strength": {"s": {"c": 20, "phi": 35, **law}},
        "rock": {"unit_weight": 26},
    }

    def at(distance) -> sk.Result:
        return sk.run(
            {**design, "crack": {"plane": "85/180", "distance": distance, "water": "full"}}
        )

    assert [at(distance).status == "lifted" for distance in (0.5, 2.0)] == [True, False]
    found = at("worst")
    assert found.status == "lifted"
    assert found.fos.limit is None
    assert found.fos.closed_form is None
    assert "W421" in [notice.code for notice in found.warnings]
    assert 0.5 < found.design.crack.distance_m < 2.0


def test_a_crack_that_does_not_matter_is_said() -> None:
    """W421: without cohesion and water F of a plane is tan φ / tan ψ wherever the crack is."""
    found = sk.run(
        {**PLANE, "strength": {"s": {"c": 0, "phi": 37}}, "crack": {"distance": "worst"}}
    )
    assert "W421" in [notice.code for notice in found.warnings]
    assert found.fos.limit == pytest.approx(
        math.tan(math.radians(37)) / math.tan(math.radians(35)), rel=1e-9
    )


def test_water_in_the_crack_of_a_plane_as_in_a_wedges() -> None:
    """Wyllie & Mah, ch. 6 (cases.json 4a_wm6): 3 m of water in a crack of 4.35 m give 1.24666; full has 4.35 m."""
    factors = [
        sk.run({**PLANE, "crack": {"depth": 4.35, "water": water}}).fos.closed_form
        for water in (3.0, 4.35, "full")
    ]
    assert factors[0] == pytest.approx(1.24666, abs=5e-6)
    assert factors[1] == pytest.approx(factors[2], rel=1e-12)
    alone = sk.run({**PLANE, "crack": {"depth": 4.35, "water": "9 kPa"}})
    both = sk.run({**PLANE, "crack": {"depth": 4.35}, "water": {"pressures": [0, 9]}})
    assert alone.fos == both.fos


# -- what is wrong --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("water", "code"),
    [
        ({"mode": "table"}, "E454"),
        ({"depth": 4}, "E454"),
        ({"mode": "table", "depth": -1}, "E454"),
        ({"mode": "table", "plane": "5/180"}, "E454"),
        ({"mode": "table", "plane": "85/180@2m"}, "E454"),
        ({"mode": "table", "points": [[0, 0], [10, 4], [5, 6]]}, "E454"),
        ({"mode": "table", "points": [[0, 0], [0, 4]]}, "E454"),
        ({"mode": "table", "depth": 4, "plane": "5/180@2m"}, "E112"),
        ({"mode": "full", "pond": 3}, "E112"),
        ({"mode": "table", "depth": 4, "fill": "50 %"}, "E112"),
        ({"mode": "table", "depth": "4 kPa"}, "E107"),
        ({"mode": "table", "points": [[0, 0], [1, "x"]]}, "E106"),
    ],
    ids=str,
)
@pytest.mark.parametrize("design", [WEDGE, PLANE], ids=["wedge", "plane"])
def test_tables_that_are_none(design, water, code) -> None:
    """Each is said by its code, whatever the kind."""
    with pytest.raises(DesignError) as found:
        sk.load({**design, "water": water})
    assert found.value.codes == (code,) or list(found.value.codes) == [code]


def test_what_else_is_wrong() -> None:
    """A table above the ground, a lifting surcharge, two words for one crack, kinds without a table."""
    with pytest.raises(MisfitError, match="E456"):
        sk.run({**WEDGE, "water": {"mode": "table", "points": [[0, 0], [10, 40]]}})
    for more, code in (
        ({"loads": {"surcharge": -5}}, "E123"),
        (
            {
                "crack": {"plane": "80/185", "distance": 2, "water": "full"},
                "water": {"mode": "table", "depth": 3},
            },
            "E112",
        ),
        ({"crack": {"plane": "80/185", "distance": "best"}}, "E106"),
    ):
        with pytest.raises(DesignError, match=code):
            sk.load({**WEDGE, **more})
    with pytest.raises(DesignError, match="E112"):
        sk.load({**PLANE, "crack": {"depth": 4, "distance": "worst"}})
    held = {
        "seismic": {"k": math.tan(math.radians(35)), "toward": 0}
    }  # along the plane, as much as the weight
    with pytest.raises(DesignError, match="E459"):
        sk.load({**PLANE, "loads": held, "crack": {"distance": "worst"}})


@pytest.mark.parametrize(
    ("pond", "says"), [(-1.0, "it wets nothing"), (25.0, "is that a reservoir?")]
)
def test_what_is_said_of_a_pond(pond, says) -> None:
    """Below the toe it wets nothing, above the crest it may be a slip of elevations."""
    result = sk.run({**WEDGE, "water": {"pond": pond}})
    assert any(says in notice.message for notice in result.warnings if notice.code == "W419")
    if pond < 0.0:
        assert result.fos.limit == pytest.approx(sk.run(WEDGE).fos.limit, rel=1e-12)


# -- many blocks ----------------------------------------------------------------------------------------------------


def section_of_blocks(water):
    """The plane failure of PLANE as a section of kind blocks: x into the slope, a fixed base under one block."""
    back = 12.0 / math.tan(math.radians(35.0))
    crest = 12.0 / math.tan(math.radians(60.0))
    return {
        "slopekit": 1,
        "kind": "blocks",
        "strength": PLANE["strength"],
        "water": water,
        "rock": {"unit_weight": 26},
        "blocks": {
            "base": {"polygon": [[0, 0], [back, 12], [back, -3], [0, -3]], "fixed": True},
            "B1": {"polygon": [[0, 0], [back, 12], [crest, 12]]},
        },
    }


@pytest.mark.parametrize(
    "water",
    [
        {"mode": "table", "points": [[0, 0], [6, 8], [12, 9]]},
        {"mode": "table", "plane": "25/180@0 m"},
    ],
    ids=str,
)
def test_blocks_have_the_water_of_the_plane(water) -> None:
    """One block on its base in a section of kind blocks is the plane failure: the same push and the same factor."""
    in_blocks = water if "points" in water else {"mode": "table", "plane": "25/270@0 m"}
    plane, blocks = sk.run({**PLANE, "water": water}), sk.run(section_of_blocks(in_blocks))
    assert blocks.forces.water["s"] == pytest.approx(plane.forces.water["J1"], rel=1e-12)
    assert blocks.fos.limit == pytest.approx(plane.fos.limit, rel=1e-7)
    assert "water table" in str(blocks.sheet)


def test_a_table_over_the_contacts_of_a_bench() -> None:
    """The water of each set is the integral over its contacts, by their corners and a rule of three points."""
    bench = {
        "slopekit": 1,
        "kind": "bench",
        "slope": {"face": "70/180", "height": "8 m", "length": "16 m"},
        "sets": {
            "S1": {"plane": "35/175", "spacing": "3 m"},
            "S2": {"plane": "80/270", "spacing": "4 m"},
        },
        "strength": {"s": {"c": 5, "phi": 30}},
        "rock": {"unit_weight": 25},
    }
    scene = kind_named("bench").cut(
        sk.load({**bench, "water": {"mode": "table", "plane": "20/180@0 m"}})
    )
    patches = scene.assembly.patches
    table = Pressure(
        (Height(np.array([0.0, math.tan(math.radians(20.0)), 0.0]), 0.0),), None, WATER
    )
    heads = patches.corners[:, 2] - patches.corners[:, 1] * math.tan(math.radians(20.0))
    checked = 0
    for k in range(len(patches)):
        head = heads[patches.first[k] : patches.first[k + 1]]
        if (head < 0.0).all():  # wholly wet: pressure at the centroid is the mean of a linear one
            at = table.pressure(patches.centroids[k][None, :])[0]
            assert scene.pressures[k] == pytest.approx(at, rel=1e-9)
            checked += 1
        elif (head > 0.0).all():
            assert scene.pressures[k] == 0.0
    assert checked > 5
    with pytest.raises(MisfitError, match="E456"):
        sk.run({**bench, "water": {"mode": "table", "plane": "0/180@20 m"}})


@pytest.mark.parametrize(
    ("water", "code"),
    [
        ({"mode": "table"}, "E454"),
        ({"points": [[0, 0], [1, 1]]}, "E454"),
        ({"mode": "table", "points": [[2, 0], [1, 1]]}, "E454"),
        ({"mode": "table", "points": [[0, 0], [1, 1]], "plane": "5/270@1m"}, "E112"),
        ({"mode": "table", "plane": "5/270@1m", "pressures": {"B1/base": 5}}, "E112"),
        ({"mode": "full"}, "E118"),
        ({"mode": "table", "depth": 3}, "E142"),
    ],
    ids=str,
)
def test_tables_that_are_none_for_blocks(water, code) -> None:
    """As for one block; blocks of any shape have no ground to lie below."""
    with pytest.raises(DesignError) as found:
        sk.load(section_of_blocks(water))
    assert code in found.value.codes
