"""The fundamental diagram of groups of edges, and the throughput of cuts, from what SUMO counts on edges.

After Edie (1963) a group of edges with lanes of Σ L together, watched for T, on which vehicles spend t and drive d, has the
flow d / (T Σ L), the density t / (T Σ L) and the speed d / t.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.metric_names import cut_key

if TYPE_CHECKING:
    from sumo_reactive.sumo.edge_counts import EdgeTime, Road  # what a task says is read without SUMO

DEFAULT_INTERVAL_S = 60.0
_SECONDS_PER_H, _M_PER_KM = 3600.0, 1e3

EdgeSets = tuple[tuple[str, tuple[str, ...]], ...]
"""Named sets of edges, by name."""


@dataclass(frozen=True)
class CountedEdges:
    """What is counted of a network every `interval_s`: `groups` of edges (empty: one for each class of road) and `cuts`.

    Raises ScenarioError for an interval that is none.
    """

    interval_s: float = DEFAULT_INTERVAL_S
    groups: EdgeSets = ()
    cuts: EdgeSets = ()

    def __post_init__(self) -> None:
        if not self.interval_s > 0.0:
            raise ScenarioError(f"an interval of {self.interval_s:g} s is none")

    def groups_in(self, roads: Mapping[str, Road]) -> dict[str, list[Road]]:
        """Return the roads of each group."""
        if self.groups:
            return {name: [roads[edge] for edge in edges] for name, edges in self.groups}
        classes: defaultdict[str, list[Road]] = defaultdict(list)
        for road in roads.values():
            classes[road.road_class].append(road)
        return dict(sorted(classes.items()))

    def lanes_of_cuts(self, roads: Mapping[str, Road]) -> dict[str, float]:
        """Return the length (m) of each lane of a cut."""
        return {lane: length for _, edges in self.cuts for edge in edges for lane, length in roads[edge].lanes.items()}

    def throughput(self, passed: Mapping[str, int], roads: Mapping[str, Road], duration: float) -> dict[str, float | None]:
        """Return the vehicles per hour over each cut by its metric's key; `passed` on each lane in `duration` s."""
        lanes = {name: [lane for edge in edges for lane in roads[edge].lanes] for name, edges in self.cuts}
        counts = {cut_key(name): sum(passed.get(lane, 0) for lane in some) for name, some in lanes.items()}
        hours = duration / _SECONDS_PER_H
        return {key: round(count / hours, 4) if hours > 0.0 else None for key, count in counts.items()}


EVERY_CLASS = CountedEdges()
"""Each class of road, minute by minute."""


class DiagramPoint(NamedTuple):
    """A group of edges from `begin_s` to `end_s`: vehicles per hour and lane, per km and lane, their mean speed (None: there
    was nobody)."""

    edges: str
    begin_s: float
    end_s: float
    flow_per_h: float
    density_per_km: float
    speed_m_s: float | None


def diagram_of(times: Sequence[EdgeTime], groups: Mapping[str, Sequence[Road]], until: float) -> tuple[DiagramPoint, ...]:
    """Return a point a group and interval, none where nobody was on any road; the last interval ends at `until` s."""
    spans = sorted({(one.begin, min(one.end, until)) for one in times if min(one.end, until) > one.begin})
    driven = {(one.begin, one.edge_id): (one.time, one.time * one.speed) for one in times}
    return tuple(
        _point(name, span, [driven.get((span[0], road.edge_id), (0.0, 0.0)) for road in roads], _lane_length(roads))
        for name, roads in groups.items()
        for span in spans
    )


def _lane_length(roads: Sequence[Road]) -> float:
    return sum(length for road in roads for length in road.lanes.values())


def _point(
    name: str, span: tuple[float, float], driven: Sequence[tuple[float, float]], lane_length: float
) -> DiagramPoint:
    """Return the point of a group with so many m of lanes; `driven` is time (s) and way (m) on each of its edges."""
    (begin, end), time, way = span, sum(time for time, _ in driven), sum(way for _, way in driven)
    watched = (end - begin) * lane_length
    flow, density = (_SECONDS_PER_H * way / watched, _M_PER_KM * time / watched) if watched > 0.0 else (0.0, 0.0)
    return DiagramPoint(name, begin, end, round(flow, 4), round(density, 4), round(way / time, 4) if time > 0.0 else None)
