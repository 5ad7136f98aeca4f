"""Oriented boxes: the ground that a vehicle covers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

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

    @property
    def center(self) -> tuple[float, float]:
        """Centre of the box (x, y), m."""
        back = 0.5 * self.length
        return self.x - back * math.cos(self.heading), self.y - back * math.sin(self.heading)

    def corners(self) -> Points:
        """Return the corners, shape (4, 2), m: front left, rear left, rear right, front right."""
        ahead = np.array([math.cos(self.heading), math.sin(self.heading)])
        left = 0.5 * self.width * np.array([-ahead[1], ahead[0]])
        front = np.array([self.x, self.y])
        rear = front - self.length * ahead
        return np.stack([front + left, rear + left, rear - left, front - left])

    def overlaps(self, other: Footprint) -> bool:
        """Whether the interiors share a point; boxes that only touch do not overlap."""
        (ax, ay), (bx, by) = self.center, other.center
        dx, dy = bx - ax, by - ay
        if math.hypot(dx, dy) >= self._radius + other._radius:
            return False
        return all(
            abs(dx * math.cos(axis) + dy * math.sin(axis)) < self._reach(axis) + other._reach(axis)
            for heading in (self.heading, other.heading)
            for axis in (heading, heading + 0.5 * math.pi)
        )

    def clearance(self, other: Footprint) -> float:
        """Return the shortest distance between the two boxes, m; 0 where they touch or overlap."""
        if self.overlaps(other):
            return 0.0
        mine, theirs = self.corners(), other.corners()
        return min(_distance_to_outline(mine, theirs), _distance_to_outline(theirs, mine))

    @cached_property
    def _radius(self) -> float:
        return 0.5 * math.hypot(self.length, self.width)

    def _reach(self, axis: float) -> float:
        """Half the extent of the box along direction `axis` (rad), m."""
        turn = axis - self.heading
        return 0.5 * (self.length * abs(math.cos(turn)) + self.width * abs(math.sin(turn)))


def _distance_to_outline(points: Points, outline: Points) -> float:
    """Return the shortest distance (m) from any of `points` (n, 2) to the closed chain `outline` (k, 2)."""
    side = np.roll(outline, -1, axis=0) - outline
    offset = points[:, None, :] - outline[None, :, :]
    t = np.clip((offset * side).sum(axis=2) / (side**2).sum(axis=1), 0.0, 1.0)
    away = offset - t[:, :, None] * side
    return float(np.sqrt((away**2).sum(axis=2).min()))


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
