"""The wedge design: everything `slopekit wedge` knows, in m, kN, kPa, kN/m³ and degrees."""

import hashlib
import json
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from slopekit.orientation import Line, Plane

Criterion = Literal["limit", "all-pairs"]

#: The paper's wedge (Sheng et al. 2023, Tables 4 and 5): what is left out of a design takes these values.
PAPER_WEDGE: dict[str, Any] = {
    "face": Plane(60.0, 180.0),
    "upper": Plane(10.0, 180.0),
    "height": 64.89,
    "c": (50.0, 50.0),
    "phi": (20.0, 20.0),
    "density": 2600.0,
}
#: The names of those values as the sheet prints them, and of what else may be taken.
DEFAULT_NAMES = {
    "face": "face", "upper": "upper", "height": "height", "c": "c", "phi": "φ", "density": "density",
    "seismic.trend": "seismic trend",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Water:
    """Water on the joints: dry, full (scaled by `fill`) or mean pressures in kPa (J1, J2, crack)."""

    mode: Literal["dry", "full", "pressures"] = "dry"
    fill: float = 0.0
    pressures_kpa: tuple[float, ...] = ()

    def in_words(self) -> str:
        """The water as the sheet prints it."""
        if self.mode == "dry":
            return "dry"
        if self.mode == "full":
            return "full" if self.fill == 1.0 else f"{self.fill * 100:g} % of full"
        return "u = " + ", ".join(f"{pressure:g}" for pressure in self.pressures_kpa) + " kPa"


@dataclass(frozen=True, slots=True)
class Crack:
    """A tension crack: its plane, and its distance from the crest along the trace of plane 1 (m)."""

    plane: Plane
    distance_m: float


@dataclass(frozen=True, slots=True)
class Seismic:
    """Pseudo-static coefficient, and the trend it acts toward (None: the trend of the line of intersection)."""

    coefficient: float = 0.0
    trend_deg: float | None = None


@dataclass(frozen=True, slots=True)
class Force:
    """A force on the wedge: east, north, up (kN), and the point it acts at (None: the centroid)."""

    components_kn: tuple[float, float, float]
    at_m: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Bolt:
    """A bolt: its force (kN) and direction on the wedge; its head and length (m) where they are known.

    An active bolt is a load. A passive bolt is strength: its capacity is divided by the strength
    reduction factor, and it pulls only if the wedge moves against it.
    """

    force_kn: float
    toward: Line
    acts: Literal["active", "passive"] = "active"
    head_m: tuple[float, float, float] | None = None
    length_m: float | None = None


@dataclass(frozen=True, slots=True)
class Stiffness:
    """Joint stiffness for displacements and the all-pairs criterion (the limit factor does not need it).

    `shear_kn_m3` is a constant, or None for Clough and Duncan's hyperbola (eq. 31) with the paper's parameters.
    """

    normal_kn_m3: float = 1.0e7
    shear_kn_m3: float | None = None


@dataclass(frozen=True, slots=True)
class WedgeDesign:
    """One wedge, complete and checked. Made by `slopekit.design.reading.wedge_design`."""

    joints: tuple[Plane, Plane]
    face: Plane
    upper: Plane
    height_m: float
    cohesion_kpa: tuple[float, float]
    friction_angle_deg: tuple[float, float]
    unit_weight_kn_m3: float
    density_kg_m3: float | None = None
    gravity_m_s2: float = 9.81
    water_unit_weight_kn_m3: float = 9.81
    dilation_deg: tuple[float, float] = (0.0, 0.0)
    tension_kpa: tuple[float, float] = (0.0, 0.0)
    water: Water = Water()
    crack: Crack | None = None
    seismic: Seismic = Seismic()
    forces: tuple[Force, ...] = ()
    bolts: tuple[Bolt, ...] = ()
    stiffness: Stiffness = Stiffness()
    criterion: Criterion = "limit"
    accept: float | None = None
    agree_within: float = 0.01
    refine: int = 0
    origin_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    defaults: tuple[str, ...] = field(default=(), compare=False)

    def inputs(self) -> dict[str, Any]:
        """Every input as plain JSON values, the defaults written out."""
        document: dict[str, Any] = asdict(self)
        del document["defaults"]
        for key in ("face", "upper"):
            document[key] = str(getattr(self, key))
        document["joints"] = {f"J{k}": str(plane) for k, plane in enumerate(self.joints, 1)}
        if self.crack:
            document["crack"] = {"plane": str(self.crack.plane), "distance_m": self.crack.distance_m}
        plain: dict[str, Any] = json.loads(json.dumps(document))
        return plain

    def input_hash(self) -> str:
        """SHA-256 of the inputs: equal designs give equal hashes."""
        exact = json.dumps(asdict(self) | {"defaults": None}, sort_keys=True)
        return hashlib.sha256(exact.encode()).hexdigest()
