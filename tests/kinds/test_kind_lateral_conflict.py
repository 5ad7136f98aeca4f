"""Kinds of narrow places: neighbour lanes of one road whose ways through a junction come nearer than bodies are wide."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import pytest
from kinds import Net, car, driven, edge, link, node, sort

from sumo_reactive.driver.view.attention import watches_of
from sumo_reactive.sumo.net_reader import read_net

STEADY = sort("steady", lcKeepRight=0, lcSpeedGain=0, lcCooperative=0)


def narrow(apart: float) -> Net:
    """Return a road of two lanes that come within `apart` m of each other for 10 m inside a long junction."""
    nodes = node("a", 0, 0) + node("b", 150, 0, radius=25) + node("c", 300, 0)
    ways = edge("ab", numLanes=2, shape="0,0 125,0") + edge("bc", numLanes=2, shape="175,0 300,0")
    y = round(apart - 4.8, 2)
    outer = link("ab bc", "00", shape="125,-4.8 150,-4.8 175,-4.8")
    inner = link("ab bc", "11", shape=f"125,-1.6 145,{y} 155,{y} 175,-1.6")
    return Net(nodes, ways, outer + inner)


def abreast(lane: int, ahead: float, departs: tuple[float, ...] = (0.0,)) -> str:
    """Return cars on `lane` that enter `ahead` m before the ego's front if they enter at the same time as it does."""
    said = {"type": "steady", "departLane": lane, "departPos": 30 + ahead, "arrivalLane": lane}
    return STEADY + "".join(car(f"x{i}", "ab bc", depart, **said) for i, depart in enumerate(departs))


def ego(lane: int) -> str:
    """Return the ego on `lane`."""
    return car("ego", "ab bc", departLane=lane, departPos=30, arrivalLane=lane)


@pytest.mark.parametrize("lane", [0, 1])
@pytest.mark.parametrize("ahead", [-3, 0, 3])
def test_where_the_lane_has_room_the_ego_keeps_off_who_drives_abreast(tmp_path, lane, ahead):
    run = driven(tmp_path, narrow(1.5), ego(lane), abreast(1 - lane, ahead))
    assert run.complaints(slower=1.02) == []
    assert run.ego.slowest(":b", "ab") > 13.0


@pytest.mark.parametrize("lane", [0, 1])
@pytest.mark.parametrize("ahead", [-3, 0, 3])
@pytest.mark.parametrize("apart", [0.6, 0.0])
def test_where_it_has_none_the_ego_falls_behind_who_drives_abreast(tmp_path, apart, lane, ahead):
    run = driven(tmp_path, narrow(apart), ego(lane), abreast(1 - lane, ahead))
    assert run.complaints(slower=1.1) == []


@pytest.mark.parametrize("lane", [0, 1])
def test_the_ego_finds_its_place_between_those_of_the_other_lane(tmp_path, lane):
    run = driven(tmp_path, narrow(0.6), ego(lane), abreast(1 - lane, 0, (0.0, 2.2, 4.4, 6.6)))
    assert run.complaints(slower=1.2) == []


@pytest.mark.parametrize("lane", [0, 1])
@pytest.mark.parametrize("ahead", [-20, 30])
def test_who_is_not_abreast_slows_nobody(tmp_path, lane, ahead):
    run = driven(tmp_path, narrow(0.6), ego(lane), abreast(1 - lane, ahead))
    assert run.complaints(slower=1.02) == []
    assert run.ego.slowest(":b", "ab") > 13.0


@pytest.mark.parametrize(("turn", "inside"), [(1, 1), (-1, 0)])
@pytest.mark.parametrize("ahead", [-6, 0, 6])
def test_a_bus_that_turns_outside_of_the_ego_is_let_cut_the_corner(tmp_path, turn, inside, ahead):
    nodes = node("a", -150, 0) + node("b", 0, 0, radius=8) + node("c", 0, 150 * turn)
    ways = edge("ab", numLanes=2, speed=10) + edge("bc", numLanes=2, speed=10)
    net = Net(nodes, ways, link("ab bc", "00") + link("ab bc", "11"))
    long = sort("long", vClass="bus", length=12, width=2.5, lcKeepRight=0, lcSpeedGain=0, lcCooperative=0)
    said = [{"departLane": lane, "arrivalLane": lane, "departSpeed": 8} for lane in (1 - inside, inside)]
    bus = car("x", "ab bc", type="long", departPos=40 + ahead, **said[0])
    run = driven(tmp_path, net, bus, car("ego", "ab bc", departPos=40, **said[1]), extra=long)
    assert run.complaints(slower=1.3) == []


def drawn_across() -> Net:
    """Return a road of two lanes; the way to the right from its outer lane swings over the straight one from the other."""
    nodes = node("a", 0, 0) + node("b", 150, -10, radius=25) + node("c", 300, 0) + node("d", 165, -180)
    ways = edge("ab", numLanes=2, shape="0,0 125,0") + edge("bc", shape="180,0 300,0") + edge("bd", shape="168,-30 165,-180")
    turn = link("ab bd", "00", shape="125,-4.8 150,1.5 162,-1 167,-12 166.4,-30")
    return Net(nodes, ways, turn + link("ab bc", "10", shape="125,-1.6 180,-1.6"))


@dataclass(frozen=True)
class TurnedBack(Net):
    """A network whose way `edge` of some `length` (m) turns back as netconvert does not draw it, but maps of wide junctions
    have it."""

    edge: str = ""
    shape: str = ""
    length: float = 0.0

    def built(self, folder: Path) -> Path:
        """Return the network with that way."""
        path = super().built(folder)
        tree = ET.parse(path)
        (way,) = tree.iterfind(f"edge[@id='{self.edge}']/lane")
        way.set("shape", self.shape)
        way.set("length", str(self.length))
        tree.write(path)
        return path


def turning_back() -> Net:
    """Return a road of three lanes; the turn from the innermost one leads back over the others before their line."""
    nodes = node("a", 0, 0) + node("b", 130, 0, radius=1) + node("c", 300, 0)
    ways = edge("ab", numLanes=3, shape="0,0 125,0") + edge("bc", numLanes=2, shape="132,0 300,0")
    back = edge("ba", shape="125,-14 0,-14")
    links = link("ab ba", "20") + link("ab bc", "00") + link("ab bc", "11")
    return TurnedBack(nodes, ways + back, links, edge=":b_2", shape="125,12.4 117,9.4 114,6.5 117,3 125,1.6", length=23.35)


CASES = [
    (drawn_across, "bd", 0, "bc", 1),
    (drawn_across, "bc", 1, "bd", 0),
    (turning_back, "bc", 0, "ba", 2),
    (turning_back, "bc", 1, "ba", 2),
]


@pytest.mark.parametrize(("net", "way", "lane", "other", "beside"), CASES)
@pytest.mark.parametrize("ahead", [-25, -6, 0, 6, 15, 25])
def test_where_a_turn_is_drawn_across_the_lane_beside_one_at_a_time_is_there(tmp_path, net, way, lane, other, beside, ahead):
    said = {"type": "steady", "departPos": 30 + ahead, "departSpeed": 10, "departLane": beside}
    ego = car("ego", f"ab {way}", departPos=30, departSpeed=10, departLane=lane)
    run = driven(tmp_path, net(), ego, STEADY + car("x", f"ab {other}", **said))
    assert run.complaints(slower=1.5) == []


def test_where_ways_from_one_lane_cross_behind_where_they_part_who_is_in_the_junction_counts(tmp_path):
    """A turn to the left is crossed by the way around: until then one leads, the other follows."""
    nodes = node("a", 0, 0) + node("b", 150, 0, radius=25) + node("c", 150, 150)
    ways = edge("ab", shape="0,0 125,0") + edge("ba", shape="125,0 0,0") + edge("bc", shape="150,25 150,150")
    links = link("ab bc", shape="125,-1.6 138,0 148,8 151.6,25") + link("ab ba")
    around = "125,-1.6 135,-8 148,-6 150,6 140,10 125,1.6"
    net = TurnedBack(nodes, ways, links, edge=":b_1", shape=around, length=65.8)
    watched = watches_of(read_net(net.built(tmp_path)).build(("ab", "bc")), "ab_0->bc_0")
    assert {":b_1_0", "ba_0"} <= watched.keys()
    assert "ab_0" not in watched
