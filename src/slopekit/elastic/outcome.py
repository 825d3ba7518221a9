"""Records of a result with elastic blocks, compared with rigid ones, and their JSON."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from slopekit.core.arrays import Floats
from slopekit.core.codec import record_of


@dataclass(frozen=True)
class OnElasticJoint:
    """Normal tractions on one joint of elastic and of rigid blocks: (lowest, highest) kPa, compression positive."""

    elastic_kpa: tuple[float, float]
    rigid_kpa: tuple[float, float]
    opened_share: float


@dataclass(frozen=True)
class ElasticMesh:
    """The finite element mesh and the accuracy of a solution with elastic blocks.

    Attributes
    ----------
    failed_pairs : node pairs that slip or are open
    unknowns : of the finite elements, with three for each node pair and those of the blocks
    cells : number of finite elements, of an `order` and with edges up to `edge_m`
    taken : names of the rock's properties that are defaults
    residual : of forces, as a fraction of the load
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
    """The outcome of elastic blocks, compared with rigid ones.

    Attributes
    ----------
    limit : the rigid limit without the cohesion of the node pairs that elastic blocks pull open
    rigid_limit : the same without the cohesion that rigid blocks lose in the same state (a sliding block: none)
    factor : strength reduction factor of the state below: 1, or less than the limit where that is below 1
    opened_share, rigid_opened_share : open fraction of the area of all contacts
    lost_share, rigid_lost_share : fraction of that area whose cohesion is lost
    joints : tractions by the joint's name
    displacement_m, rigid_displacement_m : (3,) mean of the block; of many blocks that of `block`, which moves most
    modulus_kpa, poisson : of the rock
    steps : of Newton's method, in all
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
        """Return the record as JSON values, with the fields of its mesh among them."""
        record = record_of(self)
        mesh: dict[str, Any] = record.pop("mesh")
        return record | mesh
