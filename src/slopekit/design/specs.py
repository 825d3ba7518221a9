"""Which keys a design file of each kind may have: the language of UX.md as data."""

from collections.abc import Mapping

from slopekit.design.strength_laws import LAW_KEYS
from slopekit.design.structure import AnyOf, Leaf, ListOf, Named, Section, Spec

VERSION = 1
_NUMBER = Leaf(number=True)
_SETTING = Leaf()  # a count or a tolerance: a number that cannot scatter
_POINT = ListOf(Leaf(), 3, 3, example="[0, -3, 6]")


def _orientation(example: str, steep: tuple[str, str], direction: tuple[str, str]) -> AnyOf:
    """Two angles with a slash, a pair, a distribution, or the two angles by name, each a number or a distribution."""
    angles: Mapping[str, Spec] = {key: Leaf(number=True, example=value) for key, value in (steep, direction)}
    return AnyOf((Leaf(orientation=True, example=example), Section(angles, required=tuple(angles))), example=example)


def _plane(dip: str, direction: str) -> AnyOf:
    return _orientation(f"{dip}/{direction}", ("dip", dip), ("dip_direction", direction))


_TOWARD = _orientation("000/10", ("plunge", "10"), ("trend", "000"))
_STRENGTH = Section(
    {
        "c": Leaf(number=True, example="50 kPa"),
        "phi": Leaf(number=True, example="20"),
        "law": Leaf(example="barton-bandis"),
        **dict.fromkeys(LAW_KEYS, _NUMBER),
        "dilation": _NUMBER,
        "tension": _NUMBER,
        "stiffness": Section({
            "normal": Leaf(number=True, example="1e7"),
            "shear": AnyOf((
                Leaf(number=True, example="clough-duncan"),
                Section({"law": Leaf(example="clough-duncan")} | dict.fromkeys(("k1", "n", "Rf", "phi"), _NUMBER)),
            )),
        }),
    },
    example="{c: 50 kPa, phi: 20}",
)  # fmt: skip
_STRENGTHS = Named(_STRENGTH, at_least=1, example="{joint: {c: 50 kPa, phi: 20}}")
_ROCK = Section(
    {"density": Leaf(number=True, example="2600 kg/m3"), "unit_weight": _NUMBER, "gravity": _NUMBER},
    example="{density: 2600 kg/m3}",
)
_SEISMIC = AnyOf((Leaf(number=True, example="0.1"), Section({"k": _NUMBER, "toward": Leaf()}, required=("k",))))
_FORCE: Mapping[str, Spec] = {"force": AnyOf((_NUMBER, _POINT)), "toward": _TOWARD, "at": _POINT}
_LOADS = Section(
    {
        "seismic": _SEISMIC,
        "forces": ListOf(AnyOf((Leaf(example="500 kN@180/10"), _POINT, Section(_FORCE, required=("force",))))),
    }
)
_BOLT: Mapping[str, Spec] = {
    "force": _NUMBER, "head": _POINT, "toward": _TOWARD, "length": _NUMBER, "acts": Leaf(),
}  # fmt: skip
_SUPPORT = Section(
    {
        "bolts": ListOf(AnyOf((Leaf(example="200 kN@000/10,passive"), Section(_BOLT, required=("force", "toward"))))),
    }
)
_WATER = AnyOf((
    Leaf(example="dry"),
    Section({
        "mode": Leaf(example="dry"),
        "fill": Leaf(number=True, example="50 %"),
        "pressures": AnyOf((Leaf(number=True), ListOf(_NUMBER, 1), Named(_NUMBER, 1, example="{J1: 5 kPa}"))),
        "unit_weight": _NUMBER,
    }),
))  # fmt: skip
_ACCEPTANCE = Section(
    {"rules": AnyOf((ListOf(Leaf(example='"fos >= 1.5"')), Leaf()))}, example='{rules: ["fos >= 1.5"]}'
)
_CORRELATION = Named(Leaf(), pairs=True, example="{J1.phi/J2.phi: 0.8}")
_JOINT = Section(
    {"plane": _plane("45", "115"), "strength": Leaf()}, required=("plane",),
    example="{plane: 45/115}",
)  # fmt: skip
_FROM_CSV = Section(
    {"csv": Leaf(example="joints.csv"), "pick": AnyOf((ListOf(Leaf(), 1), Leaf())), "convention": Leaf(),
     "strength": Leaf()},
    required=("csv",),
)  # fmt: skip
_JOINTS = AnyOf((Named(_JOINT, 1, example="{J1: {plane: 45/115}}"), _FROM_CSV), example="{J1: {plane: 45/115}}")
_PLANE = _plane("60", "180")


def _analysis(*more: str) -> Section:
    keys: dict[str, Spec] = {
        "criterion": Leaf(example="limit"), "agree_within": _SETTING, "stop_when": _SETTING,
        "factors": ListOf(_SETTING, example="[1.0, 1.1, 1.2]"),
    }  # fmt: skip
    return Section(keys | dict.fromkeys(more, _SETTING))


def _kind(own: Mapping[str, Spec], required: tuple[str, ...], analysis: Section) -> Section:
    shared: dict[str, Spec] = {
        "slopekit": Leaf(example=str(VERSION)), "kind": Leaf(example="wedge"), "title": Leaf(),
        "strength": _STRENGTHS, "rock": _ROCK, "analysis": analysis, "acceptance": _ACCEPTANCE,
        "correlation": _CORRELATION,
    }  # fmt: skip
    return Section(shared | dict(own), required=("slopekit", "kind", *required))


# -- designs of many blocks: loads name their block, water is given by its pressures -----------------------------------

_BLOCK = Leaf(example="B1")
_LOADS_ON_BLOCKS = Section({
    "seismic": _SEISMIC,
    "forces": ListOf(AnyOf((
        Leaf(example="500 kN@180/10"), _POINT, Section({**_FORCE, "block": _BLOCK}, required=("force",)),
    ))),
})  # fmt: skip
_BOLTS_IN_BLOCKS = Section({
    "bolts": ListOf(AnyOf((
        Leaf(example="200 kN@000/10,passive"), Section({**_BOLT, "block": _BLOCK}, required=("force", "toward")),
    ))),
})  # fmt: skip
_ANALYSIS_OF_BLOCKS = Section({
    "criterion": Leaf(example="limit"), "agree_within": _SETTING, "stop_when": _SETTING, "mechanisms": _SETTING,
})  # fmt: skip


def _pressures(of: Spec) -> Spec:
    """Water of blocks; mode and fill are known here only so that the reader can say why they are not taken."""
    return AnyOf((Leaf(example="dry"), Section({"mode": Leaf(example="dry"), "fill": _NUMBER, "pressures": of})))


def _blocky(own: Mapping[str, Spec], pressures: Spec, required: tuple[str, ...]) -> Section:
    loads: dict[str, Spec] = {
        "water": _pressures(pressures), "loads": _LOADS_ON_BLOCKS, "support": _BOLTS_IN_BLOCKS,
    }  # fmt: skip
    return _kind(loads | dict(own), (*required, "strength"), _ANALYSIS_OF_BLOCKS)


SPECS: Mapping[str, Section] = {
    "wedge": _kind(
        {
            "slope": Section({"face": _PLANE, "upper": _PLANE, "height": Leaf(number=True, example="64.89 m"),
                              "origin": _POINT}),
            "joints": _JOINTS,
            "crack": Section(
                {"plane": _plane("80", "180"), "distance": Leaf(number=True, example="5 m"),
                 "water": Leaf()},
                required=("plane", "distance"),
            ),
            "water": _WATER, "loads": _LOADS, "support": _SUPPORT,
        },
        ("joints",), _analysis("refine"),
    ),
    "plane": _kind(
        {
            "slope": Section(
                {"face": _PLANE, "upper": _PLANE, "height": Leaf(number=True, example="12 m")},
                required=("face", "height"), example="{face: 60/180, height: 12 m, upper: 0/180}",
            ),
            "joints": _JOINTS,
            "crack": Section({"depth": Leaf(number=True, example="4.35 m"), "distance": _NUMBER, "water": _NUMBER}),
            "water": _WATER, "loads": _LOADS, "support": _SUPPORT,
        },
        ("slope", "joints", "strength", "rock"), _analysis("refine"),
    ),
    "footing": _kind(
        {
            "footing": Section(
                {"load": Leaf(number=True, example="1500 kN"), "at": Leaf(number=True, example="middle")},
                required=("load",), example="{load: 1500 kN, at: middle}",
            ),
            "weak_plane": Section(
                {"dip": Leaf(number=True, example="45"), "length": Leaf(number=True, example="7.07 m"),
                 "strength": Leaf(), "pairs": _SETTING},
                required=("dip", "length"), example="{dip: 45, length: 7.07 m}",
            ),
        },
        ("footing", "weak_plane", "strength"), _analysis(),
    ),
    "surface": _kind(
        {
            "slope": Section({
                "profile": ListOf(ListOf(Leaf(), 2, 2), 2, example="[[60, 0], [40, 0], [0, 40], [-20, 40]]"),
                "mesh": Leaf(example="slope.stl"),
            }, example="{profile: [[60, 0], [40, 0], [0, 40], [-20, 40]]}"),
            "slip": Section({
                "shape": Leaf(example="ellipsoid"), "centre": ListOf(Leaf(), 2, 3, example="[40, 0, 40]"),
                "radii": ListOf(Leaf(), 3, 3, example="[40, 28, 40]"), "radius": _NUMBER, "length": _NUMBER,
                "mesh": Leaf(example="slip.stl"), "edge": _SETTING, "normals": Leaf(example="true"),
            }, example="{shape: sphere, centre: [40, 0, 40], radius: 40}"),
            "water": _WATER, "loads": _LOADS, "support": _SUPPORT,
        },
        ("slope", "slip", "strength", "rock"), _analysis(),
    ),
    "topple": _blocky(
        {
            "columns": Section(
                {"dip": Leaf(number=True, example="60"), "width": Leaf(number=True, example="10 m"),
                 "heights": ListOf(_NUMBER, 1, example="[4, 10, 16]"), "base_step": _NUMBER, "thickness": _NUMBER,
                 "rows": _SETTING, "base": Leaf(), "sides": Leaf()},
                required=("dip", "width", "heights"),
                example="{dip: 60, width: 10 m, heights: [4, 10, 16], base_step: 1 m}",
            ),
        },
        Section({"base": _NUMBER, "sides": _NUMBER}, example="{base: 5 kPa, sides: 3 kPa}"),
        ("columns", "rock"),
    ),
    "bench": _blocky(
        {
            "slope": Section(
                {"face": _PLANE, "height": Leaf(number=True, example="15 m"), "upper": _PLANE, "length": _NUMBER,
                 "depth": _NUMBER, "origin": _POINT},
                required=("face", "height"), example="{face: 70/180, height: 15 m, length: 30 m}",
            ),
            "sets": Named(
                Section(
                    {"plane": _plane("45", "170"), "spacing": Leaf(number=True, example="2 m"),
                     "offset": _NUMBER, "strength": Leaf(), "scatter": _NUMBER, "spacing_scatter": _NUMBER},
                    required=("plane", "spacing"), example="{plane: 45/170, spacing: 2 m}",
                ),
                1, example="{S1: {plane: 45/170, spacing: 2 m}}",
            ),
            "cut": Section({"max_blocks": _SETTING, "min_volume": _SETTING, "seed": _SETTING}),
        },
        Named(_NUMBER, example="{S1: 5 kPa}"), ("slope", "sets", "rock"),
    ),
    "blocks": _blocky(
        {
            "section": Section({"thickness": _NUMBER}), "contact_tolerance": _SETTING,
            "blocks": Named(
                Section({
                    "polygon": ListOf(ListOf(Leaf(), 2, 2, example="[0, 5]"), 3, example="[[0, 0], [2, 0], [2, 1]]"),
                    "mesh": Leaf(example="block.stl"), "unit_weight": _NUMBER, "fixed": Leaf(example="true"),
                }, example="{polygon: [[0, 0], [2, 0], [2, 1]]}"),
                1, example="{B1: {polygon: [[0, 0], [2, 0], [2, 1]]}}",
            ),
            "interfaces": Named(Leaf(example="joint"), pairs=True, example="{default: joint, B1/B2: smooth}"),
        },
        Named(_NUMBER, pairs=True, example="{B1/B2: 5 kPa}"), ("blocks",),
    ),
}  # fmt: skip
