"""What the pilot asks for when an event has activated it: the others' foreseen ways, and the room beside C."""

from __future__ import annotations

from sumo_reactive.driver.nouns.forecast import Outlook
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.parameters import ASSESSED_S, ATTENTION_MIN_AHEAD_M, FORECAST_REACH_M, OVERTAKING_S, SLOW_SHARE
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.beside import lanes_beside
from sumo_reactive.driver.view.foresee import foresee
from sumo_reactive.driver.view.ground import who_comes_over
from sumo_reactive.driver.view.queues import queues
from sumo_reactive.driver.world.road_graph import RoadGraph


def outlook(
    traffic: Traffic, snapshot: Snapshot, plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits
) -> Outlook:
    """Return the forecast of all whom the ego could meet on its way (of all in sight, if it looks far), the lanes
    beside it and the queues there if there is anybody to pass, and who comes over the ground of a turn in several moves."""
    front = snapshot.front
    users, duration = (traffic.users, OVERTAKING_S) if traffic.sight > 0.0 else (_concerned(snapshot), ASSESSED_S)
    slow = SLOW_SHARE * plan.road_speed(snapshot.s)
    passing = plan.aside is not None or any(obstacle.along < slow for obstacle in snapshot.on_path)
    beside = tuple(lanes_beside(graph, plan, front, FORECAST_REACH_M)) if passing else ()
    here = next((segment for segment in plan.segments if front < segment.end), None)
    width = graph.lanes[here.lane_id].width if here else 0.0
    waiting = queues(traffic, snapshot, plan, here, graph) if passing and here is not None else ()
    comes_over = who_comes_over(traffic.users, snapshot, plan, graph, limits) if plan.turnarounds else ""
    sight = max(traffic.sight, ATTENTION_MIN_AHEAD_M)
    return Outlook(foresee(graph, users, duration), beside, width, sight, waiting, comes_over)


def _concerned(snapshot: Snapshot) -> tuple[RoadUser, ...]:
    """Return who stands or drives on the ego's way, who can reach a region on it, who is beside a lane change: each once."""
    users = {obstacle.user.id: obstacle.user for obstacle in snapshot.on_path}
    users.update((foe.user.id, foe.user) for foe in snapshot.foes)
    users.update((neighbour.user.id, neighbour.user) for neighbour in snapshot.neighbours)
    pose, reach = snapshot.ego.pose, ASSESSED_S * snapshot.ego.speed + ATTENTION_MIN_AHEAD_M / 2
    return tuple(u for u in users.values() if abs(u.x - pose.x) + abs(u.y - pose.y) < 1.5 * (reach + ASSESSED_S * u.speed))
