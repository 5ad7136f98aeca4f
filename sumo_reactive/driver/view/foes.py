"""Who can reach a conflict region on the way."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Conflict, Foe
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.parameters import PLANS_KEPT
from sumo_reactive.driver.view.attention import watches_of
from sumo_reactive.driver.world.road_graph import RoadGraph

_Meaning = tuple[int, Conflict, float, tuple[str, ...], float, float]
"""A passage, and what a user of a lane may do to the ego on it: the fields of a `Watch`.

It is plain because every user near is held against it at every step: a named tuple takes longer to take apart.
"""


def foes_of(traffic: Traffic, plan: NominalPlan, graph: RoadGraph, sight: tuple[int, ...]) -> tuple[Foe, ...]:
    """Return who can reach a region of the plan's passages in `sight`, once for each region."""
    if not sight:
        return ()
    meanings = _meanings(graph, plan, sight)
    users = (*traffic.users, *traffic.beside) if traffic.beside else traffic.users
    return tuple(_found(users, meanings))


def _found(users: tuple[RoadUser, ...], meanings: Mapping[str, tuple[_Meaning, ...]]) -> list[Foe]:
    found: list[Foe] = []
    for user in users:
        watched = meanings.get(user.lane_id)
        if watched is None:
            continue
        at, body, route = user.lane_position, user.body, user.route
        is_person, length = body.is_person, body.length
        for passage, conflict, distance, edges, start, end in watched:
            if edges and route and edges != route[: len(edges)]:
                continue
            if is_person:
                foe = _walker(user, passage, conflict, start, end)
                if foe.to_clear > 0.0:
                    found.append(foe)
                continue
            to_line = distance - at
            to_clear = to_line + end + length
            if to_clear > 0.0:
                found.append(Foe._make((user, passage, conflict, to_line, to_line + start, to_clear)))
    return found


@kept(PLANS_KEPT)
def _meanings(graph: RoadGraph, plan: NominalPlan, sight: tuple[int, ...]) -> Mapping[str, tuple[_Meaning, ...]]:
    """Return, by lane id, what a user on that lane may mean for the plan's passages in `sight`."""
    table: dict[str, list[_Meaning]] = {}
    for i in sight:
        for lane_id, watches in watches_of(graph, plan.passages[i].connection_id).items():
            table.setdefault(lane_id, []).extend((i, *watch) for watch in watches)
    return {lane_id: tuple(meanings) for lane_id, meanings in table.items()}


def _walker(user: RoadUser, passage: int, conflict: Conflict, start: float, end: float) -> Foe:
    """A pedestrian may walk along the crossing's path or against it, and stand before it."""
    at, path = user.lane_position, conflict.other.path
    to_step_on = max(-at, at - path.length)
    forward = math.cos(user.heading - path.heading_at(at)) >= 0.0
    to_region, to_clear = (start - at, end - at) if forward else (at - end, at - start)
    return Foe(user, passage, conflict, to_step_on if to_step_on > 0.0 else -1.0, to_region, to_clear)
