"""What each kind of foe means for a passage: pedestrians, the rights that the map and the letters give, who merges."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest
from helpers.cars import CAR
from helpers.situations import Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.snapshot import Foe
from sumo_reactive.driver.nouns.traffic import Body
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.passages import view_of
from sumo_reactive.driver.pilot.rules.highway_code import HIGHWAY_CODE, Rules, ask
from sumo_reactive.driver.pilot.rules.region import HESITATION_S, ZIPPER_LEAD_M, kept_waiting
from sumo_reactive.driver.pilot.rules.trust import BEFORE_THE_LINE_M
from sumo_reactive.driver.view.ahead import passages_ahead
from sumo_reactive.driver.world.junction import Control
from sumo_reactive.driver.world.regions import ConflictKind, Interval

SOUTH_NORTH, WEST_EAST, NORTH_SOUTH = ("from_south", "to_north"), ("from_west", "to_east"), ("from_north", "to_south")
WALKER = Body(0.3, 0.5, 5.0, 1.6, is_person=True)
ROLLING = before("four_way_priority", SOUTH_NORTH, 12.0, 6.0)
STANDING = before("four_way_priority", SOUTH_NORTH, 1.0, 0.0)
FOE = ROLLING.other("x", "from_west_0", -26.0, 13.0, WEST_EAST)
Change = Callable[[Foe], Foe]


def rules(
    ego: Situation, change: Change, control: Control = Control.MINOR, lights: dict[str, str] | None = None, **what: bool
) -> Rules:
    """What the highway code asks for with each foe that is seen changed so; `what` is different at the conflicts."""
    snapshot = ego.seen(FOE, lights=lights)
    snapshot = snapshot._replace(foes=tuple(map(change, snapshot.foes)))
    seen = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    ahead = tuple(
        (i, replace(connection, control=control), tuple(conflict._replace(**what) for conflict in conflicts))
        for i, connection, conflicts in seen
    )
    return ask(view_of(snapshot, ego.plan, CAR, ahead), HIGHWAY_CODE, None, ego.memory)[0]


def judged(found: Rules) -> set[str]:
    """Return who matters at any region."""
    return {one.foe.user.id for one in found.judged}


def reason(found: Rules) -> Reason | None:
    """Why the ego stops (None: it goes on)."""
    return next((stop.reason for stop, _ in found.stops), None)


def walks(to_region: float, to_line: float = -1.0, speed: float = 1.4, length: float = 4.0, **rights: bool) -> Change:
    """The foe as a pedestrian, this far from a region so long, and from the kerb."""

    def change(foe: Foe) -> Foe:
        user, conflict = foe.user._replace(body=WALKER, speed=speed), foe.conflict._replace(**rights)
        return Foe(user, foe.passage, conflict, to_line, to_region, to_region + length)

    return change


@pytest.mark.parametrize(
    ("on_it", "speed", "goes_first", "waits", "stops"),
    [
        (True, 1.4, True, False, True),
        (True, 1.4, False, True, True),  # who is on the crossing is let pass, whoever goes first
        (False, 1.4, True, False, True),
        (False, 1.4, False, True, False),
        (False, 1.4, False, False, True),  # who comes walking, and no rule makes him wait
        (False, 0.0, False, False, False),
    ],
)
def test_a_pedestrian_beside_a_crossing_is_waited_for_unless_he_has_to_wait(on_it, speed, goes_first, waits, stops):
    rights = {"must_yield": goes_first, "is_yielded_to": waits}
    found = rules(ROLLING, walks(3.0, -1.0 if on_it else 1.0, speed, **rights))
    assert reason(found) is (Reason.PEDESTRIAN if stops else None)


@pytest.mark.parametrize(("longer", "matters"), [(-0.1, True), (0.1, False)])
@pytest.mark.parametrize("hesitates", [False, True])
def test_a_pedestrian_who_does_not_step_on_lets_an_ego_go_that_has_stood_or_hesitated_for_long(longer, matters, hesitates):
    since = STANDING.time - USUAL.foe_patience_s - longer
    stood = STANDING.having_stood(USUAL.foe_patience_s + longer).remembering(progress_time=STANDING.time)
    ego = STANDING.remembering(progress_time=since - HESITATION_S) if hesitates else stood
    assert ("x" in judged(rules(ego, walks(0.2, 1.0, 0.0, must_yield=True)))) is matters
    assert "x" in judged(rules(ego, walks(0.2, 1.0, 0.2, must_yield=True)))
    assert "x" in judged(rules(ego, walks(0.2, -1.0, 0.0, must_yield=True)))


@pytest.mark.parametrize(("letter", "walks_on"), [("G", True), ("g", True), ("r", False), ("y", False)])
def test_a_pedestrian_beside_a_crossing_with_a_light_walks_at_green(letter, walks_on):
    ego = before("signalised_left_turns", SOUTH_NORTH, 12.0, 6.0)
    foe = ego.other("x", "from_west_0", -10.0, 5.0, WEST_EAST)
    own = ego.connection.light.index
    letters = "".join("G" if k == own else letter for k in range(12))
    snapshot = ego.seen(foe, lights={"centre": "G" * 12})
    change = walks(3.0, 1.0, must_yield=False)
    snapshot = snapshot._replace(foes=tuple(map(change, snapshot.foes)), lights={"centre": letters})
    ahead = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    found, _ = ask(view_of(snapshot, ego.plan, CAR, ahead), HIGHWAY_CODE, None, ego.memory)
    assert ("x" in judged(found)) is walks_on


def comes(to_region: float, to_line: float, speed: float, length: float = 8.0, waiting: float = 0.0, **what) -> Change:
    """The foe as a car, this far from a region so long and from its line; `what` is different at the conflict."""

    def change(foe: Foe) -> Foe:
        region = {name: what[name] for name in ("kind",) if name in what}
        rights = {name: value for name, value in what.items() if name in ("must_yield", "is_yielded_to")}
        conflict = foe.conflict._replace(region=replace(foe.conflict.region, **region), **rights)
        if "start" in what:
            own = conflict.region.own
            moved = replace(conflict.region, own=Interval(what["start"], own.end))
            conflict = conflict._replace(region=moved)
        if "control" in what:
            conflict = conflict._replace(other=replace(conflict.other, control=what["control"]))
        user = foe.user._replace(speed=speed, waiting_time=waiting, acceleration=-what.get("braking", 0.0))
        return Foe(user, foe.passage, conflict, to_line, to_region, to_region + length)

    return change


@pytest.mark.parametrize(("in_the_way", "braking", "goes_on"), [(True, 4.5, False), (True, 0.0, True), (False, 4.5, True)])
def test_who_brakes_to_wait_in_the_ego_s_way_will_not_have_gone_first(in_the_way, braking, goes_on):
    """It lets the ego go, which cannot pass it there: each would wait for the other."""
    ego = before("four_way_priority", SOUTH_NORTH, 40.0, 10.0)
    yields = comes(6.0, 5.0, 6.5, must_yield=False, is_yielded_to=True, braking=braking)
    found = rules(ego, yields, waits_in_the_way=in_the_way)
    assert (reason(found) is None) is goes_on


@pytest.mark.parametrize(
    ("rights", "expected"),
    [
        ((True, False), Reason.YIELD_TO),
        ((True, True), Reason.WAIT_FOR_TURN),
        ((False, True), None),
        ((False, False), Reason.NO_RULE),  # nobody has to wait, so nobody does
    ],
)
def test_the_rights_at_a_region_make_the_reason(rights, expected):
    must, is_yielded_to = rights
    found = rules(ROLLING, comes(20.0, 15.0, 8.0, must_yield=must, is_yielded_to=is_yielded_to))
    assert reason(found) is expected
    inside = rules(ROLLING, comes(-1.0, -6.0, 3.0, must_yield=must, is_yielded_to=is_yielded_to))
    assert reason(inside) is Reason.REGION_OCCUPIED


@pytest.mark.parametrize(("start", "trusted"), [(-BEFORE_THE_LINE_M + 0.1, True), (-BEFORE_THE_LINE_M - 0.1, False)])
def test_nobody_is_trusted_to_yield_where_a_region_begins_far_before_a_line(start, trusted):
    change = comes(20.0, 15.0, 8.0, must_yield=False, is_yielded_to=True, start=start)
    assert (reason(rules(ROLLING, change)) is None) is trusted


LETTERS: dict[tuple[str, str], Reason | None] = {
    ("G", "g"): None,
    ("g", "G"): Reason.YIELD_TO,
    ("g", "g"): Reason.WAIT_FOR_TURN,
    ("G", "G"): Reason.YIELD_TO,
    ("G", "s"): None,
    ("g", "s"): None,
    ("g", "o"): Reason.WAIT_FOR_TURN,
    ("G", "o"): None,
    ("o", "O"): Reason.YIELD_TO,
    ("o", "o"): Reason.WAIT_FOR_TURN,
}


@pytest.mark.parametrize(("own", "theirs"), LETTERS)
def test_between_paths_that_yield_to_each_other_the_higher_letter_goes_first(own, theirs):
    ego = before("signalised_left_turns", SOUTH_NORTH, 12.0, 6.0)
    foe = ego.other("x", "from_north_1", -12.0, 8.0, ("from_north", "to_east"))
    mine, (crosser, *_) = ego.connection.light.index, ego.seen(foe, lights={"centre": "G" * 12}).foes
    other = crosser.conflict.other.light.index
    letters = "".join(own if k == mine else theirs if k == other else "r" for k in range(12))
    snapshot = ego.seen(foe, lights={"centre": letters})
    change = comes(20.0, 15.0, 8.0, must_yield=True, is_yielded_to=True)
    snapshot = snapshot._replace(foes=(change(crosser),))
    ahead = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    found, _ = ask(view_of(snapshot, ego.plan, CAR, ahead), HIGHWAY_CODE, None, ego.memory)
    assert reason(found) is LETTERS[own, theirs]


@cache
def to_merge() -> tuple[float, float]:
    """The ego's way to its line and to the region where it meets the foe."""
    snapshot, passage = ROLLING.seen(FOE), ROLLING.plan.passages[0]
    start = snapshot.foes[0].conflict.region.own.start
    scale = (passage.end - passage.start) / ROLLING.connection.path.length
    return passage.start - snapshot.front, passage.start + start * scale - snapshot.front


@pytest.mark.parametrize(("line", "region"), [(1, 1), (-1, 1), (1, -1)])
def test_where_lanes_merge_like_a_zipper_who_is_nearer_to_line_and_region_goes_first(line, region):
    to_line, to_region = to_merge()
    change = comes(
        to_region + region * 0.05 + ZIPPER_LEAD_M, to_line + line * 0.05 + ZIPPER_LEAD_M, 13.0, kind=ConflictKind.MERGING
    )
    assert ("x" in judged(rules(ROLLING, change, Control.ZIPPER))) is not (line == region == 1)
    assert "x" in judged(rules(ROLLING, change))


ROWS: dict[str, tuple[Callable[[float], bool], float, float, float]] = {
    "m that a walker must be away": (lambda m: reason(rules(ROLLING, walks(m))) is None, 0.1, 20.0, 5.043),
    "m of region that a walker has left in time": (
        lambda m: reason(rules(ROLLING, walks(-1.0, length=m))) is None, 0.1, 20.0, 3.170,
    ),
    "m of way that a car has left to leave": (
        lambda m: reason(rules(ROLLING, comes(-1.0, -6.0, 4.0, m))) is None, 0.1, 20.0, 7.199,
    ),
    "m that a merging car must be away": (
        lambda m: reason(rules(ROLLING, comes(m, m, 9.0, kind=ConflictKind.MERGING))) is None, 10.0, 90.0, 36.545,
    ),
    "m that a merging car is ahead": (
        lambda m: reason(rules(ROLLING, comes(-m, -m, 5.0, kind=ConflictKind.MERGING))) is None, 0.1, 10.0, 0.766,
    ),
    "m/s at which who must yield before a line can no longer": (
        lambda v: reason(rules(ROLLING, comes(20.0, 10.0, v, must_yield=False, is_yielded_to=True))) is None, 1.0, 12.0,
        (2.0 * USUAL.foe_can_stop_deceleration * 10.0) ** 0.5,
    ),
    "m of way to its line from which who must yield can no longer": (
        lambda m: reason(rules(ROLLING, comes(m + 5.0, m, 6.0, must_yield=False, is_yielded_to=True))) is None, -1.0, 9.0,
        36.0 / (2.0 * USUAL.foe_can_stop_deceleration),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_with_a_foe_the_pilots_word_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.005)


def test_who_stands_to_let_others_pass_is_waited_for_until_a_while_after_they_have():
    """Without them, an ego that has waited as long takes him for one who just stands there."""
    waits = STANDING.other("x", "from_west_0", -1.0, 0.0, WEST_EAST)._replace(waiting_time=30.0)
    comes = STANDING.other("y", "from_east_0", -20.0, 10.0, ("from_east", "to_west"))
    snapshot = STANDING.seen(waits, comes)
    passing = {foe.conflict.other.id for foe in STANDING.seen(comes).foes}
    lets = tuple(
        foe._replace(conflict=foe.conflict._replace(lets_pass=frozenset(passing))) if foe.user.id == "x" else foe
        for foe in snapshot.foes
    )
    memory = STANDING.memory._replace(standing_since=snapshot.time - 30.0)
    kept = kept_waiting(snapshot._replace(foes=lets), memory)
    assert passing and kept == (("x", snapshot.time),)
    assert kept_waiting(snapshot, memory) == ()
    alone = STANDING.seen(waits)
    for later, is_waited_for in ((1.0, True), (USUAL.foe_patience_s - 0.1, True), (USUAL.foe_patience_s + 0.1, False)):
        after = alone._replace(time=snapshot.time + later)
        found, _ = ask(
            view_of(after, STANDING.plan, CAR, passages_ahead(STANDING.graph, STANDING.plan, CAR, after.passages)),
            HIGHWAY_CODE, None, memory._replace(kept=kept),
        )  # fmt: skip
        assert (reason(found) is Reason.YIELD_TO) == is_waited_for, later


@pytest.mark.parametrize(
    ("kind", "away", "speed", "waited", "lets_in"),
    [
        (ConflictKind.MERGING, 6.0, 1.4, 95.0, True),
        (ConflictKind.MERGING, 6.0, 1.4, 85.0, False),
        (ConflictKind.CROSSING, 6.0, 1.4, 95.0, False),
        (ConflictKind.MERGING, 3.0, 1.4, 95.0, False),
        (ConflictKind.MERGING, 12.0, 3.1, 95.0, False),
    ],
)
def test_who_crawls_in_a_queue_is_driven_in_before_by_an_ego_that_has_waited_for_long(kind, away, speed, waited, lets_in):
    since = STANDING.time - waited
    ego = STANDING.having_stood(waited).remembering(released=(STANDING.connection.id, since), got_on=since)
    assert ("x" not in judged(rules(ego, comes(away, away, speed, kind=kind, must_yield=True)))) is lets_in
