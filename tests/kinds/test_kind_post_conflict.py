"""Kinds of post-conflict regions: no room behind a junction, or too little, and whoever waits does so before it."""

from __future__ import annotations

import pytest
from kinds import Net, car, cross, driven, edge, link, node, program, standing, stream

CENTRE = 90.0
SIDE = stream("n", "nc cs", [9, 12, 15, 18, 21, 24])


def three_in_a_row() -> str:
    """Two cars before the ego and the ego, all on their way east."""
    return "".join(car(name, "wc ce", 1.5 * k, departSpeed=8) for k, name in enumerate(("a", "b", "ego")))


@pytest.mark.parametrize("keeps", ["true", "false"])
@pytest.mark.parametrize("place", [19.0, 21.0, 24.0])
def test_room_that_those_ahead_will_fill_is_no_room(tmp_path, place, keeps):
    net = _keeping(keeps)
    run = driven(tmp_path, net, standing("jam", "ce", "ce_0", place, 30.0), three_in_a_row(), SIDE, until=90)
    assert run.complaints() == []
    assert run.ego.stands_in(CENTRE - 3.2, CENTRE + 3.2) == []


def _keeping(keeps: str) -> Net:
    """Return a crossing on whose main road the map says whether it is to be kept clear."""
    plain = cross()
    return Net(plain.nodes, plain.edges, link("wc ce", keepClear=keeps), plain.options)


def test_behind_a_junction_that_need_not_be_kept_clear_nobody_waits_for_ever(tmp_path):
    jam = standing("jam", "ce", "ce_0", 9.0, 60.0)
    run = driven(tmp_path, _keeping("false"), jam, car("ego", "wc ce", 1), until=120)
    assert run.complaints() == []


def _lanes_that_part() -> Net:
    """A road across a side road, and short behind that two lanes that part: the left one on, the right one south."""
    nodes = node("w", -120, 0) + node("c", 0, 0) + node("d", 30, 0) + node("e", 120, 0) + node("t", 30, -90)
    nodes += node("n", 0, 90) + node("s", 0, -90)
    edges = edge("wc", priority=5) + edge("cd", numLanes=2, priority=5) + edge("de", priority=5) + edge("dt", priority=5)
    rules = link("wc cd", "00") + link("cd de", "10") + link("cd dt", "00") + link("nc cs")
    return Net(nodes, edges + edge("nc", priority=1) + edge("cs", priority=1), rules)


@pytest.mark.parametrize("waiting", [1, 2])
def test_a_gap_on_the_lane_beside_is_not_waited_for_inside_the_junction(tmp_path, waiting):
    jam = standing("jam", "de", "de_0", 5.0, 30.0)
    queue = "".join(car(f"b{k}", "cd de", departLane=1, departPos=20.5 - 7.2 * k, departSpeed=0) for k in range(waiting))
    side = stream("n", "nc cs", [8, 12, 16, 20, 24, 28, 32])
    run = driven(tmp_path, _lanes_that_part(), jam, queue, side, car("ego", "wc cd de", 2.0), until=120)
    assert run.complaints() == []
    assert run.ego.stands_in(120 - 3.2, 120 + 3.2) == []


def _two_carriageways() -> Net:
    """A minor road across two one-way carriageways with no room between them."""
    nodes = node("w", -90, 0) + node("c", 0, 0) + node("d", 10, 0) + node("e", 100, 0)
    nodes += node("n", 0, 90) + node("s", 0, -90) + node("u", 10, -90) + node("o", 10, 90)
    minor = edge("wc", priority=1) + edge("cd", priority=1) + edge("de", priority=1)
    return Net(nodes, minor + "".join(edge(ends, priority=9) for ends in ("nc", "cs", "ud", "do")))


@pytest.mark.parametrize("first", [7.0, 8.0, 9.0])
def test_carriageways_with_no_room_between_are_crossed_in_one_go(tmp_path, first):
    near = stream("n", "nc cs", [first + 9.0 * k for k in range(4)])
    far = stream("u", "ud do", [2.2 * k for k in range(12)])
    run = driven(tmp_path, _two_carriageways(), near, far, car("ego", "wc cd de", 1), until=120)
    assert run.complaints() == []
    assert run.ego.stands_in(90 - 3.0, 90 + 3.0) == []


@pytest.mark.parametrize("kind", ["priority_stop", "allway_stop"])
def test_a_second_full_stop_with_no_room_before_it_is_made_behind_the_first(tmp_path, kind):
    plain = _two_carriageways()
    nodes = plain.nodes.replace('id="c"', f'id="c" type="{kind}"').replace('id="d"', f'id="d" type="{kind}"')
    assert nodes.count(kind) == 2
    near, far = stream("n", "nc cs", [4, 20, 44]), stream("u", "ud do", [6, 24, 48])
    run = driven(tmp_path, Net(nodes, plain.edges), near, far, car("ego", "wc cd de", 1), until=120)
    assert run.complaints() == []
    assert max(run.ego.slowest(lane) for lane in ("wc", "cd")) < 0.1


def _line_in_the_way(kind: str = "priority", line: float = -1.6) -> Net:
    """A crossing whose southern arm is drawn up to `line` (m north), so that who waits there stands on the main road."""
    plain = cross(kind)
    shape = f"-5.0,-3.4 -5.0,5.0 5.0,5.0 5.0,{line} -1.0,{line}"
    return Net(plain.nodes.replace('id="c"', f'id="c" shape="{shape}"'), plain.edges, "", plain.options)


def test_who_waits_with_its_nose_in_the_way_goes_first_since_else_both_would_wait(tmp_path):
    before = stream("e", "wc ce", [0, 1.8])
    run = driven(tmp_path, _line_in_the_way(), before, car("x", "sc cn", 1.0), car("ego", "wc ce", 4.5), until=120)
    assert run.complaints(slower=1.6) == []


@pytest.mark.parametrize("late", [0.0, 0.5, 1.0, 2.5])
def test_a_red_light_keeps_nobody_off_the_main_road_whose_line_is_drawn_on_it(tmp_path, late):
    side, main = "GGGrrrGGGrrr", "rrrGGgrrrGGg"
    light = program("c", (12, main), (3, "rrryyyrrryyy"), (20, side), (3, "yyyrrryyyrrr"))
    cars = car("x", "sc cn", 2.0 + late), car("ego", "wc ce", 3.0)
    run = driven(tmp_path, _line_in_the_way("traffic_light", 0.5), *cars, extra=light, until=150)
    assert run.complaints(slower=4.0) == []


ALTERNATELY = (("c", "rrGG", "GGrr"), ("d", "GGrr", "rrGG"))
"""While the minor road goes on one carriageway it stops on the other."""


def test_two_lights_that_never_let_through_at_once_are_passed_one_after_the_other(tmp_path):
    plain = _two_carriageways()
    lights = plain.nodes.replace('id="c"', 'id="c" type="traffic_light"').replace('id="d"', 'id="d" type="traffic_light"')
    net = Net(lights, plain.edges, "", plain.options)
    first, second = (program(name, (20, go), (3, "yyyy"), (20, stop), (3, "yyyy")) for name, go, stop in ALTERNATELY)
    run = driven(tmp_path, net, car("ego", "wc cd de", 1), extra=first + second, until=200)
    assert run.complaints(slower=5.0) == []
