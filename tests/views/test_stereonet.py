"""The stereonet against mplstereonet (an independent program), and its zones and curves against the criteria."""

import math

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.orientation import Line, Plane, normals
from slopekit.studies.kinematic.criteria import planes_of_poles, zones_of_lines, zones_of_poles
from slopekit.views.charts.stereonet import (
    cone,
    daylight_envelope,
    great_circle,
    lower,
    project,
    small_circle,
    unproject,
)

EXACT = 1e-9  # of the net's radius: issue 7
RNG = np.random.default_rng(20260722)
DIPS, DIRECTIONS = RNG.uniform(0.0, 90.0, 1000), RNG.uniform(0.0, 360.0, 1000)


@pytest.fixture(scope="module")
def oracle():
    """mplstereonet, and points of its nets: (longitude, latitude) in radians to (n, 2) of a net of radius 1."""
    pytest.importorskip("matplotlib")
    module = pytest.importorskip("mplstereonet")
    from mplstereonet.stereonet_transforms import LambertTransform

    def points(longitude, latitude):
        transform = LambertTransform(0.0, 0.0, 1)
        flat = np.column_stack([np.ravel(longitude), np.ravel(latitude)])
        radius = transform.transform(np.array([[math.pi / 2.0, 0.0]]))[0, 0]
        return transform.transform(flat) / radius

    return module, points


def test_poles_and_lines(oracle) -> None:
    """1,000 planes as poles, and the same angles as trend and plunge of lines."""
    module, points = oracle
    expected = points(*module.stereonet_math.pole(DIRECTIONS - 90.0, DIPS))
    assert np.abs(project(normals(DIPS, DIRECTIONS)) - expected).max() < EXACT
    expected = points(*module.stereonet_math.line(DIPS, DIRECTIONS))
    lines = np.array(
        [Line(trend, plunge).vector() for trend, plunge in zip(DIRECTIONS, DIPS, strict=True)]
    )
    assert np.abs(project(lines) - expected).max() < EXACT


def test_great_circles(oracle) -> None:
    """Nineteen points of each of 1,000 great circles, from one end of the strike to the other."""
    module, points = oracle
    longitude, latitude = module.stereonet_math.plane(
        DIRECTIONS - 90.0, DIPS, segments=19
    )  # (19, 1000)
    worst = 0.0
    for k, (dip, direction) in enumerate(zip(DIPS, DIRECTIONS, strict=True)):
        own = project(great_circle(Plane(dip, direction), 19))
        other = points(longitude[:, k], latitude[:, k])
        worst = max(worst, min(np.abs(own - other).max(), np.abs(own - other[::-1]).max()))
    assert worst < EXACT


def test_cones(oracle) -> None:
    """Small circles about 200 lines: each point of mplstereonet's is ours at the same turn about the axis."""
    module, points = oracle
    worst = 0.0
    for plunge, trend, angle in zip(
        DIPS[:200], DIRECTIONS[:200], RNG.uniform(1.0, 89.0, 200), strict=True
    ):
        longitude, latitude = (
            found[0] for found in module.stereonet_math.cone(plunge, trend, angle, segments=24)
        )
        x, y, z = module.stereonet_math.sph2cart(
            longitude, latitude
        )  # x down at the middle of the net, y east, z north
        theirs = np.column_stack([y, z, -x])
        axis = Line(trend, plunge).vector()
        up, side = (cone(axis, 90.0, np.array([turn]))[0] for turn in (0.0, math.pi / 2.0))
        ours = cone(axis, angle, np.arctan2(theirs @ side, theirs @ up))
        worst = max(worst, np.abs(ours - theirs).max())
        below = theirs[:, 2] < -1e-6
        drawn = project(ours[below]) - points(longitude[below], latitude[below])
        worst = max(worst, np.abs(drawn).max(initial=0.0))
    assert worst < EXACT


def test_back_from_the_net() -> None:
    """`unproject` gives the downward vector back; its radius is known: 60° from the vertical."""
    down = lower(normals(DIPS, DIRECTIONS))
    assert unproject(project(down)) == pytest.approx(down, abs=1e-12)
    at = project(Line(90.0, 30.0).vector()[None])[0]
    expected = math.sqrt(2.0) * math.sin(math.radians(30.0))
    assert at == pytest.approx([expected, 0.0], abs=1e-15)


@pytest.mark.parametrize(
    ("trend", "plunge", "angle", "arcs"),
    [(70, 60, 25, 1), (70, 10, 25, 2), (70, 0, 90, 2), (0, 90, 30, 1)],
)
def test_a_cone_is_cut_at_the_horizon(trend, plunge, angle, arcs) -> None:
    """All arcs lie at the angle from the axis or its opposite, none above the horizon; two arcs end on the horizon."""
    axis = Line(trend, plunge).vector()
    found = small_circle(axis, angle)
    assert len(found) == arcs
    for part in found:
        assert np.abs(part @ axis) == pytest.approx(math.cos(math.radians(angle)), abs=1e-12)
        assert part[:, 2].max() <= 1e-12
        assert np.linalg.norm(part, axis=1) == pytest.approx(1.0, abs=1e-12)
    if arcs == 2:
        assert [abs(part[end, 2]) for part in found for end in (0, -1)] == pytest.approx(
            [0.0] * 4, abs=1e-12
        )


@pytest.mark.parametrize("face", [Plane(65, 180), Plane(30, 20), Plane(89, 300)])
def test_the_daylight_envelope_bounds_what_daylights(face) -> None:
    """A pole a little within the curve daylights by the criterion (friction 0, no limits), a little outside not."""
    curve = daylight_envelope(face, 101)[10:-10]
    assert (-curve[:, 2]).min() > 0.0
    planes = planes_of_poles(curve)
    dip_vectors = np.array(
        [
            Line(direction, dip).vector()
            for dip, direction in zip(planes.dips_deg, planes.dip_directions_deg, strict=True)
        ]
    )
    assert np.abs(dip_vectors @ face.normal()).max() < 1e-12  # the dip vector lies in the face
    middle = -Plane(0.4 * face.dip_deg, face.dip_direction_deg).normal()
    for step, daylights in ((1e-4, True), (-1e-4, False)):
        near = curve + step * (middle - curve)
        near /= np.linalg.norm(near, axis=1)[:, None]
        assert (
            zones_of_poles(near, face, 0.0, 90.0, 90.0)["planar_without_limits"] == daylights
        ).all()


def test_zones_are_the_criteria_of_joints() -> None:
    """A zone holds at a direction just where a survey of joints with these poles is critical, and lines likewise."""
    face = Plane(65.0, 180.0)
    some = slice(0, 60)
    found = sk.kinematic(
        list(zip(DIPS[some], DIRECTIONS[some], strict=True)), face="65/180", phi=30
    )
    zones = zones_of_poles(-normals(DIPS[some], DIRECTIONS[some]), face, 30.0, 20.0, 30.0)
    for kind, critical in found.modes.of_joints().items():
        assert (zones[kind] == critical).all(), kind
    lines, of_lines = (
        zones_of_lines(found.lines.down, face, 30.0, 20.0, 30.0),
        found.modes.of_lines(),
    )
    assert (lines["wedge_primary"] == of_lines["wedge_primary"]).all()
    assert (lines["wedge_secondary_of_dips"] == found.modes.secondary_of_dips).all()
    assert (lines["direct"] == of_lines["direct"]).all()
    assert (lines["oblique"] == of_lines["oblique"]).all()
    assert min(of_lines[kind].sum() for kind in ("wedge_primary", "direct", "oblique")) > 0
