"""Cohesion and friction that scatter: given as on a command line, drawn at each place."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.errors import DesignError, Fault
from slopekit.core.sheet import counted
from slopekit.design.reading.nodes import Document, Node, document_from
from slopekit.design.reading.overrides import with_overrides
from slopekit.design.reading.structure import is_distribution
from slopekit.design.scatter.distributions import PARAMETERS, Distribution, Variable
from slopekit.studies.bench_design.drawn import STRENGTHS, number_or_scatter
from slopekit.studies.bench_design.trials import Trials
from slopekit.studies.prob.sampling import samples

if TYPE_CHECKING:
    from slopekit.studies.bench_design.given import BenchInputs

_OWN_SEED: Final = 0xC0FE
_EXAMPLE: Final = {"c": "lognormal:10,4", "phi": "normal:30,3"}


def drawn_strength(key: str, given: Any, where: str) -> Distribution | None:
    """How `c` or `phi` scatters where it is given so; None for a plain value.

    Parameters
    ----------
    given : `normal:10,3` (the parameters of a distribution in their order), `{dist: normal, mean: 10, sd: 3}` as in a
        file, or that as a dict

    Raises
    ------
    DesignError
        E165 parameters of the short way, and what a file of sets raises for the same.

    >>> drawn_strength("phi", "normal:30,3,20,40", "--phi").parameters
    {'mean': 30.0, 'sd': 3.0, 'min': 20.0, 'max': 40.0}
    """
    if isinstance(given, str) and given.lstrip().startswith("{"):
        return _read(key, _from_text(given, where), where, given)
    if isinstance(given, str) and ":" in given:
        return _read(key, document_from({key: _in_short(key, given, where)}), where, given)
    return _read(key, document_from({key: given}), where, given) if isinstance(given, Mapping) else None


def _from_text(given: str, where: str) -> Document:
    try:
        return with_overrides(document_from({}), [("c", given)])
    except DesignError as error:
        raise DesignError([replace(fault, where=f"{where} {given}") for fault in error.faults]) from None


def _in_short(key: str, given: str, where: str) -> dict[str, str]:
    name, _, rest = given.partition(":")
    name, parts = name.strip().lower(), [part.strip() for part in rest.split(",")]
    needed, further = PARAMETERS.get(name, ((), ()))
    if name == "fisher" or (needed and len(parts) not in (len(needed), len(needed) + len(further))) or "" in parts:
        takes = ", ".join(needed) + (f" and maybe {', '.join(further)}" if further else "")
        message = f"{given} is no distribution of a number"
        if needed and name != "fisher":
            message = f"{given} has {counted(len(parts), 'number')}, {name} takes {takes}"
        raise DesignError([Fault("E165", message, f"{where} {given}", f"Write {where} {_EXAMPLE[key]}.")])
    return {"dist": name, **dict(zip((*needed, *further), parts, strict=False))}


def _read(key: str, document: Document, where: str, given: Any) -> Distribution:
    node = next((below for _, below in document.root.items()), None)
    try:
        if not isinstance(node, Node) or not is_distribution(node):
            message = f"{key} is a group of keys without dist"
            raise DesignError([Fault("E165", message, "", f"Write {where} {_EXAMPLE[key]}.")])
        kind, least, most = STRENGTHS[key]
        distribution = number_or_scatter(node, kind, key, least, most, True)
    except DesignError as error:
        raise DesignError([replace(fault, where=f"{where} {given}") for fault in error.faults]) from None
    assert isinstance(distribution, Distribution)
    return distribution


def with_drawn(asked: "BenchInputs", trials: Trials) -> Trials:
    """The places with the strengths of their joints where these scatter: one value for each joint at each place.

    A joint with a value of its own keeps it; c and φ, and the two joints, are drawn apart from each other.
    """
    if not asked.drawn:
        return trials
    own, joints = asked.joints.joints, np.stack([trials.first, trials.second])
    variables = [Variable(key, one) for key, one in asked.drawn.items()]
    drawn = samples(variables, (), joints.size, (int(asked.number("seed")) ^ _OWN_SEED) % 2**63)
    columns = {key: drawn.values[:, k].reshape(joints.shape) for k, key in enumerate(drawn.names)}
    return replace(
        trials,
        cohesion_kpa=_at(asked.cohesion_kpa, [one.cohesion_kpa for one in own], joints, columns.get("c")),
        friction_deg=_at(asked.friction_deg, [one.friction_angle_deg for one in own], joints, columns.get("phi")),
    )


def _at(values: Floats, own: list[float | None], joints: np.ndarray, drawn: Floats | None) -> Floats:
    has_own = np.array([one is not None for one in own])
    return values[joints] if drawn is None else np.where(has_own[joints], values[joints], drawn)


def without_cohesion(trials: Trials) -> Trials:
    """The same places, their joints without cohesion."""
    return replace(trials, cohesion_kpa=np.zeros((2, len(trials))))


def in_words(scatters: Distribution) -> str:
    """A distribution with its numbers, but for limits beyond which no joint can be.

    >>> in_words(Distribution("normal", {"mean": 10.0, "sd": 3.0, "min": 0.0, "max": 1e9}, "pressure"))
    'normal, mean 10, sd 3'
    """
    ends = next(own[1:] for own in STRENGTHS.values() if own[0] == scatters.kind)
    said = [
        f"{key} {value:g}" for key, value in scatters.parameters.items()
        if not (scatters.name in ("normal", "lognormal") and value in ends and key in ("min", "max"))
    ]  # fmt: skip
    return ", ".join([scatters.name, *said])
