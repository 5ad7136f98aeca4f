"""The roads around a recorded trip, from the network that its scenario names."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import moved_aside
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.errors import ReactiveError
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.show.recording import Recording
from sumo_reactive.show.run.steps import Steps, edges_of
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.net_reader import read_net

Outline = NDArray[np.float64]
"""Corners (n, 2) of an area, m."""


class RoadMap(NamedTuple):
    """Outlines by id of lanes, of lanes inside junctions, and of junctions; `missing` says why there are none."""

    lanes: dict[str, Outline]
    inside: dict[str, Outline]
    junctions: dict[str, Outline]
    missing: str = ""


def roads_of(recording: Recording, steps: Steps) -> RoadMap:
    """Return the roads that the trip touches, and those that lead to its junctions; without the network, why not."""
    source = Path(str(recording.summary["scenario"]))
    try:
        net = read_net(read_config(load_scenario(source).config).net_file)
        graph = net.build(edges_of(steps["lane_id"]))
    except ReactiveError as error:
        return RoadMap({}, {}, {}, str(error))
    lanes = {lane.id: outline_of(lane) for lane in graph.lanes.values()}
    inside = {name: lanes.pop(name) for name, lane in graph.lanes.items() if lane.is_internal}
    return RoadMap(lanes, inside, {name: junction.outline for name, junction in graph.junctions.items()})


def outline_of(lane: Lane) -> Outline:
    """Return the area of a lane: its centre line, moved by half its width to either side."""
    points = np.asarray(lane.spine.points, dtype=float)
    half = np.full(len(points), 0.5 * lane.width)
    return np.concatenate([moved_aside(points, half), moved_aside(points, -half)[::-1]])
