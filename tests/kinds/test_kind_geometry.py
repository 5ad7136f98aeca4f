"""Kinds of geometry: short lanes, sharp turns, dead ends, bridges, loops, widths, the left-hand side."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from pathlib import Path

import pytest
from kinds import Net, car, cross, driven, edge, link, node, road, sort, stop, stream

SQUARE = "".join(node(name, x, y) for name, x, y in (("a", 0, 0), ("b", 60, 0), ("c", 60, 60), ("d", 0, 60)))


@pytest.mark.parametrize("short", [3, 1.5])
def test_lanes_shorter_than_the_car_are_driven(tmp_path, short):
    chain = road(80, *[short] * 10, 80)
    edges = " ".join("abcdefghijklmnopqrstuvwxyz"[i : i + 2] for i in range(12))
    run = driven(tmp_path, chain, car("ego", edges, 2), car("x", edges), car("y", edges, 4.5))
    assert run.complaints() == []


@pytest.mark.parametrize(
    ("turn", "side"), [(90, 1), (90, -1), (120, 1), (120, -1), (150, 1), (150, -1)]
)
def test_a_sharp_turn_is_driven(tmp_path, turn, side):
    angle = math.radians(turn) * side
    nodes = node("a", 0, 0) + node("b", 80, 0) + node("c", 80 + 80 * math.cos(angle), 80 * math.sin(angle))
    net = Net(nodes, "".join(edge(e) for e in ("ab", "bc", "cb", "ba")))
    run = driven(tmp_path, net, car("ego", "ab bc", 2), car("x", "ab bc"), car("on", "cb ba", 2.5))
    assert run.complaints() == []


def test_a_car_waits_for_those_into_whose_lane_it_must_swing_behind_a_turn_drawn_too_tight(tmp_path):
    nodes = node("a", -25, -120) + node("b", 0, 0) + node("c", 25, -120) + node("d", -25, 160)
    net = Net(nodes, "".join(edge(ends) for ends in ("ab", "bc", "cb", "bd")))
    oncoming = stream("on", "cb bd", [4.0 * k for k in range(8)])
    run = driven(tmp_path, net, car("ego", "ab bc", 2.1), oncoming, until=120)
    assert run.complaints(slower=2.5) == []  # nobody else looks where it swings: it waits for the last of them


def test_a_motorway_whose_lanes_move_aside_by_half_a_lane_is_driven_on_at_speed(tmp_path):
    nodes = "".join(node(name, x, 0) for name, x in (("a", 0), ("b", 500), ("c", 1000)))
    ways = "".join(edge(ends, speed=27.8, numLanes=lanes, spreadType="center") for ends, lanes in (("ab", 3), ("bc", 2)))
    net = Net(nodes, ways, link("ab bc", "10") + link("ab bc", "21"))
    run = driven(tmp_path, net, car("ego", "ab bc", 2, departLane=1), until=80)
    assert run.complaints(slower=1.1) == []
    assert min(moment.speed for moment in run.ego.moments) > 20.0


@pytest.mark.parametrize(("lanes", "step"), [(1, 0.1), (2, 0.1), (1, 0.25), (1, 0.5), (1, 1.0)])
def test_the_ego_turns_round_at_a_dead_end(tmp_path, lanes, step):
    net = Net(node("a", 0, 0) + node("b", 80, 0), edge("ab", numLanes=lanes) + edge("ba", numLanes=lanes), options=())
    vehicles = car("ego", "ab ba", 3, departLane="best"), car("x", "ab ba", departLane="best")
    run = driven(tmp_path, net, *vehicles, until=80, step=step)
    assert run.complaints(slower=2.2) == []  # the road is too narrow for one sweep
    assert all(moment.lane for moment in run.ego.moments)


@pytest.mark.parametrize("stub", [1, 4, 8])
def test_the_ego_turns_round_where_the_dead_end_is_a_stub_and_stays_on_the_road(tmp_path, stub):
    nodes = node("a", 0, 0) + node("b", 120, 0) + node("c", 120 + stub, 0)
    ways = "".join(edge(ends) for ends in ("ab", "bc", "cb", "ba"))
    net = Net(nodes, ways, options=())
    run = driven(tmp_path, net, car("ego", "ab bc cb ba", 2), car("x", "ab bc cb ba", 8), until=120)
    assert run.complaints(slower=2.5) == []
    assert all(moment.lane for moment in run.ego.moments)


@pytest.mark.parametrize("left_hand", [False, True])
def test_a_van_turns_round_at_a_dead_end_with_another_behind_it(tmp_path, left_hand):
    options = ("--lefthand",) if left_hand else ()
    net = Net(node("a", 0, 0) + node("b", 200, 0), edge("ab") + edge("ba"), options=options)
    van = sort("van", length=7)
    vehicles = car("ego", "ab ba", type="van"), car("x", "ab ba", 2), car("y", "ab ba", 4)
    run = driven(tmp_path, net, *vehicles, extra=van, until=120)
    assert run.complaints(slower=2.2) == []
    assert all(moment.lane for moment in run.ego.moments)


@pytest.mark.parametrize("depart", [2.0, 2.5, 4.0])
def test_who_drives_onto_the_lane_turned_into_is_let_pass_before_the_ego_turns_round(tmp_path, depart):
    nodes = node("a", 0, 0) + node("b", 80, 0) + node("c", 170, 0)
    ways = "".join(edge(ends) for ends in ("ab", "ba", "bc", "cb"))
    net = Net(nodes, ways, rules=link("ab ba") + link("ab bc") + link("cb ba"))
    others = stream("x", "cb ba", [depart, depart + 2, depart + 4])
    run = driven(tmp_path, net, car("ego", "ab ba", 2), others, until=120)
    assert run.complaints(slower=3.0) == []
    assert all(moment.lane for moment in run.ego.moments)


@pytest.mark.parametrize("beyond", [4, 8])
def test_a_lane_that_ends_beyond_the_start_of_the_next_one_is_left_where_that_begins(tmp_path, beyond):
    box = f"{100 + beyond},-2 {104 + beyond},-2 {104 + beyond},2 {100 + beyond},2"
    nodes = node("a", 0, 0) + node("b", 100, 0, shape=box) + node("c", 100, -100)
    net = Net(nodes, edge("ab", shape=f"0,0 {103 + beyond},0") + edge("bc", shape="100,-4 100,-100"))
    run = driven(tmp_path, net, car("ego", "ab bc", 2), car("x", "ab bc"), car("y", "ab bc", 5))
    assert run.complaints() == []
    assert max(moment.x for moment in run.ego.moments) < 102.5


@pytest.mark.parametrize("level", ["wbe", "snx"])
def test_a_bridge_is_no_crossing(tmp_path, level):
    nodes = node("w", -100, 0, z=6) + node("e", 100, 0, z=6) + node("s", 0, -100, z=0) + node("n", 0, 100, z=0)
    net = Net(nodes, edge("we") + edge("sn"))
    route, other = ("we", "sn") if level == "wbe" else ("sn", "we")
    run = driven(tmp_path, net, car("ego", route, 1), stream("x", other, [0, 1, 2]))
    assert run.complaints(slower=1.05) == []


@pytest.mark.parametrize("bend", [0, 25])
@pytest.mark.parametrize("width", [1.5, 1.75, 2.0])
def test_on_a_road_hardly_wider_than_two_cars_the_ego_keeps_to_its_side_and_meets_nobody(tmp_path, width, bend):
    nodes = node("a", -150, 0) + node("b", -60, 0) + node("c", 60, bend) + node("d", 150, bend)
    ways = "".join(map(edge, ("ab", "ba", "cd", "dc"))) + edge("bc", width=width) + edge("cb", width=width)
    others = stream("x", "dc cb ba", [0, 2, 4, 8, 12, 15])
    run = driven(tmp_path, Net(nodes, ways), car("ego", "ab bc cd", 1), others)
    assert run.complaints(slower=1.6) == []
    assert all(moment.lane for moment in run.ego.moments)


@pytest.mark.parametrize("bend", [0, 25])
@pytest.mark.parametrize("width", [1.5, 1.75, 2.0])
def test_where_a_side_road_joins_a_narrow_road_those_who_go_straight_on_pass_each_other(tmp_path, width, bend):
    places = {"a": (-150, 0), "b": (-60, 0), "f": (0, 0.5 * bend), "c": (60, bend), "d": (150, bend), "e": (0, -80)}
    ways = "".join(edge(ends, width=width) for ends in ("ab", "ba", "bf", "fb", "fc", "cf", "cd", "dc", "ef", "fe"))
    net = Net("".join(node(name, *place) for name, place in places.items()), ways)
    run = driven(tmp_path, net, car("ego", "ab bf fc cd", 1), stream("x", "dc cf fb ba", [0, 2, 4, 8, 12, 15]))
    assert run.complaints(slower=1.05) == []


@pytest.mark.parametrize("first", [8, 9, 10])
def test_on_a_bridge_without_a_height_nobody_is_braked_for_though_his_road_joins_farther_on(tmp_path, first):
    places = {"w": (-250, 0), "m": (0, 0), "e": (40, 0), "f": (120, 0), "n": (-20, 80)}
    ramp = edge("ne", shape="-20,80 -20,-40 0,-60 30,-60 38,-40 40,0", priority=1)
    main = "".join(edge(ends, priority=9) for ends in ("wm", "me", "ef"))
    net = Net("".join(node(name, *place) for name, place in places.items()), main + ramp)
    run = driven(tmp_path, net, car("ego", "wm me ef"), stream("x", "ne ef", [first, first + 1, first + 2]))
    assert run.ego.slowest("wm") > 13.5
    assert run.ego.duration < 1.02 * run.own.duration


@pytest.mark.parametrize(("aside", "kink"), [(3, -30), (3, 0), (5, 0)])
def test_where_the_route_crosses_itself_on_a_bridge_sumo_has_the_ego_on_the_road_that_it_is_on(tmp_path, aside, kink):
    """Where two roads join below the bridge, beside the middle of its lane, its front is nearer to that of a lane above."""
    places = {"a": (-150, 0), "m": (0, 0), "b": (100, kink), "c": (100, 80), "d": (aside, 80), "e": (aside, -120)}
    ways = edge("am", spreadType="center") + "".join(map(edge, ("mb", "bc", "cd"))) + edge("de", numLanes=2)
    net = Net("".join(node(name, *place) for name, place in places.items()), ways)
    run = driven(tmp_path, net, car("ego", "am mb bc cd de"))
    lanes = [moment.lane for moment in run.ego.moments]
    assert run.complaints() == []
    assert not any(lane.startswith("de") for lane in lanes[: lanes.index("bc_0")])


def test_a_route_that_leads_round_the_block_twice_is_driven(tmp_path):
    net = Net(SQUARE + node("z", -60, 0), "".join(edge(e) for e in ("ab", "bc", "cd", "da", "za", "az")))
    block = "ab bc cd da"
    run = driven(tmp_path, net, car("ego", f"za {block} {block} az"), car("x", f"za {block} {block} {block}", 4), until=120)
    assert run.complaints() == []


def test_lanes_become_narrower_and_wider(tmp_path):
    widths = {"ab": 3.2, "bc": 2.3, "cd": 4.5, "de": 2.6}
    nodes = "".join(node(name, 60 * i, 0) for i, name in enumerate("abcde"))
    ways = "".join(edge(e, width=w) + edge(e[::-1], width=w) for e, w in widths.items())
    run = driven(tmp_path, Net(nodes, ways), car("ego", "ab bc cd de", 1), stream("on", "ed dc cb ba", [0, 2, 4]))
    assert run.complaints() == []


@pytest.mark.parametrize("kind", ["priority", "traffic_light"])
@pytest.mark.parametrize("turn", ["cs", "ce", "cn"])
def test_on_the_left_hand_side_a_right_turn_crosses_the_oncoming_stream(tmp_path, kind, turn):
    green = 40 if kind == "traffic_light" else 0
    oncoming = stream("on", "ec cw", [green + t for t in (0, 1.5, 3, 4.5, 9, 15)])
    run = driven(tmp_path, cross(kind, options=("--lefthand",)), car("ego", f"wc {turn}", green), oncoming, until=100)
    assert run.complaints() == []


@pytest.mark.parametrize("speed", [14, 20, 22])
@pytest.mark.parametrize("side", [1, -1])
def test_an_ego_that_enters_too_fast_for_the_bend_it_stands_at_stays_on_the_road(tmp_path, speed, side):
    """SUMO's own driver takes a bend by 0.2 rad at any speed; the ego is taken over at its beginning, and would be carried
    2.4 m off its lane's centre at 22 m/s with planned braking."""
    nodes = node("a", 0, 0) + node("b", 200, 0) + node("c", 200 + 300 * math.cos(0.2), side * 300 * math.sin(0.2))
    net = Net(nodes, edge("ab", speed=speed) + edge("bc", speed=speed), options=("--offset.disable-normalization",))
    run = driven(tmp_path, net, car("ego", "ab bc", departPos="last"))
    assert run.complaints() == []
    aside = [(m.y * math.cos(0.2) - side * (m.x - 200) * math.sin(0.2)) + 1.6 for m in run.ego.moments]
    assert max(map(abs, aside)) < 1.6, "the middle of its front leaves its lane"


@pytest.mark.parametrize(("from_x", "reach"), [(0, 0.8), (6, 1.0)])
def test_who_waits_at_a_line_that_reaches_into_the_road_is_passed(tmp_path, from_x, reach):
    shape = f"-8,{-reach} 8,{-reach} 8,{reach} -8,{reach}"
    nodes = node("a", -120, 0) + node("b", 120, 0) + node("s", from_x, -80) + node("c", 0, 0, type="priority", shape=shape)
    ways = "".join(edge(ends, priority=5 - 4 * (ends == "sc"), spreadType="center") for ends in ("ac", "cb", "sc"))
    others = stream("m", "ac cb", [2.0 * k for k in range(7)])
    run = driven(tmp_path, Net(nodes, ways), car("ego", "ac cb", 14), car("x", "sc cb", 3), others)
    assert run.complaints(slower=1.2) == []


class _Folded(Net):
    """A network whose edge "ab" is drawn forth, back and forth again between 160 and 100 m, which netconvert would mend."""

    def built(self, folder: Path) -> Path:
        path = super().built(folder)
        lane = re.compile(r'(id="ab_.*?length=").*?(" shape="\S+?),(\S+) ')
        path.write_text(lane.sub(_folded, path.read_text()))
        return path


def _folded(lane: re.Match[str]) -> str:
    start, shape, y = lane.groups()
    return f"{start}420{shape},{y} 160,{float(y) + 0.3} 100,{float(y) + 0.6} 110,{y} "


@pytest.mark.parametrize("lanes", [1, 2])
def test_a_lane_drawn_forth_and_back_over_itself_is_driven_straight_through(tmp_path, lanes):
    edges = edge("ab", numLanes=lanes) + edge("bc", numLanes=lanes)
    net = _Folded(node("a", 0, 0) + node("b", 300, 0) + node("c", 400, 0), edges)
    run = driven(tmp_path, net, car("ego", "ab bc", 2), car("y", "ab bc", 5))
    assert run.complaints(slower=1.0) == []
    assert all(moment.lane for moment in run.ego.moments)


@pytest.mark.parametrize("at", [55.0, 75.0])
def test_who_stands_between_two_places_where_his_way_crosses_is_in_none(tmp_path, at):
    nodes = node("a", -200, 0) + node("b", 200, 0) + node("s", -30, -150) + node("t", 150, -150) + node("c", 0, 0)
    through = edge("ac", shape="-200,0 -60,0", priority=5) + edge("cb", shape="60,0 200,0", priority=5)
    around = edge("sc", shape="-30,-150 -30,-30", priority=1) + edge("ct", shape="30,-30 150,-150", priority=1)
    loop = link("sc ct", shape="-28.4,-30 -28.4,20 -10,40 10,40 28.4,20 28.4,-30")
    halted = car("x", "sc ct", stops=stop(":c_0_0", at, until=80))
    net = Net(nodes, through + around, link("ac cb") + loop)
    assert driven(tmp_path, net, car("ego", "ac cb", 15), halted, until=140).complaints(slower=1.2) == []


@pytest.mark.parametrize("raised", [0.0, 0.6])
def test_on_a_ramp_that_winds_over_itself_sumo_has_the_ego_on_its_own_loop(tmp_path, raised):
    """Others on the loop above it do not brake for it."""
    nodes = node("a", -40, 0) + node("b", 0, 20) + node("c", 0, 40)
    below, above = (f"60,{y} 60,{60 + y} 0,{60 + y}" for y in (0.0, raised))
    edges = edge("ab", shape=f"-40,0 {below} 0,20") + edge("bc", shape=f"0,20 0,{raised} {above} 0,40")
    run = driven(tmp_path, Net(nodes, edges), car("ego", "ab bc", 2), car("x", "ab bc"))
    lanes = [moment.lane for moment in run.ego.moments if not moment.lane.startswith(":")]
    assert [after for before, after in pairwise(["", *lanes]) if after != before] == ["ab_0", "bc_0"]
