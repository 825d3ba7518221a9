"""The page of elastic blocks shows what the document has."""

import json

import pytest

import slopekit as sk
from slopekit.kinds.words import short
from slopekit.views.pages.report import report_of


@pytest.fixture(scope="module")
def cracked():
    found = sk.wedge(
        ("45/115", "45/245"), crack="80/180@20", shear_stiffness=1e5, edge="60 m", elastic=True
    )
    return json.loads(json.dumps(found.to_dict()))


def test_the_page_has_elastic_blocks_under_a_heading_of_their_own(cracked) -> None:
    """The limit, the tractions, what was not modelled; the page of a rigid block has none of it."""
    pytest.importorskip("jinja2")
    page = report_of(cracked, with_pictures=False).html
    elastic = cracked["elastic"]
    assert "<h2>Elastic blocks</h2>" in page
    assert f"{elastic['limit']:.3f}  limit of elastic blocks" in page
    assert "(but of elastic blocks)" in page
    assert (
        short(elastic["joints"]["J1"]["elastic_kpa"][1])
        in page[page.index("<h2>Elastic blocks</h2>") :]
    )
    rigid = sk.wedge(("45/115", "45/245"), crack="80/180@20").to_dict()
    assert (
        "Elastic blocks" not in report_of(json.loads(json.dumps(rigid)), with_pictures=False).html
    )
