"""The rank correlation between what scatters, as a design file gives it: `correlation: {J1.phi/J2.phi: 0.8}`."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.design.common import Pair
from slopekit.design.reading.nodes import Node, fail
from slopekit.design.reading.structure import ANGLES
from slopekit.design.scatter.copula import EIGENVALUE_TOLERANCE, smallest_eigenvalue
from slopekit.design.scatter.distributions import Fisher, Variable, node_number

#: What a name stands for: a coordinate, or a whole orientation.
Named: TypeAlias = str | Variable
_SHOWN_NAMES = 12


def check_correlation(node: Node, names: Mapping[str, Named]) -> tuple[tuple[Pair, ...], list[Fault]]:
    """The rank correlations of a design, and what is wrong with them.

    Parameters
    ----------
    node : mapping of A/B to a coefficient
    names : what may be named, and what that is

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
    for key, given in node.items():
        parts = tuple(part.strip() for part in key.split("/"))
        where = str(given.key_place)
        if len(parts) != 2 or not all(parts):
            faults.append(Fault("E167", f"{key} is not a pair of two names", where, "A pair is written J1.phi/J2.phi."))
            continue
        unknown = [_unknown_name(name, names, where) for name in dict.fromkeys(parts) if name not in names]
        coordinates = [] if unknown else faults.of(_coordinates, parts[0], parts[1], names, where) or []
        twice = next((keys[frozenset(pair)] for pair in coordinates if frozenset(pair) in keys), None)
        if twice is not None:
            message = f"{'/'.join(parts)} is the same pair as {twice}"
            faults.append(Fault("E151", message, where, "Leave one of them out."))
        faults += unknown
        value = faults.of(node_number, given, "ratio", f"correlation {key}", least=-1.0, most=1.0, code="E167")
        if value is not None and twice is None:
            pairs |= {frozenset(pair): (*pair, value) for pair in coordinates}
            keys |= dict.fromkeys(map(frozenset, coordinates), key)
    found_pairs = tuple(pairs.values())
    if not faults:
        faults += contradictions(found_pairs, [keys[frozenset(pair[:2])] for pair in found_pairs], str(node.key_place))
    return found_pairs, faults


def _coordinates(a: str, b: str, names: Mapping[str, Named], where: str) -> list[tuple[str, str]]:
    """The pairs of coordinates that a pair of names is. Raises DesignError E167 where it is none."""
    first, second = names[a], names[b]
    if a == b:
        fail("E167", f"{a} is correlated with itself, that is always 1", where, "Leave it out.")
    if first == second:
        message = f"{a} and {b} are one value, {first if isinstance(first, str) else first.path}"
        fail("E167", message, where, "Leave it out, or give each its own: two strengths, two planes.")
    if isinstance(first, str) and isinstance(second, str):
        variables = [variable for variable in names.values() if isinstance(variable, Variable)]
        if any(isinstance(each.distribution, Fisher) and {first, second} == {*each.angles} for each in variables):
            message = f"{a} and {b} are of one Fisher distribution, which scatters alike to all sides"
            fail("E167", message, where, "To correlate them write plane: {dip: {dist: …}, dip_direction: {dist: …}}.")
        return [(first, second)]
    if isinstance(first, Variable) and isinstance(second, Variable):
        pairs = [pair for pair in zip(first.angles, second.angles, strict=True) if all(pair)]
        if not pairs:
            advice = f"There are: {', '.join((*first.coordinates, *second.coordinates))}."
            fail("E167", f"of {a} and {b} no angle scatters in both", where, advice)
        return pairs
    whole, plain, turned = (a, b, first) if isinstance(first, Variable) else (b, a, second)
    assert isinstance(turned, Variable)
    choice = " or ".join(f"{whole}.{angle.rpartition('.')[2]}/{plain}" for angle in turned.coordinates)
    message = f"{whole} is an orientation, {plain} is not: {a}/{b} does not say which angle"
    raise DesignError([Fault("E167", message, where, f"Write {choice}.")])


def _unknown_name(name: str, names: Mapping[str, Named], where: str) -> Fault:
    scattering = f"These scatter: {', '.join(list(names)[:_SHOWN_NAMES])}."
    advice = did_you_mean(name, names, scattering if names else "Nothing in this design is a distribution.")
    return Fault("E168", f"{name} is not a value that scatters in this design", where, advice)


# -- coefficients that contradict each other --------------------------------------------------------------------------


def contradictions(pairs: Sequence[Pair], keys: Sequence[str], where: str) -> Iterator[Fault]:
    """E183 for each group of values whose coefficients cannot stand together.

    Parameters
    ----------
    pairs : of coordinates
    keys : what the user wrote for each

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
            shown = ", ".join(list(names.values())[k] for k in members)
            message = f"the correlations of {shown} contradict each other: their matrix has the eigenvalue "
            message += f"{smallest:.3g}, none may be negative"
            yield Fault("E183", message, where, "Bring them nearer to 0. Pairs that are not given count as 0.")


def _names_as_written(pairs: Sequence[Pair], keys: Sequence[str]) -> dict[str, str]:
    """The coordinates as the user wrote them; of an orientation written as a whole the angle too."""
    spelled: dict[str, str] = {}
    for (a, b, _), key in zip(pairs, keys, strict=True):
        for coordinate, part in zip((a, b), key.split("/"), strict=True):
            spelled.setdefault(coordinate, _with_angle(part.strip(), coordinate))
    return spelled


def _with_angle(name: str, coordinate: str) -> str:
    """`J1.plane` for its dip: J1.plane.dip; any other name as it is.

    >>> _with_angle("J1.plane", "joints.J1.plane.dip"), _with_angle("J1.phi", "strength.weak.phi")
    ('J1.plane.dip', 'J1.phi')
    """
    above, _, angle = coordinate.rpartition(".")
    is_whole = angle in sum(ANGLES.values(), ()) and name.rpartition(".")[2] == above.rpartition(".")[2]
    return f"{name}.{angle}" if is_whole else name
