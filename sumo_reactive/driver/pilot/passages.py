"""The passages through junctions that are in sight."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.plan import NominalPlan, Passage, Turnaround
from sumo_reactive.driver.nouns.snapshot import Conflict, Snapshot
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.regions import ConflictKind

REGION_MARGIN_M = 0.5
"""Distance kept to a region when waiting inside a junction."""

WAIT_SHIFT_M = 4.0
"""A turn waits up to this far before its waiting place inside the junction if the region begins earlier."""

Ahead = tuple[tuple[int, Connection, tuple[Conflict, ...]], ...]
"""The passages in sight: index in the plan, connection, conflicts."""

STUB_M = 1.0
"""A piece of road shorter than this before a stop line holds nobody's front…"""

NODE_M = 3.0
"""…and a junction whose way is shorter than this is a node that only divides the road."""


class Crossing(NamedTuple):
    """One passage under consideration: `scale` is metres of C per metre of the connection's path, `pace` its top speed,
    `stop` where the ego means to stop behind it (m of C, infinite: nowhere), `turn` the moves in which it turns round.
    `wait_at` (m of the path): where a turn may wait inside the junction without standing in the way of others (None:
    nowhere). `waits_in_the_way`: the connections on which others wait for the ego in its corridor. `swing`: how far before
    the stop line the body begins to swing over others' ways, m. `stub`: how far before it the line before is, where nobody
    can stand between them, m. `last`: where the last region ends, `post`: where the room behind the last begins in which
    the ego may not stand (m of C; infinitely far behind: it has none)."""

    number: int
    passage: Passage
    connection: Connection
    scale: float
    pace: float
    stop: float = math.inf
    turn: Turnaround | None = None
    wait_at: float | None = None
    waits_in_the_way: frozenset[str] = frozenset()
    swing: float = 0.0
    stub: float = 0.0
    last: float = -math.inf
    post: float = -math.inf

    @property
    def line(self) -> float:
        """Where to stop before the junction, m of C: the stop line, or as far before it as others' ways reach over it, as
        the body swings over theirs, as the line before is, or as a turn in several moves begins."""
        line = self.passage.start - max(self.connection.hold_back, self.swing, self.stub)
        return line if self.turn is None else min(line, self.turn.start)

    def at(self, path_length: float) -> float:
        """Arc length on C of a place on the connection's path, m; C is as long as the lanes before and behind it."""
        inside = min(max(path_length, 0.0), self.connection.path.length)
        return self.passage.start + inside * self.scale + path_length - inside


def reach_of(snapshot: Snapshot) -> float:
    """How far ahead (m) the ego drives cautiously: the way and the time of the approach, and its way to stop."""
    p, speed = snapshot.parameters, snapshot.ego.speed
    return p.cautious_ahead_m + p.cautious_ahead_s * speed + speed * speed / (2.0 * p.comfort_deceleration)


class View(NamedTuple):
    """The ego on its plan, and what W holds ahead of it: the passages in sight, each with its conflicts and as `ways`."""

    snapshot: Snapshot
    plan: NominalPlan
    limits: VehicleLimits
    ahead: Ahead
    ways: tuple[Crossing, ...]

    @property
    def met(self) -> tuple[tuple[Crossing, tuple[Conflict, ...]], ...]:
        """The passages with their conflicts, the nearest first."""
        return tuple((way, conflicts) for way, (_, _, conflicts) in zip(self.ways, self.ahead, strict=True))


class Exit(NamedTuple):
    """What the ego found behind a passage: whether somebody takes the room there, whether it `waits` before the passage for
    one of the `stops` behind."""

    way: Crossing
    stops: tuple[TimeConstraint, ...]
    is_taken: bool
    waits: bool


def view_of(snapshot: Snapshot, plan: NominalPlan, limits: VehicleLimits, ahead: Ahead) -> View:
    """Return what the pilot looks at."""
    return View(snapshot, plan, limits, ahead, tuple(crossings(snapshot, plan, ahead)))


def crossings(snapshot: Snapshot, plan: NominalPlan, ahead: Ahead) -> Iterator[Crossing]:
    """Yield the passages that matter now."""
    for index, connection, conflicts in ahead:
        passage = plan.passages[index]
        scale = (passage.end - passage.start) / max(connection.path.length, 0.1)
        first = max(0, int(max(passage.start - connection.hold_back, snapshot.s) / plan.curve.step))
        last = max(first + 1, int(passage.end / plan.curve.step) + 1)
        pace = _pace(plan, first, last) if first < len(plan.speed_limits) else connection.speed_limit
        turn = next((one for one in plan.turnarounds if one.holds(passage)), None)
        wait_at = _place_inside(connection, conflicts)
        in_the_way = frozenset(conflict.other.id for conflict in conflicts if conflict.waits_in_the_way)
        way = Crossing(
            index, passage, connection, scale, max(pace, 1.0), turn=turn, wait_at=wait_at, waits_in_the_way=in_the_way,
            swing=_swing(connection, conflicts), stub=_stub(plan, index),
        )  # fmt: skip
        ends = (way.at(conflict.region.own.end) for conflict in conflicts)
        posts = (way.at(conflict.region.post.start) for conflict in conflicts if _counts_behind(conflict))
        yield way._replace(last=max(ends, default=-math.inf), post=max(posts, default=-math.inf))


def _counts_behind(conflict: Conflict) -> bool:
    """Whether the ego may not stand behind a region with its rear in it: of those that merge, only where it has to let the
    others go first, for else they wait for who stands there."""
    return conflict.region.kind is ConflictKind.CROSSING or (
        conflict.region.kind is ConflictKind.MERGING and conflict.must_yield
    )


@kept(PLANS_KEPT)
def _pace(plan: NominalPlan, first: int, last: int) -> float:
    """Return the lowest speed limit of the samples `first` to `last` of C, m/s."""
    return float(plan.speed_limits[first:last].min())


def _stub(plan: NominalPlan, index: int) -> float:
    """Return how far before a stop line (m) the one before it is, where the map divides a road just before its junction:
    whoever stops at the line would stand with his front on the way over the node."""
    place = line = plan.passages[index].start
    for before in reversed(plan.passages[:index]):
        if place - before.end >= STUB_M or before.end - before.start >= NODE_M:
            break
        place = before.start
    return line - place


def _swing(connection: Connection, conflicts: tuple[Conflict, ...]) -> float:
    """Return how far before the stop line (m) the body begins to be in others' ways, where no way of the map reaches."""
    places = (conflict.region.own.start for conflict in conflicts)
    return max((REGION_MARGIN_M - place for place in places if place < -connection.hold_back), default=0.0)


def _place_inside(connection: Connection, conflicts: tuple[Conflict, ...]) -> float | None:
    """Return the waiting place (m of the path), moved back before the regions of those who go first, or whom no rule makes
    wait, that reach over it."""
    wait = connection.wait_at
    if wait is None:
        return None
    starts = (conflict.region.own.start for conflict in conflicts if conflict.must_yield or _is_unruled(conflict))
    return min([wait, *(start - REGION_MARGIN_M for start in starts if start >= wait - WAIT_SHIFT_M)])


def _is_unruled(conflict: Conflict) -> bool:
    """Whether ways cross and no rule makes either wait: left turns towards each other that SUMO's map lets meet."""
    return conflict.region.kind is ConflictKind.CROSSING and not conflict.is_yielded_to
