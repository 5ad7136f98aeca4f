"""Smoothing of a sampled line: least curvature rate plus deviation, loosened where the car could not turn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded
from scipy.ndimage import maximum_filter1d

from sumo_reactive.driver.geometry.polyline import Points
from sumo_reactive.driver.parameters import (
    COMFORT_DEVIATION_M,
    SMOOTHING_GROWTH,
    SMOOTHING_LENGTH_M,
    SMOOTHING_PASSES,
    SMOOTHING_REACH_M,
)

Floats = NDArray[np.float64]

PINNED_LENGTH_M = 0.05
"""Smoothing length of samples that must stay where they are."""


def smoothed(line: Points, step: float, comfort_curvature: Floats) -> Points:
    """Return `line` (n, 2), sampled every `step` m, made smooth; its first two samples stay.

    Where |curvature| exceeds `comfort_curvature` (n,), 1/m, the line is loosened step by step, until it does not or
    leaves the centre line by COMFORT_DEVIATION_M.
    """
    lengths = np.full(len(line), SMOOTHING_LENGTH_M)
    stiffness = _third_difference_bands(len(line), step)
    reach = 2 * int(SMOOTHING_REACH_M / step) + 1
    result = _fitted(line, stiffness, lengths)
    for _ in range(SMOOTHING_PASSES):
        away = maximum_filter1d(np.hypot(*(result - line).T), reach)
        tight = (np.abs(curvature_of(result)) > comfort_curvature) & (away < COMFORT_DEVIATION_M / SMOOTHING_GROWTH)
        if not tight.any():
            break
        lengths = np.where(maximum_filter1d(tight, reach), lengths * SMOOTHING_GROWTH, lengths)
        result = _fitted(line, stiffness, lengths)
    return np.asarray(result)


def curvature_of(points: Points) -> Floats:
    """Return the signed curvature (n,), 1/m, of evenly sampled `points` (n, 2) by central differences."""
    first = np.gradient(points, axis=0)
    second = np.zeros_like(points)
    second[1:-1] = points[2:] - 2.0 * points[1:-1] + points[:-2]
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.asarray(cross / np.maximum(np.hypot(first[:, 0], first[:, 1]) ** 3, 1e-9))


def _fitted(line: Points, stiffness: Floats, lengths: Floats) -> Points:
    """Return argmin Σ ‖p − line‖² / length⁶ + Σ ‖third derivative of p‖², shape (n, 2)."""
    weights = lengths**-6.0
    weights[:2] = PINNED_LENGTH_M**-6.0
    bands = stiffness.copy()
    bands[-1] += weights
    centre = line.mean(axis=0)
    fitted: Points = solveh_banded(bands, weights[:, None] * (line - centre), check_finite=False)
    return np.asarray(fitted + centre)


def _third_difference_bands(n: int, step: float) -> Floats:
    """Return the upper bands (4, n) of DᵀD for the third-derivative operator D on n samples."""
    row = np.array([-1.0, 3.0, -3.0, 1.0])
    bands = np.zeros((4, n))
    for a in range(4):
        for b in range(a, 4):
            bands[3 - (b - a), b : b + n - 3] += row[a] * row[b]
    return bands / step**6
