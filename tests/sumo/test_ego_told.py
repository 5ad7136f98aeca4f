"""What SUMO is told of the ego, to the word; SUMO's answers are scripted."""

import math
from pathlib import Path

import libsumo
import pytest
from net_recipes import MINIMAL
from scripted_ego import scripted, state_at

from sumo_reactive.driver.nouns.completed_plan import Intent
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.world.route import Route, ScheduledStop
from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.ego import TELEPORT_GUARD_S, Ego
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.vehicle_type import FREE_EXACT, KEEP_ROUTE_EXACT, front_of

INVALID = -1073741824.0


@pytest.fixture
def net(tmp_path: Path):
    """The written network: w_0 from x = 0 to 96 at y = −1.6, whose 96 m SUMO counts as 50, and e_0 from 104 to 200."""
    (tmp_path / "some.net.xml").write_text(MINIMAL)
    return read_net(tmp_path / "some.net.xml")


def placing(vehicle):
    """The last order to be somewhere."""
    return next(order for order in reversed(vehicle.told) if order[0] == "moveToXY")


def announced(vehicle):
    """The speeds that SUMO has been told."""
    return [order[2] for order in vehicle.told if order[0] == "setSpeed"]


def test_what_sumo_says_of_a_vehicle_is_kept(monkeypatch):
    ego, vehicle = scripted(monkeypatch)
    assert (ego.id, ego.limits.vehicle_class, ego.departure, ego.speed_factor) == ("ego", "passenger", 3.0, 1.1)
    assert (ego.limits.length, ego.limits.width, ego.route) == (4.0, 1.8, Route(("w", "e")))
    assert ego.time_loss() == 4.5 and vehicle.told == []


@pytest.mark.parametrize("has_device", [True, False])
def test_taking_over_switches_off_all_that_sumo_would_do_by_itself(monkeypatch, has_device):
    refused = {} if has_device else {"setParameter": libsumo.TraCIException("no such device")}
    ego, vehicle = scripted(monkeypatch, **refused)
    left = [True, False]  # it stands at the first of two stops
    vehicle.answers |= {"getStops": lambda _: tuple(left), "isStopped": lambda _: left[0]}
    done = []
    for order in ("resume", "replaceStop"):
        vehicle.answers[order] = lambda *how, order=order: (done.append((order, *how)), left.pop(0))
    state = ego.take_over(0.2)
    assert done == [("resume", "ego"), ("replaceStop", "ego", 0, "")]
    orders = [("setSpeedMode", "ego", 32), ("setLaneChangeMode", "ego", 0), ("setActionStepLength", "ego", 0.2, True)]
    period = [("setParameter", "ego", "device.rerouting.period", "0")]
    assert vehicle.told == [*orders, *(period if has_device else ())]
    assert (state.speed, state.steering_angle, state.acceleration) == (8.0, 0.0, 0.0)


@pytest.mark.parametrize(("says", "speed"), [(8.0, 8.0), (0.5, 0.5), (-0.5, 0.0)])
def test_the_ego_is_observed_where_and_as_fast_as_sumo_says_and_never_backwards(monkeypatch, says, speed):
    ego, _ = scripted(monkeypatch, getSpeed=says, getAngle=60.0, getPosition=(30.0, 7.0))
    seen = ego.observed()
    assert (seen.speed, seen.steering_angle, seen.pose.heading) == pytest.approx((speed, 0.0, math.radians(30.0)))
    assert front_of(seen.pose, ego.limits) == pytest.approx((30.0, 7.0))


def test_the_ego_leaves_as_one_that_has_arrived_or_as_one_that_sumo_drives(monkeypatch):
    ego, vehicle = scripted(monkeypatch)
    ego.release()
    ego.arrive()
    driven = [("setSpeed", "ego", -1.0), ("setSpeedMode", "ego", 31), ("setLaneChangeMode", "ego", 1621)]
    assert vehicle.told == [*driven, ("remove", "ego", 2)]


def test_room_is_asked_for_when_that_changes(monkeypatch):
    ego, vehicle = scripted(monkeypatch)
    for wanted in (False, True, True, False, False):
        ego.ask_for_room(wanted)
    assert vehicle.told == [("setLaneChangeMode", "ego", 513), ("setLaneChangeMode", "ego", 0)]


def test_the_ego_is_put_where_its_front_is_to_be_with_its_route_kept(monkeypatch, net):
    ego, vehicle = scripted(monkeypatch)
    ego.place(state_at(ego, 40.0, 3.0, 0.5), Intent.DRIVE, 0.1, net.lane("w_0"))
    degrees = 90.0 - math.degrees(0.5)
    wanted = ("moveToXY", "ego", "", -1, 40.0, 3.0, degrees, KEEP_ROUTE_EXACT)
    assert placing(vehicle) == (*wanted[:4], *map(pytest.approx, wanted[4:7]), wanted[7])
    assert announced(vehicle) == [8.0]


@pytest.mark.parametrize(
    ("lane_id", "position", "speed", "back"),
    [
        ("w_0", 49.995, 0.0, 0.005),
        ("w_0", 49.98, 0.0, 0.0),  # farther than twice as much before the end
        ("w_0", 49.995, 0.01, 0.0),  # it still rolls
        (":j_0_0", 7.999, 0.0, 0.0),
        ("", 7.999, 0.0, 0.0),
    ],
)
def test_who_stands_on_the_end_of_a_lane_is_put_before_it_along_his_heading(monkeypatch, lane_id, position, speed, back):
    ego, vehicle = scripted(monkeypatch)
    vehicle.answers |= {"getLaneID": lane_id, "getLanePosition": position}
    ego.place(state_at(ego, 40.0, 3.0, 0.6, speed), Intent.DRIVE, 0.1, None)
    assert placing(vehicle)[4:6] == pytest.approx((40.0 - back * math.cos(0.6), 3.0 - back * math.sin(0.6)), abs=1e-9)


@pytest.mark.parametrize(
    ("overlooked", "y", "is_told"), [(True, -1.6, True), (False, -1.6, False), (True, 0.85, True), (True, 0.95, False)]
)
def test_sumo_is_told_the_lane_only_where_it_overlooks_it_and_the_front_reaches_over_it(
    monkeypatch, net, overlooked, y, is_told
):
    ego, vehicle = scripted(monkeypatch)
    ego.place(state_at(ego, 100.0, y), Intent.DRIVE, 0.1, net.lane(":j_0_0"), overlooked)
    told = placing(vehicle)
    assert (*told[2:4], told[7]) == ((":j_0", 0, FREE_EXACT) if is_told else ("", -1, KEEP_ROUTE_EXACT))


def mapped(ego, vehicle, state, lane_id):
    """Have SUMO map the ego to a lane ('' : none) where it has been put."""
    vehicle.answers |= {"getLaneID": lane_id, "getPosition": front_of(state.pose, ego.limits)}
    return ego.lane(state)


@pytest.mark.parametrize(
    ("route", "index", "restored"),
    [
        (("e",), 0, []),  # the end of the ego's own route
        (("w", "e"), 1, []),
        (("e", "x"), 0, [("setRoute", "ego", ("e", "n"))]),
        (("x",), 0, [("setRoute", "ego", ("e", "n"))]),
        (("n", "e"), -1, [("setRoute", "ego", ("e", "n"))]),
    ],
)
def test_an_ego_without_a_lane_is_told_it_until_it_is_out_of_the_junction_with_its_route(
    monkeypatch, net, route, index, restored
):
    ego, vehicle = scripted(monkeypatch, getRoute=("w", "e", "n"))
    if route[-1] == "e":
        ego.route = Route(("w", "e"))
        restored = [("setRoute", "ego", ("e",))] if restored else []
    state, inside, behind = state_at(ego, 100.0), net.lane(":j_0_0"), net.lane("e_0")
    modes = []
    for lane_id, lane in (("", inside), (":j_0_0", inside), ("e_0", behind), ("e_0", behind)):
        if lane_id == "e_0":
            vehicle.answers |= {"getRoute": route, "getRouteIndex": index}
        assert mapped(ego, vehicle, state, lane_id) == lane_id
        ego.place(state, Intent.DRIVE, 0.1, lane)
        modes.append(placing(vehicle)[7])
    assert modes == [FREE_EXACT, FREE_EXACT, KEEP_ROUTE_EXACT, KEEP_ROUTE_EXACT]
    assert [order for order in vehicle.told if order[0] == "setRoute"] == restored


def test_on_an_edge_that_is_not_of_its_route_the_ego_keeps_what_sumo_has(monkeypatch, net):
    ego, vehicle = scripted(monkeypatch)
    state = state_at(ego, 100.0)
    for lane_id in ("", "s_0"):
        mapped(ego, vehicle, state, lane_id)
    assert vehicle.told == []


@pytest.mark.parametrize(("slower", "is_told"), [(0.0, False), (0.09, False), (0.11, True), (8.0, True)])
def test_others_see_the_speed_that_the_ego_has_where_sumo_says_less(monkeypatch, slower, is_told):
    ego, vehicle = scripted(monkeypatch, getSpeed=8.0 - slower)
    mapped(ego, vehicle, state_at(ego, acceleration=-1.5), "w_0")
    assert vehicle.told == ([("setPreviousSpeed", "ego", 8.0, -1.5)] if is_told else [])


def test_another_route_is_told_to_sumo(monkeypatch):
    ego, vehicle = scripted(monkeypatch)
    ego.reroute(Route(("w", "n")))
    assert vehicle.told == [("setRoute", "ego", ("w", "n"))] and ego.route.edges == ("w", "n")


@pytest.mark.parametrize(
    ("braking", "expected"),
    [(4.59, None), (4.61, 9.0), (9.0, 9.0)],
)
def test_others_fear_the_hardest_braking_from_just_beyond_what_the_type_says(monkeypatch, braking, expected):
    ego, vehicle = scripted(monkeypatch)
    for value in (braking, braking, 0.0, 0.0):
        ego.place(state_at(ego, acceleration=-value), Intent.DRIVE, 0.1, None)
    told = [order for order in vehicle.told if order[0] == "setApparentDecel"]
    assert told == ([] if expected is None else [("setApparentDecel", "ego", expected), ("setApparentDecel", "ego", 4.5)])


def test_who_is_trusted_to_brake_harder_than_it_can_stays_so(monkeypatch):
    ego, vehicle = scripted(monkeypatch, getApparentDecel=9.5)
    ego.place(state_at(ego, acceleration=-9.7), Intent.DRIVE, 0.1, None)
    assert ("setApparentDecel", "ego", 9.5) in vehicle.told


def test_the_time_of_standing_is_counted_up_to_the_guard_and_from_anew_after_each_move(monkeypatch):
    """Teleported after 8 s with 5 s to spare: the step in which 3 s would be passed is the one that moves."""
    ego, vehicle = scripted(monkeypatch, after=3.0 + TELEPORT_GUARD_S)
    for speed in (*[0.0] * 5, STANDING_SPEED, *[0.09] * 8):
        ego.place(state_at(ego, speed=speed), Intent.DRIVE, 0.75, None)
    stands = [0.0] * 4 + [0.2] + [STANDING_SPEED] + [0.09] * 4 + [0.2] + [0.09] * 3
    assert announced(vehicle) == stands


@pytest.mark.parametrize(("after", "moves"), [(0.0, False), (-1.0, False), (TELEPORT_GUARD_S + 0.5, True)])
def test_only_where_sumo_teleports_the_ego_moves_against_it(monkeypatch, after, moves):
    ego, vehicle = scripted(monkeypatch, after=after)
    for _ in range(3):
        ego.place(state_at(ego, speed=0.0), Intent.YIELD, 0.3, None)
    assert (0.2 in announced(vehicle)) is moves


@pytest.mark.parametrize(
    ("speed", "intent", "said"),
    [(0.05, Intent.DRIVE, 0.05), (0.05, Intent.YIELD, 0.0), (0.0, Intent.GO_NEXT, 0.05), (-0.5, Intent.DRIVE, 0.0)],
)
def test_a_slow_ego_says_what_it_means_to_do(monkeypatch, speed, intent, said):
    ego, vehicle = scripted(monkeypatch)
    ego.place(state_at(ego, speed=speed), intent, 0.1, None)
    assert announced(vehicle) == [said]


def stop(lane="e_0", end=50.0, duration=INVALID, until=INVALID):
    """A stop as SUMO tells it."""
    return type("StopData", (), {"lane": lane, "endPos": end, "duration": duration, "until": until})()


@pytest.mark.parametrize(
    ("duration", "until", "means"),
    [(9.5, INVALID, (9.5, None)), (0.5, 77.0, (0.5, 77.0)), (0.0, 0.5, (0.0, 0.5)), (-1.0, 0.0, (0.0, None)),
     (INVALID, INVALID, (0.0, None))],
)  # fmt: skip
def test_a_stop_lasts_as_said_or_no_time(monkeypatch, duration, until, means):
    ego, _ = scripted(monkeypatch, getStops=(stop("", 9.0), stop("e_0", 50.0, duration, until)))
    assert ego.route.stops == (ScheduledStop("e_0", 50.0, *means),)


@pytest.mark.parametrize(("index", "edges"), [(-1, ("w", "e", "n")), (0, ("w", "e", "n")), (1, ("e", "n"))])
def test_the_route_is_what_is_left_of_sumos(monkeypatch, index, edges):
    ego, _ = scripted(monkeypatch, getRoute=("w", "e", "n"), getRouteIndex=index)
    assert ego.route.edges == edges


@pytest.mark.parametrize(("said", "position"), [(40.0, 40.0), (0.0, 0.0), (-20.0, 76.0), (-0.5, 95.5), (-200.0, 0.0)])
def test_an_arrival_counted_from_the_end_is_one_from_the_start(monkeypatch, said, position):
    monkeypatch.setattr("sumo_reactive.sumo.ego.arrival_of", {"ego": (said, 2)}.get)
    ego, _ = scripted(monkeypatch)
    assert (ego.route.arrival_position, ego.route.arrival_lane) == (position, 2)


@pytest.mark.parametrize(("off", "is_refused"), [(0.0, False), (80.0, False), (100.0, True), (180.0, True)])
def test_who_looks_against_his_lane_where_he_is_is_refused(monkeypatch, off, is_refused):
    def angle(lane_id, position):
        return {("w_0", 20.0): 30.0}[lane_id, position]

    _, vehicle = scripted(monkeypatch)
    libsumo.lane.answers["getAngle"] = angle
    vehicle.answers["getAngle"] = 30.0 + off
    if not is_refused:
        assert Ego("ego").id == "ego"
        return
    with pytest.raises(ScenarioError) as told:
        Ego("ego")
    assert str(told.value) == "ego 'ego' is on the oncoming side of lane 'w_0'; it cannot be taken over there"


def test_who_has_just_been_inserted_half_before_his_lane_is_not_refused_for_the_angle_that_sumo_shows(monkeypatch, net):
    ego, _ = scripted(monkeypatch, getLanePosition=1.0, getDistance=0.0, getAngle=-95.0)
    state = state_at(ego, *net.lane("n_0").spine.at(1.0), 0.5 * math.pi + math.radians(95.0))
    assert ego.laid_along(net.lane("n_0"), state).pose.heading == pytest.approx(0.5 * math.pi)


def test_who_is_on_no_lane_is_refused_with_the_time(monkeypatch):
    with pytest.raises(ScenarioError, match=r"^ego 'ego' is on no lane at 7\.0 s$"):
        scripted(monkeypatch, getLaneID="")


def test_places_and_speeds_count_in_metres_over_ground_where_sumo_counts_a_lane_shorter(monkeypatch, net):
    ego, _ = scripted(monkeypatch)
    assert ego.lane_position(net.build(["w", "e"]), "w_0") == pytest.approx(20.0 * 96.0 / 50.0)
    assert ego.laid_along(net.lane("w_0"), state_at(ego, speed=5.0)).speed == pytest.approx(9.6)


@pytest.mark.parametrize(
    ("front", "driven", "speed", "is_laid"),
    [(1.0, 0.0, 9.0, True), (3.99, 0.0, 9.0, True), (4.0, 0.0, 9.0, False), (1.0, 3.9, 9.0, True), (1.0, 4.0, 9.0, False),
     (1.0, 0.0, 4.7, False), (1.0, 0.0, 4.8, True)],
)  # fmt: skip
def test_a_body_that_hangs_over_the_start_of_its_lane_lies_straight_back_from_its_front(
    monkeypatch, net, front, driven, speed, is_laid
):
    """Askew by half a radian, it drifts v² · 0.25 / (2 · 4 m/s²) to the side: up to (3.2 − 1.8) / 2 m it stays."""
    ego, _ = scripted(monkeypatch, getLanePosition=front, getDistance=driven)
    x, y = net.lane("n_0").spine.at(front)  # to the north, whose metres are SUMO's
    seen = state_at(ego, x, y, 0.5 * math.pi + 0.5, speed)
    laid = ego.laid_along(net.lane("n_0"), seen)
    assert (laid is not seen) is is_laid
    assert laid.pose.heading == pytest.approx(0.5 * math.pi + (0.0 if is_laid else 0.5))
    assert front_of(laid.pose, ego.limits) == pytest.approx((x, y)) and laid.speed == speed


def test_so_little_room_is_left_before_an_ego_only_while_it_stands(monkeypatch):
    ego, vehicle = scripted(monkeypatch)  # it stands 2.0 m behind others, its type keeps 2.5 m
    for speed in (8.0, 0.0, 0.0, 8.0, 0.0):
        ego.place(state_at(ego, 40.0, 3.0, 0.0, speed), Intent.DRIVE, 0.1, None)
    ego.release()
    gaps = [order[2] for order in vehicle.told if order[0] == "setMinGap"]
    assert gaps == [1.0, 2.5, 1.0, 2.5]
