"""A design as support sees it: what holds its block, its face, and both methods asked with more load on it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from slopekit.analysis.factors import factors_of
from slopekit.analysis.stages import Clock, find_limit
from slopekit.arrays import Floats
from slopekit.design.common import Bolt, Design, Force, Strength
from slopekit.design.kinds import PlaneDesign
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import DesignError, Fault
from slopekit.geometry.cutting import Block, cut_wedge
from slopekit.orientation import Line, line_of
from slopekit.preie.model import Model
from slopekit.preie.passes import Outcome
from slopekit.studies.support_forces import Held

_STATUSES = {"slides": "slides_on_J1"}
_OUTCOMES = {
    Outcome.NO_DRIVING_FORCE: "no_driving_force", Outcome.LIFTED: "lifted", Outcome.NOT_CONVERGED: "not_converged",
}  # fmt: skip
_SAME_WAY = 1e-12  # 1 - cosine of bolts that pull one way


@dataclass(frozen=True, slots=True)
class Answer:
    """What one method says: factor of safety (None: none), status; `level` is 0 where the block falls, inf where
    nothing drives it, nan without convergence."""

    factor: float | None
    status: str
    moments_govern: bool = False
    agree: bool | None = None

    @property
    def level(self) -> float:
        if self.factor is not None:
            return self.factor
        if self.status == "not_converged":
            return math.nan
        return math.inf if self.status == "no_driving_force" else 0.0


@dataclass(frozen=True, slots=True)
class Site:
    """A wedge or a plane failure that support is looked for.

    Attributes
    ----------
    design : as it stands
    block : in local axes, m; face : (k, 3) its free face, anticlockwise from outside; area : m² of that (a plane's: per
        metre); joints : faces of the block that rock lies behind
    inward : (3,) unit normal of the face into the rock, local axes
    axes : (3, 3) rows are the local axes, in east, north, up; origin : (3,) m of the local origin
    in_section : what acts along the slope is left out, forces are per metre of slope
    model : PRE-IE's, of the design as it stands; closed_form : asks that of a changed design
    outward : face of the block -> (3,) its unit normal
    """

    design: Design
    block: Block
    face: Floats
    area: float
    joints: tuple[int, ...]
    inward: Floats
    axes: Floats
    origin: Floats
    in_section: bool
    model: Model
    closed_form: Callable[[Design], Answer]
    outward: Mapping[int, Floats]

    @property
    def unit(self) -> str:
        """What forces are counted in."""
        return "kN/m" if self.in_section else "kN"

    def local(self, vectors: Floats) -> Floats:
        """Vectors (..., 3) in east, north, up as the block takes them: in a section without their part along it."""
        turned: Floats = vectors @ self.axes.T
        if self.in_section:
            turned[..., 1] = 0.0
        return turned

    def world(self, vectors: Floats) -> Floats:
        """Vectors (..., 3) in local axes as east, north, up."""
        turned: Floats = vectors @ self.axes
        return turned

    def held(self, factor: float) -> Held:
        """What holds the block at a factor."""
        model, most = self.model, self.model.translations
        scale = model.force_scale
        normals, first = np.unique(model.interface, return_index=True)
        bonds = np.array([model.cohesion[model.interface == joint].sum() for joint in normals]) * scale
        load = self._spread(model.load[:most]) * scale
        pulls = self._spread(model.bolt_rows[:, :most]) * (model.bolt_capacity * scale)[:, None]
        size = scale + float(model.bolt_capacity.sum()) * scale
        return Held(
            load, self._spread(model.rows[first, 0, :most]), bonds, model.tan_friction[first],
            _by_direction(pulls / factor), factor, size,
        )  # fmt: skip

    def _spread(self, rows: Floats) -> Floats:
        if not self.in_section:
            return np.array(rows[..., :3])
        out = np.zeros((*rows.shape[:-1], 3))
        out[..., [0, 2]] = rows[..., :2]
        return out

    def with_bolts(self, *bolts: Bolt) -> Design:
        """The design with more bolts."""
        return replace(self.design, bolts=(*self.design.bolts, *bolts))

    def with_force(self, force: Floats, at: Floats | None) -> Design:
        """The design with one more force (3,) kN, through a point (3,) in local axes."""
        east, north, up = (float(part) for part in self.world(force))
        place = None if at is None else self.place(at)
        return replace(self.design, forces=(*self.design.forces, Force((east, north, up), place)))

    def place(self, point: Floats) -> tuple[float, float, float]:
        """A point in local axes in the coordinates of the user."""
        east, north, up = (float(part) for part in self.world(point) + self.origin)
        return east, north, up

    def line(self, direction: Floats) -> Line:
        """A direction in local axes as trend and plunge, to the last digits that mean something."""
        line = line_of(direction @ self.axes)
        return Line(round(line.trend_deg, 12) % 360.0, round(line.plunge_deg, 12) + 0.0)


def pre_ie(design: Design) -> Answer:
    """PRE-IE's answer to a design."""
    found = factors_of(design)
    return Answer(found.limit, found.status, found.moments_govern, found.agree)


def pre_ie_coarse(design: Design) -> Answer:
    """PRE-IE's answer on the coarsest node pairs, which take a tenth of the time: to look where the target lies."""
    from slopekit.analysis import plane, wedge

    scenes = wedge.scenes(design) if isinstance(design, WedgeDesign) else plane.scenes(_as_plane(design))
    refine = design.refine if isinstance(design, WedgeDesign | PlaneDesign) else 0
    found = find_limit(design, scenes, refine, Clock(), most_refined=refine)
    limit = found.analysis.governing
    status = _OUTCOMES.get(limit.outcome, "slides")
    return Answer(limit.factor or None, status, found.analysis.moments_govern)


def site_of(design: Design) -> Site:
    """The site of a wedge or a plane.

    Raises
    ------
    DesignError
        E320 for other kinds, and for curved strength.
    GeometryError
        Where no block can be formed.
    """
    if any(strength.law for strength in strengths_of(design)):
        message = "support takes Mohr-Coulomb strength: the directions it compares have one c and φ a joint"
        advice = "solve changes the bolts of any design: slopekit solve my.yaml support.bolts.0.force --fos 1.5"
        raise DesignError([Fault("E320", message, "", advice)])
    if isinstance(design, WedgeDesign):
        return _wedge_site(design)
    if isinstance(design, PlaneDesign):
        return _plane_site(design)
    message = f"support is for a wedge or a plane, this design is a {design.kind}"
    advice = "sweep and solve change the bolts of any design: slopekit solve my.yaml support.bolts.0.force --fos 1.5"
    raise DesignError([Fault("E320", message, "", advice)])


def strengths_of(design: Design) -> list[Strength]:
    """The strengths of the joints of a wedge or a plane."""
    if isinstance(design, WedgeDesign):
        return list(design.strengths)
    return [design.strength] if isinstance(design, PlaneDesign) else []


def _wedge_site(design: WedgeDesign) -> Site:
    from slopekit.analysis import wedge
    from slopekit.geometry.rockmass import FACE, J1, J2, wedge_rock_mass

    model = wedge.prepare(design, 0).model
    crack = design.crack
    rock = wedge_rock_mass(
        np.array([plane.normal() for plane in design.joints]), design.face.normal(), design.upper.normal(),
        design.height_m, crack.plane.normal() if crack else None, crack.distance_m if crack else 0.0,
    )  # fmt: skip
    block = cut_wedge(rock)

    def closed_form(changed: Design) -> Answer:
        assert isinstance(changed, WedgeDesign)
        found = wedge.closed_form(changed)
        return Answer(found.factor or None, found.status)

    return Site(
        design, block, block.faces[FACE], block.areas[FACE], (J1, J2), -_outward(block.faces[FACE]), np.eye(3),
        np.array(design.origin_m), False, model, closed_form, _normals(block),
    )  # fmt: skip


def _plane_site(design: PlaneDesign) -> Site:
    from slopekit.analysis import plane
    from slopekit.geometry.section import FACE, J1

    section = plane.section_of(design)
    model = plane.prepare(design, 0).model
    block = section.block
    out = Line(design.face.dip_direction_deg, 0.0).vector()
    up = np.array([0.0, 0.0, 1.0])

    def closed_form(changed: Design) -> Answer:
        assert isinstance(changed, PlaneDesign)
        found = plane.closed_form(changed, section)
        return Answer(found.factor or None, _STATUSES.get(found.status, found.status))

    return Site(
        design, block, block.faces[FACE], block.areas[FACE], (J1,), -_outward(block.faces[FACE]),
        np.array([out, np.cross(up, out), up]), np.zeros(3), True, model, closed_form, _normals(block),
    )  # fmt: skip


def _as_plane(design: Design) -> PlaneDesign:
    assert isinstance(design, PlaneDesign)
    return design


def _normals(block: Block) -> dict[int, Floats]:
    return {plane: _outward(polygon) for plane, polygon in block.faces.items()}


def _outward(polygon: Floats) -> Floats:
    normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    unit: Floats = normal / math.sqrt(float(normal @ normal))
    return unit


def _by_direction(pulls: Floats) -> Floats:
    """Pulls (b, 3) with those of one direction added up."""
    groups: list[Floats] = []
    for pull in pulls:
        size = math.sqrt(float(pull @ pull))
        for k, group in enumerate(groups):
            if float(group @ pull) >= (1.0 - _SAME_WAY) * size * math.sqrt(float(group @ group)):
                groups[k] = group + pull
                break
        else:
            groups.append(pull)
    return np.reshape(groups, (-1, 3))
