"""What an ego can see of a simulation: vehicles on lanes, people on crossings and before them, letters of lights."""

import math
from itertools import groupby

import libsumo
import pytest
from helpers.cars import CAR
from net_recipes import CROSS_NODES, converted, cross_edges
from simulations import running, simulated, vehicle

from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.world.route import Route
from sumo_reactive.sumo.asking import Asking
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.observer import EgoObserver
from sumo_reactive.sumo.orders import AT_ONCE
from sumo_reactive.sumo.sensor import PERSON_DECELERATION, STEPPING_ON_M, SeenCrossing, SeenLane, Sensor
from sumo_reactive.sumo.vehicle_type import heading_of, pose_of

SIDEWALKS = ("--no-turnarounds", "--sidewalks.guess", "--sidewalks.guess.max-speed", "15", "--crossings.guess")
TYPE = '<vType id="t" length="4.4" width="1.7" decel="4" emergencyDecel="7" maxSpeed="33" sigma="0" speedDev="0"/>'


@pytest.fixture(scope="module")
def net(tmp_path_factory):
    kind = CROSS_NODES.format(kind="traffic_light")
    return converted(tmp_path_factory.mktemp("net"), kind, cross_edges(), *SIDEWALKS)


def seen_lane(graph, lane_id: str) -> SeenLane:
    lane = graph.lanes[lane_id]
    return SeenLane(lane_id, lane.edge_id, lane.scale, lane.is_internal)


def looked(sensor: Sensor, *lanes: SeenLane):
    """Who is on these lanes now, by id."""
    sensor.look()
    seen = sensor.vehicles({lane.lane_id: lane for lane in lanes})
    return {user.id: user for one in seen for user in one.users}


def test_a_vehicle_is_seen_where_it_is_with_its_body_and_the_way_it_goes(net, tmp_path):
    graph = read_net(net).build(("wc", "ce"))
    lane = seen_lane(graph, "wc_1")._replace(scale=2.0)
    with running(net, tmp_path, TYPE + vehicle("a", "wc ce", type="t", departPos=30, departSpeed=9)):
        simulated(2)
        one = looked(Sensor(), lane)["a"]
        x, y = libsumo.vehicle.getPosition("a")
        assert (one.x, one.y, one.speed) == (x, y, libsumo.vehicle.getSpeed("a") * lane.scale)
        assert one.heading == pytest.approx(0.0)
        assert (one.lane_id, one.lane_position) == ("wc_1", 2.0 * libsumo.vehicle.getLanePosition("a"))
        assert (one.body.length, one.body.width, one.body.emergency_deceleration, one.body.max_speed) == (
            4.4,
            1.7,
            7.0,
            33.0,
        )
        assert one.route == ("wc", "ce") and not one.body.is_person
        assert (one.waiting_time, one.is_halted) == (0.0, False)


def test_inside_the_junction_the_way_begins_with_the_next_road(net, tmp_path):
    graph = read_net(net).build(("nc", "cs"))
    inside = [part for way in graph.ways_from("nc_1") if way.to_lane == "cs_1" for part in way.parts]
    lanes = [seen_lane(graph, name) for name in (*inside, "cs_1")]
    with running(net, tmp_path, TYPE + vehicle("a", "nc cs", type="t", departPos=120, departSpeed=9)):
        sensor, routes = Sensor(), {}
        libsumo.trafficlight.setRedYellowGreenState("c", "G" * len(libsumo.trafficlight.getRedYellowGreenState("c")))
        for _ in range(60):
            simulated()
            for one in looked(sensor, *lanes).values():
                routes.setdefault(one.lane_id, one.route)
        assert routes == {inside[0]: ("cs",), "cs_1": ("cs",)}


def test_who_stands_is_seen_with_how_long_and_whether_it_has_halted(net, tmp_path):
    stop = '<stop lane="wc_1" endPos="40" duration="60"/>'
    cars = vehicle("halted", "wc ce", stop, type="t", departPos=39.9) + vehicle("waiting", "wc ce", type="t", departPos=30)
    graph = read_net(net).build(("wc", "ce"))
    with running(net, tmp_path, TYPE + cars):
        simulated(90)
        found = looked(Sensor(), seen_lane(graph, "wc_1"))
        assert found["halted"].is_halted and not found["waiting"].is_halted
        assert found["waiting"].waiting_time == pytest.approx(libsumo.vehicle.getWaitingTime("waiting"))
        assert found["waiting"].waiting_time > 1.0


def test_stand_ins_are_nobody(net, tmp_path):
    graph = read_net(net).build(("wc", "ce"))
    with running(net, tmp_path, TYPE + vehicle("reactive.ghost.a.1", "wc ce", type="t", departPos=30)):
        simulated(2)
        assert looked(Sensor(), seen_lane(graph, "wc_1")) == {}


def test_what_one_ego_has_looked_at_in_a_step_is_not_read_again_but_in_the_next_step_it_is(net, tmp_path, monkeypatch):
    graph, asked = read_net(net).build(("wc", "ce")), []
    with running(net, tmp_path, TYPE + vehicle("a", "wc ce", type="t", departPos=30, departSpeed=9)):
        simulated(2)
        read = libsumo.vehicle.getPosition
        monkeypatch.setattr(libsumo.vehicle, "getPosition", lambda name: (asked.append(name), read(name))[1])
        sensor, lane = Sensor(), seen_lane(graph, "wc_1")
        first = looked(sensor, lane)["a"]
        assert looked(sensor, lane)["a"] is first and len(asked) == 1
        simulated()
        assert looked(sensor, lane)["a"].x > first.x and len(asked) == 2


def test_who_is_asked_by_another_ego_sees_the_first_that_asks_and_is_there(net, tmp_path):
    graph = read_net(net).build(("wc", "ce"))
    users = vehicle("a", "wc ce", type="t", departPos=40) + vehicle("b", "wc ce", type="t", departPos=20)
    with running(net, tmp_path, TYPE + users):
        simulated(2)
        sensor, asking = Sensor(), {name: Asking(name, 2.0, AT_ONCE) for name in ("gone", "b", "a")}
        libsumo.vehicle.setSpeedMode("a", 32)  # as an ego
        for asker in ("gone", "b"):
            asking[asker].ask("a")
        assert sensor.asker_of("a", ("wc_1",)) == ""  # nobody has been looked at
        looked(sensor, seen_lane(graph, "wc_1"))
        seen = [sensor.asker_of(name, (lane,)) for name, lane in (("a", "wc_1"), ("a", "wc_0"), ("b", "wc_1"))]
        assert seen == ["b", "", ""]
        asking["b"].ask("")
        assert sensor.asker_of("a", ("wc_1",)) == ""


def test_a_route_that_changes_under_way_is_noticed_at_once(net, tmp_path):
    graph = read_net(net).build(("wc", "ce"))
    with running(net, tmp_path, TYPE + vehicle("a", "wc ce", type="t", departPos=0, departSpeed=1, departLane="best")):
        sensor, lane = Sensor(), seen_lane(graph, "wc_1")
        simulated(2)
        assert looked(sensor, lane)["a"].route == ("wc", "ce")
        libsumo.vehicle.setSpeed("a", 1.0)
        libsumo.vehicle.setRoute("a", ("wc", "cn"))
        assert looked(sensor, lane)["a"].route == ("wc", "ce")  # as looked at before in this step
        simulated()
        assert looked(sensor, lane)["a"].route == ("wc", "cn")


def test_the_letters_of_a_light_are_those_of_the_present_step(net, tmp_path):
    with running(net, tmp_path, ""):
        sensor, count = Sensor(), len(libsumo.trafficlight.getRedYellowGreenState("c"))
        for letter in "rG":
            libsumo.trafficlight.setRedYellowGreenState("c", letter * count)
            simulated()
            sensor.look()
            assert sensor.letters("c") == letter * count


WALK = '<person id="p" depart="0" departPos="145"><walk edges="wc nc" speed="1.5"/></person>'


def crossing(graph, of_edge: str) -> SeenCrossing:
    """The crossing over a road, as the ends of its lane say it."""
    (way,) = (
        c for c in graph.connections.values() if c.is_crossing and c.parts[0].startswith(":c_c") and _is_over(c, of_edge)
    )
    lane = graph.lanes[way.parts[0]]
    spine = lane.spine
    first, last = spine.at(0.0), spine.at(spine.length)
    walks = tuple(dict.fromkeys(end.rpartition("_")[0] for end in (way.from_lane, way.to_lane)))
    ends = ((*first, 0.0, spine.heading_at(0.0)), (*last, spine.length, spine.heading_at(spine.length) + math.pi))
    return SeenCrossing(lane.edge_id, lane.id, walks, ends)


def _is_over(way, of_edge: str) -> bool:
    (x, y), west = way.path.at(0.5 * way.path.length), -1.0
    return abs(y) < 3.0 and x * west > 0.0 if of_edge == "wc" else abs(x) < 3.0 and y > 0.0


def test_who_walks_over_a_crossing_is_seen_on_it_and_before_that_as_one_who_is_about_to(net, tmp_path):
    graph = read_net(net).build(("ec", "cw"))
    one = crossing(graph, "wc")
    seen: list[tuple[str, float]] = []
    with running(net, tmp_path, WALK):
        libsumo.trafficlight.setRedYellowGreenState("c", "G" * len(libsumo.trafficlight.getRedYellowGreenState("c")))
        sensor = Sensor()
        for _ in range(300):
            simulated()
            sensor.look()
            for kind, found in (("about", sensor.about_to_cross(one)), ("on", sensor.on_crossing(one))):
                for person in found:
                    seen.append((kind, person.lane_position))
                    x, y = libsumo.person.getPosition("p")
                    assert (person.id, person.x, person.y, person.lane_id) == ("p", x, y, one.lane_id)
                    assert person.body.is_person and person.body.emergency_deceleration == PERSON_DECELERATION
                    assert person.speed == libsumo.person.getSpeed("p")
                    assert kind == "about" or person.heading == heading_of(libsumo.person.getAngle("p"))
    length = graph.lanes[one.lane_id].spine.length
    before, over = ([at for kind, at in seen if kind == wanted] for wanted in ("about", "on"))
    assert before and over
    assert all(-STEPPING_ON_M < at < 0.0 or length < at < length + STEPPING_ON_M for at in before)
    assert all(0.0 <= at <= length for at in over)
    assert [kind for kind, _ in seen] == sorted(kind for kind, _ in seen)  # about, then on


def start_of(graph, edge: str, away: float, speed: float) -> PlanStart:
    """A car with its bumper `away` m before the end of a road."""
    lane = graph.lanes[f"{edge}_1"]
    s = lane.spine.length - away
    x, y = lane.spine.at(s)
    return PlanStart(pose_of(x, y, lane.spine.heading_at(s), CAR), speed, 0.0, 0.0, lane.id, s, 0)


def observed(net, folder, content: str, steps: int = 2, away: float = 30.0):
    """Traffic that the ego sees from `away` m before the junction on its way from the west to the east."""
    graph, route = read_net(net).build(("wc", "ce")), ("wc", "ce")
    found = plan(graph, Route(route), CAR, start_of(graph, "wc", away, 8.0))
    with running(net, folder, content):
        simulated(steps)
        return EgoObserver("ego", Sensor(), CAR).observe(graph, found, CAR.front_to_rear_axle, 8.0, 0.0)


def test_an_ego_observes_all_vehicles_that_matter_but_itself(net, tmp_path):
    cars = "".join(
        vehicle(name, way, type="t", departPos=100) for name, way in (("a", "ec cw"), ("b", "nc cs"), ("ego", "wc ce"))
    )
    traffic = observed(net, tmp_path, TYPE + cars)
    assert {user.id for user in traffic.users} == {"a", "b"}
    assert traffic.time == pytest.approx(0.2)


def test_an_ego_observes_the_light_ahead(net, tmp_path):
    traffic = observed(net, tmp_path, "")
    assert set(traffic.lights) == {"c"} and len(traffic.lights["c"]) > 10


def test_the_future_of_a_light_is_known_for_as_long_as_asked_where_its_program_is_fixed(net, tmp_path):
    phases = ((5, "G"), (3, "y"), (7, "r"))
    with running(net, tmp_path, ""):
        lights = libsumo.trafficlight
        count, sensor = len(lights.getRedYellowGreenState("c")), Sensor()
        for number, (name, kind) in enumerate((("fixed", 0), ("actuated", 3))):
            made = [lights.Phase(float(lasts), letter * count, lasts, lasts) for lasts, letter in phases]
            lights.setProgramLogic("c", lights.Logic(name, kind, 0, made))
            simulated(1)
            now = sensor.look()
            began = lights.getNextSwitch("c") - 5.0
            known = [(time - began, letters) for time, letters in sensor.switches("c", 16.0 - (now - began))]
            assert known == ([] if number else [(5.0, "y" * count), (8.0, "r" * count), (15.0, "G" * count)])
            assert sensor.switches("c", 0.0) == ()


def test_when_a_yellow_ends_is_known_unless_it_is_set_from_outside(net, tmp_path):
    with running(net, tmp_path, ""):
        lights = libsumo.trafficlight
        count, sensor = len(lights.getRedYellowGreenState("c")), Sensor()
        made = [lights.Phase(lasts, letter * count, lasts, lasts) for lasts, letter in ((1.0, "y"), (9.0, "G"))]
        lights.setProgramLogic("c", lights.Logic("short", 0, 0, made))
        simulated(1)
        sensor.look()
        assert sensor.yellow_until({"c": "y" * count, "other": "G"}) == {"c": lights.getNextSwitch("c")}
        lights.setRedYellowGreenState("c", "y" * count)
        simulated(1)
        sensor.look()
        assert sensor.yellow_until({"c": "y" * count}) == {}


def test_an_ego_observes_who_walks_over_the_road_ahead_and_who_is_about_to(net, tmp_path):
    graph = read_net(net).build(("wc", "ce"))
    found = plan(graph, Route(("wc", "ce")), CAR, start_of(graph, "wc", 30.0, 8.0))
    seen: list[str] = []
    with running(net, tmp_path, WALK):
        libsumo.trafficlight.setRedYellowGreenState("c", "G" * len(libsumo.trafficlight.getRedYellowGreenState("c")))
        observer = EgoObserver("ego", Sensor(), CAR)
        for _ in range(200):
            simulated()
            traffic = observer.observe(graph, found, CAR.front_to_rear_axle, 8.0, 0.0)
            seen += [f"about:{user.id}" for user in traffic.beside]
            seen += [f"on:{user.id}" for user in traffic.users if user.body.is_person]
    assert [name for name, _ in groupby(seen)] == ["about:p", "on:p"]


def test_an_ego_looks_anew_once_it_has_come_on(net, tmp_path):
    """Far before the junction the light does not matter yet."""
    graph = read_net(net).build(("wc", "ce"))
    found = plan(graph, Route(("wc", "ce")), CAR, start_of(graph, "wc", 140.0, 3.0))
    with running(net, tmp_path, ""):
        simulated()
        observer = EgoObserver("ego", Sensor(), CAR)
        seen = [set(observer.observe(graph, found, front, 3.0, 0.0).lights) for front in (4.0, 120.0)]
    assert seen == [set(), {"c"}]
