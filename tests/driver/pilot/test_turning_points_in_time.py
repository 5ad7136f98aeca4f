"""Where events come about, queues are left, room is kept and turns begin: each row one scene of which one figure grows."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest
from helpers.cars import CAR
from helpers.situations import Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.nouns.completed_plan import CompletedPlan
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.forecast import FREE_GROUND, Queue, Queued, TurningGround
from sumo_reactive.driver.nouns.plan import TURNAROUND_REACHED_M, Move, ParallelLane, Turnaround
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.behaviours.backing_up import escape, room_behind
from sumo_reactive.driver.pilot.behaviours.changing_queues import HEAD_STANDS_S, SWING_OUT_M, leave_queue
from sumo_reactive.driver.pilot.behaviours.turning_round import place_to_begin, turn_round
from sumo_reactive.driver.pilot.events import detect
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.pilot import notice
from sumo_reactive.driver.pilot.rules.region import ENTERING_M
from sumo_reactive.driver.pilot.situation import LaneChanging
from sumo_reactive.driver.view.ahead import passages_ahead

SOUTH_NORTH, WEST_EAST, STREET = ("from_south", "to_north"), ("from_west", "to_east"), ("eastbound", "eastbound_out")
ROAD = ("road_before_exit", "road_after_exit")
Holds = Callable[[float], bool]

ego_at = cache(before)


def minor() -> Situation:
    return ego_at("four_way_priority", SOUTH_NORTH, 100.0, 8.0)


def road(speed: float = 15.0) -> Situation:
    return ego_at("multi_lane_road", ROAD, 380.0, speed)


@cache
def first(ego: Situation, *users: RoadUser) -> tuple[CompletedPlan, PilotMemory]:
    """What the ego holds and remembers after a first step."""
    drive = ego.step(*users).drive
    assert drive.completed is not None
    return drive.completed, drive.memory


def events(ego: Situation, snapshot: Snapshot, *users: RoadUser, **remembered) -> list[EventKind]:
    """The kinds of what has happened since that step; what is not asked for is remembered so that nothing is due."""
    held, memory = first(ego, *users)
    patient = {"progress_time": snapshot.time, "delay": 1e4, **remembered}
    ahead = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    return [one.kind for one in detect(snapshot, ego.plan, ahead, held, memory._replace(**patient), no_command=False)]


def stage_changes(left: float, since: float = 60.0) -> bool:
    """Whether a junction is an event `left` m before its line for an ego that was `since` m before it."""
    ego = ego_at("four_way_priority", SOUTH_NORTH, since, 8.0)
    front = ego.line - left
    return EventKind.INTERSECTION in events(ego, ego.seen()._replace(front=front, s=front - CAR.front_overhang))


def after(kind: EventKind, **remembered) -> Holds:
    """Whether this has happened so many seconds after the first step."""
    ego = road()
    return lambda seconds: kind in events(ego, ego.seen()._replace(time=ego.time + seconds), **remembered)


def speed_changes(kind: EventKind, now: float) -> Holds:
    ego = road(now)
    return lambda speed: kind in events(ego, ego.at_speed(speed).seen())


def other_changes(speed: float) -> bool:
    ego = road()
    x = ego.ahead("x", 55.0, 8.0)
    return EventKind.OTHER_BEHAVIOUR in events(ego, ego.seen(x._replace(speed=speed)), x)


def lights() -> Situation:
    ego = ego_at("signalised_left_turns", ("from_south", "to_west"), 50.0, 6.0)
    return replace(ego, plan=replace(ego.plan, joins=0.0, lane_changes=()))


WAY = ParallelLane(from_lane="from_south_1", to_lane="from_south_0", side=-1, cost=1.0)


def queued(ahead: float, speed: float = 0.0, waiting: float = 60.0) -> Queued:
    stood = waiting if speed == 0.0 else 0.0
    return Queued(lights().other(f"x{ahead:g}", "from_south_0", 20.0, speed, (), stood), ahead, False)


def leaves(own: tuple[Queued, ...], beside=(), go: float = 20.0, x: float | None = None, ego=None, cost=1.0) -> LaneChanging:
    """What the ego makes of its queue, the light having let it go for `go` s, somebody `x` m ahead."""
    ego = lights() if ego is None else ego
    green = {"centre": "G" * 12}
    users = () if x is None else (ego.ahead("near", x, 0.0),)
    ways = ego.considered(lights=green).ways
    queues = Queue("from_south_1", own), Queue("from_south_0", tuple(beside), replace(WAY, cost=cost))
    memory = PilotMemory(released=(ways[0].connection.id, ego.time - go))
    outlook = ego.outlook()._replace(queues=queues)
    return leave_queue(ego.seen(*users, lights=green), ego.plan, outlook, ways, memory, CAR)


STUCK = (queued(30.0), queued(22.0))


def keeps_room(speed: float) -> Holds:
    """Whether the ego keeps room behind somebody who has halted so far ahead."""
    ego = ego_at("blocked_lane", STREET, 300.0, speed)
    return lambda gap: room_behind(ego.considered(ego.ahead("x", gap, 0.0, halted=True))) is not None


def backs_up(gap: float, speed: float = 0.0) -> bool:
    ego = ego_at("blocked_lane", STREET, 200.0, speed)
    found = escape(ego.considered(ego.ahead("x", gap, 0.0, halted=True)))
    return found is not None and found.instruction is Instruction.BACK_UP


def is_blamed(gap: float) -> bool:
    """Whether somebody who has halted so far ahead, and cannot be passed, is to blame that the ego does not get on."""
    ego = ego_at("multi_lane_road", ROAD, 380.0, 0.0, 2)
    found = escape(ego.considered(ego.ahead("x", gap, 0.0, halted=True), events=(Event(EventKind.NO_PROGRESS),)))
    return found is not None and found.decision.reason is Reason.BLOCKED


def begins(away: float = 1.0, speed: float = 0.0, stop: float | None = None, stood: float | None = None) -> bool:
    """Whether the ego begins its turn in several moves, `away` m ahead; `stood`: somebody comes over, it stood so long."""
    ego = ego_at("blocked_lane", STREET, 300.0, speed)
    start = ego.seen().front + away
    move = Move(gear=1, steering_angle=0.6, bend=0.23, until=ego.ego.pose.heading + 3.1, is_last=True)
    turn = Turnaround(
        start=start, line=start + 1.0, end=start + 6.0, from_lane="eastbound_0", from_index=0, to_lane="eastbound_out_0",
        route_index=1, moves=(move,), duration=20.0, into=5.0,
    )  # fmt: skip
    memory = PilotMemory() if stood is None else PilotMemory(standing_since=ego.time - stood)
    place = None if stop is None else stop_at(start + stop, Reason.RED_LIGHT)
    plan, over = replace(ego.plan, turnarounds=(turn,)), FREE_GROUND if stood is None else TurningGround(comes_over="x")
    reason = place_to_begin(ego.seen(), plan, memory, over).reason
    assert reason is (Reason.COMES_OVER if stood is not None and stood < USUAL.turnaround_patience_s else Reason.NARROW_TURN)
    return turn_round(ego.seen(), plan, place, memory, ground=over) is not None


BRAKING = 6.0**2 / (2.0 * CAR.comfort_deceleration)
ROWS: dict[str, tuple[Holds, float, float, float]] = {
    "m before the line that a junction is near": (
        stage_changes, 30.0, 90.0,
        USUAL.cautious_ahead_m + 8.0 * USUAL.cautious_ahead_s + 64.0 / (2.0 * USUAL.comfort_deceleration),
    ),
    "m before the line that the ego enters": (lambda m: stage_changes(m, 20.0), 1.0, 15.0, ENTERING_M),
    "m before the line that it is inside": (lambda m: stage_changes(m, 3.0), -2.0, 3.0, 0.0),
    "s until a delay": (after(EventKind.DELAY, delay=0.0), 0.0, 20.0, USUAL.delay_step_s),
    "s until a greater delay": (after(EventKind.DELAY, delay=4.0), 0.0, 20.0, USUAL.delay_step_s + 4.0),
    "s without progress": (after(EventKind.NO_PROGRESS, progress_time=100.0), 0.0, 90.0, USUAL.no_progress_s),
    "s without progress after two escapes": (
        after(EventKind.NO_PROGRESS, progress_time=100.0, escapes=2), 0.0, 90.0, 3.0 * USUAL.no_progress_s,
    ),
    "s until a stop is served": (after(EventKind.TIME_REACHED, serving_until=103.0), 0.0, 9.0, 3.0),
    "s until a constraint is missed": (
        after(EventKind.CONSTRAINT_MISSED), 0.0, 90.0, road().plan.time_constraints[0].time + USUAL.time_tolerance_s - 100.0,
    ),
    "m/s of a standstill": (speed_changes(EventKind.STANDSTILL, 0.0), 0.0, 2.0, STANDING_SPEED),
    "m/s off nominal": (
        speed_changes(EventKind.OFF_NOMINAL, 15.0), 8.0, 15.0,
        road().plan.on_schedule(road().seen().s, 0.0)[1] - USUAL.off_nominal_speed,
    ),
    "m/s of another who slows down": (other_changes, 4.0, 8.0, 8.0 - USUAL.behaviour_tolerance),
    "m/s of another who speeds up": (other_changes, 8.0, 12.0, 8.0 + USUAL.behaviour_tolerance),
    "s that a light has let a queue go": (
        lambda s: leaves(STUCK, go=s).side != 0, 0.5, 20.0, USUAL.queue_gain_s - 2 * USUAL.queue_headway_s,
    ),
    "s that its head has stood": (
        lambda s: leaves((queued(30.0, waiting=s), queued(22.0)), cost=0.6).side != 0, 0.5, 20.0, HEAD_STANDS_S,
    ),
    "m of a queue that drives off": (lambda m: leaves((queued(34.7 + m, 4.0), queued(30.0))).side != 0, 1.0, 30.0, 12.0),
    "m of room to swing out of a queue": (lambda m: leaves(STUCK, x=m).side != 0, 2.0, 40.0, SWING_OUT_M + BRAKING),
    "m that room is kept behind who has halted": (keeps_room(6.0), 8.0, 40.0, USUAL.halted_room_m + BRAKING - 0.5),
    "m that an ego which stands is near enough": (lambda m: keeps_room(0.0)(m), 5.0, 8.4, USUAL.halted_room_m - 1.5),
    "m that make the ego back up": (backs_up, 3.0, 8.0, USUAL.halted_room_m - 1.5),
    "m until which it backs up": (lambda m: backs_up(m, -0.5), 3.0, 9.0, USUAL.halted_room_m - 0.02),
    "m/s of an ego that does not back up": (lambda v: backs_up(3.0, v), 0.0, 1.0, STANDING_SPEED),
    "m ahead of who is to blame": (is_blamed, 3.0, 20.0, USUAL.halted_room_m + 1.0),
    "m before a turn in several moves": (lambda m: begins(away=m), 0.0, 5.0, TURNAROUND_REACHED_M),
    "m/s before a turn in several moves": (lambda v: begins(speed=v), 0.0, 1.0, STANDING_SPEED),
    "m behind its beginning that a stop keeps it": (lambda m: begins(stop=m), 2.0, 20.0, 11.0),
    "s that it lets others come over": (lambda s: begins(stood=s), 1.0, 60.0, USUAL.turnaround_patience_s),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_on_the_way_the_pilots_word_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.005)


@pytest.mark.parametrize(
    ("way", "escapes"), [(USUAL.progress_m - 0.1, 2), (USUAL.progress_m + 0.1, 0), (-USUAL.progress_m - 0.1, 0)]
)
def test_an_ego_that_gets_on_forgets_its_escapes(way, escapes):
    snapshot = minor().seen()
    memory = PilotMemory(progress_s=snapshot.s - way, progress_time=7.0, escapes=2, standing_since=50.0)
    found = notice(snapshot, memory)
    assert (found.escapes, found.standing_since) == (escapes, None)
    last = (snapshot.s, snapshot.time) if escapes == 0 else (snapshot.s - way, 7.0)
    assert (found.progress_s, found.progress_time) == last
