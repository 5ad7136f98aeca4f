"""What a body sweeps beside the line that its front axle follows: the rear axle is towed (F&L 1991, §3.1)."""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats, nearest_point


@kernel
def swept_sides(
    xs: Floats, ys: Floats, headings: Floats, step: float, heading: float, wheelbase: float, overhang: float,
    turned: float, reach: float,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return how far, m, rear axle and front bumper pass to the left of each sample of a line: (n, 2) each, most and least,
    0 where they are on it.

    The front axle follows the line, `xs`, `ys` (n,), m, sampled every `step` m, which leads along `headings` (n,); the body
    has `heading` (rad) at the first sample. `wheelbase` and front `overhang` in m. Where the body is turned from the
    line by less than the angle of sine `turned`, it counts as on it. The way along the line to where axle or bumper are
    beside it is at most `reach` times as long as that from the front axle straight.
    """
    n = len(xs)
    rear, bumper = np.zeros((n, 2)), np.zeros((n, 2))
    rx, ry = xs[0] - wheelbase * math.cos(heading), ys[0] - wheelbase * math.sin(heading)
    behind, ahead = int(reach * wheelbase / step) + 1, int(reach * overhang / step) + 1
    for i in range(n):
        dx, dy = xs[i] - rx, ys[i] - ry
        away = max(math.hypot(dx, dy), 1e-6)
        dx, dy = dx / away, dy / away
        rx, ry = xs[i] - wheelbase * dx, ys[i] - wheelbase * dy
        if abs(dx * math.sin(headings[i]) - dy * math.cos(headings[i])) < turned:
            continue
        _note(xs, ys, headings, rear, rx, ry, max(i - behind, 0), i)
        _note(xs, ys, headings, bumper, xs[i] + overhang * dx, ys[i] + overhang * dy, i, min(i + ahead, n - 1))
    return rear, bumper


@kernel
def _note(
    xs: Floats, ys: Floats, headings: Floats, found: Floats, x: float, y: float, first: int, last: int
) -> None:
    """Note in `found` (n, 2) how far (m) (x, y) is to the left of the nearest sample from index `first` to `last`."""
    i = nearest_point(xs, ys, x, y, first, last)
    aside = (y - ys[i]) * math.cos(headings[i]) - (x - xs[i]) * math.sin(headings[i])
    found[i, 0], found[i, 1] = max(found[i, 0], aside), min(found[i, 1], aside)


def steering_along(headings: Floats, steps: Floats, wheelbase: float, angle: float) -> Floats:
    """Return the steering angle (n,), rad, with which the front axle takes `steps` (n,), m, along `headings` (n,).

    The body is drawn along: on a straight step tan(φ/2) falls by exp(−step/L). `angle` (rad) is φ on the first step.
    """
    found, before = np.empty(len(headings)), float(headings[0])
    shrink = np.exp(-steps / wheelbase).tolist()
    for k, heading in enumerate(headings.tolist()):
        if k:
            angle = 2.0 * math.atan(shrink[k - 1] * math.tan(0.5 * angle)) + heading - before
        found[k], before = angle, heading
    return found
