"""Samples: marginals, tails, ranks, orientations, replicates; the same numbers in pieces of any size."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

import slopekit as sk
from slopekit.core.errors import DesignError
from slopekit.core.orientation import Line, Plane, normals
from slopekit.design.reading.files import with_values
from slopekit.design.scatter.distributions import Angles, Distribution, Fisher, Variable
from slopekit.studies.marginals import checked_limits, marginal, tails
from slopekit.studies.prob import sampling, sources
from slopekit.studies.prob.estimates import sample_statistics, unwrapped
from slopekit.studies.prob.sampling import METHODS, ends_of_blocks, samples
from slopekit.studies.prob.sources import fisher, folded_lines, folded_planes


def dist(name, **parameters):
    return Distribution(name, {key: float(value) for key, value in parameters.items()}, "ratio")


def log_normal(mean, sd):
    """scipy's, from mean and standard deviation of the value itself."""
    s = math.sqrt(math.log1p((sd / mean) ** 2))
    return stats.lognorm(s, scale=mean * math.exp(-s * s / 2.0))


class Cut:
    """A distribution of scipy between two values, by its definition."""

    def __init__(self, whole, low=-math.inf, high=math.inf):
        self.whole, self.low, self.high = whole, low, high
        self.first, self.share = whole.cdf(low), whole.cdf(high) - whole.cdf(low)

    def cdf(self, x):
        return np.clip((self.whole.cdf(x) - self.first) / self.share, 0.0, 1.0)


MARGINALS = [
    (dist("normal", mean=20, sd=2), stats.norm(20, 2)),
    (dist("normal", mean=20, sd=2, min=17), Cut(stats.norm(20, 2), 17)),
    (dist("normal", mean=20, sd=2, min=19, max=26), Cut(stats.norm(20, 2), 19, 26)),
    (dist("normal", mean=20, sd=2, max=20), Cut(stats.norm(20, 2), high=20)),
    (dist("normal", mean=50, sd=1000, min=49, max=51), stats.uniform(49, 2)),
    (dist("normal", mean=20, sd=2, min=0, max=90), stats.norm(20, 2)),
    (dist("lognormal", mean=50, sd=20), log_normal(50, 20)),
    (dist("lognormal", mean=50, sd=20, min=30, max=60), Cut(log_normal(50, 20), 30, 60)),
    (dist("lognormal", mean=50, sd=80, min=49), Cut(log_normal(50, 80), 49)),
    (dist("lognormal", mean=50, sd=20, min=-5), log_normal(50, 20)),
    (dist("uniform", min=-3, max=7), stats.uniform(-3, 10)),
    (dist("triangular", min=10, mode=15, max=30), stats.triang(0.25, 10, 20)),
    (dist("triangular", min=10, mode=10, max=30), stats.triang(0, 10, 20)),
    (dist("triangular", min=10, mode=30, max=30), stats.triang(1, 10, 20)),
]


@pytest.mark.parametrize("method", METHODS)
def test_marginals(method) -> None:
    """Kolmogorov-Smirnov against scipy, every input at once, free and correlated.

    At p > 1e-4 for Monte Carlo (84 tests in all: one false alarm in a hundred seeds). A Latin hypercube leaves
    no gap wider than two strata of a replicate.
    """
    variables = [Variable(f"x{k}", own) for k, (own, _) in enumerate(MARGINALS)]
    pairs = [(f"x{k}", f"x{k + 1}", 0.5) for k in range(0, len(variables) - 1, 2)]
    for correlation in ((), pairs):
        drawn = samples(variables, correlation, 8192, 3, method)
        for k, (_, exact) in enumerate(MARGINALS):
            found = stats.kstest(drawn.values[:, k], exact.cdf, method="asymp")
            assert found.pvalue > 1e-4
            if method == "latin-hypercube":
                assert found.statistic < 2.0 / 512


def test_a_standard_deviation_of_0_is_a_constant() -> None:
    for name in ("normal", "lognormal"):
        variables = [
            Variable("x", dist(name, mean=20, sd=0, min=20)),
            Variable("y", dist("normal", mean=1, sd=1)),
        ]
        for method in METHODS:
            assert (
                samples(variables, [("x", "y", 0.5)], 100, 1, method).values[:, 0] == 20.0
            ).all()


def _quantile(own, p):
    """In 40 digits by bisection on the definition; p from the lower end."""
    given = own.parameters
    with mpmath.workdps(40):
        mean, sd = mpmath.mpf(given["mean"]), mpmath.mpf(given["sd"])
        low, high = given.get("min", -math.inf), given.get("max", math.inf)
        if own.name == "lognormal":
            variance = mpmath.log(1 + (sd / mean) ** 2)
            mean, sd = mpmath.log(mean) - variance / 2, mpmath.sqrt(variance)
            low, high = (mpmath.log(bound) if bound > 0 else -mpmath.inf for bound in (low, high))
        first, last = (mpmath.ncdf((mpmath.mpf(bound) - mean) / sd) for bound in (low, high))
        target = first + mpmath.mpf(p) * (last - first)
        below, above = mpmath.mpf(-40), mpmath.mpf(40)
        for _ in range(75):
            middle = (below + above) / 2
            below, above = (middle, above) if mpmath.ncdf(middle) < target else (below, middle)
        value = mean + sd * below
        return float(mpmath.exp(value) if own.name == "lognormal" else value)


@pytest.mark.parametrize(
    "own",
    [
        dist("normal", mean=0, sd=1, min=-9, max=3),
        dist("normal", mean=0, sd=1, min=-4),
        dist("normal", mean=0, sd=1),
        dist("normal", mean=20, sd=2, min=19.9, max=22),
        dist("lognormal", mean=50, sd=100, min=45),
        dist("lognormal", mean=5, sd=2, min=0.1, max=30),
    ],
    ids=str,
)
def test_exact_in_both_tails(own) -> None:
    """Quantiles against 40 digits, at 1e-14 of the width they are drawn from; in the tails ndtri has 1e-15 itself."""
    functions, width = marginal(own), own.parameters["sd"]
    for p in (2.0**-54, 1e-12, 1e-5, 0.3, 0.5):
        with mpmath.workdps(40):
            exact = _quantile(own, p), _quantile(own, 1 - mpmath.mpf(p))
        for side, value in zip((-1.0, 1.0), exact, strict=True):
            found = functions.of_tail(np.array([p]), side)[0]
            assert found == pytest.approx(value, abs=1e-14 * width, rel=2e-14)
            array = functions.of_tail(np.array([p]), np.array([side]))[0]
            assert array == found
            normal = side * stats.norm.isf(p)
            assert functions.of_normal(np.array([normal]))[0] == pytest.approx(
                value, abs=3e-14 * width, rel=3e-14
            )


@pytest.mark.parametrize(("own", "exact"), MARGINALS, ids=lambda value: str(value)[:40])
def test_shares_of_tails(own, exact) -> None:
    for value in (-5.0, 15.0, 20.0, 25.0, 52.0):
        below, above = tails(own, value, value)
        assert below == pytest.approx(
            exact.cdf(value), abs=1e-6 if own.parameters.get("sd") == 1000 else 1e-12
        )
        assert below + above == pytest.approx(1.0, abs=1e-12)


# -- correlation ------------------------------------------------------------------------------------------------------

KINDS = {
    "normal": dist("normal", mean=20, sd=2),
    "log": dist("lognormal", mean=5, sd=4),
    "cut": dist("normal", mean=20, sd=4, min=18),
    "uniform": dist("uniform", min=0, max=1),
    "triangle": dist("triangular", min=0, mode=1, max=5),
}


def _all(**more):
    return [Variable(name, own) for name, own in (KINDS | more).items()]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("wanted", [0.0, 0.8, -0.5])
def test_rank_correlation_is_the_one_asked_for(method, wanted) -> None:
    """Spearman's coefficient of 2¹⁵ samples by scipy: its standard error is about 1/√n = 0.0055."""
    drawn = samples(
        _all(), [("cut", "log", wanted), ("triangle", "uniform", -wanted)], 2**15, 7, method
    )
    found = stats.spearmanr(drawn.values).statistic
    expected = np.eye(5)
    expected[1, 2] = expected[2, 1] = wanted
    expected[3, 4] = expected[4, 3] = -wanted
    assert found == pytest.approx(expected, abs=0.024)


@pytest.mark.parametrize("method", METHODS)
def test_full_correlation_gives_the_same_ranks(method) -> None:
    """Of any two kinds of distributions; also where the matrix of all is singular in other ways."""
    pairs = [
        ("normal", "log", 1.0),
        ("normal", "cut", -1.0),
        ("log", "cut", -1.0),
        ("normal", "uniform", 0.6),
        ("log", "uniform", 0.6),
        ("cut", "uniform", -0.6),
    ]
    drawn = samples(_all(), pairs, 5000, 1, method)
    order = np.argsort(drawn.values[:, 0])
    assert (np.diff(drawn.values[order, 1]) >= 0.0).all()
    assert (np.diff(drawn.values[order, 2]) <= 0.0).all()
    assert len(np.unique(drawn.values[:, 1])) == len(drawn.values)
    assert stats.spearmanr(drawn.values[:, 0], drawn.values[:, 3]).statistic == pytest.approx(
        0.6, abs=0.05
    )


@pytest.mark.parametrize("method", METHODS)
def test_full_correlation_gives_the_same_numbers(method) -> None:
    """To the last digit, whatever else the two are correlated with."""
    own = KINDS["normal"]
    variables = [Variable(name, own) for name in "abcde"]
    pairs = [
        ("a", "d", 0.3),
        ("b", "d", -0.45),
        ("a", "e", 0.3),
        ("b", "e", -0.45),
        ("d", "e", 1.0),
        ("c", "d", 0.1),
        ("c", "e", 0.1),
    ]
    drawn = samples(variables, pairs, 3000, 2, method)
    assert (drawn.values[:, 3] == drawn.values[:, 4]).all()


# -- orientations -----------------------------------------------------------------------------------------------------


def _vectors(drawn, of="plane"):
    if of == "plane":
        return normals(drawn.values[:, 0], drawn.values[:, 1])
    trend, plunge = np.radians(drawn.values.T)
    return np.stack(
        [np.sin(trend) * np.cos(plunge), np.cos(trend) * np.cos(plunge), -np.sin(plunge)], axis=1
    )


@pytest.mark.parametrize("concentration", [0.5, 5.0, 60.0, 99.0, 100.0, 500.0])
def test_fisher_of_lines(concentration) -> None:
    """Mean resultant length coth k - 1/k; the angle by Fisher's own formula, the azimuth uniform (KS at p > 1e-4)."""
    mean = Line(310.0, 35.0)
    drawn = samples([Variable("bolt", Fisher(mean, concentration))], (), 40000, 5)
    assert drawn.names == ("bolt.trend", "bolt.plunge")
    vectors = _vectors(drawn, "line")
    resultant = np.linalg.norm(vectors.mean(axis=0))
    exact = 1.0 / math.tanh(concentration) - 1.0 / concentration
    assert resultant == pytest.approx(exact, abs=5.0 * math.sqrt((1.0 - exact**2) / 40000))
    cosine = vectors @ mean.vector()

    def share(t):
        return -np.expm1(-concentration * t) / -np.expm1(-2.0 * concentration)

    assert stats.kstest(1.0 - cosine, share).pvalue > 1e-4
    down = np.cross(np.cross(mean.vector(), [0.0, 0.0, -1.0]), mean.vector())
    side = np.cross(mean.vector(), down)
    azimuth = np.arctan2(vectors @ side, vectors @ down)
    assert stats.kstest(azimuth, stats.uniform(-math.pi, 2.0 * math.pi).cdf).pvalue > 1e-4


@pytest.mark.parametrize("concentration", [0.1, 0.5, 5.0, 60.0, 99.0, 100.0, 500.0])
@pytest.mark.parametrize("mean", [Line(310.0, 35.0), Plane(40.0, 310.0)], ids=str)
def test_angle_and_azimuth_of_a_fisher_sample(mean, concentration) -> None:
    """The angle by Fisher's formula solved in 40 digits, the azimuth that of the two normals; both to 1e-11."""
    for r in (1e-6, 0.01, 0.5, 0.999, 1.001, 2.0, 4.0, 6.0):
        turn = 0.4 + r
        with mpmath.workdps(40):
            share, none = (
                mpmath.exp(-(mpmath.mpf(r) ** 2) / 2),
                mpmath.exp(-2 * mpmath.mpf(concentration)),
            )
            angle = float(mpmath.acos(1 + mpmath.log(share + (1 - share) * none) / concentration))
        normal = np.array([r * math.cos(turn)]), np.array([r * math.sin(turn)])
        steep, direction = fisher(mean, concentration, *normal)
        if isinstance(mean, Plane):
            centre, up = mean.normal(), Plane(mean.dip_deg + 90.0, mean.dip_direction_deg).normal()
            side = Plane(90.0, mean.dip_direction_deg + 90.0).normal()
            found = Plane(float(steep[0]), float(direction[0])).normal()
        else:
            centre, up = mean.vector(), Line(mean.trend_deg, mean.plunge_deg + 90.0).vector()
            side = Line(mean.trend_deg + 90.0, 0.0).vector()
            found = Line(float(direction[0]), float(steep[0])).vector()
        expected = centre * math.cos(angle) + (
            up * math.cos(turn) + side * math.sin(turn)
        ) * math.sin(angle)
        if isinstance(mean, Plane) and expected[2] < 0.0:
            expected = -expected  # the upward one of the two
        assert found == pytest.approx(expected, abs=1e-11)


def test_fisher_against_another_sampler() -> None:
    """Means of a few functions of the pole against scipy's von Mises-Fisher of three dimensions (its own algorithm)."""
    mean, concentration, count = Plane(40.0, 250.0), 50.0, 40000
    found = _vectors(samples([Variable("J1.plane", Fisher(mean, concentration))], (), count, 2))
    other = stats.vonmises_fisher(mean.normal(), concentration).rvs(
        count, random_state=np.random.default_rng(1)
    )
    for power in (1, 2, 3):
        error = np.sqrt(((found**power).var(axis=0) + (other**power).var(axis=0)) / count)
        assert (
            np.abs((found**power).mean(axis=0) - (other**power).mean(axis=0)) < 4.5 * error
        ).all()


def test_poles_that_pass_the_horizontal() -> None:
    """A steep plane: half of its poles point downward, and are written by the dip on the other side."""
    drawn = samples([Variable("J1.plane", Fisher(Plane(88.0, 5.0), 100.0))], (), 20000, 1)
    dip, direction = drawn.values.T
    assert dip.min() >= 0.0
    assert dip.max() <= 90.0
    assert direction.min() >= 0.0
    assert direction.max() <= 360.0
    towards = np.cos(np.radians(direction - 5.0))
    over = (towards < 0.0).mean()
    # the dip has a standard deviation of 1/√k = 5.73°
    assert over == pytest.approx(stats.norm.sf(2.0 / math.degrees(0.1)), abs=0.01)
    axes = normals(dip, direction)
    assert np.abs(axes @ Plane(88.0, 5.0).normal()).min() > math.cos(math.radians(35.0))


def test_components_of_fisher_orientations_can_be_correlated() -> None:
    """Where k is large dip and dip direction · sin dip are nearly normal with 1/√k, and their ranks follow."""
    planes = [Variable(f"J{k}.plane", Fisher(Plane(50.0, 100.0 * k), 400.0)) for k in (1, 2)]
    pairs = [("J1.plane.dip", "J2.plane.dip", 0.8), ("J1.plane.dip_direction", "phi", -0.5)]
    drawn = samples([*planes, Variable("phi", KINDS["normal"])], pairs, 2**16, 1)
    found = stats.spearmanr(drawn.values).statistic
    expected = np.eye(5)
    expected[0, 2] = expected[2, 0] = 0.8
    expected[1, 4] = expected[4, 1] = -0.5
    assert found == pytest.approx(expected, abs=0.015)
    assert drawn.values[:, 0].std() == pytest.approx(math.degrees(0.05), rel=0.02)
    assert drawn.values[:, 1].std() * math.sin(math.radians(50)) == pytest.approx(
        math.degrees(0.05), rel=0.02
    )


@given(st.floats(-400, 400), st.floats(-800, 800))
def test_folded_planes_are_the_same_planes(dip, direction) -> None:
    """Their normals are equal or opposite."""
    folded, turned = folded_planes(np.array([dip]), np.array([direction]))
    assert 0.0 <= folded[0] <= 90.0
    assert 0.0 <= turned[0] <= 360.0
    product = float(normals(np.array([dip]), np.array([direction]))[0] @ normals(folded, turned)[0])
    assert abs(product) == pytest.approx(1.0, abs=1e-12)


@given(st.floats(-400, 400), st.floats(-800, 800))
def test_folded_lines_are_the_same_lines(plunge, trend) -> None:
    folded, turned = folded_lines(np.array([plunge]), np.array([trend]))
    assert -90.0 <= folded[0] <= 90.0
    assert 0.0 <= turned[0] <= 360.0
    product = float(
        Line(trend, plunge).vector() @ Line(float(turned[0]), float(folded[0])).vector()
    )
    assert product == pytest.approx(1.0, abs=1e-12)


def test_what_needs_no_folding_is_left_to_the_last_digit() -> None:
    dip, direction = np.array([45.3, 0.0, 90.0]), np.array([0.0, 359.9, 360.0])
    assert (folded_planes(dip, direction)[0] == dip).all()
    assert (folded_planes(dip, direction)[1] == direction).all()


def test_angles_as_numbers() -> None:
    """A dip that passes the vertical turns the direction too, also where the direction does not scatter."""
    steep = Variable("slope.face", Angles("plane", dist("normal", mean=88, sd=4), 350.0))
    drawn = samples([steep], (), 20000, 1)
    assert drawn.names == ("slope.face.dip", "slope.face.dip_direction")
    assert set(np.unique(drawn.values[:, 1])) == {170.0, 350.0}
    assert (drawn.values[:, 1] == 170.0).mean() == pytest.approx(stats.norm.sf(0.5), abs=0.015)
    unfolded = np.where(drawn.values[:, 1] == 170.0, 180.0 - drawn.values[:, 0], drawn.values[:, 0])
    assert stats.kstest(unfolded, stats.norm(88, 4).cdf).pvalue > 1e-4
    turned = Variable("slope.face", Angles("plane", 60.0, dist("normal", mean=355, sd=10)))
    drawn = samples([turned], (), 2000, 1)
    assert (drawn.values[:, 0] == 60.0).all()
    assert 0.2 < (drawn.values[:, 1] < 90.0).mean() < 0.4
    line = samples(
        [Variable("toward", Angles("line", dist("normal", mean=85, sd=9), 0.0))], (), 2000, 1
    )
    assert line.names == ("toward.trend", "toward.plunge")
    assert set(np.unique(line.values[:, 0])) == {0.0, 180.0}


def test_no_scatter_at_all_of_a_steep_angle() -> None:
    steep, direction = fisher(Plane(0.0, 30.0), 200.0, np.zeros(2), np.array([0.0, 1e-9]))
    assert steep.tolist() == pytest.approx([0.0, 0.0], abs=1e-7)
    assert ((direction >= 0.0) & (direction <= 360.0)).all()


# -- how they are drawn -----------------------------------------------------------------------------------------------

MIXED = [
    Variable("J1.plane", Fisher(Plane(45, 115), 200)),
    Variable("face", Angles("plane", dist("normal", mean=60, sd=9), 9.0)),
    *_all(),
]
PAIRS = [("normal", "log", 0.5), ("J1.plane.dip", "cut", -0.4)]


@pytest.mark.parametrize("method", METHODS)
def test_pieces_change_no_sample(method, monkeypatch) -> None:
    monkeypatch.setattr(sampling, "BLOCK", 256)
    whole = samples(MIXED, PAIRS, 5000, 11, method)
    assert whole.values.shape == (5000, 9)
    assert whole.values.flags.f_contiguous
    assert not whole.values.flags.writeable
    replicates = 1 if method == "monte-carlo" else len(ends_of_blocks(5000, method)) - 1
    assert np.unique(whole.replicate).tolist() == list(range(replicates))
    monkeypatch.setattr(sources, "_PIECE", 64)
    monkeypatch.setattr(sampling, "_PIECE", 48)
    assert (samples(MIXED, PAIRS, 5000, 11, method).values == whole.values).all()


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_numbers(method) -> None:
    first, again, other = (samples(MIXED, PAIRS, 300, seed, method).values for seed in (5, 5, 6))
    assert (first == again).all()
    assert not np.isclose(first[:, 4:], other[:, 4:]).any()


def test_a_longer_run_begins_with_a_shorter_one() -> None:
    longer = samples(MIXED, PAIRS, 20000, 5)
    for n in (1, 100, 8192, 8193):
        shorter = samples(MIXED, PAIRS, n, 5)
        assert (longer.values[:n] == shorter.values).all()
        assert (shorter.replicate == 0).all()


@pytest.mark.parametrize("method", METHODS)
def test_some_rows_are_those_of_all(method, monkeypatch) -> None:
    """Also across blocks; their statistics are those of all values in one array."""
    monkeypatch.setattr(sampling, "BLOCK", 64)
    drawn = samples(MIXED, PAIRS, 300, 5, method)
    for start, stop in ((0, 300), (0, 1), (63, 65), (64, 128), (130, 299)):
        assert (drawn.rows(start, stop) == drawn.values[start:stop]).all()
    some = np.array([0, 3, 64, 65, 299])
    assert (drawn.select(some) == drawn.values[some]).all()
    for found, name, values in zip(
        sample_statistics(drawn.names, drawn.pieces), drawn.names, drawn.values.T, strict=True
    ):
        own = unwrapped(name, values)
        around = 360.0 if name.endswith("dip_direction") else math.inf
        expected = [own.mean() % around, own.std(ddof=1), own.min() % around, own.max() % around]
        assert [found[key] for key in ("mean", "sd", "min", "max")] == pytest.approx(
            expected, rel=1e-12, abs=1e-9
        )


@pytest.mark.parametrize("n", [1, 2, 7, 10, 127, 128, 129, 1000, 2**14, 20000, 600_000])
def test_replicates(n) -> None:
    """Sixteen or more where there are samples enough."""
    for method in METHODS:
        ends = ends_of_blocks(n, method)
        sizes = np.diff(ends)
        assert (ends[0], ends[-1]) == (0, n)
        assert 0 < sizes.min() <= sizes.max() <= 8192
        if method == "monte-carlo":
            continue
        assert (16 if n >= 128 else 1) <= len(sizes) <= 32767
        assert sizes.max() - sizes.min() == int(n % len(sizes) > 0)


@pytest.mark.parametrize("n", [16 * 64, 16 * 63])
def test_latin_hypercube_has_one_sample_in_each_stratum(n) -> None:
    """In every replicate and every input, correlated ones too; odd numbers of strata have a middle one."""
    variables = [Variable(f"x{k}", own) for k, (own, _) in enumerate(MARGINALS)]
    drawn = samples(
        variables,
        [("x0", "x1", 0.8), ("x6", "x7", -1.0), ("x0", "x10", 0.3)],
        n,
        3,
        "latin-hypercube",
    )
    for k, (own, exact) in enumerate(MARGINALS):
        if own.parameters.get("sd") == 1000:
            continue  # scipy's stands in for a truncated one, it is not quite the same
        for replicate in range(16):
            values = drawn.values[drawn.replicate == replicate, k]
            stratum = np.floor(
                exact.cdf(values) * (n // 16) + 1e-9 * np.sign(values - np.median(values))
            )
            assert sorted(stratum) == list(range(n // 16))


def test_latin_hypercube_fills_each_stratum_evenly() -> None:
    """Where in its stratum a sample lies is uniform; the middle stratum of an odd number included."""
    drawn = samples(
        [Variable("x", dist("uniform", min=0, max=7))], (), 16 * 1000, 3, "latin-hypercube"
    )
    assert ends_of_blocks(7, "latin-hypercube") == [0, 7]
    one = [Variable("x", dist("uniform", min=0, max=7))]
    values = np.array(
        [samples(one, (), 7, seed, "latin-hypercube").values for seed in range(800)]
    ).ravel()
    for stratum in range(7):
        inside = values[np.floor(values) == stratum] - stratum
        assert len(inside) == 800
        assert stats.kstest(inside, "uniform").pvalue > 1e-4
    assert drawn.values.mean() == pytest.approx(3.5, abs=1e-12)  # the upper half mirrors the lower


def test_replicates_are_independent_and_give_confidence_limits() -> None:
    """The scatter of the replicates' means foretells the error of their mean, against the exact probability.

    Six inputs of a linear limit state, P(sum of normals < -2 √6) = Φ(-2); over 30 seeds the error in units of its
    estimated standard deviation is Student's t with 15 degrees of freedom (KS at p > 1e-3).
    """
    variables = [Variable(f"x{k}", dist("normal", mean=0, sd=1)) for k in range(6)]
    exact = stats.norm.cdf(-2.0)
    scores = []
    for seed in range(30):
        drawn = samples(variables, (), 16 * 128, seed, "latin-hypercube")
        fails = drawn.values.sum(axis=1) < -2.0 * math.sqrt(6.0)
        means = np.array([fails[drawn.replicate == k].mean() for k in range(16)])
        scores.append((means.mean() - exact) / (means.std(ddof=1) / 4.0))
    assert stats.kstest(scores, stats.t(15).cdf).pvalue > 1e-3


def test_fewer_samples_for_the_same_error() -> None:
    """The mean of a sum has a tenth of the error that Monte Carlo has, or less."""
    variables = [Variable(name, KINDS[name]) for name in ("normal", "uniform", "triangle")]
    exact = 20.0 + 0.5 + 2.0

    def error(how):
        found = [
            samples(variables, (), 2048, seed, how).values.sum(axis=1).mean() - exact
            for seed in range(10)
        ]
        return math.sqrt(np.mean(np.square(found)))

    assert error("latin-hypercube") < 0.1 * error("monte-carlo")


# -- with a design ----------------------------------------------------------------------------------------------------

DESIGN = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {
        "face": {"dip": {"dist": "normal", "mean": 65, "sd": 2}, "dip_direction": 185},
        "height": 30,
    },
    "joints": {
        "J1": {"plane": {"dist": "fisher", "mean": "45/105", "k": 200}, "strength": "rough"},
        "J2": {"plane": "70/235", "strength": "clay"},
    },
    "strength": {
        "rough": {"c": {"dist": "lognormal", "mean": "24 kPa", "sd": "8 kPa"}, "phi": 30},
        "clay": {"c": 48, "phi": {"dist": "normal", "mean": 20, "sd": 2, "min": 14}},
    },
    "correlation": {"rough.c/clay.phi": 0.5},
    "support": {"bolts": [{"force": 5, "toward": {"dist": "fisher", "mean": "005/10", "k": 100}}]},
}


def test_samples_of_a_design_and_back() -> None:
    """What a sample sets is what the design then has, to the last digit."""
    design = sk.load(DESIGN)
    drawn = samples(design.variables, design.correlation, 64, 3)
    assert set(drawn.names) == {
        "slope.face.dip",
        "slope.face.dip_direction",
        "joints.J1.plane.dip",
        "joints.J1.plane.dip_direction",
        "strength.rough.c",
        "strength.clay.phi",
        "support.bolts.0.toward.trend",
        "support.bolts.0.toward.plunge",
    }
    for row in (0, 17, 63):
        value = dict(zip(drawn.names, drawn.values[row].tolist(), strict=True))
        changed = with_values(design, drawn.settings(row))
        assert changed.variables == ()
        assert changed.face == Plane(value["slope.face.dip"], 185.0)
        assert changed.joints[0] == Plane(
            value["joints.J1.plane.dip"], value["joints.J1.plane.dip_direction"]
        )
        assert changed.cohesion_kpa == (value["strength.rough.c"], 48.0)
        assert changed.friction_angle_deg == (30.0, value["strength.clay.phi"])
        toward = Line(value["support.bolts.0.toward.trend"], value["support.bolts.0.toward.plunge"])
        assert changed.bolts[0].toward == toward


def _wedge(**strength):
    joints = {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}
    return sk.load(
        {
            "slopekit": 1,
            "kind": "wedge",
            "joints": joints,
            "strength": {"a": {"c": 9, "phi": 30} | strength},
        }
    )


BEYOND = [
    (
        {"c": {"dist": "normal", "mean": 10, "sd": 8}},
        "10.6 % of strength.a.c lies below 0",
        "Add min: 0 to",
    ),
    (
        {"c": {"dist": "uniform", "min": -5, "max": 15}},
        "25 % of strength.a.c lies below 0",
        "Give it min: 0",
    ),
    (
        {"phi": {"dist": "normal", "mean": 45, "sd": 40}},
        "13 % of strength.a.phi lies below 0, 13 % of strength.a.phi",
        "Add min: 0 and max: 90 to",
    ),
    (
        {"phi": {"dist": "lognormal", "mean": 60, "sd": 40}},
        "% of strength.a.phi lies above 90",
        "Add max: 90 to",
    ),
    (
        {"tension": {"dist": "triangular", "min": -1, "mode": 0, "max": 4}},
        "20 % of strength.a.tension lies below 0",
        "Give it min: 0",
    ),
]


@pytest.mark.parametrize(("strength", "says", "advice"), BEYOND, ids=lambda value: str(value)[:30])
def test_too_much_beyond_what_a_design_takes(strength, says, advice) -> None:
    with pytest.raises(DesignError) as caught:
        checked_limits(_wedge(**strength))
    (fault,) = caught.value.faults
    assert fault.code == "E281"
    assert fault.message.startswith(says.partition(" ")[0]) or says in fault.message
    assert says in fault.message
    assert advice in fault.advice
    assert fault.where.startswith("design: strength.a.")


def test_little_beyond_is_left_to_the_study() -> None:
    design = _wedge(
        c={"dist": "normal", "mean": 10, "sd": 4},
        phi={"dist": "normal", "mean": 30, "sd": 2, "min": 0},
    )
    checked_limits(design)
    by_path = {variable.path: variable.distribution for variable in design.variables}
    assert tails(by_path["strength.a.c"], 0.0, math.inf)[0] == pytest.approx(
        stats.norm.cdf(-2.5), rel=1e-12
    )
    assert tails(by_path["strength.a.phi"], 0.0, 90.0)[1] == pytest.approx(
        stats.norm.sf(30.0), rel=1e-9
    )
    drawn = samples(design.variables, (), 20000, 1)
    assert (drawn.values.T[list(drawn.names).index("strength.a.c")] < 0.0).mean() == pytest.approx(
        0.0062, abs=0.003
    )


def test_nothing_of_an_orientation_is_beyond() -> None:
    steep = Variable(
        "joints.J1.plane",
        Angles("plane", dist("normal", mean=85, sd=10), dist("normal", mean=0, sd=90)),
    )
    scatters = steep, Variable("slope.face", Fisher(Plane(80, 5), 2))
    design = replace(_wedge(c=10, phi=30), variables=scatters)
    checked_limits(design)  # refuses none
