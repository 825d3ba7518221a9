"""What a slope engineer types who does not know slopekit's words: it is read, or the correction is valid when typed."""

import json
import re
from copy import deepcopy
from typing import Any

import pytest
import yaml

import slopekit as sk
from slopekit.core.synonyms import SYNONYMS
from tests.commands import slopekit

WEDGE: dict[str, Any] = {
    "slopekit": 1,
    "kind": "wedge",
    "slope": {"face": "60/180", "upper": "10/180", "height": "20 m"},
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    "strength": {"joint": {"c": "50 kPa", "phi": 20}},
    "rock": {"density": 2600},
}

#: Keys that are read as another: where they stand, what they are read as.
READ = [
    ("strength.joint", "cohesion", "c", 40),
    ("strength.joint", "friction", "phi", 25),
    ("strength.joint", "friction_angle", "phi", 25),
    ("strength.joint", "Friction angle", "phi", 25),
    ("strength.joint", "tensile_strength", "tension", 5),
    ("strength.joint", "dilation-angle", "dilation", 5),
    ("strength.joint.residual", "cohesion", "c", 5),
    ("rock", "gamma", "unit_weight", 26),
    ("rock", "unitweight", "unit_weight", 26),
    ("rock", "rho", "density", 2500),
    ("rock", "youngs_modulus", "modulus", "9 GPa"),
    ("loads", "kh", "seismic", 0.1),
    ("loads", "k_h", "seismic", 0.1),
    ("loads.seismic", "kh", "k", 0.1),
    ("joints.J1.plane", "dipdir", "dip_direction", 115),
    ("slope.face", "dip_dir", "dip_direction", 180),
]


@pytest.mark.parametrize(("path", "word", "key", "value"), READ)
def test_a_synonym_is_read_as_its_key(path, word, key, value) -> None:
    plain, other = (deepcopy(WEDGE) for _ in range(2))
    for design, name in ((plain, key), (other, word)):
        if path.endswith((".plane", ".face")):
            *above, last = path.split(".")
            holder = design
            for part in above:
                holder = holder[part]
            holder[last] = {"dip": 45, name: value}
        else:
            holder = design
            for part in path.split("."):
                holder = holder.setdefault(part, {})
            holder.pop(key, None)
            if key in ("unit_weight", "density"):
                holder.clear()
            holder |= {"phi": 15, name: value} if path.endswith("residual") else {name: value}
    assert sk.load(other).inputs() == sk.load(plain).inputs()
    source = sk.load(other).source
    assert source is not None
    assert f'"{word}"' not in json.dumps(source.root.plain())
    both = deepcopy(other)
    holder = both
    for part in path.split("."):
        holder = holder[part]
    holder[key] = value
    with pytest.raises(sk.DesignError, match="E151") as caught:
        sk.load(both)
    assert f"{path}.{key} is given twice" in str(caught.value)


def test_a_file_keeps_its_lines_and_both_names_are_a_key_given_twice(tmp_path) -> None:
    path = tmp_path / "mine.yaml"
    text = (
        yaml.safe_dump(WEDGE)
        .replace("c: 50 kPa", "cohesion: 50 kPa")
        .replace("phi:", "friction_angle:")
    )
    path.write_text(text, encoding="utf-8")
    assert sk.run(path).fos.limit == sk.run(WEDGE).fos.limit
    path.write_text(text.replace("cohesion: 50 kPa", "cohesion: -50 kPa"), encoding="utf-8")
    with pytest.raises(
        sk.DesignError,
        match=r"E114 c of joint is -50 kPa(.|\n)*mine\.yaml:\d+:\d+  cohesion: -50 kPa",
    ):
        sk.load(path)
    path.write_text(text.replace("    cohesion", "    c: 3 kPa\n    cohesion"), encoding="utf-8")
    with pytest.raises(
        sk.DesignError, match=r"E151 strength\.joint\.c is given twice, here as cohesion"
    ):
        sk.load(path)


def test_set_cases_and_correlations_take_synonyms() -> None:
    assert (
        sk.load(WEDGE, set={"strength.joint.cohesion": 7}).inputs()
        == sk.load(WEDGE, set={"strength.joint.c": 7}).inputs()
    )
    spelled = {**WEDGE, "strength": {"joint": {"cohesion": 50, "friction": 20}}}
    assert (
        sk.load(spelled, set={"strength.joint.c": 7}).inputs()
        == sk.load(WEDGE, set={"strength.joint.c": 7}).inputs()
    )
    assert sk.load(WEDGE, set={"strength.joint": {"cohesion": 7, "friction": 20}}).cohesion_kpa == (
        7.0,
        7.0,
    )
    with pytest.raises(sk.DesignError, match=r"E151 strength\.joint\.c is set twice"):
        sk.load(WEDGE, set={"strength.joint.c": 7, "strength.joint.cohesion": 8})
    cases = {"quake": {"set": {"loads.kh": 0.1, "strength.joint.cohesion": 5}}}
    quake = sk.load({**WEDGE, "cases": cases}, case="quake")
    assert (quake.seismic.coefficient, quake.cohesion_kpa) == (0.1, (5.0, 5.0))
    spread = {"dist": "normal", "sd": 2}
    scattered = {
        **WEDGE,
        "strength": {"joint": {"c": {**spread, "mean": 50}, "phi": {**spread, "mean": 20}}},
    }
    by_synonym, by_key = (
        sk.load({**scattered, "correlation": {names: -0.3}}).correlation
        for names in ("joint.cohesion/joint.friction", "joint.c/joint.phi")
    )
    assert by_synonym == by_key


def test_names_of_the_user_are_left_alone() -> None:
    own = {
        **WEDGE,
        "strength": {"friction": {"c": 50, "phi": 20}},
        "joints": {"gamma": {"plane": "45/115"}, "rho": {"plane": "45/245"}},
    }
    assert sk.load(own).joint_names == ("gamma", "rho")


def test_options_and_parameters_take_synonyms() -> None:
    plain = sk.wedge(dips=("45/115", "45/245"), c=40, phi=25, unit_weight=26, seismic=0.1)
    other = sk.wedge(dips=("45/115", "45/245"), cohesion=40, friction_angle=25, gamma=26, kh=0.1)
    assert other.to_dict()["inputs"] == plain.to_dict()["inputs"]
    with pytest.raises(sk.DesignError, match="E142 cohesion is not an input of a wedge"):
        sk.wedge(dips=("45/115", "45/245"), c=40, cohesion=40)
    wedge = ("wedge", "--dips", "45/115", "45/245", "--quiet")
    by_option = slopekit(
        *wedge, "--cohesion", "40", "--friction-angle", "25", "--gamma=26", "--kh", "0.1"
    ).stdout
    assert (
        by_option
        == slopekit(
            *wedge, "--c", "40", "--phi", "25", "--unit-weight=26", "--seismic", "0.1"
        ).stdout
    )
    assert slopekit(*wedge, "--c", "40", "--cohesion", "30").stderr.startswith(
        "E100 --c is given twice"
    )
    assert (
        sk.solve(WEDGE, "strength.joint.cohesion", fs=1.5).line
        == sk.solve(WEDGE, "strength.joint.c", fos=1.5).line
    )


def test_no_synonym_is_a_key_itself() -> None:
    """A word that is a key of some group is that key: no table may take it from there."""
    meanings = {name for names in SYNONYMS.values() for name in names}
    assert not meanings & {word for word in SYNONYMS if word != "fs"}


@pytest.mark.parametrize(
    ("option", "proposed"),
    [
        ("--fos", "--accept-fos"),
        ("--fs", "--accept-fos"),
        ("--factor", "--accept-fos"),
        ("--slope", "--face"),
        ("--anchors", "--bolt"),
        ("--H", "--height"),
        ("-c", "--c"),
        ("--unit-weigth", "--unit-weight"),
        ("--hieght", "--height"),
        ("--frictoin", ""),
        ("--foo", ""),
    ],
)
def test_an_unknown_option_gets_what_it_means_or_nothing(option, proposed) -> None:
    said = slopekit("wedge", "--dips", "45/115", "45/245", option, "1").stderr
    assert said.startswith(f"E100 No such option: {option}\n")
    assert ("Did you mean " in said) == bool(proposed)
    assert proposed in said


PLANES = {
    "45-115": "45/115",
    "45,115": "45/115",
    "45 115": "45/115",
    "45;115": "45/115",
    "45°, 115°": "45/115",
    "115 45": "45/115",
    "45,5/115": "45.5/115",
    "45 to 115": "45/115",
    "dip 45 dd 115": "45/115",
    "45SE": "45/135",
    "45/SE": "45/135",
    "J1=45/115": "45/115",
    "45 deg/115 deg": "45/115",
}


@pytest.mark.parametrize(("written", "meant"), PLANES.items())
def test_a_plane_in_other_notation_gets_a_ready_answer(written, meant) -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.load({**WEDGE, "joints": {"J1": {"plane": written}, "J2": {"plane": "45/245"}}})
    assert caught.value.codes == ("E104",)
    assert caught.value.faults[0].advice.startswith(f"Write {meant}")
    sk.load({**WEDGE, "joints": {"J1": {"plane": meant}, "J2": {"plane": "45/245"}}})


def test_a_bearing_in_quadrants_says_every_meaning() -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.wedge(dips=("S45E/45", "45/245"))
    assert re.findall(r"\d+/\d+", caught.value.faults[0].advice) == ["45/135", "45/045", "45/225"]


@pytest.mark.parametrize(
    ("call", "where"),
    [
        (lambda: sk.wedge(dips=("45/115", "45/245"), face="95/180"), "face"),
        (lambda: sk.wedge(dips=("45/115", "45/245"), face=(95, 180)), "face"),
        (lambda: sk.wedge(dips=("45/115", "45/245"), upper="120/180"), "upper"),
        (lambda: sk.load({**WEDGE, "slope": {"face": "95/180", "height": 20}}), "face"),
        (
            lambda: sk.load(
                {**WEDGE, "slope": {"face": {"dist": "fisher", "mean": "95/180", "k": 9}}}
            ),
            "face",
        ),
        (lambda: sk.kinematic(["45/115", "45/245"], face="95/180", phi=30), "face"),
        (lambda: sk.combos(["45/115", "45/245"], face="95/180", height=10, c=5, phi=30), "face"),
    ],
)
def test_a_face_beyond_vertical_overhangs_and_is_not_turned_around(call, where) -> None:
    with pytest.raises(sk.DesignError) as caught:
        call()
    assert re.search(rf"dip of (mean of slope\.)?{where} is ", str(caught.value))
    assert "it overhangs" in str(caught.value)
    assert "85/" not in str(caught.value)


#: Wrong designs: what is changed, and what the advice says that is right (or its beginning).
WRONG: list[tuple[dict[str, Any], str]] = [
    ({"joints": {"J1": "45/115", "J2": "45/245"}}, "J2: {plane: 45/245}"),
    ({"joints": ["45/115", "45/245"]}, "joints: {J1: {plane: 45/115}, J2: {plane: 45/245}}"),
    ({"joints": {"J1": [45, 115], "J2": [45, 245]}}, "J2: {plane: 45/245}"),
    ({"strength": {"c": 50, "phi": 20}}, "strength: {joint: {c: 50, phi: 20}}"),
    (
        {"strength": {"cohesion": 50, "friction": 20}},
        "strength: {joint: {cohesion: 50, friction: 20}}",
    ),
    ({"slope": "70/200"}, "slope: {face: 70/200}"),
    ({"acceptance": "fos >= 1.3"}, 'acceptance: {rules: ["fos >= 1.3"]}'),
    ({"acceptance": {"fos": 1.3}}, 'rules: "fos >= 1.3"'),
    ({"acceptance": {"factor": 1.3}}, 'rules: "fos >= 1.3"'),
    ({"support": ["200 kN@000/10"]}, 'support: {bolts: ["200 kN@000/10"]}'),
    ({"strength": {"joint": {"c": 5, "tan_phi": 0.4}}}, "phi: 21.8"),
    (
        {"strength": {"joint": {"c": 5, "phi": {"mean": 23, "std": 3}}}},
        "{dist: normal, mean: 23, sd: 3}",
    ),
]


@pytest.mark.parametrize(("wrong", "proposal"), WRONG, ids=[proposal for _, proposal in WRONG])
def test_a_correction_has_the_users_own_values_and_is_valid(wrong, proposal) -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.load({**WEDGE, **wrong})
    assert any(proposal in fault.advice for fault in caught.value.faults)
    typed = yaml.safe_load(proposal)
    place = next(iter(wrong))
    if place in typed:
        mended = {**WEDGE, **typed}
    elif "dist" in typed:
        mended = {**WEDGE, "strength": {"joint": {"c": 5, "phi": typed}}}
    elif place == "joints":
        mended = {**WEDGE, "joints": {"J1": {"plane": "45/115"}, **typed}}
    else:
        group = {"acceptance": {}, "strength": {"c": 5}}[place]
        mended = {
            **WEDGE,
            place: {**group, **typed} if place == "acceptance" else {"joint": {**group, **typed}},
        }
    sk.load(mended)


#: Keys that no design has, where they stand, and the key that the advice names; "" where it names none.
KEYS = [
    ("rock", "weight", "unit_weight"),
    ("rock", "E", "modulus"),
    ("rock", "nu", "poisson"),
    ("loads", "earthquake", "seismic"),
    ("loads", "force", "forces"),
    ("loads.seismic", "direction", "toward"),
    ("support", "anchors", "bolts"),
    ("slope", "H", "height"),
    ("slope", "bench_height", "height"),
    ("slope", "crest", "upper"),
    ("slope", "hieght", "height"),
    ("joints.J1", "orientation", "plane"),
    ("strength.joint", "psi", "dilation"),
    ("strength.joint", "JRC", "jrc"),
    ("strength.joint", "phi_b", ""),
    ("strength.joint", "cov", ""),
    ("strength.joint", "angle", ""),
    ("water", "ru", ""),
    ("water", "pressure", "pressures"),
    ("loads.seismic", "kv", ""),
    ("crack", "dist", "distance"),
    ("", "tension_crack", "crack"),
    ("", "materials", "strength"),
    ("", "dips", "joints"),
]


@pytest.mark.parametrize(("path", "word", "key"), KEYS)
def test_an_unknown_key_gets_what_it_means_or_the_known_ones(path, word, key) -> None:
    design = deepcopy(WEDGE)
    holder = design
    for part in path.split(".") if path else ():
        holder = holder.setdefault(part, {})
    holder[word] = 0.2
    with pytest.raises(sk.DesignError) as caught:
        sk.load(design)
    advice = next(
        fault.advice
        for fault in caught.value.faults
        if fault.message.startswith(f"{word} is not a key")
    )
    assert advice == f"Did you mean {key}?" if key else advice.startswith("Known here: ")


@pytest.mark.parametrize(
    ("key", "first"),
    [
        ("cohesion", "strength.<name>"),
        ("c", "strength.<name>"),
        ("phi", "strength.<name>"),
        ("gamma", "rock"),
        ("unit_weight", "rock"),
        ("kh", "loads.seismic"),
        ("height", "slope"),
        ("bolts", "support"),
        ("fos", "acceptance"),
    ],
)
def test_a_key_at_the_top_is_sent_where_it_is_most_often(key, first) -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.load({**WEDGE, key: 1.5})
    assert caught.value.faults[0].advice.partition("under ")[2].startswith(first)


def test_angles_beside_a_joint_are_sent_under_its_plane() -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.load({**WEDGE, "joints": {"J1": {"dip": 45, "dipdir": 115}, "J2": {"plane": "45/245"}}})
    assert [fault.advice for fault in caught.value.faults] == [
        "dip belongs under joints.J1.plane.",
        "dip_direction belongs under joints.J1.plane.",
    ]
