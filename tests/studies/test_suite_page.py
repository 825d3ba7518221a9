"""The page of the verification suite: what docs/ holds is what the suite gives now, apart from times and versions."""

import csv
import dataclasses
import json
import re
from pathlib import Path

import pytest

from benchmarks.verification_page import judged_by, page_of, unmet
from slopekit.cli.study_command import _deliver
from slopekit.studies.suite import Verification, suite
from tests.studies.the_suite import the_suite

DOCS = Path(__file__).parents[2] / "docs"
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@pytest.fixture(scope="module")
def verification(tmp_path_factory: pytest.TempPathFactory) -> Verification:
    return the_suite(tmp_path_factory.getbasetemp())


def without_times(page: str) -> list[str]:
    """Lines of a page without the last column of its tables and the line of versions."""
    lines = [line for line in page.splitlines() if not line.startswith("Versions: ")]
    return [line.rsplit(" | ", 1)[0] if line.startswith("| ") else line for line in lines]


def same(one: str, other: str) -> bool:
    """Equal words, and numbers that are equal but for the rounding of another machine (1e-6, or in the sixth digit)."""
    if _NUMBER.split(one) != _NUMBER.split(other):
        return False
    pairs = zip(_NUMBER.findall(one), _NUMBER.findall(other), strict=True)
    return all(float(a) == pytest.approx(float(b), rel=2e-5, abs=1e-6) for a, b in pairs)


@pytest.mark.slow
def test_the_page_in_docs_is_what_the_suite_gives(verification) -> None:
    now = without_times(page_of(verification))
    kept = without_times((DOCS / "verification.md").read_text(encoding="utf-8"))
    assert len(now) == len(kept)
    assert [(a, b) for a, b in zip(now, kept, strict=True) if not same(a, b)] == []


def test_the_data_in_docs_are_what_the_suite_gives(verification) -> None:
    now = verification.to_dict()
    kept = json.loads((DOCS / "verification.json").read_text(encoding="utf-8"))
    assert kept["counts"] == now["counts"]
    assert kept["sources"] == now["sources"]
    assert set(kept) == set(now)
    for new, old in zip(now["rows"], kept["rows"], strict=True):
        for key in set(new) - {"timing_s"}:
            if isinstance(new[key], float):
                assert old[key] == pytest.approx(new[key], rel=2e-6, abs=2e-6), (new["id"], key)
            else:
                assert old[key] == new[key], (new["id"], key)


def test_the_page_is_whole(verification) -> None:
    page = page_of(verification)
    tables = [
        line
        for line in page.splitlines()
        if line.startswith("| ") and "---" not in line and "Case |" not in line
    ]
    assert len(tables) == len(verification.rows)
    assert {line.replace(r"\|", "").count(" | ") for line in tables} == {13}
    for row in verification.rows:
        assert f"`{row.case.id}`" in page
    for row in verification.not_judged:
        assert row.reason in page
    for text in verification.sources.values():
        assert text in page
    assert "No judged row is outside its tolerance." in page
    assert "nan" not in page.replace("Finance", "")


def test_a_failed_row_stands_in_the_page_and_on_the_terminal(verification) -> None:
    broken = dataclasses.replace(
        verification.rows[0], ok=False, reason="off by 0.1, outside its tolerance"
    )
    changed = dataclasses.replace(verification, rows=(broken, *verification.rows[1:]))
    assert f"- {broken.id}: off by 0.1" in page_of(changed)
    assert f"OUTSIDE   {broken.id}: off by 0.1" in str(changed)
    assert "1 outside" in str(changed)


def test_marks_of_confidence_are_explained_and_say_nothing_of_slopekit(verification) -> None:
    page = page_of(verification)
    for row in verification.rows:
        mark, _, words = row.reference.confidence.partition(": ")
        assert f"\n  - {mark}: " in page
        assert words
        assert "reproduced" not in row.reference.confidence


def test_own_values_do_not_stand_under_published(verification) -> None:
    cells = [
        line.split(" | ") for line in page_of(verification).splitlines() if line.startswith("| ")
    ]
    own = [row for row in cells if row[1] in ("cases", "prototype", "lem", "exact", "conic")]
    assert len(own) == sum(row.reference.is_own_source for row in verification.rows) > 100
    assert {row[4] for row in own} == {""}
    assert "" not in {row[5] for row in own}


def test_the_page_says_what_the_rows_rest_on(verification) -> None:
    page = page_of(verification)
    above = page.partition("\n| ")[0]
    of = judged_by(verification)
    judged = verification.counts["within"]
    assert of["published"] + of["own"] + of["recomputed"] == judged
    assert (
        f"Of the {judged} judged rows {of['published']} have a value published by somebody else"
        in above
    )
    low, *_, high = unmet(verification)
    assert low.error < -0.05 < 0.03 < high.error
    assert f"{100 * low.error:+.1f} % (`{low.id}`" in above
    assert f"{100 * high.error:+.1f} % (`{high.id}`" in above
    assert "`moments-92` 0.555099 against 0.5557" in above
    cases = {row.case.id for row in verification.rows} | {"-c", "-d", "verification.json"}
    named = re.findall(
        r"`([^`]+)`", next(line for line in above.splitlines() if line.startswith("Where moments"))
    )
    assert set(named) <= cases


def test_a_case_stands_in_one_place(verification) -> None:
    lines = page_of(verification).splitlines()
    headings: dict[str, set[str]] = {}
    heading = ""
    for line in lines:
        heading = line if line.startswith("## ") else heading
        if line.startswith("| ") and "(`" in line:
            headings.setdefault(line.split(" | ")[0], set()).add(heading)
    assert len(headings) == verification.counts["cases"]
    assert {len(found) for found in headings.values()} == {1}


def test_the_table_fits_a_terminal_and_nothing_is_cut(verification) -> None:
    text = str(verification)
    lines = text.splitlines()
    assert max(map(len, lines)) <= 100
    assert sum(bool(re.fullmatch(r" {12}\S.* (yes|-)", line)) for line in lines) == len(
        verification.rows
    )
    counts = verification.counts
    assert f"{counts['rows']} rows of {counts['cases']} designs: {counts['within']} within" in text
    assert not text.endswith("\n")
    assert "their JSON says why" in text
    for words in (
        "failed pairs at 1.33 ",
        "failed pairs at 1.333 ",
        "failed pairs at 1.334 ",
        "P of column 13, kN",
    ):
        assert text.count(words) == 1
    for row in verification.rows:
        assert row.case.id in text
        assert str(row.value).replace("_", " ") in text or not isinstance(row.value, str)
    whole = " ".join(text.split())
    for source in {row.case.source for row in verification.rows}:
        assert " ".join(verification.sources[source].split()) in whole


def test_the_terminal_shows_what_the_error_is_against(verification) -> None:
    (line,) = [
        line
        for line in str(verification).splitlines()
        if re.match(r" {12}wyllie-mah .* 1\.24666 ", line)
    ]
    assert "1.25" not in line


def test_the_files(tmp_path) -> None:
    """What the driver writes: the JSON, the sheet, every row as CSV."""
    small = suite("6c_footing")
    _deliver(small, tmp_path, None, {"as_json": False, "quiet": True})
    assert (
        json.loads((tmp_path / "verification.json").read_text(encoding="utf-8")) == small.to_dict()
    )
    assert (tmp_path / "verification.txt").read_text(encoding="utf-8") == f"{small.sheet.full}\n"
    with (tmp_path / "verification.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [
        (row["case"], float(row["value"])) for row in rows if row["quantity"] == "PRE-IE limit"
    ] == [(row.case.id, row.value) for row in small.rows if row.reference.quantity == "limit"]
