"""Node pairs and the model made of them, and what they were made from."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from slopekit.arrays import Floats
from slopekit.geometry.interfaces import NodePairs
from slopekit.preie.model import Model


@dataclass(frozen=True, slots=True)
class Bedding:
    """The flat contacts of a block, for pairs of another kind on them.

    Attributes
    ----------
    polygons : interface -> (k, 3) corners in m, or (2, 3) ends of a line in a section; centroid : (3,) of the block
    model_of : the model on other node pairs
    """

    polygons: Mapping[int, Floats]
    centroid: Floats
    model_of: Callable[[NodePairs], Model]

    def scene(self, pairs: NodePairs) -> "Scene":
        """The scene of node pairs on these contacts."""
        return Scene(pairs, self.model_of(pairs), self)


@dataclass(frozen=True, slots=True)
class Scene:
    """Node pairs and the model made of them; `bedding` where the contacts are flat."""

    pairs: NodePairs
    model: Model
    bedding: Bedding | None = None
