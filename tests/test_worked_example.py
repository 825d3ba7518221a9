"""The numbers of docs/worked-example.md found again with numpy alone.

That the page shows what the program prints is held by `tests/test_docs.py`; here its numbers are computed from survey
and design by other means: eigenvectors, vectors on the wedge's own corners, counting. The places along the bench are
drawn as slopekit draws them (the same stream of random numbers), what becomes of them is not, by forces; whether
moments turn what forces leave less than 5 % is asked of a run of each block by itself. Tolerances are those of
the digits that are printed. Left out: limits by redrawing the survey, the width of spilt rock, t limits of mean
spacings, wedges that friction alone does not hold.
"""

import csv
import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from slopekit.kinds import factors_of
from slopekit.studies.points import falls_short

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs/worked-example.md").read_text(encoding="utf-8")
FACE, HEIGHT, COHESION, WEIGHT = 65.0, 15.0, 5.0, 2600.0 * 9.81 / 1000.0
OUT = np.array([0.0, -1.0, 0.0])  # toward 180
CLOSE = 1.05  # factor of the forces: below it moments are asked for
NUMBER = r"-?\d+(?:\.\d+)?"


def numbers(pattern: str) -> list[float]:
    """The numbers of the one line of the page that begins so."""
    found = [line for line in PAGE.splitlines() if re.match(pattern, line)]
    assert len(found) == 1, (pattern, found)
    return [float(one) for one in re.findall(NUMBER, found[0][re.match(pattern, found[0]).end() :])]


def normals(dip, to):
    """Upward, (..., 3)."""
    dip, to = np.radians(dip), np.radians(to)
    return np.stack([np.sin(dip) * np.sin(to), np.sin(dip) * np.cos(to), np.cos(dip)], axis=-1)


@cache
def survey():
    """Names of sets and columns of numbers, phi 32 where none was measured."""
    lines = (ROOT / "examples/bench-survey.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    keys = {"dip": "dip", "to": "dip_direction", "spacing": "spacing (m)", "trace": "trace (m)"}
    found = {key: np.array([float(row[name]) for row in rows]) for key, name in keys.items()}
    found["tilt"] = np.array([float(row["phi"] or "nan") for row in rows])
    found["phi"] = np.where(np.isnan(found["tilt"]), 32.0, found["tilt"])
    return np.array([row["set"] for row in rows]), found


def beside(to, toward: float):
    return np.abs((to - toward + 180.0) % 360.0 - 180.0)


# -- the survey -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["S1", "S2", "S3", "S4"])
def test_sets(name) -> None:
    """Means by the first eigenvector, K = (N - 1) / (N - R) (Fisher 1953)."""
    names, of = survey()
    some = names == name
    poles = normals(of["dip"][some], of["to"][some])
    mean = np.linalg.eigh(poles.T @ poles)[1][:, -1]
    mean = mean * np.sign(mean[2])
    resultant = np.linalg.norm((poles * np.sign(poles @ mean)[:, None]).sum(axis=0))
    dip, to = math.degrees(math.acos(mean[2])), math.degrees(math.atan2(mean[0], mean[1])) % 360.0
    count, shown_dip, shown_to, k, *_ = numbers(rf"(SETS)? +{name}(?= +\d+ +[\d.]+/)")
    assert (count, shown_dip, shown_to) == (some.sum(), round(dip, 1), round(to, 1))
    assert f"{k:.3g}" == f"{(count - 1.0) / (count - resultant):.3g}"
    low, high, cone, inner, outer = numbers(rf"(SETS)? +{name}(?= +\d+ +[\d.]+/)")[4:]
    turns = 2.0 * (
        count - 1.0
    )  # of chi-square (Wilson & Hilferty 1931), N - R being as many halves of 1 / K
    for one, z in ((low, -1.959964), (high, 1.959964)):
        part = (1.0 - 2.0 / (9.0 * turns) + z * math.sqrt(2.0 / (9.0 * turns))) ** 3
        assert one == pytest.approx((count - 1.0) / (count - resultant) * part, rel=5e-3)
    away = (count - resultant) / resultant * (20.0 ** (1.0 / (count - 1.0)) - 1.0)
    assert cone == pytest.approx(math.degrees(math.acos(1.0 - away)), abs=0.0501)
    exact = (count - 1.0) / (count - resultant)
    for one, held in ((inner, 0.68), (outer, 0.95)):
        assert one == pytest.approx(
            math.degrees(math.acos(1.0 + math.log(1.0 - held) / exact)), abs=0.0501
        )
    for end, key in (("  column", "spacing"), ("$", "trace")):
        row = numbers(rf" +{name}(?= +\d+ +[\d.]+ m +[\d.]+ to [\d.]+ +[\d.]+ m{end})")
        number, mean, _, _, spread = row[:5]
        found = of[key][some].mean(), of[key][some].std(ddof=1)
        assert (number, mean, spread) == (count, *(float(f"{one:.3g}") for one in found))


def test_scatter_in_the_text() -> None:
    """√(2 / K), the root mean square angle to the mean."""
    k = [numbers(rf" +{name}(?= +\d+ +[\d.]+/)")[3] for name in ("S1", "S2")]
    said = re.search(r"scatter by (\d+)° and (\d+)°", PAGE)
    assert [round(math.degrees(math.sqrt(2.0 / one))) for one in k] == [
        int(one) for one in said.groups()
    ]


def test_kinematics() -> None:
    """Planes and lines that daylight and are steeper than friction; forces say on how many joints a wedge slides."""
    names, of = survey()
    face = normals(FACE, 180.0)
    within = beside(of["to"], 180.0)
    n = normals(of["dip"], of["to"])
    down = np.stack([n[:, 0] * n[:, 2], n[:, 1] * n[:, 2], n[:, 2] ** 2 - 1.0], axis=-1)
    free = (down @ face > 0.0) & (of["dip"] >= of["phi"])
    planar, total, _, without = numbers("PLANAR ")[:4]  # friction that just holds counts as none
    assert (planar, total) == ((free & (within <= 20.0)).sum(), len(names))
    assert without == free.sum()
    flexural = (beside(of["to"], 0.0) <= 30.0) & (of["dip"] >= 90.0 - FACE + of["phi"])
    assert numbers("FLEXURAL ")[:3] == [flexural.sum(), total, round(100.0 * flexural.mean(), 1)]
    assert numbers("PLANAR ")[2::3] == [round(100.0 * one / total, 1) for one in (planar, without)]

    i, j = np.triu_indices(len(names), 1)
    line = np.cross(n[i], n[j])
    size = np.linalg.norm(line, axis=1)
    real = size > 1e-6
    i, j, line = i[real], j[real], line[real] / size[real, None]
    line = line * -np.sign(line[:, 2])[:, None]
    plunge = np.degrees(np.arcsin(-line[:, 2]))
    primary = (line @ face > 0.0) & (plunge > np.minimum(of["phi"][i], of["phi"][j]))
    first, lines, share, both = numbers("WEDGE  +primary")[:4]
    assert (first, lines, share) == (
        primary.sum(),
        real.sum(),
        round(100.0 * primary.sum() / real.sum(), 1),
    )
    some = i[primary], j[primary]
    corners = wedge(n[some[0]], n[some[1]], FACE, np.ones(primary.sum()))
    on_both = (slides(n[some[0]], n[some[1]], *corners, 30.0, 30.0)[3] > 0.0).all(axis=-1)
    alone = float(re.search(rf"slide on both joints, ({NUMBER}) on one", PAGE)[1])
    assert (both, alone) == (on_both.sum(), (~on_both).sum())
    pair = (names[i] == "S1") & (names[j] == "S2") | (names[i] == "S2") & (names[j] == "S1")
    assert numbers(" +S1 x S2")[:2] == [pair.sum(), (pair & primary).sum()]


# -- the bench --------------------------------------------------------------------------------------------------------


def wedge(n1, n2, face_dip: float, height):
    """Corners A, B on the crest and P on the upper slope of wedges with their toe at 0, (..., 3): level ground."""
    face = normals(face_dip, 180.0)

    def corner(a, b):
        way = np.cross(a, b)
        with np.errstate(all="ignore"):
            return way * (height / way[..., 2])[..., None]

    return corner(n1, face), corner(n2, face), corner(n1, n2)


def slides(n1, n2, a, b, p, phi1, phi2, c=COHESION, weight=WEIGHT):
    """Factors of wedges by vectors on their corners, dry: on both joints, or on one where the other opens."""
    volume = np.abs(np.einsum("...i,...i", np.cross(a, b), p)) / 6.0
    areas = [np.linalg.norm(np.cross(q, p), axis=-1) / 2.0 for q in (a, b)]
    # into the wedge: toward the corner that is not on the joint
    one = n1 * np.sign(np.einsum("...i,...i", n1, b))[..., None]
    two = n2 * np.sign(np.einsum("...i,...i", n2, a))[..., None]
    along = -p / np.linalg.norm(p, axis=-1)[..., None]
    load = np.zeros(p.shape)
    load[..., 2] = -weight * volume
    matrix = np.stack([-one, -two, along], axis=-1)  # load = -N1 n1 - N2 n2 + S l
    with np.errstate(all="ignore"):
        push = np.linalg.solve(matrix, load[..., None])[..., 0]
    tan = [np.tan(np.radians(phi)) for phi in (phi1, phi2)]
    both = (c * (areas[0] + areas[1]) + push[..., 0] * tan[0] + push[..., 1] * tan[1]) / push[
        ..., 2
    ]
    single = []
    for k, own in enumerate((one, two)):
        normal = -np.einsum("...i,...i", load, own)
        driving = np.linalg.norm(load + normal[..., None] * own, axis=-1)
        with np.errstate(all="ignore"):
            single.append(
                np.where(normal > 0.0, (c * areas[k] + normal * tan[k]) / driving, np.nan)
            )
    on_both = (push[..., 0] >= 0.0) & (push[..., 1] >= 0.0)
    factor = np.where(on_both, both, np.where(push[..., 0] < 0.0, single[1], single[0]))
    return factor, volume, areas, push[..., :2]


@cache
def places():
    """Two different joints at each of 10,000 places, and where on the face they meet: the stream of seed 1."""
    rng = np.random.default_rng([1, 0xBE7C])
    joints, count = len(survey()[0]), 10_000
    even = np.full(joints, 1.0 / joints)
    first, second = (rng.choice(joints, count, p=even) for _ in range(2))
    while (same := np.flatnonzero(first == second)).size:
        first[same], second[same] = (rng.choice(joints, same.size, p=even) for _ in range(2))
    return first, second, rng.random(count)


@cache
def becomes(face_dip: float):
    """Of each mode whether it forms, fails, what it takes of the crest and how wide: (3, n) each."""
    _, of = survey()
    first, second, toe = places()
    up, cot = HEIGHT * (1.0 - toe), 1.0 / math.tan(math.radians(face_dip))
    step = every()
    n = normals(of["dip"], of["to"])

    n1, n2 = n[first], n[second]
    a, b, p = wedge(n1, n2, face_dip, up)
    with np.errstate(all="ignore"):  # parallel joints have no line
        behind = -(p - a) @ OUT
        edges = [
            np.max([np.linalg.norm(part, axis=1) for part in (q, p - q, p)], axis=0) for q in (a, b)
        ]
        reach = (edges[0] <= of["trace"][first]) & (edges[1] <= of["trace"][second])
    forms = [(behind > 0.0) & reach & np.isfinite(p).all(axis=1)]
    whole = np.flatnonzero(forms[0])
    factor = np.full(len(toe), np.nan)
    factor[whole] = slides(
        *(q[whole] for q in (n1, n2, a, b, p)), of["phi"][first[whole]], of["phi"][second[whole]]
    )[0]
    fails, sets, widths = [factor < 1.0], [behind], [np.linalg.norm(a - b, axis=1)]
    for k in np.flatnonzero((factor >= 1.0) & (factor < CLOSE)):
        fails[0][k] = turns(of, (first[k], second[k]), face_dip, up[k])

    dip, phi = np.radians(of["dip"][first]), np.radians(of["phi"][first])
    long = up / np.sin(dip)
    forms.append(
        (beside(of["to"][first], 180.0) <= 20.0)
        & (of["dip"][first] < face_dip)
        & (long <= of["trace"][first])
    )
    weight = WEIGHT * up * up * (1.0 / np.tan(dip) - cot) / 2.0
    with np.errstate(all="ignore"):  # as steep as the face
        factor = (COHESION * long + weight * np.cos(dip) * np.tan(phi)) / (weight * np.sin(dip))
    fails.append(forms[1] & (factor < 1.0))
    for k in np.flatnonzero(forms[1] & (factor >= 1.0) & (factor < CLOSE)):
        fails[1][k] = turns(of, (first[k],), face_dip, up[k])
    sets.append(up * (1.0 / np.tan(dip) - cot))
    widths.append(np.full(len(toe), step))

    forms.append(np.zeros(len(toe), dtype=bool))
    fails.append(np.zeros(len(toe), dtype=bool))
    sets.append(np.zeros(len(toe)))
    widths.append(np.full(len(toe), step))
    for steep, base in ((first, second), (second, first)):
        for k in np.flatnonzero(~forms[2]):
            found = columns(of, steep[k], base[k], face_dip, up[k])
            if found is not None:
                forms[2][k], (fails[2][k], sets[2][k]) = True, found
    return np.array(forms), np.array(fails), np.array(sets), np.array(widths)


def turns(of, joints: tuple[int, ...], face_dip: float, height: float) -> bool:
    """Whether moments bring the limit of a wedge, or of a plane in its section, below 1: slopekit's of it alone."""
    names = ("J1", "J2")[: len(joints)]
    planes = [[of["dip"][one], of["to"][one] if len(joints) > 1 else 180.0] for one in joints]
    phis = [of["phi"][one] for one in joints]
    factors = factors_of(
        sk.load(
            {
                "slopekit": 1,
                "kind": ("plane", "wedge")[len(joints) - 1],
                "rock": {"unit_weight": WEIGHT},
                "slope": {"face": [face_dip, 180], "upper": [0, 180], "height": float(height)},
                "joints": {
                    name: {"plane": list(map(float, plane)), "strength": name}
                    for name, plane in zip(names, planes, strict=True)
                },
                "strength": {
                    name: {"c": COHESION, "phi": float(phi)}
                    for name, phi in zip(names, phis, strict=True)
                },
            }
        )
    )
    assert factors.closed_form >= 1.0
    return falls_short(factors.status, factors.limit, 1.0)


def columns(of, steep: int, base: int, face_dip: float, height: float):
    """Columns between joints like `steep` on `base`, one after the other from the crest back: whether the first turns
    over, and how far behind the crest the last one that does ends (Goodman & Bray 1976)."""
    into, toward = beside(of["to"][steep], 0.0), beside(of["to"][base], 180.0)
    side, bottom, friction = of["dip"][steep], of["dip"][base], of["phi"][steep]
    if (
        into > 30.0
        or toward > 30.0
        or side >= 90.0
        or bottom >= face_dip
        or 90.0 - face_dip + friction > side
    ):
        return None
    side, bottom, width = math.radians(side), math.radians(bottom), of["spacing"][steep]
    run = height / math.tan(math.radians(face_dip))

    def deep(behind: float) -> float:
        """Down the side of a column whose top lies so far behind the crest, to the base (which daylights at 0)."""
        # top (run + s, h), down the side: x grows, since it dips into the slope
        return (height - (run + behind) * math.tan(bottom)) / (
            math.sin(side) + math.cos(side) * math.tan(bottom)
        )

    first = deep(0.0)
    # the foot of the first column: where the base must reach, and the side's own length
    left = of["trace"][base] * math.cos(bottom) - (run + first * math.cos(side))
    if first <= 0.0 or first > of["trace"][steep] or left <= 0.0:
        return None
    apart, wide = width / math.sin(side), width / math.sin(side + bottom)
    most = math.floor(min(left, height) / apart)
    many = 0
    # of weight alone: it turns about its toe where y cos ψ_d > b cos ψ_b
    while many < most and deep(many * apart) * math.cos(side) > wide * math.cos(bottom):
        many += 1
    return many > 0, many * apart


@cache
def every() -> float:
    """From joint to joint along the bench: each set is met |n · t| / spacing times a metre."""
    names, of = survey()
    met = np.abs(normals(of["dip"], of["to"])[:, 0])
    return 1.0 / sum(
        met[names == one].mean() / of["spacing"][names == one].mean() for one in set(names)
    )


def shown(label: str, face_dip: float) -> list[list[float]]:
    """The rows of a table of the bench-design, of one face."""
    text = PAGE.split(f"\n{label} ")[1].split("\nBEST")[0]
    text = re.split(r"\n[A-Z]", text)[0]
    rows = re.findall(rf"^ +15 m +{face_dip:.0f}° +(.*)$", text, re.MULTILINE)
    return [[float(one) for one in re.findall(NUMBER, row)] for row in rows]


@pytest.mark.parametrize("face_dip", [65.0, 70.0, 75.0])
def test_what_forms_and_fails(face_dip) -> None:
    """Counted place by place."""
    forms, fails, _, _ = becomes(face_dip)
    mine = [value for pair in zip(forms, fails, strict=True) for value in pair] + [
        fails.any(axis=0)
    ]
    (row,) = shown("FAILS", face_dip)
    assert row[:7] == pytest.approx([100.0 * one.mean() for one in mine], abs=0.0501)


@pytest.mark.parametrize("face_dip", [65.0, 70.0, 75.0])
def test_berms(face_dip) -> None:
    """Catch width, what is kept, what is left, and the angle from toe to toe."""
    _, fails, sets, widths = becomes(face_dip)
    lost = np.where(fails, sets, 0.0)
    which = lost.argmax(axis=0), np.arange(lost.shape[1])
    lost, long = (
        lost[which],
        np.where(fails.any(axis=0), np.maximum(widths[which], every()), every()),
    )
    catch, cot = 0.2 * HEIGHT + 4.5, 1.0 / math.tan(math.radians(face_dip))
    order = np.argsort(lost)
    share = np.cumsum(long[order]) / long.sum()
    at = {part: lost[order][np.searchsorted(share, part)] for part in (0.8, 0.95)}

    def ramp(berm: float) -> float:
        return math.degrees(math.atan2(HEIGHT, HEIGHT * cot + berm))

    rows = shown("BERMS", face_dip)
    assert [row[0] for row in rows] == [6.0, 9.0, 11.0]
    for berm, shown_catch, kept, low, _, left80, left95, _, angle in (row[:9] for row in rows):
        share_kept = 100.0 * long[berm - lost >= catch].sum() / long.sum()
        assert (shown_catch, round(kept, 1)) == (catch, pytest.approx(share_kept, abs=0.0501))
        assert low < kept or kept == 0.0
        assert (left80, left95) == pytest.approx(
            [max(0.0, berm - at[0.8]), max(0.0, berm - at[0.95])], abs=0.00501
        )
        assert angle == pytest.approx(ramp(berm), abs=0.0501)
    (needed,) = shown("NEEDED", face_dip)
    assert needed[:3] == pytest.approx([catch, at[0.8], catch + at[0.8]], abs=0.00501)
    assert needed[3] == pytest.approx(ramp(catch + at[0.8]), abs=0.0501)


def test_the_choice() -> None:
    """The steepest toe-to-toe angle among the berms whose lower limit reaches 80 %."""
    rows = [
        (row[8], row[0], dip)
        for dip in (65.0, 70.0, 75.0)
        for row in shown("BERMS", dip)
        if row[3] >= 80.0
    ]
    angle, berm, dip = max(rows)
    said = re.search(
        rf"steepest of these: 15 m at ({NUMBER})°, berm ({NUMBER}) m, inter-ramp ({NUMBER})°", PAGE
    )
    assert [float(one) for one in said.groups()] == [dip, berm, angle]
    chosen = re.search(
        rf"Chosen: 15 m at ({NUMBER})° with berms of ({NUMBER}) m, ({NUMBER})°", PAGE
    )
    assert [float(one) for one in chosen.groups()] == [dip, berm, angle]
    assert f"{len(rows)} of 9 reach 80 %" in PAGE
    best, at, wide = max(
        (row[3], dip, row[2]) for dip in (65.0, 70.0, 75.0) for row in shown("NEEDED", dip)
    )
    assert f"80 %: {best:.1f}° with benches of 15 m at {at:.0f}° and berms of {wide:.2f} m" in PAGE


# -- the wedge --------------------------------------------------------------------------------------------------------


@cache
def block():
    """Joint normals, corners and friction angles of the design."""
    names, of = survey()
    planes = re.findall(rf"S(\d): {{plane: ({NUMBER})/({NUMBER}), strength", PAGE)[:2]
    n1, n2 = (normals(float(dip), float(to)) for _, dip, to in planes)
    phi = [float(one) for one in re.findall(rf"S\d: {{c: 5 kPa, phi: ({NUMBER})}}", PAGE)[:2]]
    assert phi == [round(np.nanmean(of["tilt"][names == one]), 1) for one in ("S1", "S2")]
    return n1, n2, *wedge(n1, n2, FACE, np.array(HEIGHT)), phi


def factor_with(pull: float, k: float) -> float:
    """By vectors: what shares the load between the joints, bolts of a capacity `pull` toward 000/10 divided by F.

    The earthquake is level, the way of the line of intersection.
    """
    n1, n2, a, b, p, phi = block()
    _, volume, areas, _ = slides(n1, n2, a, b, p, *phi)
    tan = np.tan(np.radians(phi))
    weight = WEIGHT * volume
    line = -p / np.linalg.norm(p)
    level = line * [1.0, 1.0, 0.0] / math.hypot(line[0], line[1])
    toward = np.array([0.0, math.cos(math.radians(10.0)), -math.sin(math.radians(10.0))])
    low, high = 0.1, 10.0
    for _ in range(100):
        middle = (low + high) / 2.0
        load = np.array([0.0, 0.0, -weight]) + k * weight * level + pull / middle * toward
        n_1, n_2, driving = np.linalg.solve(np.stack([-n1, -n2, line], axis=-1), load)
        assert min(n_1, n_2) > 0.0
        resisting = (COHESION * sum(areas) + n_1 * tan[0] + n_2 * tan[1]) / middle
        low, high = (middle, high) if resisting > driving else (low, middle)
    return low


def test_the_wedge_bare_and_bolted() -> None:
    """Both load cases without bolts and with them; the force by the condition that F is 1.5."""
    bolts = [float(one) for one in re.findall(rf"- {{force: ({NUMBER}) kN, toward: 0/10", PAGE)]
    (said,) = re.findall(rf"The static case governs: (\d+) passive bolts, ({NUMBER}) kN", PAGE)
    assert (int(said[0]), float(said[1])) == (len(bolts), pytest.approx(sum(bolts), abs=0.06))
    for name, k, wanted in (("static", 0.0, 1.5), ("quake", 0.1, 1.1)):
        one, force = numbers(rf" +{name} .* reached ")[-1], factor_with(0.0, k)
        assert factor_with(one, k) == pytest.approx(wanted, abs=5e-5)
        rows = [
            row
            for row in PAGE.splitlines()
            if re.match(rf" +{name} +(\d\.|loads).*\d\.\d{{3}}", row)
        ]
        factors = [re.findall(r"\b\d\.\d{3}\b", row) for row in rows]
        bolted = factor_with(sum(bolts), k)
        assert factors == [
            [f"{value:.3f}"] * 2 for value in (force, bolted)
        ]  # every digit of the page


def test_lengths_of_the_bolts_and_volume_of_the_drawing() -> None:
    """From the head along the bolt to behind the joint where it leaves the wedge, and 3 m of anchorage; rounded up."""
    n1, n2, a, b, p, phi = block()
    _, volume, _, _ = slides(n1, n2, a, b, p, *phi)
    bolts = re.findall(r"toward: 0/10, acts: passive,\s+head: \[(.*?)\], length: (\S+) m", PAGE)
    drawn = re.search(rf"1 block, (\d+) bolts, ({NUMBER}) m³", PAGE)
    assert (int(drawn[1]), float(drawn[2])) == (len(bolts), pytest.approx(float(volume), abs=5e-7))
    toward = np.array([0.0, math.cos(math.radians(10.0)), -math.sin(math.radians(10.0))])
    for head, length in bolts:
        at = np.array([float(one) for one in head.split(",")])
        assert at @ normals(FACE, 180.0) == pytest.approx(0.0, abs=1e-5)
        through = min(-(n @ at) / (n @ toward) for n in (n1, n2) if n @ toward < 0.0)
        assert -1e-9 < float(length) - (through + 3.0) < 0.1 + 1e-5  # in steps of 0.1 m
