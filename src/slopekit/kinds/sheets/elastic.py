"""The block ELASTIC of the sheet: elastic blocks beside the rigid ones."""

import math
from collections.abc import Callable
from operator import itemgetter

from slopekit.core.sheet import Column, Entry, Table, factor_text
from slopekit.elastic.outcome import ElasticBlocks, OnElasticJoint
from slopekit.kinds.words import size_number
from slopekit.result import Result


def elastic_entries(result: Result) -> list[Entry]:
    """What the deformation of the rock does, in a few lines; none without elastic blocks."""
    found = result.elastic
    if found is None:
        return []
    return [_limit(found), *_bracket(found), _rock(found), _joints(found), _moves(found), _size(result, found)]


def _limit(found: ElasticBlocks) -> str:
    if found.limit is None:
        return "no limit: the blocks stand without strength"
    factor, rigid = factor_text(found.limit).strip(), factor_text(found.rigid_limit).strip()
    at = f"at F = {found.factor:.4g}"
    if found.opened_share == 0.0:
        return f"{factor}  limit of elastic blocks, that of rigid ones: no contact is pulled open {at}"
    if found.lost_share == found.rigid_lost_share == 0.0:
        also = f" (rigid {_percent(found.rigid_opened_share)})" if found.rigid_opened_share else ""
        words = f"{_percent(found.opened_share)} of the contact area{also} is pulled open {at}"
        return f"{factor}  limit of elastic blocks, that of rigid ones: {words}, where there is no cohesion to lose"
    lost = f"without the cohesion of {_percent(found.lost_share)} of the contact area, pulled open {at}"
    also = f" without {_percent(found.rigid_lost_share)}" if found.rigid_lost_share else ""
    return f"{factor}  limit of elastic blocks, {lost}; rigid {rigid}{also}"


def _percent(share: float) -> str:
    return f"{share * 100.0:.2g} %"


def _bracket(found: ElasticBlocks) -> list[str]:
    if found.bracket is None:
        return []
    low, high = found.bracket
    last = "" if found.limit_at_bracket is None else f"; rigid without what is open there {found.limit_at_bracket:.5f}"
    if found.gave_up:
        return [f"{low:.5f}  elastic blocks come to rest there; gave up at {high:.5f}{last}"]
    return [f"{low:.5f} .. {high:.5f}  elastic blocks come to rest up to the first, not at the second{last}"]


def _rock(found: ElasticBlocks) -> str:
    taken = f" ({' and '.join(found.taken)} taken, not given)" if found.taken else ""
    rock = f"modulus {found.modulus_kpa * 1e-6:.4g} GPa, Poisson's ratio {found.poisson:.3g}{taken}"
    return f"{rock}; {found.bedrock} bedrock"


def _joints(found: ElasticBlocks) -> Table[tuple[str, OnElasticJoint]]:
    """Normal tractions of each joint."""
    Row = tuple[str, OnElasticJoint]

    def end(which: str, k: int) -> Callable[[Row], float]:
        return lambda row: float(getattr(row[1], which)[k])

    def kpa(value: float) -> str:
        return size_number(float(f"{value:.4g}") if abs(value) >= 0.05 else 0.0)

    columns: list[Column[Row]] = [
        Column("on", itemgetter(0), "joint"),
        Column("σ' from", end("elastic_kpa", 0), "elastic_from_kpa", "kPa", kpa),
        Column("to", end("elastic_kpa", 1), "elastic_to_kpa", "kPa", kpa),
        Column("rigid from", end("rigid_kpa", 0), "rigid_from_kpa", "kPa", kpa),
        Column("to", end("rigid_kpa", 1), "rigid_to_kpa", "kPa", kpa),
        Column("open", lambda row: row[1].opened_share * 100.0, "opened_percent", "%", lambda share: f"{share:.2g}"),
    ]
    rows = list(found.joints.items())
    said = "  ".join(
        f"σ' {name} {kpa(one.elastic_kpa[0])}..{kpa(one.elastic_kpa[1])} kPa "
        f"(rigid {kpa(one.rigid_kpa[0])}..{kpa(one.rigid_kpa[1])})" for name, one in rows[:6]
    )  # fmt: skip
    return Table(columns, rows, said=said)


def _moves(found: ElasticBlocks) -> str:
    sizes = [math.sqrt(float(one @ one)) * 1e3 for one in (found.displacement_m, found.rigid_displacement_m)]
    who = "" if found.block is None else f" of {found.block}"
    elastic, rigid = (size_number(float(f"{size:.3g}")) for size in sizes)
    return f"mean displacement{who} at F = {found.factor:.4g}: {elastic} mm, rigid {rigid} mm"


def _size(result: Result, found: ElasticBlocks) -> str:
    seconds = result.timing_s.get("elastic")
    took = "" if seconds is None else f"; {seconds:.2g} s"
    return (
        f"{found.cells} elements of order {found.order}, edges up to {size_number(float(f'{found.edge_m:.3g}'))} m, "
        f"{found.node_pairs} node pairs, {found.unknowns} unknowns, {found.steps} Newton steps{took}"
    )
