"""What elastic blocks come to, beside the rigid ones: the records of a result and its JSON."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from slopekit.core.arrays import Floats
from slopekit.core.codec import record_of


@dataclass(frozen=True)
class OnElasticJoint:
    """A joint of elastic blocks beside the same of rigid ones: kPa from the lowest to the highest, compression +."""

    elastic_kpa: tuple[float, float]
    rigid_kpa: tuple[float, float]
    opened_share: float


@dataclass(frozen=True)
class ElasticMesh:
    """What elastic blocks were solved on.

    Attributes
    ----------
    failed_pairs : node pairs that slip or are open; unknowns : of the finite elements, with three a pair and those of
        the blocks; cells : the finite elements, of an `order` and edges up to `edge_m`
    taken : which of the numbers of the rock were not given; residual : of balance and displacements, in parts
    """

    failed_pairs: int
    node_pairs: int
    unknowns: int
    cells: int
    edge_m: float
    order: int
    taken: tuple[str, ...]
    residual: float


@dataclass(frozen=True)
class ElasticBlocks:
    """Elastic blocks beside the rigid ones.

    Attributes
    ----------
    limit : the rigid limit without the cohesion of the pairs that elastic blocks pull open, `rigid_limit` that without
        what rigid ones pull open in the same state (a sliding block: nothing), on the same node pairs
    factor : the strength reduction factor of the state below: 1, or less than the limit where that is below 1
    opened_share, rigid_opened_share : of the area of all contacts; lost_share, rigid_lost_share : of it what had
        cohesion to lose there; joints : by name
    displacement_m, rigid_displacement_m : (3,) mean of the block, of many blocks of the one that moves most: `block`
    modulus_kpa, poisson : of the rock; steps : of Newton's method, in all
    """

    limit: float | None
    rigid_limit: float | None
    factor: float
    opened_share: float
    rigid_opened_share: float
    lost_share: float
    rigid_lost_share: float
    joints: Mapping[str, OnElasticJoint]
    displacement_m: Floats
    rigid_displacement_m: Floats
    block: str | None
    modulus_kpa: float
    poisson: float
    steps: int
    mesh: ElasticMesh

    def to_dict(self) -> dict[str, Any]:
        """The record as JSON values, its mesh with the rest."""
        record = record_of(self)
        mesh: dict[str, Any] = record.pop("mesh")
        return record | mesh
