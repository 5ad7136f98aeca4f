"""Where SUMO has to be told anew on which lane and before whom the ego is; SUMO's answers are scripted."""

from pathlib import Path

import libsumo
import pytest
from net_recipes import MINIMAL
from scripted_ego import scripted, state_at

from sumo_reactive.driver.nouns.completed_plan import Intent
from sumo_reactive.sumo.net_reader import read_net


def moved(vehicle):
    """The orders to be on a lane."""
    return [order[1:] for order in vehicle.told if order[0] == "moveTo"]


def beside(ego_s=30.0, other_s=20.0, ego_v=8.0, other_v=5.0, other_lane="w_0", ego_lane="w_0", **more):
    """What SUMO says of an ego of 4 m and another, whose `minGap` is 2.5 m and `tau` 0.5 s, led by who is behind it."""
    return {
        "getLeader": ("other", other_s - 4.0 - ego_s - 2.5), "getLaneID": {"ego": ego_lane, "other": other_lane},
        "getLanePosition": {"ego": ego_s, "other": other_s}, "getSpeed": {"ego": ego_v, "other": other_v},
        "getMinGap": {"ego": 2.5, "other": 2.5}, "getTau": {"ego": 1.0, "other": 0.5},
    } | more  # fmt: skip


SORTED_IN = [("ego", "e_2", 0.0), ("ego", "w_0", 30.0)]
"""Over the last lane of the next edge, and back to where it was."""


@pytest.mark.parametrize(
    ("said", "is_sorted"),
    [
        (beside(), True),
        (beside(getLeader=None), False),  # nobody is said to be ahead
        (beside(getLeader=("other", -3.9)), False),  # not passed, but near
        (beside(getLeader=("other", -4.0)), True),  # by its own length
        (beside(other_s=20.9), True),  # 30 − 4 − 20.9 − 2.5 = 2.6 m, more than 5 m/s · 0.5 s
        (beside(other_s=21.1), False),  # 2.4 m, and he would brake
        (beside(other_s=21.1, other_v=4.6), True),
        (beside(other_s=23.4, ego_v=4.0), True),  # he opens the gap by himself: 0.1 m will do
        (beside(other_s=23.6, ego_v=4.0), False),
        (beside(other_s=21.1, ego_v=5.0), False),  # as fast as he
        (beside(other_lane="w_1"), False),
        (beside(ego_lane=":j_0_0", other_lane=":j_0_0"), False),
        (beside(ego_lane="", other_lane=""), False),
    ],
)
def test_an_ego_that_has_passed_somebody_is_sorted_in_as_soon_as_he_need_not_brake(monkeypatch, said, is_sorted):
    ego, vehicle = scripted(monkeypatch)
    vehicle.answers |= said
    libsumo.lane.answers |= {"getLastStepVehicleIDs": {"w_0": ("ego", "other")}}
    ego.place(state_at(ego), Intent.DRIVE, 0.1, None)
    assert moved(vehicle) == (SORTED_IN if is_sorted else [])


@pytest.mark.parametrize(
    ("route", "index", "over"),
    [(("w", "e"), 0, "e_2"), (("e", "w"), 1, "e_2"), (("s", "w", "e"), 1, "e_2"), (("w",), 0, "")],
)
def test_an_ego_is_sorted_in_over_the_next_edge_of_its_route_or_else_the_one_before(monkeypatch, route, index, over):
    ego, vehicle = scripted(monkeypatch)
    vehicle.answers |= beside(getRoute=route, getRouteIndex=index)
    ego.place(state_at(ego), Intent.DRIVE, 0.1, None)
    assert moved(vehicle) == ([("ego", over, 0.0), ("ego", "w_0", 30.0)] if over else [])


@pytest.fixture
def lanes(tmp_path: Path):
    """The written network, whose road w has a second lane, w_1, to the left of w_0; both end at x = 96."""
    left = '<lane id="w_1" index="1" speed="13.9" length="50" shape="0,1.6 96,1.6"/></edge>'
    (tmp_path / "some.net.xml").write_text(MINIMAL.replace('</edge>\n  <edge id="e"', f'{left}\n  <edge id="e"', 1))
    return read_net(tmp_path / "some.net.xml")


BESIDE = {"getLaneID": "w_0", "getLanePosition": 49.0, "getRoute": ("s", "w", "e", "n"), "getRouteIndex": 1}
"""SUMO has the ego on the lane beside that by which C leaves."""


def led_to(lanes, monkeypatch, links="e_0", there=(), x=95.97, by="w_1", then=None, **more):
    """Where SUMO is told to have an ego whose front is to be at `x`, whose C leaves the road by lane `by`."""
    ego, vehicle = scripted(monkeypatch)
    vehicle.answers |= BESIDE | more
    libsumo.lane.answers |= {
        "getLinks": {by: ((links, True, True, True),)}, "getLastStepVehicleIDs": {by: there},
        "getLength": {"w_0": 50.0, "w_1": 48.5, by: 48.5},
    }  # fmt: skip
    ego.place(state_at(ego, x, 1.6), Intent.DRIVE, 0.1, lanes.lane(by))
    for lane in then or ():
        ego.place(state_at(ego, x, 1.6), Intent.DRIVE, 0.1, lane and lanes.lane(lane))
    return moved(vehicle)


MOVED = [("ego", "w_1", 48.5)]
"""At the end of the lane by which C leaves, for it has driven farther on the other."""


@pytest.mark.parametrize(
    ("how", "is_moved"),
    [
        ({}, True),
        ({"x": 95.96}, True),
        ({"x": 95.94}, False),  # its front is not yet at the end
        ({"x": 97.0}, True),
        ({"links": "n_0"}, False),  # from there the way does not lead on along the route
        ({"links": "s_0"}, False),
        ({"getRouteIndex": 2}, False),
        ({"getLaneID": "w_1"}, False),  # SUMO has it there
        ({"getLaneID": "s_0"}, False),  # SUMO has it on another road
        ({"getLaneID": ""}, False),
        ({"there": ("somebody",)}, False),
        ({"there": ("reactive.ghost.ego.1",)}, True),
        ({"there": ("reactive.ghost.ego.1", "somebody")}, False),
    ],
)
def test_an_ego_at_the_end_of_its_road_is_on_the_lane_that_it_leaves_by_where_nobody_is(monkeypatch, lanes, how, is_moved):
    assert led_to(lanes, monkeypatch, **how) == (MOVED if is_moved else [])


def test_who_has_driven_less_than_the_lane_is_long_stays_where_he_is_along_it(monkeypatch, lanes):
    assert led_to(lanes, monkeypatch, getLanePosition=48.0) == [("ego", "w_1", 48.0)]


@pytest.mark.parametrize("then", [None, ":j_0_0"])
def test_the_lane_that_c_leaves_by_stays_known_inside_the_junction_and_beside_every_lane(monkeypatch, lanes, then):
    assert led_to(lanes, monkeypatch, then=[then]) == MOVED * 2


def test_an_ego_that_has_not_been_on_any_lane_is_led_to_none(monkeypatch, lanes):
    assert led_to(lanes, monkeypatch, by=":j_0_0") == []


@pytest.mark.parametrize(
    ("said", "is_aside", "passing"),
    [
        (beside(getLeader=("other", 6.0)), True, "other"),
        (beside(getLeader=("other", 6.0)), False, ""),
        (beside(getLeader=("other", -2.4)), False, ""),  # as much as it keeps
        (beside(getLeader=("other", -2.6)), False, "other"),
        (beside(getLeader=("other", 6.0), other_lane="w_1"), True, ""),
        (beside(getLeader=None), True, ""),
        (beside(getLeader=("other", 6.0), ego_lane="", other_lane=""), True, ""),
        (beside(), True, ""),  # sorted in
        (beside(other_s=21.1), True, "other"),  # he would brake
    ],
)
def test_whom_the_ego_passes_is_known_until_sumo_has_it_before_him(monkeypatch, tmp_path, said, is_aside, passing):
    ego, vehicle = scripted(monkeypatch)
    vehicle.answers |= said
    libsumo.lane.answers |= {"getLastStepVehicleIDs": {"w_0": ("ego", "other")}}
    (tmp_path / "some.net.xml").write_text(MINIMAL)
    own = read_net(tmp_path / "some.net.xml").lane("w_0")
    ego.place(state_at(ego), Intent.DRIVE, 0.1, None if is_aside else own)
    assert ego.passing == passing
