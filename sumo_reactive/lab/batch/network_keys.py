"""The table `[network]` of an experiment with shares of egos: which groups of edges and which cuts are counted."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

from pydantic import Field, StringConstraints, field_validator

from sumo_reactive.lab.fundamental_diagram import DEFAULT_INTERVAL_S, CountedEdges, EdgeSets
from sumo_reactive.lab.schema import TomlTable, nearest, problem_at, problem_in
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.edge_counts import edges_for_cars
from sumo_reactive.sumo.net_file import parse

LEAST_INTERVAL_S, LONGEST_INTERVAL_S = 1.0, 86400.0
MOST_LETTERS_OF_EDGES = 40
_CUT = re.compile(rf"[a-z][a-z0-9_]{{0,{MOST_LETTERS_OF_EDGES - 1}}}")
"""The name of a cut is a part of a metric's key."""

Edges = Annotated[list[str], Field(min_length=1)]
Label = Annotated[str, StringConstraints(min_length=1, max_length=MOST_LETTERS_OF_EDGES)]


class NetworkKeys(TomlTable):
    """The table: edges by the name of their group or cut, each counted in those scenarios whose network has them."""

    interval_s: float = Field(default=DEFAULT_INTERVAL_S, ge=LEAST_INTERVAL_S, le=LONGEST_INTERVAL_S)
    """How long each point of the fundamental diagram is counted, s."""
    groups: dict[Label, Edges] = Field(default_factory=dict)
    """Edges counted together, by the group's name; without any, each class of road is one."""
    cuts: dict[Label, Edges] = Field(default_factory=dict)
    """Edges whose vehicles are counted in the middle, by the cut's name: the metric `cut_<name>_per_h`."""

    @field_validator("groups", "cuts")
    @classmethod
    def _differ(cls, asked: dict[str, list[str]]) -> dict[str, list[str]]:
        for name, edges in asked.items():
            if len(set(edges)) < len(edges):
                raise problem_at(name, "an edge is named twice")
        return asked

    @field_validator("cuts")
    @classmethod
    def _are_keys(cls, asked: dict[str, list[str]]) -> dict[str, list[str]]:
        for name in asked:
            if not _CUT.fullmatch(name):
                raise problem_at(name, f"a cut's name is small letters, digits and _, {MOST_LETTERS_OF_EDGES} at most")
        return asked


def counted_of(path: Path, keys: NetworkKeys, configs: Mapping[str, Path]) -> dict[str, CountedEdges]:
    """Return what is counted of each scenario, by its name; of one with none of the groups, each class of road.

    Raises ScenarioError naming the line of an edge in no network, or of a group or cut of which a network has a part.
    """
    if not keys.groups and not keys.cuts:
        return dict.fromkeys(configs, CountedEdges(keys.interval_s))
    roads = {name: _edges_in(config) for name, config in configs.items()}
    for kind, sets in (("groups", keys.groups), ("cuts", keys.cuts)):
        for name, edges in sets.items():
            _require_whole(path, ("network", kind, name), edges, roads)
    return {
        name: CountedEdges(keys.interval_s, _sets_in(keys.groups, edges), _sets_in(keys.cuts, edges))
        for name, edges in roads.items()
    }


def _edges_in(config: Path) -> frozenset[str]:
    return frozenset(edges_for_cars(parse(read_config(config).net_file)))


def _sets_in(asked: Mapping[str, Sequence[str]], edges: frozenset[str]) -> EdgeSets:
    return tuple((name, tuple(some)) for name, some in asked.items() if edges.issuperset(some))


def _require_whole(
    path: Path, place: tuple[str, str, str], edges: Sequence[str], roads: Mapping[str, frozenset[str]]
) -> None:
    every = frozenset().union(*roads.values())
    for k, edge in enumerate(edges):
        if edge not in every:
            raise problem_in(path, (*place, k), f"no road of a scenario is called '{edge}'{nearest(edge, every)}")
    for name, known in roads.items():
        lacking = [edge for edge in edges if edge not in known]
        if 0 < len(lacking) < len(edges):
            raise problem_in(path, place, f"{name} has a part of these roads only, not '{lacking[0]}'")
    if not any(known.issuperset(edges) for known in roads.values()):
        raise problem_in(path, place, "no scenario has all of these roads")
