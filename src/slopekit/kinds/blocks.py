"""The user's own blocks: polygons of a section, or closed meshes."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from slopekit.arrays import Bools, Floats, Ints, frozen
from slopekit.core.sheet import counted
from slopekit.design.blocky import BlocksDesign
from slopekit.errors import DesignError, Fault, GeometryError, Notice
from slopekit.kinds.many_blocks import Blocks, kind_of_many_blocks, no_closed_form, no_notices
from slopekit.kinds.many_blocks_scene import AssemblyScene, with_loads
from slopekit.kinds.words import (
    BLOCKS_STATUSES,
    SheetPart,
    first_and_last,
    names_in_runs,
    strength_in_words,
)
from slopekit.result import Result, Words

_OVERLAP = 1e-3  # of the smaller block: a larger overlap is refused
_NAMED = 5  # blocks that a notice names
_MOST_INTERFACES = 3


def cut(design: BlocksDesign) -> AssemblyScene:
    """The blocks with what acts on them. Raises GeometryError and DesignError as `with_loads`."""
    names = tuple(block.name for block in design.blocks)
    fixed = np.array([block.fixed for block in design.blocks])
    scene = (_section if design.in_section else _solids)(design, names, fixed)
    kinds = tuple(name for name, _ in design.strengths)
    patches = scene.assembly.patches
    joint = np.full(len(patches), kinds.index(design.default_strength))
    pressures = np.zeros(len(patches))
    index = {name: k for k, name in enumerate(names)}
    low, high = np.minimum(patches.plus, patches.minus), np.maximum(patches.plus, patches.minus)
    key = low * len(names) + high
    notices = list(scene.notices)
    unmet = []
    for named, values, take in (
        (design.interfaces, joint, lambda name: kinds.index(str(name))),
        (design.pressures_kpa, pressures, float),
    ):
        for first, second, value in named:
            a, b = sorted((index[first], index[second]))
            at = key == a * len(names) + b
            values[at] = take(value)
            if not at.any():
                unmet.append(f"{first}/{second}")
    if unmet:
        notices.append(Notice("W335", f"interfaces are named between blocks that do not touch: {_some(unmet)}"))
    scene = replace(
        scene, assembly=replace(scene.assembly, patches=replace(patches, joint=joint)), joints=kinds,
        strengths=tuple(strength for _, strength in design.strengths), pressures=frozen(pressures),
        unit_weights=np.array([
            design.unit_weight_kn_m3 if block.unit_weight_kn_m3 is None else block.unit_weight_kn_m3
            for block in design.blocks
        ]), notices=tuple(notices),
    )  # fmt: skip
    return with_loads(design, scene, 270.0)


def _section(design: BlocksDesign, names: tuple[str, ...], fixed: Bools) -> AssemblyScene:
    from slopekit.geometry.section_blocks import section_assembly

    polygons = [np.array(block.polygon_m) for block in design.blocks]
    cut = section_assembly(polygons, fixed, design.thickness_m, design.contact_tolerance_m, names)
    _refuse_overlaps(names, cut.overlaps.pairs, cut.overlaps.amounts, cut.assembly.volumes / design.thickness_m, "m²")
    notices = _fit(names, cut.overlaps.amounts, cut.overlaps.pairs, cut.gaps, cut.untouching, "m", "m²")
    if cut.point_contacts:
        text = f"{cut.point_contacts} pairs of blocks touch at a corner only, which carries nothing"
        notices.append(Notice("W342", text))
    return AssemblyScene(
        cut.assembly, names, (), (), np.zeros(0), np.zeros(0),
        dict(zip(names, cut.outlines, strict=True)),
        {"contact_tolerance_m": cut.tolerance, "contact_length_m": cut.contact_length},
        (), tuple(notices), thickness=design.thickness_m,
    )  # fmt: skip


def _solids(design: BlocksDesign, names: tuple[str, ...], fixed: Bools) -> AssemblyScene:
    from slopekit.geometry.meshes import read_mesh
    from slopekit.geometry.solids import mesh_assembly

    meshes: list[tuple[Floats, Ints]] = []
    faults: list[Fault] = []
    for block in design.blocks:
        assert block.mesh is not None
        try:
            vertices, triangles, _ = read_mesh(Path(block.mesh.path), block.mesh.name, block.mesh.where, turn=False)
            meshes.append((vertices, triangles))
        except DesignError as error:
            faults += error.faults
    if faults:
        raise DesignError(faults)
    cut = mesh_assembly(meshes, fixed, design.contact_tolerance_m, names)
    _refuse_overlaps(names, cut.overlaps.pairs, cut.overlaps.amounts, cut.assembly.volumes, "m³")
    notices = _fit(names, cut.overlaps.amounts, cut.overlaps.pairs, cut.gaps, cut.untouching, "m²", "m³")
    if len(cut.turned):
        notices.append(Notice("W343", f"meshes that were inside out have been turned: {_listed(names, cut.turned)}"))
    several = np.flatnonzero(cut.shells > 1)
    if len(several):
        text = f"files that hold several closed surfaces, taken as one rigid block each: {_listed(names, several)}"
        notices.append(Notice("W344", text))
    if len(cut.unchecked):
        pairs = [f"{names[a]}/{names[b]}" for a, b in cut.unchecked.tolist()]
        notices.append(Notice("W345", f"whether these blocks overlap could not be computed: {_some(pairs)}"))
    return AssemblyScene(
        cut.assembly, names, (), (), np.zeros(0), np.zeros(0), {},
        {"contact_tolerance_m": cut.tolerance, "contact_area_m2": cut.contact_area}, (), tuple(notices),
    )  # fmt: skip


def _refuse_overlaps(names: Sequence[str], pairs: Ints, amounts: Floats, sizes: Floats, unit: str) -> None:
    """E257 for blocks that lie in each other by more than a thousandth of the smaller one."""
    faults = [
        Fault("E257", f"{names[a]} and {names[b]} overlap by {amount:.4g} {unit}", "",
              "Blocks may touch, not lie in each other: move one, or give contact_tolerance.")
        for (a, b), amount in zip(pairs.tolist(), amounts.tolist(), strict=True)
        if amount > _OVERLAP * min(sizes[a], sizes[b])
    ]  # fmt: skip
    if faults:
        raise GeometryError(faults[:20])


def _fit(
    names: Sequence[str], overlaps: Floats, pairs: Ints, gaps: "object", untouching: Ints, along: str, amount: str
) -> list[Notice]:
    """What a reader must know of overlaps, gaps and blocks that touch nothing."""
    notices = []
    if len(overlaps):
        apart_or_over = [
            f"{names[a]}/{names[b]} {size:.2g} {amount}"
            for (a, b), size in zip(pairs.tolist(), overlaps.tolist(), strict=True)
        ]
        notices.append(Notice("W333", f"{len(apart_or_over)} pairs of blocks overlap a little: {_some(apart_or_over)}"))
    places = getattr(gaps, "pairs").tolist()  # noqa: B009  (Gaps of geometry.fit)
    if places:
        most, long = getattr(gaps, "most").tolist(), getattr(gaps, "amounts").tolist()  # noqa: B009
        apart_or_over = [
            f"{names[a]} and {names[b]} are {1e3 * apart:.3g} mm apart over {size:.3g} {along}"
            for (a, b), apart, size in zip(places, most, long, strict=True)
        ]
        notices.append(Notice("W334", f"faces that do not touch: {_some(apart_or_over)}; they carry nothing "
                              "(contact_tolerance closes such gaps)"))  # fmt: skip
    if len(untouching):
        notices.append(Notice("W346", f"blocks that touch no other: {_listed(names, untouching)}"))
    return notices


def _listed(names: Sequence[str], which: Ints) -> str:
    return _some([names[k] for k in which.tolist()])


def _some(words: Sequence[str]) -> str:
    more = f" and {len(words) - _NAMED} more" if len(words) > _NAMED else ""
    return ", ".join(words[:_NAMED]) + more


def _slope(design: BlocksDesign, _result: Result) -> SheetPart:
    moving = [block.name for block in design.blocks if not block.fixed]
    fixed = [block.name for block in design.blocks if block.fixed]
    shape = f"polygons of a section {design.thickness_m:.6g} m thick" if design.in_section else "closed meshes"
    within = design.contact_tolerance_m
    touch = "" if within is None else f"; faces nearer than {within * 1e3:.6g} mm touch"
    entries = [
        f"{shape}{touch}",
        f"can move: {names_in_runs(moving)}; bedrock: {names_in_runs(fixed) or 'none'}",
    ]
    for name, strength in design.strengths:
        pairs = [f"{one}/{other}" for one, other, own in design.interfaces if own == name]
        shown, rest, _ = first_and_last(pairs, _MOST_INTERFACES, 0)
        listed = ", ".join([*shown, *([f"... and {rest} more"] if rest else [])])
        on = [f"on {counted(len(pairs), 'named interface')} ({listed})"] if pairs else []
        if name == design.default_strength:
            on.insert(0, "on every other interface" if design.interfaces else "on every interface")
        entries.append(f"{name}  {strength_in_words(strength, '.6g')}  {' and '.join(on) or 'on no interface'}")
    return SheetPart("BLOCKS", entries + _own_weights(design))


def _own_weights(design: BlocksDesign) -> list[str]:
    """Which blocks have a unit weight of their own, lightest first."""
    by_weight: dict[float, list[str]] = {}
    for block in design.blocks:
        own = block.unit_weight_kn_m3
        if own is not None and not block.fixed and own != design.unit_weight_kn_m3:
            by_weight.setdefault(own, []).append(block.name)
    if not by_weight:
        return []
    listed = [f"{weight:.5g} kN/m³ {names_in_runs(names)}" for weight, names in sorted(by_weight.items())]
    shown, rest, last = first_and_last(listed, 3, 1)
    more = [f"... {rest} more ..."] if rest else []
    return ["own unit weights: " + "; ".join([*shown, *more, *last])]


def _pressures(design: BlocksDesign) -> list[tuple[str, float]]:
    return [(f"{one}/{other}", pressure) for one, other, pressure in design.pressures_kpa]


OWN = Blocks(
    Words(
        "blocks of any shape", "blocks", "the way the file says", "closed form", "", BLOCKS_STATUSES,
        "there is none for blocks of any shape",
    ),
    cut, no_closed_form, no_notices,
)  # fmt: skip
KIND = kind_of_many_blocks(
    "blocks", OWN, _slope, _pressures,
)  # fmt: skip
