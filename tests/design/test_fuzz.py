"""Four hundred mutated design files: each ends in a result or a message with a code, never in a traceback.

`python -m benchmarks.fuzz` runs ten thousand of the same kind; here the designs that take longest are left out.
"""

import pytest

from benchmarks.fuzz import outcomes, report, shares
from benchmarks.fuzz_mutations import case
from benchmarks.fuzz_seeds import SEEDS

_COUNT, _SEED = 400, 3
_SLOW = (
    "ground surface", "surface", "cylinder", "sheet surface", "sphere", "paper-ellipsoid", "facet surface",
    "pressed wedge", "pressed plane", "rich footing",
)  # fmt: skip
_NAMES = tuple(name for name in SEEDS if name not in _SLOW)


@pytest.fixture(scope="module")
def found() -> list:
    return outcomes(_COUNT, _SEED, jobs=2, names=_NAMES)


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
    assert len({code for each in found for code in each.codes}) >= 50
    assert len({each.status for each in found if each.status}) >= 10


def test_a_file_of_a_seed_is_always_the_same() -> None:
    assert [case(k, 1) for k in range(20)] == [case(k, 1) for k in range(20)]
    assert len({case(k, 1).content for k in range(50)}) > 45
