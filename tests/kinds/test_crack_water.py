"""Water some metres deep in a wedge's crack: by hand, by quadrature on planes solved here, and as plane failure has it.

Where no tolerance has a cause of its own it is rounding.
"""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError, GeometryError
from slopekit.kinds.wedge import cut

WATER = 9.81
WEDGE = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "0/185", "height": "20 m"},
    "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "60/235"}},
    "strength": {"s": {"c": 20, "phi": 30}},
    "rock": {"unit_weight": 26},
    "crack": {"plane": "90/185", "distance": "4 m"},
}


def wet(depth, **more):
    return WEDGE | more | {"crack": WEDGE["crack"] | more.get("crack", {}) | {"water": depth}}


def normal(dip, direction):
    dip, direction = math.radians(dip), math.radians(direction)
    return np.array(
        [math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)]
    )


class ByHand:
    """The wedge of a design by the corners that three planes meet in, and its water by many small triangles."""

    def __init__(
        self, first, second, face, upper, crack, height, distance, depth, unit_weight=26.0
    ) -> None:
        planes = {
            name: normal(*map(float, plane.split("/")))
            for name, plane in {"1": first, "2": second, "f": face, "u": upper, "c": crack}.items()
        }
        offsets = dict.fromkeys("12f", 0.0)
        trace = np.cross(planes["1"], planes["f"])
        crest = trace * height / trace[2]
        offsets["u"] = planes["u"] @ crest

        def at(three):
            return np.linalg.solve(
                [planes[name] for name in three], [offsets[name] for name in three]
            )

        behind = at("12u") - crest
        offsets["c"] = planes["c"] @ (crest + behind / np.linalg.norm(behind) * distance)
        foot, tops, crests = at("12c"), [at("1uc"), at("2uc")], [at("1fu"), at("2fu")]
        level = foot[2] + depth
        toe = np.zeros(3)
        inside = (toe + foot + sum(tops) + sum(crests)) / 6.0
        self.force, self.moment = np.zeros(3), np.zeros(3)  # of the water, about the toe
        wet_to = [foot + (top - foot) * min(1.0, depth / (top[2] - foot[2])) for top in tops]
        crack = [(foot, *wet_to, depth, (0.0, 0.0))]
        joints = [
            [(foot, toe, own, depth, (0.0, 0.0)), (foot, own, edge, depth, (0.0, 0.0))]
            for own, edge in zip(crests, wet_to, strict=True)
        ]
        self.of = [self._push(part, inside) for part in (*joints, crack)]
        assert level <= min(top[2] for top in tops) + 1e-9
        volume = 0.0
        for a, b, c in (
            (toe, crests[0], crests[1]),
            (crests[0], crests[1], tops[0]),
            (crests[1], tops[0], tops[1]),
            (foot, *tops),
            (toe, foot, crests[0]),
            (foot, crests[0], tops[0]),
            (toe, foot, crests[1]),
            (foot, crests[1], tops[1]),
        ):
            volume += abs(np.linalg.det([a - inside, b - inside, c - inside])) / 6.0
        self.areas = [
            sum(
                np.linalg.norm(np.cross(b - a, c - a)) / 2.0
                for a, b, c in ((toe, foot, own), (foot, own, top))
            )
            for own, top in zip(crests, tops, strict=True)
        ]
        load = self.force + np.array([0.0, 0.0, -unit_weight * volume])
        line = foot / np.linalg.norm(foot)
        inward = [planes[k] * math.copysign(1.0, planes[k] @ inside) for k in "12"]
        # load + N1 n1 + N2 n2 + T line = 0
        pressed = np.linalg.solve(np.array([*inward, line]).T, -load)
        bond = 20.0 * sum(self.areas)
        self.factor = (bond + (pressed[0] + pressed[1]) * math.tan(math.radians(30.0))) / abs(
            pressed[2]
        )
        self.slides_on_both = min(pressed[:2]) > 0.0

    def _push(self, triangles, inside):
        """A pyramid over each triangle (peak, a, b), by 20,000 equal parts, for the sake of moments."""
        total, n = 0.0, 141
        grid = [
            (i, j, k)
            for i in range(n)
            for j in range(n - i)
            for k in (1, 2)
            if k == 1 or i + j < n - 1
        ]
        u, v = np.array([((i + k / 3.0) / n, (j + k / 3.0) / n) for i, j, k in grid]).T
        for peak, a, b, head, ends in triangles:
            square = np.cross(a - peak, b - peak)
            square = square if square @ (inside - peak) > 0.0 else -square
            pressure = WATER * (head * (1.0 - u - v) + ends[0] * u + ends[1] * v)
            pushes = pressure[:, None] * square / 2.0 / len(u)
            points = peak + u[:, None] * (a - peak) + v[:, None] * (b - peak)
            self.force += pushes.sum(axis=0)
            self.moment += np.cross(points, pushes).sum(axis=0)
            total += float(np.linalg.norm(pushes.sum(axis=0)))
        return total


CASES = [
    ("45/105", "60/235", "65/185", "0/185", "90/185", 20.0, 4.0, 3.0),
    ("45/105", "60/235", "65/185", "12/195", "80/185", 30.0, 3.0, 6.0),
    ("50/110", "48/250", "70/180", "5/180", "75/170", 15.0, 2.0, 1.0),
]


@pytest.mark.parametrize("case", CASES)
def test_force_moment_and_factor_are_those_of_the_sum_over_small_triangles(case) -> None:
    """To 1e-4: a moment by 20,000 equal parts of a triangle is off by one part in as many."""
    first, second, face, upper, crack, height, distance, depth = case
    expected = ByHand(*case)
    design = sk.load(
        wet(
            f"{depth} m",
            slope={"face": face, "upper": upper, "height": height},
            joints={"J1": {"plane": first}, "J2": {"plane": second}},
            crack={"plane": crack, "distance": distance},
        )
    )
    result = sk.run(design)
    assert expected.slides_on_both
    assert [result.forces.water[name] for name in ("J1", "J2", "crack")] == pytest.approx(
        expected.of, rel=1e-9
    )
    assert result.fos.closed_form == pytest.approx(expected.factor, rel=1e-9)
    assert result.comparisons.forces_only == pytest.approx(
        expected.factor, rel=1e-7
    )  # of the search for the limit
    acting = [
        (force, at) for name, force, at in cut(design).loads.acting if name.startswith("water")
    ]
    assert sum(np.cross(at, force) for force, at in acting) == pytest.approx(
        expected.moment, rel=1e-4, abs=1e-3
    )


@pytest.mark.parametrize("part", [0.3])
def test_below_level_ground_it_is_a_third_of_the_peak_over_the_wet_areas(part) -> None:
    """By hand: a triangle of still water has a third of its peak on its own area, which is the part squared."""
    full = sk.run(wet("full"))
    deep = full.forces.water["crack"] * 3.0 / WATER / full.geometry.areas_m2["crack"]
    found = sk.run(wet(f"{part * deep!r} m"))
    assert found.forces.water["crack"] == pytest.approx(
        part**3 * full.forces.water["crack"], rel=1e-9
    )


def test_a_full_crack_below_level_ground_is_that_of_hoek_and_bray() -> None:
    """Both methods, moments too: γ_w h₅/3 on all three with `water: full` (1981, ch. 8)."""
    full = sk.run(WEDGE | {"water": "full"})
    deep = full.forces.water["crack"] * 3.0 / WATER / full.geometry.areas_m2["crack"]
    found = sk.run(wet(f"{deep!r} m"))
    assert dict(found.forces.water) == pytest.approx(dict(full.forces.water), rel=1e-9)
    assert found.fos.closed_form == pytest.approx(full.fos.closed_form, rel=1e-9)
    assert found.fos.limit == pytest.approx(full.fos.limit, rel=1e-7)


@pytest.mark.parametrize("depth", [1.5])
def test_between_upright_sides_it_is_plane_failure(depth) -> None:
    """Sides that all but stand upright, 10 km above where they meet: to the 0.1 % that their width changes by."""
    plane = sk.run(
        {
            "slopekit": 1,
            "kind": "plane",
            "slope": {"face": "60/180", "height": 12.0},
            "joints": {"J1": {"plane": "35/180"}},
            "strength": {"s": {"c": 0, "phi": 37}},
            "rock": {"unit_weight": 26},
            "crack": {"distance": 4.0, "water": depth},
        }
    )
    wedge = sk.run(
        {
            "slopekit": 1,
            "kind": "wedge",
            "slope": {"face": "60/180", "upper": "0/180", "height": 10012.0},
            "joints": {"J1": {"plane": "89.9/90"}, "J2": {"plane": "89.9/270"}},
            "basal": {"plane": "35/180", "height": 10000.0},
            "rock": {"unit_weight": 26},
            "strength": {"s": {"c": 0, "phi": 37}},
            "crack": {"plane": "90/180", "distance": 4.0, "water": f"{depth} m"},
        }
    )
    wide = wedge.geometry.areas_m2["crack"] / plane.geometry.crack["depth_m"]
    for name, other in (("basal", "J1"), ("crack", "crack")):
        assert wedge.forces.water[name] / wide == pytest.approx(
            plane.forces.water[other], rel=1.5e-3
        )


@pytest.mark.parametrize("scale", [40.0])
def test_a_larger_wedge_without_cohesion_has_the_same_factor(scale) -> None:
    """Weight and water grow with the cube of lengths, areas with the square."""
    strength = {"s": {"c": 0, "phi": 35}}
    one = sk.run(wet("3 m", strength=strength))
    other = sk.run(
        wet(
            f"{3 * scale} m",
            strength=strength,
            slope=WEDGE["slope"] | {"height": 20 * scale},
            crack={"distance": 4 * scale},
        )
    )
    assert other.fos.closed_form == pytest.approx(one.fos.closed_form, rel=1e-9)
    assert other.fos.limit == pytest.approx(one.fos.limit, rel=1e-7)
    assert other.forces.water["crack"] == pytest.approx(
        one.forces.water["crack"] * scale**3, rel=1e-9
    )
    assert other.geometry.areas_m2["J1"] == pytest.approx(
        one.geometry.areas_m2["J1"] * scale**2, rel=1e-9
    )


def test_a_study_keeps_its_unit() -> None:
    for water, values in (("3 m", [1.0, 2.0]), ("20 kPa", [10.0, 30.0])):
        found = sk.sweep(sk.load(wet(water)), {"crack.water": values})
        unit = water.split()[1]
        each = [sk.run(wet(f"{value} {unit}")).fos.limit for value in values]
        assert [point.factors.limit for point in found.points] == pytest.approx(each, rel=1e-9)


def test_a_call_takes_it_too() -> None:
    planes = {
        "dips": ("45/105", "60/235"),
        "face": "65/185",
        "upper": "0/185",
        "height": 20,
        "unit_weight": 26,
    }
    called = sk.wedge(
        **planes, c=20, phi=30, crack={"plane": "90/185", "distance": 4, "water": "3 m"}
    )
    assert called.fos.limit == sk.run(wet("3 m")).fos.limit


@pytest.mark.parametrize(
    ("more", "code"),
    [
        (wet("3 m", water="full"), "E112"),
        (wet("3 m", water={"pressures": [5, 5]}), "E112"),
        (wet("3 m", water={"mode": "table", "depth": 2}), "E112"),
        (wet("-3 m"), "E118"),
        (wet("300 m"), "E207"),
        (wet("3"), "E118"),
        (wet("3 kg"), "E118"),
        # the basal joint cuts the line of J1 and J2 before the crack
        (wet("2 m", basal={"plane": "10/185", "height": 1.0}), "E456"),
        # J1, J2 and the crack meet inside the rock, under a basal joint that lies below the toe
        (wet("3 m", basal={"plane": "20/150", "height": -3}, crack={"plane": "85/185"}), "E232"),
    ],
)
def test_what_cannot_be_is_refused(more, code) -> None:
    with pytest.raises((DesignError, GeometryError)) as refused:
        sk.run(more)
    assert code in refused.value.codes
    assert refused.value.exit_code == (3 if code == "E232" else 2)
