"""Mutated design files and surveys, some run and some only read: each ends in a result or a message with a code.

`python -m benchmarks.fuzz` runs ten thousand of the same kind; here the designs that take longest are left out.
"""

import inspect
import re

import pytest

import slopekit as sk
from benchmarks.fuzz import outcomes, report, run, shares
from benchmarks.fuzz_mutations import case, keys_of
from benchmarks.fuzz_seeds import SEEDS, write_files
from benchmarks.fuzz_studies import OPTIONS, study_outcomes
from slopekit.design.fields import every_field
from slopekit.design.registry import KINDS, record_of
from slopekit.studies.bench_design import bench_design
from slopekit.studies.sets import sets

pytestmark = pytest.mark.slow

_COUNT, _SEED = 165, 21  # 11 takes twice as long for as many codes
_SEED_OF_BLOCKS, _SEED_OF_OTHERS = 12, 11
_SEED_OF_CASES = 14  # 11 draws one near 90° of friction and dilation that takes three times as long as all others
_SLOW = (
    "ground surface",
    "surface",
    "cylinder",
    "sheet surface",
    "sphere",
    "paper-ellipsoid",
    "facet surface",
    "pressed wedge",
    "pressed plane",
    "rich footing",
    "cracked wedge",
    "wedge with a table",
    "factored wedge",
    "basal wedge",
    "plane under a table",
)
_OF_BLOCKS = tuple(
    name for name, text in SEEDS.items() if re.search("kind: (topple|bench|blocks)\n", text)
)
_OF_CASES = ("cases plane",)
_WET = ("wet footing", "deep crack")
_NAMES = tuple(name for name in SEEDS if name not in (*_SLOW, *_OF_BLOCKS, *_OF_CASES, *_WET))


def keyword_only(function) -> set[str]:
    """The names of the parameters that a function takes by name alone."""
    parameters = inspect.signature(function).parameters.values()
    return {one.name for one in parameters if one.kind is one.KEYWORD_ONLY}


@pytest.fixture(scope="module")
def found() -> list:
    return outcomes(_COUNT, _SEED, names=_NAMES)


def test_nothing_escapes(found) -> None:
    assert not [each for each in found if each.escaped], report(found)
    assert {each.exit_code for each in found} <= {0, 1, 2, 3, 4}
    assert all(each.codes for each in found if each.exit_code in (2, 3))


def test_no_file_takes_long(found) -> None:
    """Seconds of the processor; most files take a hundredth."""
    assert max(each.seconds for each in found) < 15.0, report(found)


def test_a_healthy_share_reaches_each_stage(found) -> None:
    part = shares(found)
    assert part["built as a tree"] >= 0.7
    assert part["past YAML"] >= 0.8
    assert part["to the analysis"] >= 0.35
    assert part["to a result"] >= 0.2
    assert len({code for each in found for code in each.codes}) >= 40  # of 150
    assert len({each.status for each in found if each.status}) >= 10


def test_a_file_of_a_seed_is_always_the_same() -> None:
    assert [case(k, 1) for k in range(20)] == [case(k, 1) for k in range(20)]
    assert len({case(k, 1).content for k in range(50)}) > 45


def test_files_with_uplift_and_water_in_a_crack_are_run_or_refused(tmp_path) -> None:
    """Every file ends with a result or with codes."""
    each = [run(case(index, _SEED_OF_OTHERS, _WET), tmp_path) for index in range(25)]
    assert not [one.escaped for one in each if one.escaped]
    assert all(one.codes for one in each if one.exit_code in (2, 3))
    assert {one.exit_code for one in each} >= {0, 2}


def test_every_key_stands_in_a_seed() -> None:
    """What no design says is never mutated."""
    known = {*keys_of(SEEDS.values()), "*"}
    assert {
        one.path for kind in KINDS for one in every_field(record_of(kind)) if one.key not in known
    } == set()


def test_surveys_and_options_of_two_studies_are_run_or_refused(tmp_path) -> None:
    """`sets` and `bench-design`: lists with a cell wrong, broken files, options outside their range."""
    each = study_outcomes(44, _SEED_OF_CASES, tmp_path)
    assert not [one.escaped for one in each if one.escaped]
    assert all(one.codes for one in each if one.exit_code in (2, 3))
    assert sum(one.stage == "result" for one in each) >= 10
    assert len({code for one in each for code in one.codes}) >= 14
    for study, function in (("bench-design", bench_design), ("sets", sets)):
        assert set(OPTIONS[study]) == keyword_only(function) - {"desk", "jobs", "scheduler"}


def test_files_with_load_cases_are_run_or_refused(tmp_path) -> None:
    """Cases and partial factors: every file ends with a result or with codes."""
    each = [run(case(index, _SEED_OF_CASES, _OF_CASES), tmp_path) for index in range(30)]
    assert not [one.escaped for one in each if one.escaped]
    assert all(one.codes for one in each if one.exit_code in (2, 3))
    assert sum(one.stage == "result" for one in each) >= 10
    assert len({code for one in each for code in one.codes}) >= 8


def test_files_of_many_blocks_are_read_or_refused(tmp_path) -> None:
    """Reading alone: whatever is wrong has a code and a place."""
    write_files(tmp_path)
    read, codes = 0, set()
    for index in range(260):
        content = case(index, _SEED_OF_BLOCKS, _OF_BLOCKS).content
        path = tmp_path / "case.yaml"
        path.write_bytes(
            content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass")
        )
        try:
            design = sk.load(path)
        except sk.DesignError as error:
            codes.update(error.codes or ("without a code",))
            continue
        assert len(design.input_hash()) == 64
        read += 1
    assert read >= 100
    assert "without a code" not in codes
    assert len(codes) >= 25
