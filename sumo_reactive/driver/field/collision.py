"""The exact collision test, separate from U (F&L 1991, §3.2 and §3.3.1)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.vehicle.bicycle import advance_pose

LONG_M = 8.0
"""A body longer than this that turns away beside the ego swings its tail out, …"""

TAIL_M = 0.6
"""…by more than it is foreseen to, perhaps by this, …"""

ALONG = 0.5
"""…if it heads where the ego does, to within the angle with this cosine."""


@kernel
def foreseen_pose(box: Floats, t: float, turn_rate: float) -> tuple[float, float, float]:
    """Return centre (m) and heading (rad) of a box (7) that has kept its speed and a turn rate (rad/s) for `t` s."""
    back = 0.5 * box[4]
    x, y = box[0] - back * math.cos(box[2]), box[1] - back * math.sin(box[2])
    half = 0.5 * turn_rate * t
    chord = box[3] * t * (1.0 - half * half / 6.0)
    return x + chord * math.cos(box[2] + half), y + chord * math.sin(box[2] + half), box[2] + 2.0 * half


@kernel
def within_reach(
    x: float, y: float, heading: float, speed: float, middle: float, radius: float, boxes: Floats, horizon: float
) -> NDArray[np.int64]:
    """Return which of `boxes` (n, 8) are ahead of the ego's middle, or stand, and could be touched within `horizon` s.

    The ego's middle is `middle` m ahead of its rear axle at (x, y), its body within `radius` m of that.
    """
    c, s = math.cos(heading), math.sin(heading)
    cx, cy = x + middle * c, y + middle * s
    found = np.empty(len(boxes), dtype=np.int64)
    n = 0
    for k in range(len(boxes)):
        dx, dy = boxes[k, 0] - cx, boxes[k, 1] - cy
        reach = radius + boxes[k, 4] + boxes[k, 5] + (speed + boxes[k, 3]) * horizon + 1.0
        ahead = (boxes[k, 0] - x) * c + (boxes[k, 1] - y) * s
        if (ahead > middle or boxes[k, 3] < STANDING_SPEED) and dx * dx + dy * dy < reach * reach:
            found[n] = k
            n += 1
    return found[:n]


@kernel
def _touches(
    x: float, y: float, heading: float, length: float, width: float, box: Floats, t: float, turn_rate: float, wide: float
) -> bool:
    """Whether the ego, its middle at (x, y) then, touches a box (7), taken to be `wide`, as it is foreseen after `t` s."""
    return boxes_overlap(x, y, heading, length, width, *foreseen_pose(box, t, turn_rate), box[4], wide)


@kernel
def braking_collides(
    x: float, y: float, heading: float, speed: float, steering_angle: float, wheelbase: float, axle_to_front: float,
    length: float, width: float, deceleration: float, boxes: Floats, start: float, horizon: float, step: float,
) -> bool:  # fmt: skip
    """Whether the ego, braking along its arc from `start` s ahead, touches a predicted footprint within `horizon` s.

    The others keep their speed. Who turns may go on turning or go straight on: only where both ways touch, braking is no
    matter of what he will do. A car that comes round a bend does not hit the ego, nor does one that waits to turn across its
    path; that one is the pilot's matter. A long body beside that has begun to turn goes on. Who drives with the front behind
    the ego's middle, or is touched only while the ego stands, has to look out himself; who leaves the road at the end of his
    way touches nobody behind it. `boxes` (n, 8):
    front x, y, heading, speed, length, width, turn rate (rad/s), way left (m).
    """
    middle = axle_to_front - 0.5 * length
    possible = within_reach(x, y, heading, speed, middle, 0.5 * (length + width), boxes, horizon)
    t, v, any_swings = start, speed, False
    px, py, ph = x, y, heading
    for k in possible:
        any_swings |= boxes[k, 4] > LONG_M and boxes[k, 6] != 0.0 and math.cos(boxes[k, 2] - heading) > ALONG
    while len(possible) > 0 and t <= horizon and (v > 0.0 or any_swings):
        cx, cy = px + middle * math.cos(ph), py + middle * math.sin(ph)
        for k in possible:
            swings = boxes[k, 4] > LONG_M and boxes[k, 6] != 0.0 and math.cos(boxes[k, 2] - heading) > ALONG
            if boxes[k, 3] * t > boxes[k, 7] or (v <= 0.0 and not swings):
                continue
            wide, turns = boxes[k, 5] + (2.0 * TAIL_M if swings else 0.0), boxes[k, 6] != 0.0
            if _touches(cx, cy, ph, length, width, boxes[k], t, boxes[k, 6], wide) and (
                swings or not turns or _touches(cx, cy, ph, length, width, boxes[k], t, 0.0, wide)
            ):
                return True
        px, py, ph = advance_pose(px, py, ph, v, steering_angle, wheelbase, step)
        v = max(0.0, v - deceleration * step)
        t += step
    return False
