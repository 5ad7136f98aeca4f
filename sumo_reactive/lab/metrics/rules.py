"""Rules that the ego breaks: red lights run, and rights of way taken, where another suffers from it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.geometry.polyline import Points
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.regions import ConflictRegion
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.lab.fault import RED_LIGHT_RUN, RIGHT_OF_WAY_TAKEN, Fault
from sumo_reactive.lab.metrics.moment import Figures, Moment

NO_GO = frozenset("rRu")
"""Red, and red with yellow; "s" (stop, then go) is not among them."""


class RedLights:
    """Counts stop lines crossed under a letter that forbids it, before the step and in it.

    Lights and the line are SUMO's, not what the driver has seen of them. A crossing after which SUMO has the ego before the
    line again was none: it had taken a body beside the lane for one inside the junction.
    """

    def __init__(self) -> None:
        self.faults: list[Fault] = []
        self._lane, self._before = "", ""

    def see(self, moment: Moment) -> None:
        """Note a crossing on red, and whether it was none."""
        lane = moment.step.lane_id
        if self._before and lane == self._before:
            self.faults.pop()
        if moment.crossed and NO_GO.issuperset(moment.crossed):
            self.faults.append(Fault(moment.step.time, RED_LIGHT_RUN, "", lane))
            self._before = self._lane
        elif lane != self._lane:
            self._before = ""
        self._lane = lane

    def figures(self) -> Figures:
        """Return the number of red lights run."""
        return {"red_lights_run": len(self.faults)}


OBSTRUCTED_BRAKING = -3.0
"""m/s²; who has priority and brakes harder is obstructed (comfortable braking is 2 to 3)."""

OBSTRUCTED_FOR_S = 0.5
"""Braking counts on average over at least so long: SUMO's cars dither by 0.45 m/s from step to step."""

GOES_ON_S = 1.0
"""Who brakes on for so long after the ego has left his way…"""

GOES_ON_BRAKING = -1.5
"""…this hard (m/s²) or harder, on average, brakes for something else…"""

FOLLOWS_BRAKING = 2.0
"""…unless it takes this (m/s²) to stay behind the ego as it leaves."""

ROAD_BEGINS_M = 10.0
"""Who has driven no farther on his road, and has at least…"""

AS_FAST = 0.8
"""…this share of the speed that it allows, brakes for its limit: drivers differ by a fifth in how fast they take it."""

NEAR_MISS_S = 1.0
"""A time to collision below this counts as nearly touching."""

ROUNDING_S = 1e-6
"""Times of steps are sums."""

APPROACH_M = 50.0
"""A vehicle this close to its stop line is about to use the junction: its braking distance at 16 m/s and 2.5 m/s²."""

OBSTRUCTED_SPEED = 0.5
"""m/s; who stands is not obstructed by being where it is."""


class _Suspicion(NamedTuple):
    """That who brakes does so because the ego is in a region (`polygon`), which it has left at `left` (s, None: not yet),
    when he drove with `speed` (m/s)."""

    fault: Fault
    polygon: Points
    left: float | None = None
    speed: float = 0.0


class RightOfWayViolations:
    """Counts users that the ego obstructs, each once per junction passage.

    A user is obstructed when all of this holds: the ego's box is inside a conflict region; the ego's connection yields to
    the user's there, and not the user's to the ego's (so "right before left" counts, an all-way stop does not); the user
    is before or in the region, inside the junction, or, where no light rules (a light's letter may be why it brakes),
    within 50 m of its stop line on the way to that connection; it moves; and it brakes harder than 3 m/s², on average
    over half a second, or the time to collision with the ego is below 1 s. Who only brakes, and brakes on when the ego is
    gone, though not to stay behind it, has another reason: a line, a queue, a bend. So has who comes onto a slower road and
    drives as fast as it allows.
    """

    def __init__(self) -> None:
        self._found: list[Fault] = []
        self._suspicions: dict[str, _Suspicion] = {}
        self._graph: RoadGraph | None = None
        self._own: Connection | None = None
        self._obstructed: set[str] = set()
        self._past: deque[tuple[float, dict[str, float]]] = deque()

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Every user obstructed, those whose reason to brake the run has left open included."""
        return (*self._found, *(suspicion.fault for suspicion in self._suspicions.values()))

    def see(self, moment: Moment) -> None:
        """Note who is newly obstructed."""
        graph = moment.world
        if graph is not self._graph and graph is not None and self._own is not None:
            self._own = graph.connections.get(self._own.id)  # a route taken anew may not pass that junction
        self._graph = graph
        if graph is None:
            return
        self._remember(moment)
        if self._suspicions:
            self._review(moment)
        own = graph.connection_of.get(moment.step.lane_id)
        if own is not None and own is not self._own:
            self._own, self._obstructed = own, set()
        if self._own is None or not moment.users:
            return
        if moment.hardest_braking >= OBSTRUCTED_BRAKING and min(moment.times_to_collision) >= NEAR_MISS_S:
            return
        for user, time in zip(moment.users, moment.times_to_collision, strict=True):
            brakes = moment.slowing.get(user.id, 0.0) < OBSTRUCTED_BRAKING and self._has_braked(user, moment.step.time)
            brakes = brakes and not _comes_onto_slower_road(graph, user)
            suffers = brakes or time < NEAR_MISS_S
            if suffers and user.speed > OBSTRUCTED_SPEED and user.id not in self._obstructed:
                self._judge(graph, self._own, user, moment, is_certain=time < NEAR_MISS_S)

    def figures(self) -> Figures:
        """Return the number of users obstructed; None where nobody knows the roads."""
        return {"right_of_way_violations": None if self._graph is None else len(self.faults)}

    def _remember(self, moment: Moment) -> None:
        """Keep the speeds (m/s) of the last OBSTRUCTED_FOR_S, and of the step before."""
        now = moment.step.time
        while len(self._past) > 1 and self._past[1][0] <= now - OBSTRUCTED_FOR_S + ROUNDING_S:
            self._past.popleft()
        self._past.append((now, {user.id: user.speed for user in moment.users}))

    def _has_braked(self, user: RoadUser, now: float) -> bool:
        """Whether a user has braked hard on average for OBSTRUCTED_FOR_S or a whole step."""
        since, speeds = self._past[0]
        if user.id not in speeds or now - since < OBSTRUCTED_FOR_S - ROUNDING_S:
            return False
        return (user.speed - speeds[user.id]) / (now - since) < OBSTRUCTED_BRAKING

    def _review(self, moment: Moment) -> None:
        """Look whether those who brake did so for the ego: it gone, they stop braking, or stand, or must stay behind it."""
        now, users = moment.step.time, {user.id: user for user in moment.users}
        for name, suspicion in tuple(self._suspicions.items()):
            user = users.get(name)
            if user is None or user.speed <= OBSTRUCTED_SPEED:
                self._found.append(self._suspicions.pop(name).fault)
            elif _covers(moment, suspicion.polygon):
                self._suspicions[name] = suspicion._replace(left=None)
            elif suspicion.left is None and _braking_behind(moment, user) > FOLLOWS_BRAKING:
                self._found.append(self._suspicions.pop(name).fault)
            elif suspicion.left is None:
                self._suspicions[name] = suspicion._replace(left=now, speed=user.speed)
            elif now - suspicion.left >= GOES_ON_S - ROUNDING_S:
                if (user.speed - suspicion.speed) / (now - suspicion.left) > GOES_ON_BRAKING:
                    self._found.append(suspicion.fault)
                del self._suspicions[name]

    def _judge(self, graph: RoadGraph, own: Connection, user: RoadUser, moment: Moment, *, is_certain: bool) -> None:
        for region, other in _lost(graph, own):
            if _claims(graph, other, region, user) and _covers(moment, region.polygon):
                self._obstructed.add(user.id)
                fault = Fault(moment.step.time, RIGHT_OF_WAY_TAKEN, user.id, moment.step.lane_id)
                if is_certain:
                    self._found.append(fault)
                else:
                    self._suspicions[user.id] = _Suspicion(fault, region.polygon)
                return


def _comes_onto_slower_road(graph: RoadGraph, user: RoadUser) -> bool:
    """Whether a user who brakes has just come onto his road, and drives as fast as it allows."""
    lane = graph.lanes.get(user.lane_id)
    return lane is not None and user.lane_position < ROAD_BEGINS_M and user.speed >= AS_FAST * lane.speed_limit


def _braking_behind(moment: Moment, user: RoadUser) -> float:
    """Return the deceleration (m/s²) that keeps a user behind the ego's rear, as if it drove straight ahead of him."""
    step = moment.step
    rear = step.x - moment.length * math.cos(step.heading), step.y - moment.length * math.sin(step.heading)
    gap = math.hypot(rear[0] - user.x, rear[1] - user.y)
    return max(user.speed**2 - step.speed**2, 0.0) / (2.0 * max(gap, 0.1))


def _lost(graph: RoadGraph, own: Connection) -> Iterator[tuple[ConflictRegion, Connection]]:
    """Yield the regions on `own` where another connection goes first, with that connection."""
    rule = graph.junctions[own.junction_id].right_of_way
    for region in graph.regions_on(own):
        other = graph.connections.get(region.other_id)
        if other and rule.must_yield(own.index, other.index) and not rule.must_yield(other.index, own.index):
            yield region, other


def _claims(graph: RoadGraph, other: Connection, region: ConflictRegion, user: RoadUser) -> bool:
    """Whether `user` is on its way by `other` through the region."""
    inside = graph.connection_of.get(user.lane_id)
    if inside is not None:
        return inside is other and other.path.project(user.x, user.y)[0] - user.body.length < region.other.end
    lane, target = graph.lanes.get(other.from_lane), graph.lanes.get(other.to_lane)
    if other.light or lane is None or target is None or user.lane_id != lane.id:
        return False
    return target.edge_id in user.route[1:2] and lane.length - user.lane_position < APPROACH_M


def _covers(moment: Moment, polygon: Points) -> bool:
    """Whether the ego's box covers part of `polygon`: a vertex inside the box, or the box's middle line inside it."""
    step = moment.step
    c, s = math.cos(step.heading), math.sin(step.heading)
    offset = polygon - (step.x, step.y)
    ahead, aside = offset @ (c, s), offset @ (-s, c)
    if bool(np.any((ahead < 0.0) & (ahead > -moment.length) & (np.abs(aside) < 0.5 * moment.width))):
        return True
    back = np.linspace(0.0, moment.length, 10)[:, None]
    return bool(_inside((step.x, step.y) - back * (c, s), polygon).any())


def _inside(points: Points, polygon: Points) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return for each point (n, 2) whether it lies in `polygon` (k, 2): an odd number of sides to its right."""
    (ax, ay), (bx, by) = polygon.T, np.roll(polygon, -1, axis=0).T
    x, y = points[:, :1], points[:, 1:]
    spans = (ay > y) != (by > y)
    rise = np.where(by == ay, 1.0, by - ay)
    crossed = spans & (x < ax + (y - ay) / rise * (bx - ax))
    return np.asarray(crossed.sum(axis=1) % 2 == 1)
