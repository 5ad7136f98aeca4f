"""Whole pictures before a junction, and all that the pilot tells of each: orders, reasons with their figures, regions,
what it foresees, what it rests on."""

import pytest
from helpers.cars import CAR
from helpers.curves import on_curve
from helpers.situations import Situation, before
from helpers.telling import again, told

from sumo_reactive.driver.controller import Step
from sumo_reactive.driver.nouns.traffic import RoadUser

NORTH_SOUTH, SOUTH_NORTH, SOUTH_WEST = ("from_north", "to_south"), ("from_south", "to_north"), ("from_south", "to_west")
WEST_EAST, EAST_WEST = ("from_west", "to_east"), ("from_east", "to_west")
PRIORITY, LIGHTS, ALL_WAY = "four_way_priority", "signalised_left_turns", "all_way_stop"
GREEN, YELLOW, RED = ({"centre": letters} for letters in ("GGgrrrGGgrrr", "y" * 12, "r" * 12))
Picture = tuple[Situation, Step]


def on(ego: Situation, route: tuple[str, str], position: float, speed: float, waiting: float = 0.0) -> RoadUser:
    """A car named after the road that it comes from."""
    return ego.other(route[0], f"{route[0]}_0", position, speed, route, waiting)


def inside(ego: Situation, connection: str, at: float, speed: float) -> RoadUser:
    """A car inside the junction."""
    return ego.other("inside", ego.graph.connections[connection].parts[0], at, speed, (connection.split("->")[1][:-2],))


def minor_road() -> Picture:
    ego = before(PRIORITY, SOUTH_WEST, 1.0, 0.0)
    return ego, ego.step(on(ego, WEST_EAST, -26.0, 13.0), on(ego, EAST_WEST, -70.0, 13.0))


def goes_before() -> Picture:
    ego = before(PRIORITY, SOUTH_NORTH, 20.0, 8.0)
    return ego, ego.step(on(ego, WEST_EAST, -60.0, 8.0), on(ego, EAST_WEST, -190.0, 11.0))


def region_taken() -> Picture:
    ego = before(PRIORITY, SOUTH_NORTH, 12.0, 5.0)
    return ego, ego.step(inside(ego, "from_west_0->to_east_0", 9.0, 0.0))


def no_room_behind() -> Picture:
    ego = before(PRIORITY, SOUTH_NORTH, 15.0, 6.0)
    return ego, ego.step(ego.other("queue", "to_north_0", 3.5, 0.0, ("to_north",), 20.0))


def foe_too_fast() -> Picture:
    ego = before(PRIORITY, WEST_EAST, 24.0, 13.0)
    return ego, ego.step(on(ego, SOUTH_NORTH, -13.0, 13.0))


def left_turn() -> Picture:
    ego = before(LIGHTS, SOUTH_WEST, 8.0, 6.0, lane=1)
    return ego, ego.step(on(ego, NORTH_SOUTH, -25.0, 13.0), lights=GREEN)


def late_yellow() -> Picture:
    ego = before(LIGHTS, SOUTH_NORTH, 15.0, 13.0)
    return ego, ego.step(lights=YELLOW)


def red() -> Picture:
    ego = before(LIGHTS, SOUTH_NORTH, 30.0, 13.0)
    return ego, again(ego, on(ego, NORTH_SOUTH, -25.0, 13.0), lights=RED)


def goes_after() -> Picture:
    ego = before(PRIORITY, SOUTH_NORTH, 20.0, 8.0)
    return ego, ego.step(on(ego, WEST_EAST, -6.0, 13.0))


def far_from_it() -> Picture:
    ego = before(PRIORITY, SOUTH_NORTH, 58.0, 8.0)
    return ego, ego.step(on(ego, WEST_EAST, -60.0, 8.0))


def standing_at_red() -> Picture:
    ego = before(LIGHTS, SOUTH_NORTH, 1.0, 0.0)
    return ego, again(ego, on(ego, NORTH_SOUTH, -25.0, 13.0), lights=RED)


def another_turn() -> Picture:
    ego = before(ALL_WAY, WEST_EAST, 1.0, 0.0).having_stood(1.0)
    return ego, ego.step(on(ego, NORTH_SOUTH, -1.0, 0.0, waiting=2.5), on(ego, SOUTH_NORTH, -30.0, 9.0))


def stop_sign() -> Picture:
    ego = before(ALL_WAY, WEST_EAST, 30.0, 9.0)
    return ego, again(ego)


def full_stop_made() -> Picture:
    ego = before(ALL_WAY, WEST_EAST, 1.0, 0.0)
    return ego, ego.step()


def crossing_now() -> Picture:
    ego = before(PRIORITY, SOUTH_NORTH, 10.0, 8.0)
    front = ego.line + 8.0
    drive = ego.drive()._replace(ego=on_curve(ego.plan.curve, front, 8.0), s=front - CAR.front_overhang)
    return ego, ego.step(on(ego, WEST_EAST, -30.0, 12.0), drive=drive, time=ego.time + 2.0)


def from_the_right() -> Picture:
    ego = before("right_before_left", SOUTH_NORTH, 12.0, 6.0)
    return ego, ego.step(on(ego, EAST_WEST, -12.0, 7.0), on(ego, WEST_EAST, -15.0, 6.0))


TELLINGS = {
    minor_road: """
CAUTIOUS: STOP, YIELD
stop at 0.00 until 104.78 YIELD_TO from_south_0->to_west_0|from_west_0->to_east_0 from_west
tuned 10.00 1.00 1.00
CAUTIOUS because YIELD_TO from_south_0->to_west_0|from_west_0->to_east_0 from_west
- arrival_s 2.26 clearance_s 4.19 foe_arrival_s 2.20 foe_clearance_s 3.06
CLAIMED from_south_0->to_west_0|from_west_0->to_east_0 from_west
CLAIMED from_south_0->to_west_0|from_east_0->to_west_0 from_east
7 regions
FAILURE late 1.01 for 0.00
meets from_west at 102.26 4.09 161.00 156.84
rests on from_east from_west is_standing asks
from_east at from_south_0->to_west_0|from_east_0->to_west_0
from_west at from_south_0->to_west_0|from_west_0->to_east_0
2 can be reached, stages (2, 0, 0)
may go by from_south_0->to_west_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    goes_before: """
CAUTIOUS: APPROACH, DRIVE
tuned 10.00 1.00 1.00
CROSSING passes YIELD_TO from_south_0->to_north_0|from_west_0->to_east_0 from_west
- arrival_s 2.36 clearance_s 2.81 foe_arrival_s 5.71 foe_clearance_s 9.32
6 regions
FINE late 0.34 for 0.00
rests on from_east from_west asks
from_east at from_south_0->to_north_0|from_east_0->to_west_0
from_west at from_south_0->to_north_0|from_west_0->to_east_0
2 can be reached, stages (1, 0, 0)
may go by from_south_0->to_north_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    region_taken: """
CAUTIOUS: STOP, YIELD
stop at 0.00 REGION_OCCUPIED from_south_0->to_north_0|from_west_0->to_east_0 inside
tuned 10.00 1.00 1.00
CAUTIOUS because REGION_OCCUPIED from_south_0->to_north_0|from_west_0->to_east_0 inside
- arrival_s 2.27 clearance_s 91.80 foe_arrival_s 0.00 foe_clearance_s 56.00
CAUTIOUS because EXIT_BLOCKED from_south_0->to_north_0 inside
OCCUPIED from_south_0->to_north_0|from_west_0->to_east_0 inside
6 regions
FAILURE late 6.05 for 0.00
meets inside at 102.27 4.50 161.60 157.30
rests on inside asks
inside at from_south_0->to_north_0|from_west_0->to_east_0
1 can be reached, stages (1, 0, 0)
may go by from_south_0->to_north_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    no_room_behind: """
CAUTIOUS: STOP, YIELD
stop at 0.00 EXIT_BLOCKED from_south_0->to_north_0 queue
from 7.50 until 100.50 REGION_OCCUPIED from_south_0->to_north_0|from_west_0->to_north_0 queue
from 9.10 until 100.50 REGION_OCCUPIED from_south_0->to_north_0|from_east_0->to_north_0 queue
tuned 10.00 1.00 1.00
CAUTIOUS because EXIT_BLOCKED from_south_0->to_north_0 queue
CROSSING passes REGION_OCCUPIED from_south_0->to_north_0|from_west_0->to_north_0 queue
- arrival_s 2.61 clearance_s 83.81 foe_arrival_s 0.00 foe_clearance_s 12.00
CROSSING passes REGION_OCCUPIED from_south_0->to_north_0|from_east_0->to_north_0 queue
- arrival_s 2.75 clearance_s 83.81 foe_arrival_s 0.00 foe_clearance_s 12.00
OCCUPIED from_south_0->to_north_0|from_west_0->to_north_0 queue
OCCUPIED from_south_0->to_north_0|from_east_0->to_north_0 queue
6 regions
DEGRADED late 5.27 for 0.00
rests on queue asks
queue at from_south_0->to_north_0|from_east_0->to_north_0
queue at from_south_0->to_north_0|from_west_0->to_north_0
2 can be reached, stages (1, 0, 0)
may go by from_south_0->to_north_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    foe_too_fast: """
CAUTIOUS: STOP, YIELD
stop at 0.00 until 101.83 FOE_CANNOT_STOP from_west_0->to_east_0|from_south_0->to_north_0 from_south
tuned 10.00 1.00 1.00
CAUTIOUS because FOE_CANNOT_STOP from_west_0->to_east_0|from_south_0->to_north_0 from_south
- arrival_s 2.30 clearance_s 2.75 foe_arrival_s 1.28 foe_clearance_s 1.88
CLAIMED from_west_0->to_east_0|from_south_0->to_north_0 from_south
6 regions
FAILURE late 0.21 for 0.00
meets from_south at 102.30 7.70 160.50 158.40
rests on from_south asks
from_south at from_west_0->to_east_0|from_south_0->to_north_0
1 can be reached, stages (1, 0, 0)
may go by from_west_0->to_east_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    left_turn: """
CAUTIOUS: STOP, YIELD
stop at 10.03 until 103.42 YIELD_TO from_south_1->to_west_1|from_north_0->to_south_0 from_north
tuned 10.00 1.00 1.00
CAUTIOUS because YIELD_TO from_south_1->to_west_1|from_north_0->to_south_0 from_north
- arrival_s 3.28 clearance_s 4.21 foe_arrival_s 2.42 foe_clearance_s 3.19
CLAIMED from_south_1->to_west_1|from_north_0->to_south_0 from_north
4 regions
FAILURE late 0.70 for 0.00
meets from_north at 103.00 12.16 196.62 200.18
rests on from_north asks
from_north at from_south_1->to_west_1|from_north_0->to_south_0
1 can be reached, stages (1, 0, 0)
may go by from_south_1->to_west_1 100.00 stopped at
delay 0.00 on 100.00 0
""",
    late_yellow: """
CAUTIOUS: APPROACH, DRIVE
tuned 10.00 1.00 1.00
CROSSING passes YELLOW_TOO_CLOSE centre
- to_line_m 15.00 braking_needed_m_s2 5.63
5 regions
FINE late 0.21 for 0.00
rests on asks
0 can be reached, stages (1, 0, 0)
may go by 100.00 ('from_south_0->to_north_0', 100.0) stopped at
delay 0.00 on 100.00 0
""",
    red: """
CAUTIOUS: STOP, YIELD
stop at 0.00 RED_LIGHT centre
tuned 10.00 1.00 1.00
CAUTIOUS because RED_LIGHT centre
5 regions
DEGRADED late 5.83 for 0.00
rests on asks
0 can be reached, stages (1, 0, 0)
may go by 100.00 stopped at
delay 0.00 on 100.00 0
""",
    goes_after: """
CAUTIOUS: APPROACH, DRIVE
from 4.50 until 102.08 YIELD_TO from_south_0->to_north_0|from_west_0->to_east_0 from_west
tuned 10.00 1.00 1.00
CROSSING passes YIELD_TO from_south_0->to_north_0|from_west_0->to_east_0 from_west
- arrival_s 2.36 clearance_s 2.81 foe_arrival_s 1.01 foe_clearance_s 1.58
6 regions
FINE late 0.34 for 0.00
rests on from_west asks
from_west at from_south_0->to_north_0|from_west_0->to_east_0
1 can be reached, stages (1, 0, 0)
may go by from_south_0->to_north_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    far_from_it: """
NORMAL: FOLLOW_CURVE, DRIVE
tuned 10.00 1.00 1.00
6 regions
FINE late 0.34 for 0.00
rests on
1 can be reached, stages (0, 0, 0)
may go by from_south_0->to_north_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    standing_at_red: """
CAUTIOUS: STOP, YIELD
stop at 0.00 RED_LIGHT centre
tuned 10.00 1.00 1.00
CAUTIOUS because RED_LIGHT centre
5 regions
DEGRADED late 7.12 for 0.00
rests on is_standing is_settled asks
0 can be reached, stages (2, 0, 0)
may go by 100.00 stopped at
delay 0.00 on 100.00 0
""",
    another_turn: """
CAUTIOUS: STOP, YIELD
stop at 0.00 WAIT_FOR_TURN from_west_0->to_east_0|from_north_0->to_south_0 from_north
tuned 10.00 1.00 1.00
CAUTIOUS because WAIT_FOR_TURN from_west_0->to_east_0|from_north_0->to_south_0 from_north
- arrival_s 2.35 clearance_s 3.36 foe_arrival_s 3.41 foe_clearance_s 156.00
CLAIMED from_west_0->to_east_0|from_north_0->to_south_0 from_north
6 regions
FAILURE late 0.80 for 0.00
meets from_north at 102.35 4.50 137.30 138.40
rests on from_north from_south is_standing asks
from_north at from_west_0->to_east_0|from_north_0->to_south_0
2 can be reached, stages (2, 0, 0)
may go by from_west_0->to_east_0 100.00 stopped at from_west_0->to_east_0
delay 0.00 on 100.00 0
""",
    stop_sign: """
CAUTIOUS: STOP, YIELD
stop at 0.00 STOP_SIGN
tuned 10.00 1.00 1.00
CAUTIOUS because STOP_SIGN
6 regions
DEGRADED late 5.22 for 0.00
rests on asks
0 can be reached, stages (1, 0, 0)
may go by from_west_0->to_east_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
    full_stop_made: """
CAUTIOUS: APPROACH, DRIVE
tuned 10.00 1.00 1.00
6 regions
FINE late 0.80 for 0.00
rests on is_standing asks
0 can be reached, stages (2, 0, 0)
may go by from_west_0->to_east_0 100.00 stopped at from_west_0->to_east_0
delay 0.00 on 100.00 0
""",
    crossing_now: """
CROSSING: CROSS, DRIVE
tuned 10.00 1.00 1.00
OWN from_south_0->to_north_0|from_east_0->to_south_0
OWN from_south_0->to_north_0|from_west_0->to_east_0
OWN from_south_0->to_north_0|from_north_0->to_east_0
OWN from_south_0->to_north_0|from_west_0->to_north_0
OWN from_south_0->to_north_0|from_east_0->to_west_0
6 regions
FINE late 1.04 for 14.40
rests on from_west is_off_nominal asks
1 can be reached, stages (3, 0, 1)
may go by 102.00 stopped at
delay 0.25 on 102.00 0
""",
    from_the_right: """
CAUTIOUS: STOP, YIELD
stop at 0.00 until 102.93 YIELD_TO from_south_0->to_north_0|from_east_0->to_west_0 from_east
tuned 10.00 1.00 1.00
CAUTIOUS because YIELD_TO from_south_0->to_north_0|from_east_0->to_west_0 from_east
- arrival_s 2.53 clearance_s 3.28 foe_arrival_s 2.05 foe_clearance_s 3.34
CLAIMED from_south_0->to_north_0|from_east_0->to_west_0 from_east
6 regions
FAILURE late 0.25 for 0.00
meets from_east at 102.53 7.70 121.60 120.50
rests on from_east from_west asks
from_east at from_south_0->to_north_0|from_east_0->to_west_0
2 can be reached, stages (1, 0, 0)
may go by from_south_0->to_north_0 100.00 stopped at
delay 0.00 on 100.00 0
""",
}


@pytest.mark.parametrize("picture", TELLINGS, ids=lambda picture: picture.__name__)
def test_the_pilot_tells_of_a_junction_what_it_does_and_why(picture):
    assert told(*picture()) == TELLINGS[picture].strip().splitlines()
