"""The centre line of the lanes to drive, joined, with what lies where along it: C before it is smoothed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.curve import CURVE_STEP_M
from sumo_reactive.driver.geometry.polyline import Points, Polyline, cut, eased, joined, wrapped
from sumo_reactive.driver.nouns.plan import LANE_CHANGE_CLEARANCE_M, LATE_LANE_CHANGE_LENGTH_M
from sumo_reactive.driver.path.lane_choice import LaneStep
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import ScheduledStop

CURVE_RUNOUT_M = 10.0
"""C goes on straight this far behind the goal, so that points ahead of the car always exist."""


@dataclass(frozen=True, eq=False)
class Piece:
    """The reference follows `lane` from its arc length `u` on; `lane_offset` is the spine arc length there, m."""

    lane: Lane
    route_index: int
    u: float
    lane_offset: float


@dataclass(frozen=True, eq=False)
class Change:
    """A lane change between reference arc lengths `start` and `end`, m, possible from `opens` on."""

    from_lane: Lane
    to_lane: Lane
    side: int
    opens: float
    start: float
    end: float


@dataclass(eq=False)
class Reference:
    """The joined centre line while it grows; every place is an arc length on it, m.

    `points` are chunks of shape (n, 2). `stage_starts` holds the arc length where each lane step began.
    """

    graph: RoadGraph
    length: float = 0.0
    points: list[Points] = field(default_factory=list)
    pieces: list[Piece] = field(default_factory=list)
    passages: list[tuple[Connection, float, float]] = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)
    stops: list[tuple[ScheduledStop, float]] = field(default_factory=list)
    stage_starts: list[float] = field(default_factory=list)
    goal: float | None = None

    def follow(self, lane: Lane, route_index: int, start: float, end: float) -> None:
        """Append the spine of `lane` from arc length `start` (may be negative: straight on backwards) to `end`, without what
        is drawn forth and back in between."""
        last = self.pieces[-1] if self.pieces else None
        if last is None or last.lane is not lane:
            self.pieces.append(Piece(lane, route_index, self.length, start))
        fold = fold_of(lane)
        if fold is not None and start < fold.leaves and fold.joins < end:
            self._append(cut(lane.spine, start, fold.leaves))
            start = fold.joins
            self.pieces.append(Piece(lane, route_index, self.length, start))
        if end > start:
            self._append(cut(lane.spine, start, end))

    def pass_junction(
        self, connection: Connection, route_index: int, start: float = 0.0, driven: float = 0.0
    ) -> float:
        """Append a connection's internal lanes, from arc length `start` (m) of its path on; return where the line goes on on
        the lane behind them, m. The car has `driven` so many metres of the path already."""
        began = self.length - driven
        *parts, _ = self.graph.lanes_behind(connection)
        for part, before in parts:
            lane = self.graph.lanes[part]
            if start < before + lane.spine.length:
                self.follow(lane, route_index, start if before == 0.0 else max(start - before, 0.0), lane.spine.length)
        if not connection.parts and start < connection.path.length:
            self._append(cut(connection.path, start, connection.path.length))
        self.passages.append((connection, began, self.length))
        return max(start - connection.path.length, 0.0)

    def drive(self, step: LaneStep, start: float) -> float:
        """Append a lane step from spine arc length `start` of its first lane, with its lane changes; return from which arc
        length on the line then follows the path of its connection, m."""
        self.stage_starts.append(self.length)
        lane, at = step.lanes[0], start
        end = _end_on(lane, step)
        for number, following in enumerate(step.lanes[1:]):
            left = len(step.lanes) - 1 - number
            at = self._change(step, lane, following, at, min(end, _beside(lane, following)), left)
            lane, end = following, _end_on(following, step)
        overrun = None if step.connection is None else overrun_of(self.graph, step.connection.id)
        if overrun is not None and at < overrun.leaves:
            self.follow(lane, step.stage.route_index, at, overrun.leaves)
            return overrun.joins
        self.follow(lane, step.stage.route_index, at, end)
        place = self.length + (step.stage.end * lane.scale - max(at, end))
        if step.stage.stop is not None:
            self.stops.append((step.stage.stop, place))
        return 0.0

    def finish(self, lane: Lane, arrival: float) -> None:
        """Set the goal at spine arc length `arrival` of the last `lane` and run out behind it."""
        self.goal = self.length
        rest = min(lane.spine.length - arrival, CURVE_RUNOUT_M)
        if rest > 0.0:
            self._append(cut(lane.spine, arrival, arrival + rest))
        self.run_out(CURVE_RUNOUT_M - max(rest, 0.0) + CURVE_STEP_M)

    def run_out(self, length: float) -> None:
        """Prolong the line straight by `length` m."""
        chain = self.points[-1]
        way = chain[-1] - chain[-2]
        self._append(np.vstack([chain[-1], chain[-1] + way / max(float(np.hypot(*way)), 1e-9) * length]))

    def cut_at(self, horizon: float) -> None:
        """Forget what lies beyond arc length `horizon`, m, unless the goal does not."""
        if self.goal is not None and self.goal <= horizon:
            return
        self.goal = None
        self.pieces = [piece for piece in self.pieces if piece.u < horizon]
        self.passages = [passage for passage in self.passages if passage[1] < horizon]
        self.changes = [change for change in self.changes if change.end <= horizon]
        self.stops = [stop for stop in self.stops if stop[1] <= horizon]

    def _change(self, step: LaneStep, lane: Lane, following: Lane, at: float, end: float, left: int) -> float:
        """Append the way along `lane` and the change to `following`; return the arc length reached on the latter."""
        index = step.stage.route_index
        room = max(end - LANE_CHANGE_CLEARANCE_M - at, 2.0 * CURVE_STEP_M)
        length = min(LATE_LANE_CHANGE_LENGTH_M, room / left)
        begin = at + room - left * length
        self.follow(lane, index, at, begin)
        start = self.length
        old = resampled(cut(lane.spine, begin, begin + length))
        feet = following.spine.arc_lengths_at(old)
        share = np.linspace(0.0, 1.0, len(old))[:, None]
        line = old + (following.spine.points_at(feet) - old) * eased(share)
        half = len(line) // 2
        self._append(line[: half + 1])
        self.pieces.append(Piece(following, index, self.length, float(feet[half])))
        self._append(line[half:])
        first = len(step.lanes) - 1 == left
        opens = self.stage_starts[-1 - min(step.opens, len(self.stage_starts) - 1)] if first else self.changes[-1].end
        side = following.index - lane.index
        side = -side if self.graph.left_hand else side
        self.changes.append(Change(lane, following, side, opens, start, self.length))
        return float(feet[-1])

    def _append(self, chunk: Points) -> None:
        gap = chunk[0] - self.points[-1][-1] if self.points else np.zeros(2)
        self.length += float(np.hypot(*gap)) + float(np.hypot(*np.diff(chunk, axis=0).T).sum())
        self.points.append(chunk)


def resampled(points: Points) -> Points:
    """Return `points` at even arc length, about CURVE_STEP_M apart, ends kept, at least five of them."""
    line = Polyline(points)
    s = np.linspace(0.0, line.length, max(int(line.length / CURVE_STEP_M) + 1, 5))
    return line.points_at(s)


def _end_on(lane: Lane, step: LaneStep) -> float:
    """Return the spine arc length of `lane` where the step ends."""
    whole = step.connection is not None
    return lane.spine.length if whole else min(step.stage.end * lane.scale, lane.spine.length)


def _beside(lane: Lane, following: Lane) -> float:
    """Return the spine arc length of `lane` up to which `following` runs beside it."""
    return float(lane.spine.project(*following.spine.at(following.spine.length))[0])


FOLDED_RAD = math.radians(150.0)
"""A lane that turns by more at one of its points turns back on itself."""


class Fold(NamedTuple):
    """C leaves the lane at its spine arc length `leaves` and goes on at `joins`, m: in between the lane is drawn back along
    itself and forth again, which no car can drive."""

    leaves: float
    joins: float


@kept(4096)
def fold_of(lane: Lane) -> Fold | None:
    """Return what C leaves out of a lane that is drawn forth and back over itself; None: the lane can be driven.

    A hairpin turns back once; a fold turns back twice, and where it does so for the second time it has been before.
    """
    spine = lane.spine
    headings = [math.atan2(y, x) for x, y in np.diff(spine.points, axis=0).tolist()]
    turns = [i for i in range(1, len(headings)) if abs(wrapped(headings[i] - headings[i - 1])) > FOLDED_RAD]
    for back, forth in pairwise(turns):
        place = spine.points[forth]
        s, d = Polyline(spine.points[: back + 1]).project(float(place[0]), float(place[1]))
        if s > 0.0 and abs(d) < 0.5 * lane.width and abs(wrapped(headings[forth] - headings[back - 1])) < TURNED_BACK_RAD:
            return Fold(s, float(spine.arc_lengths[forth]))
    return None


TURNED_BACK_RAD = math.radians(110.0)
"""A connection turns back on its lane if it begins in a direction this far from the lane's, and does not lead back."""
REACH_M = 30.0
"""The way behind the end of the lane is looked at so far."""
BEGUN_M = 0.5
"""A way that has just begun is on its lane for so long."""
LEAST_OVERRUN_M = 2.0
"""What a lane overruns the next one by less is smoothed away."""


class Overrun(NamedTuple):
    """C leaves the lane at its spine arc length `leaves` and goes on at `joins` of the connection's path and the lane behind
    it, m: in between it would drive on and come back along the lane."""

    leaves: float
    joins: float


@kept(4096)
def overrun_of(graph: RoadGraph, connection_id: str) -> Overrun | None:
    """Return what C leaves out where a connection turns back on its lane; None where it does not.

    That is up to where the way behind the lane's end crosses the lane for the last time, else leaves it to the side.
    """
    way = graph.connections[connection_id]
    own, behind = graph.lanes[way.from_lane], graph.lanes[way.to_lane]
    before, onto = own.spine.heading_at(own.spine.length), behind.spine.heading_at(0.0)
    turned = abs(wrapped(way.path.heading_at(0.0) - before))
    if turned < TURNED_BACK_RAD or abs(wrapped(onto - before)) > TURNED_BACK_RAD:
        return None
    back = Polyline(joined([way.path.points, behind.spine.points]))
    at = np.arange(BEGUN_M, min(back.length, way.path.length + REACH_M), CURVE_STEP_M)
    places = back.points_at(at)
    aside, along = own.spine.offsets(places), own.spine.arc_lengths_at(places)
    beside = (along > 0.0) & (along < own.spine.length)
    crosses = np.flatnonzero((aside[1:] * aside[:-1] < 0.0) & beside[1:]) + 1
    leaves = np.flatnonzero(beside & (np.abs(aside) > 0.5 * own.width))
    if not len(crosses) and not len(leaves):
        return None
    k = crosses[-1] if len(crosses) else leaves[0]
    left_out = own.spine.length - float(along[k])
    return Overrun(float(along[k]), float(at[k])) if left_out > LEAST_OVERRUN_M else None
