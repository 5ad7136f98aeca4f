"""The kinds of roads that are drawn, by name."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import NamedTuple

from roads import country, pieces
from roads.cities import (
    bent,
    city,
    grid,
    junctions,
    mixed_streets,
    scattered,
    spider,
    streets,
    with_junctions,
)
from roads.plain import Roads

WALKS = ("--sidewalks.guess", "--sidewalks.guess.max-speed", "17", "--crossings.guess")
CYCLES = ("--bikelanes.guess", "--bikelanes.guess.max-speed", "17")
MEETS = ("--opposites.guess", "--opposites.guess.fix-lengths")


class Kind(NamedTuple):
    """A kind of roads: how they are drawn, and which of `walkers`, `sublane`, `opposite` its traffic has in any case."""

    draw: Callable[[Random], Roads]
    traits: frozenset[str] = frozenset()


def _dense(rng: Random) -> Roads:
    return city(rng, *grid(rng, (28.0, 60.0)), *bent(rng, 4.0), *streets(rng), *junctions(rng))


def _spider(rng: Random) -> Roads:
    return city(rng, *spider(rng), *streets(rng), *junctions(rng))


def _random(rng: Random) -> Roads:
    return city(rng, *scattered(rng), *streets(rng), *junctions(rng))


def _mixed(rng: Random) -> Roads:
    layout, files = rng.choice((grid, scattered))(rng), {"typ": mixed_streets(rng)}
    return city(rng, *layout, *bent(rng, 25.0), "--random-type", *junctions(rng), files=files)


def _left_hand(rng: Random) -> Roads:
    return city(rng, *rng.choice((grid, scattered))(rng), *bent(rng), *streets(rng), *junctions(rng), "--lefthand")


def _opposite(rng: Random) -> Roads:
    layout = rng.choice((grid, scattered))(rng)
    return city(rng, *layout, *streets(rng, 1), *junctions(rng), *MEETS)


def _walked(rng: Random) -> Roads:
    layout = rng.choice((grid, grid, scattered))(rng)
    return city(rng, *layout, *streets(rng, 2), *junctions(rng), convert=(*WALKS, *(CYCLES if rng.random() < 0.3 else ())))


def _cycled(rng: Random) -> Roads:
    return city(rng, *rng.choice((grid, spider))(rng), *streets(rng, 2), *junctions(rng), convert=CYCLES)


def _with_bus_lanes(rng: Random) -> Roads:
    return city(rng, *rng.choice((grid, scattered))(rng), *streets(rng), *junctions(rng), own_lanes="bus taxi")


KINDS = {
    "lights": Kind(lambda rng: with_junctions(rng, "traffic_light")),
    "actuated lights": Kind(lambda rng: with_junctions(rng, "traffic_light", "--tls.default-type", "actuated")),
    "priority": Kind(lambda rng: with_junctions(rng, "priority")),
    "stop signs": Kind(lambda rng: with_junctions(rng, "priority_stop")),
    "right before left": Kind(lambda rng: with_junctions(rng, "right_before_left")),
    "all-way stops": Kind(lambda rng: with_junctions(rng, "allway_stop")),
    "unregulated": Kind(lambda rng: with_junctions(rng, "unregulated")),
    "dense grid": Kind(_dense),
    "spider": Kind(_spider),
    "random": Kind(_random),
    "mixed streets": Kind(_mixed),
    "left hand": Kind(_left_hand),
    "opposite": Kind(_opposite, frozenset({"opposite"})),
    "crossings": Kind(_walked, frozenset({"walkers"})),
    "bicycle lanes": Kind(_cycled),
    "bus lanes": Kind(_with_bus_lanes),
    "sublane": Kind(_mixed, frozenset({"sublane"})),
    "roundabout": Kind(pieces.roundabout),
    "crossing": Kind(pieces.crossing),
    "dual carriageway": Kind(pieces.dual_carriageway),
    "ramps": Kind(country.ramps),
    "weaving": Kind(country.weaving),
    "lane drop": Kind(country.lane_drop),
    "bridge": Kind(pieces.bridge),
    "winding": Kind(country.winding, frozenset({"opposite"})),
}


def kind_at(index: int) -> str:
    """Return the name of the kind of the network with this number: one after the other."""
    return list(KINDS)[index % len(KINDS)]


def draw_of(seed: int, index: int) -> Random:
    """Return the numbers that a network and its traffic are drawn from: they depend on nothing else."""
    return Random(f"random roads {seed} {index}")
