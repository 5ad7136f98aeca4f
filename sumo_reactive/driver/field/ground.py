"""U over the ground: what it would be if the ego were elsewhere, headed along C at its speed (F&L 1991, §4, figure 4)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.field.demands import weights_of
from sumo_reactive.driver.field.foreseen_shadow import foreseen_potential, foreseen_shadows
from sumo_reactive.driver.field.shadow import corners_of
from sumo_reactive.driver.field.valley import least_to_static, valley_potential
from sumo_reactive.driver.geometry.curve import Curve, project_on_curve
from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan, Weights
from sumo_reactive.driver.nouns.record import GroundField
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.vehicle.limits import VehicleLimits

SOUGHT_M = 15.0
"""A place is looked for on C this far around where it would be if C were straight."""

AHEAD_M = np.arange(-6.0, 37.0)
"""Places before (negative: behind) the ego's front bumper at which U is recorded…"""

LEFT_M = np.arange(-6.0, 7.0)
"""…and to the left of it."""


class Ground(NamedTuple):
    """What the ego meets on the ground: C, where its front axle is on it (`s`, m) and its front bumper in the world (m),
    `boxes` (n, 6 or more) of the others, `static` (k, 2) points, its speed (m/s), its limits and the `weights` in force."""

    curve: Curve
    s: float
    front: tuple[float, float]
    boxes: Floats
    static: Floats
    speed: float
    weights: Weights
    limits: VehicleLimits

    def potentials(self, x: Floats, y: Floats) -> Floats:
        """Return w₁U₁ + w₂U₂ with the ego's middle at each of the places (n,), m; NaN where it would touch somebody."""
        corners = corners_of(self.boxes)
        return np.array([self._at(*place, corners) for place in zip(x.tolist(), y.tolist(), strict=True)])

    def _at(self, x: float, y: float, corners: Floats) -> float:
        curve, limits, p = self.curve, self.limits, self.limits.parameters
        heading = curve.at(self.s)[2]
        ahead = (x - self.front[0]) * math.cos(heading) + (y - self.front[1]) * math.sin(heading)
        s, _ = project_on_curve(x, y, curve.x, curve.y, curve.step, self.s + ahead, SOUGHT_M)
        heading = curve.at(s)[2]
        for k, box in enumerate(self.boxes):
            if boxes_overlap(x, y, heading, limits.length, limits.width, *corners[k, 5], *box[[2, 4, 5]]):
                return math.nan
        axle = 0.5 * limits.length - limits.front_overhang
        fx, fy = x + axle * math.cos(heading), y + axle * math.sin(heading)
        at, d = project_on_curve(fx, fy, curve.x, curve.y, curve.step, s, SOUGHT_M)
        half, behind = 0.5 * limits.width, limits.length - limits.front_overhang
        left, right = least_to_static(
            self.static, curve.x, curve.y, curve.heading, curve.step, at, half, limits.front_overhang, behind
        )
        u1 = valley_potential(abs(d), min(left - d, right + d), p.valley_attraction, p.valley_repulsion)
        room = np.full(2, np.inf)
        shadows = foreseen_shadows(
            self.boxes, self.speed, half, limits.front_overhang, behind, curve.x, curve.y, curve.heading, curve.step, at,
            room, p.shadow_scale, p.clearance_m,
        )  # fmt: skip
        u2 = foreseen_potential(shadows, d, np.full(2, np.inf), p.clearance_m)
        return float(self.weights.valley * u1 + self.weights.shadow * u2)


def ground_field(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits) -> GroundField:
    """Return w₁U₁ + w₂U₂ over the ground around the ego, its front bumper at the origin."""
    pose = snapshot.ego.pose
    x, y = pose.ahead(limits.front_to_rear_axle)
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    ahead, left = (grid.ravel() for grid in np.meshgrid(AHEAD_M, LEFT_M, indexing="ij"))
    ground = Ground(
        completed.plan.curve, snapshot.s, (x, y), snapshot.boxes, snapshot.static, snapshot.ego.speed,
        weights_of(completed, limits.parameters), limits,
    )  # fmt: skip
    found = ground.potentials(x + ahead * c - left * s, y + ahead * s + left * c)
    return GroundField(x, y, pose.heading, AHEAD_M, LEFT_M, found.reshape(len(AHEAD_M), len(LEFT_M)))
