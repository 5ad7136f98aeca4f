"""The exact collision test, separate from U (F&L 1991, §3.2 and §3.3.1)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.compilation import kernel
from sumo_reactive.geometry.footprint import boxes_overlap
from sumo_reactive.vehicle.bicycle import advance_pose

Array = NDArray[np.float64]


@kernel
def braking_collides(
    x: float, y: float, heading: float, speed: float, steering_angle: float, wheelbase: float, axle_to_front: float,
    length: float, width: float, deceleration: float, boxes: Array, start: float, horizon: float, step: float,
) -> bool:  # fmt: skip
    """Whether the ego, braking along its arc from `start` s ahead, touches a predicted footprint within `horizon` s.

    The others keep speed and heading. Who now has the front behind the ego's middle, or is touched only while the ego
    stands, has to look out himself. `boxes` (n, 6): front x, y, heading, speed, length, width.
    """
    t, v = start, speed
    px, py, ph = x, y, heading
    while t <= horizon and v > 0.0:
        back = axle_to_front - 0.5 * length
        cx, cy = px + back * math.cos(ph), py + back * math.sin(ph)
        for k in range(len(boxes)):
            bh, bv = boxes[k, 2], boxes[k, 3]
            cos_b, sin_b = math.cos(bh), math.sin(bh)
            reach = bv * t - 0.5 * boxes[k, 4]
            bx, by = boxes[k, 0] + reach * cos_b, boxes[k, 1] + reach * sin_b
            ahead = (boxes[k, 0] - x) * math.cos(heading) + (boxes[k, 1] - y) * math.sin(heading)
            if ahead > axle_to_front - 0.5 * length and boxes_overlap(
                cx, cy, ph, length, width, bx, by, bh, boxes[k, 4], boxes[k, 5]
            ):
                return True
        px, py, ph = advance_pose(px, py, ph, v, steering_angle, wheelbase, step)
        v = max(0.0, v - deceleration * step)
        t += step
    return False
