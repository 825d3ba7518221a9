"""Words for the sheet that differ by kind of design: planes, sizes, numbers as a person writes them."""

from slopekit.design.blocky import AssemblyDesign
from slopekit.design.common import Design, Strength
from slopekit.design.kinds import FootingDesign, PlaneDesign, SurfaceDesign
from slopekit.design.wedge import WedgeDesign
from slopekit.extents import SectionGeometry, SurfaceGeometry, WedgeGeometry
from slopekit.orientation import Line
from slopekit.result import Result


def planes(result: Result) -> tuple[str, list[str]]:
    """What the block lies on, in words, and the label of that."""
    design, geometry = result.design, result.geometry
    if isinstance(design, WedgeDesign) and isinstance(geometry, WedgeGeometry):
        return "PLANES", _wedge_planes(design, geometry)
    if isinstance(design, PlaneDesign) and isinstance(geometry, SectionGeometry):
        return "PLANES", _plane_planes(design, geometry)
    if isinstance(design, FootingDesign):
        area = size_number(design.length_m)
        words = f"weak plane dips {design.dip_deg:.6g}°, {area} m long  {_strength(design.strength)}"
        return "PLANES", [words]
    if isinstance(design, SurfaceDesign) and isinstance(geometry, SurfaceGeometry):
        return "SURFACE", _surface(design, geometry)
    return "PLANES", []


def size(result: Result) -> list[str]:
    """Height, volume, weight."""
    design, geometry = result.design, result.geometry
    weight = weight_in_words(result)
    volume = f"volume {size_number(geometry.volume_m3)} m³"
    if isinstance(geometry, WedgeGeometry) and isinstance(design, WedgeDesign):
        heights = f"height {size_number(design.height_m)} m (total {size_number(geometry.total_height_m)} m)"
    elif isinstance(geometry, SectionGeometry):
        heights = f"height {size_number(geometry.total_height_m)} m"
        if isinstance(design, PlaneDesign):
            heights = f"height {size_number(design.height_m)} m (total {size_number(geometry.total_height_m)} m)"
        volume += " per metre"
    elif isinstance(geometry, SurfaceGeometry):
        heights = f"height {size_number(geometry.total_height_m)} m"
    else:
        heights = ""
    return [f"{heights}  {volume}  {weight}"]


def weight_in_words(result: Result) -> str:
    """The weight of what moves, and the unit weight it comes from."""
    design = result.design
    if not design.unit_weight_kn_m3:
        return "weight left out"
    density = "" if design.density_kg_m3 is None else f" ({design.density_kg_m3:.5g} kg/m³)"
    return f"weight {size_number(result.forces.weight)} kN  unit weight {design.unit_weight_kn_m3:.5g} kN/m³{density}"


def dilates(design: Design) -> bool:
    """Whether any joint of the design dilates as it slips."""
    if isinstance(design, WedgeDesign):
        return any(design.dilation_deg)
    if isinstance(design, AssemblyDesign):
        return any(strength.dilation_deg for _, strength in design.strengths)
    strength = getattr(design, "strength", None)
    return isinstance(strength, Strength) and bool(strength.dilation_deg)


def line_in_words(line: Line) -> str:
    """Trend and plunge as the sheet prints them."""
    return f"{line.trend_deg % 360.0:03.0f}/{line.plunge_deg:.1f}"


def _strength(strength: Strength) -> str:
    words = f"c {strength.cohesion_kpa:.1f} kPa  φ {strength.friction_angle_deg:.1f}°"
    if strength.law is not None:
        words = strength.law.in_words()
    if strength.dilation_deg:
        words += f"  ψ {strength.dilation_deg:.1f}°"
    if strength.tension_kpa:
        words += f"  σt {strength.tension_kpa:.4g} kPa"
    return words


def _wedge_planes(design: WedgeDesign, geometry: WedgeGeometry) -> list[str]:
    entries = []
    for k, plane in enumerate(design.joints):
        area = size_number(geometry.areas_m2[f"J{k + 1}"])
        name, own = f"J{k + 1}", design.joint_names[k]
        name += "" if own == name else f" ({own})"
        entries.append(f"{name} {plane}  {plane.in_words()}  {_strength(design.strengths[k])}  area {area} m²")
    entries.append(f"face {design.face}  {design.face.in_words()}")
    entries.append(f"upper {design.upper}  {design.upper.in_words()}")
    if design.crack:
        area = size_number(geometry.areas_m2["crack"])
        entries.append(
            f"crack {design.crack.plane}  {design.crack.plane.in_words()}, {design.crack.distance_m:.4g} m behind the "
            f"crest along J1  area {area} m²"
        )
    line = Line(geometry.line_trend_deg, geometry.line_plunge_deg)
    length = size_number(geometry.line_length_m)
    entries.append(f"line of intersection {line_in_words(line)}, {length} m long, daylights at the toe")
    return entries


def _plane_planes(design: PlaneDesign, geometry: SectionGeometry) -> list[str]:
    area = size_number(geometry.areas_m2[design.joint_name])
    entries = [
        f"{design.joint_name} {design.joint}  {design.joint.in_words()}  {_strength(design.strength)}  {area} m long",
        f"face {design.face}  {design.face.in_words()}",
        f"upper {design.upper}  {design.upper.in_words()}",
    ]
    if geometry.crack_depth_m is not None and geometry.crack_distance_m is not None:
        off = geometry.crack_distance_m
        where = f"{off:.4g} m behind the crest" if off >= 0.0 else f"{-off:.4g} m in front of the crest"
        entries.append(f"crack vertical, {geometry.crack_depth_m:.4g} m deep, {where}")
    return entries


def _surface(design: SurfaceDesign, geometry: SurfaceGeometry) -> list[str]:
    area = size_number(geometry.areas_m2["slip surface"])
    ground = (
        f"ground mesh {design.ground_mesh.name}"
        if design.ground_mesh is not None
        else "ground profile " + " ".join(f"({x:.6g}, {z:.6g})" for x, z in design.profile_m or ())
    )
    lets = {0: "no motion exactly", 1: "one motion"}.get(geometry.motions, f"{geometry.motions} motions")
    turned = f", turned by {geometry.misfit_deg:.2g}° to follow it" if geometry.misfit_deg else ""
    return [
        f"{design.slip.in_words()}  {_strength(design.strength)}  area {area} m²",
        f"normals {geometry.normals}, edges {geometry.edge_m:.3g} m; the surface lets {lets} through{turned}",
        ground,
    ]


def size_number(value: float) -> str:
    """Six significant digits without an exponent where a person would not write one."""
    if value == 0.0:
        return "0"
    if 1e5 <= abs(value) < 1e9:
        return f"{value:.0f}"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.6g}" if abs(value) < 1e3 else f"{value:.1f}"
    return f"{value:.6g}"
