"""Joints drawn from sets: scatter, strengths, spacings against scipy and Fisher's formula; what a file may not say."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

from slopekit.core.errors import DesignError
from slopekit.core.orientation import Plane
from slopekit.studies.bench_design.drawn import joints_of_sets
from tests.commands import slopekit

SETS: dict[str, Any] = {
    "A": {"plane": "50/150", "scatter": 9, "spacing": 2, "phi": {"dist": "normal", "mean": 30, "sd": 3}},
    "B": {"plane": {"dist": "fisher", "mean": "60/220", "k": 60}, "spacing": "4 m", "spacing_scatter": "50 %"},
    "C": {"plane": {"dip": {"dist": "normal", "mean": 75, "sd": 4}, "dip_direction": 5}, "spacing": 4, "c": "5 kPa"},
}


def of(name: str) -> list[Any]:
    return [joint for joint in joints_of_sets({"sets": SETS}, 3, 4000).joints if joint.set_name == name]


def test_sets_are_met_by_their_spacings() -> None:
    """1/2 : 1/4 : 1/4."""
    assert [len(of(name)) for name in "ABC"] == [2000, 1000, 1000]


@pytest.mark.parametrize(("name", "k"), [("A", 2.0 / np.radians(9.0) ** 2), ("B", 60.0)])
def test_planes_scatter_as_fisher_says(name: str, k: float) -> None:
    """K (1 - cos θ) about the mean is exponential (Fisher 1953, K large): Kolmogorov & Smirnov, p above 1e-3."""
    drawn = of(name)
    mean = Plane(*{"A": (50.0, 150.0), "B": (60.0, 220.0)}[name]).normal()
    gaps = np.array([1.0 - abs(joint.plane.normal() @ mean) for joint in drawn])
    assert stats.kstest(k * gaps, "expon").pvalue > 1e-3
    assert stats.kstest(1.3 * k * gaps, "expon").pvalue < 1e-3


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("A", "friction_angle_deg", stats.norm(30.0, 3.0)),
        ("B", "spacing_m", stats.lognorm(np.sqrt(np.log(1.25)), scale=4.0 / np.sqrt(1.25))),
    ],
)
def test_numbers_scatter_as_asked(name: str, value: str, expected: Any) -> None:
    """Mean 4 m and half of it as sd is a lognormal with σ² = ln 1.25 of its logarithm."""
    drawn = np.array([getattr(joint, value) for joint in of(name)])
    assert stats.kstest(drawn, expected.cdf).pvalue > 1e-3
    assert stats.kstest(drawn * 1.1, expected.cdf).pvalue < 1e-3


def test_fixed_numbers_and_the_other_angle_stay() -> None:
    drawn = of("C")
    assert {joint.cohesion_kpa for joint in drawn} == {5.0}
    assert {joint.plane.dip_direction_deg for joint in drawn if joint.plane.dip_direction_deg < 90.0} == {5.0}
    assert np.isclose(np.std([joint.plane.dip_deg for joint in drawn]), 4.0, rtol=0.1)


def test_a_plane_of_joints_comes_before_that_of_sets() -> None:
    both = {"sets": {"A": {"plane": "20/090", "spacing": 2}}, "joints": {"A": {"plane": "50/150"}}}
    first = joints_of_sets(both, 1, 10).joints[0]
    assert (first.plane.dip_deg, first.spacing_m) == (50.0, 2.0)


def test_the_seed_and_nothing_else_decides() -> None:
    one, same, other = (joints_of_sets({"sets": SETS}, seed, 50).rows() for seed in (1, 1, 2))
    assert one == same != other


@pytest.mark.parametrize(
    ("block", "codes"),
    [
        ("slope: {height: 3}", {"E190"}),
        ("sets: {A: {plane: 50/150, spacings: 2}}", {"E142"}),
        ("sets: {A: {spacing: 2}, B: {plane: 95/150}}", {"E143", "E101"}),
        ("sets: {A: {plane: 50/150, phi: 95}}", {"E281"}),
        ("sets: {A: {plane: 50/150, c: {dist: normal, mean: 5, sd: 5}}}", {"E281"}),
        ("sets: {A: {plane: 50/150, trace: {dist: uniform, min: -1, max: 5}}}", {"E281"}),
        ("sets: {A: {plane: 50/150, phi: {dist: norm, mean: 5, sd: 5}}}", {"E165"}),
        ("sets: {A: 50/150}", {"E143"}),
        ("sets: [50/150]", {"E190"}),
    ],
)
def test_what_a_file_may_not_say(block: str, codes: set[str], tmp_path: Path) -> None:
    path = tmp_path / "sets.yaml"
    path.write_text(block + "\n", encoding="utf-8")
    with pytest.raises(DesignError) as caught:
        joints_of_sets(path, 1)
    assert {fault.code for fault in caught.value.faults} == codes


def test_the_command(tmp_path: Path) -> None:
    """What `slopekit sets` writes is taken as it is."""
    path = tmp_path / "sets.yaml"
    path.write_text("sets:\n  S1: {plane: 54.8/142.4, spacing: 2.01 m, scatter: 11.3}\n"
                    "  S2: {plane: 61.6/225.6, spacing: 2.53 m, scatter: 13.5}\n", encoding="utf-8")  # fmt: skip
    ran = slopekit(
        "bench-design", str(path), "--height", "15", "--face", "70", "--dip-direction", "180", "--c", "2", "--phi",
        "32", "-n", "500", "--confirm", "0", "--near", "0",
    )  # fmt: skip
    assert ran.returncode == 0
    assert "1000 joints drawn of 2 sets" in " ".join(ran.stdout.split())


def test_sets_that_do_not_scatter_are_few_joints_however_many_are_drawn(tmp_path: Path) -> None:
    """W390: 1,000 joints of two planes are two joints; sets with a scatter are as many as are drawn."""
    (tmp_path / "alike.yaml").write_text("sets:\n  A: {plane: 50/150}\n  B: {plane: 60/220}\n")
    (tmp_path / "apart.yaml").write_text("sets:\n  A: {plane: 50/150, scatter: 5}\n  B: {plane: 60/220}\n")
    bench = ["--height", "10", "--face", "65", "--dip-direction", "180", "--c", "1", "--phi", "30", "-n", "100",
             "--confirm", "0", "--near", "0"]  # fmt: skip
    said = [slopekit("bench-design", str(tmp_path / name), *bench).stdout for name in ("alike.yaml", "apart.yaml")]
    assert "W390 alike.yaml holds 1000 joints in 2 orientations, as its sets do not scatter" in " ".join(
        said[0].split()
    )
    assert "W390" not in said[1]
