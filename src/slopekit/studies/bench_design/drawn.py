"""Joints drawn from joint sets with distributions, as `slopekit sets` writes them: a survey that was never made.

A set is met as often as its planes follow each other, 1 / spacing; sets without spacings alike. `joints:` and `sets:`
of one file are the same sets: the plane with its scatter is that of `joints`, what else is known stands in `sets`.
"""

import math
import os
from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault, Faults
from slopekit.core.orientation import Plane, number, parse_plane
from slopekit.core.units import quantity
from slopekit.design.joint_lists import JointList
from slopekit.design.reading.document import load_document
from slopekit.design.reading.nodes import Node, document_from
from slopekit.design.reading.structure import has_angles, is_distribution
from slopekit.design.scatter.distributions import (
    Angles,
    Distribution,
    Fisher,
    Variable,
    read_angles,
    read_distribution,
    read_orientation,
)
from slopekit.design.survey import MeasuredJoint
from slopekit.studies.marginals import MOST_BEYOND, tails
from slopekit.studies.prob.sampling import samples

DRAWN: Final = 1000  # joints, of all sets together
_FEWEST: Final = 2  # of each set
_OWN_SEED: Final = 0x5E75
_SUFFIXES: Final = (".yaml", ".yml")
#: Of a set, by key: what it measures, the least and the most that it may be.
_NUMBERS: Final[Mapping[str, tuple[str, float, float]]] = {
    "spacing": ("length", 1e-3, 1e5), "trace": ("length", 1e-3, 1e6), "c": ("pressure", 0.0, 1e9),
    "phi": ("angle", 0.0, 89.99),
}  # fmt: skip
STRENGTHS: Final = {key: _NUMBERS[key] for key in ("c", "phi")}
_PARTS: Final[Mapping[str, tuple[str, float, float]]] = {
    "scatter": ("angle", 0.0, 45.0), "spacing_scatter": ("ratio", 0.0, 1.0)
}  # fmt: skip
_OF_A_BENCH: Final = ("strength", "offset", "pressure")  # of a joint set of kind bench, and of no use here
_KEYS: Final = ("plane", *_NUMBERS, *_PARTS, *_OF_A_BENCH)
_Values: TypeAlias = dict[str, "Distribution | float"]


def is_sets(source: object) -> bool:
    """Whether joints are given as a file of sets, or as the same in Python."""
    if isinstance(source, Mapping):
        return any(isinstance(source.get(key), Mapping) for key in ("sets", "joints"))
    return isinstance(source, str | os.PathLike) and Path(source).suffix.lower() in _SUFFIXES


def joints_of_sets(source: Any, seed: int, count: int = DRAWN) -> JointList:
    """Joints drawn from sets, each set at least twice.

    Raises
    ------
    DesignError
        E190 no sets, E142 an unknown key, E143 a set without a plane, E281 values that cannot be, and what the reading
        of planes, numbers and distributions raises.

    >>> sets = {"sets": {"A": {"plane": "50/150", "spacing": 2, "scatter": 8}, "B": {"plane": "60/220", "spacing": 4}}}
    >>> drawn = joints_of_sets(sets, 1, 300)
    >>> len(drawn), [joint.set_name for joint in drawn.joints].count("A"), drawn.joints[-1].plane
    (300, 200, Plane(dip_deg=60.0, dip_direction_deg=220.0))
    """
    document = document_from(source, "joints") if isinstance(source, Mapping) else load_document(source)
    name = document.name
    nodes: dict[str, list[Node]] = {}
    for key in ("joints", "sets"):
        block = document.root.get(key)
        for own, node in () if block is None else block.items():
            nodes.setdefault(own, []).append(node)
    if not nodes:
        advice = "slopekit sets survey.csv writes such a block; a survey itself is a .csv or .xlsx file."
        raise DesignError([Fault("E190", f"{name} holds no joint sets under sets: or joints:", name, advice)])
    faults = Faults()
    planes: dict[str, Fisher | Angles | Plane] = {}
    values: dict[str, _Values] = {}
    for own, parts in nodes.items():
        with faults.kept():
            planes[own], values[own] = _set(own, parts)
    faults.refuse()
    return _drawn(name, planes, values, seed, count)


def _set(name: str, parts: list[Node]) -> tuple[Fisher | Angles | Plane, _Values]:
    """The plane of a set, and its numbers."""
    faults = Faults()
    given: dict[str, Node] = {}
    for part in parts:
        for key, node in part.items():
            if key not in _KEYS:
                near = get_close_matches(key, _KEYS, n=1)
                advice = f"Did you mean {near[0]}?" if near else f"Known: {', '.join(_KEYS)}."
                faults.append(Fault("E142", f"a joint set has no {key} ({name})", str(node.key_place), advice))
            given.setdefault(key, node)
    values: _Values = {}
    for key, (kind, least, most) in {**_NUMBERS, **_PARTS}.items():
        with faults.kept():
            if key in given:
                values[key] = number_or_scatter(given[key], kind, f"{key} of {name}", least, most, key in _NUMBERS)
    if "plane" not in given:
        faults.append(Fault("E143", f"{name} has no plane", str(parts[0].place), "Write plane: 54/142."))
    plane = faults.of(lambda: _plane(given["plane"], name)) if "plane" in given else None
    if faults or plane is None:
        raise DesignError(faults)
    scatter = values.pop("scatter", 0.0)
    if isinstance(plane, Plane) and isinstance(scatter, float) and scatter > 0.0:
        plane = Fisher(plane, 2.0 / math.radians(scatter) ** 2)  # as a bench's joint set has it
    varies, spacing = values.pop("spacing_scatter", 0.0), values.get("spacing")
    if isinstance(spacing, float) and isinstance(varies, float) and varies > 0.0:
        least, most = _NUMBERS["spacing"][1:]
        shape = {"mean": spacing, "sd": varies * spacing, "min": least, "max": most}
        values["spacing"] = Distribution("lognormal", shape, "length")
    return plane, values


def _plane(node: Node, name: str) -> Fisher | Angles | Plane:
    if is_distribution(node):
        return read_orientation(node, name)
    if has_angles(node):
        return read_angles(node, name)
    return parse_plane(node.text if node.text is not None else node.plain(), name, str(node.place))


def number_or_scatter(
    node: Node, kind: str, name: str, least: float, most: float, may_scatter: bool
) -> Distribution | float:  # fmt: skip
    """A number, or how it scatters: cut off where no joint can be, as long as that is little of it."""
    where = str(node.place)
    if not (may_scatter and is_distribution(node)):
        written: Any = node.text if node.text is not None else node.plain()
        value = quantity(written, kind, name, where)
        if not least <= value <= most:
            message = f"{name} is {number(value)}, it lies between {number(least)} and {number(most)}"
            raise DesignError([Fault("E281", message, where)])
        return value
    scatters = read_distribution(node, kind, name)
    beyond = sum(tails(scatters, least, most))
    cut = scatters.name in ("normal", "lognormal")
    if beyond > (MOST_BEYOND if cut else 0.0):
        message = f"{100.0 * beyond:.3g} % of {name} lies below {number(least)} or above {number(most)}"
        raise DesignError([Fault("E281", message, where, "Make it narrower, or give it min and max.")])
    if not cut or not scatters.parameters["sd"]:
        return scatters
    known = scatters.parameters
    bounds = {"min": max(least, known.get("min", least)), "max": min(most, known.get("max", most))}
    return replace(scatters, parameters={**known, **bounds})


def _drawn(
    name: str, planes: Mapping[str, Fisher | Angles | Plane], values: Mapping[str, _Values], seed: int, count: int
) -> JointList:  # fmt: skip
    """So many joints of the sets, each as often as it is met."""
    apart = [_centre(own.get("spacing")) for own in values.values()]
    often = np.array([1.0 / one if one is not None else 1.0 for one in apart])
    if any(one is None for one in apart):
        often = np.ones(len(apart))
    ends = np.round(np.cumsum(often) / often.sum() * count).astype(int)
    counts = np.maximum(np.diff(ends, prepend=0), _FEWEST)
    variables = [Variable(f"{own}.plane", plane) for own, plane in planes.items() if not isinstance(plane, Plane)]
    variables += [
        Variable(f"{own}.{key}", value)
        for own, numbers in values.items() for key, value in numbers.items() if isinstance(value, Distribution)
    ]  # fmt: skip
    columns: dict[str, Floats] = {}
    if variables:
        drawn = samples(variables, (), int(counts.max()), (seed ^ _OWN_SEED) % 2**63)
        columns = {path: drawn.values[:, k] for k, path in enumerate(drawn.names)}
    joints: list[MeasuredJoint] = []
    for (own, plane), many in zip(planes.items(), counts.tolist(), strict=True):
        for k in range(many):
            known = {
                key: float(columns[f"{own}.{key}"][k]) if isinstance(value, Distribution) else value
                for key, value in values[own].items()
            }  # fmt: skip
            at = plane if isinstance(plane, Plane) else Plane(
                *(float(columns[f"{own}.plane.{angle}"][k]) for angle in ("dip", "dip_direction"))
            )  # fmt: skip
            joints.append(MeasuredJoint(
                f"{own}-{k + 1}", at, len(joints) + 1, known.get("c"), known.get("phi"), own,
                spacing_m=known.get("spacing"), trace_m=known.get("trace"),
            ))  # fmt: skip
    return JointList(name, tuple(joints), (), (f"{len(joints)} joints drawn of {len(planes)} sets",))


def _centre(value: Distribution | float | None) -> float | None:
    return value.centre if isinstance(value, Distribution) else value
