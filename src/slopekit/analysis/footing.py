"""The footing on a weak plane (Sheng et al. 2023, §3.3): from its design to its result."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from slopekit.analysis.plane import section_bedding, section_geometry
from slopekit.analysis.scene import Scene
from slopekit.analysis.secants import changed_laws, on_secants
from slopekit.analysis.stages import (
    Clock,
    ClosedForm,
    block_status,
    driving_and_resisting,
    normal_forces,
    result,
    solve,
)
from slopekit.closed_form.footing import ClosedFormFooting, footing
from slopekit.design.kinds import FootingDesign
from slopekit.errors import Fault, GeometryError
from slopekit.geometry.section import J1, Section, footing_section, line_pairs
from slopekit.loads import Loads, PointForce, block_loads
from slopekit.notices import Interface
from slopekit.result import Forces, Result

NAME = "weak plane"


def analyse_footing(design: FootingDesign) -> Result:
    """Load the block above the weak plane, find its factor of safety twice, and compare.

    Raises
    ------
    GeometryError
        E219 the load stands beside the block.
    """
    clock = Clock()
    with clock("cut"):
        section, loads = _loaded(design)
    with clock("closed_form"):
        weight = float(-loads.parts["weight"][2])
        closed = _closed_form(design, weight)
    with clock("governs"):
        governs = _governs(design, weight)
    solved = solve(design, lambda refine: _scene(design, section, loads, refine), 0, clock)
    status = block_status(solved.limit, solved.analysis, solved.scene, (J1,))
    forces = Forces(
        float(-loads.parts["weight"][2]), normal_forces(solved, {J1: NAME}), {}, *driving_and_resisting(solved)
    )
    left_out = ["bedrock (no unknowns)", "deformation of the footing and the rock", "the length of the footing "
                "(per metre)"]  # fmt: skip
    left_out += [] if design.unit_weight_kn_m3 else ["the weight of the rock"]
    why_not = "the closed form knows no dilation: it is printed, not compared" if design.strength.dilation_deg else ""
    status_of = {"slides": "slides_on_J1"}
    return result(
        design, solved, status, ClosedForm(closed.factor, status_of.get(closed.status, closed.status), why_not),
        section_geometry(section, NAME), forces, [Interface(J1, NAME, design.strength)], left_out, clock,
        governs=governs, loads=loads,
    )  # fmt: skip


def prepare(design: FootingDesign, refine: int) -> Scene:
    """The stages before the solver, from a design to its node pairs and its model.

    Parameters
    ----------
    refine : how often the parts between the node pairs are halved
    """
    return scenes(design)(refine)


def scenes(design: FootingDesign) -> Callable[[int], Scene]:
    """The stages before the solver, as `prepare`: loaded once, for any number of parts."""
    section, loads = _loaded(design)
    return lambda refine: _scene(design, section, loads, refine)


def weight_of(design: FootingDesign) -> float:
    """The weight of the block above the weak plane, kN per metre."""
    return float(-_loaded(design)[1].parts["weight"][2])


def closed_form(design: FootingDesign, weight: float) -> ClosedFormFooting:
    """The design by limit equilibrium; weight in kN per metre."""
    return _closed_form(design, weight)


def _loaded(design: FootingDesign) -> tuple[Section, Loads]:
    section = footing_section(design.dip_deg, design.length_m)
    width = -float(section.bottom[0])
    at = width / 2.0 if design.load_at_m is None else design.load_at_m
    if not 0.0 <= at <= width:
        message = f"the load stands {at:.6g} m from the face, the block is {width:.6g} m wide"
        raise GeometryError([Fault("E219", message)])
    push = PointForce(np.array([0.0, 0.0, -design.load_kn]), np.array([-at, 0.0, section.bottom[2]]))
    return section, block_loads(section.block, design.unit_weight_kn_m3, {}, np.zeros(3), pushes={"footing": push})


def _scene(design: FootingDesign, section: Section, loads: Loads, refine: int) -> Scene:
    pairs = line_pairs(section, (design.pairs - 1) // 2 * 2**refine)
    return section_bedding(section, loads, design.strength).scene(pairs)


def _closed_form(design: FootingDesign, weight: float) -> ClosedFormFooting:
    return on_secants(
        [design.strength],
        lambda given: footing(
            design.load_kn, design.dip_deg, design.length_m, given[0].cohesion_kpa, given[0].friction_angle_deg, weight
        ),
        lambda found: [found.normal_kn / design.length_m],
    )[0]


def _governs(design: FootingDesign, weight: float) -> tuple[tuple[str, float | None, str], ...]:
    """What a few changes of the input do to the closed form."""
    strength = design.strength
    changes = [("load +10 %", replace(design, load_kn=design.load_kn * 1.1))]
    changes += [(name, replace(design, strength=other)) for name, other in changed_laws(strength)]
    if strength.law is None and strength.friction_angle_deg < 88.0:
        steeper = replace(strength, friction_angle_deg=strength.friction_angle_deg + 1.0)
        changes.append(("φ +1°", replace(design, strength=steeper)))
    if strength.law is None and strength.cohesion_kpa:
        firmer = replace(strength, cohesion_kpa=strength.cohesion_kpa * 1.1)
        changes.append(("c +10 %", replace(design, strength=firmer)))
    if design.dip_deg < 88.0:
        changes.append(("dip +1°", replace(design, dip_deg=design.dip_deg + 1.0)))
    return tuple((name, _closed_form(changed, weight).factor, "slides_on_J1") for name, changed in changes)
