"""The lanes beside C: to which the ego might move aside, and the queues on those by which it could go as well."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.nouns.forecast import LaneBeside, Queue, Queued
from sumo_reactive.driver.nouns.plan import LaneSegment, NominalPlan, ParallelLane
from sumo_reactive.driver.nouns.snapshot import Neighbour, Snapshot
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.view.attention import ATTENTION_BEHIND_M, lane_axis
from sumo_reactive.driver.world.lane import Lane, road_of, separation
from sumo_reactive.driver.world.road_graph import RoadGraph

CAR = "passenger"
"""SUMO's class of ordinary cars."""


def lanes_beside(graph: RoadGraph, plan: NominalPlan, front: float, reach: float) -> Iterator[LaneBeside]:
    """Yield the lanes on the side to overtake on, along C from `front` m on for `reach` m."""
    for segment in plan.segments:
        if segment.end > front and segment.start < front + reach and not segment.lane_id.startswith(":"):
            beside = _beside(graph, segment.lane_id)
            if beside is not None:
                lane, away, is_oncoming = beside
                stretch, is_entry = (segment.start, segment.end), is_oncoming and not graph.ways_into(lane.id)
                yield LaneBeside(lane.id, *stretch, away, lane.width, lane.speed_limit, is_oncoming, is_entry)


@kept(4096)
def _beside(graph: RoadGraph, lane_id: str) -> tuple[Lane, float, bool] | None:
    """Return the lane beside, how far to the left its centre is (m), and whether its traffic comes towards the ego."""
    side = -1.0 if graph.left_hand else 1.0
    lane = graph.lanes[lane_id]
    left, right = graph.neighbours(lane_id)
    inner = right if graph.left_hand else left
    if inner is not None and _usable(lane, inner):
        return inner, side * 0.5 * (lane.width + inner.width), False
    oncoming = graph.oncoming(lane.edge_id)
    if inner is not None or not oncoming or not _usable(lane, oncoming[-1]):
        return None
    other = oncoming[-1]
    return other, side * (0.5 * (lane.width + other.width) + max(separation(lane, other), 0.0)), True


def _usable(lane: Lane, other: Lane) -> bool:
    """Whether the cars of a lane may use the other."""
    return CAR in other.allowed if CAR in lane.allowed else bool(lane.allowed & other.allowed)


def queues(
    traffic: Traffic, snapshot: Snapshot, plan: NominalPlan, here: LaneSegment, graph: RoadGraph
) -> tuple[Queue, ...]:
    """Return the queue on the ego's lane and on each lane beside that leads on as well; none if no such lane is there."""
    ways = tuple(way for way in plan.parallel_lanes.get(here.route_index, ()) if way.from_lane == here.lane_id)
    if not ways:
        return ()
    place = plan.curve.at(snapshot.front)[:2]
    exit_id = next((p.connection_id for p in plan.passages if p.end > snapshot.front), "")
    own_fears = feared(graph, exit_id) if exit_id in graph.connections else frozenset()

    def queue_on(lane_id: str, way: ParallelLane | None) -> Queue:
        near = tuple(_near(traffic.users, graph, lane_id, place)) if way else ()
        users = tuple(_before(traffic.users, graph, lane_id, place, own_fears))
        return Queue(lane_id, users, way, near, graph.lanes[lane_id].speed_limit)

    return (queue_on(here.lane_id, None), *(queue_on(way.to_lane, way) for way in ways))


@kept(4096)
def feared(graph: RoadGraph, connection_id: str) -> frozenset[str]:
    """Return the other roads from which vehicles go first somewhere on a connection, whether or not the ego takes it."""
    connection = graph.connections[connection_id]
    junction = graph.junctions.get(connection.junction_id)
    if junction is None or connection.index < 0:
        return frozenset()
    rules, own = junction.right_of_way, road_of(connection.from_lane)
    others = (other for other in junction.connections if other.index >= 0 and not other.is_crossing)
    return frozenset(road_of(o.from_lane) for o in others if rules.must_yield(connection.index, o.index)) - {own}


@kept(4096)
def _exits(graph: RoadGraph, lane_id: str) -> Mapping[str, tuple[float, str]]:
    """Return where the lane and the ways out of it begin on the lane's own axis (m), and the connection that each is of."""
    table, length = {lane_id: (0.0, "")}, graph.lanes[lane_id].spine.length
    for way in graph.ways_from(lane_id):
        table.update((part, (length + at, way.id)) for part, at in [*graph.lanes_behind(way)][:-1])
    return table


@kept(4096)
def _exit_to(graph: RoadGraph, lane_id: str, edge_id: str) -> str:
    """Return the connection from a lane to an edge; empty: none."""
    ways = graph.ways_from(lane_id)
    return next((c.id for c in ways if c.to_lane in graph.lanes and graph.lanes[c.to_lane].edge_id == edge_id), "")


def _before(
    users: tuple[RoadUser, ...], graph: RoadGraph, lane_id: str, place: tuple[float, float], own_fears: frozenset[str]
) -> list[Queued]:
    table, own = _exits(graph, lane_id), graph.lanes[lane_id].spine.project(*place)[0]
    found = []
    for user in users:
        if user.lane_id not in table or user.body.is_person:
            continue
        start, connection = table[user.lane_id]
        ahead = start + user.lane_position - own
        if ahead > 0.0:
            connection = connection or (_exit_to(graph, lane_id, user.route[1]) if len(user.route) > 1 else "")
            fears = feared(graph, connection) if connection else frozenset()
            found.append(Queued(user, ahead, not fears <= own_fears))
    return sorted(found, key=lambda one: -one.ahead)


def _near(users: tuple[RoadUser, ...], graph: RoadGraph, lane_id: str, place: tuple[float, float]) -> Iterator[Neighbour]:
    axis, own = lane_axis(graph, lane_id), graph.lanes[lane_id].spine.project(*place)[0]
    for user in users:
        start = axis.get(user.lane_id)
        if start is not None and start + user.lane_position - own > -ATTENTION_BEHIND_M:
            yield Neighbour(user, start + user.lane_position - own)
