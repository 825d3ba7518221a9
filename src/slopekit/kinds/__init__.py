"""From a design to a result: the only room that knows the order of the stages."""

from slopekit.design.common import Design
from slopekit.design.wedge import WedgeDesign
from slopekit.result import Result


def analyse(design: Design) -> Result:
    """Analyse a design of any kind; each kind's modules load only when it is asked for.

    Raises
    ------
    GeometryError
        Where no block can be formed.
    """
    from slopekit.design.blocky import AssemblyDesign
    from slopekit.design.kinds import FootingDesign, PlaneDesign, SurfaceDesign

    if isinstance(design, WedgeDesign):
        from slopekit.kinds.wedge import analyse_wedge

        return analyse_wedge(design)
    if isinstance(design, PlaneDesign):
        from slopekit.kinds.plane import analyse_plane

        return analyse_plane(design)
    if isinstance(design, FootingDesign):
        from slopekit.kinds.footing import analyse_footing

        return analyse_footing(design)
    if isinstance(design, SurfaceDesign):
        from slopekit.kinds.surface import analyse_surface

        return analyse_surface(design)
    if isinstance(design, AssemblyDesign):
        from slopekit.kinds.many_blocks import analyse_assembly

        return analyse_assembly(design)
    raise TypeError(f"no analysis for {type(design).__name__}")
