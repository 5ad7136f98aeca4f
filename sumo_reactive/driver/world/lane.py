"""Lanes: the regions of W that have a spine."""

from __future__ import annotations

from dataclasses import dataclass

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.world.vehicle_class import VEHICLE_CLASSES


@dataclass(frozen=True, eq=False)
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

    @property
    def scale(self) -> float:
        """Spine metres per position metre."""
        return self.spine.length / self.length

    def reaches(self, x: float, y: float, width: float) -> bool:
        """Whether a body of `width` m with the middle of its front at (x, y) reaches over the lane."""
        return abs(self.spine.project(x, y)[1]) < 0.5 * (self.width + width)

    def allows(self, vehicle_class: str) -> bool:
        """Whether vehicles of the class may drive here."""
        return vehicle_class in self.allowed

    def allows_change_left(self, vehicle_class: str) -> bool:
        """Whether vehicles of the class may leave this lane to the left."""
        return vehicle_class in self.change_left

    def allows_change_right(self, vehicle_class: str) -> bool:
        """Whether vehicles of the class may leave this lane to the right."""
        return vehicle_class in self.change_right
