"""The paper's bitmap of U₁ (30 s in 1991); timed by `pytest tests/benchmark --benchmark-enable`."""

from __future__ import annotations

import numpy as np

from sumo_reactive.driver.field.valley_map import CELLS, MAP_SIDE_M, valley_bitmap
from sumo_reactive.driver.parameters import USUAL

CELL = MAP_SIDE_M / CELLS


def test_a_bitmap_of_500_by_500_cells(benchmark):
    arc = np.arange(0.0, MAP_SIDE_M, 0.5 * CELL)
    x, y = arc, 0.5 * MAP_SIDE_M + 8.0 * np.sin(0.05 * arc)
    static = np.column_stack((x[::20], y[::20] + 6.0))
    bitmap = benchmark(valley_bitmap, np.column_stack((x, y)), static, 0.0, 0.0, CELL, USUAL)
    assert bitmap.shape == (500, 500)
    assert bitmap.min() == 0.0
