"""Where the others' shadows R_D lie: what their foreseen motion covers until the ego meets them (F&L 1991, §3.3.2)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from sumo_reactive.driver.field.demands import weights_of
from sumo_reactive.driver.field.foreseen_shadow import DRIFT_S, foreseen_shadows
from sumo_reactive.driver.geometry.curve import Curve, project_on_curve
from sumo_reactive.driver.geometry.polyline import Floats, wrapped
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan
from sumo_reactive.driver.nouns.record import CastShadow
from sumo_reactive.driver.nouns.snapshot import NEAR_M, Snapshot
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.vehicle.limits import VehicleLimits

CORNERS_APART_M = 2.0
"""The sides of an outline have a corner so often."""


def cast_shadows(
    snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, users: Iterable[RoadUser]
) -> tuple[CastShadow, ...]:
    """Return the shadow of each body that casts U₂ on the ego in a step; `users` are those observed before it."""
    if weights_of(completed, limits.parameters).shadow <= 0.0:
        return ()
    ids = {(user.x, user.y): user.id for user in users}
    return tuple(_cast(snapshot, completed.plan.curve, limits, ids))


def _cast(
    snapshot: Snapshot, curve: Curve, limits: VehicleLimits, ids: dict[tuple[float, float], str]
) -> Iterator[CastShadow]:
    p, half = limits.parameters, 0.5 * limits.width
    ahead, behind, speed = limits.front_overhang, limits.length - limits.front_overhang, snapshot.ego.speed
    for k in range(len(snapshot.boxes)):
        found = foreseen_shadows(
            snapshot.boxes[k : k + 1], speed, half, ahead, behind, curve.x, curve.y, curve.heading, curve.step, snapshot.s,
            np.full(2, np.inf), p.shadow_scale, p.clearance_m,
        )  # fmt: skip
        if len(found):
            box = snapshot.boxes[k]
            outline = _covered(box, curve, snapshot.s, ahead, speed)
            yield CastShadow(ids.get((float(box[0]), float(box[1])), ""), float(found[0, 2]), outline)


def _covered(box: Floats, curve: Curve, s: float, ahead: float, speed: float) -> Floats:
    """Return the outline (n, 2), m, of what a body covers along C until an ego with its front axle at `s` meets it.

    As foreseen for U₂, it keeps its speed along C, and what it moves aside for a while.
    """
    x, y, heading, own, length, width = box[:6].tolist()
    x, y = x - 0.5 * length * math.cos(heading), y - 0.5 * length * math.sin(heading)
    at, left = project_on_curve(x, y, curve.x, curve.y, curve.step, s, NEAR_M)
    angle = wrapped(heading - curve.heading_at(at))
    along, across = own * math.cos(angle), own * math.sin(angle)
    reach = 0.5 * (length * abs(math.cos(angle)) + width * abs(math.sin(angle)))
    beside = 0.5 * (width * abs(math.cos(angle)) + length * abs(math.sin(angle)))
    meets = max(at - reach - s - ahead, 0.0) / max(speed - along, 0.1)
    way, aside = along * meets, across * min(meets, DRIFT_S)
    first, last = at + min(way, 0.0) - reach, at + max(way, 0.0) + reach
    places = np.linspace(first, last, 2 + int((last - first) / CORNERS_APART_M))
    share = (places - first) / (last - first)
    middles = left + aside * (share if way >= 0.0 else 1.0 - share)
    sides = [_beside(curve, places, middles + side) for side in (beside, -beside)]
    return np.concatenate([sides[0], sides[1][::-1]])


def _beside(curve: Curve, places: Floats, left: Floats) -> Floats:
    """Return the points (n, 2), m, that lie so far (m) to the left of places on C."""
    found = ((*curve.at(s), d) for s, d in zip(places.tolist(), left.tolist(), strict=True))
    return np.array([(x - d * math.sin(heading), y + d * math.cos(heading)) for x, y, heading, d in found])
