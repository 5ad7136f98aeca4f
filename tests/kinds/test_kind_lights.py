"""Kinds of traffic lights."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from helpers.witness import Witness
from kinds import ARMS, Net, car, cross, driven, edge, link, node, program, road, situation, standing, stream

from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.lab.simulation import run_trial

LIGHTS = cross("traffic_light")
"""Letters: n, e, s, w; of each: right, straight on, left."""
CENTRE = 90.0
MAIN, SIDE = "rrrGGgrrrGGg", "GGgrrrGGgrrr"
MAIN_YELLOW, SIDE_YELLOW = "rrryyyrrryyy", "yyyrrryyyrrr"


def test_a_permissive_left_turn_waits_for_a_gap_in_oncoming_traffic(tmp_path):
    oncoming = stream("on", "ec cw", [0, 1.5, 3, 4.5, 6, 7.5, 9, 16, 18])
    light = program("c", (40, MAIN), (3, MAIN_YELLOW), (20, SIDE), (3, SIDE_YELLOW))
    run = driven(tmp_path, LIGHTS, car("ego", "wc cn", 2), oncoming, extra=light)
    assert run.complaints() == []


def test_a_permissive_left_turn_leaves_the_junction_when_only_yellow_ends_the_stream(tmp_path):
    oncoming = stream("on", "ec cw", [1.8 * i for i in range(20)])
    light = program("c", (20, MAIN), (3, MAIN_YELLOW), (2, "r" * 12), (20, SIDE), (3, SIDE_YELLOW), (2, "r" * 12))
    run = driven(tmp_path, LIGHTS, car("ego", "wc cn", 2), oncoming, stream("n", "nc cs", [3, 10]), extra=light, until=90)
    assert run.complaints() == []


@pytest.mark.parametrize(
    ("route", "late"),
    [
        ("wc ce", 0.0),
        ("wc ce", 0.7),
        ("wc ce", 1.4),
        ("sc ce", 0.0),
        ("sc ce", 0.7),
        ("sc ce", 1.4),
    ],
)
def test_two_full_greens_into_one_lane_end_in_no_crash(tmp_path, route, late):
    other = "sc ce" if route == "wc ce" else "wc ce"
    light = program("c", (60, "rrrrrrGrrrGr"))
    run = driven(tmp_path, LIGHTS, car("ego", route), car("other", other, late), extra=light)
    assert run.complaints() == []


@pytest.mark.parametrize("green", [2.0, 3.5, 4.2, 4.8, 5.5])
def test_a_yellow_near_or_far_before_the_line_leads_nobody_over_red(tmp_path, green):
    light = program("c", (green, MAIN), (3, MAIN_YELLOW), (15, SIDE), (3, SIDE_YELLOW), (40, MAIN))
    cross_traffic = stream("n", "nc cs", [green - 1, green + 1]) + car("behind", "wc ce", 1.6)
    run = driven(tmp_path, LIGHTS, car("ego", "wc ce"), cross_traffic, extra=light)
    assert run.complaints() == []


@pytest.mark.parametrize("yellow", [1.0, 2.0])
@pytest.mark.parametrize("green", [3.0, 3.6, 4.2, 4.4, 5.0, 5.6])
def test_a_yellow_that_is_shorter_than_usual_leads_nobody_over_red_who_can_stop(tmp_path, green, yellow):
    """The program says how short it is, and whoever drives there knows; one is behind."""
    light = program("c", (green, MAIN), (yellow, MAIN_YELLOW), (15, SIDE), (yellow, SIDE_YELLOW), (40, MAIN))
    cross_traffic = stream("n", "nc cs", [green, green + 2]) + car("behind", "wc ce", 1.6)
    run = driven(tmp_path, LIGHTS, car("ego", "wc ce"), cross_traffic, extra=light)
    assert run.complaints() == []


@pytest.mark.parametrize("green", [3.0, 4.0, 4.4, 5.0, 5.6])
def test_a_program_without_yellow_stops_whoever_can_stop(tmp_path, green):
    light = program("c", (green, MAIN), (12, SIDE), (40, MAIN))
    run = driven(tmp_path, LIGHTS, car("ego", "wc ce"), stream("n", "nc cs", [green, green + 2]), extra=light)
    assert run.complaints(red=green < 4.5) == []


@pytest.mark.parametrize("turned", [-20.0, 33.0])
def test_a_car_inserted_on_a_lane_shorter_than_itself_waits_at_its_end_for_green(tmp_path, turned):
    """Its front is on the line: not in the junction, though coordinates say so by less than they are exact."""
    arm, (x, y) = 11.0, (math.cos(math.radians(turned)), math.sin(math.radians(turned)))
    ends = "".join(node(a, arm * (u * x - v * y), arm * (u * y + v * x)) for a, (u, v) in ARMS.items())
    net = replace(LIGHTS, nodes=ends + node("c", 0, 0, type="traffic_light"))
    light = program("c", (12, "r" * 12), (40, "g" * 12))
    run = driven(tmp_path, net, car("ego", "wc ce", departSpeed="0"), extra=light)
    assert run.complaints() == []
    assert [letter for _, letter in run.ego.lights] == ["g"]


def test_who_knows_when_a_red_light_turns_green_comes_to_it_rolling(tmp_path):
    light = program("c", (14, SIDE), (3, SIDE_YELLOW), (40, MAIN))
    scenario, least = situation(tmp_path, LIGHTS, car("ego", "wc ce"), extra=light), []
    for known in (0.0, 60.0):
        witness = Witness()
        result = run_trial(replace(scenario, parameters=Parameters(foreseen_lights_s=known)), observer=witness)
        assert result.verdict == "arrived without a violation"
        assert [letter for _, letter in witness.lights] == ["G"]
        least.append(min(moment.speed for moment in witness.moments[20:]))
    assert least[0] == pytest.approx(0.0, abs=0.01)
    assert least[1] > 1.5


def test_right_on_red_stops_first_and_then_takes_a_gap(tmp_path):
    light = program("c", (60, "GGgrrrGGgsrr"))
    run = driven(tmp_path, LIGHTS, car("ego", "wc cs"), stream("n", "nc cs", [0, 2, 4, 6, 14, 16]), extra=light)
    assert run.complaints() == []
    assert run.ego.slowest("wc") < 0.1


OTHERS = stream("n", "nc cs", [0, 3, 9]) + stream("e", "ec cw", [0.5, 4, 9])


@pytest.mark.parametrize("route", ["wc ce", "wc cn", "sc cn", "sc cw"])
def test_a_blinking_light_leaves_it_to_the_right_of_way(tmp_path, route):
    run = driven(tmp_path, LIGHTS, car("ego", route, 0.5), OTHERS, extra=program("c", (60, "o" * 12)))
    assert run.complaints() == []


LATE = pytest.mark.xfail(strict=True, reason="who comes 2.2 s behind at 14 m/s brakes hard: he looks late")


@pytest.mark.parametrize(
    ("route", "depart"),
    [("wc ce", 0.0), ("wc ce", 0.8), ("wc cn", 0.8), ("sc cn", 0.8), ("sc cw", 1.6), pytest.param("sc cw", 2.0, marks=LATE)],
)
def test_at_a_light_that_is_off_the_ego_looks_out_since_the_others_do_not(tmp_path, route, depart):
    run = driven(tmp_path, LIGHTS, car("ego", route, depart), OTHERS, extra=program("c", (60, "O" * 12)))
    assert run.complaints() == []


@pytest.mark.parametrize("room", [6.0, 9.0, 11.0])
def test_nobody_stands_in_the_junction_at_green_when_the_exit_is_blocked(tmp_path, room):
    light = program("c", (12, MAIN), (3, MAIN_YELLOW), (12, SIDE), (3, SIDE_YELLOW), (40, MAIN))
    blocked = standing("jam", "ce", "ce_0", room, 22.0)
    run = driven(tmp_path, LIGHTS, car("ego", "wc ce", 1), blocked, stream("n", "nc cs", [8, 10, 12]), extra=light)
    assert run.complaints() == []
    assert run.ego.stands_in(CENTRE - 3.2, CENTRE + 3.2) == []


@pytest.mark.parametrize("green", [8.4, 8.6, 8.8, 9.0, 9.2])
def test_a_second_line_close_behind_that_turns_yellow_too_leads_nobody_over_red_at_the_first(tmp_path, green):
    """Who goes on at a yellow and brakes for the next line would come over the first one when it is red."""
    nodes = node("a", 0, 0) + "".join(node(name, x, 0, type="traffic_light", tl="l") for name, x in (("b", 200), ("c", 220)))
    sides = "".join(node(name, x, y) for name, x, y in (("m", 200, -80), ("n", 200, 80), ("o", 220, -80), ("p", 220, 80)))
    ways = "".join(edge(ends, speed=16.7) for ends in ("ab", "bc", "cd", "mb", "bn", "oc", "cp"))
    net = Net(nodes + node("d", 400, 0) + sides, ways, link("ab bc") + link("mb bn") + link("bc cd") + link("oc cp"))
    light = program("l", (green, "GGGG"), (3, "yyyy"), (15, "rrrr"), (60, "GGGG"))
    run = driven(tmp_path, net, car("ego", "ab bc cd"), until=90, extra=light)
    assert run.complaints() == []


def left_lanes(wait: float) -> Net:
    """Return a crossing with lanes to the left, three from the west, whose waiting places are `wait` m behind the lines."""
    turns = {"n": "wse", "e": "nws", "s": "enw", "w": "sen"}
    nodes = "".join(node(a, x * CENTRE, y * CENTRE) for a, (x, y) in ARMS.items())
    nodes += node("c", 0, 0, type="traffic_light", radius=1.5)
    edges = "".join(edge(f"{a}c", numLanes=3 if a == "w" else 2) + edge(f"c{a}") for a in ARMS)
    links = "".join(
        link(f"{a}c c{right}", "00")
        + link(f"{a}c c{on}", "10" if a == "w" else "00")
        + link(f"{a}c c{left}", "20" if a == "w" else "10", contPos=wait)
        for a, (right, on, left) in turns.items()
    )
    return Net(nodes, edges, links, options=("--no-turnarounds",))


@pytest.mark.parametrize(("way", "opposite"), [("nc ce", "sc cw"), ("sc cw", "nc ce")])
def test_who_turns_left_keeps_clear_of_the_opposite_left_turn_rather_than_of_a_place_where_others_may_wait(
    tmp_path, way, opposite
):
    """Both have green at once, and no rule makes one of them wait: whoever reached over the other's way would stand."""
    light = program("c", (60, SIDE), (3, SIDE_YELLOW), (30, MAIN), (3, MAIN_YELLOW))
    others = stream("left", opposite, [2.5 * i for i in range(25)], departLane=1)
    run = driven(tmp_path, left_lanes(5.0), car("ego", way, 2, departLane=1), others, extra=light, until=120)
    assert run.complaints(slower=1.1) == []


@dataclass(frozen=True)
class _Redrawn(Net):
    """A network with lanes drawn otherwise than netconvert does, as some maps have them: lane, and x,y of its points."""

    lanes: tuple[tuple[str, str], ...] = ()

    def built(self, folder: Path) -> Path:
        path = super().built(folder)
        for lane, shape in self.lanes:
            text, replaced = re.subn(f'(<lane id="{lane}"[^>]* shape=")[^"]*', rf"\g<1>{shape}", path.read_text())
            assert replaced == 1
            path.write_text(text)
        return path


@pytest.mark.parametrize("lap", [0.6, 0.9, 1.5])
@pytest.mark.parametrize("step", [0.1, 0.5])
def test_who_waits_at_red_stands_before_the_way_on_where_that_begins_before_the_line(tmp_path, lap, step):
    plain = road(CENTRE, CENTRE)
    nodes = plain.nodes.replace('id="b"', 'id="c" type="traffic_light"').replace('id="c" x="180', 'id="e" x="180')
    lanes = ("ac_0", f"0,-1.6 {CENTRE + lap},-1.6"), (":c_0_0", f"{CENTRE + lap},-1.6 {CENTRE},-1.6")
    net = _Redrawn(nodes, edge("ac") + edge("ce"), lanes=lanes)
    run = driven(tmp_path, net, car("ego", "ac ce"), extra=program("c", (18, "r"), (40, "G")), step=step)
    assert run.complaints() == []


def test_who_waits_at_red_to_turn_stands_before_the_way_where_that_leads_back_past_the_line_at_first(tmp_path):
    """SUMO has him inside the junction as soon as his front is beside that way."""
    nodes = node("a", 0, 0) + node("c", CENTRE, 0, type="traffic_light") + node("e", CENTRE + 20.0, CENTRE)
    behind = f"{CENTRE},5.5"
    lanes = (
        ("ac_0", f"0,-1.6 {CENTRE},-1.6"), (":c_0_0", f"{CENTRE},-1.6 {CENTRE - 1.3},-0.1 {CENTRE - 0.3},3.7 {behind}"),
        ("ce_0", f"{behind} {CENTRE + 20.0},{CENTRE}"),
    )  # fmt: skip
    net = _Redrawn(nodes, edge("ac") + edge("ce"), lanes=lanes)
    run = driven(tmp_path, net, car("ego", "ac ce"), extra=program("c", (18, "r"), (40, "G")))
    assert run.complaints() == []
