"""What the pilot asks for when an event has activated it: the others' foreseen ways, and the room beside C."""

from __future__ import annotations

from sumo_reactive.messages.forecast import Outlook
from sumo_reactive.messages.plan import NominalPlan
from sumo_reactive.messages.snapshot import Snapshot
from sumo_reactive.messages.traffic import RoadUser, Traffic
from sumo_reactive.parameters import ASSESSED_S, ATTENTION_MIN_AHEAD_M, FORECAST_REACH_M
from sumo_reactive.perception.beside import lanes_beside
from sumo_reactive.perception.foresee import foresee
from sumo_reactive.world.road_graph import RoadGraph


def outlook(traffic: Traffic, snapshot: Snapshot, plan: NominalPlan, graph: RoadGraph) -> Outlook:
    """Return the forecast of all whom the ego could meet, and the lanes beside it."""
    front = snapshot.front
    users = traffic.users if traffic.sight > 0.0 else tuple(u for u in traffic.users if _may_meet(u, snapshot))
    beside = tuple(lanes_beside(graph, plan, front, FORECAST_REACH_M))
    here = next((segment for segment in plan.segments if front < segment.end), None)
    width = graph.lanes[here.lane_id].width if here else 0.0
    return Outlook(foresee(graph, users), beside, width, max(traffic.sight, ATTENTION_MIN_AHEAD_M))


def _may_meet(user: RoadUser, snapshot: Snapshot) -> bool:
    """Whether a user is near enough to touch the ego within the time that is assessed."""
    pose, reach = snapshot.ego.pose, ASSESSED_S * (snapshot.ego.speed + user.speed) + ATTENTION_MIN_AHEAD_M / 2
    return abs(user.x - pose.x) < reach and abs(user.y - pose.y) < reach
