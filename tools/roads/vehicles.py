"""Types of vehicles as real scenarios have them: sizes by class, and drivers of all tempers."""

from __future__ import annotations

from collections.abc import Mapping
from random import Random
from typing import NamedTuple

from roads.plain import element

Range = tuple[float, float]


class Sort(NamedTuple):
    """Vehicles of a class: how many of a hundred, and between what their measures lie (m, m/s²)."""

    vehicle_class: str
    share: float
    length: Range
    width: Range
    acceleration: Range
    max_speed: float = 55.0


SORTS = {
    "car": Sort("passenger", 70.0, (3.6, 5.3), (1.6, 2.0), (1.8, 3.5)),
    "van": Sort("delivery", 6.0, (5.2, 7.2), (1.9, 2.2), (1.5, 2.8)),
    "truck": Sort("truck", 5.0, (7.0, 12.0), (2.2, 2.55), (0.8, 1.5), 30.0),
    "trailer": Sort("trailer", 3.0, (13.0, 18.5), (2.4, 2.6), (0.7, 1.2), 28.0),
    "bus": Sort("bus", 6.0, (10.0, 18.0), (2.4, 2.55), (0.9, 1.4), 25.0),
    "motorcycle": Sort("motorcycle", 5.0, (1.9, 2.4), (0.7, 0.95), (3.0, 6.0)),
    "bicycle": Sort("bicycle", 5.0, (1.5, 1.9), (0.5, 0.7), (0.8, 1.4), 6.0),
}
"""By the word that the ids of their types and vehicles begin with."""

VARIANTS = 2
"""Types of each sort in a network."""


def vehicle_types(rng: Random, step_s: float, traits: frozenset[str]) -> list[str]:
    """Return some types of each sort, `sort0`, `sort1` …, for steps of this length (s)."""
    return [
        element("vType", id=f"{name}{k}", vClass=sort.vehicle_class, **_body(rng, sort), **_temper(rng, step_s, traits))
        for name, sort in SORTS.items()
        for k in range(VARIANTS)
    ]


def _body(rng: Random, sort: Sort) -> Mapping[str, object]:
    measures = {"length": sort.length, "width": sort.width, "accel": sort.acceleration}
    drawn: dict[str, object] = {name: round(rng.uniform(*limits), 2) for name, limits in measures.items()}
    return drawn | {"maxSpeed": sort.max_speed}


def _temper(rng: Random, step_s: float, traits: frozenset[str]) -> Mapping[str, object]:
    """Return how somebody drives: as SUMO's cars do, but for some of these."""
    mean, spread = rng.uniform(0.85, 1.15), rng.uniform(0.02, 0.15)
    others: dict[str, object] = {
        "tau": round(max(step_s, rng.uniform(0.6, 1.8)), 2),
        "sigma": round(rng.uniform(0.0, 0.9), 2),
        "speedFactor": f"normc({mean:.2f},{spread:.2f},0.6,1.4)",
        "minGap": round(rng.uniform(0.8, 3.0), 2),
        "decel": round(rng.uniform(3.5, 6.0), 2),
        "impatience": round(rng.uniform(0.0, 0.6), 2),
        "lcAssertive": round(rng.uniform(1.0, 3.0), 2),
        "lcCooperative": round(rng.uniform(0.0, 1.0), 2),
        "lcSpeedGain": round(rng.uniform(0.0, 3.0), 2),
        "lcStrategic": round(rng.uniform(0.3, 5.0), 2),
        "jmTimegapMinor": round(rng.uniform(0.7, 2.0), 2),
        "carFollowModel": rng.choice(("Krauss", "IDM", "EIDM", "KraussOrig1")),
    }
    drawn = {name: value for name, value in others.items() if rng.random() < (0.1 if name == "carFollowModel" else 0.3)}
    drawn.setdefault("tau", max(1.0, step_s))
    if "sublane" in traits:
        drawn |= {"minGapLat": round(rng.uniform(0.2, 0.8), 2), "lcPushy": round(rng.uniform(0.0, 0.6), 2)}
        drawn |= {"latAlignment": rng.choice(("center", "right", "compact", "arbitrary", "nice"))}
    if "opposite" in traits:
        drawn |= {"lcOpposite": round(rng.uniform(0.5, 3.0), 2)}
    return drawn
