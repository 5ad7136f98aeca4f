"""What sensor and observed vehicle make of SUMO's answers, value by value, and how often they ask; answers are scripted."""

import math
from types import SimpleNamespace

import libsumo
import pytest
from libsumo import constants as tc
from scripted import Domain, script

from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import Body, RoadUser, packed_boxes
from sumo_reactive.sumo.observed_vehicle import SAME_LEVEL_M, TOUCHING_M, Bystanders, ObservedVehicle
from sumo_reactive.sumo.sensor import (
    PERSON_DECELERATION,
    ROUTE_AHEAD,
    STEPPING_ON_M,
    SeenCrossing,
    SeenLane,
    Sensor,
)

NORTH, EAST = 0.5 * math.pi, 0.0
LANE = SeenLane("a_0", "a", 1.5, False)
CAR = {
    "getPosition": (10.0, 20.0), "getAngle": 0.0, "getSpeed": 4.0, "getLanePosition": 30.0, "getLength": 5.0,
    "getWidth": 1.75, "getDecel": 4.0, "getEmergencyDecel": 7.0, "getAccel": 3.5, "getMaxSpeed": 40.0, "getRouteIndex": 1,
    "getRoute": ("z", "a", "b", "c"), "getWaitingTime": 6.0, "isStopped": 1, "getAcceleration": -2.0,
    "getVehicleClass": "passenger", "getRouteID": "r",
}  # fmt: skip


def seeing(monkeypatch, on_lanes, on_edges=None, walkers=None, **car):
    """A sensor of a SUMO that has these vehicles on lanes and these people on edges; SUMO's clock stands in `now`."""
    now = SimpleNamespace(time=5.0)
    quiet = {"getParkingStartingVehiclesIDList": (), "getParkingEndingVehiclesIDList": (), "getArrivedIDList": ()}
    script(
        monkeypatch,
        vehicle=Domain(**(CAR | {"getIDList": ()} | car)),
        lane=Domain(getLastStepVehicleIDs=on_lanes),
        edge=Domain(getLastStepPersonIDs=on_edges or {}),
        person=Domain(**(walkers or {})),
        polygon=Domain(getIDList=()),
        simulation=Domain(getTime=lambda: now.time, getDeltaT=0.1, **quiet),
        trafficlight=Domain(),
    )
    return Sensor(), now


def vehicles(sensor, *lanes):
    return [user for one in sensor.vehicles({lane.lane_id: lane for lane in lanes}) for user in one.users]


def test_a_vehicle_that_moves_is_read_with_places_and_speeds_over_ground(monkeypatch):
    sensor, _ = seeing(monkeypatch, {"a_0": ("x",)})
    assert sensor.look() == 5.0
    body = Body(5.0, 1.75, 7.0, 40.0, acceleration=3.5)
    assert vehicles(sensor, LANE) == [
        RoadUser("x", 10.0, 20.0, NORTH, 6.0, "a_0", 45.0, body, ("a", "b", "c"), 0.0, False, -3.0)
    ]


@pytest.mark.parametrize(("over", "stands"), [(-0.01, True), (0.0, True), (0.01, False)])
def test_who_is_no_faster_than_a_stand_over_ground_is_asked_how_long_and_why(monkeypatch, over, stands):
    sensor, _ = seeing(monkeypatch, {"a_0": ("x",)}, getSpeed=STANDING_SPEED + over)
    sensor.look()
    (one,) = vehicles(sensor, LANE._replace(scale=1.0))
    assert (one.waiting_time, one.is_halted) == ((6.0, True) if stands else (0.0, False))
    assert (one.x, one.y, one.heading, one.lane_id, one.lane_position) == (10.0, 20.0, NORTH, "a_0", 30.0)
    assert (one.body.length, one.route) == (5.0, ("a", "b", "c"))


@pytest.mark.parametrize(
    ("index", "is_internal", "route"),
    [(-1, False, "zabc"), (0, False, "zabc"), (0, True, "abc"), (2, False, "bc"), (2, True, "c"), (3, True, "")],
)
def test_the_way_that_is_left_begins_here_or_behind_the_junction(monkeypatch, index, is_internal, route):
    sensor, _ = seeing(monkeypatch, {"a_0": ("x",)}, getRouteIndex=index)
    sensor.look()
    assert vehicles(sensor, LANE._replace(is_internal=is_internal))[0].route == tuple(route)


def test_of_a_long_way_the_next_edges_are_kept(monkeypatch):
    way = tuple(str(k) for k in range(40))
    sensor, _ = seeing(monkeypatch, {"a_0": ("x",)}, getRoute=way)
    sensor.look()
    assert vehicles(sensor, LANE)[0].route == way[1 : 1 + ROUTE_AHEAD]


@pytest.mark.parametrize(("service", "emergency", "hardest"), [(4.0, 7.0, 7.0), (8.0, 7.0, 8.0)])
def test_a_body_brakes_as_hard_as_the_harder_of_both_that_its_type_says(monkeypatch, service, emergency, hardest):
    sensor, _ = seeing(monkeypatch, {"a_0": ("x",)}, getDecel=service, getEmergencyDecel=emergency)
    sensor.look()
    assert vehicles(sensor, LANE)[0].body.emergency_deceleration == hardest


@pytest.mark.parametrize(
    ("vehicle_class", "length", "keeps_to_its_way"), [("trailer", 16.0, 9.5), ("trailer", 8.0, 8.0), ("bus", 12.0, 12.0)]
)
def test_a_trailer_turns_with_its_first_part(monkeypatch, vehicle_class, length, keeps_to_its_way):
    sensor, _ = seeing(monkeypatch, {"a_0": ("x",)}, getVehicleClass=vehicle_class, getLength=length)
    sensor.look()
    assert vehicles(sensor, LANE)[0].body.turning_length == keeps_to_its_way


def test_lanes_are_told_in_order_and_stand_ins_and_empty_lanes_left_out(monkeypatch):
    on = {"a_0": ("x", "reactive.ghost.e.1", "y"), "b_0": (), "c_0": ("w",)}
    sensor, _ = seeing(monkeypatch, on)
    sensor.look()
    lanes = tuple(LANE._replace(lane_id=name, edge_id=name[0]) for name in ("c_0", "b_0", "a_0"))
    assert [(user.id, user.lane_id) for user in vehicles(sensor, *lanes)] == [("w", "c_0"), ("x", "a_0"), ("y", "a_0")]


def test_a_body_is_read_once_a_way_on_a_new_edge_or_another_route_and_a_lane_once_a_step(monkeypatch):
    asked, route = [], ["r"]
    counting = {
        name: lambda who, name=name, value=CAR[name]: (asked.append(name), value)[1]
        for name in ("getLength", "getRoute", "getPosition")
    }
    sensor, now = seeing(monkeypatch, {"a_0": ("x",), "b_0": ("x",)}, getRouteID=lambda _: route[0], **counting)

    def looked(time, lane):
        asked.clear()
        now.time = time
        sensor.look()
        vehicles(sensor, lane)
        return sorted(asked)

    next_lane = LANE._replace(lane_id="b_0", edge_id="b")
    assert looked(5.0, LANE) == ["getLength", "getPosition", "getRoute"]
    assert looked(5.0, LANE) == []
    assert looked(5.1, LANE) == ["getPosition"]
    route[0] = "!r!var#1"
    assert looked(5.2, LANE) == ["getPosition", "getRoute"]
    assert looked(5.3, LANE) == ["getPosition"]
    assert looked(5.4, next_lane) == ["getPosition", "getRoute"]
    assert looked(5.5, next_lane) == ["getPosition"]


def test_each_light_is_read_once_a_step_and_at_all_at_time_zero(monkeypatch):
    asked = []
    sensor, now = seeing(monkeypatch, {})
    libsumo.trafficlight.answers["getRedYellowGreenState"] = lambda light: (asked.append(light), f"{light}{now.time}")[1]
    for time in (0.0, 0.0, 0.1):
        now.time = time
        sensor.look()
        assert [sensor.letters(light) for light in "stst"] == [f"{light}{time}" for light in "stst"]
    assert asked == ["s", "t"] * 2


WALKER = {
    "getAngle": {"p": 90.0, "q": 0.0}, "getLanePosition": {"p": 3.0, "q": 1.0}, "getLength": {"p": 0.25, "q": 0.5},
    "getWidth": {"p": 0.5, "q": 0.75}, "getMaxSpeed": {"p": 1.5, "q": 2.0}, "getSpeed": {"p": 1.25, "q": 0.5},
    "getPosition": {"p": (1.0, 2.0), "q": (3.0, 4.0)},
}  # fmt: skip
CROSSING = SeenCrossing(":c_c0", ":c_c0_0", (":c_w0", ":c_w1"), ((0.0, 0.0, 0.0, 0.3), (10.0, 0.0, 12.0, 3.4)))
P = RoadUser("p", 1.0, 2.0, EAST, 1.25, ":c_c0_0", 3.0, Body(0.25, 0.5, PERSON_DECELERATION, 1.5, True))
Q = RoadUser("q", 3.0, 4.0, NORTH, 0.5, ":c_c0_0", 1.0, Body(0.5, 0.75, PERSON_DECELERATION, 2.0, True))


def test_people_on_a_crossing_are_read_each_with_his_own_body(monkeypatch):
    sensor, _ = seeing(monkeypatch, {}, {":c_c0": ("p", "q")}, WALKER)
    for _ in range(2):
        assert list(sensor.on_crossing(CROSSING)) == [P, Q]


@pytest.mark.parametrize(
    ("x", "position", "heading"),
    [
        (-STEPPING_ON_M + 0.01, -STEPPING_ON_M + 0.01, 0.3),
        (-STEPPING_ON_M - 0.01, None, None),
        (-0.5, -0.5, 0.3),
        (1.0, -1.0, 0.3),
        (9.0, 13.0, 3.4),
        (10.5, 12.5, 3.4),
        (10.0 + STEPPING_ON_M, None, None),
        (5.0 + 1.01, 12.0 + 3.99, 3.4),
        (5.0, None, None),
    ],
)
def test_who_is_about_to_cross_is_before_the_nearer_end_and_looks_as_he_will_step_on(monkeypatch, x, position, heading):
    walkers = WALKER | {"getPosition": (x, 0.0), "getNextEdge": {"p": ":c_c0", "q": ":c_c1"}}
    sensor, _ = seeing(monkeypatch, {}, {":c_w0": ("q",), ":c_w1": ("p", "q")}, walkers)
    found = [(one.id, one.lane_position, one.heading, one.lane_id) for one in sensor.about_to_cross(CROSSING)]
    assert found == ([] if position is None else [("p", pytest.approx(position), heading, ":c_c0_0")])


def values(x=0.0, y=0.0, z=0.0, lane="a_0", angle=0.0):
    """What is subscribed of one vehicle."""
    return {
        tc.VAR_POSITION3D: (x, y, z), tc.VAR_ANGLE: angle, tc.VAR_SPEED: 4.0, tc.VAR_LANE_ID: lane,
        tc.VAR_LANEPOSITION: 30.0, tc.VAR_LENGTH: 5.0, tc.VAR_WIDTH: 1.75, tc.VAR_ACCELERATION: -1.5,
    }  # fmt: skip


def watched(monkeypatch, seen, people=None, ended=(), teleporting=()):
    """SUMO with what is near the ego; all may be changed under way. Return what it is asked for routes."""
    asked = []
    people = people or {}
    vehicle = Domain(
        **CAR | {"getContextSubscriptionResults": {"ego": seen}, "getDeparture": 2.0, "getAccel": 2.0, "getTau": 1.0,
                 "getMinGap": 2.0, "getTypeID": "t", "getParameter": "",
                 "getRoute": lambda who: (asked.append(who), ("a", "b", "c"))[1], "getRouteIndex": 0},
    )  # fmt: skip
    person = {name: {who: one[name] for who, one in people.items()} for name in WALKER | {"getRoadID": 0, "getLaneID": 0}}
    edge = Domain(getFromJunction=lambda one: one[:1], getToJunction=lambda one: one[-1:])
    script(
        monkeypatch,
        vehicle=vehicle, vehicletype=Domain(getParameter=""), person=Domain(getIDList=tuple(people), **person), edge=edge,
        trafficlight=Domain(getIDList=()),
        simulation=Domain(getArrivedIDList=lambda: tuple(ended), getStartingTeleportIDList=lambda: tuple(teleporting)),
    )  # fmt: skip
    return asked


def body(length, width):
    """A body of whom nothing else is known."""
    return (length, width, pytest.approx(math.nan, nan_ok=True), pytest.approx(math.nan, nan_ok=True))


def test_an_observed_vehicle_sees_all_that_is_subscribed_on_its_level(monkeypatch):
    seen = {"ego": values(z=5.0), "x": values(3.0, 4.0, 5.0 + SAME_LEVEL_M - 0.1, ":j_0_0", 90.0)}
    watched(monkeypatch, seen | {"up": values(z=5.0 + SAME_LEVEL_M), "down": values(z=5.0 - SAME_LEVEL_M)})
    observed = ObservedVehicle("ego", 70.0)
    wanted = [
        tc.VAR_POSITION3D,
        tc.VAR_ANGLE,
        tc.VAR_SPEED,
        tc.VAR_LANE_ID,
        tc.VAR_LANEPOSITION,
        tc.VAR_LENGTH,
        tc.VAR_WIDTH,
        tc.VAR_ACCELERATION,
    ]
    assert libsumo.vehicle.told == [("subscribeContext", "ego", tc.CMD_GET_VEHICLE_VARIABLE, 70.0, wanted)]
    view = observed.look()
    (other,) = view.others
    assert other == RoadUser("x", 3.0, 4.0, EAST, 4.0, ":j_0_0", 30.0, other.body, ("b", "c"), acceleration=-1.5)
    assert other.body == (*body(5.0, 1.75), False, 0.0, 0.0)
    assert (view.own.id, view.own.route, view.own.heading) == ("ego", ("a", "b", "c"), NORTH)
    assert (observed.departure, observed.limits.length) == (2.0, 5.0)


def test_a_way_is_asked_for_once_on_each_edge(monkeypatch):
    seen = {"ego": values(), "x": values()}
    asked = watched(monkeypatch, seen)
    observed, counts = ObservedVehicle("ego", 70.0), []
    for lane in ("a_0", "a_1", "b_0", ":j_0_0"):
        seen["x"] = values(lane=lane)
        asked.clear()
        observed.look()
        counts.append(asked.count("x"))
    assert counts == [1, 0, 1, 1]


def test_off_the_road_there_is_nothing_to_see_and_teleports_and_the_arrival_are_counted(monkeypatch):
    seen, ended, teleporting = {"ego": values()}, [], ["other"]
    watched(monkeypatch, seen, None, ended, teleporting)
    observed, told = ObservedVehicle("ego", 70.0), []
    for step in range(5):
        teleporting[:] = ["other", "ego"] if step in (1, 2) else ["other"]
        ended[:] = ["ego"] if step == 3 else ["other"]
        libsumo.vehicle.answers["getContextSubscriptionResults"] = {"ego": {} if step == 1 else seen}
        told.append((observed.look() is not None, observed.teleports, observed.arrived))
    assert told == [(True, 0, False), (False, 1, False), (True, 2, False), (False, 2, True), (False, 2, True)]


def walker(x, y, road=":c_c0"):
    return {name: of["p"] for name, of in WALKER.items()} | {
        "getPosition": (x, y), "getRoadID": road, "getLaneID": f"{road}_0",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("x", "y", "road", "is_seen"),
    [
        (10.0 + 42.0, 20.0 - 55.9, ":c_c0", True),  # nearly 70 m away
        (10.0 + 42.0, 20.0 - 56.1, ":c_c0", False),
        (12.0, 21.0, ":c_w0", False),
        (12.0, 21.0, "a", False),
        (12.0, 21.0, ":c_c12", True),
        (12.0, 21.0, ":c_c1x", False),
    ],
)
def test_people_are_seen_on_crossings_within_reach(monkeypatch, x, y, road, is_seen):
    watched(monkeypatch, {"ego": values(10.0, 20.0)}, {"far": walker(500.0, 0.0), "p": walker(x, y, road)})
    found = ObservedVehicle("ego", 70.0).look().others
    assert [one[:7] for one in found] == ([("p", x, y, EAST, 1.25, f"{road}_0", 3.0)] if is_seen else [])
    assert [one.body for one in found] == ([(*body(0.25, 0.5), True, 0.0, 0.0)] if is_seen else [])


@pytest.mark.parametrize(
    ("here", "there", "is_near"),
    [
        ("a-b_0", "b-c_0", True),
        ("a-b_0", "c-d_0", False),
        ("a-b_0", "c-a_1", True),
        ("", "c-d_0", True),
        ("a-b_0", "", True),
    ],
)
def test_bystanders_are_those_on_roads_that_a_junction_joins_and_on_none(monkeypatch, here, there, is_near):
    seen = {"ego": values(lane=here), "x": values(1.0, 2.0, lane=there), "reactive.ghost.1": values(lane=here)}
    watched(monkeypatch, seen)
    bystanders = Bystanders("ego")
    for _ in range(2):
        found = bystanders.look()
        assert [(one.id, one.x, one.y, one.route) for one in found] == ([("x", 1.0, 2.0, ())] if is_near else [])
    bystanders.leave()
    libsumo.vehicle.answers["getContextSubscriptionResults"] = {"ego": {}}
    assert bystanders.look() == ()
    assert libsumo.vehicle.told[-1] == ("unsubscribeContext", "ego", tc.CMD_GET_VEHICLE_VARIABLE, TOUCHING_M)


def test_the_ego_is_left_out_of_its_lane_and_the_boxes_are_those_of_the_others(monkeypatch):
    sensor, _ = seeing(monkeypatch, {"a_0": ("x", "ego", "y"), "b_0": ("z",), "empty_0": ()})
    lanes = {"a_0": LANE, "empty_0": LANE._replace(lane_id="empty_0"), "b_0": LANE._replace(lane_id="b_0")}
    sensor.look()
    found = sensor.vehicles(lanes, "ego")
    assert [[user.id for user in one.users] for one in found] == [["x", "y"], ["z"]]
    assert [one.boxes for one in found] == [packed_boxes(one.users) for one in found]
    assert [user.id for one in sensor.vehicles(lanes) for user in one.users] == ["x", "ego", "y", "z"]
