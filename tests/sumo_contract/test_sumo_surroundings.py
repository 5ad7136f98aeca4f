"""Lights, pedestrians, repeatability and the version of SUMO itself."""

import re
from importlib import metadata
from itertools import pairwise

import libsumo
import pytest
from contract_driving import depart, place, take_over


def test_lights_letters_by_link_index(simulate, light_cross):
    simulate(light_cross, depart("wc ce", lane=1))
    take_over()
    letters = libsumo.trafficlight.getRedYellowGreenState("c")
    ((light, index, distance, letter),) = libsumo.vehicle.getNextTLS("ego")
    assert light == "c"
    assert letters[index] == letter
    assert len(libsumo.trafficlight.getControlledLinks("c")) == len(letters)
    assert libsumo.trafficlight.getControlledLinks("c")[index][0][0] == libsumo.vehicle.getLaneID("ego")
    x = libsumo.vehicle.getPosition("ego")[0]
    assert distance == pytest.approx(libsumo.lane.getShape(libsumo.vehicle.getLaneID("ego"))[-1][0] - x, abs=0.01)


def test_the_program_tells_the_letters_and_times_to_come(simulate, light_cross):
    simulate(light_cross, depart("wc ce"), step=1.0)
    program = libsumo.trafficlight.getAllProgramLogics("c")[0]
    for _ in range(80):
        libsumo.simulationStep()
        phase = libsumo.trafficlight.getPhase("c")
        assert program.phases[phase].state == libsumo.trafficlight.getRedYellowGreenState("c")
        remaining = libsumo.trafficlight.getNextSwitch("c") - libsumo.simulation.getTime()
        assert 0.0 <= remaining <= program.phases[phase].duration


def test_an_ego_that_runs_a_red_light_is_not_noticed_by_sumo(simulate, light_cross):
    simulate(light_cross, depart("nc cs", lane=1, position=150))
    take_over()
    x, y = libsumo.vehicle.getPosition("ego")
    emergency = 0
    while y > 150.0:
        y -= 1.0
        place(x, y, 10.0, 180.0)
        emergency += libsumo.simulation.getEmergencyStoppingVehiclesNumber()
    assert emergency == 0
    assert libsumo.vehicle.getRoadID("ego") == "cs"


def crossing_positions() -> list[tuple[float, tuple[float, float]]]:
    """(lane position, place) of a walker on the crossing over the western arm, step by step."""
    seen: list[tuple[float, tuple[float, float]]] = []
    for _ in range(2000):
        libsumo.simulationStep()
        if "walker" in libsumo.person.getIDList() and libsumo.person.getRoadID("walker") == ":c_c3":
            assert "walker" in libsumo.edge.getLastStepPersonIDs(":c_c3")
            seen.append((libsumo.person.getLanePosition("walker"), libsumo.person.getPosition("walker")))
        elif seen:
            break
    return seen


@pytest.mark.parametrize("walk, start, grows", [("nc cs", 150, True), ("cs cw", 5, False)])
def test_a_walkers_lane_position_counts_along_the_crossings_shape_both_ways(simulate, light_cross, walk, start, grows):
    simulate(light_cross, f'<person id="walker" depart="0" departPos="{start}"><walk edges="{walk}"/></person>')
    seen = crossing_positions()
    assert len(seen) > 50
    assert all((s2 >= s1) is grows or s1 == s2 for (s1, _), (s2, _) in pairwise(seen))
    top = libsumo.lane.getShape(":c_c3_0")[0][1]
    assert all(top - y == pytest.approx(s, abs=0.01) for s, (_, y) in seen)


def trace(simulate, net, seed: int, save_to: str = "") -> list[tuple[str, float, float]]:
    flow = '<flow id="f" type="other" begin="0" end="60" period="exp(0.5)" from="nc" to="cs" departSpeed="max"/>'
    simulate(net, depart("wc ce") + flow, seed=seed)
    take_over()
    places = []
    for k in range(300):
        place(min(21.0 + k, 350.0), 198.4, 10.0)
        if save_to and k % 50 == 0:
            libsumo.simulation.saveState(save_to)
        places += [(v, *libsumo.vehicle.getPosition(v)) for v in libsumo.vehicle.getIDList()]
    return places


def test_same_seed_same_run(simulate, priority_cross):
    assert trace(simulate, priority_cross, seed=3) == trace(simulate, priority_cross, seed=3)
    assert trace(simulate, priority_cross, seed=3) != trace(simulate, priority_cross, seed=4)


def test_saving_the_state_does_not_change_the_run(simulate, priority_cross, tmp_path):
    saved = trace(simulate, priority_cross, seed=3, save_to=str(tmp_path / "state.xml"))
    assert saved == trace(simulate, priority_cross, seed=3)


def test_supported_sumo_version():
    (declared,) = [r for r in metadata.requires("sumo-reactive") or [] if re.match(r"libsumo\b", r)]
    lowest = re.search(r">=([\d.]+)", declared)
    below = re.search(r"<([\d.]+)", declared)
    assert lowest and below

    def numbers(text: str) -> tuple[int, ...]:
        return tuple(int(n) for n in text.split("."))[:2]

    _, name = libsumo.getVersion()
    running = numbers(name.removeprefix("SUMO "))
    assert numbers(lowest[1]) <= running < numbers(below[1])
