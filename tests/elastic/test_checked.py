"""`check --elastic`: a row beside the rigid limit; what deformation opens is no disagreement."""

from dataclasses import replace

import numpy as np
import pytest

import slopekit as sk
from slopekit.studies.check.run import _elastic, check


def test_the_cohesion_that_opens_is_no_disagreement() -> None:
    design = {
        "slopekit": 1, "kind": "wedge", "slope": {"face": "65/185", "upper": "12/195", "height": 30},
        "joints": {"J1": {"plane": "45/105"}, "J2": {"plane": "70/235"}},
        "strength": {"joint": {"c": 24, "phi": 25, "stiffness": {"normal": 1e7, "shear": 1e5}}},
        "rock": {"unit_weight": 25, "modulus": "2 GPa"}, "analysis": {"elastic": {"edge": "25 m"}},
    }  # fmt: skip
    found = check(sk.load(design), elastic=True)
    one = next(finding for finding in found.findings if finding.name == "elastic blocks")
    assert found.result.elastic.limit < found.result.elastic.rigid_limit * (1.0 - 1e-3)
    assert one.met
    assert one.value <= one.wanted
    assert found.consistent
    assert found.to_dict()["elastic"]["bracket"] is not None
    low, high = found.result.elastic.bracket
    apart = replace(found.result.elastic, limit_at_bracket=1.05 * high)
    other = _elastic(replace(found.result, elastic=apart))
    assert (other.met, other.code) == (None, "W453")
    assert other.value == pytest.approx(0.05)
    assert np.log(high / low) < 2e-4


@pytest.mark.parametrize("given", [{"modulus": "5 GPa"}, {"bedrock": "elastic", "edge": 4}])
def test_what_is_of_elastic_blocks_alone_is_not_dropped_silently(given) -> None:
    said = {one.code: one.message for one in sk.wedge(dips=("45/115", "45/245"), **given).warnings}
    assert said["W457"].startswith(" and ".join(one for one in ("edge", "bedrock") if one in given) or "modulus")
