"""The limit of many blocks by plain passes, to see what each of them buys (the limit itself is found by `blocks`)."""

from collections.abc import Iterator

import numpy as np

from slopekit.preie.assembly import AssemblyModel
from slopekit.preie.program import BlockProgram, Strengths

_STEPS = 80
_SHED = 1e-3


def passes_of_blocks(model: AssemblyModel, tolerance: float = 1e-7) -> Iterator[float]:
    """The factor after every frozen-friction pass from a cold start: every bond whole, no Newton, no damping.

    Ends where a pass does not settle, sheds load, or finds nothing that drives the blocks.

    Parameters
    ----------
    tolerance : complementarity of each pass in parts of its load factor
    """
    program = BlockProgram(model)
    normal, factor = program.start.normal, program.start.load_factor
    while True:
        summed = model.by_group(normal)
        frozen = Strengths(
            np.minimum(model.tan_dilation, factor * model.tan_friction), program.cohesion + model.tan_friction * summed,
            summed,
        )  # fmt: skip
        program.elastic = program.stiffest * min(1.0, factor)
        found = program.solve(frozen, program.start, tolerance, _STEPS)
        if not found.settled or found.at.shed > _SHED or not found.at.load_factor > 0.0:
            return
        normal, factor = found.at.normal, found.at.load_factor
        yield 1.0 / factor
