"""Which behaviour may follow which: the table is closed, and everything in it can be reached (F&L 1991, §2)."""

from pathlib import Path

import pytest
from helpers.situations import before

from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.pilot import behaviours
from sumo_reactive.driver.pilot.rules.highway_code import decision_of
from sumo_reactive.driver.pilot.transitions import RULES, TRANSITIONS, next_behaviour
from sumo_reactive.driver.world.route import ScheduledStop

WEST_EAST = ("from_west", "to_east")
SOUTH_NORTH = ("from_south", "to_north")


def test_every_behaviour_has_one_rule_and_one_row():
    assert set(RULES) == set(TRANSITIONS) == set(Behaviour)
    assert all(rule.behaviour is behaviour for behaviour, rule in RULES.items())


def test_every_behaviour_has_a_file_of_its_name():
    files = {file.stem for file in Path(behaviours.__file__).parent.glob("*.py")} - {"__init__"}
    assert files == {behaviour.name.lower() for behaviour in Behaviour}


@pytest.mark.parametrize(
    ("reason", "behaviour"),
    [
        (Reason.NO_GAP, Behaviour.CHANGING_LANES), (Reason.QUEUE_CHANGE, Behaviour.CHANGING_QUEUES),
        (Reason.NARROW_TURN, Behaviour.TURNING_ROUND), (Reason.COMES_OVER, Behaviour.TURNING_ROUND),
        (Reason.SCHEDULED_STOP, Behaviour.STOPPING), (Reason.YIELD_TO, Behaviour.CAUTIOUS),
    ],
)  # fmt: skip
def test_a_stop_is_decided_by_the_behaviour_that_asks_for_it(reason, behaviour):
    assert decision_of(stop_at(10.0, reason)).behaviour is behaviour


def test_the_table_leads_to_behaviours_only_and_never_to_itself():
    for behaviour, following in TRANSITIONS.items():
        assert set(following) <= set(Behaviour) - {behaviour}
        assert len(set(following)) == len(following)


def test_every_behaviour_can_be_reached_from_normal_driving():
    reached, queue = {Behaviour.NORMAL}, [Behaviour.NORMAL]
    while queue:
        new = set(TRANSITIONS[queue.pop()]) - reached
        reached |= new
        queue.extend(new)
    assert reached == set(Behaviour)


def test_every_behaviour_but_normal_driving_has_conditions_at_both_ends():
    for behaviour, rule in RULES.items():
        assert bool(rule.preconditions) == bool(rule.postconditions) == (behaviour is not Behaviour.NORMAL)


def in_behaviour(ego, behaviour, **options):
    return next_behaviour(ego.remembering(behaviour=behaviour).considered(**options))


@pytest.mark.parametrize("now", [Behaviour.NORMAL, Behaviour.STOPPING, Behaviour.CROSSING, Behaviour.OVERTAKING])
def test_a_behaviour_that_has_ended_gives_way_to_what_the_situation_asks_for(now):
    near, far = (before("four_way_priority", SOUTH_NORTH, away, 8.0) for away in (20.0, 140.0))
    assert in_behaviour(near, now) is Behaviour.CAUTIOUS
    assert in_behaviour(far, now) is Behaviour.NORMAL


def test_a_behaviour_goes_on_until_its_postconditions_hold():
    near = before("four_way_priority", SOUTH_NORTH, 20.0, 8.0)
    assert in_behaviour(near, Behaviour.CAUTIOUS) is Behaviour.CAUTIOUS


def test_a_stop_of_the_route_goes_before_cautious_driving():
    near = before("four_way_priority", WEST_EAST, 40.0, 8.0, stops=(ScheduledStop("from_west_0", 120.0, 4.0),))
    assert in_behaviour(near, Behaviour.CAUTIOUS) is Behaviour.STOPPING


def test_no_behaviour_interrupts_an_overtaking():
    near = before("four_way_priority", WEST_EAST, 40.0, 8.0, stops=(ScheduledStop("from_west_0", 120.0, 4.0),))
    near = near.passing("x", Instruction.OVERTAKE)
    assert in_behaviour(near, Behaviour.OVERTAKING) is Behaviour.OVERTAKING
