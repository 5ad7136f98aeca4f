"""Lanes: the regions of W that have a spine, who may use them, and which one shares a road in the other direction."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sumo_reactive.driver.geometry.polyline import Points, Polyline, moved_aside

OPPOSITE_SLACK_M = 1.0
"""Two edges share a carriageway if their inner lanes lie side by side with at most this room (a painted median) between."""

CROSSING_SINE = 0.5
"""Roads at a smaller angle lie over each other rather than cross, whether or not a junction joins them."""

VEHICLE_CLASSES = frozenset(
    {
        "private", "emergency", "authority", "army", "vip", "pedestrian", "passenger", "hov", "taxi", "bus", "coach",
        "delivery", "truck", "trailer", "motorcycle", "moped", "bicycle", "evehicle", "tram", "rail_urban", "rail",
        "rail_electric", "rail_fast", "ship", "container", "cable_car", "subway", "aircraft", "wheelchair", "scooter",
        "drone", "custom1", "custom2",
    }
)  # fmt: skip
"""Every class that a lane can allow or forbid (SUMO 1.28)."""

HEEDS_NOTHING = "ignoring"
"""SUMO's class for vehicles that heed no permission."""

FARTHEST_M = 1e6
"""No lane, and no network, reaches this far: a coordinate beyond is a slip, and points are laid along lanes."""

_SAMPLES = np.linspace(0.1, 0.9, 5)  # fractions of the spine; its ends may fan out at the junctions


@dataclass(frozen=True, eq=False, kw_only=True)
class Lane:
    """One lane of an edge, or one internal lane of a junction.

    `spine` is the centre line in m. `length` (m) is the length that positions on the lane refer to; a network may state
    one that differs from the spine's, so positions are scaled by `scale`. `index` counts from the outer edge of the road
    (right in right-hand traffic, left in left-hand traffic). `allowed` holds the vehicle classes that may drive here,
    `change_left` and `change_right` those that may leave the lane to that side, as the driver sees it.
    """

    id: str
    edge_id: str
    index: int
    spine: Polyline
    length: float
    width: float
    speed_limit: float
    allowed: frozenset[str]
    is_internal: bool = False
    change_left: frozenset[str] = VEHICLE_CLASSES
    change_right: frozenset[str] = VEHICLE_CLASSES

    def __post_init__(self) -> None:
        if self.width <= 0.0 or self.length <= 0.0 or self.speed_limit < 0.0:
            raise ValueError(f"lane {self.id}: width and length must be positive, speed not negative")
        if max(self.length, self.spine.length) > FARTHEST_M:
            raise ValueError(f"lane {self.id} is longer than {FARTHEST_M:g} m")

    @property
    def scale(self) -> float:
        """Spine metres per position metre."""
        return self.spine.length / self.length

    @property
    def outline(self) -> Points:
        """The lane's area (n, 2), m: its centre line, moved by half its width to either side."""
        half = np.full(len(self.spine.points), 0.5 * self.width)
        return np.concatenate([moved_aside(self.spine.points, half), moved_aside(self.spine.points, -half)[::-1]])

    def reaches(self, x: float, y: float, width: float) -> bool:
        """Whether a body of `width` m with the middle of its front at (x, y) reaches over the lane."""
        return abs(self.spine.project(x, y)[1]) < 0.5 * (self.width + width)

    def allows(self, vehicle_class: str) -> bool:
        """Whether vehicles of the class may drive here; SUMO's class for those who heed no permission may everywhere."""
        return vehicle_class in self.allowed or vehicle_class == HEEDS_NOTHING

    def allows_change_left(self, vehicle_class: str) -> bool:
        """Whether vehicles of the class may leave this lane to the left."""
        return vehicle_class in self.change_left or vehicle_class == HEEDS_NOTHING

    def allows_change_right(self, vehicle_class: str) -> bool:
        """Whether vehicles of the class may leave this lane to the right."""
        return vehicle_class in self.change_right or vehicle_class == HEEDS_NOTHING


def road_of(lane_id: str) -> str:
    """Return the id of the edge that a lane belongs to, which its own begins with."""
    return lane_id.rpartition("_")[0]


def nearest_opposite(inner: Lane, candidates: Iterable[Lane]) -> Lane | None:
    """Return the oncoming inner lane that lies right beside `inner`, or None.

    `candidates` are the inner lanes of edges that join the same junctions the other way round; one counts if vehicles of
    some class may use both and if on average at most `OPPOSITE_SLACK_M` lies between them.
    """
    beside = [(separation(inner, lane), lane) for lane in candidates if lane.allowed & inner.allowed]
    near = [(gap, lane) for gap, lane in beside if gap <= OPPOSITE_SLACK_M]
    return min(near, key=lambda item: (abs(item[0]), item[1].id))[1] if near else None


def separation(inner: Lane, other: Lane) -> float:
    """Return the mean room between the borders of two lanes, m; negative where they overlap."""
    offsets = [other.spine.project(*inner.spine.at(float(f) * inner.spine.length))[1] for f in _SAMPLES]
    return float(np.mean(np.abs(offsets))) - 0.5 * (inner.width + other.width)
