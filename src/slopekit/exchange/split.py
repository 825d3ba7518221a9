"""One closed mesh file a block, and the design (kind: blocks) that reads them, with all that carries over."""

import json
import math
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from slopekit._version import __version__
from slopekit.core.arrays import Floats
from slopekit.core.errors import Notice, writing
from slopekit.core.whole_files import whole_files
from slopekit.evidence import WithoutBasal
from slopekit.exchange.picking import Picked, WrittenBlock
from slopekit.exchange.solids import Files
from slopekit.exchange.source import ExportSource, Pair, bolt_of_load, direction_deg, joints_of, pairs_of
from slopekit.kinds.protocol import CarriedJoint

_APART = "between rows"  # the smooth strength of rows of columns that do not touch
DESIGN = "blocks.yaml"
_SLAB = 0.25  # thickness of the bedrock behind a joint, in parts of the block's size
_COMPARE = (
    f"run {DESIGN} and compare the factor: the node pairs differ, and the limit state may not be the only one"
)  # fmt: skip
_NOT_IN_FILES = re.compile(r"[^A-Za-z0-9._-]+")


def design_text(
    source: ExportSource,
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
    pairs = pairs_of(source, rock, joints)
    of_pair = {pair: joint for pair, joint in pairs.joint.items() if all(name in files for name in pair)}
    moving = [joint for pair, joint in of_pair.items() if not all(is_fixed[name] for name in pair)]
    default = Counter(joints[joint].strength for joint in moving).most_common(1)[0][0]
    used = {joints[joint].strength: joints[joint] for joint in of_pair.values()}
    named = {
        pair: joints[joint].strength for pair, joint in of_pair.items()
        if joints[joint].strength != default
    }  # fmt: skip
    pressures = pressures_of(source, joints, of_pair, files)
    lost, rows = lost_of_mixed(source, pairs.mixed, pressures), source.carried.apart(inputs, source.scene.shapes.names)
    lost += ["that rows do not touch: here smooth joints lie between them"] if rows else []
    lost += lost_of_laws(inputs)
    lost += lost_of_strength_and_water(source)
    apart = [pair for pair in rows if all(name in files for name in pair)]
    if apart:
        smooth = CarriedJoint(_APART, 0.0, 0.0, 0.0, 0.0)
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


def _strength(name: str, joint: CarriedJoint, inputs: Mapping[str, Any]) -> str:
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


def _loads(source: ExportSource, files: Mapping[str, str]) -> tuple[list[str], list[str]]:
    """Seismic load and forces; active bolts act as forces."""
    arrows, names = source.scene.loads, source.scene.shapes.names
    forces, seismic = [], np.zeros(3)
    passive: dict[str, str] = {}
    bolts, away = source.document["inputs"].get("bolts", ()), []
    for what, block, force, at in zip(arrows.what, arrows.block, arrows.force_kn, arrows.at_m, strict=True):
        word, name = arrows.names[what], names[block]
        bolt = bolt_of_load(source.document, word)
        called = word if bolt is None else f"bolt {bolt[1]}"
        if word == "weight" or (source.has_many and word == "water"):
            continue
        if word == "seismic":
            seismic = force
        elif name not in files:
            away.append(called)
        elif bolt is not None and bolt[0] == "passive":
            passive.setdefault(called, _bolt(bolts[bolt[1] - 1], name, at))  # its head comes first
        else:
            own = f"force: {_point(force)}, block: {_text(name)}, at: {_point(at)}"
            forces.append(f"    - {{{own}}}  # {called}")
    lines = ["loads:"]
    coefficient = source.document["inputs"]["seismic"]["coefficient"]
    if coefficient and seismic.any():
        lines.append(f"  seismic: {{k: {coefficient!r}, toward: {direction_deg(seismic)!r}}}")
    lines += ["  forces:", *forces] if forces else ["  forces: []"]
    if passive:
        lines += ["support:", "  bolts:", *(f"    - {{{bolted}}}  # {name}" for name, bolted in passive.items())]
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
    keys = [f"mechanisms: {inputs.get('mechanisms', 1)}"]
    if inputs.get("criterion", "limit") != "limit":
        keys.append(f"criterion: {inputs['criterion']}")
    lines = [f"analysis: {{{', '.join(keys)}}}"]
    return [*lines, f"acceptance: {{rules: {json.dumps(rules)}}}"] if rules else lines


def _point(values: Sequence[float]) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def _text(text: str) -> str:
    """A text as YAML and JSON both write it."""
    return json.dumps(text, ensure_ascii=False)


def write_split(
    folder: Path, source: ExportSource, chosen: Picked, suffix: str, write: Callable[[Path, Picked], Files]
) -> tuple[Files, list[Notice]]:
    """Write a mesh a block and, where bedrock holds blocks that move, blocks.yaml.

    The bedrock of a wedge, a plane or a footing is a slab behind each joint. Blocks of a section stand in blocks.yaml
    as polygons, which say the same in fewer numbers.

    Returns
    -------
    files, blocks.yaml first, and the precision of the meshes; W376 where something does not carry over
    """
    fixed = source.scene.shapes.fixed
    rock = _slabs(source, chosen.bodies)
    bodies = [*chosen.bodies, *rock.values()]
    files = _file_names([body.name for body in bodies], suffix)
    is_fixed = {body.name: body.index < 0 or bool(fixed[body.index]) for body in bodies}
    text, notices = None, []
    why = _why_no_design(source, is_fixed)
    if why:
        notices.append(Notice("W376", f"no {DESIGN} is written: {why}"))
    else:
        behind = {k: slab.name for k, slab in rock.items()}
        if source.carried.bedrock_is_last:
            behind = dict.fromkeys(range(len(source.scene.shapes.contacts)), source.scene.shapes.names[-1])
        polygons = _polygons(source, chosen)
        text, lost = design_text(source, is_fixed, files, behind, polygons)
        whole = _whole(source.document)
        lost += [] if whole is None else [f"the whole wedge, which the basal joint is cut from ({whole.in_words()})"]
        if len(chosen.bodies) < len(fixed):
            lost.append(f"{len(fixed) - len(chosen.bodies)} of {len(fixed)} blocks, which were not chosen")
        if lost:
            notices.append(Notice("W376", f"{DESIGN} does not carry over: {'; '.join(lost)}"))
        if not polygons and source.has_many:
            notices.append(Notice("W376", _COMPARE))
    paths = [folder / files[body.name] for body in bodies]
    precision = ""
    with writing(folder), whole_files(folder) as staging:
        for path, body in zip(paths, bodies, strict=True):
            mesh = replace(chosen, what=("blocks",), bodies=(body,), contacts=chosen.contacts[:0])
            _, precision = write(staging / path.name, mesh)
        if text is not None:
            (staging / DESIGN).write_text(text, encoding="utf-8")
            paths.insert(0, folder / DESIGN)
    return (paths, precision), notices


def _whole(document: Mapping[str, Any]) -> WithoutBasal | None:
    """The larger wedge that a block above a basal joint is part of, which no mesh of that block shows."""
    rows = document.get("mechanisms") or ()
    whole = next((row for row in rows if row["mechanism"] == "whole_wedge"), None)
    return None if whole is None else WithoutBasal(whole["status"], whole["fos"])


def _polygons(source: ExportSource, chosen: Picked) -> dict[str, Floats]:
    """The polygons (k, 2) of a section of blocks, which say all of it; none where rows of columns stand in space."""
    if not (source.has_many and chosen.outlines):
        return {}
    middles = [float(body.vertices[:, 1].mean()) for body in chosen.bodies]
    if np.ptp(middles) > 0.0:
        return {}
    return {body.name: outline[:, [0, 2]] for body, outline in zip(chosen.bodies, chosen.outlines, strict=True)}


def _why_no_design(source: ExportSource, is_fixed: Mapping[str, bool]) -> str:
    if source.is_curved:
        return "the slip surface is curved, its normals are not those of the triangles (kind surface reads meshes too)"
    if all(is_fixed.values()):
        return "all of these blocks are bedrock"
    whole, limit = _whole(source.document), (source.document.get("fos") or {}).get("limit")
    if whole is not None and whole.falls_short(math.inf if limit is None else limit):
        return (f"the whole wedge, without the basal joint, fails before the block above it: {whole.in_words()} by the "
                "closed form; blocks cut from that block alone would stand without a word of it")  # fmt: skip
    return "" if any(is_fixed.values()) else "none of these blocks is bedrock, nothing would hold them"


def _file_names(names: Sequence[str], suffix: str) -> dict[str, str]:
    """A file for every block; what a file name may not hold becomes _, and no two differ by capitals alone."""
    file_names: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        stem = base = _NOT_IN_FILES.sub("_", name).strip(".") or "block"
        count = 1
        while stem.lower() in taken:
            count += 1
            stem = f"{base}_{count}"
        taken.add(stem.lower())
        file_names[name] = stem + suffix
    return file_names


def _slabs(source: ExportSource, bodies: Sequence[WrittenBlock]) -> dict[int, WrittenBlock]:
    """Bedrock behind each joint of a single convex block, by the index of the contact."""
    if source.has_many or source.is_curved or len(bodies) != 1:
        return {}
    shapes = source.scene.shapes
    contacts, joints = shapes.contacts, joints_of(source)
    slabs = {}
    for k in range(len(contacts)):
        joint = shapes.joints[contacts.joint[k]]
        if joint in joints:
            corners = contacts.corners[contacts.first[k] : contacts.first[k + 1]]
            slabs[k] = _slab(corners, bodies[0], f"bedrock {joint}")
    return slabs


def _slab(corners: Floats, body: WrittenBlock, name: str) -> WrittenBlock:
    """A convex face of a block, drawn out of it."""
    middle = body.vertices.mean(axis=0)
    turned = np.roll(corners, -1, axis=0)
    out = np.cross(corners - corners[0], turned - corners[0]).sum(axis=0)
    ring = corners
    if out @ (corners[0] - middle) < 0.0:
        out, ring = -out, corners[::-1]
    depth = _SLAB * float(np.ptp(body.vertices, axis=0).max())
    count = len(ring)
    vertices = np.concatenate([ring, ring + depth * out / np.sqrt(out @ out)])
    here, after = np.arange(count), np.roll(np.arange(count), -1)
    fan = np.stack([np.zeros(count - 2, dtype=np.int64), here[1:-1], here[2:]], axis=1)
    sides = [np.stack([here, after, after + count], axis=1), np.stack([here, after + count, here + count], axis=1)]
    return WrittenBlock(-1, name, vertices, np.concatenate([fan[:, ::-1], fan + count, *sides]))


# -- what a design of its own does not hold ----------------------------------------------------------------------------


#: What acceptance can name in a design of kind blocks; the last only where its criterion is asked for.
_RULES = ("fos", "fos.limit", "fos.static_bound")
_ALL_PAIRS = "fos.all_pairs_failed"
_SHOWN = 3


def acceptance(inputs: Mapping[str, Any]) -> tuple[list[str], list[str]]:
    """The acceptance rules that kind blocks can judge, and in words those it cannot."""
    known = (*_RULES, _ALL_PAIRS) if inputs.get("criterion") == "all-pairs" else _RULES
    kept: list[str] = []
    lost: list[str] = []
    for one in inputs.get("rules", ()):
        text = f"{one['name']} {one['relation']} {one['value']!r}"
        (kept if one["name"] in known else lost).append(text)
    if not lost:
        return kept, []
    word = "acceptance" if len(lost) == 1 else f"{len(lost)} rules of acceptance"
    return kept, [f"{word} ({', '.join(lost)}): kind blocks has no such factor"]


def lost_of_laws(inputs: Mapping[str, Any]) -> list[str]:
    """Curved strength, of which the cohesion and the friction angle of one line are written."""
    given = [inputs.get("strength"), *(strength for _, strength in inputs.get("strengths", ()))]
    laws = [one["law"] for one in given if isinstance(one, Mapping) and "law" in one]
    named = dict.fromkeys(law["law"] for law in (*laws, *(law for law in inputs.get("laws", ()) if law)))
    return [f"curved strength ({', '.join(named)}): c and φ of its line up to 100 kPa are written"] if named else []


def lost_of_strength_and_water(source: ExportSource) -> list[str]:
    """Residual strength, and a water table over the contacts of many blocks."""
    inputs = source.document["inputs"]
    given = [inputs.get("strength"), *(strength for _, strength in inputs.get("strengths", ()))]
    has_residual = any(isinstance(one, Mapping) and "residual" in one for one in given) or "residuals" in inputs
    lost = ["residual strength: the peak alone is written"] if has_residual else []
    has_table = "table_points_m" in inputs or "table_plane" in inputs
    if has_table and source.has_many:
        lost.append("the water table: the blocks are dry, write water: {mode: table, ...} again")
    return lost


def lost_of_criterion(source: ExportSource) -> list[str]:
    """The all-pairs factor of one block is sought in another way than that of many."""
    if source.document["inputs"].get("criterion") != "all-pairs" or source.has_many:
        return []
    factor = (source.document.get("fos") or {}).get("all_pairs_failed")
    here = "here none was found" if factor is None else f"here it is {factor:.6g}"
    return [f"the search for all pairs failed: kind blocks has its own, compare that factor ({here})"]


def lost_of_mixed(source: ExportSource, mixed: Sequence[str], pressures: Mapping[Pair, float]) -> list[str]:
    """Interfaces that had several strengths or pressures and have one here."""
    if not mixed:
        return []
    if source.carried.mixed:
        shown = [f"{'/'.join(pair)} {value:g} kPa" for pair, value in pressures.items() if "/".join(pair) in mixed]
        return [source.carried.mixed + (f" ({_some(shown)})" if shown else "")]
    return [f"{len(mixed)} interfaces with several strengths or pressures have that of the largest part "
            f"({_some(mixed)})"]  # fmt: skip


def lost_of_loads(away: Sequence[str]) -> list[str]:
    """Loads by their names whose block was not chosen."""
    if not away:
        return []
    verb = "acts on a block" if len(away) == 1 else "act on blocks"
    return [f"{', '.join(away)}, which {verb} not chosen"]


def pressures_of(
    source: ExportSource, joints: Mapping[str, CarriedJoint], of_pair: Mapping[Pair, str], files: Mapping[str, str]
) -> dict[Pair, float]:
    """Mean water pressures (kPa) of pairs; those of single blocks act as forces."""
    if source.carried.pressures is not None:
        given = source.carried.pressures(source.document["inputs"])
        return {(a, b): value for a, b, value in given if a in files and b in files}
    return {pair: joints[joint].pressure for pair, joint in of_pair.items() if joints[joint].pressure}


def _some(texts: Sequence[str]) -> str:
    return ", ".join(texts[:_SHOWN]) + (", …" if len(texts) > _SHOWN else "")
