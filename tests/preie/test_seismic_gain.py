"""How fast several blocks gain on shaken ground: by hand, by Goodman & Bray's recursion, by the equation of motion."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import slopekit as sk
from benchmarks.quake import rate_above
from slopekit.design.reading.files import with_values
from slopekit.design.templates import path_of
from slopekit.geometry.patches import Assembly
from slopekit.kinds import kind_of
from slopekit.kinds.assemblies.many_blocks_states import gyration

KEY = "loads.seismic.k"


def _both(design):
    """What the path in the load and the gain at it say, and the gain of the closed form."""
    kind, ends = kind_of(design), [with_values(design, {KEY: k}) for k in (0.0, 1.0)]
    at = kind.at_load(*ends, 1.0)
    return at, *(kind.seismic_gain(*ends, at, closed) for closed in (False, True))


def _column(dip: float, phi: float, cohesion: float) -> dict:
    """A slab 20 m long and 1 m high on a plane that dips west."""
    b = math.radians(dip)
    along, up = np.array([math.cos(b), math.sin(b)]), np.array([-math.sin(b), math.cos(b)])
    base = [[0, 0], (40 * along).tolist(), [40 * along[0], -5], [0, -5]]
    slab = [point.tolist() for point in (10 * along, 30 * along, 30 * along + up, 10 * along + up)]
    return {
        "slopekit": 1,
        "kind": "blocks",
        "rock": {"unit_weight": 25},
        "blocks": {"base": {"polygon": base, "fixed": True}, "B1": {"polygon": slab}},
        "strength": {"joint": {"c": cohesion, "phi": phi}},
        "loads": {"seismic": {"k": 0, "toward": 270}},
    }


@pytest.mark.parametrize(
    ("dip", "phi", "cohesion"), [(20.0, 35.0, 0.0), (35.0, 30.0, 20.0), (5.0, 60.0, 0.0)]
)
def test_one_block_on_a_plane_gains_by_cos_of_dip_less_phi_over_cos_phi(dip, phi, cohesion) -> None:
    b, f = math.radians(dip), math.radians(phi)
    _, gain, _ = _both(sk.load(_column(dip, phi, cohesion)))
    assert gain.factor == pytest.approx(math.cos(b - f) / math.cos(f), rel=1e-12)
    assert gain.first is None  # the modes have it by themselves


def test_a_column_that_tips_by_hand() -> None:
    """1 m by 2 m about its corner: I = 5/3 m, driven by k at 1 m, the centroid at √5/2 m. θ'' = 3/5 k g."""
    column = {
        "slopekit": 1,
        "kind": "blocks",
        "blocks": {
            "base": {"polygon": [[-1, -1], [3, -1], [3, 0], [-1, 0]], "fixed": True},
            "B1": {"polygon": [[0, 0], [1, 0], [1, 2], [0, 2]]},
        },
        "strength": {"joint": {"c": 0, "phi": 60}},
        "rock": {"unit_weight": 25},
        "loads": {"seismic": {"k": 0, "toward": "090"}},
    }
    at, gain, _ = _both(sk.load(column))
    assert at == pytest.approx(0.5, rel=1e-9)
    assert gain.factor == pytest.approx(0.6 * math.sqrt(5.0) / 2.0, rel=1e-9)


def test_an_active_block_pushes_a_passive_one_by_hand() -> None:
    """Four equations of the two blocks of the template, 12.5 and 50 of weight, the push Q between them level.

    B1 slides down its base at 45° with √2 times the speed at which it drives B2 along the level one; φ 30°.
    """
    t = math.tan(math.radians(30.0))
    r = math.sqrt(0.5)
    matrix = np.array(
        [
            [12.5, -r * (1 - t), 1.0, 0.0],  # level, B1: inertia, N1 less its friction, push back
            [-12.5, -r * (1 + t), 0.0, 0.0],  # up
            [50.0, 0.0, -1.0, t],  # level, B2
            [0.0, 0.0, 0.0, 1.0],  # up: N2 does not change
        ]
    )
    level = np.linalg.solve(matrix, [12.5, 0.0, 50.0, 0.0])[0]
    _, gain, _ = _both(sk.load(str(path_of("blocks"))))
    assert gain.factor == pytest.approx(level * math.sqrt(2.0), rel=1e-9)
    assert gain.block == "B1"


def _columns(seed: int) -> dict:
    rng = np.random.default_rng(seed)
    heights = rng.uniform(2.5, 9.0, int(rng.integers(3, 8))).round(2).tolist()
    return {
        "slopekit": 1,
        "kind": "topple",
        "rock": {"unit_weight": 25},
        "loads": {"seismic": {"k": 0, "toward": 270}},
        "columns": {
            "dip": float(rng.uniform(70, 85)),
            "width": float(rng.uniform(2, 3)),
            "heights": heights,
            "base_step": float(rng.uniform(0, 0.4)),
            "base": "base",
            "sides": "side",
        },
        "strength": {
            "base": {"c": 0, "phi": float(rng.uniform(32, 45))},
            "side": {"c": 0, "phi": float(rng.uniform(20, 45))},
        },
    }


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 6, 7])
def test_columns_as_goodman_and_bray_s_recursion_with_inertia(seed) -> None:
    design = sk.load(_columns(seed))
    _, ours, closed = _both(design)
    assert ours.factor == pytest.approx(closed.factor, rel=1e-10)
    assert (ours.block, ours.first) == (closed.block, None)


@pytest.mark.parametrize("name", ["topple", "blocks"])
def test_the_equation_of_motion_of_blocks_on_springs_has_that_rate(name) -> None:
    """Implicit Euler, 0.02 above k_y, no modes prescribed: its acceleration once the springs have followed."""
    design = sk.load(str(path_of(name)))
    _, gain, _ = _both(design)
    assert rate_above(design, gain.block, 0.02) == pytest.approx(gain.factor, rel=1e-9)


def test_inertia_of_blocks_in_space_and_in_a_section() -> None:
    """A box of 1 x 2 x 3 m: (b² + c²) / 12; in a section a triangle of 3 by 6 m: (3² + 6²) / 18."""
    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = np.array([half for a, b, c, d in quads for half in ((a, b, c), (a, c, d))])
    none = np.zeros((0, 3))
    box = Assembly(
        np.array([6.0]),
        np.array([[0.5, 1.0, 1.5]]),
        np.array([False]),
        None,
        False,
        corners,
        triangles,
        np.zeros(12, dtype=int),
    )
    assert gyration(SimpleNamespace(assembly=box))[0] == pytest.approx(
        np.diag([13.0, 10.0, 5.0]) / 12.0, abs=1e-12
    )
    flat = Assembly(
        np.array([9.0]),
        np.array([[1.0, 0.0, 2.0]]),
        np.array([False]),
        None,
        True,
        none,
        none,
        none,
    )
    outline = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 6.0]])
    scene = SimpleNamespace(assembly=flat, polygons=(outline,))
    assert gyration(scene)[0, 1, 1] == pytest.approx(45.0 / 18.0, rel=1e-12)


BENCH = {
    "slopekit": 1,
    "kind": "bench",
    "slope": {"face": "70/180", "height": 5, "upper": "0/180", "length": 6, "depth": 4},
    "sets": {
        "S1": {"plane": "30/175", "spacing": 2, "strength": "bedding"},
        "S2": {"plane": "85/265", "spacing": 2, "offset": 0.5, "strength": "joint"},
        "S3": {"plane": "75/350", "spacing": 2.5, "strength": "joint"},
    },
    "strength": {"bedding": {"c": 0, "phi": 42}, "joint": {"c": 0, "phi": 40}},
    "rock": {"density": 2600},
    "loads": {"seismic": {"k": 0, "toward": 180}},
}


def _bench(**changes) -> dict:
    return BENCH | {"slope": BENCH["slope"] | changes}


@pytest.mark.slow
def test_where_contacts_change_just_above_the_limit_the_factor_above_is_taken() -> None:
    """A bench whose side joint presses with next to nothing: the equation of motion never has the limit's factor."""
    design = sk.load(_bench(height=4, face="65/180"))
    found = sk.quake(design, "sine:0.3g,2Hz")
    ours = found.yields[0]
    assert abs(ours.first_factor / ours.factor - 1.0) > 0.02
    assert rate_above(design, ours.factor_of, 0.0023) == pytest.approx(ours.factor, rel=0.01)
    assert [notice.code for notice in found.warnings] == ["W462", "W338"]


@pytest.mark.slow
def test_a_motion_whose_modes_are_not_of_one_motion_has_no_factor_and_says_so() -> None:
    found = sk.quake(sk.load(_bench(length=8)), "sine:0.3g,2Hz")
    ours = found.yields[0]
    assert ours.coefficient == pytest.approx(0.25234, rel=1e-3)
    assert ours.factor is None
    assert [notice.code for notice in found.warnings] == ["W462", "W312", "W338"]
