"""Cities that netgenerate draws: grids, spiders, random ones, with any kind of junction, lane and street."""

from __future__ import annotations

from random import Random
from typing import Any

from roads.plain import Roads, element

SPEEDS = (8.33, 11.11, 13.89, 13.89, 16.67, 22.22)
"""m/s, towns' most often."""

LIGHTS, ACTUATED = ("traffic_light",), ("traffic_light", "--tls.default-type", "actuated")
"""What netgenerate is told of junctions: their type, and more options."""


def turns(rng: Random) -> tuple[str, ...]:
    """Return the options for what a junction's inside is like: turnarounds, speed in turns, how finely lines are drawn."""
    options = ["--no-turnarounds.except-deadend"] if rng.random() < 0.7 else []
    if rng.random() < 0.3:
        options += ["--junctions.limit-turn-speed", rng.choice(("4", "7"))]
    if rng.random() < 0.3:
        options += ["--junctions.corner-detail", "5", "--junctions.internal-link-detail", rng.choice(("3", "8"))]
    return tuple(options)


def streets(rng: Random, widest: int = 3) -> tuple[str, ...]:
    """Return the options for what streets are like unless said otherwise: lanes, speed, width, turning lanes."""
    lanes = rng.choices(range(1, widest + 1), weights=range(widest, 0, -1))[0]
    options = ["--default.lanenumber", str(lanes), "--default.speed", str(rng.choice(SPEEDS))]
    options += ["--random-lanenumber"] if lanes > 1 and rng.random() < 0.5 else []
    options += ["--turn-lanes", "1", "--turn-lanes.length", "30"] if rng.random() < 0.2 and widest > 1 else []
    options += ["--default.lanewidth", rng.choice(("2.8", "3.0", "3.5"))] if rng.random() < 0.3 else []
    options += ["--default.junctions.radius", rng.choice(("1.5", "8", "12"))] if rng.random() < 0.3 else []
    return tuple(options)


def grid(rng: Random, block: tuple[float, float] = (70.0, 220.0)) -> tuple[str, ...]:
    """Return the options of a grid whose blocks are so long (m)."""
    sides = ["--grid.x-number", str(rng.randint(2, 5)), "--grid.y-number", str(rng.randint(2, 5))]
    lengths = [word for name in ("x", "y") for word in (f"--grid.{name}-length", f"{rng.uniform(*block):.1f}")]
    return ("--grid", *sides, *lengths, "--grid.attach-length", f"{rng.uniform(80.0, 200.0):.1f}")


def spider(rng: Random) -> tuple[str, ...]:
    """Return the options of a spider's web."""
    size = ("--spider.arm-number", str(rng.randint(3, 7)), "--spider.circle-number", str(rng.randint(1, 3)))
    middle = ("--spider.omit-center",) if rng.random() < 0.5 else ()
    attached = ("--spider.attach-length", f"{rng.uniform(60.0, 150.0):.1f}")
    return ("--spider", *size, "--spider.space-radius", f"{rng.uniform(50.0, 150.0):.1f}", *middle, *attached)


def scattered(rng: Random) -> tuple[str, ...]:
    """Return the options of a random network."""
    nearest = rng.uniform(40.0, 120.0)
    distances = ("--rand.min-distance", f"{nearest:.1f}", "--rand.max-distance", f"{nearest * rng.uniform(1.5, 3.0):.1f}")
    angle = ("--rand.min-angle", f"{rng.uniform(30.0, 70.0):.1f}")
    return ("--rand", "--rand.iterations", str(rng.randint(12, 45)), *distances, *angle, "--bidi-probability", "0.9")


def bent(rng: Random, most: float = 20.0) -> tuple[str, ...]:
    """Return the options that move junctions by some metres from where they would be."""
    spread = f"norm(0,{rng.uniform(0.3, 1.0) * most:.1f})"
    return ("--perturb-x", spread, "--perturb-y", spread)


def junctions(rng: Random) -> tuple[str, ...]:
    """Return the options for junctions of any type."""
    kinds = (LIGHTS, ACTUATED, ("priority",), ("right_before_left",), ("allway_stop",), ("priority_stop",))
    kind, *more = rng.choice(kinds)
    if kind == "traffic_light" and rng.random() < 0.4:
        more += ["--tls.layout", "incoming"] if rng.random() < 0.5 else ["--tls.no-mixed"]
    return ("--default.junctions.type", kind, *more)


def city(rng: Random, *options: str, **more: Any) -> Roads:
    """Return a city drawn with these options, with others where they leave something open, and with `more` of `Roads`."""
    drawn = ("--seed", str(rng.randint(0, 2**31 - 1)), *turns(rng), *options)
    return Roads((*drawn,), **more)


def with_junctions(rng: Random, kind: str, *more: str) -> Roads:
    """Return a grid, spider or random city, all of whose junctions are of one type."""
    layout = rng.choices((grid, spider, scattered), weights=(4, 1, 1))[0]
    major = ("--random-priority", "--default.priority", "8") if kind.startswith("priority") else ()
    return city(rng, *layout(rng), *streets(rng), *major, "--default.junctions.type", kind, *more)


def mixed_streets(rng: Random) -> tuple[str, ...]:
    """Return types of streets for netgenerate to draw from: lanes, speeds, priorities, widths."""
    return tuple(
        element(
            "type",
            id=f"street{k}",
            numLanes=rng.choice((1, 1, 2, 2, 3)),
            speed=rng.choice(SPEEDS),
            priority=rng.randint(1, 9),
            width=rng.choice((None, 2.8, 3.5)),
        )
        for k in range(rng.randint(2, 4))
    )
