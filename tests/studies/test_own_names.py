"""Studies call a joint by the name that the user gave it, as the result does; and what they find is a table too."""

import csv
import io
import re
from functools import cache
from typing import Any

import pytest

import slopekit as sk
from slopekit.design.common import Design
from slopekit.design.templates import path_of

#: Slides on its first joint, the other has lost contact.
OWN = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "65/180", "upper": "10/180", "height": 20},
    "joints": {
        "bedding": {"plane": "45/150", "strength": "weak"},
        "fault": {"plane": "80/60", "strength": "weak"},
    },
    "strength": {"weak": {"c": 0, "phi": {"dist": "normal", "mean": 25, "sd": 2}}},
}
NAMED = re.compile(r"\bJ[12]\b")


@cache
def design() -> Design:
    return sk.load(OWN)


STUDIES: dict[str, Any] = {
    "sweep": lambda: sk.sweep(
        design(), {"joints.fault.plane.dip_direction": [60, 150, 240]}, closed_form=True
    ),
    "tornado": lambda: sk.tornado(design(), {"strength.weak.phi": "20:30"}, closed_form=True),
    "solve": lambda: sk.solve(design(), "strength.weak.phi.mean", fos=0.8, within="35:50"),
    "prob": lambda: sk.prob(design(), 60),
    "support": lambda: sk.support(design(), 1.1, acts="active", toward="330/10"),
}


@cache
def found(name: str) -> Any:
    return STUDIES[name]()


@pytest.mark.slow
@pytest.mark.parametrize("name", STUDIES)
def test_what_happens_is_told_in_the_names_of_the_user(name) -> None:
    text = " ".join(str(found(name)).split())
    assert "slides on bedding, fault has lost contact" in text
    assert not NAMED.search(text)
    assert "slides_on_bedding" not in text  # the code stays


@pytest.mark.parametrize(
    "more",
    [
        {"crack": {"plane": "80/185", "distance": "3 m"}, "water": "full"},
        {"basal": {"plane": "20/185", "height": "4 m", "strength": "b"}},
        {"water": {"pressures": {"fault": 20, "bedding": 30}}},
        {
            "joints": {
                "fault": {"plane": "45/180", "strength": "a"},
                "bedding": {"plane": "46/190", "strength": "b"},
            }
        },
    ],
)
def test_a_sheet_calls_the_joints_of_a_wedge_by_their_own_names(more) -> None:
    """J1 and J2, which stand in JSON, are explained once, where the planes are."""
    wedge = {
        "slopekit": 1,
        "kind": "wedge",
        "slope": {"face": "65/185", "upper": "12/195", "height": 20},
        "joints": {
            "fault": {"plane": "45/105", "strength": "a"},
            "bedding": {"plane": "70/235", "strength": "b"},
        },
        "strength": {"a": {"c": 24, "phi": 20}, "b": {"c": 48, "phi": 30}},
    }
    result = sk.run(wedge | more)
    assert NAMED.findall(result.sheet.full) == ["J1", "J2"]
    assert not NAMED.search(str([notice.message for notice in result.warnings]))


def rows(name: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(found(name).tables()[name].csv())))


def test_values_solved_for_are_a_table() -> None:
    solution = found("solve")
    first, *others = rows("solve")
    assert (first["method"], float(first["strength.weak.phi.mean"])) == (
        "pre_ie",
        solution.answer.value,
    )
    assert float(first["fos"]) == solution.answer.factor
    assert [one["method"] for one in others] == ["closed_form"]
    assert "<td>root</td>" in solution._repr_html_()
    assert "root" not in str(solution)  # text has the entries


def test_cases_of_support_are_a_table() -> None:
    support = found("support")
    own = rows("support")
    assert [float(one["use_kn"]) for one in own] == pytest.approx(
        [case.force for case in support.cases]
    )
    assert [one["reached"] for one in own] == [str(case.reached) for case in support.cases]
    assert int(own[0]["bolts"]) == len(support.cases[0].layout)
    assert "<h4>CASES</h4>" in support.sheet._repr_html_()
    nothing = sk.support(sk.load(path_of("wedge")), 1.2)
    assert nothing.tables()["support"].rows == ()
    assert "CASES" not in nothing.sheet._repr_html_()
