"""Junctions made by hand, whose measures are drawn at random: roundabouts, crossings, a bridge."""

from __future__ import annotations

import math
from random import Random

from roads.cities import SPEEDS, turns
from roads.plain import Point, Roads, both, edge, element, node


def _around(radius: float, angle: float, side: int = 1) -> Point:
    """Return a point on a circle; `side` −1: seen in a mirror."""
    return radius * math.cos(angle), side * radius * math.sin(angle)


def _angles(rng: Random, number: int) -> list[float]:
    """Return directions (rad) all around, anticlockwise, somewhat uneven."""
    first, even = rng.uniform(0.0, 2.0 * math.pi), 2.0 * math.pi / number
    return [first + even * (k + rng.uniform(-0.17, 0.17)) for k in range(number)]


def roundabout(rng: Random) -> Roads:
    """Return a roundabout of three to six arms and one to three lanes, on either side of the road."""
    arms, lanes, side = rng.randint(3, 6), rng.choice((1, 1, 2, 2, 3)), rng.choice((1, 1, 1, -1))
    radius = rng.uniform(10.0 + 2.5 * arms + 3.0 * lanes, 45.0)
    angles, ring = _angles(rng, arms), [f"r{k}" for k in range(arms)]
    nodes = [node(ring[k], _around(radius, angles[k], side), type="priority") for k in range(arms)]
    edges = []
    for k in range(arms):
        after = angles[(k + 1) % arms] + (2.0 * math.pi if k + 1 == arms else 0.0)
        bend = [_around(radius, angles[k] + share / 6.0 * (after - angles[k]), side) for share in range(7)]
        shape = " ".join(f"{x:.2f},{y:.2f}" for x, y in bend)
        around = (ring[k], ring[(k + 1) % arms])
        edges.append(edge(around, numLanes=lanes, speed=rng.uniform(6.0, 10.0), priority=9, shape=shape))
        nodes.append(node(f"a{k}", _around(radius + rng.uniform(80.0, 200.0), angles[k], side)))
        edges += both((f"a{k}", ring[k]), numLanes=rng.randint(1, max(lanes, 2)), speed=rng.choice(SPEEDS), priority=3)
    members = " ".join(f"{ring[k]}_{ring[(k + 1) % arms]}" for k in range(arms))
    edges.append(element("roundabout", nodes=" ".join(ring), edges=members))
    return Roads((), {"nod": (*nodes,), "edg": (*edges,)}, (*turns(rng), *(("--lefthand",) if side < 0 else ())))


def crossing(rng: Random) -> Roads:
    """Return one or two crossings near each other, of any type; arms of any number of lanes, skew, bent."""
    kinds = ("traffic_light", "traffic_light", "priority", "right_before_left", "allway_stop", "priority_stop")
    arms, centres = rng.choice((3, 4, 4, 5)), ["m0", "m1"] if rng.random() < 0.5 else ["m0"]
    nodes, edges = [], []
    apart, speed = rng.uniform(25.0, 90.0), rng.choice(SPEEDS)
    for m, centre in enumerate(centres):
        kind, radius = rng.choice((*kinds, "unregulated")), rng.choice((None, 3, 10))
        nodes.append(node(centre, (m * apart, 0.0), type=kind, radius=radius))
        for k, angle in enumerate(_angles(rng, arms) if len(centres) == 1 else _arms_beside(rng, m)):
            x, y = _around(rng.uniform(120.0, 260.0), angle)
            nodes.append(node(f"a{m}{k}", (x + m * apart, y)))
            lanes, priority = rng.choice((1, 1, 2, 2, 3, 4)), rng.choice((3, 7))
            edges += both((f"a{m}{k}", centre), numLanes=lanes, speed=rng.choice((speed, *SPEEDS)), priority=priority)
    if len(centres) > 1:
        edges += both(("m0", "m1"), numLanes=rng.randint(1, 3), speed=speed, priority=7)
    return Roads((), {"nod": (*nodes,), "edg": (*edges,)}, turns(rng))


def _arms_beside(rng: Random, centre: int) -> list[float]:
    """Return the directions (rad) of two or three arms that lead away from the other of two crossings."""
    spread = rng.choice(((0.0, 0.8), (-0.7, 0.7), (0.8, 0.0, -0.8)))
    return [(0.0 if centre else math.pi) + 1.6 * share + rng.uniform(-0.2, 0.2) for share in spread]


def dual_carriageway(rng: Random) -> Roads:
    """Return the crossing of two roads whose carriageways lie apart: four junctions, joined into a large one or not."""
    gap, arm, lanes = rng.uniform(9.0, 24.0), rng.uniform(120.0, 250.0), rng.randint(1, 3)
    kind = rng.choice(("traffic_light", "priority", "priority_stop"))
    corners = {"sw": (0.0, 0.0), "se": (gap, 0.0), "ne": (gap, gap), "nw": (0.0, gap)}
    nodes = [node(name, place, type=kind) for name, place in corners.items()]
    ends = {
        "w": ("sw", "nw", (-arm, gap / 2)), "e": ("ne", "se", (gap + arm, gap / 2)),
        "s": ("se", "sw", (gap / 2, -arm)), "n": ("nw", "ne", (gap / 2, gap + arm)),
    }  # fmt: skip
    main, side = rng.choice(SPEEDS), rng.choice(SPEEDS)
    edges = []
    for name, (into, out_of, place) in ends.items():
        nodes.append(node(name, place))
        said = {"numLanes": lanes, "speed": main if name in "we" else side, "priority": 8 if name in "we" else 5}
        edges += [edge((name, into), **said), edge((out_of, name), **said)]
    for before, behind in (("sw", "se"), ("se", "ne"), ("ne", "nw"), ("nw", "sw")):
        edges.append(edge((before, behind), numLanes=lanes, speed=8.33, priority=7))
    join = ("--junctions.join", "--junctions.join-dist", "30") if rng.random() < 0.4 else ()
    return Roads((), {"nod": (*nodes,), "edg": (*edges,)}, (*turns(rng), "--tls.join", *join))


def bridge(rng: Random) -> Roads:
    """Return two roads that cross without a junction, with a height or without, and streets around."""
    reach, turn, height = rng.uniform(90.0, 220.0), rng.uniform(-0.5, 0.5), rng.choice((None, 6.0))
    corners = [_around(reach, k * math.pi / 2 + (turn if k % 2 else 0.0)) for k in range(4)]
    kind = rng.choice(("priority", "right_before_left", "traffic_light"))
    nodes = [node(f"c{k}", corners[k], type=kind, z=None if height is None else (k % 2) * height) for k in range(4)]
    fast, lanes = rng.choice(SPEEDS), rng.randint(1, 2)
    edges = []
    for ends in (("c0", "c2"), ("c1", "c3")):
        edges += both(ends, numLanes=lanes, speed=fast, priority=7)
    for k in range(4):
        x, y = corners[k]
        nodes.append(node(f"o{k}", (1.8 * x, 1.8 * y)))
        edges += both((f"o{k}", f"c{k}"), numLanes=lanes, speed=fast, priority=7)
        edges += both((f"c{k}", f"c{(k + 1) % 4}"), numLanes=1, speed=11.11, priority=3)
    return Roads((), {"nod": (*nodes,), "edg": (*edges,)}, turns(rng))
