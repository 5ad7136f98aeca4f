"""What is seen of a vehicle that SUMO itself drives."""

import libsumo
import pytest
from net_recipes import CROSS_NODES, converted, cross_edges
from simulations import running, simulated, vehicle

from sumo_reactive.sumo.spectator import Spectator
from sumo_reactive.sumo.units import heading_of

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
        spectator = Spectator("ego", 110.0)
        simulated()
        view = spectator.look()
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
        spectator, ways, crossed = Spectator("ego", 80.0), [], []
        for _ in range(600):
            simulated()
            view = spectator.look()
            if view is None:
                break
            place = view.own.lane_id[:2]
            ways += [(place, view.own.route)] if not ways or ways[-1][0] != place else []
            crossed += [view.crossed] if view.crossed else []
        assert ways == [("wc", ("wc", "ce")), (":c", ("ce",)), ("ce", ("ce",))]
        assert crossed == ["GG"]
        assert spectator.arrived and spectator.teleports == 0
        assert spectator.look() is None


def test_who_walks_near_is_seen_and_who_walks_far_is_not(net, tmp_path):
    walks = "".join(
        f'<person id="{name}" depart="0" departPos="{at}"><walk edges="wc" arrivalPos="{at + 5}" speed="0.5"/></person>'
        for name, at in (("near", 100), ("far", 5))
    )
    with running(net, tmp_path, TYPE + walks + vehicle("ego", "wc ce", type="t", departPos=100)):
        simulated()
        spectator = Spectator("ego", 50.0)
        simulated()
        view = spectator.look()
        assert view is not None
        (one,) = view.others
        assert (one.id, one.body.is_person) == ("near", True)
        assert (one.x, one.y, one.speed) == (*libsumo.person.getPosition("near"), libsumo.person.getSpeed("near"))
        assert (one.body.length, one.body.width) == (libsumo.person.getLength("near"), libsumo.person.getWidth("near"))
        assert (one.lane_id, one.lane_position) == ("wc_0", libsumo.person.getLanePosition("near"))
        assert one.heading == heading_of(libsumo.person.getAngle("near"))
