"""The declared fields against what is read: the same units, the same limits, no number of a design left out."""

from collections.abc import Iterator

import pytest

from slopekit.core.errors import DesignError
from slopekit.core.units import quantity
from slopekit.design.fields import every_field, field_at, record_spec, words_of
from slopekit.design.reading.document import read_document
from slopekit.design.reading.files import load
from slopekit.design.reading.structure import Spec
from slopekit.design.registry import KINDS, record_of
from slopekit.design.strength_laws import fields_of_law
from slopekit.design.templates import names, path_of
from slopekit.strength.mohr_coulomb import MohrCoulomb
from slopekit.strength.registry import LAWS
from slopekit.studies.keys import keys_of

PLANE = {"dip": 45, "dip_direction": 115}
LINE = {"trend": 10, "plunge": 5}
SHEAR = {"k1": 4800, "n": 0.56, "Rf": 0.74, "phi": 36}
STRENGTH = {
    "c": 10,
    "phi": 30,
    "dilation": 1,
    "tension": 2,
    "stiffness": {"normal": 1e7, "shear": 1e6},
}
BY_LAW = {"c": 10, "phi": 30, "stiffness": {"shear": SHEAR}}
CURVED = (
    {
        "law": "barton-bandis",
        "jrc": 8,
        "jcs": 5e4,
        "phi_r": 25,
        "length": 5,
        "length_0": 0.1,
        "waviness": 3,
    },
    {"law": "power", "a": 2, "b": 0.75, "d": 5, "residual": {"c": 1, "phi": 20}},
    {"law": "bridged", "c": 1, "phi": 30, "c_rock": 500, "phi_rock": 45, "persistence": 0.9},
    {"law": "bilinear", "phi": 0, "i": 0, "sigma_t": 300},
)
#: The other laws, at the examples of their own fields.
OF_EXAMPLES = [
    {"law": name}
    | {one.path: quantity(one.example, one.measures, name) for one in fields_of_law(law).values()}
    for name, law in LAWS.items()
    if law is not MohrCoulomb and name not in {given["law"] for given in CURVED}
]
LOADS = {"seismic": {"k": 0.1, "toward": 180}, "forces": [{"force": 5, "toward": LINE}]}
BOLTS = {"bolts": [{"force": 5, "toward": LINE, "head": [0, 0, 0], "length": 9}]}
JOINTS = {"J1": {"plane": PLANE}, "J2": {"plane": "45/245"}}
FACE = {
    "face": {"dip": 60, "dip_direction": 180},
    "upper": {"dip": 5, "dip_direction": 180},
    "height": 30,
}
PROFILE = {"profile": [[60, 0], [40, 0], [0, 40], [-20, 40]]}
BENCH = {"plane": PLANE, "spacing": 2, "offset": 1, "scatter": 3, "spacing_scatter": 0.1}
SQUARE = [[0, 0], [2, 0], [2, 2], [0, 2]]
ROCK = {"unit_weight": 25, "gravity": 9.81}
# one design or more of each kind, with every number that may scatter in one of them
DESIGNS = [
    (
        "wedge",
        {
            "slope": FACE,
            "joints": JOINTS,
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "water": {"fill": 0.5},
            "crack": {"plane": PLANE, "distance": 5},
            "loads": LOADS,
            "support": BOLTS,
        },
    ),
    (
        "wedge",
        {
            "slope": FACE,
            "joints": JOINTS,
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "basal": {"plane": PLANE, "height": 5},
        },
    ),
    (
        "wedge",
        {
            "slope": FACE,
            "joints": JOINTS,
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "limits": {
                "bench_width": 6,
                "slope_length": 50,
                "trace_length": 10,
                "persistence": 8,
                "max_volume": 500,
            },
        },
    ),
    (
        "wedge",
        {
            "slope": FACE,
            "joints": JOINTS,
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "limits": {"trace_length": {"J1": 10}, "persistence": {"J1": 8}, "min_volume": 0.1},
        },
    ),
    (
        "wedge",
        {
            "joints": JOINTS,
            "strength": {"a": BY_LAW},
            "rock": {"density": 2600},
            "water": {"pressures": {"J1": 5}, "unit_weight": 9.81},
            "loads": {"seismic": 0.1},
        },
    ),
    (
        "wedge",
        {
            "joints": JOINTS,
            "strength": {"a": BY_LAW},
            "water": {"mode": "table", "depth": 4, "pond": 3},
            "loads": {"surcharge": 20},
        },
    ),
    (
        "plane",
        {
            "slope": FACE,
            "joints": {"J1": {"plane": PLANE}},
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "crack": {"depth": 4, "water": 3},
            "loads": LOADS,
        },
    ),
    (
        "plane",
        {
            "slope": FACE,
            "joints": {"J1": {"plane": PLANE}},
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "crack": {"distance": 4},
            "water": {"pressures": [5, 6]},
        },
    ),
    *(
        (
            "plane",
            {
                "slope": FACE,
                "joints": {"J1": {"plane": PLANE}},
                "strength": {"a": law},
                "rock": ROCK,
            },
        )
        for law in (*CURVED, *OF_EXAMPLES)
    ),
    (
        "footing",
        {
            "footing": {"load": 1500, "at": 2},
            "weak_plane": {"dip": 45, "length": 7},
            "strength": {"a": STRENGTH},
            "uplift": {"toe": 20, "heel": 5, "drain": 0.5},
        },
    ),
    (
        "footing",
        {
            "footing": {"load": 1500, "at": 2},
            "weak_plane": {"dip": 45, "length": 7},
            "strength": {"a": STRENGTH},
            "uplift": {"fill": 0.5},
        },
    ),
    (
        "surface",
        {
            "slope": PROFILE,
            "slip": {"shape": "cylinder", "centre": [44, 44], "radius": 44, "length": 10},
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "water": {"pressures": 5},
        },
    ),
    (
        "topple",
        {
            "columns": {"dip": 60, "width": 10, "heights": [4, 10], "base_step": 1, "thickness": 2},
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "water": {"pressures": {"base": 5, "sides": 3}},
        },
    ),
    (
        "topple",
        {
            "columns": {"dip": 60, "width": 10, "base_angle": 36},
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "slope": {"height": 92, "face": 56, "upper": 4},
        },
    ),
    (
        "bench",
        {
            "slope": FACE | {"length": 30, "depth": 20},
            "sets": {"S1": BENCH},
            "strength": {"a": STRENGTH},
            "rock": ROCK,
            "water": {"pressures": {"S1": 5}},
        },
    ),
    (
        "blocks",
        {
            "blocks": {
                "base": {"polygon": SQUARE, "fixed": "true"},
                "B": {"polygon": SQUARE, "unit_weight": 25},
            },
            "section": {"thickness": 2},
            "strength": {"a": STRENGTH},
            "water": {"pressures": {"B/base": 5}},
        },
    ),
    (
        "blocks",
        {
            "blocks": {
                "base": {"polygon": SQUARE, "fixed": "true"},
                "B": {"polygon": SQUARE, "unit_weight": 25},
            },
            "strength": {"a": STRENGTH},
            "loads": {"surcharge": {"B": 20}},
        },
    ),
]


def _in_numbers(kind: str, value: object, path: str = "") -> object:
    """What a template says, its quantities as numbers."""
    if isinstance(value, dict):
        return {
            key: _in_numbers(kind, below, f"{path}.{key}" if path else key)
            for key, below in value.items()
        }
    field = field_at(record_of(kind), path)
    return (
        quantity(value, field.measures, path)
        if isinstance(value, str) and field and field.is_number
        else value
    )


DESIGNS += [
    (
        kind,
        {
            key: _in_numbers(kind, value, key)
            for key, value in read_document(path_of(kind))[0].root.plain().items()
        },
    )
    for kind in KINDS
    if kind not in {kind for kind, _ in DESIGNS}
]
_UNITS = {
    "length": "m",
    "pressure": "kPa",
    "unit weight": "kN/m3",
    "density": "kg/m3",
    "force": "kN",
    "angle": "deg",
    "stiffness": "kPa/m",
    "volume": "m3",
    "acceleration": "m/s2",
    "ratio": "",
}
_WRONG = {"length": "kPa", "ratio": "m"}
_STEP = 1e-9
#: Columns of a slope whose numbers are each taken for themselves, and do not fit together.
_TOGETHER = {"E450"}


def _numbers(value: object, path: str = "") -> Iterator[tuple[str, float]]:
    if isinstance(value, dict):
        for key, below in value.items():
            yield from _numbers(below, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for k, below in enumerate(value):
            yield from _numbers(below, f"{path}.{k}")
    elif isinstance(value, int | float):
        yield path, value


def _with(design: dict, path: str, value: object) -> dict:
    key, _, below = path.partition(".")
    return design | {key: _with(design.get(key, {}), below, value) if below else value}


def _seen() -> set[str]:
    matched = [(record_of(kind), path) for kind, design in DESIGNS for path, _ in _numbers(design)]
    return {field.path for record, path in matched if (field := field_at(record, path)) is not None}


_SEEN = _seen()
#: Keys that no design above has, where they take their defaults: those of a field that was declared since.
DESIGNS += [
    (kind, _with(next(design for of, design in DESIGNS if of == kind), field.path, field.default))
    for kind in KINDS
    for field in every_field(record_of(kind))
    if field.is_number
    and field.scatters
    and field.path not in _SEEN
    and isinstance(field.default, int | float)
]


def _cases() -> dict:
    """Each number once, and once for each law of strength: in other designs of its kind it is read the same way."""
    found = {}
    for kind, design in DESIGNS:
        laws = [given.get("law", "") for given in design.get("strength", {}).values()]
        for path, value in _numbers(design):
            field = field_at(record_of(kind), path)
            if field is not None and field.scatters:
                law = "-".join(laws) if path.startswith("strength") else ""
                found.setdefault(f"{kind}-{path}-{law}", (kind, design, path, value, field))
    return found


CASES = _cases()


def _accepts(kind: str, design: dict, path: str, value: object) -> bool:
    values = [(path, str(value))]
    if path.startswith("columns.heights"):
        values.append(("columns.base_step", "0"))  # which no column may be lower than
    elif path.endswith(".dilation"):
        values.append(
            (path.replace("dilation", "phi"), "89.9999999999")
        )  # which dilation may not pass
    elif path.endswith(".phi") and "shear" not in path and "residual" not in path:
        values.append((path.replace("phi", "dilation"), "0"))
    try:
        load({"slopekit": 1, "kind": kind} | design, values)
    except DesignError as error:
        return set(error.codes) <= _TOGETHER
    return True


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "design", "path", "value", "expected"), CASES.values(), ids=CASES)
def test_units_and_limits_are_those_of_the_reader(kind, design, path, value, expected) -> None:
    """Just beyond a limit a value is refused; the limit itself or what lies just within is taken."""
    assert _accepts(kind, design, path, value)
    assert _accepts(kind, design, path, f"{value} {_UNITS[expected.measures]}")
    wrong = "deg" if expected.or_measures else _WRONG.get(expected.measures, "m")
    assert not _accepts(kind, design, path, f"{value} {wrong}")

    for limit, inward in ((expected.least, 1.0), (expected.most, -1.0)):
        if abs(limit) == float("inf"):
            assert (
                _accepts(kind, design, path, value - 1000.0 * inward) or path == "columns.base_step"
            )
            continue
        step = _STEP * max(abs(limit), 1.0) * inward
        assert not _accepts(kind, design, path, repr(limit - step))
        assert _accepts(kind, design, path, repr(limit)) or _accepts(
            kind, design, path, repr(limit + step)
        )


def test_every_field_that_may_scatter_is_looked_at() -> None:
    every = {
        field.path
        for kind in KINDS
        for field in every_field(record_of(kind))
        if field.is_number and field.scatters and not (field.many and not field.path.endswith(".*"))
    }
    assert every - _seen() == set()


def _leaves(spec: Spec, path: str) -> Iterator[str]:
    """The paths of all numbers that may scatter, X for a name of the user's."""
    for key, below in (spec.keys or {}).items():
        yield from _leaves(below, f"{path}.{key}" if path else key)
    if spec.names is not None:
        yield from _leaves(spec.names, f"{path}.X")
    if spec.items is not None:
        yield from _leaves(spec.items, f"{path}.0")
    if spec.value == "number":
        yield path


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_that_may_scatter_is_a_field(kind) -> None:
    record = record_of(kind)
    paths = set(_leaves(record_spec(record, record.REQUIRED), ""))
    assert len(paths) > 5
    assert {path for path in paths if field_at(record, path) is None} == set()


@pytest.mark.parametrize("name", [*names(), *range(len(DESIGNS))])
def test_every_number_of_a_design_has_words_of_its_own(name) -> None:
    """Axes tell two numbers of one design apart, and show no path."""
    if isinstance(name, int):
        kind, values = DESIGNS[name]
        design = load({"slopekit": 1, "kind": kind} | values)
    else:
        design = load(path_of(name))
    found = {}
    for key in keys_of(design):
        found.setdefault(words_of(type(design), key.path), []).append(key.path)
    assert len(found) > 5
    twice = [paths for paths in found.values() if len(paths) > 1]
    assert all(paths == ["loads.seismic", "loads.seismic.k"] for paths in twice), twice
    for words, (path, *_) in found.items():
        top, _, below = path.partition(".")
        assert words != path
        assert not words.startswith(f"{top}.")
        assert "_" not in words or "_" in below.partition(".")[0]  # in a name of the user's
