"""Table 7's row of elastic blocks: speed against error with the edge of the elements and their order.

python -m benchmarks.elastic_speed [HALVED]: the wedge of Sheng et al. (2023), Table 4, k_t 1e5 kN/m³, 20 GPa, rigid
bedrock; edges of half the longest of the wedge, halved HALVED times [3]; CPU seconds of the elastic blocks alone. Then
the rows that are held against the paper's 305 s, and the state at F = 1 with the limit once the blocks are condensed.
"""

import sys
import time
from dataclasses import replace
from unittest.mock import patch

import numpy as np

import slopekit as sk
from slopekit.elastic.outcome import ElasticBlocks
from slopekit.elastic.rest import RestSearch
from slopekit.kinds import elastic, kind_of
from slopekit.result import Result

PAPER_S, COARSE_S, STATE_S = 305.0, 3.0, 1.0  # Table 7; what we may take


def main(halved: int = 3) -> None:
    """Print a line for each edge and order, then how the quickest that is near the finest compares with the paper."""
    plain = sk.wedge(("45/115", "45/245"), shear_stiffness=1e5)
    corners = np.array([*plain.to_dict()["geometry"]["corners_m"].values()])
    longest = max(float(np.linalg.norm(a - b)) for a in corners for b in corners)
    warm = sk.wedge(("45/115", "45/245"), shear_stiffness=1e5, edge=longest / 2.0, elastic=True)
    assert warm.elastic is not None  # what it loads is no part of the times
    rows = []
    for edge in (longest / 2.0**k for k in range(1, halved + 2)):
        for order in (1, 2):
            design = plain.design
            analysis = replace(design.analysis, elastic_edge_m=edge * (1.0 + 1e-9))
            design = replace(design, analysis=analysis)
            rows.append((edge, order, *timed(replace(plain, design=design), order)))
    finest = rows[-1][2]
    print(
        "edge m  order  elements  pairs  unknowns  opened    limit    off finest  moved mm    σ' J1 kPa     CPU s"
    )
    for edge, order, found, took in rows:
        moved = 1e3 * float(np.linalg.norm(found.displacement_m))
        (low, high), mesh = found.joints["J1"].elastic_kpa, found.mesh
        print(
            f"{edge:6.1f}  {'P' + str(order):>5s}  {mesh.cells:8d}  {mesh.node_pairs:5d}  {mesh.unknowns:8d}  "
            f"{found.opened_share:6.2%}  {found.limit:.5f}  {found.limit / finest.limit - 1.0:10.1e}  {moved:8.4f}  "
            f"{low:6.1f} .. {high:5.1f}  {took:8.3f}"
        )
    print(f"the paper's PFE-IE {PAPER_S:.0f} s")
    for edge, _, _, took in rows[5:6]:  # an eighth of the longest edge, order two
        _said(f"edge: auto is {edge:.1f} m in P2, rigid bedrock", took, COARSE_S)
    design = plain.design
    scene = elastic.scene_of_one(design, kind_of(design).cut(design))
    began = time.process_time()
    state = RestSearch(scene.model, scene.stiffness).rest(1.0)
    scene.limit_without(state.parted)
    _said("state at F = 1 and limit without what is open", time.process_time() - began, STATE_S)


def timed(plain: Result, order: int = elastic.ORDER) -> tuple[ElasticBlocks, float]:
    """The elastic blocks of a result with elements of an order, and the CPU seconds that they take."""
    began = time.process_time()
    with patch.object(elastic, "ORDER", order):
        found = elastic.with_elastic(kind_of(plain.design), plain).elastic
    took = time.process_time() - began
    assert found is not None
    assert found.limit is not None
    return found, took


def _said(what: str, took: float, most: float) -> None:
    print(f"{what}: {took:.2f} s, {'within' if took <= most else 'NOT within'} {most:.0f} s")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
