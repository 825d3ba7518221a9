"""The text of a design (kind: blocks) that reads mesh files: strengths, loads and water as far as they carry over."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from slopekit._version import __version__
from slopekit.arrays import Floats
from slopekit.exchange.losses import (
    acceptance,
    load_name,
    lost_of_columns,
    lost_of_criterion,
    lost_of_laws,
    lost_of_loads,
    lost_of_mixed,
    pressures_of,
    rows_apart,
)
from slopekit.exchange.source import Source
from slopekit.exchange.strengths import Joint, Pair, direction_deg, joints_of, pairs_of

_APART = "between rows"  # the smooth strength of rows of columns that do not touch


def design_text(
    source: Source,
    is_fixed: Mapping[str, bool],
    files: Mapping[str, str],
    rock: Mapping[int, str],
    polygons: Mapping[str, Floats],
) -> tuple[str, list[str]]:
    """The design, and what of the result's own it does not hold.

    Parameters
    ----------
    is_fixed : the blocks by name; files : their meshes
    rock : names of the bedrock behind contacts (by their index) that no block of the scene stands for
    polygons : (k, 2) x, z of the blocks of a section, which then stand in place of the meshes
    """
    document, inputs = source.document, source.document["inputs"]
    joints = joints_of(source)
    found = pairs_of(source, rock, joints)
    of_pair = {pair: joint for pair, joint in found.joint.items() if all(name in files for name in pair)}
    moving = [joint for pair, joint in of_pair.items() if not all(is_fixed[name] for name in pair)]
    default = Counter(joints[joint].strength for joint in moving).most_common(1)[0][0]
    used = {joints[joint].strength: joints[joint] for joint in of_pair.values()}
    named = {
        pair: joints[joint].strength for pair, joint in of_pair.items()
        if joints[joint].strength != default
    }  # fmt: skip
    pressures = pressures_of(source, joints, of_pair, files)
    lost = lost_of_mixed(source, found.mixed, pressures) + lost_of_columns(source) + lost_of_laws(inputs)
    apart = [pair for pair in rows_apart(source) if all(name in files for name in pair)]
    if apart:
        smooth = Joint(_APART, 0.0, 0.0, 0.0, 0.0)
        used, named = used | {_APART: smooth}, named | dict.fromkeys(apart, _APART)
    lines = [
        f"# Written by slopekit {__version__} export of a {document['kind']}, input {document.get('input_sha256')}",
        "slopekit: 1", "kind: blocks", f"title: {_text(document.get('title') or document['kind'])}",
        *([f"section: {{thickness: {document['geometry']['thickness_m']!r} m}}"] if polygons else []), "blocks:",
    ]  # fmt: skip
    weights = {one["name"]: one["unit_weight_kn_m3"] for one in inputs.get("blocks", ())}
    for name, file in files.items():
        own = f", unit_weight: {weights[name]!r}" if weights.get(name) is not None else ""
        shape = f"mesh: {_text(file)}"
        if polygons:
            shape = f"polygon: [{', '.join(_point(point) for point in polygons[name])}]"
        lines.append(f"  {_text(name)}: {{{shape}{own}{', fixed: true' if is_fixed[name] else ''}}}")
    lines += ["strength:", *(_strength(name, joint, inputs) for name, joint in used.items())]
    lines += ["interfaces:", f"  default: {_text(default)}"]
    lines += [f"  {_text('/'.join(pair))}: {_text(strength)}" for pair, strength in named.items()]
    lines.append(f"rock: {{unit_weight: {inputs['unit_weight_kn_m3']!r} kN/m3}}")
    lines += _water(pressures)
    loads, lost_loads = _loads(source, files)
    lines += loads
    rules, lost_rules = acceptance(inputs)
    lines += _analysis(inputs, rules)
    return "\n".join(lines) + "\n", lost + lost_loads + lost_of_criterion(source) + lost_rules


def _strength(name: str, joint: Joint, inputs: Mapping[str, Any]) -> str:
    given = inputs["stiffness"]
    shear = repr(given["shear_kn_m3"])
    if given["shear_kn_m3"] is None:
        law = given["hyperbola"]
        shear = (
            f"{{law: clough-duncan, k1: {law['modulus_number']!r}, n: {law['exponent']!r}, "
            f"Rf: {law['failure_ratio']!r}, phi: {law['friction_angle_deg']!r}}}"
        )
    return (
        f"  {_text(name)}: {{c: {joint.cohesion!r} kPa, phi: {joint.friction!r}, dilation: {joint.dilation!r}, "
        f"tension: {joint.tension!r} kPa, stiffness: {{normal: {given['normal_kn_m3']!r}, shear: {shear}}}}}"
    )


def _water(pressures: Mapping[Pair, float]) -> list[str]:
    if not pressures:
        return ["water: {mode: dry}"]
    return [
        "water:",
        "  pressures:",
        *(f"    {_text('/'.join(pair))}: {value!r} kPa" for pair, value in pressures.items()),
    ]


def _loads(source: Source, files: Mapping[str, str]) -> tuple[list[str], list[str]]:
    """Seismic load and forces; active bolts act as forces."""
    arrows, names, kind = source.scene.loads, source.scene.shapes.names, source.document["kind"]
    own_water = kind in ("bench", "blocks", "topple")
    forces, seismic = [], np.zeros(3)
    passive: dict[str, str] = {}
    bolts, away = source.document["inputs"].get("bolts", ()), []
    for what, block, force, at in zip(arrows.what, arrows.block, arrows.force_kn, arrows.at_m, strict=True):
        word, name = arrows.names[what], names[block]
        if word == "weight" or (own_water and word == "water"):
            continue
        if word == "seismic":
            seismic = force
        elif name not in files:
            away.append(load_name(source, word))
        elif word.startswith("passive"):
            called = load_name(source, word)
            passive.setdefault(called, _bolt(bolts[int(called.split()[1]) - 1], name, at))  # its head comes first
        else:
            own = f"force: {_point(force)}, block: {_text(name)}, at: {_point(at)}"
            forces.append(f"    - {{{own}}}  # {load_name(source, word)}")
    lines = ["loads:"]
    coefficient = source.document["inputs"]["seismic"]["coefficient"]
    if coefficient and seismic.any():
        lines.append(f"  seismic: {{k: {coefficient!r}, toward: {direction_deg(seismic)!r}}}")
    lines += ["  forces:", *forces] if forces else ["  forces: []"]
    if passive:
        lines += ["support:", "  bolts:", *(f"    - {{{bolt}}}  # {name}" for name, bolt in passive.items())]
    return lines, lost_of_loads(away)


def _bolt(given: Mapping[str, Any], block: str, at: Sequence[float]) -> str:
    """A passive bolt with its full capacity; without a head it passes through the centroid of its block."""
    line = given["toward"]
    length = "" if given["length_m"] is None else f", length: {given['length_m']!r} m"
    return (
        f"force: {given['force_kn']!r}, toward: [{line['trend_deg']!r}, {line['plunge_deg']!r}], acts: passive, "
        f"block: {_text(block)}, head: {_point(at)}{length}"
    )


def _analysis(inputs: Mapping[str, Any], rules: Sequence[str]) -> list[str]:
    keys = [f"stop_when: {inputs['stop_when']!r}", f"mechanisms: {inputs.get('mechanisms', 1)}"]
    if inputs.get("criterion", "limit") != "limit":
        keys.append(f"criterion: {inputs['criterion']}")
    lines = [f"analysis: {{{', '.join(keys)}}}"]
    return [*lines, f"acceptance: {{rules: {json.dumps(rules)}}}"] if rules else lines


def _point(values: Sequence[float]) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def _text(text: str) -> str:
    """A text as YAML and JSON both write it."""
    return json.dumps(text, ensure_ascii=False)
