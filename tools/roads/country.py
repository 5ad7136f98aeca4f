"""Roads between junctions, made by hand, whose measures are drawn at random: motorways, roads that lose lanes or wind."""

from __future__ import annotations

import math
from random import Random

from roads.cities import turns
from roads.plain import Roads, both, edge, joined, node


def ramps(rng: Random) -> Roads:
    """Return a motorway with a way on, whose lane ends after a while, and a way off."""
    lanes, fast, slow = rng.randint(1, 3), rng.uniform(22.0, 36.0), rng.uniform(13.0, 22.0)
    x = [0.0, rng.uniform(250.0, 500.0)]
    for length in (rng.uniform(100.0, 300.0), rng.uniform(200.0, 500.0), rng.uniform(100.0, 250.0), 400.0):
        x.append(x[-1] + length)
    kind = rng.choice(("priority", "priority", "zipper"))
    places = {f"h{k}": (at, rng.uniform(-10.0, 10.0)) for k, at in enumerate(x)}
    places |= {"on": (x[1] - 180.0, -60.0), "off": (x[4] + 180.0, -60.0)}
    nodes = [node(name, place, type=kind if name == "h2" else "priority") for name, place in places.items()]
    widths = (lanes, lanes + 1, lanes, lanes + 1, lanes)
    road = [(f"h{k}", f"h{k + 1}") for k in range(5)]
    edges = [edge(road[k], numLanes=widths[k], speed=fast, priority=10) for k in range(5)]
    edges += [edge(ends, numLanes=1, speed=slow, priority=5) for ends in (("on", "h1"), ("h4", "off"))]
    through = [(k, k + 1) for k in range(lanes)]
    narrow = [(k + 1, k) for k in range(lanes)]
    links = [*joined("h0_h1", "h1_h2", through), *joined("on_h1", "h1_h2", [(0, 0)])]
    links += joined("h1_h2", "h2_h3", [*narrow, (0, 0)])
    links += [*joined("h2_h3", "h3_h4", [*through, (0, 0)]), *joined("h3_h4", "h4_h5", narrow)]
    links += joined("h3_h4", "h4_off", [(0, 0)])
    return Roads((), {"nod": (*nodes,), "edg": (*edges,), "con": (*links,)})


def weaving(rng: Random) -> Roads:
    """Return two roads that run together for a while: who came from one may go to the other."""
    left, right, fast = rng.randint(1, 3), rng.randint(1, 2), rng.uniform(16.0, 30.0)
    length, lanes = rng.uniform(120.0, 350.0), left + right
    places = {"l0": (-350.0, 40.0), "r0": (-350.0, -40.0), "a": (0.0, 0.0), "b": (length, 0.0)}
    places |= {"l1": (length + 350.0, 40.0), "r1": (length + 350.0, -40.0)}
    edges = [edge((f"{name}0", "a"), numLanes=n, speed=fast, priority=7) for name, n in (("l", left), ("r", right))]
    edges += [edge(("b", f"{name}1"), numLanes=n, speed=fast, priority=7) for name, n in (("l", left), ("r", right))]
    edges.append(edge(("a", "b"), numLanes=lanes, speed=fast, priority=7))
    on_right, on_left = [(k, k) for k in range(right)], [(k, right + k) for k in range(left)]
    links = [*joined("r0_a", "a_b", on_right), *joined("l0_a", "a_b", on_left)]
    links += [*joined("a_b", "b_r1", on_right), *joined("a_b", "b_l1", [(b, a) for a, b in on_left])]
    nodes = tuple(node(name, place) for name, place in places.items())
    return Roads((), {"nod": nodes, "edg": (*edges,), "con": (*links,)})


def lane_drop(rng: Random) -> Roads:
    """Return a road that loses its lanes and wins them again, between crossings."""
    widths = [rng.randint(2, 4)]
    for _ in range(rng.randint(2, 4)):
        widths.append(max(1, min(4, widths[-1] + rng.choice((-1, -1, 1)))))
    nodes, edges, x = [node("n0", (0.0, 0.0))], [], 0.0
    speed = rng.choice((13.89, 22.22, 27.78))
    for k, lanes in enumerate(widths):
        x += rng.uniform(120.0, 300.0)
        kind = rng.choice(("priority", "priority", "zipper", "traffic_light"))
        nodes.append(node(f"n{k + 1}", (x, rng.uniform(-30.0, 30.0)), type=kind))
        edges.append(edge((f"n{k}", f"n{k + 1}"), numLanes=lanes, speed=speed, priority=7))
        if rng.random() < 0.5:
            nodes.append(node(f"s{k}", (x + rng.uniform(-40.0, 40.0), -120.0)))
            edges += both((f"s{k}", f"n{k + 1}"), numLanes=1, speed=11.11, priority=3)
    nodes.append(node("out", (x + 200.0, 0.0)))
    edges.append(edge((f"n{len(widths)}", "out"), numLanes=widths[-1], speed=speed, priority=7))
    return Roads((), {"nod": (*nodes,), "edg": (*edges,)}, turns(rng))


def winding(rng: Random) -> Roads:
    """Return a road of bends through the country, one lane each way, with side roads; who overtakes meets the others."""
    nodes, edges, place = [node("n0", (0.0, 0.0))], [], (0.0, 0.0)
    speed = rng.choice((13.89, 19.44, 25.0))
    for k in range(rng.randint(2, 5)):
        length, swing, waves = rng.uniform(150.0, 450.0), rng.uniform(-0.12, 0.12), rng.choice((0.5, 1.0, 1.5))
        bend = [
            (place[0] + length * t, place[1] + length * swing * math.sin(2.0 * math.pi * waves * t)) for t in _shares(12)
        ]
        ends, place = (f"n{k}", f"n{k + 1}"), bend[-1]
        for way, line in ((ends, bend), (ends[::-1], bend[::-1])):
            shape = " ".join(f"{x:.2f},{y:.2f}" for x, y in line)
            edges.append(edge(way, numLanes=1, speed=speed, priority=7, shape=shape))
        nodes.append(node(ends[1], place, type="priority"))
        nodes.append(node(f"s{k}", (place[0] + rng.uniform(-60.0, 60.0), place[1] + rng.choice((-140.0, 140.0)))))
        edges += both((f"s{k}", ends[1]), numLanes=1, speed=13.89, priority=3)
    options = (*turns(rng), "--opposites.guess", "--opposites.guess.fix-lengths")
    return Roads((), {"nod": (*nodes,), "edg": (*edges,)}, options)


def _shares(number: int) -> list[float]:
    return [k / number for k in range(number + 1)]
