"""The five behaviours, each by its preconditions, instruction and postconditions as the paper states them (F&L 1991, §2)."""

from dataclasses import replace

import pytest
from helpers.cars import CAR
from helpers.situations import before

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.completed_plan import Replanning
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.nouns.plan import Aside
from sumo_reactive.driver.parameters import USUAL, Parameters
from sumo_reactive.driver.pilot.behaviours import cautious, crossing, normal, overtaking, stopping
from sumo_reactive.driver.pilot.instructions import TUNINGS
from sumo_reactive.driver.pilot.manoeuvre import proof
from sumo_reactive.driver.world.route import ScheduledStop

COUNTRY = ("eastbound", "eastbound_out")
ONCOMING = ("westbound", "westbound_out")
SOUTH_NORTH, WEST_EAST = ("from_south", "to_north"), ("from_west", "to_east")
FAR = 600.0
"""m; how far the ego that wants to overtake looks along the oncoming lane."""
SLOW = 8.5


def late(away: float = 620.0, speed: float = SLOW):
    """The ego on a country road, three seconds late, and later with each one that it spends behind somebody slow."""
    return before("two_way_road", COUNTRY, away, speed).late_by(3.0)


def forbids(situation) -> str | None:
    """Who or what forbids to pass X (None: nobody), whatever speaks for passing him."""
    found = proof(situation, situation.ahead_of_ego)
    return None if found.aside else found.obstacle


def may_overtake(ego, *users) -> bool:
    return overtaking.RULE.may_begin(ego.considered(*users, sight=FAR))


# --- overtaking: (M follows X) ∧ |v − v_d| < k₁ ∧ delay > k₂, where it is legal and the gap is proven -------------------


def test_overtaking_begins_when_every_precondition_holds():
    ego = late()
    situation = ego.considered(ego.ahead("x", 10.5, SLOW), sight=FAR)
    assert [holds.__name__ for holds in overtaking.RULE.preconditions if not holds(situation)] == []


def test_overtaking_begins_only_when_m_follows_x():
    ego = late()
    assert not may_overtake(ego)
    assert not overtaking.follows_x(ego.considered(ego.ahead("far", 50.0, SLOW)))
    assert not overtaking.follows_x(ego.considered(ego.ahead("fast", 10.5, 18.0)))
    assert not may_overtake(ego, ego.ahead("far", 50.0, SLOW))


def test_overtaking_begins_only_when_settled_v_near_v_d():
    ego = late(speed=12.0)
    situation = ego.considered(ego.ahead("x", 10.5, SLOW), sight=FAR)
    assert overtaking.follows_x(situation)
    assert not overtaking.has_settled(situation)
    assert not overtaking.RULE.may_begin(situation)


def test_overtaking_begins_only_when_delay_exceeds_k2():
    ego = before("two_way_road", COUNTRY, 620.0, SLOW)
    situation = ego.considered(ego.ahead("x", 10.5, SLOW), sight=FAR)
    assert all(holds(situation) for holds in (overtaking.follows_x, overtaking.has_settled, overtaking.is_legal))
    assert forbids(situation) is None
    assert not overtaking.is_late(situation)
    assert not overtaking.RULE.may_begin(situation)


def test_somebody_who_has_halted_is_overtaken_without_waiting_for_a_delay():
    ego = before("blocked_lane", COUNTRY, 300.0, 0.0)
    situation = ego.considered(ego.ahead("x", 9.0, 0.0, halted=True), sight=FAR)
    assert overtaking.RULE.may_begin(situation)


def test_somebody_who_stands_in_traffic_is_not_overtaken():
    ego = before("blocked_lane", COUNTRY, 300.0, 0.0).late_by(60.0)
    assert not may_overtake(ego, ego.ahead("queue", 9.0, 0.0))


def test_overtaking_does_not_begin_near_an_intersection():
    ego = late(away=40.0)
    situation = ego.considered(ego.ahead("x", 10.5, SLOW), sight=FAR)
    assert overtaking.follows_x(situation)
    assert not overtaking.is_legal(situation)
    assert not may_overtake(ego, ego.ahead("x", 10.5, SLOW))


def test_overtaking_does_not_begin_when_it_would_end_near_an_intersection():
    """X itself is still far enough from it."""
    ego = late(away=110.0)
    situation = ego.considered(ego.ahead("x", 10.5, SLOW), sight=FAR)
    assert overtaking.is_legal(situation)
    assert forbids(situation) == "the road ahead is too short"
    assert not overtaking.RULE.may_begin(situation)


def test_overtaking_does_not_begin_where_there_is_no_lane_to_pass_on():
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, SLOW, lane=2).late_by(3.0)
    situation = ego.considered(ego.ahead("x", 10.5, SLOW), sight=FAR)
    assert overtaking.follows_x(situation)
    assert not overtaking.is_legal(situation)


def test_on_a_road_of_several_lanes_the_ego_overtakes_on_the_next_one():
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, SLOW).late_by(3.0)
    x = ego.ahead("x", 10.5, SLOW)
    assert overtaking.RULE.may_begin(ego.considered(x, sight=FAR))
    beside = ego.other("beside", "road_before_exit_1", x.lane_position - 5.0, SLOW, ())
    assert forbids(ego.considered(x, beside, sight=FAR)) == "beside"
    assert not overtaking.RULE.may_begin(ego.considered(x, beside, sight=FAR))


def test_overtaking_does_not_begin_before_the_ego_has_looked_far():
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, SLOW).late_by(3.0)
    assert not overtaking.RULE.may_begin(ego.considered(ego.ahead("x", 10.5, SLOW)))


@pytest.mark.parametrize(("away", "is_proven"), [(100.0, False), (300.0, False), (500.0, True)])
def test_overtaking_does_not_begin_when_the_oncoming_gap_is_not_proven(away, is_proven):
    ego = late()
    x, comes = ego.ahead("x", 10.5, SLOW), ego.other("comes", "westbound_0", -away, 20.0, ONCOMING)
    assert forbids(ego.considered(x, comes, sight=FAR)) == (None if is_proven else "comes")
    assert may_overtake(ego, x, comes) is is_proven


def test_overtaking_does_not_begin_when_the_oncoming_lane_is_not_in_sight_far_enough():
    ego = late()
    situation = ego.considered(ego.ahead("x", 10.5, SLOW), sight=60.0)
    assert forbids(situation) == "the oncoming lane is not in sight far enough"
    assert not overtaking.RULE.may_begin(situation)


def test_who_wants_to_overtake_looks_far_along_the_oncoming_lane():
    ego = late()
    assert ego.step(ego.ahead("x", 10.5, SLOW)).completed.sight == FAR
    assert ego.step(ego.ahead("fast", 10.5, 18.0)).completed.sight == 0.0


def pulled_out():
    """The first step in which the ego pulls out."""
    ego = late()
    x = ego.ahead("x", 10.5, SLOW)
    steps = ego.driven_among(lambda t: [ego.later(x, t)], 3.0)
    return next(step for step in steps if step.completed.behaviour is Behaviour.OVERTAKING)


def test_overtaking_asks_for_a_curve_that_leads_past_x():
    completed = pulled_out().completed
    assert (completed.instruction, completed.request.what) == (Instruction.OVERTAKE, Replanning.CURVE)
    aside = completed.request.aside
    assert aside.lateral > 0.5 * (CAR.width + 1.8)
    assert completed.decisions[-1].reason is Reason.SLOW_AHEAD


def test_the_attraction_of_c_is_weakened_while_overtaking():
    weakened, usual = pulled_out().completed.tuning.weights, late().step().completed.tuning.weights
    assert weakened == TUNINGS[Instruction.OVERTAKE].weights
    assert weakened.valley < usual.valley


def passing(s_back: float, to_left: float, instruction: Instruction, away: float = 600.0):
    """The ego beside its lane, on a curve that leads it back from `s_back` m on within 10 m."""
    aside = Aside(to_left, s_back, s_back + 10.0)
    ego = before("two_way_road", COUNTRY, away, 15.0, to_left=to_left, aside=aside)
    return ego.remembering(behaviour=Behaviour.OVERTAKING).passing("x", instruction)


def test_the_ego_passes_on_until_x_is_behind_it_by_gap_and_headway():
    ego = passing(100.0, 2.5, Instruction.OVERTAKE)
    beside, behind = (ego.ahead("x", gap, SLOW) for gap in (-5.0, -30.0))
    going, done = (overtaking.carry_on(ego.considered(x, sight=FAR), ego.memory.overtaking) for x in (beside, behind))
    assert going.overtaking.instruction is Instruction.OVERTAKE
    assert (done.overtaking.instruction, done.replans, done.aside) == (Instruction.RETURN, True, None)


def test_the_ego_falls_back_when_the_gap_is_lost_before_it_has_drawn_level():
    ego = passing(100.0, 2.5, Instruction.OVERTAKE)
    x, comes = ego.ahead("x", 9.0, SLOW), ego.other("comes", "westbound_0", -230.0, 20.0, ONCOMING)
    step = overtaking.carry_on(ego.considered(x, comes, sight=FAR), ego.memory.overtaking)
    assert (step.overtaking.instruction, step.replans, step.aside) == (Instruction.FALL_BACK, True, None)
    assert (step.reason, step.cause) == (Reason.GAP_LOST, "comes")


def test_beside_x_the_ego_slows_down_before_it_falls_back():
    ego = passing(100.0, 2.5, Instruction.OVERTAKE)
    x, comes = ego.ahead("x", -4.0, SLOW), ego.other("comes", "westbound_0", -190.0, 20.0, ONCOMING)
    step = overtaking.carry_on(ego.considered(x, comes, sight=FAR), ego.memory.overtaking)
    assert (step.overtaking.instruction, step.replans) == (Instruction.OVERTAKE, False)
    assert step.top_speed < SLOW


@pytest.mark.parametrize("instruction", [Instruction.RETURN, Instruction.FALL_BACK])
@pytest.mark.parametrize(
    ("d", "is_back"), [(USUAL.off_curve_epsilon_m - 0.1, True), (USUAL.off_curve_epsilon_m + 0.1, False)]
)
def test_overtaking_ends_when_d_m_c_is_below_epsilon(instruction, d, is_back):
    ego = before("two_way_road", COUNTRY, 600.0, 15.0).passing("x", instruction)
    situation = ego.considered()
    placed = situation.snapshot._replace(s=situation.plan.joins + 1.0, d=d)
    assert overtaking.RULE.has_ended(situation._replace(snapshot=placed)) is is_back


def test_overtaking_does_not_end_while_x_is_being_passed_nor_before_c_is_the_lanes_centre_again():
    situation = before("two_way_road", COUNTRY, 600.0, 15.0).passing("x").considered()
    assert not overtaking.RULE.has_ended(situation)
    returning = passing(2.0, 2.5, Instruction.RETURN).considered()
    on_it = returning.snapshot._replace(s=8.0, d=0.0)
    assert not overtaking.RULE.has_ended(returning._replace(snapshot=on_it))


def test_an_ego_that_has_fallen_back_too_near_behind_somebody_halted_still_gets_out():
    """It stands beside C, and no command leads it back onto it: backing up does."""
    ego = before("blocked_lane", COUNTRY, 300.0, 0.0, to_left=0.6)
    ego = ego.remembering(behaviour=Behaviour.OVERTAKING).passing("x", Instruction.FALL_BACK)
    steps = ego.driven(60.0, ego.ahead("x", 3.0, 0.0, halted=True))
    assert {step.completed.behaviour for step in steps} != {Behaviour.OVERTAKING}


# --- cautious driving: M approaches an intersection ---------------------------------------------------------------------


@pytest.mark.parametrize(("away", "begins"), [(54.0, True), (56.0, False)])
def test_cautious_driving_begins_ten_metres_four_seconds_and_the_way_to_stop_before_the_line(away, begins):
    ego = before("four_way_priority", SOUTH_NORTH, away, 8.0)
    away_from_line = ego.line - ego.seen().front
    assert away_from_line == pytest.approx(away, abs=0.5)
    assert cautious.RULE.may_begin(ego.considered()) is begins
    assert not cautious.RULE.has_ended(ego.considered())  # who has slowed down on the approach is still on it


def test_where_nobody_crosses_and_no_light_speaks_there_is_no_cautious_driving():
    assert not cautious.RULE.may_begin(before("two_way_road", COUNTRY, 10.0, 8.0).considered())


def test_cautious_driving_ends_behind_the_line():
    ego = before("four_way_priority", SOUTH_NORTH, 10.0, 8.0)
    situation = ego.considered()
    past = situation._replace(snapshot=situation.snapshot._replace(front=ego.line + 0.1))
    assert cautious.RULE.has_ended(past)


def test_cautious_driving_approaches_ready_to_stop_and_stops_where_it_must():
    ego = before("four_way_priority", SOUTH_NORTH, 20.0, 8.0)
    assert cautious.RULE.instruction(ego.considered()) is Instruction.APPROACH
    assert cautious.RULE.instruction(ego.considered(stop=stop_at(ego.line, Reason.YIELD_TO))) is Instruction.STOP


# --- crossing: one vehicle at a time in a region, and room behind it --------------------------------------------------


def test_crossing_begins_behind_the_line_and_ends_behind_the_last_region():
    ego = before("four_way_priority", SOUTH_NORTH, 10.0, 8.0)
    situation, passage = ego.considered(), ego.plan.passages[0]

    def at(front: float):
        moved = situation.snapshot._replace(front=front, s=front - CAR.front_overhang)
        return situation._replace(snapshot=moved)

    assert not crossing.RULE.may_begin(at(passage.start - 0.1))
    assert crossing.RULE.may_begin(at(passage.start + 0.1))
    assert not crossing.RULE.has_ended(at(passage.end - 0.1))
    assert crossing.RULE.has_ended(at(passage.end + CAR.front_overhang + 0.1))


def test_crossing_does_not_stop_unless_it_must():
    ego = before("four_way_priority", SOUTH_NORTH, 10.0, 8.0)
    assert crossing.RULE.instruction(ego.considered()) is Instruction.CROSS
    assert crossing.RULE.instruction(ego.considered(stop=stop_at(30.0, Reason.YIELD_TO))) is Instruction.STOP


def in_region(ego):
    part = ego.graph.connections["from_west_0->to_east_0"].parts[0]
    return ego.other("inside", part, 9.0, 0.0, ("to_east",))


def behind_region(ego):
    return ego.other("queue", "to_north_0", 3.5, 0.0, ("to_north",), 20.0)


@pytest.mark.parametrize(
    ("who", "reason"), [(in_region, Reason.REGION_OCCUPIED), (behind_region, Reason.EXIT_BLOCKED)], ids=["in", "behind"]
)
def test_the_ego_enters_a_region_only_if_it_is_free_and_the_post_conflict_region_too(who, reason):
    ego = before("four_way_priority", SOUTH_NORTH, 12.0, 5.0)
    assert ego.stop() is None
    completed = ego.step(who(ego)).completed
    assert completed.stop.s <= ego.line + 1e-9
    assert any(decision.reason is reason and not decision.passes for decision in completed.decisions)


@pytest.mark.parametrize(("away", "stops"), [(8.0, True), (3.0, False)])
def test_the_ego_keeps_a_junction_clear_only_where_planned_braking_stops_it_before_the_line(away, stops):
    ego = before("four_way_priority", SOUTH_NORTH, away, 5.0)
    decisions = ego.step(behind_region(ego)).completed.decisions
    assert any(decision.reason is Reason.EXIT_BLOCKED for decision in decisions) is stops


# --- stopping and normal driving --------------------------------------------------------------------------------------


def test_stopping_is_for_the_stops_of_the_route_and_ends_when_they_are_served():
    halt = ScheduledStop("from_west_0", 100.0, 4.0)
    ego = before("four_way_priority", WEST_EAST, 60.0, 8.0, stops=(halt,))
    far, served = before("four_way_priority", WEST_EAST, 140.0, 2.0, stops=(halt,)), ego.remembering(served=(halt,))
    found = [(stopping.RULE.may_begin(one.considered()), stopping.RULE.has_ended(one.considered())) for one in (ego, served)]
    assert found == [(True, False), (False, True)]
    assert not stopping.RULE.may_begin(far.considered())
    assert stopping.RULE.instruction(ego.considered()) is Instruction.STOP


def test_a_stop_of_the_route_behind_a_line_waits_until_the_line_is_passed():
    ego = before("four_way_priority", WEST_EAST, 20.0, 8.0, stops=(ScheduledStop("to_east_0", 5.0, 4.0),))
    assert not stopping.RULE.may_begin(ego.considered())


@pytest.mark.parametrize("has_rules", [True, False])
def test_an_ego_that_is_kept_in_normal_driving_runs_a_red_light_and_takes_a_right_of_way(has_rules):
    limits = replace(CAR, parameters=Parameters(without=Mechanism.NONE if has_rules else Mechanism.BEHAVIOURS))
    red = replace(before("signalised_left_turns", ("from_south", "to_west"), 30.0, 8.0, lane=1), limits=limits)
    letters = {red.connection.light.light_id: "r" * 40}
    assert (red.driven(8.0, lights=letters)[-1].snapshot.front > red.line) is not has_rules
    ego = replace(before("four_way_priority", SOUTH_NORTH, 30.0, 8.0), limits=limits)
    coming = ego.other("coming", "from_west_0", -25.0, 8.0, WEST_EAST)
    steps = ego.driven_among(lambda t: [ego.later(coming, t)], 6.0)
    assert any(step.completed.stop for step in steps) is has_rules


def test_normal_driving_asks_for_nothing_and_follows_c():
    ego = before("two_way_road", COUNTRY, 600.0, 15.0)
    assert (normal.RULE.preconditions, normal.RULE.postconditions) == ((), ())
    assert normal.RULE.instruction(ego.considered()) is Instruction.FOLLOW_CURVE
    assert ego.step().completed.behaviour is Behaviour.NORMAL
