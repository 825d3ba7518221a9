"""Partial factors: the design with its strengths divided and its actions multiplied by their factors.

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
from slopekit.design.parts import (
    Action,
    FactoredNumber,
    PartialFactors,
    Residual,
    Rule,
    Strength,
    listed,
)
from slopekit.design.reading.nodes import Document, Node
from slopekit.strength.reduced import Reduced

_SHIPPED = Path(__file__).with_name("factors")
_EQUAL_FACTORS = 1e-12
_FILES = (".yaml", ".yml")
_NUMBERS = {
    field.path: name for name, field in fields_of(PartialFactors).items() if field.is_number
}


def read_factors(document: Document, node: Node) -> PartialFactors:
    """Read the partial factors of a design: a set by its name, a set of a file, or factors given in the design.

    Raises
    ------
    DesignError
        E127 a number that is no factor, E197 an unknown set, with the nearest, E480 a file without factors, and
        the faults of reading the file.
    """
    if node.text is not None:
        return _factor_set(document, node.text, node)
    faults = Faults()
    base, set_node = PartialFactors(), node.get("set")
    if set_node.text is not None:
        base = faults.of(_factor_set, document, set_node.text, set_node) or base
    numbers = _numbers(node, faults)
    forces = node.get("forces")
    if forces.text is not None:
        if forces.text not in ("permanent", "variable"):
            faults.append(
                Fault(
                    "E127",
                    f"forces are {forces.text}, they are permanent or variable",
                    str(forces.place),
                )
            )
        numbers["forces"] = forces.text
    faults.refuse()
    if numbers and base.called:
        return replace(base, **numbers, called=f"{base.called}, with factors of its own")
    return replace(base, **numbers, called=base.called or "its own factors")


def _numbers(node: Node, faults: Faults) -> dict[str, Any]:
    """Return the factors in a group of keys by attribute; faults are added to `faults`."""
    factors: dict[str, Any] = {}
    for path, name in _NUMBERS.items():
        below = node.get(path)
        if below.text is not None:
            read = fields_of(PartialFactors)[name].read
            value = faults.of(read, below.text, f"the partial factor {path}", str(below.place))
            factors |= {} if value is None else {name: value}
    return factors


def _factor_set(document: Document, text: str, node: Node) -> PartialFactors:
    """Return a set of partial factors from `DA1-C2`, `eurocode-7 DA1-C2`, `my.yaml` or `my.yaml NAME`."""
    first, _, rest = text.strip().partition(" ")
    location = str(node.place)
    if first.lower().endswith(_FILES):
        file = Path(first)
        path = file if file.is_absolute() or document.path is None else document.path.parent / file
        return _choose_set(_sets(path), rest.strip(), file.name, location)
    shipped = {path.stem: path for path in sorted(_SHIPPED.glob("*.yaml"))}
    if first.lower() in shipped:
        return _choose_set(_sets(shipped[first.lower()]), rest.strip(), first, location)
    shipped_sets = {
        name: factors for path in shipped.values() for name, factors in _shipped_sets(path).items()
    }
    return _choose_set(shipped_sets, text.strip(), "slopekit", location)


def _choose_set(
    sets: Mapping[str, PartialFactors], name: str, source: str, location: str
) -> PartialFactors:
    if not name and len(sets) == 1:
        return next(iter(sets.values()))
    folded = {key.lower(): factors for key, factors in sets.items()}
    if name.lower() in folded:
        return folded[name.lower()]
    advice = did_you_mean(
        name.upper(), sets, f"There are: {', '.join(sets)}; or a file: my-factors.yaml."
    )
    message = (
        f"{name} is no set of partial factors of {source}"
        if name
        else f"{source} has several sets of partial factors"
    )
    raise DesignError([Fault("E197", message, location, advice)])


def _sets(path: Path) -> Mapping[str, PartialFactors]:
    """Read the sets of partial factors of a file by name: those under `sets`, or the file itself as one set."""
    from slopekit.design.reading.document import load_document

    root = load_document(path).root
    faults, factor_sets = Faults(), dict[str, PartialFactors]()
    title, source, date = (root.get(key).text or "" for key in ("title", "source", "date"))
    sets = root.get("sets")
    groups = dict(sets.items()) if sets else {title or path.stem: root}
    for name, node in groups.items():
        known_keys = set(_NUMBERS) | (set() if sets else {"title", "source", "date"})
        for key, below in node.items():
            if key not in known_keys:
                advice = did_you_mean(key, _NUMBERS, f"Known: {', '.join(_NUMBERS)}.")
                faults.append(
                    Fault("E480", f"{key} is no partial factor", str(below.key_place), advice)
                )
        numbers = _numbers(node, faults)
        if not numbers:
            message = f"{name} of {path.name} holds no partial factor"
            faults.append(Fault("E480", message, str(node.place), f"Known: {', '.join(_NUMBERS)}."))
        set_title = name if not title or name == title else f"{title}: {name}"
        factor_sets[name] = PartialFactors(
            **numbers, called=set_title, source=", ".join(filter(None, (source, date)))
        )
    if not groups:
        message = f"{path.name} has no sets of partial factors"
        faults.append(
            Fault("E480", message, str(root.place), "Write sets: {NAME: {tan_phi: 1.25, c: 1.25}}")
        )
    faults.refuse()
    return factor_sets


_shipped_sets = cache(_sets)

# -- the factored design ----------------------------------------------------------------------------------------------


def factored(design: Design, kind: Any, factors: PartialFactors, location: str = "") -> Design:
    """Return the design with its design values and a table of the factored numbers.

    Weight, forces (with a footing's load) and surcharge are each unfavourable or favourable as a whole, in the
    combination with the lowest closed form; unfavourable where a kind has none. Water is permanent and unfavourable.
    The seismic force is that of the unfactored weight. Bolts are not factored: their forces are design values.

    Raises
    ------
    DesignError
        E112 a curved law with two factors.
    """
    if abs(factors.tan_phi - factors.c) > _EQUAL_FACTORS and any(
        strength.law is not None for strength in design.joint_strengths
    ):
        message = "a curved strength has no c and phi of its own: its partial factors tan_phi and c must be equal"
        raise DesignError([Fault("E112", message, location, "Eurocode 7 has 1.25 for both.")])
    rules = design.rules or (Rule("fos", ">=", 1.0),)
    candidates = [
        (_closed_form_factor(factored_design, kind), factored_design)
        for factored_design in (
            _design_with_factors(design, factors, *combination)
            for combination in _combinations(design, factors)
        )
    ]
    return replace(min(candidates, key=lambda pair: pair[0])[1], rules=rules)


def _combinations(design: Design, factors: PartialFactors) -> Iterator[tuple[float, float, float]]:
    """Yield combinations of the factors of weight, forces and surcharge, the unfavourable ones first."""
    permanent = (factors.permanent_unfavourable, factors.permanent_favourable)
    variable = (factors.variable_unfavourable, factors.variable_favourable)
    forces = (
        (variable if factors.forces == "variable" else permanent)
        if design.forces or _footing_load_kn(design)
        else (1.0,)
    )
    surcharge = variable if _surcharges_kpa(design) else (1.0,)
    combinations = product(
        dict.fromkeys(permanent), dict.fromkeys(forces), dict.fromkeys(surcharge)
    )
    yield from combinations if design.HAS_CLOSED_FORM else [next(combinations)]


def _closed_form_factor(design: Design, kind: Any) -> float:
    if not design.HAS_CLOSED_FORM:
        return 0.0
    try:
        solution = kind.closed_form(design, None)
    except GeometryError:
        return math.inf  # the error is reported when the design is analysed
    return math.inf if solution.status == "no_driving_force" else float(solution.factor or 0.0)


def _design_with_factors(
    design: Design,
    factors: PartialFactors,
    weight_factor: float,
    force_factor: float,
    surcharge_factor: float,
) -> Design:
    unit_weight_factor, water_factor = (
        weight_factor * factors.unit_weight,
        factors.permanent_unfavourable,
    )
    factor_of_action: dict[Action, float] = {
        "weight": unit_weight_factor,
        "water": water_factor,
        "force": force_factor,
        "surcharge": surcharge_factor,
    }
    load, surcharges = _footing_load_kn(design), _surcharges_kpa(design)
    seismic = replace(design.seismic, coefficient=design.seismic.coefficient / unit_weight_factor)
    factored_design: Design = replace(
        _with_factored_actions(
            design.each_strength(lambda strength: _design_strength(strength, factors)),
            factor_of_action,
        ),
        seismic=seismic,
    )
    rows = [*_strength_rows(design, factored_design, factors)]
    if design.rock.unit_weight_kn_m3:  # a footing may stand on rock without weight
        rows.append(
            FactoredNumber(
                "unit weight",
                design.rock.unit_weight_kn_m3,
                unit_weight_factor,
                factored_design.rock.unit_weight_kn_m3,
                "kN/m³",
            )
        )
    if design.is_wet:
        rows.append(
            FactoredNumber(
                "unit weight of water, and its pressures",
                design.water_unit_weight_kn_m3,
                water_factor,
                factored_design.water_unit_weight_kn_m3,
                "kN/m³",
            )
        )
    for k, (force, factored_force) in enumerate(
        zip(design.forces, factored_design.forces, strict=True), 1
    ):
        rows.append(
            FactoredNumber(
                f"force {k}, {factors.forces}",
                math.hypot(*force.components_kn),
                force_factor,
                math.hypot(*factored_force.components_kn),
                "kN",
            )
        )
    if load:
        rows.append(
            FactoredNumber(
                f"{design.kind} load, {factors.forces}",
                load,
                force_factor,
                load * force_factor,
                "kN",
            )
        )
    for name, pressure in surcharges.items():
        label = f"surcharge{f' on {name}' if name else ''}, variable"
        rows.append(
            FactoredNumber(label, pressure, surcharge_factor, pressure * surcharge_factor, "kPa")
        )
    if design.seismic.coefficient:
        coefficient = design.seismic.coefficient
        rows.append(
            FactoredNumber(
                "seismic coefficient, of the weight unfactored", coefficient, 1.0, coefficient, ""
            )
        )
    analysis = replace(factored_design.analysis, partial=replace(factors, table=tuple(rows)))
    return replace(factored_design, analysis=analysis)


def _actions(record: type) -> dict[str, Action]:
    """Return the attributes of a record that are actions, with the kind of action."""
    return {
        name: action for actions in listed(record, "ACTIONS") for name, action in actions.items()
    }


def _with_factored_actions(value: Any, factor_of_action: Mapping[Action, float]) -> Any:
    """Return a record, or a tuple of records, with its actions multiplied by their factors."""
    if isinstance(value, tuple):
        entries = tuple(_with_factored_actions(entry, factor_of_action) for entry in value)
        return (
            entries
            if any(new is not old for new, old in zip(entries, value, strict=True))
            else value
        )
    if not is_dataclass(value) or isinstance(value, type):
        return value
    actions = _actions(type(value))
    changed = {
        name: _scaled(getattr(value, name), factor_of_action[action])
        for name, action in actions.items()
    }
    for attribute in fields(value):
        if attribute.compare and attribute.name not in actions:
            old = getattr(value, attribute.name)
            new = _with_factored_actions(old, factor_of_action)
            changed |= {} if new is old else {attribute.name: new}
    return replace(value, **changed) if changed else value


def _footing_load_kn(design: Design) -> float:
    """Return the load of a footing in kN; 0 for other kinds."""
    return float(
        sum(
            getattr(design, name)
            for name, action in _actions(type(design)).items()
            if action == "force"
        )
    )


def _surcharges_kpa(design: Design) -> dict[str, float]:
    """Return the surcharges in kPa by the name of the block; on the upper slope the name is empty."""
    values = [
        getattr(design, name)
        for name, action in _actions(type(design)).items()
        if action == "surcharge"
    ]
    return {
        name: pressure
        for value in values
        if value
        for name, pressure in (value if isinstance(value, tuple) else (("", value),))
    }


def _design_strength(strength: Strength, factors: PartialFactors) -> Strength:
    """Return the design strength: c and tan φ divided by their factors, or the shear strength of a curved law."""
    phi_factor, cohesion_factor = (
        factors.tan_phi * factors.resistance,
        factors.c * factors.resistance,
    )
    dilation = _angle(strength.dilation_deg, phi_factor)
    characteristic_residual = strength.residual
    residual = (
        None
        if characteristic_residual is None
        else Residual(
            characteristic_residual.cohesion_kpa / cohesion_factor,
            _angle(characteristic_residual.friction_angle_deg, phi_factor),
        )
    )
    if strength.law is not None:
        return replace(
            Strength.by_law(
                Reduced(strength.law, phi_factor), dilation, strength.tension_kpa / cohesion_factor
            ),
            residual=residual,
        )
    return Strength(
        strength.cohesion_kpa / cohesion_factor,
        _angle(strength.friction_angle_deg, phi_factor),
        dilation,
        strength.tension_kpa / cohesion_factor,
        residual=residual,
    )


def _angle(degrees: float, factor: float) -> float:
    return (
        degrees
        if factor == 1.0
        else math.degrees(math.atan(math.tan(math.radians(degrees)) / factor))
    )


def _strength_rows(
    design: Design, factored_design: Design, factors: PartialFactors
) -> Iterator[FactoredNumber]:
    pairs = list(
        dict.fromkeys(zip(design.joint_strengths, factored_design.joint_strengths, strict=True))
    )
    for k, (characteristic, factored_strength) in enumerate(pairs, 1):
        suffix = f", strength {k}" if len(pairs) > 1 else ""
        phi_factor, cohesion_factor = (
            factors.tan_phi * factors.resistance,
            factors.c * factors.resistance,
        )
        if characteristic.law is not None:
            yield FactoredNumber(f"strength by its law{suffix}", None, phi_factor, None, "")
            continue
        yield FactoredNumber(
            f"c{suffix}",
            characteristic.cohesion_kpa,
            cohesion_factor,
            factored_strength.cohesion_kpa,
            "kPa",
            True,
        )
        tangent, lower = (
            math.tan(math.radians(strength.friction_angle_deg))
            for strength in (characteristic, factored_strength)
        )
        yield FactoredNumber(f"tan φ{suffix}", tangent, phi_factor, lower, "", True)
        yield FactoredNumber(
            f"φ{suffix}",
            characteristic.friction_angle_deg,
            None,
            factored_strength.friction_angle_deg,
            "°",
        )


def _scaled(value: Any, factor: float) -> Any:
    """Return a number, or the numbers in nested tuples, multiplied by a factor; anything else is unchanged."""
    if isinstance(value, tuple):
        return tuple(_scaled(entry, factor) for entry in value)
    return value * factor if isinstance(value, int | float) else value
