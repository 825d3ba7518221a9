"""The limit of the elastic path of one block against its exact limit state: random wedges, two programs, one number."""

from collections import Counter

import numpy as np

from benchmarks.wedge_paths import compared


def test_single_wedges_have_the_limit_of_the_path() -> None:
    """Where the limit state opens no joint with cohesion the two are one: to 1e-6, the path's own steadiness."""
    rng = np.random.default_rng(20)
    words = Counter(compared(rng)[0] for _ in range(40))
    assert words["alike"] >= 15
    assert words["DIFFER"] == 0
