"""One kind of situation each: a tiny network, who drives there, SUMO's own driver and the ego, one witness for both."""

from __future__ import annotations

import math
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from pathlib import Path

import libsumo
import pytest
from helpers.witness import EGO, FORCED_LIMIT, LENGTH_M, RED, Witness
from sumolib import checkBinary

from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import DEFAULT_SEED, Scenario, load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.launch import sumo_arguments

STEP_S = 0.1
LATERAL_LIMIT = 4.05
SLOWER = 1.5
"""The ego may take this many times as long as SUMO's own driver."""



def fails(*values: object, because: str) -> object:
    """Return parameters with which the ego fails today, and why."""
    return pytest.param(*values, marks=pytest.mark.xfail(reason=because, strict=True))


def element(tag: str, content: str = "", **attributes: object) -> str:
    """Return an XML element; a trailing underscore of an attribute's name is dropped."""
    said = " ".join(f'{name.rstrip("_")}="{value}"' for name, value in attributes.items())
    return f"<{tag} {said}>{content}</{tag}>"


def node(name: str, x: float, y: float, **attributes: object) -> str:
    """Return a node."""
    return element("node", id=name, x=x, y=y, **attributes)


def edge(ends: str, content: str = "", **attributes: object) -> str:
    """Return the edge named by its two nodes, each one letter."""
    return element("edge", content, id=ends, from_=ends[0], to=ends[1], **({"speed": 13.9} | attributes))


def link(ends: str, lanes: str = "00", **attributes: object) -> str:
    """Return the connection between two edges, "ab bc", from and to a lane each."""
    before, behind = ends.split()
    return element("connection", from_=before, to=behind, fromLane=lanes[0], toLane=lanes[1], **attributes)


def car(name: str, edges: str, depart: float = 0.0, stops: str = "", **attributes: object) -> str:
    """Return a car that enters at its road's speed at the beginning of its route."""
    said = {"id": name, "type": "car", "depart": depart, "departSpeed": "max", "departPos": "base"} | attributes
    return element("vehicle", element("route", edges=edges) + stops, **said)


def standing(name: str, edges: str, lane: str, at: float, until: float, **attributes: object) -> str:
    """Return a car that stands with its front `at` m on a lane until `until` s."""
    said = {"departLane": lane[-1], "departPos": at - 0.1, "departSpeed": 0} | attributes
    return car(name, edges, stops=stop(lane, at, until=until), **said)


def sort(name: str, **attributes: object) -> str:
    """Return a vehicle type: a car unless said otherwise, which keeps to the road's speed exactly."""
    return element("vType", id=name, **({"length": 4.7, "width": 1.8, "speedFactor": 1, "speedDev": 0} | attributes))


def stop(lane: str, at: float, **attributes: object) -> str:
    """Return a stop with the front `at` m on a lane."""
    return element("stop", lane=lane, endPos=at, **attributes)


def stream(name: str, edges: str, departs: list[float], **attributes: object) -> str:
    """Return cars that enter one after the other."""
    return "".join(car(f"{name}{i}", edges, depart, **attributes) for i, depart in enumerate(departs))


def program(name: str, *phases: tuple[float, str]) -> str:
    """Return a fixed programme of a light: duration (s) and letters of each phase."""
    shown = "".join(element("phase", duration=duration, state=state) for duration, state in phases)
    return element("tlLogic", shown, id=name, type="static", programID="kind", offset=0)


_SORTS = (
    sort("car"),
    sort("calm", sigma=0),
    sort("bus", vClass="bus", length=12, width=2.5),
    sort("bike", vClass="bicycle", length=1.6, width=0.65, maxSpeed=5),
    sort("train", vClass="rail", length=60, width=2.8),
)


@dataclass(frozen=True)
class Net:
    """What netconvert makes a network of; `rules`: the file of connections."""

    nodes: str
    edges: str
    rules: str = ""
    options: tuple[str, ...] = ("--no-turnarounds",)

    def built(self, folder: Path) -> Path:
        """Return the network in `folder`."""
        command = [checkBinary("netconvert"), "-o", "k.net.xml", *self.options]
        files = (("-n", "nodes", self.nodes), ("-e", "edges", self.edges), ("-x", "connections", self.rules))
        for option, kind, content in files:
            if content:
                (folder / f"k.{kind}.xml").write_text(f"<{kind}>{content}</{kind}>")
                command += [option, f"k.{kind}.xml"]
        subprocess.run(command, check=True, capture_output=True, cwd=folder)
        return folder / "k.net.xml"


ARMS = {"w": (-1, 0), "e": (1, 0), "n": (0, 1), "s": (0, -1)}


def cross(kind: str = "priority", arm: float = 90.0, options: tuple[str, ...] = (), **attributes: object) -> Net:
    """Return a crossing at c with the arms w, e (the main road), n, s; its light's letters: n, e, s, w, each right first."""
    nodes = "".join(node(a, x * arm, y * arm) for a, (x, y) in ARMS.items()) + node("c", 0, 0, type=kind)
    even = kind in ("right_before_left", "allway_stop", "unregulated", "traffic_light")
    edges = "".join(
        edge(ends, **({"priority": 5 if even or arm_id in "we" else 1} | attributes))
        for arm_id in ARMS
        for ends in (f"{arm_id}c", f"c{arm_id}")
    )
    return Net(nodes, edges, options=("--no-turnarounds", *options))


def road(*lengths: float, **attributes: object) -> Net:
    """Return a one-way road through the nodes a, b, c, …, with edges of these lengths."""
    names = "abcdefghijklmnopqrstuvwxyz"
    places = [sum(lengths[:i]) for i in range(len(lengths) + 1)]
    nodes = "".join(node(names[i], x, 0) for i, x in enumerate(places))
    return Net(nodes, "".join(edge(names[i : i + 2], **attributes) for i in range(len(lengths))))


@dataclass(frozen=True)
class Run:
    """SUMO's own driver and the ego in one situation."""

    own: Witness
    ego: Witness
    result: TrialResult

    def complaints(self, *, slower: float = SLOWER, red: bool = True) -> list[str]:
        """Return what there is to complain about; `slower`: than SUMO's own driver by this factor at most."""
        found = [] if self._arrives() else [f"does not arrive: {self.result.verdict}"]
        found += [f"touches {name} at {time:g} s" for name, time in self.ego.touched.items()]
        found += [f"crosses on {letter} at {time:g} s" for time, letter in self.ego.lights if red and letter in RED]
        force, when = self.ego.lateral()
        found += [f"{force:.2f} m/s² to the side at {when:g} s"] if force > LATERAL_LIMIT else []
        if self.ego.duration > slower * self.own.duration:
            found.append(f"takes {self.ego.duration:.1f} s, SUMO's own driver {self.own.duration:.1f} s")
        limit = min([braking for _, _, braking in self.own.forced], default=FORCED_LIMIT)
        worst = min(self.ego.forced, key=lambda one: one[2], default=(0.0, "", 0.0))
        return found + ([f"{worst[1]} brakes {worst[2]} m/s² behind the ego at {worst[0]:g} s"] if worst[2] < limit else [])

    def _arrives(self) -> bool:
        """Whether the ego ends where SUMO's own driver does, within two of its last steps."""
        a, b = self.own.moments[-1], self.ego.moments[-1]
        steps = 2.0 * self.result.step_length_s * (a.speed + b.speed)
        return self.result.arrived and math.hypot(a.x - b.x, a.y - b.y) < LENGTH_M + steps


def situation(
    folder: Path, net: Net, *vehicles: str, extra: str = "", until: float = 60.0, step: float = STEP_S, options: str = ""
) -> Scenario:
    """Write all files of a situation; `extra` goes to the additional file, `options` into the configuration."""
    net.built(folder)
    (folder / "k.rou.xml").write_text(f"<routes>{_in_order((*_SORTS, *vehicles))}</routes>")
    (folder / "k.add.xml").write_text(f"<additional>{extra}</additional>")
    files = '<net-file value="k.net.xml"/><route-files value="k.rou.xml"/><additional-files value="k.add.xml"/>'
    times = f'<step-length value="{step}"/><time-to-teleport value="-1"/>'
    (folder / "k.sumocfg").write_text(f"<configuration>{files}{times}{options}</configuration>")
    return replace(load_scenario(folder / "k.sumocfg"), ego=EGO, until_s=until, step_length_s=step)


def _in_order(vehicles: tuple[str, ...]) -> str:
    """SUMO reads departures in order."""
    elements = list(ET.fromstring(f"<all>{''.join(vehicles)}</all>"))
    elements.sort(key=lambda one: float(one.get("depart", one.get("begin", "-1"))))
    return "".join(ET.tostring(one, encoding="unicode") for one in elements)


def driven_by_sumo(scenario: Scenario) -> Witness:
    """Let SUMO's own driver take the ego's trip."""
    config, witness = read_config(scenario.config), Witness()
    step = scenario.step_length_s or STEP_S
    arguments, _ = sumo_arguments(config, scenario.config, seed=DEFAULT_SEED, step_length_s=step)
    libsumo.start(["sumo", *arguments])
    try:
        while not witness.arrived and libsumo.simulation.getTime() < (scenario.until_s or math.inf):
            libsumo.simulationStep()
            witness()
            witness.arrived = EGO in libsumo.simulation.getArrivedIDList()
    finally:
        libsumo.close()
    return witness


def driven(folder: Path, net: Net, *vehicles: str, **how: object) -> Run:
    """Build a situation and let first SUMO's own driver, then the ego drive in it; the first must arrive."""
    scenario = situation(folder, net, *vehicles, **how)
    own, witness = driven_by_sumo(scenario), Witness()
    assert own.arrived, "SUMO's own driver does not arrive: the situation is wrong"
    result = run_trial(scenario, observer=witness)
    return Run(own, witness, result)
