"""A scenario of a seed and a number: a network with its traffic, written as SUMO's files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from random import Random
from typing import NamedTuple

import sumolib

from roads.kinds import KINDS, draw_of, kind_at
from roads.plain import document, element
from roads.traffic import Demand, bus_stops, persons, vehicles
from roads.vehicles import vehicle_types

CONFIG, TRAFFIC = "roads.sumocfg", "roads.rou.xml"
STEPS = {0.1: 4, 0.2: 3, 0.5: 3, 1.0: 1}
"""Step lengths (s), and how often each is drawn."""

TELEPORTS = (300, 300, 300, 120, 60, -1)
"""s of waiting after which SUMO takes a vehicle out of a jam; −1: never."""


class Place(NamedTuple):
    """A scenario on disk: seed and number, its kind, its configuration, the step (s), how many edges the network has."""

    seed: int
    index: int
    kind: str
    config: Path
    step_s: float
    edges: int


def written(seed: int, index: int, folder: Path) -> Place:
    """Write the scenario with this number into a folder that exists; raise NetworkError if its network cannot be built."""
    rng, kind = draw_of(seed, index), KINDS[kind_at(index)]
    file = kind.draw(rng).built(folder)
    net = sumolib.net.readNet(str(file), withPedestrianConnections=False)
    step = rng.choices(list(STEPS), list(STEPS.values()))[0]
    traits = kind.traits | ({"sublane"} if rng.random() < 0.1 else set())
    _write_traffic(Demand(net, rng), step, traits, folder)
    options = _options(rng, step, traits)
    settings = [element(name, value=value) for name, value in options.items()]
    config = folder / CONFIG
    config.write_text(document("configuration", settings), encoding="utf-8")
    return Place(seed, index, kind_at(index), config, step, len(net.getEdges()))


def _write_traffic(demand: Demand, step: float, traits: frozenset[str], folder: Path) -> None:
    types = vehicle_types(demand.rng, step, traits)
    stops, cars = bus_stops(demand), vehicles(demand)
    walkers = persons(demand) if "walkers" in traits else []
    files = {"rou": ("routes", [*types, *cars]), "add": ("additional", stops), "ped": ("routes", walkers)}
    for name, (root, elements) in files.items():
        (folder / f"roads.{name}.xml").write_text(document(root, elements), encoding="utf-8")


def _options(rng: Random, step: float, traits: frozenset[str]) -> Mapping[str, object]:
    """Return what the configuration says."""
    said: dict[str, object] = {
        "net-file": "roads.net.xml", "route-files": "roads.rou.xml,roads.ped.xml", "additional-files": "roads.add.xml",
        "begin": 0, "step-length": step, "time-to-teleport": rng.choice(TELEPORTS), "ignore-route-errors": "true",
    }  # fmt: skip
    if "sublane" in traits:
        said["lateral-resolution"] = rng.choice((0.3, 0.5, 0.8))
    if rng.random() < 0.15:
        said |= {"device.rerouting.probability": round(rng.uniform(0.2, 1.0), 2), "device.rerouting.period": 60}
    if rng.random() < 0.1:
        said["ignore-junction-blocker"] = rng.choice((10, 60))
    return said
