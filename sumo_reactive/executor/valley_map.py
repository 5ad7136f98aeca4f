"""U₁ as bitmaps, the paper's way: taxicab distances on a 500 × 500 grid over W (F&L 1991, §3.3.1, §4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.compilation import kernel
from sumo_reactive.parameters import VALLEY_ATTRACTION, VALLEY_REPULSION

Array = NDArray[np.float64]

CELLS = 500
"""Cells along each side of a bitmap (F&L 1991, §4)."""


@dataclass(frozen=True, eq=False)
class ValleyMap:
    """One bitmap of U_p for each control point, shape (k, CELLS, CELLS), indexed [k, row y, column x].

    Cell (0, 0) is centred on (`x0`, `y0`) m; `cell` is the resolution l/500, m. Control points: F, R.
    """

    bitmaps: Array
    x0: float
    y0: float
    cell: float

    def holds(self, x: float, y: float, margin: float) -> bool:
        """Whether (x, y) lies inside, at least `margin` m from the rim."""
        side = (CELLS - 1) * self.cell
        return self.x0 + margin <= x <= self.x0 + side - margin and self.y0 + margin <= y <= self.y0 + side - margin


NO_MAP = ValleyMap(np.empty((0, 1, 1)), 0.0, 0.0, 1.0)
"""Stands for exact distances."""


@kernel
def taxicab_transform(seeds: Array, cell: float) -> Array:
    """Distance from each cell to the nearest seed (value > 0) in |Δx| + |Δy|, m: two exact raster sweeps."""
    rows, columns = seeds.shape
    distance = np.empty((rows, columns))
    for i in range(rows):
        for j in range(columns):
            best = 0.0 if seeds[i, j] > 0.0 else np.inf
            if i > 0:
                best = min(best, distance[i - 1, j] + cell)
            if j > 0:
                best = min(best, distance[i, j - 1] + cell)
            distance[i, j] = best
    for i in range(rows - 1, -1, -1):
        for j in range(columns - 1, -1, -1):
            best = distance[i, j]
            if i < rows - 1:
                best = min(best, distance[i + 1, j] + cell)
            if j < columns - 1:
                best = min(best, distance[i, j + 1] + cell)
            distance[i, j] = best
    return distance


@kernel
def _drawn(x: Array, y: Array, x0: float, y0: float, cell: float, cells: int) -> Array:
    image = np.zeros((cells, cells))
    for k in range(len(x)):
        i, j = int(round((y[k] - y0) / cell)), int(round((x[k] - x0) / cell))
        if 0 <= i < cells and 0 <= j < cells:
            image[i, j] = 1.0
    return image


@kernel
def map_potential(bitmap: Array, x: float, y: float, x0: float, y0: float, cell: float) -> float:
    """U_p of the cell that holds (x, y); the rim's value outside."""
    i = min(max(int(round((y - y0) / cell)), 0), bitmap.shape[0] - 1)
    j = min(max(int(round((x - x0) / cell)), 0), bitmap.shape[1] - 1)
    return bitmap[i, j]


def valley_bitmap(curve_x: Array, curve_y: Array, static: Array, x0: float, y0: float, cell: float) -> Array:
    """U_p = α·d₁(p, C) + β·d₁(p, C) / min_o d₁(p, o) over the grid, shape (CELLS, CELLS) (F&L 1991, §3.3.1).

    The curve's samples (m) must lie no farther apart than a cell; `static` (k, 2) are points of O_S.
    """
    distance = taxicab_transform(_drawn(curve_x, curve_y, x0, y0, cell, CELLS), cell)
    if not len(static):
        return VALLEY_ATTRACTION * distance
    to_static = taxicab_transform(_drawn(static[:, 0], static[:, 1], x0, y0, cell, CELLS), cell)
    result: Array = VALLEY_ATTRACTION * distance + VALLEY_REPULSION * distance / np.maximum(to_static, cell)
    return result
