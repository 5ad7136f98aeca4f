"""Unseen roads: what is drawn is drawn again alike, every kind is what it is called, and the worse trips are told."""

from __future__ import annotations

import json
import re
import shlex
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

import libsumo
import pytest
import sumolib
from helpers.programs import TOOLS, run_tool, sumo_reactive
from helpers.tools import tool

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.errors import NetworkError
from sumo_reactive.lab.task import Ending

sys.path.insert(0, str(TOOLS))

from roads.kinds import KINDS, draw_of, kind_at
from roads.plain import Roads, document, edge, element, node
from roads.scenarios import written
from roads.table import Row, faults, table, worse
from roads.trips import Order, Run, brisk_of, completed, drawn, scenario_of
from roads.witness import Witness, bridges_of

SMALL = (3, 18)
"""Seed and number of a small network, two crossings, and of little traffic."""


def built(kind: str, folder: Path) -> str:
    """Return the text of the first network of a kind, from seed 1."""
    number = list(KINDS).index(kind)
    return KINDS[kind].draw(draw_of(1, number)).built(folder).read_text(encoding="utf-8")


@pytest.mark.parametrize("kind", KINDS)
def test_a_network_of_every_kind_is_built(kind, tmp_path):
    built(kind, tmp_path)
    net = sumolib.net.readNet(str(tmp_path / "roads.net.xml"))
    assert len([edge for edge in net.getEdges() if edge.allows("passenger")]) >= 5


@pytest.mark.parametrize(
    ("kind", "sign"),
    [
        ("lights", r'<tlLogic [^>]*type="static"'),
        ("actuated lights", r'<tlLogic [^>]*type="actuated"'),
        ("priority", r'<junction [^>]*type="priority"'),
        ("stop signs", r'<junction [^>]*type="priority_stop"'),
        ("right before left", r'<junction [^>]*type="right_before_left"'),
        ("all-way stops", r'<junction [^>]*type="allway_stop"'),
        ("unregulated", r'<junction [^>]*type="unregulated"'),
        ("left hand", r'<net [^>]*lefthand="true"'),
        ("opposite", r"<neigh "),
        ("crossings", r'<edge [^>]*function="crossing"'),
        ("bicycle lanes", r'<lane [^>]*allow="bicycle"'),
        ("bus lanes", r'<lane [^>]*allow="taxi bus"'),
        ("roundabout", r"<roundabout "),
        ("winding", r"<neigh "),
    ],
)
def test_a_kind_is_what_it_is_called(kind, sign, tmp_path):
    assert re.search(sign, built(kind, tmp_path))


def test_roads_cross_on_a_bridge_without_a_junction(tmp_path):
    built("bridge", tmp_path)
    assert frozenset(("c0_c2", "c1_c3")) in bridges_of(tmp_path / "roads.net.xml")
    built("crossing", tmp_path)
    assert bridges_of(tmp_path / "roads.net.xml") == frozenset()


def files_of(seed, number, folder):
    """Return what is written for a scenario by the file's name."""
    folder.mkdir()
    written(seed, number, folder)
    return {file.name: file.read_text(encoding="utf-8") for file in folder.iterdir() if file.suffix != ".typ"}


@pytest.mark.parametrize("number", [SMALL[1], list(KINDS).index("crossings"), list(KINDS).index("mixed streets")])
def test_seed_and_number_say_all_about_network_and_traffic(number, tmp_path):
    first, again = files_of(SMALL[0], number, tmp_path / "a"), files_of(SMALL[0], number, tmp_path / "b")
    assert first == again
    other = files_of(SMALL[0] + 1, number, tmp_path / "c")
    next_round = files_of(SMALL[0], number + len(KINDS), tmp_path / "d")
    assert len({one["roads.rou.xml"] for one in (first, other, next_round)}) == 3
    assert len({one["roads.net.xml"] for one in (first, other, next_round)}) == 3


def test_traffic_is_of_all_classes_from_an_empty_road_to_a_full_one(tmp_path):
    found, numbers, steps = set(), [], set()
    for number, seed in ((number, seed) for number in (SMALL[1], 13, 22) for seed in range(4)):
        traffic = files_of(seed, number, tmp_path / f"{number}_{seed}")
        names = re.findall(r'<(?:vehicle|trip|person) id="([a-z]+)_', "".join(traffic.values()))
        departures = re.findall(r'<(?:vehicle|trip) [^>]*depart="([\d.]+)"', traffic["roads.rou.xml"])
        assert departures == sorted(departures, key=float)
        found |= set(names)
        numbers.append(len(departures))
        steps.add(re.search(r'<step-length value="([\d.]+)"', traffic["roads.sumocfg"])[1])
    assert found == {"car", "van", "truck", "trailer", "bus", "motorcycle", "bicycle", "walker"}
    assert min(numbers) < 60 < 300 < max(numbers)
    assert len(steps) >= 3


def test_a_network_that_netgenerate_refuses_is_told_with_its_words(tmp_path):
    with pytest.raises(NetworkError, match=r"^netgenerate ends with 1: .*no-such-option"):
        Roads(("--grid", "--no-such-option", "1")).built(tmp_path)


def test_egos_arrive_in_the_hands_of_sumo_and_are_drawn_alike_each_time(tmp_path):
    place = written(*SMALL, tmp_path)
    names = completed(scenario_of(place, ""))
    order = Order(*SMALL, tmp_path, egos=3)
    chosen = drawn(names, order)
    assert len(chosen) == 3 and set(chosen) <= set(names)
    assert chosen == drawn(names, order) != drawn(names, order._replace(seed=99))
    assert all(one.startswith(("car", "van", "truck", "bus", "trailer")) for one in chosen)


OVER = Roads(
    (),
    {
        "nod": (node("a", (-100, 0)), node("b", (100, 0)), node("c", (0, -100)), node("d", (0, 100))),
        "edg": (edge(("a", "b"), numLanes=1, speed=10), edge(("c", "d"), numLanes=1, speed=10)),
    },
)
"""Two roads, one over the other, as far as anybody can tell from the plane."""


def test_a_witness_counts_a_contact_once_and_none_on_a_bridge(tmp_path):
    net = OVER.built(tmp_path)
    halts = []
    for way in ("a_b", "c_d"):
        stop = element("stop", lane=f"{way}_0", endPos=102, until=60)
        halts.append(element("vehicle", element("route", edges=way), stop, id=way, depart=0))
    (tmp_path / "roads.rou.xml").write_text(document("routes", halts), encoding="utf-8")
    bridges = bridges_of(net)
    assert bridges == {frozenset(("a_b", "c_d"))}
    aware, unaware = Witness("a_b", bridges), Witness("a_b")
    libsumo.start(["sumo", "-n", str(net), "-r", str(tmp_path / "roads.rou.xml"), "--no-step-log", "--step-length", "0.5"])
    try:
        for _ in range(100):
            libsumo.simulationStep()
            aware.look()
            unaware.look()
    finally:
        libsumo.close()
    assert aware.seen == ((), (), 0.0)
    assert [name for _, name in unaware.seen.contacts] == ["c_d"]


def test_who_parks_is_not_off_the_road(tmp_path):
    net, file = OVER.built(tmp_path), tmp_path / "roads.rou.xml"
    stop = element("stop", lane="a_b_0", endPos=60, duration=20, parking="true")
    car = element("vehicle", element("route", edges="a_b"), stop, id="x", depart=0)
    file.write_text(document("routes", [car]), encoding="utf-8")
    witness, lanes = Witness("x"), []
    libsumo.start(["sumo", "-n", str(net), "-r", str(file), "--no-step-log", "--step-length", "0.5"])
    try:
        for _ in range(50):
            libsumo.simulationStep()
            witness.look()
            lanes.append(libsumo.vehicle.getLaneID("x"))
    finally:
        libsumo.close()
    assert "" in lanes and witness.seen.off_road_s == 0.0


def test_who_brakes_hard_in_comfort_is_known(tmp_path):
    sorts = [element("vType", id=name, vClass=sort, decel=decel) for name, sort, decel in (
        ("calm", "passenger", 4.5), ("hard", "passenger", 5.0), ("plain", "truck", None), ("motorcycle", "motorcycle", None),
        ("slow", "motorcycle", 4.0),
    )]  # fmt: skip
    cars = [element("trip", id=f"{name}_1", type=name) for name in ("calm", "hard", "plain", "motorcycle", "slow")]
    (tmp_path / "roads.rou.xml").write_text(document("routes", [*sorts, *cars]), encoding="utf-8")
    assert brisk_of(tmp_path) == {"hard_1", "motorcycle_1"}


CLEAN = Run(arrived=True, told="arrived without a violation", duration_s=20.0)
HIT, RAN = CLEAN._replace(contacts=((7.5, "x"),)), CLEAN._replace(red=(9.0,))


def row(ours: Run, sumo: Run = CLEAN, edges: int = 10, number: int = 0) -> Row:
    """A trip of one ego."""
    return Row(number, kind_at(number), edges, "car_1", ours, sumo)


@pytest.mark.parametrize(
    ("ours", "sumo", "told"),
    [
        (CLEAN, CLEAN, []),
        (CLEAN._replace(duration_s=30.0), CLEAN, []),
        (CLEAN._replace(duration_s=30.1), CLEAN, ["takes 30.1 s, SUMO's own 20.0 s"]),
        (HIT, CLEAN, ["contact with x at 7.5 s"]),
        (HIT, HIT, ["contact with x at 7.5 s"]),
        (RAN, CLEAN, ["red light run at 9 s"]),
        (CLEAN._replace(hard_braking=2), CLEAN._replace(hard_braking=2), []),
        (CLEAN._replace(hard_braking=2), CLEAN, ["2 hard brakings caused, SUMO's own 0"]),
        (CLEAN._replace(contacts=((1.0, "x"),) * 5), CLEAN, ["contact with x at 1 s"] * 3 + ["2 more contacts"]),
        (Run(told="until 9 s"), CLEAN, ["not arrived: until 9 s"]),
        (Run(exit_code=70, error="internal error: IndexError"), CLEAN, ["exit 70: internal error: IndexError"]),
    ],
)
def test_what_this_driver_does_worse_is_told_in_words(ours, sumo, told):
    assert faults(row(ours, sumo)) == told


def test_the_worse_trips_are_listed_with_the_smallest_network_first():
    rows = [row(HIT, edges=30), row(CLEAN, edges=1), row(RAN, edges=4, number=3), row(HIT, edges=4, number=2)]
    assert worse(rows) == [rows[3], rows[2], rows[0]]


def test_the_table_has_both_drivers_side_by_side_by_kind_and_in_all():
    slow = CLEAN._replace(duration_s=40.0, off_road_s=1.5, lateral=3.0)
    broken = row(Run(exit_code=70, error="x"), RAN._replace(standstill_s=4.0), number=1)
    told = table([row(HIT), row(slow, number=1), broken])
    head, first, second, whole = (re.split(r"\s{2,}", line.strip()) for line in told.splitlines())
    assert dict(zip(head, first, strict=True))["contacts"] == "1 / 0" and first[0] == "lights"
    cells = dict(zip(head, second, strict=True))
    assert (cells["networks"], cells["trips"], cells["arrived"], cells["red"]) == ("1", "2", "1 / 2", "0 / 1")
    assert (cells["off s"], cells["stand s"], cells["lateral"]) == ("1.5 / 0.0", "0 / 4", "3.0 / 0.0")
    assert cells["exit > 1"] == "1"
    cells = dict(zip(head, whole, strict=True))
    assert (whole[0], cells["networks"], cells["trips"], cells["ratio p50"]) == ("all", "2", "3", "1.50")


@dataclass
class FakeRunner:
    """Answers in turn as a process would."""

    answers: list[object]
    asked: list[str] = field(default_factory=list)

    def call(self, function, *_):
        self.asked.append(function)
        return self.answers.pop(0)


READY = SimpleNamespace(place=SimpleNamespace(edges=5), bridges=frozenset(), trips={"car_1": CLEAN, "car_2": CLEAN})


def test_a_trip_that_takes_the_program_down_is_a_row_and_the_next_one_is_driven(tmp_path):
    runner = FakeRunner([
        (Ending.DONE, READY, 1.0), (Ending.CRASHED, "internal error: IndexError: x", 1.0), (Ending.DONE, CLEAN, 1.0),
    ])  # fmt: skip
    found = tool("random_roads")._driven_network(Order(1, 0, tmp_path, 2), runner, 9.0)
    assert [one.ours.exit_code for one in found.rows] == [70, 0]
    assert found.rows[0].is_harmful and not found.rows[1].is_harmful


def test_a_network_that_cannot_be_built_is_counted_and_told(tmp_path, capsys):
    random_roads = tool("random_roads")
    runner = FakeRunner([(Ending.FAILED, "netgenerate ends with 1: Error", 0.1)])
    found = random_roads._driven_network(Order(1, 3, tmp_path, 2), runner, 9.0)
    random_roads._show(1, [found], [])
    said = capsys.readouterr().out
    assert "1 networks, 1 without a trip; 0 trips" in said
    assert "3 stop signs: netgenerate ends with 1: Error" in said


def asked(*more):
    """The command line for two trips in the small network."""
    seed, number = SMALL
    return (seed, number + 1, "--only", number, "--egos", 2, *more)


def test_a_trip_is_driven_told_and_replayed_by_its_command(tmp_path):
    file, kept = tmp_path / "trips.json", tmp_path / "kept"
    first = run_tool("random_roads", *asked("--json", file))
    assert first.returncode == 0, first.stdout + first.stderr
    assert re.search(r"^crossing +1 +2 +2 / 2 +0 / 0 +0 / 0 ", first.stdout, re.MULTILINE)
    assert run_tool("random_roads", *asked()).stdout == first.stdout
    trip, _ = json.loads(file.read_text(encoding="utf-8"))["trips"]
    answer = run_tool("random_roads", *asked("--ego", trip["ego"], "--keep", kept))
    program, *command = shlex.split(answer.stdout)
    assert program == "sumo-reactive"
    again = sumo_reactive(*command)
    assert again.returncode == 0, again.stderr
    summary = json.loads((kept / trip["ego"] / "summary.json").read_text(encoding="utf-8"))
    assert summary["duration_s"] == pytest.approx(trip["ours"]["duration_s"], abs=1e-3)


def test_the_egos_of_a_network_drive_together_and_are_replayed_by_their_command(tmp_path):
    file, kept = tmp_path / "trips.json", tmp_path / "kept"
    first = run_tool("random_roads", *asked("--together", "--json", file))
    assert first.returncode == 0, first.stdout + first.stderr
    trips = json.loads(file.read_text(encoding="utf-8"))["trips"]
    answer = run_tool("random_roads", *asked("--together", "--keep", kept))
    _, *command = shlex.split(answer.stdout)
    again = sumo_reactive(*command)
    assert again.returncode == 0, again.stderr
    fleet = json.loads((kept / "together" / "fleet.json").read_text(encoding="utf-8"))
    told = {one["ego"]: one["duration_s"] for one in fleet["egos"]}
    assert told == pytest.approx({trip["ego"]: trip["ours"]["duration_s"] for trip in trips}, abs=1e-3)
    assert len(told) == 2


def test_egos_that_cannot_drive_together_drive_alone(tmp_path):
    runner = FakeRunner([
        (Ending.DONE, READY, 1.0), (Ending.FAILED, "ego 'car_1' cannot be driven", 1.0), (Ending.DONE, HIT, 1.0),
        (Ending.DONE, CLEAN, 1.0),
    ])  # fmt: skip
    found = tool("random_roads")._driven_network(Order(1, 0, tmp_path, 2), runner, 9.0, together=True)
    assert [one.ours for one in found.rows] == [HIT, CLEAN]
    assert runner.asked == ["roads.trips:prepared", "roads.trips:driven_together", *["roads.trips:driven"] * 2]
    replay = tool("random_roads").replay(1, found.rows[0], Order(1, 0, tmp_path, 2).parameters, 2)
    assert " --only 0 --together --egos 2 --keep " in replay


def test_a_driver_that_yields_to_nothing_is_listed_as_worse():
    answer = run_tool("random_roads", *asked("--parameter", f"without={Mechanism.GRAPH:d}"))
    assert answer.returncode == 1
    assert re.search(r"^crossing \(\d+ edges\), \w+: .*red light run at ", answer.stdout, re.MULTILINE)
    assert f"python tools/random_roads.py {SMALL[0]} {SMALL[1] + 1} --only {SMALL[1]} --ego " in answer.stdout
    assert f" --parameter without={Mechanism.GRAPH:d} --keep " in answer.stdout


def test_wrong_usage_is_one_line_and_exit_code_2():
    for words, told in (
        ((1, 5, "--only", 7), "--only is one of the 5 networks"),
        ((1, 5, "--ego", "x"), "need --only"),
        ((1, 5, "--parameter", "stuck=1"), "unknown parameter 'stuck'; near it: stuck_s"),
    ):
        answer = run_tool("random_roads", *words)
        assert answer.returncode == 2 and told in answer.stderr and answer.stdout == ""
