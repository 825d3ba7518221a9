"""The PRE-IE model of one rigid block as arrays, moved to a local origin and scaled.

Mixed system of the paper (eq. 23) in node-pair forces f and block displacements γ:

    C f + B γ = 0,   Bᵀ f + P = 0,   C = diag(1 / (A k))

As printed, eqs. 24-27 do not have matching dimensions (K_ff carries G_γᵀ Wᵀ in front); the system here comes from
the functional (19): C is diagonal with lumped control areas, so that f = -C⁻¹ B γ and only γ is solved for.
Forces are those on the plus side, compression positive; B γ is positive where a pair opens.

Lengths are divided by the root mean square distance of the node pairs from the centroid, forces by the total load,
control areas by their sum: a wedge of 1 mm and one of 100 km are the same model.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slopekit.core.arrays import Floats, Ints, cross, frozen
from slopekit.core.errors import Fault, SolverError
from slopekit.geometry.interfaces import NodePairs
from slopekit.loads import Loads
from slopekit.preie.tolerances import PARALLEL

if TYPE_CHECKING:
    from slopekit.preie.system.strength_lines import StrengthLines
    from slopekit.strength.protocol import StrengthLaw

_SECTION_UNKNOWNS = [
    0,
    2,
    4,
]  # translations x and z and rotation about y, of the six unknowns of a block


@dataclass(frozen=True)
class JointStrength:
    """Strength of each interface as a straight line: (k,) arrays; kPa and tangents.

    Dilation and tension are those of the joint at full strength. `laws` are the curved laws by interface, None for a
    straight one; empty where no law is curved. The cohesion of a curved law is τ(0).
    """

    cohesion: Floats
    tan_friction: Floats
    tan_dilation: Floats
    tension: Floats
    laws: "tuple[StrengthLaw | None, ...]" = ()


@dataclass(frozen=True)
class Model:
    """A PRE-IE model in scaled units.

    Attributes
    ----------
    rows : (n, 3, u) relative displacement of pair i per unknown; local axes normal, first and second tangent
    control_area : (n,) as a fraction of all; sums to 1
    cohesion, tension : (n,) strength forces c A and σ_t A, in units of the load
    tan_friction, tan_dilation : (n,)
    interface : (n,) the interface of each pair
    load : (u,) P; generalised forces of the loads that do not depend on the strength
    bolt_rows : (b, u) shortening of each passive bolt per unknown; bolt_capacity : (b,) at full strength
    length_scale : m; force_scale : kN; area_scale : m²
    translations : how many of the unknowns are translations (they come first): 3, or 2 in a vertical section
    lines : tractions at which tan_friction is the line of a curved law; None without curved laws
    """

    rows: Floats
    control_area: Floats
    cohesion: Floats
    tension: Floats
    tan_friction: Floats
    tan_dilation: Floats
    interface: Ints
    load: Floats
    bolt_rows: Floats
    bolt_capacity: Floats
    length_scale: float
    force_scale: float
    area_scale: float
    translations: int = 3
    lines: "StrengthLines | None" = None

    @property
    def section_slip_rows(self) -> Floats:
        """Slip (n, 1, 3) of the pairs per unknown in a section; the other of their two tangents is normal to it."""
        slips: Floats = self.rows[:, 1:].sum(axis=1, keepdims=True)
        return slips

    @property
    def unknowns(self) -> int:
        """Number of unknowns u: six, three in a vertical section, fewer for a block that cannot rotate."""
        return int(self.rows.shape[2])

    @property
    def flat_rows(self) -> Floats:
        """The rows as a (3n, u) matrix B."""
        return self.rows.reshape(-1, self.unknowns)

    @property
    def normal_rows(self) -> Floats:
        """Normal opening of each pair per unknown, (n, u)."""
        return self.rows[:, 0, :]

    @property
    def dilates(self) -> bool:
        """Whether any joint dilates."""
        return bool(self.tan_dilation.any())

    def relative(self, displacement: Floats) -> Floats:
        """Return the relative displacements of the pairs, (n, 3): normal (opening positive) and two tangents."""
        return (self.flat_rows @ displacement).reshape(-1, 3)

    def slip(self, displacement: Floats) -> Floats:
        """Return the magnitude of the tangential relative displacement of each pair, (n,)."""
        tangential = self.relative(displacement)[:, 1:]
        size: Floats = np.sqrt((tangential * tangential).sum(axis=1))
        return size

    def rigid_motion(self, displacement: Floats) -> tuple[Floats, Floats]:
        """Return a displacement (u,) as translation (3,) and rotation (3,), with zeros for missing unknowns."""
        translation, rotation = np.zeros(3), np.zeros(3)
        if self.translations == 2:
            translation[[0, 2]] = displacement[:2]
            rotation[1] = displacement[2] if len(displacement) > 2 else 0.0
        else:
            translation[:] = displacement[:3]
            rotation[: len(displacement) - 3] = displacement[3:]
        return translation, rotation


def build_model(
    pairs: NodePairs,
    loads: Loads,
    centroid: Floats,
    strength: JointStrength,
    in_section: bool = False,
) -> Model:
    """Return the scaled model of one block on bedrock.

    Parameters
    ----------
    pairs : node pairs of block 0 against the bedrock
    loads : force and moment about `centroid`
    strength : indexed by `pairs.interface`
    in_section : the block moves in its vertical x-z section only: three unknowns (x, z, rotation about y)

    Raises
    ------
    SolverError
        E599 there is nothing to solve, or normals are no unit vectors.
    """
    # the sum of all loads' sizes, not the size of their sum: bolts may hold the block in balance
    force_scale = sum(math.sqrt(float(force @ force)) for force in loads.components.values())
    if len(pairs) == 0 or not force_scale > 0.0:
        raise SolverError([Fault("E599", "the model has no node pairs or no load")])
    arms = pairs.points - centroid
    length = math.sqrt(float((arms * arms).sum()) / len(pairs))
    arms = arms / length
    axes = local_axes(pairs.normals)
    rows = np.concatenate([axes, cross(arms[:, None, :], axes)], axis=2)
    if float(np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max()) > PARALLEL:
        raise SolverError(
            [Fault("E599", "a rigid translation does not move the node pairs by its own length")]
        )
    bolt_arms = (loads.passive_points - centroid) / length
    bolt_axes = np.concatenate(
        [loads.passive_forces, cross(bolt_arms, loads.passive_forces)], axis=1
    )
    capacity = np.sqrt((loads.passive_forces**2).sum(axis=1))
    load = np.concatenate([loads.force, loads.moment / length]) / force_scale
    if in_section:
        rows, bolt_axes, load = (
            rows[:, :, _SECTION_UNKNOWNS],
            bolt_axes[:, _SECTION_UNKNOWNS],
            load[_SECTION_UNKNOWNS],
        )
    area = float(pairs.control_areas.sum())
    per_force = pairs.control_areas / force_scale
    interface = pairs.interface
    model = Model(
        rows=frozen(rows),
        control_area=frozen(pairs.control_areas / area),
        cohesion=frozen(strength.cohesion[interface] * per_force),
        tension=frozen(strength.tension[interface] * per_force),
        tan_friction=frozen(strength.tan_friction[interface]),
        tan_dilation=frozen(strength.tan_dilation[interface]),
        interface=interface,
        load=frozen(load),
        bolt_rows=frozen(bolt_axes / capacity[:, None]),
        bolt_capacity=frozen(capacity / force_scale),
        length_scale=length,
        force_scale=force_scale,
        area_scale=area,
        translations=2 if in_section else 3,
    )
    if not strength.laws:
        return model
    from slopekit.preie.system.strength_lines import (
        with_initial_lines,  # only curved laws pay for it
    )

    return with_initial_lines(strength.laws, interface, model, force_scale / area)


def local_axes(normals: Floats) -> Floats:
    """Return the local axes ξ (normal), η, ζ (tangents) of unit normals (n, 3): (n, 3, 3), one axis a row.

    >>> local_axes(np.array([[0.0, 0.0, 1.0]])).round(12).tolist()
    [[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]]
    """
    reference = np.zeros_like(normals)
    steep = np.abs(normals[:, 0]) > 0.9
    reference[steep, 1], reference[~steep, 0] = 1.0, 1.0
    first = cross(normals, reference)
    first /= np.sqrt((first * first).sum(axis=1))[:, None]
    return np.stack([normals, first, cross(normals, first)], axis=1)
