"""Static obstacles that SUMO knows: polygons of one type on the road, and vehicles that are parked beside it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import libsumo
import numpy as np
import shapely
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.footprint import Footprint
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import NO_POINTS, Body, RoadUser
from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.config import OBSTACLE_POLYGONS
from sumo_reactive.sumo.vehicle_type import heading_of, size_of_body

LANES_REFRESH_M = 5.0
"""The lanes in sight are chosen anew each time the ego has come this far."""

OUTLINE_STEP_M = 0.5
"""Spacing of the points of O_S on the outline of a parked vehicle or a polygon: a tenth of a car's length."""

STATIC_SIGHT_M = 60.0
"""Parked vehicles and polygons are points of O_S up to this far in x and y: half a bitmap's side, and a refresh more."""

POLYGON_REACH_M = 150.0
"""Polygons on the road are seen this far: braking from 25 m/s takes 125 m."""

THIN_POLYGON_M = 0.05
"""Half the width of a polygon that is but a line or a point."""

_Points = NDArray[np.float64]

LARGEST_OBSTACLE_M = 10_000.0
"""Side of the largest obstacle; a larger polygon is an error of its coordinates."""

_FIRM = 10.0  # m/s²; a body that never moves stops at once


class Static(NamedTuple):
    """What stands near: polygons as `users`; `points` (k, 2), m, of O_S on the outlines of polygons and parked vehicles."""

    users: tuple[RoadUser, ...]
    points: _Points


NOTHING = Static((), NO_POINTS)
"""Nothing stands near."""


class StaticObstacles:
    """Reads the polygons once, and keeps account of parked vehicles from step to step."""

    def __init__(self, polygon_type: str = OBSTACLE_POLYGONS) -> None:
        polygon = libsumo.polygon
        names = [name for name in polygon.getIDList() if polygon.getType(name) == polygon_type]
        hulls = {name: hull_of(_finite(name, polygon.getShape(name))) for name in names}
        self.users = tuple(standing(f"polygon:{name}", hull) for name, hull in hulls.items())
        self.outlines = tuple(outline(hull) for hull in hulls.values())
        self.parked: dict[str, _Points] = {}
        self.changes = -1
        self.look_again()

    def look_again(self) -> None:
        """Take in who parks; to be asked where steps have been missed."""
        self.parked.clear()
        self._park(name for name in libsumo.vehicle.getIDList() if libsumo.vehicle.isStoppedParking(name))
        self.changes += 1

    def update(self) -> None:
        """Take in who has begun or ended parking in the last step; to be asked once after each."""
        simulation = libsumo.simulation
        begun, gone = simulation.getParkingStartingVehiclesIDList(), simulation.getParkingEndingVehiclesIDList()
        if self.parked:
            gone += simulation.getArrivedIDList()
        before = len(self.parked)
        for name in gone:
            self.parked.pop(name, None)
        ended = before > len(self.parked)
        if self._park(begun) or ended:
            self.changes += 1

    def _park(self, names: Iterable[str]) -> bool:
        """Keep the outline of each that stands beside the road: SUMO has it on no lane, so nobody else sees it."""
        vehicle, before = libsumo.vehicle, len(self.parked)
        for name in names:
            if not vehicle.getLaneID(name):
                x, y = vehicle.getPosition(name)
                heading = heading_of(vehicle.getAngle(name))
                box = Footprint(x, y, heading, *size_of_body(name, vehicle.getLength(name), vehicle.getWidth(name)))
                self.parked[name] = outline(shapely.Polygon(box.corners()))
        return len(self.parked) > before


class StaticView:
    """What one ego sees of the static obstacles; looks again when it has moved on or something has changed."""

    def __init__(self, obstacles: StaticObstacles, ego_id: str = "") -> None:
        self._obstacles, self._ego_id = obstacles, ego_id
        self._near = NOTHING
        self._seen = (math.inf, math.inf, -1)

    @property
    def is_empty(self) -> bool:
        """Whether nothing stands anywhere."""
        return not (self._obstacles.users or self._obstacles.outlines or self._obstacles.parked)

    def near(self, x: float, y: float) -> Static:
        """Return what stands near (x, y), m."""
        changes = self._obstacles.changes
        was_x, was_y, seen = self._seen
        if changes != seen or max(abs(x - was_x), abs(y - was_y)) > LANES_REFRESH_M:
            self._seen = x, y, changes
            self._near = Static(tuple(u for u in self._obstacles.users if _is_near(u, x, y)), self._points(x, y))
        return self._near

    def _points(self, x: float, y: float) -> _Points:
        parked = (points for name, points in sorted(self._obstacles.parked.items()) if name != self._ego_id)
        outlines = (*self._obstacles.outlines, *parked)
        if not outlines:
            return NO_POINTS
        points = np.concatenate(outlines)
        return np.asarray(points[np.abs(points - (x, y)).max(axis=1) < STATIC_SIGHT_M])


def _finite(name: str, shape: Sequence[tuple[float, float]]) -> Sequence[tuple[float, float]]:
    """Return the points of a polygon; raise ScenarioError for one that cannot stand on a road."""
    points = np.array([point[:2] for point in shape])
    if not shape or not np.isfinite(points).all():
        raise ScenarioError(f"polygon '{name}': its shape is not a list of finite x,y")
    if np.ptp(points, axis=0).max() > LARGEST_OBSTACLE_M:
        raise ScenarioError(f"polygon '{name}': an obstacle of more than {LARGEST_OBSTACLE_M / 1000.0:g} km")
    return shape


def hull_of(shape: Iterable[tuple[float, float]]) -> shapely.Polygon:
    """Return the convex hull of a polygon's points; a line or a single point gets a width of 2 · THIN_POLYGON_M."""
    hull = shapely.MultiPoint([point[:2] for point in shape]).convex_hull
    return hull if hull.area > 0.0 else hull.buffer(THIN_POLYGON_M, cap_style="square", join_style="mitre")


def outline(shape: shapely.Polygon) -> _Points:
    """Return points (n, 2), m, on the outline of a shape, at most OUTLINE_STEP_M apart."""
    ring: _Points = shapely.get_coordinates(shapely.segmentize(shape.exterior, OUTLINE_STEP_M))
    return ring[:-1]


def standing(name: str, hull: shapely.Polygon) -> RoadUser:
    """Return a shape as a body that has halted: its smallest rectangle, whose front looks along the road."""
    corners = shapely.get_coordinates(hull.minimum_rotated_rectangle)[:4]
    (x, y), sides = corners.mean(axis=0), np.diff(corners[:3], axis=0)
    road = _road_heading(x, y)
    along = sides @ (math.cos(road), math.sin(road)) / np.hypot(*sides.T)
    first = int(np.argmax(np.abs(along)))
    ahead = math.copysign(1.0, along[first]) * sides[first]
    body = Body(float(np.hypot(*ahead)), float(np.hypot(*sides[1 - first])), _FIRM, STANDING_SPEED)
    front_x, front_y = (x, y) + 0.5 * ahead
    return RoadUser(name, float(front_x), float(front_y), math.atan2(ahead[1], ahead[0]), 0.0, "", 0.0, body, is_halted=True)


def _road_heading(x: float, y: float) -> float:
    """Return the direction (rad) of the lane nearest to (x, y), m; 0 where SUMO finds no road."""
    try:
        edge_id, position, index = libsumo.simulation.convertRoad(x, y)
    except libsumo.TraCIException:
        return 0.0
    return heading_of(libsumo.lane.getAngle(f"{edge_id}_{index}", position))


def _is_near(user: RoadUser, x: float, y: float) -> bool:
    reach = POLYGON_REACH_M + user.body.length + user.body.width
    return abs(user.x - x) < reach and abs(user.y - y) < reach
