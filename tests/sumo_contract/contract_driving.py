"""What the contract tests share: an ego placed by hand on a SUMO lane, and boxes that overlap or not."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import libsumo
from shapely.geometry import Polygon

KEEP_ROUTE_EXACTLY = 3
EXACTLY = 2
SPEED_AS_SET = 32
NO_LANE_CHANGES = 0
Point = tuple[float, float]


def depart(route: str, lane: int = 1, speed: float = 10.0, position: float = 20.0, extra: str = "") -> str:
    """Route-file text of an ego that departs at time 0."""
    return (
        f'<vehicle id="ego" type="ego" depart="0" departLane="{lane}" departSpeed="{speed}" departPos="{position}" {extra}>'
        f'<route edges="{route}"/></vehicle>'
    )


def another(name: str, lane: int, position: float, kind: str = "other", speed: float = 0.0, at: float = 0.0) -> str:
    """Route-file text of a SUMO-driven vehicle on the priority road, eastbound."""
    return (
        f'<vehicle id="{name}" type="{kind}" depart="{at}" departLane="{lane}" departPos="{position}" departSpeed="{speed}">'
        '<route edges="wc ce"/></vehicle>'
    )


def take_over(vehicle: str = "ego") -> None:
    """Step until the vehicle is there, then switch SUMO's own driving off."""
    while vehicle not in libsumo.vehicle.getIDList():
        libsumo.simulationStep()
    libsumo.vehicle.setSpeedMode(vehicle, SPEED_AS_SET)
    libsumo.vehicle.setLaneChangeMode(vehicle, NO_LANE_CHANGES)


def place(x: float, y: float, speed: float, angle: float = 90.0, keep_route: int = KEEP_ROUTE_EXACTLY) -> None:
    """One step of the protocol: announce the speed, place the front bumper, step."""
    libsumo.vehicle.setSpeed("ego", speed)
    libsumo.vehicle.moveToXY("ego", "", -1, x, y, angle, keep_route)
    libsumo.simulationStep()


def lane_path(lanes: Sequence[str]) -> list[Point]:
    """The joined centre lines of consecutive lanes."""
    points: list[Point] = []
    for lane in lanes:
        points += [p for p in libsumo.lane.getShape(lane) if not points or math.dist(p, points[-1]) > 1e-6]
    return points


def point_at(path: Sequence[Point], s: float) -> tuple[float, float, float]:
    """Point at arc length s, and the navigational angle of the path there."""
    for (x1, y1), (x2, y2) in pairwise(path):
        length = math.dist((x1, y1), (x2, y2))
        if s <= length:
            angle = (90 - math.degrees(math.atan2(y2 - y1, x2 - x1))) % 360
            return x1 + (x2 - x1) * s / length, y1 + (y2 - y1) * s / length, angle
        s -= length
    raise ValueError("s lies beyond the end of the path")


def path_length(path: Sequence[Point]) -> float:
    return sum(math.dist(a, b) for a, b in pairwise(path))


def drive(
    path: Sequence[Point],
    s: float,
    speed: float,
    until: float,
    step: float = 0.1,
    after_step: Callable[[], None] = lambda: None,
    turn: float = 0.0,
    keep_route: int = KEEP_ROUTE_EXACTLY,
) -> None:
    """Drive the ego along a path at constant speed; `turn` (degrees) is a deviation of its heading."""
    while s < until:
        s += speed * step
        x, y, angle = point_at(path, s)
        place(x, y, speed, (angle + turn) % 360, keep_route)
        after_step()


def box(vehicle: str) -> Polygon:
    """The vehicle's outline from its front bumper centre, angle, length and width."""
    (x, y), length = libsumo.vehicle.getPosition(vehicle), libsumo.vehicle.getLength(vehicle)
    half = libsumo.vehicle.getWidth(vehicle) / 2
    heading = math.radians(90 - libsumo.vehicle.getAngle(vehicle))
    c, s = math.cos(heading), math.sin(heading)
    corners = ((0, half), (-length, half), (-length, -half), (0, -half))
    return Polygon([(x + a * c - b * s, y + a * s + b * c) for a, b in corners])


def overlapping() -> set[str]:
    """The vehicles whose boxes overlap the ego's."""
    ego = box("ego")
    return {v for v in libsumo.vehicle.getIDList() if v != "ego" and ego.intersects(box(v))}
