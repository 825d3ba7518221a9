"""What partial factors have made of a design: characteristic, factor, design value."""

from operator import attrgetter

from slopekit.core.sheet import Column, Section, Table
from slopekit.design.parts import FactoredNumber, PartialFactors


def partial_factors(given: PartialFactors) -> Section:
    """Whose factors they are, what they have made, and how to read the factor of safety."""
    columns: list[Column[FactoredNumber]] = [
        Column("of", attrgetter("what"), "what", width=-47),
        Column("characteristic", attrgetter("characteristic"), "characteristic", show=".5g", width=14),
        Column("factor", _factor, "factor", width=9),
        Column("design", attrgetter("design"), "design", show=".5g", width=10),
        Column(" unit", attrgetter("unit"), "unit", width=-1, about=" {}"),
    ]
    said = given.called + (f" ({given.source})" if given.source else "")
    end = "all numbers above are design values, and FoS is the over-design factor: 1 is enough"
    return Section("FACTORED", [f"{said}: {end}", Table(columns, given.table)])


def _factor(row: FactoredNumber) -> str:
    return "" if row.factor is None else f"{'/' if row.divided else 'x'} {row.factor:.4g}"
