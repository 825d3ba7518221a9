"""What a reader sees first is what counts: the factor of ACCEPT, inputs nobody gave, the user's own names."""

import re
from dataclasses import replace
from functools import partial

import pytest

import slopekit as sk
from benchmarks.populations import bench, section
from slopekit.core.sheet import factor_text
from slopekit.design.templates import names, path_of
from slopekit.evidence import Comparisons
from slopekit.kinds.assemblies.many_blocks_design import AssemblyDesign
from slopekit.kinds.sheets.shared import judged_difference, judged_factor
from slopekit.views.pages.report_words import answer
from slopekit.views.solid.stage import Stage

DIPS = ("45/115", "45/245")


def first_factor(result) -> str:
    (entry,) = [line for line in str(result).splitlines() if line.startswith("FoS ")]
    return entry[10:]


def picture_title(result) -> str:
    return Stage(result.to_dict(), result.scene).answer


#: a design, its rules, and the name of the factor that leads; empty: the limit
LED = [
    ("goodman-bray", ["fos.lowest >= 0.7"], "lowest"),
    ("goodman-bray", ["fos >= 0.7"], ""),
    ("goodman-bray", ["fos >= 1.2", "fos.lowest >= 0.7"], ""),  # the limit is what breaks its rule
    ("goodman-bray", ["fos >= 1.0", "fos.lowest >= 1.0"], "lowest"),
    ("goodman-bray", ["fos.static_bound >= 2"], ""),  # an upper bound leads nowhere
    ("goodman-bray", ["fos.lowest <= 0.7"], ""),
    ("surface", ["fos.fellenius >= 1.3"], "fellenius"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("template", "rules", "name"), LED)
def test_the_factor_that_acceptance_hangs_on_leads(template, rules, name) -> None:
    result = sk.run(path_of(template), set={"acceptance": {"rules": rules}})
    document, limit = result.to_dict(), result.fos.limit
    value = limit if not name else result.methods.get(name) or getattr(result.fos, name)
    assert value <= limit
    assert document.get("leading") == ({"name": name, "fos": value} if name else None)
    assert first_factor(result).split()[0] == factor_text(value).strip()
    assert answer(document, [])["exact"] == factor_text(value).strip()
    assert re.search(r"\d\.\d{3,}", result.line).group() == factor_text(value).strip()
    assert (
        re.search(r"FoS (\d\.\d{3,})", picture_title(result)).group(1) == factor_text(value).strip()
    )
    for text in (
        str(result),
        answer(document, [])["what"] if name else "",
        result.line,
        picture_title(result),
    ):
        texts = {factor_text(limit).strip(), judged_factor(limit, result.design.rules)}
        assert (
            any(shown in text for shown in texts) or not text
        )  # the limit stands below, by its name


def test_all_pairs_lead_where_a_rule_judges_by_them() -> None:
    result = sk.wedge(DIPS, criterion="all-pairs", accept=1.5)
    pairs, limit = result.fos.all_pairs_failed, result.fos.limit
    assert pairs < limit
    assert result.leading == ("all_pairs_failed", pairs)
    assert f"  all-pairs {pairs:.3f}, limit {limit:.3f}  agree  met" in result.line
    assert (
        first_factor(result)
        == f"{pairs:.3f}  all pairs failed: the factor that ACCEPT is held against"
    )
    unruled = sk.wedge(DIPS, criterion="all-pairs")
    assert unruled.leading is None
    assert f"  limit {limit:.3f}, all-pairs {pairs:.3f}  agree" in unruled.line


def test_inputs_that_nobody_gave_are_named_on_one_line() -> None:
    line = sk.wedge(DIPS, face="65/180", c=40).line
    assert line.endswith("  W379 (upper, height, phi, density)")
    whole = sk.wedge(DIPS, face="60/180", upper="10/180", height=20, c=40, phi=30, density=2600)
    assert "W379" not in whole.line


def test_a_joint_has_its_own_name_in_what_happens() -> None:
    design = {
        "slopekit": 1,
        "kind": "wedge",
        "slope": {"face": "65/180", "upper": "0/180", "height": 10},
        "joints": {
            "bedding": {"plane": "40/160", "strength": "weak"},
            "J1": {"plane": "80/220", "strength": "weak"},
        },
        "strength": {"weak": {"c": 20, "phi": 30}},
        "rock": {"unit_weight": 26},
    }
    result = sk.run(design)
    said = "slides on bedding, J1 has lost contact"
    assert (result.status, result.status_text) == ("slides_on_J1", said)
    toward = "slides on bedding toward 160/40.0, J1 has lost contact"
    assert f"STATUS    {toward}\n" in str(result)
    assert picture_title(result).startswith(f"{said} · ")
    document = result.to_dict()
    assert answer(document, document["sheet"]["STATUS"])["status"].startswith(toward)


def test_a_plane_has_its_own_name_where_it_was_given_one() -> None:
    for name, said in (("bedding", "slides on bedding"), ("J1", "slides on its plane")):
        design = {
            "slopekit": 1,
            "kind": "plane",
            "slope": {"face": "60/180", "height": 12},
            "joints": {name: {"plane": "35/180", "strength": "weak"}},
            "strength": {"weak": {"c": 20, "phi": 30}},
            "rock": {"unit_weight": 26},
        }
        result = sk.run(design)
        assert (result.status, result.status_text) == ("slides_on_J1", said)
        dry = Comparisons(governs=(("dry", None, "slides_on_J1"),))
        (table,) = replace(result, comparisons=dry).to_dict()["sheet"]["SENSITIVITY"]
        assert table["shown"][0][-1] == said


def test_every_notice_stands_in_the_line() -> None:
    assert "W329" in sk.wedge(DIPS, tension=100).line
    assert "W311" in sk.wedge(DIPS, bolts=["1000@000/10"]).line


# -- factors by block --------------------------------------------------------------------------------------------------


def assemblies() -> list:
    """Designs, and how many mechanisms; benches take as long as all others.

    Bench 5 names ranges. Of the first 60 sections two to four of each sort:
    one row, two and three, names one by one and in ranges, more blocks than are named, what no strength holds.
    """
    every = [
        name
        for name in names()
        if name != "bench" and isinstance(sk.load(path_of(name)), AssemblyDesign)
    ]
    one, two, three, stand = (2, 16), (10, 28, 33, 49), (17, 38), (29, 44, 52, 53)
    return [
        *(pytest.param(path_of(name), 6, id=name) for name in every),
        *(pytest.param(partial(bench, number), 6, id=f"bench {number}") for number in (5,)),
        *(
            pytest.param(section(number), 6, id=f"section {number}")
            for number in (*one, *two, *three, *stand)
        ),
    ]


def test_a_section_whose_second_mechanism_needs_less_strength_than_the_first() -> None:
    """B1 stands by B3 and B4: freed of them it slides at 1.2564, so it fails with them, at 1.3684."""
    result = sk.run(section(572), set={"analysis.mechanisms": 6})
    first, second, third = result.mechanisms
    assert second.fos < first.fos < third.fos
    factors = dict(zip(result.geometry.names, result.scene.factor.tolist(), strict=False))
    assert {name: factors[name] for name in ("B1", "B2", "B3", "B4")} == {
        "B3": first.fos,
        "B4": first.fos,
        "B1": first.fos,
        "B2": third.fos,
    }
    assert "at once: 1 slides (B1)" in str(result)


@pytest.mark.parametrize(
    ("rules", "limit", "pairs", "criterion", "said", "judged"),
    [
        ("fos >= 1.5", 1.5574, None, "limit", "(limit 1.557): MET", ("limit", 1.5574)),
        (
            "fos >= 1.5",
            1.5574,
            1.5489,
            "all-pairs",
            "(all pairs failed 1.549, no higher than the limit): MET",
            ("all_pairs_failed", 1.5489),
        ),
        (
            "fos >= 1.5",
            1.52,
            1.5489,
            "all-pairs",
            "(limit 1.520, no higher than the factor of all pairs): MET",
            ("limit", 1.52),
        ),
        (
            "fos >= 1.5",
            1.52,
            None,
            "all-pairs",
            "(all-pairs): NOT MET (there is no such number here)",
            (None, None),
        ),
        ("fos.closed_form >= 1.5", 1.2, None, "limit", "(1.557): MET", ("closed_form", 1.5571)),
        (
            "fos >= 1.5",
            1.49999996,
            None,
            "limit",
            "(limit 1.49999996): NOT MET",
            ("limit", 1.49999996),
        ),
    ],
)
def test_a_rule_says_which_number_it_judged(rules, limit, pairs, criterion, said, judged) -> None:
    """By name and value, on the sheet and in JSON; in as many digits as show on which side of the rule it lies."""
    found = sk.run(
        path_of("paper-wedge"), set={"acceptance.rules": [rules], "analysis.criterion": criterion}
    )
    found = replace(
        found, fos=replace(found.fos, limit=limit, closed_form=1.5571, all_pairs_failed=pairs)
    )
    (line,) = [line for line in str(found).splitlines() if line.startswith("ACCEPT")]
    assert line == f"ACCEPT    {rules} {said}"
    (rule,) = found.to_dict()["rules"]
    assert (rule["judged"], rule["fos"]) == judged


def test_a_rule_on_many_blocks_says_how_large_its_mechanism_is() -> None:
    found = sk.run(path_of("topple"), set={"acceptance.rules": ["fos >= 1.2", "fos.lowest >= 1.2"]})
    first, lowest = found.findings.first.size.volume_m3, factor_text(found.fos.lowest)
    text = re.sub(r"\n {13}", " ", str(found))  # a folded line as one
    lines = text.splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("ACCEPT"))
    of_first = f"fos >= 1.2 (limit {factor_text(found.fos.limit)} of the critical block or group, {first:.4g} m³)"
    assert lines[at : at + 2] == [
        f"ACCEPT    {of_first}: MET (lowest estimate {lowest})",
        f"{'':10}fos.lowest >= 1.2 ({lowest}): MET",
    ]


def test_what_nothing_drives_meets_a_rule_without_a_number_and_says_so() -> None:
    found = sk.run(path_of("paper-wedge"), set={"acceptance.rules": ["fos >= 1.5"]})
    found = replace(
        found, status="no_driving_force", fos=replace(found.fos, limit=None, all_pairs_failed=None)
    )
    assert (
        "fos >= 1.5 (all-pairs): MET (it stands without any strength: there is no factor to judge)"
        in str(found)
    )
    assert found.to_dict()["rules"] == [
        {"rule": "fos >= 1.5", "met": True, "judged": None, "fos": None}
    ]


@pytest.mark.parametrize(
    ("difference", "agree", "text"),
    [
        (0.0, True, "AGREE within 0.0001 %"),
        (1.04e-4, True, "AGREE within 0.011 %"),
        (0.00996, True, "AGREE within 1 %"),
        (0.01004, False, "DISAGREE by 1.1 % (limit 1 %)"),
        (None, True, "AGREE (no number from either)"),
    ],
)
def test_two_methods_never_look_nearer_than_they_are(difference, agree, text) -> None:
    """`within` is rounded up: what is printed bounds what was found."""
    assert judged_difference(difference, agree, 0.01) == text
