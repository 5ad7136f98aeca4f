"""Which lane and route index SUMO gives to a pose, and what becomes of the route."""

from itertools import pairwise

import libsumo
import pytest
from contract_driving import EXACTLY, KEEP_ROUTE_EXACTLY, depart, drive, lane_path, path_length, place, take_over

LEFT_TURN = ["wc_1", ":c_13_0", ":c_15_0", "cn_0"]
CROSSING_ITSELF = ["w_c", "c_e", "e_ne", "ne_n", "n_c", "c_s"]


@pytest.mark.parametrize("turn", [-25.0, 0.0, 25.0])
def test_keep_route_3_keeps_the_route_and_maps_the_lane(simulate, priority_cross, turn):
    simulate(priority_cross, depart("wc cn"))
    take_over()
    seen: list[tuple[str, int]] = []

    def look():
        now = (libsumo.vehicle.getLaneID("ego"), libsumo.vehicle.getRouteIndex("ego"))
        seen.extend([now] if now not in seen[-1:] else [])
        assert libsumo.vehicle.getRoute("ego") == ("wc", "cn")

    drive(lane_path(LEFT_TURN), 150.0, 5.0, until=240.0, after_step=look, turn=turn)
    assert seen == [("wc_1", 0), (":c_13_0", 0), (":c_15_0", 0), ("cn_0", 1)]


@pytest.mark.parametrize("keep_route, route", [(EXACTLY, ("cw",)), (KEEP_ROUTE_EXACTLY, ("wc", "ce"))])
def test_keep_route_2_replaces_the_route_once_a_foreign_lane_is_nearer(simulate, priority_cross, keep_route, route):
    simulate(priority_cross, depart("wc ce"))
    take_over()
    place(100.0, 200.5, 0.0, keep_route=keep_route)
    assert libsumo.vehicle.getRoute("ego") == route
    assert libsumo.vehicle.getRoadID("ego") == route[0]


def test_the_nearest_lane_of_the_route_is_mapped(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce"))
    take_over()
    for y, lane, offset in ((193.6, "wc_0", -1.6), (196.7, "wc_0", 1.5), (196.9, "wc_1", -1.5), (200.4, "wc_1", 2.0)):
        place(100.0, y, 0.0)
        assert libsumo.vehicle.getLaneID("ego") == lane
        assert libsumo.vehicle.getLateralLanePosition("ego") == pytest.approx(offset)
        assert libsumo.vehicle.getLanePosition("ego") == pytest.approx(100.0)


def test_the_lane_is_empty_from_half_of_lane_plus_vehicle_width(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce"))
    take_over()
    reach = (3.2 + 1.8) / 2
    place(100.0, 198.4 + reach - 0.01, 0.0)
    assert libsumo.vehicle.getLaneID("ego") == "wc_1"
    place(100.0, 198.4 + reach + 0.01, 0.0)
    assert libsumo.vehicle.getLaneID("ego") == ""
    assert libsumo.vehicle.getRoute("ego") == ("wc", "ce")
    place(100.0, 198.4, 0.0)
    assert libsumo.vehicle.getLaneID("ego") == "wc_1"


def loop_lanes() -> list[str]:
    """The lanes of the self-crossing route, internal ones included."""

    def via(edge: str, to: str) -> str:
        return next(link[4] for link in libsumo.lane.getLinks(f"{edge}_0") if link[0] == f"{to}_0")

    before_the_last = [lane for edge, to in pairwise(CROSSING_ITSELF) for lane in (f"{edge}_0", via(edge, to))]
    return [*before_the_last, f"{CROSSING_ITSELF[-1]}_0"]


def mapped_edges_on_the_loop(windowed: bool) -> list[str]:
    """The lanes on which SUMO sees an ego that drives the loop, as edges; windowed: the route visits no junction twice."""
    take_over()
    lanes = loop_lanes()
    path = lane_path(lanes)
    seen: list[str] = []

    def set_window(first: int) -> None:
        edges = CROSSING_ITSELF[first : first + 4]
        libsumo.route.add(f"window{first}", edges)
        libsumo.vehicle.setRouteID("ego", f"window{first}")
        assert libsumo.vehicle.getRoute("ego") == tuple(edges)
        assert libsumo.vehicle.getRouteIndex("ego") == 0

    def look() -> None:
        edge = libsumo.vehicle.getRoadID("ego")
        if edge not in seen[-1:]:
            seen.append(edge)
            if windowed and not edge.startswith(":"):
                set_window(CROSSING_ITSELF.index(edge))

    drive(path, 20.0, 5.0, until=path_length(path) - 40.0, after_step=look)
    return seen


def test_a_route_that_crosses_itself_confuses_the_mapping(simulate, loop):
    simulate(loop, depart(" ".join(CROSSING_ITSELF), lane=0, speed=5))
    assert mapped_edges_on_the_loop(windowed=False) != [lane.rsplit("_", 1)[0] for lane in loop_lanes()]


def test_a_route_window_without_a_junction_twice_is_mapped_right(simulate, loop):
    simulate(loop, depart(" ".join(CROSSING_ITSELF), lane=0, speed=5))
    assert mapped_edges_on_the_loop(windowed=True) == [lane.rsplit("_", 1)[0] for lane in loop_lanes()]


def test_set_route_keeps_the_edges_already_passed(simulate, loop):
    simulate(loop, depart(" ".join(CROSSING_ITSELF), lane=0, speed=5))
    take_over()
    place(150.0, libsumo.lane.getShape("c_e_0")[0][1], 5.0)
    libsumo.vehicle.setRoute("ego", ["c_e", "e_ne"])
    assert libsumo.vehicle.getRoute("ego") == ("w_c", "c_e", "e_ne")
