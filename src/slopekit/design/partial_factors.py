"""Partial factors: a design with every strength divided and every action multiplied by its own factor.

The design itself is factored, so both methods, every study and every picture see the design values. Its factor of
safety is then the over-design factor: 1 is enough. A factor on the resistance divides the strength of the joints once
more, which divides that factor of safety alike.

>>> from slopekit.design.reading.files import load
>>> plane = {"slopekit": 1, "kind": "plane", "slope": {"face": "60/180", "height": 12}, "rock": {"unit_weight": 26},
...          "joints": {"J1": {"plane": "35/180"}}, "strength": {"s": {"c": 25, "phi": 37}},
...          "analysis": {"partial_factors": "DA1-C2"}}
>>> design = load(plane)
>>> design.strength.cohesion_kpa, round(design.strength.friction_angle_deg, 3)
(20.0, 31.083)
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

from slopekit.core.errors import DesignError, Fault, Faults, GeometryError, did_you_mean
from slopekit.design.common import Design
from slopekit.design.fields import fields_of
from slopekit.design.parts import Action, FactoredNumber, PartialFactors, Residual, Rule, Strength, listed
from slopekit.design.reading.nodes import Document, Node
from slopekit.strength.reduced import Reduced

_SHIPPED = Path(__file__).with_name("factors")
_SAME = 1e-12
_FILES = (".yaml", ".yml")
_NUMBERS = {own.path: name for name, own in fields_of(PartialFactors).items() if own.is_number}


def read_factors(document: Document, node: Node) -> PartialFactors:
    """The factors that a design asks for: a set by its name, of a file, or its own.

    Raises
    ------
    DesignError
        E127 a number that is no factor, E197 no such set, with the nearest, E480 a file that holds no factors, and
        those of reading it.
    """
    if node.text is not None:
        return _set_of(document, node.text, node)
    faults = Faults()
    base, named = PartialFactors(), node.get("set")
    if named.text is not None:
        base = faults.of(_set_of, document, named.text, named) or base
    own = _numbers(node, faults)
    forces = node.get("forces")
    if forces.text is not None:
        if forces.text not in ("permanent", "variable"):
            faults.append(Fault("E127", f"forces are {forces.text}, they are permanent or variable", str(forces.place)))
        own["forces"] = forces.text
    faults.refuse()
    if own and base.called:
        return replace(base, **own, called=f"{base.called}, with factors of its own")
    return replace(base, **own, called=base.called or "its own factors")


def _numbers(node: Node, faults: Faults) -> dict[str, Any]:
    """The factors of a group of keys by attribute."""
    factors: dict[str, Any] = {}
    for path, name in _NUMBERS.items():
        below = node.get(path)
        if below.text is not None:
            read = fields_of(PartialFactors)[name].read
            value = faults.of(read, below.text, f"the partial factor {path}", str(below.place))
            factors |= {} if value is None else {name: value}
    return factors


def _set_of(document: Document, text: str, node: Node) -> PartialFactors:
    """`DA1-C2`, `eurocode-7 DA1-C2`, `my.yaml`, `my.yaml NAME`."""
    first, _, rest = text.strip().partition(" ")
    where = str(node.place)
    if first.lower().endswith(_FILES):
        file = Path(first)
        path = file if file.is_absolute() or document.path is None else document.path.parent / file
        return _chosen(_sets(path), rest.strip(), file.name, where)
    shipped = {path.stem: path for path in sorted(_SHIPPED.glob("*.yaml"))}
    if first.lower() in shipped:
        return _chosen(_sets(shipped[first.lower()]), rest.strip(), first, where)
    every = {name: one for path in shipped.values() for name, one in _of_ours(path).items()}
    return _chosen(every, text.strip(), "slopekit", where)


def _chosen(sets: Mapping[str, PartialFactors], name: str, of: str, where: str) -> PartialFactors:
    if not name and len(sets) == 1:
        return next(iter(sets.values()))
    folded = {key.lower(): one for key, one in sets.items()}
    if name.lower() in folded:
        return folded[name.lower()]
    advice = did_you_mean(name.upper(), sets, f"There are: {', '.join(sets)}; or a file: my-factors.yaml.")
    message = f"{name} is no set of partial factors of {of}" if name else f"{of} has several sets of partial factors"
    raise DesignError([Fault("E197", message, where, advice)])


def _sets(path: Path) -> Mapping[str, PartialFactors]:
    """The sets of a file by name: all under `sets`, or one that is the file itself."""
    from slopekit.design.reading.document import load_document

    root = load_document(path).root
    faults, factor_sets = Faults(), dict[str, PartialFactors]()
    title, source, date = (root.get(key).text or "" for key in ("title", "source", "date"))
    sets = root.get("sets")
    groups = dict(sets.items()) if sets else {title or path.stem: root}
    for name, node in groups.items():
        known = set(_NUMBERS) | (set() if sets else {"title", "source", "date"})
        for key, below in node.items():
            if key not in known:
                advice = did_you_mean(key, _NUMBERS, f"Known: {', '.join(_NUMBERS)}.")
                faults.append(Fault("E480", f"{key} is no partial factor", str(below.key_place), advice))
        numbers = _numbers(node, faults)
        if not numbers:
            message = f"{name} of {path.name} holds no partial factor"
            faults.append(Fault("E480", message, str(node.place), f"Known: {', '.join(_NUMBERS)}."))
        called = name if not title or name == title else f"{title}: {name}"
        factor_sets[name] = PartialFactors(**numbers, called=called, source=", ".join(filter(None, (source, date))))
    if not groups:
        message = f"{path.name} has no sets of partial factors"
        faults.append(Fault("E480", message, str(root.place), "Write sets: {NAME: {tan_phi: 1.25, c: 1.25}}"))
    faults.refuse()
    return factor_sets


_of_ours = cache(_sets)

# -- the design with them ---------------------------------------------------------------------------------------------


def factored(design: Design, kind: Any, given: PartialFactors, where: str = "") -> Design:
    """The design with its design values, and what has become of each number.

    Weight, forces (a footing's load among them) and surcharge are taken unfavourable or favourable, all of each alike,
    whichever gives the lower closed form; where a kind has none, unfavourable. Water is permanent and unfavourable. The
    seismic force is that of the weight without its factor. Bolts have theirs already or are strength.

    Raises
    ------
    DesignError
        E112 a curved law with two factors.
    """
    if abs(given.tan_phi - given.c) > _SAME and any(one.law is not None for one in design.joint_strengths):
        message = "a curved strength has no c and phi of its own: its partial factors tan_phi and c must be equal"
        raise DesignError([Fault("E112", message, where, "Eurocode 7 has 1.25 for both.")])
    rules = design.rules or (Rule("fos", ">=", 1.0),)
    tried = [
        (_level(made, kind), made)
        for made in (_with(design, given, *one) for one in _combinations(design, given))
    ]  # fmt: skip
    return replace(min(tried, key=lambda pair: pair[0])[1], rules=rules)


def _combinations(design: Design, given: PartialFactors) -> Iterator[tuple[float, float, float]]:
    """Factors of weight, forces and surcharge; the unfavourable ones first."""
    permanent = (given.permanent_unfavourable, given.permanent_favourable)
    variable = (given.variable_unfavourable, given.variable_favourable)
    forces = (variable if given.forces == "variable" else permanent) if design.forces or _load(design) else (1.0,)
    surcharge = variable if _surcharges(design) else (1.0,)
    every = product(dict.fromkeys(permanent), dict.fromkeys(forces), dict.fromkeys(surcharge))
    yield from every if design.HAS_CLOSED_FORM else [next(every)]


def _level(design: Design, kind: Any) -> float:
    if not design.HAS_CLOSED_FORM:
        return 0.0
    try:
        solution = kind.closed_form(design, None)
    except GeometryError:
        return math.inf  # said when it is analysed
    return math.inf if solution.status == "no_driving_force" else float(solution.factor or 0.0)


def _with(
    design: Design, given: PartialFactors, on_weight: float, on_forces: float, on_surcharge: float
) -> Design:  # fmt: skip
    weight, water = on_weight * given.unit_weight, given.permanent_unfavourable
    by: dict[Action, float] = {"weight": weight, "water": water, "force": on_forces, "surcharge": on_surcharge}
    load, surcharges = _load(design), _surcharges(design)
    shaken = replace(design.seismic, coefficient=design.seismic.coefficient / weight)
    made: Design = replace(_acting(design.each_strength(lambda one: _weaker(one, given)), by), seismic=shaken)
    rows = [*_of_strengths(design, made, given)]
    if design.rock.unit_weight_kn_m3:  # a footing may stand on rock without weight
        rows.append(
            FactoredNumber("unit weight", design.rock.unit_weight_kn_m3, weight, made.rock.unit_weight_kn_m3, "kN/m³")
        )
    if design.is_wet:
        rows.append(FactoredNumber("unit weight of water, and its pressures", design.water_unit_weight_kn_m3, water,
                                   made.water_unit_weight_kn_m3, "kN/m³"))  # fmt: skip
    for k, (before, after) in enumerate(zip(design.forces, made.forces, strict=True), 1):
        rows.append(FactoredNumber(f"force {k}, {given.forces}", math.hypot(*before.components_kn), on_forces,
                                   math.hypot(*after.components_kn), "kN"))  # fmt: skip
    if load:
        rows.append(FactoredNumber(f"{design.kind} load, {given.forces}", load, on_forces, load * on_forces, "kN"))
    for name, one in surcharges.items():
        what = f"surcharge{f' on {name}' if name else ''}, variable"
        rows.append(FactoredNumber(what, one, on_surcharge, one * on_surcharge, "kPa"))
    if design.seismic.coefficient:
        k_before = design.seismic.coefficient
        rows.append(FactoredNumber("seismic coefficient, of the weight unfactored", k_before, 1.0, k_before, ""))
    analysis = replace(made.analysis, partial=replace(given, table=tuple(rows)))
    return replace(made, analysis=analysis)


def _actions(record: type) -> dict[str, Action]:
    """The attributes of a record that partial factors multiply."""
    return {name: how for own in listed(record, "ACTIONS") for name, how in own.items()}


def _acting(value: Any, by: Mapping[Action, float]) -> Any:
    """A record, or a tuple of records, with what acts in it times its factor; what does not act stays as it is."""
    if isinstance(value, tuple):
        made = tuple(_acting(one, by) for one in value)
        return made if any(new is not old for new, old in zip(made, value, strict=True)) else value
    if not is_dataclass(value) or isinstance(value, type):
        return value
    own = _actions(type(value))
    changed = {name: _times(getattr(value, name), by[how]) for name, how in own.items()}
    for part in fields(value):
        if part.compare and part.name not in own:
            old = getattr(value, part.name)
            new = _acting(old, by)
            changed |= {} if new is old else {part.name: new}
    return replace(value, **changed) if changed else value


def _load(design: Design) -> float:
    """In kN, that of a footing; 0 where there is none."""
    return float(sum(getattr(design, name) for name, how in _actions(type(design)).items() if how == "force"))


def _surcharges(design: Design) -> dict[str, float]:
    """In kPa, by the block they stand on; of the upper slope by no name."""
    given = [getattr(design, name) for name, how in _actions(type(design)).items() if how == "surcharge"]
    return {name: one for own in given if own for name, one in (own if isinstance(own, tuple) else (("", own),))}


def _weaker(one: Strength, given: PartialFactors) -> Strength:
    """The design strength: c and tan φ divided, of a curved law τ."""
    on_phi, on_c = given.tan_phi * given.resistance, given.c * given.resistance
    dilation = _angle(one.dilation_deg, on_phi)
    left = one.residual
    residual = None if left is None else Residual(left.cohesion_kpa / on_c, _angle(left.friction_angle_deg, on_phi))
    if one.law is not None:
        return replace(Strength.by_law(Reduced(one.law, on_phi), dilation, one.tension_kpa / on_c), residual=residual)
    return Strength(one.cohesion_kpa / on_c, _angle(one.friction_angle_deg, on_phi), dilation, one.tension_kpa / on_c,
                    residual=residual)  # fmt: skip


def _angle(degrees: float, factor: float) -> float:
    return degrees if factor == 1.0 else math.degrees(math.atan(math.tan(math.radians(degrees)) / factor))


def _of_strengths(design: Design, made: Design, given: PartialFactors) -> Iterator[FactoredNumber]:
    pairs = list(dict.fromkeys(zip(design.joint_strengths, made.joint_strengths, strict=True)))
    for k, (before, after) in enumerate(pairs, 1):
        of = f", strength {k}" if len(pairs) > 1 else ""
        on_phi, on_c = given.tan_phi * given.resistance, given.c * given.resistance
        if before.law is not None:
            yield FactoredNumber(f"strength by its law{of}", None, on_phi, None, "")
            continue
        yield FactoredNumber(f"c{of}", before.cohesion_kpa, on_c, after.cohesion_kpa, "kPa", True)
        tangent, lower = (math.tan(math.radians(one.friction_angle_deg)) for one in (before, after))
        yield FactoredNumber(f"tan φ{of}", tangent, on_phi, lower, "", True)
        yield FactoredNumber(f"φ{of}", before.friction_angle_deg, None, after.friction_angle_deg, "°")


def _times(value: Any, factor: float) -> Any:
    """Numbers in tuples, times a factor; names among them stay."""
    if isinstance(value, tuple):
        return tuple(_times(part, factor) for part in value)
    return value * factor if isinstance(value, int | float) else value
