"""What is seen of a vehicle that SUMO itself drives."""

import libsumo
import pytest
from net_recipes import CROSS_NODES, converted, cross_edges
from simulations import running, simulated, vehicle

from sumo_reactive.sumo.observed_vehicle import Bystanders, ObservedVehicle
from sumo_reactive.sumo.vehicle_type import heading_of

TYPE = '<vType id="t" length="4.4" width="1.7" sigma="0" speedDev="0"/>'


@pytest.fixture(scope="module")
def net(tmp_path_factory):
    kind = CROSS_NODES.format(kind="traffic_light")
    return converted(tmp_path_factory.mktemp("net"), kind, cross_edges(), "--no-turnarounds")


def test_the_vehicle_and_those_within_reach_are_seen_where_sumo_has_them(net, tmp_path):
    places = (("ego", "wc ce", 100), ("near", "ec cw", 100), ("far", "nc cs", 0))
    cars = "".join(vehicle(name, way, type="t", departPos=at, departSpeed=5) for name, way, at in places)
    with running(net, tmp_path, TYPE + cars):
        simulated()
        observed = ObservedVehicle("ego", 110.0)
        simulated()
        view = observed.look()
        assert view is not None and [one.id for one in view.others] == ["near"]
        for one in (view.own, *view.others):
            assert (one.x, one.y) == libsumo.vehicle.getPosition(one.id)
            assert one.speed == libsumo.vehicle.getSpeed(one.id)
            assert one.heading == heading_of(libsumo.vehicle.getAngle(one.id))
            assert (one.lane_id, one.lane_position) == (
                libsumo.vehicle.getLaneID(one.id), libsumo.vehicle.getLanePosition(one.id),
            )  # fmt: skip
            assert (one.body.length, one.body.width, one.body.is_person) == (4.4, 1.7, False)
        assert (view.own.route, view.others[0].route) == (("wc", "ce"), ("ec", "cw"))


def test_a_trip_is_seen_to_its_end_with_the_way_that_is_left_and_the_line_that_is_crossed(net, tmp_path):
    with running(net, tmp_path, TYPE + vehicle("ego", "wc ce", type="t", departPos=100, departSpeed=10)):
        libsumo.trafficlight.setRedYellowGreenState("c", "G" * len(libsumo.trafficlight.getRedYellowGreenState("c")))
        simulated()
        observed, ways, crossed = ObservedVehicle("ego", 80.0), [], []
        for _ in range(600):
            simulated()
            view = observed.look()
            if view is None:
                break
            place = view.own.lane_id[:2]
            ways += [(place, view.own.route)] if not ways or ways[-1][0] != place else []
            crossed += [view.crossed] if view.crossed else []
        assert ways == [("wc", ("wc", "ce")), (":c", ("ce",)), ("ce", ("ce",))]
        assert crossed == ["GG"]
        assert observed.arrived and observed.teleports == 0
        assert observed.look() is None


WALKS = ("--sidewalks.guess", "--sidewalks.guess.max-speed", "15", "--crossings.guess")


@pytest.mark.parametrize("reach", [60.0, 20.0])
def test_who_walks_over_a_crossing_near_is_seen_there_and_nowhere_else(tmp_path, reach):
    kind = CROSS_NODES.format(kind="traffic_light")
    net = converted(tmp_path, kind, cross_edges(), "--no-turnarounds", *WALKS)
    walk = '<person id="p" depart="0" departPos="145"><walk edges="wc nc" speed="1.5"/></person>'
    with running(net, tmp_path, TYPE + walk + vehicle("ego", "wc ce", type="t", departPos=100)):
        libsumo.trafficlight.setRedYellowGreenState("c", "G" * len(libsumo.trafficlight.getRedYellowGreenState("c")))
        simulated()
        libsumo.vehicle.setSpeed("ego", 0.0)
        observed, lanes = ObservedVehicle("ego", reach), set()
        for _ in range(150):
            simulated()
            view = observed.look()
            assert view is not None
            for one in view.others:
                assert (one.id, one.body.is_person) == ("p", True)
                assert (one.x, one.y, one.speed) == (*libsumo.person.getPosition("p"), libsumo.person.getSpeed("p"))
                assert (one.body.length, one.body.width) == (libsumo.person.getLength("p"), libsumo.person.getWidth("p"))
                assert one.lane_position == libsumo.person.getLanePosition("p")
                assert one.heading == heading_of(libsumo.person.getAngle("p"))
                lanes.add(one.lane_id)
    assert lanes == ({":c_c3_0"} if reach == 60.0 else set())


def test_who_is_on_a_bridge_above_is_not_near(tmp_path):
    nodes = "".join(
        f'<node id="{name}" x="{x}" y="{y}" z="{z}"/>'
        for name, x, y, z in (("w", -100, 0, 0), ("e", 100, 0, 0), ("s", 0, -100, 8), ("n", 0, 100, 8))
    )
    edges = '<edges><edge id="we" from="w" to="e"/><edge id="sn" from="s" to="n"/></edges>'
    net = converted(tmp_path, f"<nodes>{nodes}</nodes>", edges)
    places = (("ego", "we", 100), ("above", "sn", 100), ("behind", "we", 80), ("reactive.ghost.x", "we", 60))
    places = (*places, ("far", "we", 5))
    slow = TYPE.replace("sigma", 'maxSpeed="0.2" sigma')
    cars = "".join(vehicle(name, way, type="t", departPos=at) for name, way, at in places)
    with running(net, tmp_path, slow + cars):
        simulated(5)
        assert len(libsumo.vehicle.getIDList()) == 5
        observed, bystanders = ObservedVehicle("ego", 70.0), Bystanders("behind")
        simulated()
        view = observed.look()
        assert view is not None
        assert {one.id for one in view.others} == {"behind", "reactive.ghost.x"}
        assert {one.id for one in bystanders.look()} == {"ego"}
        (one,) = bystanders.look()
        assert (one.x, one.y, one.speed) == (*libsumo.vehicle.getPosition("ego"), libsumo.vehicle.getSpeed("ego"))
        assert (one.body.length, one.body.width) == (4.4, 1.7)
        bystanders.leave()
        libsumo.vehicle.remove("behind")
        simulated()
        assert "behind" not in libsumo.vehicle.getIDList()


def test_roads_that_cross_without_a_junction_are_on_different_levels_in_a_flat_network_too(tmp_path):
    places = (("w", -100, 0), ("e", 100, 0), ("s", 0, -100), ("n", 0, 100), ("f", 150, 0))
    nodes = "".join(f'<node id="{name}" x="{x}" y="{y}"/>' for name, x, y in places)
    edges = "".join(f'<edge id="{way}" from="{way[0]}" to="{way[1]}"/>' for way in ("we", "sn", "ef"))
    net = converted(tmp_path, f"<nodes>{nodes}</nodes>", f"<edges>{edges}</edges>")
    slow = TYPE.replace("sigma", 'maxSpeed="0.2" sigma')
    seats = (("ego", "we", 100), ("above", "sn", 100), ("behind", "we", 80), ("ahead", "ef", 10))
    cars = "".join(vehicle(name, way, type="t", departPos=at) for name, way, at in seats)
    with running(net, tmp_path, slow + cars):
        simulated(5)
        bystanders = Bystanders("ego")
        simulated()
        assert libsumo.vehicle.getPosition("above")[1] < 10.0
        assert {one.id for one in bystanders.look()} == {"behind"}  # who is ahead is farther away
