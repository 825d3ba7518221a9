"""Goodman & Bray's columns: lengths from their formulas, and the same contacts found from the outlines alone."""

import math
import time

import numpy as np
import pytest

from slopekit.geometry.sections.columns import BASE, RISER, SIDE, column_assembly, column_outlines
from slopekit.geometry.sections.section_blocks import section_assembly

#: Goodman & Bray 1976: 16 columns, 10 m wide, dipping 60°, steps of 1 m
HEIGHTS = np.array([4.0, 8, 12, 16, 20, 24, 28, 32, 36, 40, 34, 28, 22, 16, 10, 4])


def test_goodman_bray() -> None:
    """Corner n at (n - 1)(10 e_x + 1 e_y); sides touch from the higher base to the lower top (their L and M)."""
    columns = column_assembly(60.0, 10.0, HEIGHTS, 1.0)
    e_x = np.array([math.cos(math.pi / 6), 0.0, math.sin(math.pi / 6)])
    e_y = np.array([-math.sin(math.pi / 6), 0.0, math.cos(math.pi / 6)])
    patches, number = columns.patches, np.arange(16.0)
    corner = number[:, None] * (10.0 * e_x + e_y)
    assert columns.volumes == pytest.approx(10.0 * HEIGHTS)
    assert columns.centroids == pytest.approx(corner + 5.0 * e_x + HEIGHTS[:, None] / 2.0 * e_y)
    base, side, riser = (patches.joint == joint for joint in (BASE, SIDE, RISER))
    assert patches.areas[base].tolist() == [10.0] * 16
    assert patches.normals[base] == pytest.approx(np.tile(e_y, (16, 1)))
    assert patches.centroids[base] == pytest.approx(corner + 5.0 * e_x)
    # up to column 10 the lower column ends the contact, above it the upper one
    expected = [
        HEIGHTS[n] - 1.0 if HEIGHTS[n] <= HEIGHTS[n + 1] + 1.0 else HEIGHTS[n + 1]
        for n in range(15)
    ]
    assert patches.areas[side] == pytest.approx(expected)
    assert (patches.plus[side] - patches.minus[side] == 1).all()
    assert patches.normals[side] == pytest.approx(np.tile(e_x, (15, 1)))
    assert patches.areas[riser] == pytest.approx(np.ones(15))
    assert patches.normals[riser] == pytest.approx(np.tile(-e_x, (15, 1)))
    assert (patches.plus[riser].tolist(), set(patches.minus[riser])) == (list(range(15)), {-1})
    ends = patches.corners.reshape(-1, 2, 3)
    assert np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)) == pytest.approx(patches.areas)
    assert patches.centroids == pytest.approx(ends.mean(axis=1))


@pytest.mark.parametrize("step", [1.0, 0.0, -0.75, 6.0])
def test_the_outlines_have_the_same_contacts(step) -> None:
    """Columns and bedrock as polygons through the search of contacts: steps up, none, down, higher than a column."""
    outlines, bedrock = column_outlines(65.0, 3.0, HEIGHTS, step)
    found = section_assembly([*outlines, bedrock], np.arange(17) == 16, 2.0)
    exact = column_assembly(65.0, 3.0, HEIGHTS, step, thickness=2.0)
    assert len(found.overlaps) == len(found.gaps) == 0
    minus = np.where(found.assembly.patches.minus == 16, -1, found.assembly.patches.minus)
    # a base and the riser behind it are two contacts with the bedrock: told apart by their normals
    rows = []
    for patches, below in ((found.assembly.patches, minus), (exact.patches, exact.patches.minus)):
        table = np.column_stack(
            [patches.plus, below, patches.normals, patches.areas, patches.centroids]
        )
        rows.append(table[np.lexsort(np.round(table[:, [5, 2, 1, 0]], 6).T)])
    assert rows[0] == pytest.approx(rows[1], abs=1e-9)
    assert found.assembly.volumes[:16] == pytest.approx(exact.volumes)
    assert found.assembly.centroids[:16] == pytest.approx(exact.centroids)


def test_rows_are_repeated_along_the_strike() -> None:
    one, three = (
        column_assembly(60.0, 10.0, HEIGHTS[:4], 1.0, thickness=2.0, rows=rows) for rows in (1, 3)
    )
    assert (len(three), len(three.patches)) == (3 * len(one), 3 * len(one.patches))
    assert three.patches.areas.sum() == pytest.approx(3.0 * one.patches.areas.sum())
    last = slice(2 * len(one.patches), None)
    assert (three.patches.plus[last] - one.patches.plus).tolist() == [8] * len(one.patches)
    assert (three.patches.minus[last] >= 8).tolist() == (one.patches.minus >= 0).tolist()
    assert three.centroids[8:] == pytest.approx(one.centroids + np.array([0.0, 4.0, 0.0]))


def test_upright_columns_on_a_level_base() -> None:
    columns = column_assembly(90.0, 1.0, np.array([2.0, 3.0]), 0.0)
    assert columns.patches.normals.tolist() == [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    assert columns.patches.areas.tolist() == [1.0, 1.0, 2.0]


def test_ten_thousand_columns() -> None:
    began = time.perf_counter()
    columns = column_assembly(60.0, 10.0, np.full(10_000, 30.0), 1.0)
    assert time.perf_counter() - began < 1.0  # 10 ms alone
    assert columns.patches.areas.sum() == pytest.approx(1e5 + 9999 * (29.0 + 1.0))
