"""The ego in a real simulation, where its body swings out of its lanes."""

from contextlib import contextmanager
from itertools import pairwise

import libsumo
import pytest
from net_recipes import CROSS_NODES, converted, cross_edges

from sumo_reactive.driver.nouns.completed_plan import Intent
from sumo_reactive.driver.nouns.state import VehicleState
from sumo_reactive.driver.world.route import Route
from sumo_reactive.errors import ScenarioError, SimulationError
from sumo_reactive.sumo.asking import Asking
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.orders import AT_ONCE
from sumo_reactive.sumo.outputs import trip_of
from sumo_reactive.sumo.vehicle_type import front_of, pose_of

ROUTE = ("wc", "ce")
LANE_Y = -1.6
"""Centre of the lane wc_0, m; the oncoming lane lies at +1.6."""


@contextmanager
def on_cross(tmp_path, attributes="", inner="", *, before="", options=()):
    """Run a simulation of a cross with an ego on ROUTE; yield it and its lane. `before`: types, and who drives there."""
    net = converted(tmp_path, CROSS_NODES.format(kind="priority"), cross_edges(), "--no-turnarounds")
    routes = tmp_path / "ego.rou.xml"
    vehicle = f'<vehicle id="ego" depart="0" {attributes}><route edges="{" ".join(ROUTE)}"/>{inner}</vehicle>'
    routes.write_text(f"<routes>{before}{vehicle}</routes>")
    with seen_first(net, routes, *options) as ego:
        yield ego, read_net(net).lane("wc_0")


@contextmanager
def seen_first(net, routes, *options):
    """Run a simulation, after the first step of which the ego is on the road."""
    libsumo.start(["sumo", "-n", str(net), "-r", str(routes), "--no-step-log", "--step-length", "0.1", *options])
    try:
        libsumo.simulationStep()
        yield Ego("ego")
    finally:
        libsumo.close()


def test_an_ego_that_swings_out_over_another_road_keeps_its_route(tmp_path):
    """A long vehicle in a U-turn does; with its route lost, SUMO's sublane model crashed."""
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        mapped = []
        for y in (LANE_Y - 8.0, LANE_Y + 4.0, LANE_Y):  # beside the road, over the oncoming lane, back
            state = VehicleState(pose_of(-100.0, y, 0.0, ego.limits), 1.0, 0.0)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            mapped.append(ego.lane(state))
            assert libsumo.vehicle.getRoute("ego") == ROUTE
        assert (mapped[0], mapped[-1]) == ("", "wc_0")


def test_others_expect_of_the_ego_what_they_expect_of_its_type_until_it_brakes_harder(tmp_path):
    """SUMO's cars choose their gaps behind a vehicle by its type: with more to fear they would at once brake hard."""
    with on_cross(tmp_path) as (ego, lane):
        usual = libsumo.vehicle.getApparentDecel("ego")
        ego.take_over(0.1)
        feared = []
        for acceleration in (0.0, -3.0, -8.0, -1.0):
            state = VehicleState(pose_of(-60.0, LANE_Y, 0.0, ego.limits), 10.0, 0.0, acceleration)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            feared.append(libsumo.vehicle.getApparentDecel("ego"))
        assert feared == [usual, usual, ego.limits.emergency_deceleration, usual]


def test_the_ego_asks_for_room_only_while_it_seeks_a_gap(tmp_path):
    with on_cross(tmp_path) as (ego, _):
        ego.take_over(0.1)
        modes = []
        for wants_room in (False, True, True, False):
            ego.ask_for_room(wants_room)
            modes.append(libsumo.vehicle.getLaneChangeMode("ego") != 0)
        assert modes == [False, True, True, False]


def over_the_lane_beside(net):
    """The places of an ego that swings over lane wc_0 on its way from wc_1 into the junction, and the lane inside."""
    graph = read_net(net).build(("wc", "cn"))
    beside, own = graph.lanes["wc_0"].spine, graph.lanes["wc_1"]
    (turn,) = (c for c in graph.ways_from("wc_1") if c.to_lane.startswith("cn"))
    inside = graph.lanes[turn.parts[0]]
    way = [(*beside.at(beside.length + s), own) for s in (-1.5, -1.0, -0.5, 0.0)]
    return [*way, *((*inside.spine.at(s), inside) for s in (0.5, 1.0))], inside


def test_an_ego_that_swings_over_the_lane_beside_as_it_turns_keeps_its_speed_for_sumo(tmp_path):
    """From the end of a lane that does not lead where the ego goes SUMO would stop it for a step."""
    net = converted(tmp_path, CROSS_NODES.format(kind="priority"), cross_edges(2), "--no-turnarounds")
    routes = tmp_path / "ego.rou.xml"
    vehicle = '<vehicle id="ego" depart="0" departLane="1"><route edges="wc cn"/></vehicle>'
    routes.write_text(f"<routes>{vehicle}</routes>")
    way, inside = over_the_lane_beside(net)
    with seen_first(net, routes) as ego:
        ego.take_over(0.1)
        seen = []
        for x, y, lane in way:
            state = VehicleState(pose_of(x, y, 0.0, ego.limits), 5.0, 0.0)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            seen.append((ego.lane(state), libsumo.vehicle.getSpeed("ego")))
        assert [lane for lane, _ in seen] == ["wc_0"] * 4 + [inside.id] * 2
        assert [speed for _, speed in seen] == [5.0] * 6


def test_who_follows_does_not_brake_for_a_step_in_which_sumo_has_stopped_the_ego(tmp_path):
    """With somebody on the ego's lane SUMO has it on the one beside to its end, and stops it there for a step."""
    net = converted(tmp_path, CROSS_NODES.format(kind="priority"), cross_edges(2), "--no-turnarounds")
    routes = tmp_path / "ego.rou.xml"
    vehicles = """<routes><vType id="car" sigma="0"/>
        <vehicle id="ego" depart="0" departLane="1"><route edges="wc cn"/></vehicle>
        <vehicle id="behind" depart="0" departLane="0" departPos="124" departSpeed="5"><route edges="wc ce"/></vehicle>
        <vehicle id="left" depart="0" departLane="1" departPos="20" departSpeed="5"><route edges="wc cn"/></vehicle>
        </routes>"""
    routes.write_text(vehicles)
    way, _ = over_the_lane_beside(net)
    with seen_first(net, routes) as ego:
        ego.take_over(0.1)
        told, braking = [], []
        for x, y, lane in way:
            state = VehicleState(pose_of(x, y, 0.0, ego.limits), 5.0, 0.0)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            braking.append(libsumo.vehicle.getAcceleration("behind"))
            told.append((libsumo.vehicle.getSpeed("ego"), ego.lane(state) and libsumo.vehicle.getSpeed("ego")))
        assert told == [(5.0, 5.0)] * 4 + [(0.0, 5.0), (5.0, 5.0)]  # as SUMO says, and as the others see it
        assert min(braking[1:]) > -1.0


@pytest.mark.parametrize(("speed", "is_turned"), [(14.0, True), (2.0, False)])
def test_an_ego_inserted_askew_at_the_start_of_its_lane_is_laid_along_it_unless_it_steers_back(tmp_path, speed, is_turned):
    """On a lane that begins with a bend SUMO shows the angle of a body whose rear is nowhere yet."""
    with on_cross(tmp_path, 'departPos="0"') as (ego, lane):
        seen = ego.take_over(0.1)
        x, y = front_of(seen.pose, ego.limits)
        askew = VehicleState(pose_of(x, y, seen.pose.heading + 0.5, ego.limits), speed, 0.0)
        laid = ego.laid_along(lane, askew)
        assert laid.pose.heading == pytest.approx(0.0 if is_turned else askew.pose.heading, abs=1e-3)
        assert front_of(laid.pose, ego.limits) == pytest.approx((x, y))


def test_an_ego_whose_body_is_on_its_lane_keeps_the_angle_it_has(tmp_path):
    with on_cross(tmp_path) as (ego, lane):
        seen = ego.take_over(0.1)
        askew = VehicleState(pose_of(seen.pose.x, seen.pose.y, 0.5, ego.limits), 14.0, 0.0)
        assert ego.laid_along(lane, askew) is askew


def placed_at(ego, x, speed=5.0, y=LANE_Y, **how):
    """Place the ego with its bumper at (x, y), heading east, and simulate the step."""
    state = VehicleState(pose_of(x, y, 0.0, ego.limits), speed, 0.0)
    ego.place(state, how.get("intent", Intent.DRIVE), 0.1, how.get("lane"))
    libsumo.simulationStep()
    return state


def test_an_ego_that_is_where_it_was_put_is_verified_with_its_lane(tmp_path):
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        assert ego.lane(placed_at(ego, -60.0, lane=lane)) == "wc_0"


@pytest.mark.parametrize(
    ("dx", "dy", "is_wrong"), [(0.005, 0.0, False), (0.02, 0.0, True), (0.0, -0.02, True), (3.0, 0.0, True)]
)
def test_an_ego_that_sumo_has_put_elsewhere_is_an_error_that_says_where(tmp_path, dx, dy, is_wrong):
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        placed_at(ego, -60.0 + dx, y=LANE_Y + dy, lane=lane)
        meant = VehicleState(pose_of(-60.0, LANE_Y, 0.0, ego.limits), 5.0, 0.0)
        if not is_wrong:
            assert ego.lane(meant) == "wc_0"
            return
        with pytest.raises(SimulationError) as told:
            ego.lane(meant)
        there = f"({-60.0 + dx:.2f}, {LANE_Y + dy:.2f})"
        assert str(told.value) == f"SUMO moved ego 'ego' to {there} instead of (-60.00, -1.60)"


def test_an_ego_that_sumo_has_taken_off_the_road_is_an_error_that_names_it(tmp_path):
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        state = placed_at(ego, -60.0, lane=lane)
        libsumo.vehicle.remove("ego")
        libsumo.simulationStep()
        with pytest.raises(SimulationError, match=r"^SUMO has taken ego 'ego' off the road: "):
            ego.lane(state)


def test_an_ego_that_has_arrived_is_off_the_road_and_counts_as_arrived(tmp_path):
    trips = tmp_path / "trips.xml"
    with on_cross(tmp_path, options=("--tripinfo-output", str(trips))) as (ego, lane):
        ego.take_over(0.1)
        placed_at(ego, -60.0, lane=lane)
        ego.arrive()
        libsumo.simulationStep()
        assert "ego" not in libsumo.vehicle.getIDList()
    trip = trip_of(trips, "ego")
    assert trip is not None
    assert trip.arrival == pytest.approx(0.2)


def test_an_ego_that_is_released_drives_on_as_sumo_drives(tmp_path):
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        placed_at(ego, -60.0, speed=0.0, lane=lane)
        ego.release()
        for _ in range(30):
            libsumo.simulationStep()
        assert libsumo.vehicle.getSpeed("ego") > 3.0
        assert (libsumo.vehicle.getSpeedMode("ego"), libsumo.vehicle.getLaneChangeMode("ego")) == (31, 1621)


def test_an_ego_taken_over_is_where_sumo_has_it_and_drives_by_itself_no_more(tmp_path):
    stop = '<stop lane="ce_0" endPos="50" duration="10"/><stop lane="ce_0" endPos="90" until="77"/>'
    with on_cross(tmp_path, 'departSpeed="8"', stop) as (ego, _):
        x, y = libsumo.vehicle.getPosition("ego")
        state = ego.take_over(0.1)
        assert front_of(state.pose, ego.limits) == pytest.approx((x, y))
        assert (state.speed, state.steering_angle) == (libsumo.vehicle.getSpeed("ego"), 0.0)
        assert not libsumo.vehicle.getStops("ego")
        assert (libsumo.vehicle.getSpeedMode("ego"), libsumo.vehicle.getLaneChangeMode("ego")) == (32, 0)
        assert [(s.lane_id, s.position, s.duration, s.until) for s in ego.route.stops] == [
            ("ce_0", 50.0, 10.0, None), ("ce_0", 90.0, 0.0, 77.0),
        ]  # fmt: skip


@pytest.mark.parametrize(
    ("said", "position", "lane"),
    [("", None, None), ('arrivalPos="40"', 40.0, None), ('arrivalPos="-20" arrivalLane="0"', "from the end", 0)],
)
def test_where_the_route_ends_is_read_with_it(tmp_path, said, position, lane):
    with on_cross(tmp_path, said) as (ego, _):
        length = libsumo.lane.getLength("ce_0")
        expected = length - 20.0 if position == "from the end" else position
        assert ego.route.edges == ROUTE
        assert ego.route.arrival_position == (None if expected is None else pytest.approx(expected))
        assert ego.route.arrival_lane == lane


@pytest.mark.parametrize(
    ("speed", "intent", "announced"),
    [(5.0, Intent.YIELD, 5.0), (0.0, Intent.GO_NEXT, 0.05), (0.0, Intent.YIELD, 0.0), (0.04, Intent.DRIVE, 0.04)],
)
def test_what_the_ego_announces_says_whether_it_yields(tmp_path, speed, intent, announced):
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        placed_at(ego, -60.0, speed=speed, intent=intent, lane=lane)
        assert libsumo.vehicle.getSpeed("ego") == pytest.approx(announced)


@pytest.mark.parametrize(("limit", "nudges"), [(8.0, True), (-1.0, False)])
def test_an_ego_that_stands_for_long_moves_for_a_step_before_sumo_would_teleport_it(tmp_path, limit, nudges):
    with on_cross(tmp_path, options=("--time-to-teleport", str(limit))) as (ego, lane):
        ego.take_over(0.1)
        told = [placed_at(ego, -60.0, 0.0, lane=lane) and libsumo.vehicle.getSpeed("ego") for _ in range(150)]
        assert (max(told) > 0.1) is nudges
        assert sum(speed > 0.1 for speed in told) <= 6
        assert libsumo.vehicle.getPosition("ego")[0] == pytest.approx(-60.0)


@pytest.mark.parametrize(("speed", "before_it"), [(0.0, 0.005), (1.0, 0.0)])
def test_an_ego_that_stands_on_the_end_of_its_lane_is_kept_out_of_the_junction(tmp_path, speed, before_it):
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        end, _ = lane.spine.at(lane.spine.length)
        placed_at(ego, end - 0.002, lane=lane)
        placed_at(ego, end - 0.002, speed=speed, lane=lane)
        assert libsumo.vehicle.getPosition("ego")[0] == pytest.approx(end - 0.002 - before_it, abs=1e-4)


def test_who_has_been_passed_sees_the_ego_as_its_leader_again(tmp_path):
    """SUMO keeps the order in which they came: it has to be sorted in anew."""
    other = '<vehicle id="slow" depart="0" departPos="60" departSpeed="3" type="slow"><route edges="wc ce"/></vehicle>'
    kind = '<vType id="slow" maxSpeed="3" sigma="0" speedDev="0"/>'
    with on_cross(tmp_path, 'departPos="30" departSpeed="8"', before=kind + other) as (ego, lane):
        ego.take_over(0.1)
        x, leaders = libsumo.vehicle.getPosition("ego")[0], []
        for _ in range(80):
            x += 0.9
            placed_at(ego, x, 9.0, lane=lane)
            leader = libsumo.vehicle.getLeader("slow", 100.0)
            leaders.append(leader[0] if leader else "")
        assert leaders[0] == "" and leaders[-1] == "ego"


def test_an_ego_on_another_route_drives_it_for_sumo_too(tmp_path):
    with on_cross(tmp_path) as (ego, _):
        ego.take_over(0.1)
        ego.reroute(Route(("wc", "cn")))
        assert libsumo.vehicle.getRoute("ego") == ego.route.edges == ("wc", "cn")


@pytest.mark.parametrize("kind", ["bicycle", "tram", "pedestrian"])
def test_what_is_no_road_car_is_refused_with_its_class(tmp_path, kind):
    told = pytest.raises(ScenarioError, match=rf"^ego 'ego' is not a road car: its class is '{kind}'$")
    with told, on_cross(tmp_path, 'type="odd"', before=f'<vType id="odd" vClass="{kind}"/>'):
        pass


def test_the_time_lost_and_the_place_on_the_lane_are_sumos(tmp_path):
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        for _ in range(20):
            placed_at(ego, -60.0, speed=0.0, lane=lane)
        assert ego.time_loss() == libsumo.vehicle.getTimeLoss("ego") > 1.0
        graph = read_net(tmp_path / "n.net.xml").build(ROUTE)
        assert ego.lane_position(graph, "wc_0") == pytest.approx(libsumo.vehicle.getLanePosition("ego"), abs=0.01)


def test_who_is_let_go_does_not_wait_for_the_ego_in_a_junction_as_long_as_it_is(tmp_path):
    other = '<vehicle id="other" depart="0"><route edges="nc cs"/><param key="junctionModel.ignoreIDs" value="z"/></vehicle>'
    with on_cross(tmp_path, before=other) as (ego, _):

        def ignored():
            return libsumo.vehicle.getParameter("other", "junctionModel.ignoreIDs")

        seen = []
        for users in (("other", "gone"), ("other",), (), ("other",)):
            ego.let_go(users)
            seen.append(ignored())
        assert seen == ["z ego", "z ego", "z", "z ego"]
        ego.take_over(0.1)
        ego.release()
        assert ignored() == "z"


@pytest.mark.parametrize("is_let_go", [True, False])
def test_sumo_lets_somebody_pass_who_is_let_go_though_the_ego_stands_in_the_junction(tmp_path, is_let_go):
    other = '<vehicle id="other" depart="0" departPos="60"><route edges="nc cs"/></vehicle>'
    with on_cross(tmp_path, before=other) as (ego, lane):
        ego.take_over(0.1)
        state = VehicleState(pose_of(-2.0, LANE_Y, 0.0, ego.limits), 0.0, 0.0)
        for k in range(300):
            ego.place(state, Intent.YIELD, 0.1, lane)
            if k > 200 and is_let_go:
                ego.let_go(("other",))
            libsumo.simulationStep()
        left = "other" not in libsumo.vehicle.getIDList() or libsumo.vehicle.getLaneID("other") == "cs_0"
        assert left is is_let_go


def asked_at(tmp_path, asked, *, told=True, mode=31):
    """Return the speeds of a car that comes up behind an ego at 5 m/s, by step, asked to let it in for the second second."""
    other = '<vType id="calm" sigma="0"/><vehicle id="other" type="calm" depart="0" departPos="30" departSpeed="13">'
    other += '<route edges="wc ce"/></vehicle>'
    speeds, how = [], ("--default.speeddev", "0")
    with on_cross(tmp_path, 'departPos="95" departSpeed="5"', before=other, options=how) as (ego, lane):
        ego.take_over(0.1)
        libsumo.vehicle.setSpeedMode("other", mode)
        x, asking = libsumo.vehicle.getPosition("ego")[0], Asking("ego", 2.0, AT_ONCE)
        for k in range(30):
            asking.ask(asked if told and 10 <= k < 20 else "")
            placed_at(ego, x + 0.5 * (k + 1), speed=5.0, lane=lane)
            speeds.append(libsumo.vehicle.getSpeed("other"))
    return speeds


def test_who_is_asked_falls_back_gently_until_he_is_asked_no_more(tmp_path):
    alone, asked = (asked_at(tmp_path, "other", told=told) for told in (False, True))
    assert asked[:10] == alone[:10]
    brakes = [10.0 * (a - b) for a, b in pairwise(asked[9:20])]
    assert max(brakes) == pytest.approx(2.0, abs=0.01)
    assert asked[19] < alone[19] - 1.0
    assert asked[29] > asked[19]


@pytest.mark.parametrize(("asked", "mode"), [("gone", 31), ("", 31), ("other", 32)])
def test_nobody_is_asked_who_has_left_or_is_moved_from_outside(tmp_path, asked, mode):
    assert asked_at(tmp_path, asked, mode=mode) == asked_at(tmp_path, asked, told=False, mode=mode)


def test_who_does_not_come_by_the_egos_road_is_not_asked(tmp_path):
    other = '<vehicle id="other" depart="0" departPos="15" departSpeed="13"><route edges="nc cs"/></vehicle>'
    with on_cross(tmp_path, before=other, options=("--default.speeddev", "0")) as (ego, lane):
        ego.take_over(0.1)
        Asking("ego", 2.0, AT_ONCE).ask("other")
        placed_at(ego, -60.0, speed=0.0, lane=lane)
        assert libsumo.vehicle.getSpeed("other") > 13.0
