"""`slopekit prob --survey`: joints of a wedge from a survey, against every pair of it (`combos`) and its resampling."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.design.reading.files import load
from tests.commands import slopekit

ROOT = Path(__file__).parents[2]
LIST = str(ROOT / "examples" / "joints.csv")
PLAIN = """slopekit: 1
kind: wedge
slope: {face: 65/180, upper: 0/180, height: 15 m}
joints: {J1: {plane: 45/115}, J2: {plane: 45/245}}
strength: {weak: {c: 10 kPa, phi: 30}}
rock: {density: 2600 kg/m3}
"""


@pytest.fixture
def wedge(tmp_path):
    path = tmp_path / "wedge.yaml"
    path.write_text(PLAIN, encoding="utf-8")
    return load(path)


@pytest.fixture(scope="module")
def joints():
    """The survey without the friction angles of its own, which combos would take."""
    listed = sk.sets(LIST).joints.joints
    return [replace(joint, friction_angle_deg=None) for joint in listed]


def test_against_every_pair(wedge, joints) -> None:
    """All 2016 pairs of combos: the shares that form and fail lie within the limits of the samples (99.9 %)."""
    every = sk.combos(joints, face="65/180", upper="0/180", height=15, c=10, phi=30, top=0)
    forms, fails = every.pairs.is_removable, every.pairs.fails(1.3)
    found = sk.prob(wedge, 8000, target=1.3, confirm=0, near=0, confidence=0.999, survey=joints).survey
    assert found is not None
    assert found.occurrence.low < forms.mean() < found.occurrence.high
    assert found.failure.low < fails.sum() / forms.sum() < found.failure.high
    assert found.both.low < fails.mean() < found.both.high
    assert found.both.share == pytest.approx(found.occurrence.share * found.failure.share)


def test_limits_by_resampling(wedge, joints) -> None:
    """Resampled surveys over the whole table of pairs give the same limits, but for the noise of either."""
    every = sk.combos(joints, face="65/180", upper="0/180", height=15, c=10, phi=30, top=0)
    table = np.zeros((len(joints), len(joints)))
    first, second = every.joints.pairs()
    table[first, second] = every.pairs.is_removable
    table += table.T
    times = np.random.default_rng(4).multinomial(len(joints), np.full(len(joints), 1 / len(joints)), 2000)
    pairs = (times.sum(axis=1) ** 2 - (times**2).sum(axis=1)).astype(float)
    low, high = np.quantile(np.einsum("bi,ij,bj->b", times, table, times) / pairs, [0.025, 0.975])
    found = sk.prob(wedge, 8000, confirm=0, near=0, survey=joints).survey
    assert found is not None
    assert found.resampled is not None
    assert (found.resampled[0].low, found.resampled[0].high) == pytest.approx((low, high), abs=0.02)


def test_the_command_and_what_it_says(tmp_path) -> None:
    template = str(ROOT / "templates" / "wedge-scatter.yaml")
    run = slopekit("prob", template, "--survey", LIST, "-n", "300", "--confirm", "3", "--near", "0.1%", "--json")
    assert run.returncode == 0, run.stderr
    document = json.loads(run.stdout)
    assert document["survey"]["times"] == 400
    both = document["probability_of_failure"]["all_samples"]["probability"]
    assert document["survey"]["both"]["probability"] == both
    assert "forms a wedge" in " ".join(map(str, document["sheet"]["SURVEY"]))
    again = slopekit("prob", template, "--survey", LIST, "-n", "300", "--confirm", "3", "--near", "0.1%", "--json")
    assert json.loads(again.stdout)["survey"] == document["survey"]


def test_bad_input_is_refused(wedge, tmp_path) -> None:
    def refused(design, **given):
        with pytest.raises(DesignError) as caught:
            sk.prob(design, 100, **({"survey": LIST} | given))
        return caught.value.codes

    plane = load(ROOT / "templates" / "plane.yaml")
    assert refused(plane, method="sobol") == ("E288", "E126")
    assert refused(wedge, survey=["45/115"]) == ("E190",)
    path = tmp_path / "linked.yaml"
    scatter = "{plane: {dip: {dist: normal, mean: 45, sd: 2}, dip_direction: 115}}"
    text = PLAIN.replace("{plane: 45/115}", scatter).replace("phi: 30", "phi: {dist: normal, mean: 30, sd: 2}")
    path.write_text(text + "correlation: {J1.plane.dip/weak.phi: 0.5}\n", encoding="utf-8")
    assert refused(load(path)) == ("E167",)
