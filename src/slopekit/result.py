"""The result of a wedge analysis: value, status and evidence, and its JSON (a contract: keys never change)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from slopekit._version import __version__
from slopekit.arrays import Floats, Ints
from slopekit.design.wedge import WedgeDesign
from slopekit.errors import Notice

#: Every status a wedge can have, as a sentence.
STATUSES: Mapping[str, str] = {
    "slides_on_both": "slides on both planes",
    "slides_on_J1": "slides on J1, J2 has lost contact",
    "slides_on_J2": "slides on J2, J1 has lost contact",
    "slides_up": "slides up the slope: the loads drive it upward",
    "rotates": "turns while it slides",
    "topples": "topples: where its joints open, nothing is left to hold it",
    "lifted": "is pushed off both planes",
    "falls": "falls: nothing lies under it",
    "no_driving_force": "stands: nothing drives it",
    "not_converged": "the analysis did not converge: no number",
}


@dataclass(frozen=True, slots=True)
class FactorsOfSafety:
    """The factors of safety; None where one does not apply.

    limit : PRE-IE, zero (or the given) dilation: the answer; closed_form : Hoek & Bray; static_bound : an upper
    bound, unsafe as an answer; all_pairs_failed : the paper's criterion, when asked for.
    """

    limit: float | None = None
    closed_form: float | None = None
    static_bound: float | None = None
    all_pairs_failed: float | None = None


@dataclass(frozen=True, slots=True)
class WedgeGeometry:
    """Size and shape of the wedge: areas in m² by joint, the line of intersection as trend and plunge.

    `faces_m` are all faces as (k, 3) polygons by name, anticlockwise seen from outside.
    """

    volume_m3: float
    total_height_m: float
    areas_m2: Mapping[str, float]
    line_trend_deg: float
    line_plunge_deg: float
    line_length_m: float
    corners_m: Mapping[str, Floats]
    centroid_m: Floats
    faces_m: Mapping[str, Floats] = field(repr=False)


@dataclass(frozen=True, slots=True)
class WedgeForces:
    """Forces in kN: effective normal forces by joint, along the sliding direction what drives and what resists."""

    weight: float
    normal: Mapping[str, float | None]
    water: Mapping[str, float]
    driving: float | None
    resisting: float | None


@dataclass(frozen=True, slots=True)
class ModelSize:
    """What was modelled and what was left out."""

    moving_blocks: int
    unknowns: int
    node_pairs: int
    refined: int
    mesh_change: float | None
    left_out: tuple[str, ...]
    passes: int
    residual: float


@dataclass(frozen=True, slots=True)
class Movement:
    """A movement of the wedge: displacement of its centroid and rotation about it, (3,) each."""

    displacement: Floats
    rotation: Floats


@dataclass(frozen=True, slots=True)
class AtFactorOne:
    """The wedge at rest at full strength: movement in m and radians, node pairs by contact mode."""

    movement: Movement
    failed_pairs: int
    residual: float


@dataclass(frozen=True, slots=True)
class AllPairs:
    """The paper's search: its bracket, whether equilibrium was lost at the upper end, every trial."""

    bracket: tuple[float, float]
    lost_equilibrium: bool
    history: tuple[tuple[float, int], ...]


@dataclass(frozen=True, slots=True)
class NodePairState:
    """The node pairs at the limit, for pictures: points (n, 3) m, joints (n,), normal forces (n,) kN."""

    points_m: Floats
    joint: Ints
    control_area_m2: Floats
    normal_kn: Floats


@dataclass(frozen=True, slots=True)
class WedgeResult:
    """One analysed wedge. `to_dict()` is the JSON of `slopekit wedge --json`."""

    design: WedgeDesign
    status: str
    fos: FactorsOfSafety
    difference: float | None
    agree: bool | None
    moments_govern: bool
    forces_only: float | None
    static_bound_proved: bool
    geometry: WedgeGeometry
    forces: WedgeForces
    model: ModelSize
    mechanism: Movement | None
    at_factor_one: AtFactorOne | None
    all_pairs: AllPairs | None
    governs: tuple[tuple[str, float | None, str], ...]
    warnings: tuple[Notice, ...]
    node_pairs: NodePairState = field(repr=False)
    timing_s: Mapping[str, float] = field(default_factory=dict, compare=False)

    @property
    def criterion_fos(self) -> float | None:
        """The factor that `--accept` is held against: the limit, or the lower of it and the all-pairs factor."""
        if self.design.criterion == "limit" or self.fos.limit is None:
            return self.fos.limit
        return None if self.fos.all_pairs_failed is None else min(self.fos.limit, self.fos.all_pairs_failed)

    @property
    def accepted(self) -> bool | None:
        """Whether the acceptance criterion is met; None where there is none."""
        if self.design.accept is None:
            return None
        if self.status == "no_driving_force":
            return True
        if self.status == "not_converged" or self.agree is False:
            return False  # a number that the two methods dispute is no reason to accept
        return self.criterion_fos is not None and self.criterion_fos >= self.design.accept

    @property
    def exit_code(self) -> int:
        """0 done, 1 criterion not met, 4 the methods disagree or no convergence."""
        if self.status == "not_converged" or self.agree is False:
            return 4
        return 1 if self.accepted is False else 0

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON values."""
        geometry, forces, model = self.geometry, self.forces, self.model
        one, pairs = self.at_factor_one, self.all_pairs
        return {
            "slopekit": __version__,
            "kind": "wedge",
            "input_sha256": self.design.input_hash(),
            "status": self.status,
            "status_text": STATUSES[self.status],
            "fos": {
                "limit": self.fos.limit,
                "closed_form": self.fos.closed_form,
                "static_bound": self.fos.static_bound,
                "all_pairs_failed": self.fos.all_pairs_failed,
            },
            "difference": self.difference,
            "agree": self.agree,
            "moments_govern": self.moments_govern,
            "forces_only": self.forces_only,
            "static_bound_proved": self.static_bound_proved,
            "accepted": self.accepted,
            "geometry": {
                "volume_m3": geometry.volume_m3,
                "total_height_m": geometry.total_height_m,
                "areas_m2": dict(geometry.areas_m2),
                "line": {"trend_deg": geometry.line_trend_deg, "plunge_deg": geometry.line_plunge_deg},
                "line_length_m": geometry.line_length_m,
                "corners_m": {name: point.tolist() for name, point in geometry.corners_m.items()},
                "centroid_m": geometry.centroid_m.tolist(),
            },
            "forces_kn": {
                "weight": forces.weight,
                "normal": dict(forces.normal),
                "water": dict(forces.water),
                "driving": forces.driving,
                "resisting": forces.resisting,
            },
            "model": {
                "moving_blocks": model.moving_blocks,
                "unknowns": model.unknowns,
                "node_pairs": model.node_pairs,
                "refined": model.refined,
                "mesh_change": model.mesh_change,
                "passes": model.passes,
                "residual": model.residual,
                "left_out": list(model.left_out),
            },
            "mechanism": None if self.mechanism is None else {
                "blocks": ["wedge"],
                "displacement": self.mechanism.displacement.tolist(),
                "rotation": self.mechanism.rotation.tolist(),
            },
            "at_factor_one": None if one is None else {
                "displacement_m": one.movement.displacement.tolist(),
                "rotation_rad": one.movement.rotation.tolist(),
                "failed_pairs": one.failed_pairs,
                "residual": one.residual,
            },
            "all_pairs": None if pairs is None else {
                "bracket": list(pairs.bracket),
                "lost_equilibrium": pairs.lost_equilibrium,
                "history": [
                    {"factor": factor, "failed_pairs": count} for factor, count in sorted(pairs.history)
                ],
            },
            "governs": [{"change": name, "fos": fos, "status": status} for name, fos, status in self.governs],
            "inputs": self.design.inputs(),
            "defaults": list(self.design.defaults),
            "warnings": [{"code": notice.code, "message": notice.message} for notice in self.warnings],
            "timing_s": dict(self.timing_s),
        }  # fmt: skip
