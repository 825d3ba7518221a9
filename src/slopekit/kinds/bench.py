"""A bench cut into blocks by joint sets."""

from collections.abc import Iterator

import numpy as np

from slopekit.design.blocky import BenchDesign, JointSetInput
from slopekit.errors import Notice
from slopekit.kinds.many_blocks import Blocks, kind_of_many_blocks, named_strength, no_closed_form
from slopekit.kinds.many_blocks_scene import AssemblyScene, with_loads
from slopekit.kinds.protocol import ClosedForm
from slopekit.kinds.words import BLOCKS_STATUSES, SheetPart, size_number
from slopekit.orientation import Plane
from slopekit.preie.ravelling import Failure
from slopekit.result import Result, Words


def cut(design: BenchDesign) -> AssemblyScene:
    """The blocks of the bench with what acts on them. Raises GeometryError and DesignError as `with_loads`."""
    from slopekit.geometry.bench import bench_body
    from slopekit.geometry.joint_sets import JointSet, planes_of_sets
    from slopekit.geometry.splitting import cut_bench

    body = bench_body(design.face.normal(), design.upper.normal(), design.height_m, design.length_m, design.depth_m)
    sets = [
        JointSet(given.plane.normal(), given.spacing_m, given.offset_m, given.scatter_deg, given.spacing_scatter)
        for given in design.sets
    ]
    planes = planes_of_sets(sets, body, np.random.default_rng(design.seed))
    cut = cut_bench(body, planes, design.max_blocks, design.min_volume_m3)
    assembly = cut.assembly
    notices = []
    if cut.planes_merged or cut.planes_on_body_faces:
        notices.append(Notice("W337", f"{cut.planes_merged} joint planes that coincide were merged, "
                              f"{cut.planes_on_body_faces} lie on a face of the bench and cut nothing"))  # fmt: skip
    if cut.slivers_joined or cut.slivers_left_out:
        left = f", {cut.slivers_left_out} without a neighbour left out ({cut.volume_left_out:.3g} m³)"
        notices.append(Notice("W336", f"{cut.slivers_joined} slivers below {cut.min_volume:.3g} m³ were joined to the "
                              f"neighbour they share most with{left if cut.slivers_left_out else ''}"))  # fmt: skip
    scene = AssemblyScene(
        assembly, tuple(f"B{k}" for k in range(1, len(assembly) + 1)), tuple(given.name for given in design.sets),
        tuple(design.strength(given.strength) for given in design.sets),
        np.full(len(assembly), design.unit_weight_kn_m3),
        np.array([given.pressure_kpa for given in design.sets])[assembly.patches.joint],
        {},
        {"volume_error": cut.volume_error, "area_error": cut.area_error, "plane_error_m": cut.plane_error,
         "joint_area_m2": cut.joint_area},
        (f"{cut.fixed} of {cut.blocks} blocks reach the ends, the back or the bottom of the bench, where the rock goes "
         "on: bedrock, no unknowns",),
        tuple(notices), origin=np.array(design.origin_m),
    )  # fmt: skip
    advice = "Take closer joints or a longer and deeper bench."
    return with_loads(design, scene, design.face.dip_direction_deg, advice)


def _notices(design: BenchDesign, scene: AssemblyScene, first: Failure, _: ClosedForm) -> Iterator[Notice]:
    patches, fixed = scene.assembly.patches, np.append(scene.assembly.fixed, True)
    moves = np.zeros(len(fixed), dtype=bool)
    moves[first.blocks] = True
    if ((moves[patches.plus] & fixed[patches.minus]) | (moves[patches.minus] & fixed[patches.plus])).any():
        yield Notice("W338", "the first mechanism touches blocks that are bedrock only because the model ends "
                     "there: see whether a longer or deeper bench changes the factor")  # fmt: skip


def _slope(design: BenchDesign, result: Result) -> SheetPart:
    entries, areas = [], result.geometry.areas_m2
    for one in design.sets:
        area = f"  area {size_number(areas[one.name])} m²" if one.name in areas else ""
        entries.append(
            f"{one.name} {one.plane}  {one.plane.in_words()}, every {one.spacing_m:.6g} m{_regularity(design, one)}  "
            f"{named_strength(design, one.strength)}{area}"
        )
    entries.append(_surface("face", design.face))
    entries.append(_surface("upper", design.upper))
    toe = "" if not any(design.origin_m) else " (mid-toe at {:.10g}, {:.10g}, {:.10g})".format(*design.origin_m)
    entries.append(
        f"bench {design.length_m:.6g} m along the strike{toe}, rock modelled to {design.depth_m:.6g} m behind the crest"
    )
    return SheetPart("SETS", entries)


def _regularity(design: BenchDesign, one: JointSetInput) -> str:
    """Where the set lies, and how it scatters."""
    words = ""
    if one.offset_m:
        side = "above" if one.offset_m > 0.0 else "below"
        words += f" (one plane {abs(one.offset_m):.6g} m {side} mid-toe)"
    turned = f"normals scatter by {one.scatter_deg:.4g}°" if one.scatter_deg else ""
    uneven = f"distances scatter by {one.spacing_scatter * 100:.4g} %" if one.spacing_scatter else ""
    if turned or uneven:
        words += f", {' and '.join(filter(None, (turned, uneven)))} (seed {design.seed})"
    return words


def _surface(name: str, plane: Plane) -> str:
    return f"{name} {plane}  " + (plane.in_words() if plane.dip_deg else "level")


OWN = Blocks(
    Words(
        "bench cut by joint sets", "bench", "the way the face dips", "closed form", "", BLOCKS_STATUSES,
        "there is none for blocks cut by joint sets",
    ),
    cut, no_closed_form, _notices,
)  # fmt: skip
KIND = kind_of_many_blocks(
    "bench", OWN, _slope, lambda design: [(one.name, one.pressure_kpa) for one in design.sets],
    with_areas=lambda design: {one.name for one in design.sets},
)  # fmt: skip
