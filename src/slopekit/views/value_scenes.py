"""Scenes of blocks coloured by a value: the factor of safety at which they fail, the order in which they do."""

from collections.abc import Sequence

import numpy as np

from slopekit.arrays import Bools, Floats
from slopekit.errors import DesignError, Fault
from slopekit.views.layers import blocks_layer
from slopekit.views.picture import FALLS, ROCK, STANDS, UNSETTLED, Bar, Picture
from slopekit.views.scene_parts import Legend, ends, names, picture, unsettled, without_strength
from slopekit.views.stage import Stage


def factors(stage: Stage) -> Picture:
    """Blocks by the factor of safety at which they fail."""
    factor = stage.scene.factor
    known = np.isfinite(factor)
    bar = Bar("factor of safety at which a block fails", *ends(factor[known])) if known.any() else None
    one = bar is not None and not np.ptp(factor[known]) > 1e-9 * float(factor[known].max())
    fixed = int(stage.scene.shapes.fixed.sum())
    falls, open_ = without_strength(stage), unsettled(stage)
    none = int((stage.free & ~known & ~falls & ~open_).sum())
    text = "no factor: it stands, or was not looked at" if not stage.alone else "no factor of safety"
    asked = [(f"{text} ({none})", STANDS, 1.0)] if none else []
    asked += _special(falls, open_)
    asked += [(f"bedrock ({fixed})", ROCK, 1.0)] if fixed else []
    notes = ("a block that only the one before it held fails together with it",) if not stage.alone else ()
    if one and bar is not None:  # one value needs no scale
        colour = tuple(bar.colours(factor[known][:1])[0].tolist())
        asked = [(f"fails at {float(factor[known][0]):.4f} ({int(known.sum())})", colour, 1.0), *asked]
    return _by_value(stage, "factors", factor, bar, asked, notes, scale=not one)


def ravelling(stage: Stage) -> Picture:
    """Blocks by the order in which they fail.

    Raises
    ------
    DesignError
        E352 where nothing moves.
    """
    order = stage.scene.order
    if not order.any():
        raise DesignError([Fault("E352", f"nothing moves: {stage.document.get('status_text')}", "ravelling")])
    open_ = unsettled(stage)
    values = np.where((order > 0) & ~open_, order.astype(np.float64), np.nan)
    bar = Bar("order in which blocks fail", 1.0, float(order.max()), whole=True)
    left = int((stage.free & (order == 0)).sum())
    legend = [(f"left in place ({left})", STANDS, 1.0)] if left else []
    legend += _special(np.zeros_like(open_), open_)
    legend += [("bedrock", ROCK, 1.0)] if stage.scene.shapes.fixed.any() else []
    standing = (stage.document.get("assembly") or {}).get("standing")
    return _by_value(stage, "ravelling", values, bar, legend, (str(standing),) if standing else ())


def _special(falls: Bools, open_: Bools) -> Legend:
    """Blocks without a number that do not stand either."""
    legend: Legend = [(f"held by no strength that was tried ({int(falls.sum())})", FALLS, 1.0)] if falls.any() else []
    last = f"moves in a mechanism that did not settle ({int(open_.sum())})"
    return [*legend, (last, UNSETTLED, 1.0)] if open_.any() else legend


def _by_value(
    stage: Stage, what: str, values: Floats, bar: Bar | None, legend: Legend,
    notes: Sequence[str], scale: bool = True,
) -> Picture:  # fmt: skip
    colours = np.tile(np.array(STANDS), (len(values), 1))
    known = np.isfinite(values)
    if bar is not None:
        colours[known] = bar.colours(values[known])
    colours[without_strength(stage) & ~known] = FALLS
    colours[unsettled(stage) & ~known] = UNSETTLED
    layers = [*stage.rock(), blocks_layer("blocks", stage.scene.shapes, stage.free, colours, stage.still)]
    return picture(stage, what, layers, legend, notes=notes, bar=bar if scale else None, labels=names(stage))
