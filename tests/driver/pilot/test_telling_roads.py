"""Whole pictures on roads, and everything that the pilot tells of each: passing, changing lanes, stops, escapes, turns."""

from dataclasses import replace

import pytest
from helpers.cars import CAR
from helpers.situations import PERIOD, Situation, before
from helpers.telling import again, told

from sumo_reactive.driver.controller import Controller, Step
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.nouns.plan import Aside, Move, Turnaround
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.pilot.memory import Overtaking
from sumo_reactive.driver.world.route import ScheduledStop

COUNTRY, ONCOMING = ("eastbound", "eastbound_out"), ("westbound", "westbound_out")
ROAD, TO_EXIT = ("road_before_exit", "road_after_exit"), ("road_before_exit", "exit")
SLOW, LOCK = 8.5, 0.6
Picture = tuple[Situation, Step]


def far(ego: Situation, *users: RoadUser, **remembered) -> Picture:
    """A step of an ego that looks far and remembers this."""
    ego = ego.remembering(**remembered)
    return ego, Controller(graph=ego.graph, limits=CAR).step(ego.traffic(*users, sight=600.0), ego.drive(), PERIOD)


def late(away: float = 620.0) -> Situation:
    return before("two_way_road", COUNTRY, away, SLOW).late_by(3.0)


def beside(ego: Situation, name: str, ahead: float, speed: float, lane: int = 0) -> RoadUser:
    """A car on another lane of the ego's road, its front so far before the ego's."""
    user = ego.ahead(name, ahead - 4.7, speed)
    return ego.other(name, f"{ego.route[0]}_{lane}", user.lane_position, speed, ego.route)


def follows() -> Picture:
    ego = late()
    return ego, ego.step(ego.ahead("x", 10.5, SLOW))


def pulls_out() -> Picture:
    ego = late()
    return far(ego, ego.ahead("x", 10.5, SLOW), ego.other("comes", "westbound_0", -560.0, 20.0, ONCOMING))


def meets_oncoming() -> Picture:
    ego = late()
    return far(ego, ego.ahead("x", 10.5, SLOW), ego.other("comes", "westbound_0", -300.0, 20.0, ONCOMING))


def short_road() -> Picture:
    ego = late(110.0)
    return far(ego, ego.ahead("x", 10.5, SLOW))


def several_lanes() -> Picture:
    ego = before("multi_lane_road", ROAD, 380.0, SLOW).late_by(3.0)
    return far(ego, ego.ahead("x", 10.5, SLOW), beside(ego, "behind", -60.0, 15.0, 1))


def lane_beside_taken() -> Picture:
    ego = before("multi_lane_road", ROAD, 380.0, SLOW).late_by(3.0)
    return far(ego, ego.ahead("x", 10.5, SLOW), beside(ego, "behind", -20.0, 15.0, 1))


def past_a_halted() -> Picture:
    ego = before("blocked_lane", COUNTRY, 300.0, 6.0)
    return far(ego, ego.ahead("x", 20.0, 0.0, halted=True))


def on_the_way_past(x_ahead: float, *others: tuple[float, float], instruction=Instruction.OVERTAKE) -> Picture:
    aside = Aside(2.5, 100.0, 140.0)
    ego = before("two_way_road", COUNTRY, 600.0, 15.0, to_left=2.5, aside=aside)
    users = [ego.other(f"c{away:g}", "westbound_0", -away, speed, ONCOMING) for away, speed in others]
    under_way = Overtaking(("x",), 95.0, instruction)
    return far(ego, ego.ahead("x", x_ahead, SLOW), *users, behaviour=Behaviour.OVERTAKING, overtaking=under_way)


def passing() -> Picture:
    return on_the_way_past(-5.0)


def gap_is_lost() -> Picture:
    return on_the_way_past(9.0, (230.0, 20.0))


def gap_is_lost_beside() -> Picture:
    return on_the_way_past(-4.0, (190.0, 20.0))


def has_passed() -> Picture:
    return on_the_way_past(-30.0)


def comes_back() -> Picture:
    return on_the_way_past(-30.0, instruction=Instruction.RETURN)


def keeps_room() -> Picture:
    ego = before("blocked_lane", COUNTRY, 300.0, 10.0)
    return ego, ego.step(ego.ahead("x", 50.0, 0.0, halted=True))


def backs_up() -> Picture:
    ego = before("blocked_lane", COUNTRY, 200.0, 0.0)
    return ego, ego.step(ego.ahead("x", 3.0, 0.0, halted=True))


def is_blocked() -> Picture:
    ego = before("multi_lane_road", ROAD, 380.0, 0.0, lane=2)
    return stuck(ego, ego.ahead("x", 3.0, 0.0, halted=True))


def stuck(ego: Situation, *users: RoadUser, escapes: int = 0) -> Picture:
    drive = ego.step(*users).drive
    memory = drive.memory._replace(progress_s=drive.s, progress_time=ego.time - 100.0, escapes=escapes)
    return ego, ego.step(*users, drive=drive._replace(ego=ego.ego, memory=memory), time=ego.time + PERIOD)


def wants_a_new_curve() -> Picture:
    return stuck(before("blocked_lane", COUNTRY, 200.0, 0.0))


def wants_more_commands() -> Picture:
    return stuck(before("blocked_lane", COUNTRY, 200.0, 0.0), escapes=1)


def changes_lanes() -> Picture:
    ego = before("multi_lane_road", TO_EXIT, 200.0, 15.0, lane=1)
    return ego, ego.step(beside(ego, "behind", -70.0, 15.0), beside(ego, "before", 40.0, 15.0))


def waits_for_a_gap() -> Picture:
    ego = before("multi_lane_road", TO_EXIT, 60.0, 0.0, lane=1).remembering(waiting_since=20.0, standing_since=20.0)
    return ego, ego.step(beside(ego, "beside", -2.0, 5.0), beside(ego, "before", 5.0, 5.0))


def misses_its_turn() -> Picture:
    ego = before("multi_lane_road", TO_EXIT, 22.0, 0.0, lane=1)
    ego = ego.remembering(waiting_since=70.0, standing_since=70.0, behaviour=Behaviour.CHANGING_LANES)
    return ego, ego.step(beside(ego, "beside", -2.0, 5.0), beside(ego, "before", 5.0, 5.0))


def reaches_its_stop() -> Picture:
    ego = before("four_way_priority", ("from_west", "to_east"), 100.0, 0.0, stops=(ScheduledStop("from_west_0", 53.8, 4.0),))
    return ego, again(ego)


def turns_round() -> Picture:
    ego = turning(1.0, 0.0)
    return ego, ego.step()


def before_a_turn() -> Picture:
    ego = turning(8.0, 3.0)
    return ego, ego.step()


def turning(away: float, speed: float) -> Situation:
    """The ego before a turn in two moves, `away` m ahead of its bumper."""
    ego = before("blocked_lane", COUNTRY, 300.0, speed)
    heading, bend, start = ego.ego.pose.heading, 0.56 / CAR.wheelbase, ego.seen().front + away
    moves = Move(gear=1, steering_angle=LOCK, bend=bend, until=heading + 0.9), Move(
        gear=-1, steering_angle=-LOCK, bend=-bend, until=heading + 3.1, is_last=True
    )
    turn = Turnaround(
        start=start, line=start + 1.0, end=start + 6.0, from_lane="eastbound_0", from_index=0, to_lane="eastbound_out_0",
        route_index=1, moves=moves, duration=20.0, into=5.0,
    )  # fmt: skip
    return replace(ego, plan=replace(ego.plan, turnarounds=(turn,)))


TELLINGS = {
    follows: """
NORMAL: FOLLOW_CURVE, DRIVE
looks 600.00
tuned 10.00 1.00 1.00
NORMAL passes FOLLOWS x
0 regions
DEGRADED late 6.42 for 0.00
rests on x PASS_TRIED in 1.50
0 can be reached, stages
may go by 100.00 stopped at
delay 3.00 on 100.00 0
""",
    pulls_out: """
OVERTAKING: OVERTAKE, DRIVE
asks for CURVE 0 0
leads 2.45 aside -542.99 -488.99
looks 600.00
tuned 4.00 1.00 0.60
OVERTAKING passes SLOW_AHEAD x
0 regions
DEGRADED late 6.42 for 0.00
rests on x asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 3.00 on 100.00 0 passing x 100.00 OVERTAKE
""",
    meets_oncoming: """
NORMAL: FOLLOW_CURVE, DRIVE
looks 600.00
tuned 10.00 1.00 1.00
OVERTAKING because NO_ROOM_TO_PASS comes x
0 regions
DEGRADED late 6.42 for 0.00
rests on x PASS_TRIED in 1.50
0 can be reached, stages
may go by 100.00 stopped at
delay 3.00 on 100.00 0
""",
    short_road: """
NORMAL: FOLLOW_CURVE, DRIVE
looks 600.00
tuned 10.00 1.00 1.00
OVERTAKING because NO_ROOM_TO_PASS the road ahead is too short x
0 regions
DEGRADED late 6.42 for 0.00
rests on x PASS_TRIED in 1.50
0 can be reached, stages
may go by 100.00 stopped at
delay 3.00 on 100.00 0
""",
    several_lanes: """
OVERTAKING: OVERTAKE, DRIVE
asks for CURVE 0 0
leads 3.20 aside -303.06 -241.47
looks 600.00
tuned 4.00 1.00 0.60
OVERTAKING passes SLOW_AHEAD x
0 regions
DEGRADED late 6.41 for 0.00
rests on x asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 3.00 on 100.00 0 passing x 100.00 OVERTAKE
""",
    lane_beside_taken: """
OVERTAKING: OVERTAKE, DRIVE
asks for CURVE 0 0
leads 3.20 aside -303.06 -241.47
looks 600.00
tuned 4.00 1.00 0.60
OVERTAKING passes SLOW_AHEAD x
0 regions
DEGRADED late 6.41 for 0.00
rests on x asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 3.00 on 100.00 0 passing x 100.00 OVERTAKE
""",
    past_a_halted: """
OVERTAKING: OVERTAKE, DRIVE
asks for CURVE 0 0
leads 2.45 aside -270.98 -236.45
looks 600.00
tuned 4.00 1.00 0.60
OVERTAKING passes SLOW_AHEAD x
0 regions
DEGRADED late 5.93 for 0.00
rests on x asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 passing x 100.00 OVERTAKE
""",
    passing: """
OVERTAKING: OVERTAKE, DRIVE
asks for CURVE 0 0
leads 2.50 aside -570.43 -518.01
looks 600.00
tuned 4.00 1.00 0.60
OVERTAKING passes SLOW_AHEAD x
0 regions
FINE late 0.33 for 0.00
rests on asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 passing x 95.00 OVERTAKE
""",
    gap_is_lost: """
OVERTAKING: FALL_BACK, DRIVE
asks for CURVE 0 0
looks 600.00
tuned 10.00 1.35 1.00
OVERTAKING because GAP_LOST c230
0 regions
FAILURE late 0.33 for 0.00
meets c230 at 103.00 -545.73 295.21 100.90
rests on c230 asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 passing x 95.00 FALL_BACK
""",
    gap_is_lost_beside: """
OVERTAKING: OVERTAKE, DRIVE
from -600.09 to 4.50 GAP_LOST
looks 600.00
tuned 4.00 1.00 0.60
OVERTAKING because GAP_LOST c190
0 regions
FAILURE late 0.33 for 0.00
meets c190 at 102.00 -565.85 275.09 100.90
rests on c190 asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 passing x 95.00 OVERTAKE
""",
    has_passed: """
OVERTAKING: RETURN, DRIVE
asks for CURVE 0 0
looks 600.00
tuned 10.00 1.00 1.00
OVERTAKING passes SLOW_AHEAD x
0 regions
FINE late 0.33 for 0.00
rests on asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 passing x 95.00 RETURN
""",
    comes_back: """
OVERTAKING: RETURN, DRIVE
looks 600.00
tuned 10.00 1.00 1.00
OVERTAKING passes SLOW_AHEAD x
0 regions
FINE late 0.33 for 0.00
rests on asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 passing x 95.00 RETURN
""",
    keeps_room: """
NORMAL: STOP, YIELD
stop at -258.00 BLOCKED x
looks 600.00
tuned 10.00 1.00 1.00
STOPPING because BLOCKED x
NORMAL passes FOLLOWS x
0 regions
FINE late 4.39 for 0.00
rests on x PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0
""",
    backs_up: """
BACKING_UP: BACK_UP, YIELD
stop at -205.00 BLOCKED x
looks 600.00
tuned 10.00 1.00 1.00
NORMAL passes FOLLOWS x
BACKING_UP because BLOCKED x
0 regions
DEGRADED late 7.12 for 0.00
rests on x is_standing asks PASS_TRIED in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0
""",
    is_blocked: """
NORMAL: FOLLOW_CURVE, DRIVE
tuned 10.00 1.00 1.00
NORMAL passes FOLLOWS x
STOPPING because BLOCKED x
0 regions
DEGRADED late 7.22 for 0.00
rests on x is_standing
0 can be reached, stages
may go by 100.10 stopped at
delay 0.00 on 0.00 1
""",
    wants_a_new_curve: """
NORMAL: FOLLOW_CURVE, DRIVE
asks for CURVE 0 0
tuned 10.00 1.00 1.00
STOPPING because NO_PROGRESS
0 regions
FINE late 1.06 for 0.00
rests on is_standing
0 can be reached, stages
may go by 100.10 stopped at
delay 0.00 on 0.00 1
""",
    wants_more_commands: """
NORMAL: WIDEN, DRIVE
from -199.99 to 1.00 NO_PROGRESS
tuned 4.00 1.00 1.00
STOPPING because NO_PROGRESS
0 regions
FINE late 1.06 for 0.00
rests on is_standing
0 can be reached, stages
may go by 100.10 stopped at
delay 0.00 on 0.00 2
""",
    changes_lanes: """
CHANGING_LANES: FOLLOW_CURVE, DRIVE
asks for CURVE -1 0
tuned 10.00 1.00 1.00
0 regions
FINE late 0.25 for 0.00
rests on is_seeking asks GAP_SOUGHT in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0
""",
    waits_for_a_gap: """
CHANGING_LANES: STOP, YIELD
stop at -20.25 NO_GAP road_before_exit_0 beside
from -60.24 NO_GAP behind beside
tuned 10.00 1.00 1.00
CHANGING_LANES because NO_GAP road_before_exit_0 beside
0 regions
FINE late 0.94 for 0.00
rests on is_standing is_seeking asks GAP_SOUGHT in 0.40
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 waits since 20.00
""",
    misses_its_turn: """
TAKING_ANOTHER_WAY: STOP, YIELD
stop at -20.28 NO_GAP road_before_exit_0 beside
from -22.28 NO_GAP behind beside
asks for ROUTE 0 0
tuned 10.00 1.00 1.00
CHANGING_LANES because NO_GAP road_before_exit_0 beside
0 regions
FAILURE late 1.03 for 0.00
meets beside at 103.40 -10.31 585.76 93.54
rests on is_standing is_seeking asks GAP_SOUGHT in 0.40
0 can be reached, stages
may go by road_before_exit_0->exit_0 100.00 stopped at
delay 0.00 on 100.00 0 waits since 70.00
""",
    reaches_its_stop: """
STOPPING: STOP, YIELD
stop at -99.00 SCHEDULED_STOP from_west_0
tuned 10.00 1.00 1.00
STOPPING because SCHEDULED_STOP from_west_0
0 regions
DEGRADED late 6.74 for -99.00
rests on is_standing is_settled asks halts
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 serves until 104.00
""",
    turns_round: """
TURNING_ROUND: TURN_ROUND, DRIVE
moves 1 0.60 0.90
tuned 10.00 1.00 1.00
TURNING_ROUND passes NARROW_TURN 2 moves
0 regions
FINE late 0.96 for 0.00
rests on is_standing asks halts
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0 move (0, 0)
""",
    before_a_turn: """
TURNING_ROUND: STOP, YIELD
stop at -292.00 NARROW_TURN
tuned 10.00 1.00 1.00
TURNING_ROUND because NARROW_TURN
0 regions
FINE late 0.66 for 0.00
rests on asks halts
0 can be reached, stages
may go by 100.00 stopped at
delay 0.00 on 100.00 0
""",
}


@pytest.mark.parametrize("picture", TELLINGS, ids=lambda picture: picture.__name__)
def test_the_pilot_tells_of_a_road_what_it_does_and_why(picture):
    assert told(*picture()) == TELLINGS[picture].strip().splitlines()
