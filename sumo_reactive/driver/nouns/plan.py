"""The nominal plan P and the completed plan P⁺ (F&L 1991, §1.3).

Every arc length `s` is measured along the curve C from its first sample, in m, and says where a point of the road lies;
the front axle follows C, the front bumper is ahead of it by the front overhang.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.geometry.polyline import eased, wrapped
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.state import STANDING_SPEED, VehicleState
from sumo_reactive.driver.world.route import ScheduledStop

SEEKS_BEFORE_S = 1.0
"""A gap is sought this long before the ego would have to brake for want of one."""

LATE_LANE_CHANGE_LENGTH_M = 18.0
"""Length of the latest possible change on C: 1.5 times the minimum, for a car that has already slowed down."""

LANE_CHANGE_CLEARANCE_M = 2.0
"""A change ends this far before its lane does, so that the car stands straight at the stop line."""

CALL_OFF_SHARE = 0.3
"""A lane change may be called off on this share of its length: a car of 1.8 m on a lane of 3.2 m then touches the line."""

MOVE_SPEED = 3.0
"""m/s; how fast the moves of a turn are driven where the road is too narrow for one sweep…"""

MOVE_BACK_SPEED = 2.0
"""m/s; …and how fast those backwards."""

MOVE_END_M = 0.04
"""The last move is over when less of its way is left…"""

TURNED_ON_M = 0.2
"""…and another when it stands with less of it left: its wheels are turned on to the next one's while it stops."""

WHEELS_TURNED_RAD = 0.03
"""The wheels are straight again when they are this near to it."""

TURNAROUND_REACHED_M = 1.5
"""An ego that stands this near to where it turns round begins."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneSegment:
    """C follows lane `lane_id` (normal or internal) from `start` to `end`; `lane_offset` is the spine arc length there.

    A point of the lane at spine arc length p lies at s = start + (p − lane_offset) · stretch; `stretch` (metres of C per
    metre of spine) differs from 1 where C cuts or rounds a corner.
    """

    lane_id: str
    start: float
    end: float
    lane_offset: float
    route_index: int
    stretch: float = 1.0


@dataclass(frozen=True, slots=True)
class Passage:
    """C passes a junction by connection `connection_id`: stop line at `start`, the connection's end at `end`.

    `start` is negative when C begins inside the junction.
    """

    connection_id: str
    junction_id: str
    start: float
    end: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneChange:
    """A change from lane to lane that the route needs.

    `side` is +1 to the left, −1 to the right. It may begin at once (`opens`) and must have begun by `start`, where C makes
    it, ending at `end`, shortly before the old lane does.
    """

    from_lane: str
    to_lane: str
    side: int
    opens: float
    start: float
    end: float

    @property
    def middle(self) -> float:
        """Where the front comes onto the new lane, m of C."""
        return 0.5 * (self.start + self.end)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParallelLane:
    """From `from_lane` of C, where C changes no lane, the route can as well be driven by `to_lane` beside it, on `side` (+1
    left, −1 right), with no change back on this road.

    `cost`: that of the change, and of the later ones that it adds or saves, in lane changes. `merges`: at the end of the
    road `from_lane` has to yield to `to_lane`, and both lead into one lane. `is_inner`: it is farther from the kerb.
    """

    from_lane: str
    to_lane: str
    side: int
    cost: float
    merges: bool = False
    is_inner: bool = False


@dataclass(frozen=True, slots=True)
class PlannedStop:
    """A scheduled halt on C: the front bumper at `s`."""

    s: float
    stop: ScheduledStop


@dataclass(frozen=True, slots=True)
class Aside:
    """C runs `lateral` m beside the lane's centre (left positive) to pass somebody; from arc length `back` (m) on it
    returns, and at `until` it has."""

    lateral: float
    back: float
    until: float


def lateral_of(aside: Aside, s: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return how far (n,), m, C runs beside the lane's centre at arc lengths `s` (n,): a quintic leads it back."""
    t = np.clip((s - aside.back) / max(aside.until - aside.back, 0.1), 0.0, 1.0)
    return np.asarray(aside.lateral * (1.0 - eased(t)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """An arc of a turn in several moves: forwards (`gear` 1) or backwards (−1), wheels at `steering_angle` (rad), which
    turns the car by `bend` (rad) per metre ahead, until its heading is `until` (rad); `then` (rad) is the steering angle of
    the next one. After the last one C leads on; the car stands there, unless it `rolls_out`."""

    gear: int
    steering_angle: float
    bend: float
    until: float
    is_last: bool = False
    rolls_out: bool = False
    then: float = 0.0

    def left(self, heading: float) -> float:
        """Return the way left of the arc, m, at the car's `heading` (rad); negative where it has turned too far."""
        return self.gear * wrapped(self.until - heading) / self.bend

    def is_over(self, ego: VehicleState) -> bool:
        """Whether the car is at the end, after the last move with its wheels straight; it stands unless it rolls out."""
        left = MOVE_END_M if self.is_last else TURNED_ON_M
        is_there = self.left(ego.pose.heading) < left and (self.rolls_out or abs(ego.speed) < STANDING_SPEED)
        return is_there and (not self.is_last or abs(ego.steering_angle) < WHEELS_TURNED_RAD)


@dataclass(frozen=True, slots=True, kw_only=True)
class Turnaround:
    """C leads back beside the way it came, too tightly for the car: it turns in several `moves`, the first from a stand with
    its front bumper at `start`, before the stop `line`. They lead from lane `from_lane` to `to_lane`, whose edges are the
    route's at `from_index` and `route_index`, `into` m past `end`, and take about `duration` s."""

    start: float
    line: float
    end: float
    from_lane: str
    from_index: int
    to_lane: str
    route_index: int
    moves: tuple[Move, ...]
    duration: float
    into: float

    def holds(self, passage: Passage) -> bool:
        """Whether a passage is part of the turn."""
        return self.line <= passage.start and passage.end <= self.end

    @property
    def pace(self) -> float:
        """The speed along C that takes as long as the moves, m/s."""
        return (self.end - self.line) / self.duration


@dataclass(frozen=True, eq=False, kw_only=True)
class NominalPlan:
    """P = (C, {(l, t_l)}) with what the map says along C.

    `speed_limits` (n,) is the envelope of lane limits, curvature and deceleration at each sample of C, m/s. `goal` is the
    arc length where the front bumper has arrived, or None when the plan ends before the route does. `times` (n,) is when
    the front axle passes each sample on schedule, s. Up to `joins` (m) C still comes from where the car was when it was
    planned. `aside`: C leaves the lane's centre to pass somebody. `missed`: C begins a new route, since the turn to this
    edge was missed (empty: it does not). `parallel_lanes`: other lanes that do as well, by route index.
    `turnarounds`: where the car turns in several moves. `stays_on`: the route index of the edge that is left by the lane
    that the car came to (−1: by whichever is best).
    """

    curve: Curve
    segments: tuple[LaneSegment, ...]
    passages: tuple[Passage, ...]
    lane_changes: tuple[LaneChange, ...]
    stops: tuple[PlannedStop, ...]
    speed_limits: NDArray[np.float64]
    time_constraints: tuple[TimeConstraint, ...]
    goal: float | None
    times: NDArray[np.float64]
    joins: float = 0.0
    aside: Aside | None = None
    missed: str = ""
    parallel_lanes: Mapping[int, tuple[ParallelLane, ...]] = field(default_factory=dict)
    turnarounds: tuple[Turnaround, ...] = ()
    stays_on: int = -1

    def next_change(self, front: float) -> LaneChange | None:
        """Return the lane change to seek a gap for with the front bumper at `front` (m of C): the next not ended, or,
        once the front is on its new lane, the one that follows on the same road."""
        begun = None
        for change in self.lane_changes:
            if begun is not None:
                return change if change.from_lane == begun.to_lane else begun
            if change.middle > front:
                return change
            begun = change if change.end > front else None
        return begun

    def may_begin(self, change: LaneChange, front: float) -> bool:
        """Whether a lane change may begin with the front bumper at `front` (m of C): it is open, or its lane is reached."""
        return change.opens <= front or any(
            other.to_lane == change.from_lane and other.middle <= front < other.end for other in self.lane_changes
        )

    def may_be_sought(self, change: LaneChange, front: float, speed: float, braking: float) -> bool:
        """Whether a gap for a lane change matters with the front bumper at `front` (m of C): where it may begin, and from
        where an ego at `speed` (m/s) has just the way to stop with `braking` (m/s²) where it must have begun: on a short
        road behind a junction it may begin too late for that. A merge before it comes first."""
        if self.may_begin(change, front):
            return True
        left = change.start - front
        return left < speed * (SEEKS_BEFORE_S + 0.5 * speed / braking) and self.merging(front) is None

    def merging(self, front: float) -> ParallelLane | None:
        """Return the lane that the one at arc length `front` (m) has to yield to in the merge that it ends in; None: it ends
        in none, or C leaves it on this road."""
        here = next((segment for segment in self.segments if front < segment.end), None) if self.merges else None
        ways = () if here is None else self.parallel_lanes.get(here.route_index, ())
        return next((way for way in ways if here is not None and way.merges and way.from_lane == here.lane_id), None)

    @cached_property
    def merges(self) -> bool:
        """Whether a lane of C has to yield to another in the merge that it ends in."""
        return any(way.merges for ways in self.parallel_lanes.values() for way in ways)

    def on_schedule(self, s: float, time: float) -> tuple[float, float]:
        """Return how far behind schedule the front axle is at arc length `s` (m) at `time`, s (negative: early), and its
        speed there on schedule, m/s."""
        i, f = self.curve.sample_at(s)
        here, ahead = self.times.item(i), self.times.item(i + 1)
        return time - here - f * (ahead - here), self.curve.step / max(ahead - here, 1e-3)

    def road_speed(self, s: float) -> float:
        """The highest speed that road and curve allow with the front axle at arc length `s`, m/s."""
        return self.speed_limits.item(min(max(int(s / self.curve.step), 0), len(self.speed_limits) - 1))


def segment_at(nominal: NominalPlan, front: float) -> LaneSegment:
    """Return the lane segment of C that holds the front bumper at arc length `front`, m; the last one past its end."""
    return next((segment for segment in nominal.segments if front < segment.end), nominal.segments[-1])
