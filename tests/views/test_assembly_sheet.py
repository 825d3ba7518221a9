"""The sheet of many blocks: what it says, that it says it shortly, and that it leaves nothing out unsaid."""

import re
from dataclasses import replace

import pytest

import slopekit as sk
from slopekit.design.templates import path_of
from slopekit.evidence import FactorsOfSafety
from slopekit.kinds import kind_of
from slopekit.kinds.words import first_and_last, in_order, names_in_runs
from tests.views.scenes import (
    bench,
    goodman_bray,
    interfaces,
    mechanism,
    motions,
    result,
    two_blocks,
)


def labels(text: str) -> list[str]:
    """The labels of a sheet in order, the head line without."""
    return [line[:10].strip() for line in text.splitlines()[1:] if line[:1] != " "]


def part(text: str, label: str) -> str:
    """One part of the sheet with its spaces reduced to one."""
    lines, inside = [], False
    for line in text.splitlines()[1:]:
        inside = line.startswith(label) if line[:1] != " " else inside
        if inside:
            lines.append(line[10:])
    return re.sub(r"\s+", " ", " ".join(lines)).strip()


EVERY = {"goodman_bray": goodman_bray, "bench": bench, "blocks": two_blocks}


@pytest.mark.parametrize("name", EVERY)
def test_every_sheet_fits_the_page_and_has_its_parts(name) -> None:
    sheet = EVERY[name]().sheet
    first = {"goodman_bray": "COLUMNS", "bench": "SETS", "blocks": "BLOCKS"}[name]
    for text in (str(sheet), sheet.full):
        assert max(map(len, text.splitlines())) <= 100
        assert not any(line.endswith(" ") for line in text.splitlines())
        assert len(labels(text)) == len(set(labels(text)))
    details = {"FORCES", "MOVES", "CHECKS", "MODEL", "TIME"}
    assert labels(str(sheet))[:5] == [first, "SIZE", "LOADS", "STATUS", "FoS"]
    assert not details & set(labels(str(sheet)))
    assert labels(sheet.full)[:6] == [first, "SIZE", "LOADS", "FORCES", "STATUS", "FoS"]
    assert details <= set(labels(sheet.full))
    assert "left out: bedrock (no unknowns), deformation of the rock" in part(sheet.full, "MODEL")


# -- names ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ([], ""),
        (["C4"], "C4"),
        (["C4", "C5"], "C4, C5"),
        (["C4", "C5", "C6"], "C4 to C6"),
        (["C9", "C10", "C11"], "C9 to C11"),
        (["A1", "A2", "A3", "B4", "B5", "B6"], "A1 to A3, B4 to B6"),
        (["C1-1", "C2-1", "C3-1", "C1-2", "C2-2"], "C1-1 to C3-1, C1-2, C2-2"),
        (["C1-1", "C2-2", "C3-3"], "C1-1, C2-2, C3-3"),
        (["left", "right", "top", "bottom", "key"], "left, right, top, bottom, ... and 1 more"),
        ([f"B{k}" for k in range(1, 80, 2)], "B1, B3, B5, B7, ... and 36 more"),
    ],
)
def test_names_in_runs(names, words) -> None:
    assert names_in_runs(names) == words


def test_names_are_put_in_the_order_of_the_blocks() -> None:
    order = {"C1": 0, "C2": 1, "C10": 2}
    assert in_order(["C10", "other", "C2", "C1"], order) == ["C1", "C2", "C10", "other"]


@pytest.mark.parametrize(("count", "kept"), [(3, 3), (4, 4), (5, 3), (100, 3)])
def test_a_line_is_never_replaced_by_a_line_about_it(count, kept) -> None:
    first, between, last = first_and_last(range(count), 2, 1)
    assert len(first) + len(last) == kept
    assert len(first) + between + len(last) == count


# -- the answer -----------------------------------------------------------------------------------


def test_goodman_and_brays_columns() -> None:
    """Heights and table of Goodman & Bray (1976) as in tests/validation; PRE-IE beside it is made up."""
    text = goodman_bray().sheet.full
    columns = part(text, "COLUMNS")
    assert "16 columns, C1 at the toe, 10 m wide, dip 60° into the slope" in columns
    assert "bases dip 30° out of the slope, each 1 m above the one below" in columns
    assert "heights 4 to 40 m (C10 the tallest), from the toe upward: 4, 8, 12, 16," in columns
    assert "c 0 kPa φ 38.15°" in columns
    assert part(text, "STATUS") == "blocks topple: 10 topple (C4 to C13), 2 slide (C2, C3), 4 stay"
    fos = part(text, "FoS")
    assert fos.startswith(
        "1.001 limit of the elastic path 0.99996 Goodman & Bray closed form AGREE within 0.06"
    )
    assert (
        " % none range for other load paths and locked-in stresses: not found 1.190 upper bound"
        in fos
    )
    assert fos.endswith("upper bound (associated flow), not for design")
    moves = part(text, "MOVES")
    assert "fastest C4, which topples toward 270/26.6 (x is 090)" in moves
    assert "40.0 % C4/C3 joint slips N' 2825.5 kN (256.9 kPa)" in moves
    assert (
        "10.0 % bedrock/C1 joint slips and opens N' 812.4 kN (81.24 kPa) 50.0 % ... the others together"
        in moves
    )
    assert "of 60 node pairs 12 stick, 30 slip, 18 are open (they carry nothing, or part)" in moves
    assert part(text, "MECHANISM") == "3 columns are left; one mechanism was asked for"


def test_the_table_of_the_columns() -> None:
    """From the highest column down, as the book prints it; what PRE-IE has differently is marked and counted."""
    table = part(goodman_bray().sheet.full, "TABLE")
    assert table.startswith(
        "Goodman & Bray's columns, strength divided by 1.001; y, M, L in m, P in kN"
    )
    assert table.index(" 16 4.00 - 4.00 -832.53") < table.index(" 13 22.00 17.00 22.00 292.47 ")
    assert "topple | topple 9 36.00" in table
    assert " 3 12.00 12.00 7.00 1102.66 1412.58 1412.58 slide | topple < 2 " in table
    assert table.endswith("the modes are the same in 15 of 16 columns; not in C3")


@pytest.mark.parametrize(("count", "left_out"), [(40, 0), (41, 11), (60, 30)])
def test_a_long_table_says_what_it_leaves_out(count, left_out) -> None:
    text = goodman_bray([4.0 + k % 30 for k in range(count)]).sheet.full
    rows = re.findall(r"(?m)^\s+(\d+)\s.*\|", text)
    assert len(rows) == count - left_out
    assert (rows[0], rows[-1]) == (str(count), "1")
    assert (f"... {left_out} columns left out here" in text) == bool(left_out)


@pytest.mark.parametrize("status", ["falls", "lifted", "no_driving_force", "not_converged"])
def test_no_factor_is_a_reason_and_never_a_number(status) -> None:
    found = two_blocks(status)
    fos = part(str(found), "FoS")
    assert fos.startswith(f"none limit of the elastic path: {found.status_text}")
    assert "range for" not in fos
    assert ("largest unbalanced force" in part(found.sheet.full, "CHECKS")) == (
        status == "no_driving_force"
    )
    assert not re.search(r"\d\.\d|∞|inf", fos)
    assert part(str(found), "STATUS").startswith(found.status_text)


@pytest.mark.parametrize(
    ("lowest", "highest", "said"),
    [
        (1.1, 1.4, "1.100 .. 1.400 range for"),
        (None, 1.4, "none .. 1.400 range for"),
        (None, None, "none range for"),
    ],
)
def test_the_range_of_the_mechanism_stands_below_the_limit(lowest, highest, said) -> None:
    """Where neither end was found the line says that."""
    one = mechanism("slides", 1.25, motions(["B1", "B2"], "slides"))
    found = result(sk.load(path_of("blocks")), [one], ["base", "B1", "B2"], ["base"])
    fos = FactorsOfSafety(limit=1.25, static_bound=1.5, lowest=lowest, highest=highest)
    text = part(str(replace(found, fos=fos)), "FoS")
    assert text.startswith("1.250 limit of the elastic path")
    none = "" if lowest or highest else ": not found"
    assert f"{said} other load paths and locked-in stresses{none} 1.500 upper bound" in text


@pytest.mark.parametrize(
    ("basis", "change", "said"),
    [
        ("limit", 0.0, "1.250 limit of the elastic path (k_t/k_n 0.4) none closed form"),
        ("settled", 0.0, "1.250 limit of the elastic path (k_t/k_n 0.4), settled none closed form"),
        (
            "peak",
            0.004,
            "1.250 last stable state of the elastic path (k_t/k_n 0.4); fails at 1.255, 0.4 %",
        ),
        ("peak", 0.0, "1.250 last stable state of the elastic path (k_t/k_n 0.4) none closed form"),
    ],
)
def test_the_headline_says_what_it_rests_on(basis, change, said) -> None:
    one = mechanism("slides", 1.25, motions(["B1", "B2"], "slides"), change=change, basis=basis)
    found = result(sk.load(path_of("blocks")), [one], ["base", "B1", "B2"], ["base"])
    assert found.findings is not None
    found = replace(found, findings=replace(found.findings, shear_to_normal=0.4))
    assert part(str(found), "FoS").startswith(said)
    first = found.to_dict()["mechanisms"][0]
    assert (first["basis"], first["change"]) == (basis, change)
    assert found.to_dict()["assembly"]["shear_to_normal"] == 0.4


@pytest.mark.parametrize(
    ("rule", "lowest", "said"),
    [
        ("fos >= 1.2", 1.1, "MET, but not by the lowest estimate 1.100"),
        ("fos.limit >= 1.2", 1.1, "MET, but not by the lowest estimate 1.100"),
        ("fos >= 1.2", 1.2, "MET (lowest estimate 1.200)"),
        ("fos >= 1.05", 1.1, "MET (lowest estimate 1.100)"),
        ("fos >= 1.2", None, "MET"),
        ("fos <= 1.3", 1.2, "MET"),
        ("fos.lowest >= 1.05", 1.1, "MET"),
        ("fos.lowest >= 1.2", 1.1, "NOT MET"),
        ("fos.lowest >= 1.05", None, "NOT MET (there is no such number here)"),
        ("fos >= 1.3", 1.1, "NOT MET"),
    ],
)
def test_a_rule_says_whether_it_is_met_for_every_locked_in_force(rule, lowest, said) -> None:
    design = sk.load(path_of("blocks"), set={"acceptance.rules": [rule]})
    one = mechanism("slides", 1.25, motions(["B1", "B2"], "slides"))
    found = result(design, [one], ["base", "B1", "B2"], ["base"])
    text = part(
        str(replace(found, fos=FactorsOfSafety(limit=1.25, lowest=lowest, highest=1.4))), "ACCEPT"
    )
    assert text.endswith(f": {said}")


def test_what_stays_is_counted() -> None:
    text = part(str(two_blocks()), "STATUS")
    assert text == "blocks fall: no strength that was tried holds them; 1 falls (B1), 1 stays"


def test_all_pairs_stand_beside_the_limit_where_asked_for() -> None:
    asked = {"analysis.criterion": "all-pairs"}
    found = part(str(two_blocks(set=asked, all_pairs_failed=1.234)), "FoS")
    assert "1.234 all pairs failed (no block is tied to bedrock by sticking pairs; depends" in found
    assert "none all pairs failed: asked for, and not found" in part(
        str(two_blocks(set=asked)), "FoS"
    )
    assert "all pairs" not in part(str(two_blocks()), "FoS")


def test_a_bound_that_was_not_found_is_missed() -> None:
    design = sk.load(path_of("blocks"))
    one = mechanism("slides", 1.25, motions(["B1", "B2"], "slides"), change=0.002)
    found = result(design, [one], ["base", "B1", "B2"], ["base"])
    text = found.sheet.full
    assert "none upper bound: not found" in part(text, "FoS")
    assert part(text, "CHECKS").startswith(
        "the limit lies 0.2 % from a strength at which they run after 7 factorisations;"
    )


def test_ten_thousand_blocks_on_one_screen() -> None:
    text = bench().sheet.full
    assert len(text.splitlines()) <= 60
    assert (
        part(text, "STATUS")
        == "blocks slide: 49 slide (B2, B4, B6, B8, ... and 45 more), 9451 stay"
    )
    assert (
        "9500 blocks that can move and 500 of bedrock, 28500 contacts, in 3 groups that touch only"
        in text
    )
    assert "... and 37 more together" in part(text, "MOVES")


def test_the_sets_in_words() -> None:
    found = part(str(bench()), "SETS")
    assert found.startswith(
        "S1 30/175 dips 30° toward 175 (S), every 3 m bedding: c 0 kPa φ 42° area 5,120 m²"
    )
    assert "every 3.5 m (one plane 0.5 m above mid-toe) joint: c 0 kPa φ 40°" in found
    assert "normals scatter by 3° and distances scatter by 20 % (seed 7)" in found
    assert "face 70/180 dips 70° toward 180 (S) upper 0/180 level" in found
    assert "bench 20 m along the strike, rock modelled to 10 m behind the crest" in found
    assert "contact area cut at the ends 3 m²" in part(
        str(bench()), "SIZE"
    )  # of no set: not dropped


def test_successive_mechanisms() -> None:
    """Every block is in a line or counted in the one that stands for those left out."""
    found = bench()
    text = part(found.sheet.full, "MECHANISM")
    assert "1 0.900 - - slide 49 slide (B2, B4, B6, B8, ... and 45 more)" in text
    assert "2 0.850 - - turn at once: 4 slide (B207 to B210), 2 turn (B211, B212)" in text
    assert (
        "3 none - - fall at once: blocks fall: no strength that was tried holds them; 6 fall"
        in text
    )
    assert (
        "4 0.930 - - turn 4 slide (B221" in text
    )  # needs weaker joints than the first: not at once
    assert "... 30 more: 180 blocks, FoS 0.980 to 1.270 ..." in text
    assert "40 1.290" in text
    assert text.endswith("9217 blocks are left; 40 were asked for")


def test_mechanisms_at_one_factor_are_one_failure() -> None:
    """Two that differ by rounding only: the second needs no weaker joints, and the blocks have one factor."""
    design = sk.load(path_of("wall"))
    names = [f"A{k}" for k in range(1, 8)]
    found = [
        mechanism("slides", 1.9238 + 1e-8 * k, motions([names[k]], "slides")) for k in range(2)
    ]
    text = str(result(design, found, names))
    assert "2 1.924 - - slide at once: 1 slides (A2)" in part(text, "MECHANISM")


def test_one_mechanism_has_no_table() -> None:
    found = bench(700, 1)
    text = found.sheet.full
    assert "MECHANISM" not in labels(str(found))
    assert part(text, "MECHANISM") == "151 blocks are left; 1 were asked for"


def test_shares_of_all_and_of_some() -> None:
    """Interfaces beyond those of the result are in what the shares lack of one."""
    design = sk.load(path_of("bench"))
    names = [f"B{k}" for k in range(1, 9)]
    every = interfaces(43)
    for given, words in (
        (every, "... and 37 more together"),
        (every[:12], "... the others together"),
    ):
        one = mechanism("slides", 1.1, motions(names, "slides"), given)
        moves = part(result(design, [one], names).sheet.full, "MOVES")
        assert f"{100 * (1 - sum(one.share for one in given[:6])):.1f} % {words}" in moves
    tiny = [
        replace(one, share=share)
        for one, share in zip(every, (0.7, 0.2996, 2e-4, 2e-4), strict=False)
    ]
    one = mechanism("slides", 1.1, motions(names, "slides"), tiny)
    assert "< 0.1 % ... and 2 more together" in part(
        result(design, [one], names).sheet.full, "MOVES"
    )
    few = mechanism("slides", 1.1, motions(names, "slides"), interfaces(6))
    assert "together" not in result(design, [few], names).sheet.full


# -- loads, strengths, checks ---------------------------------------------------------------------


def test_loads_name_their_block() -> None:
    forces = [
        {"force": 50 + k, "toward": "270/00", "block": "B2", "at": [10, 0, 2]} for k in range(12)
    ]
    bolts = [{"force": 50, "toward": "270/20", "block": "B1", "acts": "active"}]
    text = str(
        two_blocks(
            set={
                "loads.forces": forces,
                "support.bolts": bolts,
                "loads.seismic.k": 0.1,
                "water": {"pressures": {"base/B1": "5 kPa"}},
            }
        )
    )
    found = part(text, "LOADS")
    assert found.startswith(
        "water u = 5 kPa on base/B1 seismic 0.1 g toward 090 (x is 090) force (-50, 0, 0) kN"
    )
    assert (
        "force (-57, 0, 0) kN east, north, up on B2 at (10.000, 0.000, 2.000) ... and 4 more"
        in found
    )
    assert found.endswith("bolt 50 kN toward 270/20.0 on B1, active")


def test_the_users_blocks_and_their_strengths() -> None:
    found = part(str(two_blocks(set={"blocks.B2.unit_weight": 24})), "BLOCKS")
    assert found == (
        "polygons of a section 1 m thick; faces nearer than 1 mm touch can move: B1, B2; bedrock: base "
        "joint c 0 kPa φ 30° on every other interface smooth c 0 kPa φ 0° on 1 named interface (B1/B2) "
        "own unit weights: 24 kN/m³ B2"
    )


def test_columns_with_two_strengths() -> None:
    rows = {"columns.heights": [5, 5], "columns.base_step": 0}
    found = sk.run(path_of("topple"), set=rows)
    words = " ".join(kind_of(found.design).slope(found.design, found)[0].entries)
    assert "2 columns, C1 at the toe" in words
    assert "bases dip 16° out of the slope, in one plane heights all 5 m" in words
    assert "bases  bedding: c 0 kPa  φ 36° sides  joint: c 0 kPa  φ 40°" in words


def test_checks_have_their_units() -> None:
    checks = {
        "contact_tolerance_m": 1e-3,
        "joint_area_m2": 512.345,
        "new_figure": 0.0,
        "plane_error_m": 2e-15,
        "gap": 3.0,
        "largest_unbalanced_force": 9.1e-9,
    }
    found = part(two_blocks("no_driving_force", checks=checks).sheet.full, "CHECKS")
    assert found == (
        "contact tolerance 0.001 m; joint area 512 m²; new figure 0; corners at most 2e-15 m off their planes; "
        "gap 3; largest unbalanced force 9.1e-09 of the load"
    )
