"""The block ELASTIC of the sheet: elastic blocks beside the rigid ones."""

import math
from collections.abc import Callable
from operator import itemgetter

from slopekit.core.sheet import Column, Entry, Table, factor_text
from slopekit.elastic.outcome import ElasticBlocks, OnElasticJoint
from slopekit.kinds.words import short
from slopekit.result import Result

_MOST_JOINTS = 6  # joints of the sheet


def elastic_entries(result: Result, blocks: ElasticBlocks) -> list[Entry]:
    """Return the entries on the effect of rock deformation."""
    return [
        _limit(blocks),
        _rock(blocks),
        _joints(result, blocks),
        _moves(blocks),
        _size(result, blocks),
    ]


def _limit(blocks: ElasticBlocks) -> str:
    if blocks.limit is None and blocks.rigid_limit is not None:
        lost = f"without the cohesion of {_percent(blocks.lost_share)} of the contact area, pulled open"
        reason = (
            f"that {lost} at F = {blocks.factor:.4g}, was not found; rigid {blocks.rigid_limit:.4f}"
        )
        return f"no limit: {reason}"
    if blocks.limit is None:
        return "no limit: the blocks stand without strength"
    factor, rigid = factor_text(blocks.limit).strip(), factor_text(blocks.rigid_limit).strip()
    factor_text_at = f"at F = {blocks.factor:.4g}"
    if blocks.opened_share == blocks.rigid_opened_share == 0.0:
        return f"{factor}  limit of elastic blocks, that of rigid ones: no contact is pulled open {factor_text_at}"
    if blocks.lost_share == blocks.rigid_lost_share == 0.0:
        rigid_note = (
            f" (rigid {_percent(blocks.rigid_opened_share)})" if blocks.rigid_opened_share else ""
        )
        words = f"{_percent(blocks.opened_share)} of the contact area{rigid_note} is pulled open {factor_text_at}"
        return f"{factor}  limit of elastic blocks, that of rigid ones: {words}, where there is no cohesion to lose"
    lost = f"without the cohesion of {_percent(blocks.lost_share)} of the contact area, pulled open {factor_text_at}"
    rigid_note = (
        f" without that of {_percent(blocks.rigid_lost_share)}" if blocks.rigid_lost_share else ""
    )
    return f"{factor}  limit of elastic blocks, {lost}; rigid {rigid}{rigid_note}"


def _percent(share: float) -> str:
    return f"{share * 100.0:.2g} %"


def _rock(blocks: ElasticBlocks) -> str:
    defaults_note = (
        f" ({' and '.join(blocks.mesh.taken)} taken, not given)" if blocks.mesh.taken else ""
    )
    rock = f"modulus {blocks.modulus_kpa * 1e-6:.4g} GPa, Poisson's ratio {blocks.poisson:.3g}{defaults_note}"
    return f"{rock}; rigid bedrock"


#: The name of a joint and its state on elastic blocks.
_JointRow = tuple[str, OnElasticJoint]


def _joints(result: Result, blocks: ElasticBlocks) -> Table[tuple[str, OnElasticJoint]]:
    """Normal tractions of each joint."""

    def end(attribute: str, k: int) -> Callable[[_JointRow], float]:
        return lambda row: float(getattr(row[1], attribute)[k])

    def kpa(value: float) -> str:
        return short(value if abs(value) >= 0.05 else 0.0)

    columns: list[Column[_JointRow]] = [
        Column("on (kPa, %)", itemgetter(0), "joint", show=result.design.in_own_names, width=-14),
        Column("σ' from", end("elastic_kpa", 0), "elastic_from_kpa", "kPa", kpa, 14),
        Column("to", end("elastic_kpa", 1), "elastic_to_kpa", "kPa", kpa, 12),
        Column("rigid from", end("rigid_kpa", 0), "rigid_from_kpa", "kPa", kpa, 12),
        Column("to", end("rigid_kpa", 1), "rigid_to_kpa", "kPa", kpa, 12),
        Column("open", lambda row: row[1].opened_share * 100.0, "opened_percent", "%", ".2g", 10),
    ]
    return Table(columns, list(blocks.joints.items()), ends=(_MOST_JOINTS, 0), rest="...")


def _moves(blocks: ElasticBlocks) -> str:
    sizes = [
        math.sqrt(float(displacement @ displacement)) * 1e3
        for displacement in (blocks.displacement_m, blocks.rigid_displacement_m)
    ]
    block_note = "" if blocks.block is None else f" of {blocks.block}"
    elastic, rigid = (short(size) for size in sizes)
    return (
        f"mean displacement{block_note} at F = {blocks.factor:.4g}: {elastic} mm, rigid {rigid} mm"
    )


def _size(result: Result, blocks: ElasticBlocks) -> str:
    seconds = result.timing_s.get("elastic")
    duration = "" if seconds is None else f"; {seconds:.2g} s"
    return (
        f"{blocks.mesh.cells} elements of order {blocks.mesh.order}, edges up to {short(blocks.mesh.edge_m)} m, "
        f"{blocks.mesh.node_pairs} node pairs, {blocks.mesh.unknowns} unknowns, {blocks.steps} Newton steps{duration}"
    )
