"""What was found at the regions and behind them holds until it is otherwise, and then that is an event."""

import pytest
from helpers.cars import CAR
from helpers.situations import PERIOD, Situation, before

from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.overturned import overturned
from sumo_reactive.driver.pilot.passages import view_of
from sumo_reactive.driver.pilot.pilot import notice
from sumo_reactive.driver.pilot.rules.region import carried_on, judgements
from sumo_reactive.driver.view.ahead import passages_ahead

SOUTH_NORTH, SOUTH_WEST, WEST_EAST = ("from_south", "to_north"), ("from_south", "to_west"), ("from_west", "to_east")
EAST_WEST, NORTH_SOUTH = ("from_east", "to_west"), ("from_north", "to_south")
PRIORITY = "four_way_priority"


def on(ego: Situation, route: tuple[str, str], away: float, speed: float, waiting: float = 0.0) -> RoadUser:
    """A car named after the road that it comes from, `away` m before its line."""
    return ego.other(route[0], f"{route[0]}_0", -away, speed, route, waiting)


def after(ego: Situation, first: tuple[RoadUser, ...], then: tuple[RoadUser, ...], **memory) -> list[Event]:
    """The events at the regions in the step after a decision among others as `first`, who are as `then`."""
    drive = ego.step(*first).drive
    snapshot = ego.seen(*then)._replace(time=ego.time + PERIOD)
    assert drive.memory.premises is not None
    return overturned(snapshot, notice(snapshot, drive.memory._replace(**memory)), drive.memory.premises)


WAITING, ROLLING = before(PRIORITY, SOUTH_NORTH, 1.0, 0.0), before(PRIORITY, SOUTH_NORTH, 30.0, 10.0)
MAJOR = before(PRIORITY, WEST_EAST, 20.0, 10.0)


def test_what_is_as_it_was_is_no_event():
    foe = on(WAITING, WEST_EAST, 26.0, 13.0)
    assert after(WAITING, (foe,), (WAITING.later(foe, 0.1),)) == []


def test_somebody_who_comes_to_a_region_is_new_once_he_matters_there():
    west, north = on(WAITING, WEST_EAST, 26.0, 13.0), on(WAITING, NORTH_SOUTH, 26.0, 13.0)
    assert after(WAITING, (), (west,)) == [Event(EventKind.NEW_OBSTACLE, "from_west")]
    assert after(WAITING, (), (north,)) == []


def test_somebody_for_whom_the_ego_waits_and_who_is_gone_is_no_cause_any_more():
    waited_for, let_pass = on(WAITING, WEST_EAST, 26.0, 13.0), on(WAITING, WEST_EAST, 190.0, 10.0)
    assert after(WAITING, (waited_for,), ()) == [Event(EventKind.CAUSE_VANISHED, "from_west")]
    assert after(WAITING, (let_pass,), ()) == []


def test_somebody_trusted_to_yield_who_can_no_longer_stop_does_something_else():
    trusted, too_fast = on(MAJOR, SOUTH_NORTH, 25.0, 10.0), on(MAJOR, SOUTH_NORTH, 12.0, 13.0)
    assert after(MAJOR, (trusted,), (trusted,)) == []
    assert after(MAJOR, (trusted,), (too_fast,)) == [Event(EventKind.OTHER_BEHAVIOUR, "from_south")]


@pytest.mark.parametrize(("away", "then", "kind"), [(26.0, 90.0, EventKind.GAP_OPENED), (90.0, 26.0, EventKind.GAP_CLOSED)])
def test_a_gap_that_opens_or_closes_is_an_event(away, then, kind):
    assert after(WAITING, (on(WAITING, WEST_EAST, away, 13.0),), (on(WAITING, WEST_EAST, then, 13.0),)) == [
        Event(kind, "from_west")
    ]


@pytest.mark.parametrize(("slower", "is_one"), [(0.8, False), (1.8, True)])
def test_somebody_who_clears_a_region_otherwise_than_foreseen_matters_to_an_ego_that_rolls(slower, is_one):
    foe = on(ROLLING, WEST_EAST, 40.0, 12.0)
    kinds = {event.kind for event in after(ROLLING, (foe,), (foe._replace(speed=12.0 - slower),))}
    assert (EventKind.OTHER_BEHAVIOUR in kinds) is is_one
    assert after(WAITING, (foe,), (foe._replace(speed=12.0 - slower),)) == []


def test_patience_with_somebody_who_stands_ends():
    foe = on(WAITING, EAST_WEST, 2.0, 0.0, waiting=1.0)
    waiting = foe._replace(waiting_time=60.0)
    since = {"standing_since": WAITING.time - 60.0}
    assert after(WAITING, (foe,), (foe,)) == []
    assert after(WAITING, (foe,), (waiting,), **since) == [Event(EventKind.CAUSE_VANISHED, "from_east")]


def test_room_behind_that_is_taken_or_free_again_is_an_event():
    ego = before(PRIORITY, SOUTH_NORTH, 12.0, 6.0)
    queue = ego.other("queue", "to_north_0", 6.0, 0.0, ("to_north",))
    gone = ego.other("queue", "to_north_0", 60.0, 8.0, ("to_north",))
    junction = ego.plan.passages[0].junction_id
    assert after(ego, (queue,), (queue,)) == []
    assert after(ego, (queue,), (gone,)) == [Event(EventKind.ROOM_BEHIND, junction)]
    assert after(ego, (gone,), (queue,)) == [Event(EventKind.ROOM_BEHIND, junction)]


def test_the_ego_leaves_a_region_later_behind_somebody_who_is_slow():
    """It would else go before a pedestrian, and come to a stand in his way."""
    foe, slow = on(ROLLING, WEST_EAST, 90.0, 12.0), ROLLING.ahead("slow", 12.0, 3.0)
    clears = []
    for others in ((foe,), (foe, slow)):
        snapshot = ROLLING.seen(*others)
        view = view_of(snapshot, ROLLING.plan, CAR, passages_ahead(ROLLING.graph, ROLLING.plan, CAR, snapshot.passages))
        of_foe = (one for one, _ in judgements(view.ways[0], snapshot.foes, view, ROLLING.memory))
        clears.append(next(one.own.clearance for one in of_foe if one.foe.user.id == foe.id))
    alone, behind = clears
    assert behind > alone + 2.0


@pytest.mark.parametrize(("away", "speed"), [(30.0, 10.0), (20.0, 6.0)])
@pytest.mark.parametrize(("seconds", "within"), [(0.1, 1e-9), (0.6, 0.1), (1.1, 0.2)])
def test_the_egos_own_times_are_carried_on_to_within_less_than_what_is_tolerated(away, speed, seconds, within):
    """They are compared with those simulated anew after the ego has driven on."""
    ego = before(PRIORITY, SOUTH_NORTH, away, speed)
    steps = ego.driven(seconds, on(ego, WEST_EAST, 90.0, 12.0))
    known, views = [], []
    for snapshot in (steps[0].snapshot, steps[-1].snapshot):
        views.append(view_of(snapshot, ego.plan, CAR, passages_ahead(ego.graph, ego.plan, CAR, snapshot.passages)))
        known.append([one for one, _ in judgements(views[-1].ways[0], snapshot.foes, views[-1], ego.memory)])
    start = views[0].snapshot.front, views[0].snapshot.ego.speed
    own = [carried_on(one, start, views[1].ways[0], views[1].snapshot, CAR) for one in known[0]]
    assert [tuple(one[:3]) for one in own] == [pytest.approx(tuple(one.own[:3]), abs=within) for one in known[1]]
    assert own and within < USUAL.foreseen_tolerance_s


@pytest.mark.parametrize(("speed", "after"), [(0.0, USUAL.trust_s), (3.0, USUAL.retry_s)])
def test_the_gap_in_which_somebody_who_stands_can_be_passed_is_looked_for_more_often(speed, after):
    """Somebody comes towards the ego: it cannot pass yet."""
    ego = before("two_way_road", ("eastbound", "eastbound_out"), 200.0, 5.0)
    oncoming = ego.other("comes", "westbound_0", -150.0, 12.0, ())
    premises = ego.step(ego.ahead("x", 20.0, speed, halted=speed == 0.0), oncoming).drive.memory.premises
    assert premises is not None
    assert premises.due == {EventKind.PASS_TRIED: pytest.approx(ego.time + after)}
