"""The lights whose stop lines a vehicle crosses, told from SUMO's lights and its lane."""

from collections.abc import Iterator
from pathlib import Path

import libsumo
import pytest

from sumo_reactive.sumo.sensor import StopLines, read_signals

NET = Path(__file__).parents[2] / "networks" / "signalised_left_turns" / "signalised_left_turns.net.xml"
LIGHT = "centre"
GREEN, RED = "G" * 12, "r" * 12


@pytest.fixture
def lines() -> Iterator[StopLines]:
    """Watches a vehicle at the lights, which are green, after a first step."""
    libsumo.start(["sumo", "-n", str(NET), "--no-step-log", "--no-warnings"])
    try:
        show(GREEN)
        yield StopLines(read_signals())
    finally:
        libsumo.close()


def show(letters: str) -> None:
    """Have the light show these letters, and simulate a step."""
    libsumo.trafficlight.setRedYellowGreenState(LIGHT, letters)
    libsumo.simulationStep()


def way() -> tuple[str, str, str, int]:
    """A lane before the light, the lane behind it and the one inside, and the index of the letter."""
    index = 4
    ((before, behind, inside),) = libsumo.trafficlight.getControlledLinks(LIGHT)[index]
    return before, behind, inside, index


@pytest.mark.parametrize(("then", "now"), [("r", "r"), ("r", "g"), ("g", "r"), ("y", "y")])
def test_the_letters_before_the_step_and_in_it_are_told(lines, then, now):
    before, _, inside, index = way()
    show(GREEN[:index] + then + GREEN[index + 1 :])
    assert lines.crossed(before) == ""
    show(GREEN[:index] + now + GREEN[index + 1 :])
    assert lines.crossed(inside) == then + now


def test_a_line_is_crossed_once(lines):
    before, behind, inside, _ = way()
    told = [lines.crossed(lane) for lane in (before, before, inside, inside, behind, behind)]
    assert told == ["", "", "GG", "", "", ""]


def test_who_is_on_no_lane_for_a_while_crosses_the_line_as_he_comes_onto_the_next(lines):
    before, _, inside, _ = way()
    lines.crossed(before)
    show(RED)
    assert [lines.crossed(""), lines.crossed(inside)] == ["", "rr"]


def test_who_passes_the_whole_junction_within_a_step_crosses_the_line(lines):
    before, behind, _, _ = way()
    lines.crossed(before)
    assert lines.crossed(behind) == "GG"


def test_who_swings_out_on_the_lane_beside_crosses_the_line_of_the_lane_that_he_comes_to(lines):
    before, _, inside, _ = way()
    edge, _, lane = before.rpartition("_")
    lines.crossed(f"{edge}_{1 - int(lane)}")
    assert lines.crossed(inside) == "GG"


def test_who_changes_lanes_before_the_light_crosses_no_line(lines):
    edge = way()[0].rpartition("_")[0]
    assert [lines.crossed(f"{edge}_{index}") for index in (0, 1, 0)] == [""] * 3
