"""U₂, moving obstacles: the shadow of the ego in the direction of the relative velocity (F&L 1991, §3.3.2)."""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats

TOUCH_M = 0.05
"""δ is not taken below this, so that U₂ stays finite at contact."""


@kernel
def _corners(x: float, y: float, heading: float, ahead: float, behind: float, width: float, out: Floats) -> None:
    c, s = math.cos(heading), math.sin(heading)
    h = 0.5 * width
    out[0, 0], out[0, 1] = x + ahead * c - h * s, y + ahead * s + h * c
    out[1, 0], out[1, 1] = x + ahead * c + h * s, y + ahead * s - h * c
    out[2, 0], out[2, 1] = x - behind * c + h * s, y - behind * s - h * c
    out[3, 0], out[3, 1] = x - behind * c - h * s, y - behind * s + h * c


@kernel
def _reach(px: float, py: float, ux: float, uy: float, box: Floats) -> float:
    """Smallest t ≥ 0 with p + t·u on the boundary of `box` (4, 2), u of unit length; infinite when missed."""
    nearest = np.inf
    for i in range(4):
        ax, ay = box[i, 0], box[i, 1]
        ex, ey = box[(i + 1) % 4, 0] - ax, box[(i + 1) % 4, 1] - ay
        denominator = ux * ey - uy * ex
        if abs(denominator) < 1e-12:
            continue
        qx, qy = ax - px, ay - py
        t = (qx * ey - qy * ex) / denominator
        w = (qx * uy - qy * ux) / denominator
        if t >= 0.0 and -1e-9 <= w <= 1.0 + 1e-9 and t < nearest:
            nearest = t
    return nearest


@kernel
def shadow_distance(own: Floats, other: Floats, ux: float, uy: float) -> float:
    """δ: how far body `own` (4, 2) can move along unit vector u before it touches `other`; infinite when it never does.

    Exact for convex bodies: the first contact is between a corner of one and an edge of the other, so the rays from
    the own corners along u and from the other corners against u hold it.
    """
    low_own = low_other = np.inf
    high_own = high_other = -np.inf
    for i in range(4):
        a = own[i, 1] * ux - own[i, 0] * uy
        b = other[i, 1] * ux - other[i, 0] * uy
        low_own, high_own = min(low_own, a), max(high_own, a)
        low_other, high_other = min(low_other, b), max(high_other, b)
    if high_own <= low_other or high_other <= low_own:
        return np.inf
    nearest = np.inf
    for i in range(4):
        nearest = min(nearest, _reach(own[i, 0], own[i, 1], ux, uy, other))
        nearest = min(nearest, _reach(other[i, 0], other[i, 1], -ux, -uy, own))
    return nearest


@kernel
def shadow_potential(own: Floats, own_vx: float, own_vy: float, other: Floats, vx: float, vy: float, scale: float) -> float:
    """U_D = k₀ ‖v − v_D‖ / δ when D meets the shadow R_D of the ego, else 0: k₀ over the time to collision.

    (F&L 1991, §3.3.2.) Bodies are corner arrays (4, 2) in m, velocities in m/s, `scale` k₀ in s.
    """
    rx, ry = own_vx - vx, own_vy - vy
    relative = math.hypot(rx, ry)
    if relative < 1e-9:
        return 0.0
    distance = shadow_distance(own, other, rx / relative, ry / relative)
    if distance == np.inf:
        return 0.0
    return scale * relative / max(distance, TOUCH_M)


@kernel
def corners_of(boxes: Floats) -> Floats:
    """Return (n, 6, 2): four corners, velocity, centre of `boxes` (n, 6: front x, y, heading, speed, length, width)."""
    corners = np.empty((len(boxes), 6, 2))
    for k in range(len(boxes)):
        h, v = boxes[k, 2], boxes[k, 3]
        _corners(boxes[k, 0], boxes[k, 1], h, 0.0, boxes[k, 4], boxes[k, 5], corners[k])
        c, w = math.cos(h), math.sin(h)
        corners[k, 4, 0], corners[k, 4, 1] = v * c, v * w
        corners[k, 5, 0], corners[k, 5, 1] = boxes[k, 0] - 0.5 * boxes[k, 4] * c, boxes[k, 1] - 0.5 * boxes[k, 4] * w
    return corners


@kernel
def shadow_sum(
    x: float, y: float, heading: float, speed: float, axle_to_front: float, axle_to_rear: float, width: float,
    boxes: Floats, corners: Floats, scale: float, horizon: float,
) -> float:  # fmt: skip
    """U₂ = Σ_D U_D over `boxes` (n, 6), with their `corners` (n, 6, 2), within `horizon` m of the rear axle."""
    own = np.empty((4, 2))
    _corners(x, y, heading, axle_to_front, axle_to_rear, width, own)
    c, w = math.cos(heading), math.sin(heading)
    middle = 0.5 * (axle_to_front - axle_to_rear)
    mx, my = x + middle * c, y + middle * w
    radius = 0.5 * math.hypot(axle_to_front + axle_to_rear, width)
    total = 0.0
    for k in range(len(boxes)):
        dx, dy = corners[k, 5, 0] - mx, corners[k, 5, 1] - my
        rx, ry = speed * c - corners[k, 4, 0], speed * w - corners[k, 4, 1]
        bound = radius + 0.5 * (boxes[k, 4] + boxes[k, 5])
        relative = rx * rx + ry * ry
        misses = (dx * ry - dy * rx) ** 2 > bound * bound * relative or dx * rx + dy * ry < -bound * math.sqrt(relative)
        if not misses and dx * dx + dy * dy <= (horizon + bound) ** 2:
            total += shadow_potential(
                own, speed * c, speed * w, corners[k, :4], corners[k, 4, 0], corners[k, 4, 1], scale
            )
    return total
