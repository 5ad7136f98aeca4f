"""Small hand-made road graphs and cars for the planner's tests."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.path.planner import PlanStart
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.junction import Connection, Control, Turn
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph, arcs_of

WIDTH = 3.2
CAR = VehicleLimits(
    length=5.0, width=1.8, wheelbase=3.0, front_overhang=0.9, max_speed=50.0, max_acceleration=2.6,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=9.0, max_steering_angle=0.65,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip


def road(
    edge_id: str, points: Sequence[tuple[float, float]], lanes: int = 1, speed: float = 13.9, closed: Sequence[int] = ()
) -> tuple[Lane, ...]:
    """Return an edge's lanes: lane 0 along `points`, the others beside the first segment's left; `closed` bar cars."""
    spine = np.array(points, dtype=float)
    way = spine[1] - spine[0]
    left = np.array([-way[1], way[0]]) / np.hypot(*way) * WIDTH
    made = []
    for k in range(lanes):
        line = Polyline(spine + k * left)
        allowed = frozenset({"bus"} if k in closed else {"passenger", "bus"})
        made.append(Lane(
            id=f"{edge_id}_{k}", edge_id=edge_id, index=k, spine=line, length=line.length, width=WIDTH, speed_limit=speed,
            allowed=allowed,
        ))  # fmt: skip
    return tuple(made)


def graph(
    roads: Sequence[tuple[Lane, ...]],
    links: Sequence[tuple[str, str]],
    bends: dict[str, list[tuple[float, float]]] | None = None,
) -> RoadGraph:
    """Return the road graph with a connection per (from lane, to lane); `bends` gives inner points of its path."""
    lanes = {lane.id: lane for lanes in roads for lane in lanes}
    connections = {}
    for number, (a, b) in enumerate(links):
        start, end = lanes[a].spine.points[-1], lanes[b].spine.points[0]
        between = (bends or {}).get(a, [])
        if np.hypot(*(end - start)) < 0.01:
            end = start + np.array([0.05, 0.0])
        path = Polyline(np.vstack([start, *between, end]))
        part = Lane(
            id=f":J{number}_0", edge_id=f":J{number}", index=0, spine=path, length=path.length, width=WIDTH,
            speed_limit=13.9, allowed=lanes[b].allowed, is_internal=True,
        )  # fmt: skip
        connection = Connection(
            id=f"{a}->{b}", junction_id=f"J{number}", index=0, from_lane=a, to_lane=b, parts=(part.id,), path=path,
            turn=Turn.STRAIGHT, control=Control.MAJOR,
        )  # fmt: skip
        connections[connection.id], lanes[part.id] = connection, part
    edges = {group[0].edge_id: group for group in roads}
    return RoadGraph(
        lanes=lanes, edge_lanes=edges, junctions={}, connections=connections, regions={}, arcs=arcs_of(connections, ()),
        opposite={}, left_hand=False,
    )  # fmt: skip


def start_on(lane: Lane, position: float, speed: float = 10.0, offset: float = 0.0, route_index: int = 0) -> PlanStart:
    """Return a car aligned with `lane`, its front bumper at `position` (m), `offset` m to the left of the spine."""
    heading = lane.spine.heading_at(position)
    x, y = lane.spine.at(position)
    along, left = (math.cos(heading), math.sin(heading)), (-math.sin(heading), math.cos(heading))
    back = CAR.front_to_rear_axle
    pose = Pose(x - back * along[0] + offset * left[0], y - back * along[1] + offset * left[1], heading)
    return PlanStart(pose, speed, 0.0, 100.0, lane.id, position, route_index)


def corner(radius: float, points: int) -> RoadGraph:
    """Return a left turn by 90° between two roads of 60 m; its path has `points` points in all."""
    angles = np.linspace(-math.pi / 2, 0.0, points)[1:-1]
    bend = [(60.0 + radius * math.cos(a), radius + radius * math.sin(a)) for a in angles]
    a = road("a", [(0.0, 0.0), (60.0, 0.0)])
    b = road("b", [(60.0 + radius, radius), (60.0 + radius, radius + 60.0)])
    return graph([a, b], [("a_0", "b_0")], {"a_0": bend})
