"""`slopekit sets`: statistics against SciPy and mplstereonet, clusters of drawn sets, and what a survey may hold."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import vonmises_fisher

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Line, normals
from slopekit.design.reading.files import load
from slopekit.studies.axes import axes_of, cone_of, terzaghi_weights
from slopekit.studies.sets.clustering import clusters_of, least_bic
from slopekit.studies.sets.density import density
from tests.commands import slopekit

LIST = str(Path(__file__).parents[2] / "examples" / "joints.csv")
TEMPLATES = Path(__file__).parents[2] / "templates"
#: Dip, dip direction, K and number of joints of drawn sets.
THREE = ((45, 120, 40, 40), (80, 20, 40, 30), (60, 270, 25, 25))


def drawn(rng: np.random.Generator, sets=THREE, anywhere: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Poles of drawn sets, and the set that each is of (-1: anywhere)."""
    parts = [
        vonmises_fisher(normals(np.array(dip), np.array(way)), k).rvs(n, random_state=rng)
        for dip, way, k, n in sets
    ]
    loose = rng.normal(size=(anywhere, 3))
    parts.append(loose / np.linalg.norm(loose, axis=1)[:, None])
    of = np.repeat([*range(len(sets)), -1], [*(n for *_, n in sets), anywhere])
    return np.concatenate(parts), of


def planes(poles: np.ndarray) -> list[tuple[float, float]]:
    """Dip and dip direction of poles of either sign."""
    up = np.where(poles[:, 2:] < 0.0, -poles, poles)
    dips = np.degrees(np.arctan2(np.hypot(up[:, 0], up[:, 1]), up[:, 2]))
    ways = np.degrees(np.arctan2(up[:, 0], up[:, 1])) % 360.0
    return list(zip(dips.tolist(), ways.tolist(), strict=True))


def turn(angle: float, axis: tuple[float, float, float]) -> np.ndarray:
    """A rotation by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def survey(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "survey.csv"
    path.write_text(text, encoding="utf-8")
    return path


def refused(**given) -> DesignError:
    with pytest.raises(DesignError) as caught:
        sk.sets(**({"joints": LIST} | given))
    return caught.value


def codes(found) -> list[str]:
    return [notice.code for notice in found.warnings]


# -- statistics --------------------------------------------------------------------------------------------------------


def test_fisher_against_mplstereonet_and_scipy() -> None:
    """K and its cone are mplstereonet's (Fisher 1953); SciPy's likeliest κ solves coth κ - 1/κ = R/N: N / (N - R)."""
    stereonet = pytest.importorskip("mplstereonet")
    rng = np.random.default_rng(3)
    for dip, way, k, n in ((40, 100, 20, 30), (75, 250, 80, 12), (20, 10, 200, 60)):
        poles, _ = drawn(rng, ((dip, way, k, n),))
        own = axes_of(poles, np.ones(n), None, 0.95)
        angles = np.array(planes(poles))
        _, (resultant, cone, kappa) = stereonet.find_fisher_stats(
            angles[:, 1] - 90.0, angles[:, 0], measurement="poles", conf=95
        )
        assert (own.k, own.resultant, own.cone_deg) == pytest.approx(
            (kappa, resultant, cone), rel=1e-9
        )
        mean, likeliest = vonmises_fisher.fit(poles)
        assert own.k * n / (n - 1) == pytest.approx(likeliest, rel=1e-6)
        assert abs(own.mean @ mean) > math.cos(math.radians(0.6))  # eigenvector against vector sum
        values = np.linalg.eigvalsh(poles.T @ poles / n)[::-1]
        assert own.eigenvalues == pytest.approx(values, abs=1e-12)


def test_limits_hold_the_truth_as_often_as_they_say() -> None:
    """1,000 surveys of 15 joints, K 40: 95 % of the limits of K and of the cones hold it, within 3 standard errors."""
    truth = normals(np.array(50.0), np.array(200.0))
    all_poles = (
        vonmises_fisher(truth, 40.0)
        .rvs(15_000, random_state=np.random.default_rng(8))
        .reshape(1000, 15, 3)
    )
    found = [axes_of(poles, np.ones(15)) for poles in all_poles]
    near = 3.0 * math.sqrt(0.05 * 0.95 / 1000)
    assert np.mean([one.k_low < 40.0 < one.k_high for one in found]) == pytest.approx(
        0.95, abs=near
    )
    inside = [
        math.degrees(math.acos(min(1.0, abs(one.mean @ truth)))) < one.cone_deg for one in found
    ]
    assert np.mean(inside) == pytest.approx(0.95, abs=near)
    assert np.mean([one.k for one in found]) == pytest.approx(
        40.0 * 14 / 13, rel=0.03
    )  # mean of 1 / χ²
    assert np.mean([one.is_elongated for one in found]) == pytest.approx(0.01, abs=0.01)


@pytest.mark.parametrize("k", [3.0, 20.0, 500.0])
def test_cones_of_variability(k) -> None:
    """The density K sin θ exp(K cos θ) / 2 sinh K integrated to the cone gives the share."""
    for share in (0.5, 0.68, 0.8):
        angle = math.radians(cone_of(k, share))
        inside = quad(lambda t: k * math.sin(t) * math.exp(k * (math.cos(t) - 1.0)), 0.0, angle)[0]
        assert inside / -math.expm1(-2.0 * k) == pytest.approx(share, rel=1e-7)


def test_quantities_are_repeated_joints_and_weights_are_not() -> None:
    poles, _ = drawn(np.random.default_rng(4), ((50, 30, 30, 12),))
    times = np.array([1, 2, 3] * 4)
    once, many = (
        axes_of(poles, np.ones(12), times.astype(float)),
        axes_of(poles.repeat(times, axis=0), np.ones(24)),
    )
    assert (once.joints, once.k, once.k_low, once.cone_deg) == pytest.approx(
        (24, many.k, many.k_low, many.cone_deg)
    )
    weighted = axes_of(poles, 7.0 * times)
    assert weighted.joints == pytest.approx(24**2 / 56)  # Kish
    assert weighted.resultant == pytest.approx(once.resultant)
    assert weighted.k_high / weighted.k_low > once.k_high / once.k_low


def test_axes_of_one_two_and_alike() -> None:
    one = axes_of(np.array([[0.0, 0.6, 0.8]]), np.ones(1))
    assert one.mean.tolist() == pytest.approx([0.0, -0.6, -0.8])
    assert all(
        math.isnan(value)
        for value in (one.k, one.k_low, one.cone_deg, one.scatter_deg, one.cone_of(0.5))
    )
    alike = axes_of(np.array([[0.0, 0.6, 0.8], [0.0, -0.6, -0.8]]), np.ones(2))
    assert (alike.k, alike.cone_deg, alike.cone_of(0.95), alike.scatter_deg) == (
        math.inf,
        0.0,
        0.0,
        0.0,
    )
    half = math.radians(3.0)
    two = axes_of(
        np.array([[math.sin(half), 0.0, math.cos(half)], [-math.sin(half), 0.0, math.cos(half)]]),
        np.ones(2),
    )
    assert two.k == pytest.approx(1.0 / (2.0 - 2.0 * math.cos(half)))  # (N - 1) / (N - R)


def test_density_against_mplstereonet() -> None:
    stereonet = pytest.importorskip("mplstereonet")
    rng = np.random.default_rng(5)
    poles, _ = drawn(rng, anywhere=15)
    weights = rng.uniform(0.5, 2.0, len(poles))
    angles = np.array(planes(poles))
    lon, lat, theirs = stereonet.density_grid(
        angles[:, 1] - 90.0,
        angles[:, 0],
        method="exponential_kamb",
        gridsize=25,
        weights=weights.copy(),
    )
    down, east, north = stereonet.stereonet_math.sph2cart(lon.ravel(), lat.ravel())
    ours = density(np.column_stack([east, north, -down]), poles, weights, float(len(poles)))
    assert ours == pytest.approx(theirs.ravel(), rel=1e-9, abs=1e-9)


def test_terzaghi() -> None:
    """A joint at 30° to the line counts twice one square to it; at 5° it counts as at 15°."""
    line = Line(90.0, 0.0).vector()
    poles = np.array([Line(90.0 - off, 0.0).vector() for off in (0.0, 60.0, 85.0)])
    assert terzaghi_weights(poles, line, 15.0) == pytest.approx(
        [1.0, 2.0, 1.0 / math.sin(math.radians(15.0))]
    )
    found = sk.sets({"a": "90/090", "b": "90/030", "c": "90/005"}, n=1, scanline="090/0")
    assert found.weights == pytest.approx([1.0, 2.0, 3.8637033])
    assert found.capped == 1
    assert {"W401", "W402"} <= set(codes(found))
    assert "W402 1 joint within 15° of the scanline weighs 3.86" in " ".join(str(found).split())


# -- clusters ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sets", "anywhere"),
    [((), 50), (THREE[:1], 6), (THREE[:2], 6), (THREE, 10), ((*THREE, (85, 300, 40, 25)), 8)],
)
def test_the_number_of_drawn_sets_is_found(sets, anywhere) -> None:
    poles, of = drawn(np.random.default_rng(11), sets, anywhere)
    found = clusters_of(poles, np.ones(len(poles)), None, np.random.default_rng(1))
    assert least_bic(found) == len(sets)
    chosen = found[len(sets)]
    for k in range(len(sets)):
        own = chosen.labels[of == k]
        assert np.bincount(own + 1).max() >= 0.9 * len(own)  # one set, and few left alone


def test_joints_far_from_every_set_are_of_none() -> None:
    """Of joints that lie anywhere, those beyond 40° of every mean: K 40 has 0.1 in 1,000 there."""
    rng = np.random.default_rng(16)
    poles, of = drawn(rng, anywhere=25)
    means = np.stack([normals(np.array(dip), np.array(way)) for dip, way, *_ in THREE])
    far = (of == -1) & (np.abs(poles @ means.T).max(axis=1) < math.cos(math.radians(40.0)))
    assert far.sum() >= 5
    found = clusters_of(poles, np.ones(len(poles)), 3, np.random.default_rng(1))[0]
    assert (found.labels[far] == -1).all()
    assert np.mean(found.labels[of >= 0] == -1) < 0.05


def test_turned_and_flipped_poles_are_in_the_same_sets() -> None:
    poles, _ = drawn(np.random.default_rng(12), anywhere=8)
    ones, rotation = np.ones(len(poles)), turn(1.1, (1.0, 2.0, -0.5))
    sides = np.where(np.random.default_rng(0).random(len(poles)) < 0.5, -1.0, 1.0)[:, None]
    first, turned, flipped = (
        clusters_of(some, ones, 3, np.random.default_rng(1))[0]
        for some in (poles, poles @ rotation.T, poles * sides)
    )
    assert (first.labels == turned.labels).all()
    assert (first.labels == flipped.labels).all()
    assert np.abs(np.einsum("ij,ij->i", turned.means, first.means @ rotation.T)) == pytest.approx(
        np.ones(3), abs=1e-12
    )
    assert (turned.bic, flipped.bic) == pytest.approx((first.bic, first.bic))


def test_a_fixed_point_of_fuzzy_k_means() -> None:
    """Without outliers each mean is the first eigenvector of its own Σ u² x xᵀ (Hammah & Curran 1998)."""
    poles, _ = drawn(
        np.random.default_rng(13), ((45, 120, 200, 30), (80, 20, 200, 30), (60, 270, 200, 30))
    )
    found = clusters_of(poles, np.ones(90), 3, np.random.default_rng(1))[0]
    assert (found.labels >= 0).all()
    square = 1.0 - (poles @ found.means.T) ** 2
    share = 1.0 / (square[:, :, None] / square[:, None, :]).sum(axis=2)
    assert (found.labels == share.argmax(axis=1)).all()
    for k, mean in enumerate(found.means):
        tensor = np.einsum("n,ni,nj->ij", share[:, k] ** 2, poles, poles)
        assert abs(np.linalg.eigh(tensor)[1][:, -1] @ mean) == pytest.approx(1.0, abs=1e-8)


def test_the_column_set_wins() -> None:
    own = sk.sets(LIST)
    assert own.are_given
    assert [one.name for one in own.sets] == ["S1", "S2", "S3"]
    assert len(own.without_set) == 6
    asked = sk.sets(LIST, n=5)
    assert [len(one.members) for one in asked.sets] == [len(one.members) for one in own.sets]
    assert "W404" in codes(asked)
    anew = sk.sets(LIST, ignore_sets=True)
    assert not anew.are_given
    assert "W404" in codes(anew)
    # the list was drawn from three sets and six flat joints: all found again, but for four joints at the edges
    both = {
        (joint.set_name, int(k))
        for joint, k in zip(anew.joints.joints, anew.of, strict=True)
        if k >= 0
    }
    assert sorted(name for name, _ in both) == ["S1", "S2", "S3"]
    assert sorted(k for _, k in both) == [0, 1, 2]
    assert set(own.without_set) < set(anew.without_set)
    assert len(anew.without_set) == 10


def test_few_joints_and_joints_alike() -> None:
    assert codes(sk.sets(["45/115"])) == ["W404"]
    assert sk.sets(["45/115"]).line == "no sets  1 of no set  W404"
    two = sk.sets(["45/115", "47/117"], n=2)
    assert sorted(len(one.members) for one in two.sets) == [1, 1]
    alike = sk.sets({f"J{k}": "45/120" for k in range(20)})
    assert [str(one.rounded) for one in alike.sets] == ["45/120"]
    assert (
        alike.block
        == "sets:\n  S1: {plane: 45/120}  # 20 joints; add a spacing: the survey has none\n"
    )
    for found in (two, alike):
        assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["sets"][0]["k"] is None
        assert max(map(len, str(found).splitlines())) <= 100


def test_a_set_that_scatters_one_way_is_said(tmp_path) -> None:
    """Dip 60 ± 2, dip direction 120 ± 15: K is neither, and the block takes both angles."""
    rng = np.random.default_rng(15)
    joints = list(
        zip(rng.normal(60, 2, 80).tolist(), rng.normal(120, 15, 80).tolist(), strict=True)
    )
    found = sk.sets(joints, n=1)
    assert "W401" in codes(found)
    angles = found.sets[0].angles
    assert (angles["dip_sd_deg"], angles["dip_direction_sd_deg"]) == pytest.approx(
        (2, 15), rel=0.25
    )
    assert "dip_direction: {dist: normal, mean: 1" in found.scatter_block


# -- spacing and traces ------------------------------------------------------------------------------------------------


def test_spacing_along_a_scanline_and_traces(tmp_path) -> None:
    """Joints at 60° to the line every 2, 3, 4 m: 0.5 × 3 m. Traces 2, 4, 6, 8 m, two whole: Σ l / n = 10 m."""
    rows = [("90/030", 0, 2, 2), ("90/030", 2, 4, 2), ("90/030", 5, 6, 1), ("90/030", 9, 8, 0)]
    text = "plane,Position (m),trace length [m],ends\n" + "\n".join(
        ",".join(map(str, row)) for row in rows
    )
    path = survey(tmp_path, text)
    found = sk.sets(path, n=1, scanline="090/0")
    (one,) = found.sets
    assert one.spacing is not None
    assert (one.spacing.count, one.spacing.mean_m, one.spacing.sd_m) == pytest.approx((3, 1.5, 0.5))
    assert one.trace is not None
    assert (one.trace.mean_m, one.ended, one.whole_mean_m) == (5.0, 2, 10.0)
    assert (
        found.block
        == "sets:\n  S1: {plane: 90/030, spacing: 1.5 m, spacing_scatter: 33 %}  # 4 joints\n"
    )
    without = sk.sets(path, n=1)
    assert without.sets[0].spacing is None
    assert "W402" in codes(without)
    given = survey(
        tmp_path,
        "plane,spacing (cm),n,quantity\n" + "\n".join(f"45/12{k},{50 + k},x,2" for k in range(4)),
    )
    own = sk.sets(given, n=1, scanline="120/45")
    assert own.sets[0].spacing is not None
    assert own.sets[0].spacing.mean_m == pytest.approx(0.515)
    assert "W402" in codes(own)


def test_the_blocks_are_designs(tmp_path) -> None:
    """The block stands for the sets of a bench, the other for the joints of a wedge."""
    listed = sk.sets(LIST).joints.joints
    found = sk.sets([replace(joint, spacing_m=1.25) for joint in listed])
    template = (TEMPLATES / "bench.yaml").read_text(encoding="utf-8")
    head, _, rest = template.partition("\nsets:\n")
    bench = tmp_path / "bench.yaml"
    bench.write_text(
        head
        + "\n"
        + found.block
        + rest[rest.index("\nstrength:") :].replace("bedding: {c: 0, phi: 42}", "")
    )
    design = load(bench)
    for read, one in zip(design.sets, found.sets, strict=True):
        assert (read.spacing_m, read.plane.dip_deg) == pytest.approx(
            (1.25, one.plane.dip_deg), abs=0.05
        )
        assert read.scatter_deg == pytest.approx(
            math.degrees(math.sqrt(2.0 / one.axes.k)), abs=0.05
        )
    wedge = tmp_path / "wedge.yaml"
    joints = "\n".join(found.scatter_block.splitlines()[:3])
    wedge.write_text(
        f"slopekit: 1\nkind: wedge\nslope: {{face: 65/180, height: 15 m}}\n{joints}\n"
        "strength: {weak: {c: 10 kPa, phi: 30}}\nrock: {density: 2600 kg/m3}\n"
    )
    variables = load(wedge).variables
    assert [one.path for one in variables] == ["joints.S1.plane", "joints.S2.plane"]
    assert variables[0].distribution.k == pytest.approx(found.sets[0].axes.k, rel=0.01)


# -- the command, and what is refused ----------------------------------------------------------------------------------


def test_json_sheet_and_files(tmp_path) -> None:
    folder = tmp_path / "out"
    run = slopekit("sets", LIST, "--scanline", "045/10", "-o", str(folder))
    assert (run.returncode, run.stderr) == (0, "")
    assert {path.name for path in folder.iterdir()} == {
        "sets.json",
        "sets.txt",
        "sets.yaml",
        "joints.csv",
        "sets.csv",
        "stereonet.png",
    }
    full = (folder / "sets.txt").read_text().splitlines()
    sheet = [line.partition("   sha ")[0] for line in full if not line.startswith("TIME ")]
    assert sheet == run.stdout.splitlines()
    assert any(line.startswith("TIME ") for line in full)
    assert max(map(len, run.stdout.splitlines())) <= 100
    document = json.loads((folder / "sets.json").read_text())
    assert document["block"] + document["scatter_block"] == (folder / "sets.yaml").read_text()
    assert document["sets"][0]["joints"] == 22
    assert document["defaults"] == ["bias_angle"]
    again = sk.sets(folder / "joints.csv")  # its own list, weights as quantities
    before = sk.sets(LIST, scanline="045/10")
    for one, other in zip(again.sets, before.sets, strict=True):
        assert one.plane.dip_deg == pytest.approx(other.plane.dip_deg, abs=1e-3)
        assert one.axes.resultant == pytest.approx(other.axes.resultant, abs=1e-6)


@pytest.mark.parametrize("arguments", [(), ("--ignore-sets", "--scanline", "090/0")])
def test_the_picture(tmp_path, arguments) -> None:
    from slopekit.views.charts.drawing import new_figure
    from slopekit.views.charts.survey_charts import draw_sets

    run = slopekit("sets", LIST, *arguments, "--json")
    document = json.loads(run.stdout)
    with new_figure("x") as figure:
        draw_sets(figure, document)
    said = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert sum(text.startswith("mean S") for text in said) == len(document["sets"])
    assert sum("S1 (" in text for text in said) == 1
    assert sum("(Kamb)" in text for text in said) == 1


def test_bad_input_is_refused(tmp_path) -> None:
    assert refused(n=0).codes == refused(n=9).codes == ("E137",)
    assert refused(joints=["45/115"], n=2).codes == ("E137",)
    assert refused(scanline="east").codes == refused(scanline="400/0").codes == ("E104",)
    assert refused(bias_angle=0).codes == refused(bias_angle="91").codes == ("E307",)
    path = survey(tmp_path, "dip,dd,spacing,trace,ends\n45,120,-1,2,2\n46,121,1 kg,0,3\n")
    assert refused(joints=path, n=7, bias_angle=0).codes == ("E193", "E108", "E193", "E193", "E307")
    assert (
        sk.combos(path, face="65/180", c=0, phi=30).joints.joints[0].spacing_m is None
    )  # not read there
    wrong = slopekit("sets", LIST, "--sets", "many", "--scanline", "x", "--json")
    assert wrong.returncode == 2
    assert "--sets many" in wrong.stderr
    wrong = slopekit("sets", LIST, "--sets", "12", "--scanline", "x", "--bias-angle", "100")
    assert [line[:4] for line in wrong.stderr.splitlines() if line[:1] == "E"] == [
        "E104",
        "E307",
        "E137",
    ]
