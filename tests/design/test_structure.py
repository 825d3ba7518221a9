"""Keys that are unknown, missing, of the wrong shape or empty, each with its place and what to type instead."""

import pytest

from slopekit.core.errors import DesignError
from slopekit.design.reading.document import load_document
from slopekit.design.reading.files import load
from slopekit.design.reading.nodes import document_from
from slopekit.design.reading.structure import VALUE, Spec, check_structure

NUMBER = Spec("number")
STRENGTH = Spec(keys={"c": NUMBER, "phi": Spec("number", example="20"), "dilation": NUMBER})
WEDGE = Spec(
    keys={
        "slopekit": VALUE,
        "kind": VALUE,
        "slope": Spec(
            keys={
                "face": Spec("orientation"),
                "height": Spec("number", example="64.89 m"),
                "profile": Spec(
                    items=Spec(items=NUMBER, at_least=2, at_most=2), example="[[60, 0], [40, 0]]"
                ),
            },
            required=("height",),
        ),
        "joints": Spec(
            names=Spec(
                keys={"plane": Spec("orientation", example="45/115"), "strength": VALUE},
                required=("plane",),
            ),
            at_least=2,
            example="{J1: {plane: 45/115}, J2: {plane: 45/245}}",
        ),
        "strength": Spec(names=STRENGTH),
        "loads": Spec(
            keys={"forces": Spec(items=Spec("value", items=NUMBER, at_least=3, at_most=3))}
        ),
        "slip": Spec(
            keys={"mesh": VALUE, "up": VALUE},
            required=("mesh",),
            names=Spec(keys={"shape": VALUE, "radius": NUMBER}, required=("shape",)),
        ),
        "interfaces": Spec(names=VALUE, pairs=True),
    },
    required=("slope", "joints"),
)
PLANE = Spec(keys={"weak_plane": Spec(keys={"dip": NUMBER})})
GOOD = {
    "kind": "wedge",
    "slope": {"height": "64.89 m", "face": "60/180"},
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": (45, 245)}},
    "strength": {"weak": {"c": 50, "phi": {"dist": "normal", "mean": 20, "sd": 2}}},
    "interfaces": {"default": "weak", "J1/J2": "weak"},
    "loads": {"forces": ["500@180/10", [1, 2, 3]]},
}

# code, changed entries, first line, advice
CASES = [
    (
        "E142",
        {"tilte": 1},
        "tilte is not a key of a wedge design",
        "Known here: slopekit, kind, slope,",
    ),
    ("E142", {"stregnth": {}}, "stregnth is not a key of a wedge design", "Did you mean strength?"),
    (
        "E142",
        {"slope": {"height": 5, "fase": 1}},
        "fase is not a key of slope",
        "Did you mean face?",
    ),
    ("E142", {"slope": {"hieght": 5}}, "hieght is not a key of slope", "Did you mean height?"),
    (
        "E142",
        {"phi": 20},
        "phi is not a key of a wedge design",
        "phi belongs under strength.<name>.",
    ),
    (
        "E142",
        {"slope": {"height": 5, "kind": 1}},
        "kind is not a key of slope",
        "kind belongs at the top.",
    ),
    ("E142", {"weak_plane": {}}, "weak_plane is not a key", "weak_plane is a key of kind: plane."),
    ("E142", {"radiuss": 1}, "radiuss is not a key", "Did you mean radius, under slip.<name>?"),
    (
        "E142",
        {"strength": {"weak": {"Phi": 1}}},
        "Phi is not a key of strength.weak",
        "Did you mean phi?",
    ),
    ("E143", {"slope": {"face": "60/180"}}, "slope.height is missing", "Add height: 64.89 m"),
    (
        "E143",
        {"joints": {"J1": {}, "J2": {"plane": 1}}},
        "joints.J1.plane is missing",
        "Add plane: 45/115",
    ),
    (
        "E144",
        {"slope": "60/180"},
        "slope is the text '60/180', a group of keys (face, height, profile) is needed",
        "",
    ),
    ("E144", {"slope": [1]}, "slope is a list of 1, a group of keys", ""),
    ("E144", {"kind": {"wedge": 1}}, "kind is a group of keys (wedge), a value is needed", ""),
    (
        "E144",
        {"slope": {"height": [1]}},
        "slope.height is a list of 1, a number is needed",
        "Write height: 64.89 m",
    ),
    (
        "E144",
        {"strength": {"weak": {"phi": {"dists": "normal"}}}},
        "a number is needed",
        "instead of dists:",
    ),
    (
        "E144",
        {"slope": {"height": 5, "face": [1, 2, 3]}},
        "slope.face is a list of 3, an orientation is needed",
        "",
    ),
    ("E144", {"loads": {"forces": 5}}, "loads.forces is the text '5', a list is needed", ""),
    (
        "E144",
        {"loads": {"forces": [{"a": 1}]}},
        "loads.forces.0 is a group of keys (a), a value or a list",
        "",
    ),
    (
        "E146",
        {"strength": {"a.b": {"c": 1}}},
        "'a.b' under strength cannot be a name",
        "letters, digits",
    ),
    ("E146", {"strength": {"": {"c": 1}}}, "'' under strength cannot be a name", ""),
    (
        "E109",
        {"joints": {"J1": {"plane": "45/115"}}},
        "joints has 1 entry, at least 2 needed",
        "Write joints: {J1:",
    ),
    (
        "E109",
        {"slope": {"height": 5, "profile": [[1, 2], [3]]}},
        "slope.profile.1 has 1 entry, 2 needed",
        "",
    ),
    ("E109", {"loads": {"forces": [[1, 2, 3, 4]]}}, "loads.forces.0 has 4 entries, 3 needed", ""),
]


@pytest.mark.parametrize(
    ("code", "change", "says", "advice"), CASES, ids=lambda value: str(value)[:40]
)
def test_each_fault_once_with_its_remedy(code, change, says, advice) -> None:
    faults = check_structure(
        document_from({**GOOD, **change}).root, WEDGE, "wedge", lambda: {"plane": PLANE}
    )
    assert [fault.code for fault in faults] == [code]
    assert says in faults[0].message
    assert advice in faults[0].advice
    assert faults[0].where.startswith("design: ")


def test_a_good_design_has_no_faults() -> None:
    assert check_structure(document_from(GOOD).root, WEDGE, "wedge") == []


def test_all_faults_of_a_file_with_line_and_column(tmp_path) -> None:
    path = tmp_path / "wall.yaml"
    path.write_text(
        "slope: {hight: 5}\njoints:\n  J1: 45/115\n  J2: {plane:45/245}\nstrength: {weak: {phi: }}\nloads:\n"
    )
    faults = check_structure(load_document(path).root, WEDGE, "wedge")
    assert [str(fault) for fault in faults] == [
        "E142 hight is not a key of slope\n     wall.yaml:1:9  slope: {hight: 5}\n     Did you mean height?",
        "E144 joints.J1 is the text '45/115', a group of keys (plane, strength) is needed\n"
        "     wall.yaml:3:7  J1: 45/115\n     Write J1: {plane: 45/115}",
        "E142 plane:45/245 is not a key of joints.J2\n     wall.yaml:4:8  J2: {plane:45/245}\n"
        "     Put a space behind the colon: plane: 45/245",
        "E143 joints.J2.plane is missing\n     wall.yaml:4:3  J2: {plane:45/245}\n     Add plane: 45/115",
        "E144 strength.weak.phi is empty, a number is needed\n     wall.yaml:5:19  strength: {weak: {phi: }}\n"
        "     Write phi: 20",
    ]


def test_a_key_that_is_required_tells_a_group_of_keys_from_names() -> None:
    def codes(slip: object) -> list[str]:
        return [
            f.code
            for f in check_structure(document_from({**GOOD, "slip": slip}).root, WEDGE, "surface")
        ]

    assert codes({"mesh": "slip.stl"}) == []
    assert codes({"mesh": "slip.stl", "upp": "y"}) == ["E142"]
    assert codes({"S1": {"shape": "sphere", "radius": 5}}) == []
    assert codes({"S1": {"shape": "sphere", "raduis": 5}}) == ["E142"]
    assert codes("sphere") == ["E144"]


def test_an_empty_design_misses_every_required_key() -> None:
    faults = check_structure(document_from({}).root, WEDGE, "wedge")
    assert [fault.message for fault in faults] == ["slope is missing", "joints is missing"]


def test_what_is_wrong_ten_thousand_times_is_said_two_hundred_times() -> None:
    """Each unknown key was looked up for a likely slip: 60,000 took a minute and a half (issue 40, C19)."""
    many = document_from(
        {
            "slope": {f"key{k}": "1" for k in range(10_000)},
            "strength": {f"s{k}": "1" for k in range(9)},
        }
    )
    faults = check_structure(many.root, WEDGE, "wedge")
    assert [fault.code for fault in faults] == ["E142"] * 200 + ["E143", "E149"]
    assert faults[-1].message == "there are 200 faults: what stands behind them was not looked at"


def test_values_that_are_wrong_a_thousand_times_are_said_two_hundred_times() -> None:
    wrong = {f"s{k}": {"c": -1.0, "phi": 30} for k in range(1000)}
    with pytest.raises(DesignError) as caught:
        load(
            {
                "slopekit": 1,
                "kind": "wedge",
                "joints": {"J1": {"plane": "45/115"}},
                "strength": wrong,
            }
        )
    assert len(caught.value.faults) == 201
    assert caught.value.codes[-1] == "E149"
    assert caught.value.faults[-1].message.endswith("faults: these are the first 200")
