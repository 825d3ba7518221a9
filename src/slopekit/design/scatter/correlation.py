"""Reading the rank correlations of random variables from a design: `correlation: {J1.phi/J2.phi: 0.8}`."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.design.common import Pair
from slopekit.design.reading.nodes import Node, fail
from slopekit.design.reading.structure import ANGLES
from slopekit.design.scatter.copula import EIGENVALUE_TOLERANCE, smallest_eigenvalue
from slopekit.design.scatter.distributions import Fisher, Variable, node_number

#: The meaning of a name in a correlation: a coordinate, or the variable of an orientation.
CorrelatedValue: TypeAlias = str | Variable
_SHOWN_NAMES = 12


def check_correlation(
    node: Node, names: Mapping[str, CorrelatedValue]
) -> tuple[tuple[Pair, ...], list[Fault]]:
    """Return the rank correlations of a design and their faults.

    Parameters
    ----------
    node : mapping of A/B to a coefficient
    names : the allowed names with their meaning

    Returns
    -------
    pairs of coordinates with their coefficient (two orientations give two pairs), and faults: E105 to E108 for a
    coefficient, E144 no mapping, E151 a pair twice, E167 a key that is no pair, a coefficient beyond -1 to 1, a value
    with itself, or an orientation with a number, E168 an unknown name, E183 coefficients that contradict each other.

    >>> from slopekit.design.reading.nodes import document_from
    >>> node = document_from({"J1.phi/J2.phi": 0.8}).root
    >>> check_correlation(node, {"J1.phi": "strength.rough.phi", "J2.phi": "strength.clay.phi"})
    ((('strength.rough.phi', 'strength.clay.phi', 0.8),), [])
    """
    if not node.is_mapping and node.value is not None:
        advice = "Write correlation: {J1.phi/J2.phi: 0.8}"
        return (), [Fault("E144", "correlation is not a group of pairs", str(node.place), advice)]
    faults = Faults()
    pairs: dict[frozenset[str], Pair] = {}
    keys: dict[frozenset[str], str] = {}
    for key, coefficient in node.items():
        key_names = tuple(name.strip() for name in key.split("/"))
        location = str(coefficient.key_place)
        if len(key_names) != 2 or not all(key_names):
            faults.append(
                Fault(
                    "E167",
                    f"{key} is not a pair of two names",
                    location,
                    "A pair is written J1.phi/J2.phi.",
                )
            )
            continue
        unknown = [
            _unknown_name(name, names, location)
            for name in dict.fromkeys(key_names)
            if name not in names
        ]
        coordinates = (
            []
            if unknown
            else faults.of(_coordinates, key_names[0], key_names[1], names, location) or []
        )
        twice = next(
            (keys[frozenset(pair)] for pair in coordinates if frozenset(pair) in keys), None
        )
        if twice is not None:
            message = f"{'/'.join(key_names)} is the same pair as {twice}"
            faults.append(Fault("E151", message, location, "Leave one of them out."))
        faults += unknown
        value = faults.of(
            node_number,
            coefficient,
            "ratio",
            f"correlation {key}",
            least=-1.0,
            most=1.0,
            code="E167",
        )
        if value is not None and twice is None:
            pairs |= {frozenset(pair): (*pair, value) for pair in coordinates}
            keys |= dict.fromkeys(map(frozenset, coordinates), key)
    correlations = tuple(pairs.values())
    if not faults:
        faults += contradictions(
            correlations, [keys[frozenset(pair[:2])] for pair in correlations], str(node.key_place)
        )
    return correlations, faults


def _coordinates(
    a: str, b: str, names: Mapping[str, CorrelatedValue], location: str
) -> list[tuple[str, str]]:
    """Return the pairs of coordinates of a pair of names. Raises DesignError E167 where they cannot be correlated."""
    first, second = names[a], names[b]
    if a == b:
        fail("E167", f"{a} is correlated with itself, that is always 1", location, "Leave it out.")
    if first == second:
        message = f"{a} and {b} are one value, {first if isinstance(first, str) else first.path}"
        fail(
            "E167",
            message,
            location,
            "Leave it out, or give each its own: two strengths, two planes.",
        )
    if isinstance(first, str) and isinstance(second, str):
        variables = [variable for variable in names.values() if isinstance(variable, Variable)]
        if any(
            isinstance(variable.distribution, Fisher) and {first, second} == {*variable.angles}
            for variable in variables
        ):
            message = (
                f"{a} and {b} are of one Fisher distribution, which scatters alike to all sides"
            )
            fail(
                "E167",
                message,
                location,
                "To correlate them write plane: {dip: {dist: …}, dip_direction: {dist: …}}.",
            )
        return [(first, second)]
    if isinstance(first, Variable) and isinstance(second, Variable):
        pairs = [pair for pair in zip(first.angles, second.angles, strict=True) if all(pair)]
        if not pairs:
            advice = f"There are: {', '.join((*first.coordinates, *second.coordinates))}."
            fail("E167", f"of {a} and {b} no angle scatters in both", location, advice)
        return pairs
    orientation_name, number_name, orientation = (
        (a, b, first) if isinstance(first, Variable) else (b, a, second)
    )
    assert isinstance(orientation, Variable)
    choice = " or ".join(
        f"{orientation_name}.{angle.rpartition('.')[2]}/{number_name}"
        for angle in orientation.coordinates
    )
    message = f"{orientation_name} is an orientation, {number_name} is not: {a}/{b} does not say which angle"
    raise DesignError([Fault("E167", message, location, f"Write {choice}.")])


def _unknown_name(name: str, names: Mapping[str, CorrelatedValue], location: str) -> Fault:
    scattering = f"These scatter: {', '.join(list(names)[:_SHOWN_NAMES])}."
    advice = did_you_mean(
        name, names, scattering if names else "Nothing in this design is a distribution."
    )
    return Fault("E168", f"{name} is not a value that scatters in this design", location, advice)


# -- coefficients that contradict each other --------------------------------------------------------------------------


def contradictions(pairs: Sequence[Pair], keys: Sequence[str], location: str) -> Iterator[Fault]:
    """Yield fault E183 for each group of variables whose rank correlations are impossible.

    Parameters
    ----------
    pairs : pairs of coordinates with their rank correlation
    keys : the key of each pair as the user wrote it
    location : place of the fault

    >>> given = [("a", "b", 0.9), ("b", "c", 0.9), ("a", "c", -0.9)]
    >>> print(*contradictions(given, ["a/b", "b/c", "a/c"], ""))
    E183 the correlations of a, b, c contradict each other: their matrix has the eigenvalue -0.816, none may be negative
         Bring them nearer to 0. Pairs that are not given count as 0.
    """
    from scipy.sparse.csgraph import connected_components

    names = _names_as_written(pairs, keys)
    place = {name: k for k, name in enumerate(names)}
    ranks = np.eye(len(names))
    for a, b, value in pairs:
        ranks[place[a], place[b]] = ranks[place[b], place[a]] = value
    count, group = connected_components(ranks != 0.0)
    for members in (np.flatnonzero(group == k) for k in range(count)):
        smallest = smallest_eigenvalue(ranks[np.ix_(members, members)])
        if smallest < -EIGENVALUE_TOLERANCE:
            member_names = ", ".join(list(names.values())[k] for k in members)
            message = f"the correlations of {member_names} contradict each other: their matrix has the eigenvalue "
            message += f"{smallest:.3g}, none may be negative"
            yield Fault(
                "E183",
                message,
                location,
                "Bring them nearer to 0. Pairs that are not given count as 0.",
            )


def _names_as_written(pairs: Sequence[Pair], keys: Sequence[str]) -> dict[str, str]:
    """Return the coordinates' names as the user wrote them, with the angle added to names of orientations."""
    spelled: dict[str, str] = {}
    for (a, b, _), key in zip(pairs, keys, strict=True):
        for coordinate, name in zip((a, b), key.split("/"), strict=True):
            spelled.setdefault(coordinate, _with_angle(name.strip(), coordinate))
    return spelled


def _with_angle(name: str, coordinate: str) -> str:
    """Return the name of an orientation with the coordinate's angle, `J1.plane.dip`; any other name unchanged.

    >>> _with_angle("J1.plane", "joints.J1.plane.dip"), _with_angle("J1.phi", "strength.weak.phi")
    ('J1.plane.dip', 'J1.phi')
    """
    above, _, angle = coordinate.rpartition(".")
    is_whole = (
        angle in sum(ANGLES.values(), ()) and name.rpartition(".")[2] == above.rpartition(".")[2]
    )
    return f"{name}.{angle}" if is_whole else name
