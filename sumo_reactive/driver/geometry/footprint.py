"""Oriented boxes: the ground that a vehicle covers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Points


@dataclass(frozen=True)
class Footprint:
    """A box of `length` × `width` m whose front edge's centre is (x, y) m; `heading` in rad, counter-clockwise from x."""

    x: float
    y: float
    heading: float
    length: float
    width: float

    def __post_init__(self) -> None:
        if not (self.length > 0.0 and self.width > 0.0):
            raise ValueError(f"a footprint needs a positive size, got {self.length} × {self.width} m")

    def corners(self) -> Points:
        """Return the corners, shape (4, 2), m: front left, rear left, rear right, front right."""
        ahead = np.array([math.cos(self.heading), math.sin(self.heading)])
        left = 0.5 * self.width * np.array([-ahead[1], ahead[0]])
        front = np.array([self.x, self.y])
        rear = front - self.length * ahead
        return np.stack([front + left, rear + left, rear - left, front - left])


@kernel
def boxes_overlap(
    ax: float, ay: float, ah: float, al: float, aw: float, bx: float, by: float, bh: float, bl: float, bw: float
) -> bool:
    """Whether two boxes (centre x, y, heading, length, width) overlap: separating axes, exact."""
    dx, dy = bx - ax, by - ay
    reach = 0.5 * (math.hypot(al, aw) + math.hypot(bl, bw))
    if dx * dx + dy * dy > reach * reach:
        return False
    ca, sa, cb, sb = math.cos(ah), math.sin(ah), math.cos(bh), math.sin(bh)
    c, s = abs(ca * cb + sa * sb), abs(sa * cb - ca * sb)
    if abs(dx * ca + dy * sa) >= 0.5 * (al + bl * c + bw * s):
        return False
    if abs(dy * ca - dx * sa) >= 0.5 * (aw + bl * s + bw * c):
        return False
    if abs(dx * cb + dy * sb) >= 0.5 * (bl + al * c + aw * s):
        return False
    return abs(dy * cb - dx * sb) < 0.5 * (bw + al * s + aw * c)
