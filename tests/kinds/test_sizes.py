"""How large it is what fails, and limits of size.

Independent sources: `closed_form.sizes` (corners by vectors, nothing shared with the cut body) for wedges and corners
of blocks, the divergence theorem for volumes; similarity (all lengths by s: areas s², volumes s³, and with
c = 0 and no water the same factor of safety).
"""

import math
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.closed_form.sizes import wedge_sizes
from slopekit.core.errors import DesignError, GeometryError
from slopekit.design.templates import folder
from slopekit.findings import AssemblyGeometry
from slopekit.kinds.assemblies.many_blocks_states import sizes_of_blocks
from slopekit.kinds.bench import BenchDesign
from slopekit.kinds.bench import cut as cut_bench
from slopekit.kinds.wedge import cut
from slopekit.kinds.wedge.design import wedge_design
from slopekit.kinds.words import short
from slopekit.result import Result
from slopekit.views.solid.scenes import dimensions
from slopekit.views.solid.stage import Stage
from tests.closed_form.extents import block_extents

CUT = 1e-8  # manifold rounds to 1e-12 of the body; a thin wedge loses some digits
WEDGE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/185", "upper": "12/195", "height": 30},
    "joints": {"A": {"plane": "45/105"}, "B": {"plane": "70/235"}},
    "strength": {"joint": {"c": 0, "phi": 35}},
    "rock": {"unit_weight": 25},
}


def limited(**limits: Any) -> Result:
    """The wedge with limits of size."""
    return sk.run(WEDGE | {"limits": limits})


def faults(run: Any, **limits: Any) -> list[str]:
    """Codes of the faults that a wedge with limits has."""
    with pytest.raises((DesignError, GeometryError)) as raised:
        run(**limits)
    return [fault.code for fault in raised.value.faults]


def sized(planes: Any, height: float) -> Any:
    """The geometry of a wedge by eight angles: joints, face, upper slope."""
    plane = [f"{planes[k]:.6f}/{planes[k + 1]:.6f}" for k in range(0, 8, 2)]
    given = {"dips": (plane[0], plane[1]), "face": plane[2], "upper": plane[3], "height": height}
    return cut(wedge_design(given)).geometry()


# -- one block --------------------------------------------------------------------------------------------------------


def test_random_wedges_have_the_sizes_of_their_corners() -> None:
    """30 wedges: height, width, setback and the four traces by vectors; setback and height by the corners too."""
    rng = np.random.default_rng(11)
    low, high = [30, 60, 30, 180, 55, 140, 0, 130], [80, 170, 80, 300, 89, 220, 15, 230]
    seen = 0
    while seen < 30:
        planes = rng.uniform(low, high).round(6)
        height = float(rng.uniform(5, 40))
        own = wedge_sizes(*planes, height)
        if not 1.0 < own.volume_m3[0] < 1e6:
            continue
        try:
            found = sized(planes, height)
        except GeometryError:
            continue
        seen += 1
        wanted = {
            "height_m": own.height_m,
            "face_width_m": own.face_width_m,
            "setback_m": own.setback_m,
        }
        for key, value in wanted.items():
            assert getattr(found, key) == pytest.approx(float(value[0]), rel=CUT), key
        traces = found.trace_lengths_m
        for joint, face, upper in (
            ("J1", own.trace1_m, own.upper_trace1_m),
            ("J2", own.trace2_m, own.upper_trace2_m),
        ):
            assert traces[joint]["face"] == pytest.approx(float(face[0]), rel=CUT)
            assert traces[joint]["upper"] == pytest.approx(float(upper[0]), rel=CUT)
    assert seen == 30


def test_a_level_crest_by_the_corners_of_the_block() -> None:
    """Under a level slope `block_extents` has setback and height, with a basal joint and a crack."""
    result = sk.run(folder() / "wedge-basal.yaml", set={"slope.upper": "0/180"})
    geometry, design = result.geometry, result.design
    corners = np.concatenate(list(geometry.faces_m.values()))
    own = block_extents(corners, design.face.dip_direction_deg, geometry.corners_m["crest_J1"])
    assert geometry.setback_m == pytest.approx(own.setback_m, rel=CUT)
    assert geometry.height_m == pytest.approx(own.height_m, rel=CUT)
    assert result.mass_t == pytest.approx(
        geometry.volume_m3 * design.rock.unit_weight_kn_m3 / 9.81, rel=1e-9
    )


@pytest.mark.parametrize("scale", [0.1, 3.0])
def test_sizes_scale_and_the_factor_does_not(scale: float) -> None:
    """c = 0 and dry: lengths by s, areas s², weight s³, the same factor by both methods."""
    one, other = sk.run(WEDGE), sk.run(WEDGE, set={"slope.height": 30 * scale})
    assert other.fos.limit == pytest.approx(one.fos.limit, rel=1e-6)
    assert other.fos.closed_form == pytest.approx(one.fos.closed_form, rel=1e-12)
    for key in ("height_m", "face_width_m", "setback_m"):
        assert getattr(other.geometry, key) == pytest.approx(
            scale * getattr(one.geometry, key), rel=CUT
        )
    for joint, traces in one.geometry.trace_lengths_m.items():
        for where, length in traces.items():
            assert other.geometry.trace_lengths_m[joint][where] == pytest.approx(
                scale * length, rel=CUT
            )
        assert other.geometry.areas_m2[joint] == pytest.approx(
            scale**2 * one.geometry.areas_m2[joint], rel=CUT
        )
    assert other.forces.weight == pytest.approx(scale**3 * one.forces.weight, rel=CUT)
    assert other.mass_t == pytest.approx(scale**3 * one.mass_t, rel=CUT)


def test_a_plane_by_hoek_and_bray() -> None:
    """b = H (cot ψp - cot ψf) / (1 - tan ψs cot ψp) without a crack, the distance of the crack with one."""
    whole = sk.run(
        {
            "slopekit": 1,
            "kind": "plane",
            "slope": {"face": "60/180", "height": 12, "upper": "5/180"},
            "joints": {"J1": {"plane": "35/180"}},
            "strength": {"joint": {"c": 5, "phi": 30}},
            "rock": {"unit_weight": 26},
        }
    )
    face, joint, upper = (math.tan(math.radians(dip)) for dip in (60, 35, 5))
    setback = 12 * (1 / joint - 1 / face) / (1 - upper / joint)
    assert whole.geometry.setback_m == pytest.approx(setback, rel=1e-12)
    assert whole.geometry.height_m == pytest.approx(12 + setback * upper, rel=1e-12)
    assert whole.geometry.face_width_m is None
    cracked = sk.run(folder() / "plane.yaml")
    assert cracked.geometry.setback_m == pytest.approx(cracked.geometry.crack_distance_m, rel=1e-9)
    table = cracked.tables()["result"]
    assert [column.of(cracked) for column in table.columns if column.key == "setback_m"] == [
        cracked.geometry.setback_m
    ]


# -- many blocks ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def bench() -> Result:
    return sk.run(
        folder() / "bench.yaml", set={"slope.length": 14, "slope.depth": 9, "slope.height": 8}
    )


@pytest.mark.slow
def test_a_mechanism_has_the_sizes_of_its_blocks(bench: Result) -> None:
    """Volume by the divergence theorem, mass, height, width and setback by the corners: what moves, random blocks."""
    design, geometry = bench.design, bench.geometry
    assert isinstance(geometry, AssemblyGeometry)
    assert isinstance(design, BenchDesign)
    assert bench.findings is not None
    first, scene = bench.findings.first, cut_bench(design)
    a, b, c = (geometry.vertices_m[geometry.triangles[:, k]] for k in range(3))
    volume = np.bincount(
        geometry.triangle_block, (a * np.cross(b, c)).sum(axis=1) / 6.0, len(geometry.names)
    )
    index = {name: k for k, name in enumerate(geometry.names)}
    behind = math.tan(math.radians(90 - design.face.dip_deg)) * design.height_m
    to = math.radians(design.face.dip_direction_deg)
    crest = np.array([-math.sin(to) * behind, -math.cos(to) * behind, design.height_m])
    rng, assembled = np.random.default_rng(5), len(geometry.names)
    made = [rng.choice(assembled, count, replace=False) for count in (1, 1, 2, 5, 20)]
    sizes = [(own, sizes_of_blocks(own, scene, design.rock.gravity_m_s2)) for own in made]
    setbacks = []
    for own, size in ((np.array([index[name] for name in first.blocks]), first.size), *sizes):
        corners = geometry.vertices_m[
            geometry.triangles[np.isin(geometry.triangle_block, own)].ravel()
        ]
        extents = block_extents(corners, design.face.dip_direction_deg, crest)
        assert size is not None
        assert size.volume_m3 == pytest.approx(float(volume[own].sum()), rel=1e-9)
        assert size.mass_t == pytest.approx(
            float(volume[own].sum()) * design.rock.unit_weight_kn_m3 / 9.81, rel=1e-9
        )
        assert size.height_m == pytest.approx(extents.height_m, rel=1e-9)
        assert size.setback_m == pytest.approx(extents.setback_m, abs=1e-9)
        assert size.face_width_m is not None
        assert size.face_width_m <= extents.face_width_m * (1 + 1e-9)
        setbacks.append(extents.setback_m)
    assert max(setbacks) > 1.0 > min(setbacks)


def test_the_result_of_many_blocks_says_it(bench: Result) -> None:
    """JSON, the sheet and the table have the first mechanism's size."""
    assert bench.findings is not None
    first, document = bench.findings.first.size, bench.to_dict()
    assert first is not None
    assert document["mechanism"]["volume_m3"] == first.volume_m3
    assert document["mechanisms"][0]["setback_m"] == first.setback_m
    assert "critical block or group: height" in " ".join(str(bench.sheet).split())
    assert bench.size == first


def test_a_bench_that_one_wedge_leaves_is_that_wedge() -> None:
    """Two sets with one plane each in the bench: the traces, width and setback of the block are those of kind wedge."""
    bench = sk.run(
        {
            "slopekit": 1,
            "kind": "bench",
            "slope": {"face": "70/180", "height": 10, "upper": "0/180", "length": 80, "depth": 40},
            "sets": {
                "J1": {"plane": "50/130", "spacing": 500},
                "J2": {"plane": "55/235", "spacing": 500},
            },
            "strength": {"joint": {"c": 0, "phi": 25}},
            "rock": {"unit_weight": 25},
        }
    )
    wedge = sk.wedge(
        dips=("50/130", "55/235"),
        face="70/180",
        upper="0/180",
        height=10,
        c=0,
        phi=25,
        unit_weight=25,
    )
    size, geometry = bench.size, wedge.geometry
    assert size is not None
    for key in ("volume_m3", "height_m", "face_width_m", "setback_m"):
        assert getattr(size, key) == pytest.approx(getattr(geometry, key), rel=1e-6), key
    for joint in ("J1", "J2"):
        assert size.trace_lengths_m[joint] == pytest.approx(
            geometry.trace_lengths_m[joint], rel=1e-6
        )


def test_dimension_lines_are_as_long_as_their_numbers(bench: Result) -> None:
    """Of a wedge and of a mechanism: each line has its length, and begins or ends at the block."""
    for result in (sk.run(WEDGE), bench):
        stage = Stage.from_document(result.to_dict())
        found = {text.split()[0]: (text, start, end) for text, start, end, _ in dimensions(stage)}
        assert result.size is not None
        for name, key in (
            ("setback", "setback_m"),
            ("width", "face_width_m"),
            ("height", "height_m"),
        ):
            if getattr(result.size, key):
                (text, start, end), length_m = found.pop(name), getattr(result.size, key)
                assert float(np.linalg.norm(end - start)) == pytest.approx(length_m, rel=1e-4)
                assert text == f"{name} {short(length_m)} m"
        assert not found


# -- limits -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limits", "key", "by"),
    [
        ({"bench_width": 6}, "setback", "bench width"),
        ({"slope_length": 5}, "width", "slope length"),
        ({"max_volume": 50}, "volume", "max volume"),
        ({"trace_length": {"A": 4}}, "trace A", "trace length"),
        ({"trace_length": 5}, "trace", "trace length"),
        ({"persistence": {"B": 7}}, "edge B", "persistence"),
        ({"persistence": [20, 7], "bench_width": 40}, "edge B", "persistence"),
    ],
)
def test_a_scaled_wedge_meets_its_limit(limits: dict[str, Any], key: str, by: str) -> None:
    """The cut block has just the size of the limit that it is said to meet; dry and with c = 0 F stays."""
    result, whole = limited(**limits), sk.run(WEDGE)
    geometry = result.geometry
    traces = {name: max(own.values()) for name, own in geometry.trace_lengths_m.items()}
    measured = {
        "setback": geometry.setback_m,
        "width": geometry.face_width_m,
        "volume": geometry.volume_m3,
        "trace A": traces["J1"],
        "trace": max(traces.values()),
        "edge B": max(traces["J2"], geometry.line_length_m),
    }[key]
    first = next(iter(limits.values()))
    wanted = (
        first
        if isinstance(first, int)
        else first[-1]
        if isinstance(first, list)
        else next(iter(first.values()))
    )
    assert measured == pytest.approx(wanted, rel=CUT)
    scaled = geometry.scaled
    assert scaled["by"] == by
    assert geometry.volume_m3 == pytest.approx(
        scaled["factor"] ** 3 * whole.geometry.volume_m3, rel=CUT
    )
    assert (result.fos.limit, result.fos.closed_form) == pytest.approx(
        (whole.fos.limit, whole.fos.closed_form), 1e-6
    )
    assert f"made smaller by the limit of {by}" in " ".join(str(result.sheet).split())


def test_limits_that_a_wedge_meets_change_nothing() -> None:
    """Numbers and hash of the inputs apart from the limits themselves."""
    result, whole = limited(bench_width=1000, persistence=500), sk.run(WEDGE)
    assert (result.fos, result.geometry.volume_m3) == (whole.fos, whole.geometry.volume_m3)
    assert result.geometry.scaled["by"] is None
    assert "limits" not in whole.design.inputs()
    assert "within its limits of size: persistence 500 m, bench width 1000 m" in " ".join(
        str(result.sheet).split()
    )


def test_the_smallest_of_several_wedges_counts() -> None:
    """As in SWedge: of several limits the one that leaves the smallest wedge."""
    each = [{"bench_width": 6}, {"slope_length": 5}, {"max_volume": 50}, {"trace_length": 5}]
    factors = [limited(**one).geometry.scaled["factor"] for one in each]
    together: dict[str, Any] = {}
    for one in each:
        together |= one
    assert limited(**together).geometry.scaled["factor"] == min(factors)


def test_a_filtered_wedge_is_none() -> None:
    """E486 larger than a limit, E487 smaller than the least volume."""
    assert faults(limited, bench_width=6, by="filter") == ["E486"]
    assert faults(limited, bench_width=6, min_volume=1000) == ["E487"]
    assert limited(bench_width=600, by="filter").geometry.scaled["factor"] == 1.0


@pytest.mark.parametrize(
    ("limits", "codes"),
    [
        ({"bench_width": 0}, ["E116"]),
        ({"min_volume": 5, "max_volume": 2}, ["E116"]),
        ({"trace_length": {"A": -1}}, ["E116"]),
        ({"trace_length": {"C": 1}}, ["E197"]),
        ({"persistence": [1, 2, 3]}, ["E109"]),
        ({"by": "cut"}, ["E126"]),
        ({"bench_width": "6 kPa"}, ["E107"]),
        ({"by": "cut", "slope_length": -2, "persistence": {"J1": 4}}, ["E116", "E126", "E197"]),
        ({"width": 3}, ["E142"]),
        (5, ["E144"]),
        ({"trace_length": {"A": "long"}}, ["E106"]),
    ],
)
def test_limits_that_are_none_are_refused(limits: Any, codes: list[str]) -> None:
    """All faults at once, each with its code."""
    with pytest.raises(DesignError) as raised:
        sk.load(WEDGE | {"limits": limits})
    assert sorted(fault.code for fault in raised.value.faults) == sorted(codes)


def test_limits_and_what_bounds_the_wedge_exclude_each_other() -> None:
    """E112 beside a crack or a basal joint."""
    for other in (
        {"crack": {"plane": "80/185", "distance": 3}},
        {"basal": {"plane": "20/185", "height": 4}},
    ):
        with pytest.raises(DesignError) as raised:
            sk.load(WEDGE | other | {"limits": {"bench_width": 6}})
        assert [fault.code for fault in raised.value.faults] == ["E112"]


def test_points_are_from_the_toe_of_the_smaller_wedge() -> None:
    """W435 where a force has a point and the wedge is made smaller, and not where it is as it was."""
    force = {"loads": {"forces": [{"force": "1 kN", "toward": "180/00", "at": [0, 0.2, 0.4]}]}}
    for width, codes in ((6, 1), (600, 0)):
        result = sk.run(WEDGE | force | {"limits": {"bench_width": width}})
        assert sum(notice.code == "W435" for notice in result.warnings) == codes
