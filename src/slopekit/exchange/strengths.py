"""What a result says of its joints: strength and mean water pressure, whatever the kind of its design."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from slopekit.arrays import Floats
from slopekit.exchange.panels import areas_of
from slopekit.exchange.source import Source

Pair = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint of a scene: the name of its strength, c (kPa), φ, dilation (degrees), tension, water pressure (kPa)."""

    strength: str
    cohesion: float
    friction: float
    dilation: float
    tension: float
    pressure: float = 0.0


def joints_of(source: Source) -> dict[str, Joint]:
    """The joints of a result by name; those without a strength (a tension crack) are left out."""
    inputs, kind = source.document["inputs"], source.document["kind"]
    named = {name: _values(given) for name, given in inputs.get("strengths", ())}
    if kind == "bench":
        return {
            one["name"]: Joint(one["strength"], *named[one["strength"]], one["pressure_kpa"]) for one in inputs["sets"]
        }
    if kind == "topple":
        base, side = inputs["pressures_kpa"]
        return {
            joint: Joint(inputs[key], *named[inputs[key]], water)
            for joint, key, water in (("base", "base", base), ("sides", "sides", side), ("riser", "base", 0.0))
        }
    if kind == "blocks":
        return {name: Joint(name, *values) for name, values in named.items()}
    if kind == "wedge":
        columns = [inputs[f"{key}"] for key in ("cohesion_kpa", "friction_angle_deg", "dilation_deg", "tension_kpa")]
        return {
            name: Joint(name, *values)
            for name, values in zip(inputs["joint_names"], zip(*columns, strict=True), strict=False)
        }
    first = source.scene.shapes.joints[0]
    return {first: Joint("joint", *_values(inputs["strength"]))}


def _values(given: Mapping[str, Any]) -> tuple[float, float, float, float]:
    return given["cohesion_kpa"], given["friction_angle_deg"], given["dilation_deg"], given["tension_kpa"]


@dataclass(frozen=True, slots=True)
class Pairs:
    """The interfaces of a scene: joint by pair of blocks (the one of most area), and pairs that had several."""

    joint: Mapping[Pair, str]
    mixed: tuple[str, ...]


def pairs_of(source: Source, rock: Mapping[int, str], joints: Mapping[str, Joint]) -> Pairs:
    """The interfaces between named blocks.

    Parameters
    ----------
    rock : names of the bedrock behind contacts (by their index) that no block of the scene stands for
    """
    shapes = source.scene.shapes
    contacts, area = shapes.contacts, areas_of(shapes.contacts)
    shares: dict[Pair, dict[str, float]] = {}
    for k in range(len(contacts)):
        name = shapes.joints[contacts.joint[k]]
        ends = [shapes.names[one] if one >= 0 else rock.get(k, "") for one in (contacts.plus[k], contacts.minus[k])]
        if all(ends) and name in joints:
            pair = (min(ends), max(ends))
            share = shares.setdefault(pair, {})
            share[name] = share.get(name, 0.0) + float(area[k])
    mixed = tuple(
        "/".join(pair) for pair, share in shares.items()
        if len({(joints[name].strength, joints[name].pressure) for name in share}) > 1
    )  # fmt: skip
    return Pairs({pair: max(share, key=share.__getitem__) for pair, share in shares.items()}, mixed)


def direction_deg(force: Floats | Sequence[float]) -> float:
    """The trend (degrees from north) of a horizontal vector."""
    return float(np.degrees(np.arctan2(force[0], force[1])) % 360.0)
