"""U₁ as bitmaps, the paper's way: taxicab distances on a 500 × 500 grid over W (F&L 1991, §3.3.1, §4)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.parameters import Parameters

MAP_SIDE_M = 100.0
"""Side l of the world window that a bitmap covers; a cell is l/500 = 0.2 m (F&L 1991, §4)."""

MAP_MARGIN_M = 20.0
"""A new bitmap is drawn when the ego comes this near to the rim."""


CELLS = 500
"""Cells along each side of a bitmap (F&L 1991, §4)."""

MAP_SAMPLE_SHARE = 0.25
"""Distance between the points of C that are drawn, in cells."""


@dataclass(frozen=True, eq=False)
class ValleyMap:
    """One bitmap of U_p for each control point, shape (k, CELLS, CELLS), indexed [k, row y, column x].

    Cell (0, 0) is centred on (`x0`, `y0`) m; `cell` is the resolution l/500, m. Control points: F, R.
    """

    bitmaps: Floats
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
def taxicab_transform(start: Floats, cell: float) -> Floats:
    """Least of each cell's `start` (m) and any other's plus the way there in |Δx| + |Δy|, m: two exact raster sweeps."""
    rows, columns = start.shape
    distance = start.copy()
    for i in range(rows):
        for j in range(columns):
            best = distance[i, j]
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
def _drawn(x: Floats, y: Floats, x0: float, y0: float, cell: float, cells: int) -> Floats:
    """Taxicab distance (m) of the four cells around each point to the nearest of the points; infinite elsewhere."""
    image = np.full((cells, cells), np.inf)
    for k in range(len(x)):
        row, column = math.floor((y[k] - y0) / cell), math.floor((x[k] - x0) / cell)
        for i in range(max(row, 0), min(row + 2, cells)):
            for j in range(max(column, 0), min(column + 2, cells)):
                image[i, j] = min(image[i, j], abs(x0 + j * cell - x[k]) + abs(y0 + i * cell - y[k]))
    return image


@kernel
def map_potential(bitmap: Floats, x: float, y: float, x0: float, y0: float, cell: float) -> float:
    """U_p at (x, y), bilinear between the centres of four cells; the rim's value outside.

    Reading: taken from the one cell that holds (x, y), U_p would not tell 0.2 m apart, and the car would weave in that
    width (F&L 1991, §4 names the coarse discretisation of W as open).
    """
    v = min(max((y - y0) / cell, 0.0), bitmap.shape[0] - 1.0)
    u = min(max((x - x0) / cell, 0.0), bitmap.shape[1] - 1.0)
    i, j = min(int(v), bitmap.shape[0] - 2), min(int(u), bitmap.shape[1] - 2)
    f, g = u - j, v - i
    near = bitmap[i, j] + f * (bitmap[i, j + 1] - bitmap[i, j])
    far = bitmap[i + 1, j] + f * (bitmap[i + 1, j + 1] - bitmap[i + 1, j])
    return float(near + g * (far - near))


def valley_bitmap(line: Floats, static: Floats, x0: float, y0: float, cell: float, parameters: Parameters) -> Floats:
    """U_p = α·d₁(p, C) + β·d₁(p, C) / min_o d₁(p, o) over the grid, shape (CELLS, CELLS) (F&L 1991, §3.3.1).

    The samples of C, the `line` (n, 2), m, must lie no farther apart than a cell; `static` (k, 2) are points of O_S.
    """
    distance = taxicab_transform(_drawn(line[:, 0], line[:, 1], x0, y0, cell, CELLS), cell)
    attraction: Floats = parameters.valley_attraction * distance
    if not len(static):
        return attraction
    to_static = taxicab_transform(_drawn(static[:, 0], static[:, 1], x0, y0, cell, CELLS), cell)
    result: Floats = attraction + parameters.valley_repulsion * distance / np.maximum(to_static, cell)
    return result


@kernel
def rear_trace(x: Floats, y: Floats, heading: float, wheelbase: float) -> Floats:
    """Return (n, 2): the curve C_R that the rear axle traces while the front axle follows the samples, m.

    `heading` is the body's at the first sample. The rear axle is drawn along the body (F&L 1991, §3.1).
    """
    out = np.empty((len(x), 2))
    out[0, 0], out[0, 1] = x[0] - wheelbase * math.cos(heading), y[0] - wheelbase * math.sin(heading)
    for i in range(1, len(x)):
        dx, dy = x[i] - out[i - 1, 0], y[i] - out[i - 1, 1]
        away = math.hypot(dx, dy)
        out[i, 0], out[i, 1] = x[i] - wheelbase * dx / away, y[i] - wheelbase * dy / away
    return out


def valley_map(
    curve: Curve, s: float, heading: float, wheelbase: float, static: Floats, parameters: Parameters
) -> ValleyMap:
    """Return U₁ of F and R in a window of `MAP_SIDE_M` around the place at `s` of C; `heading` is the car's there."""
    cell = MAP_SIDE_M / CELLS
    x, y, _ = curve.at(s)
    x0, y0 = x - 0.5 * MAP_SIDE_M, y - 0.5 * MAP_SIDE_M
    arc = np.arange(max(0.0, s - wheelbase), min(curve.length, s + MAP_SIDE_M), MAP_SAMPLE_SHARE * cell)
    samples = np.arange(len(curve.x)) * curve.step
    fx, fy = np.interp(arc, samples, curve.x), np.interp(arc, samples, curve.y)
    rear = rear_trace(fx, fy, heading, wheelbase)
    traces = (np.column_stack((fx, fy)), rear)
    bitmaps = np.stack([valley_bitmap(trace, static, x0, y0, cell, parameters) for trace in traces])
    return ValleyMap(bitmaps, x0, y0, cell)
