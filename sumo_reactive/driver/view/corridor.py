"""The corridor that the ego will sweep along C: which bodies reach into it, and where it covers the lane beside."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.geometry.swept import swept_sides
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import NEAR_M, OffTracking
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph

TURN_FORESEEN_S = 0.7
"""The others' turning is taken over this time, along their lanes: for as long as footprints are tested."""

OFF_TRACKING_M = 0.6
"""A body that covers the lane beside by more than this in a bend is shown there: SUMO's cars, in the middle of 3.2 m, leave
0.7 m."""

OFF_TRACKING_SIGHT_M = 60.0
"""So far ahead the driver looks for a place where the body will cut into the lane beside: enough to stop in town."""

SPEED_GAINED = 2.0
"""m/s; no command adds more to the ego's speed."""
WIDTHS_M = 5.0
"""m; no two bodies are wider together."""
STRAIGHT = 0.02
"""Sine of the angle to C up to which the body counts as on it."""
BEHIND_SHARE = 0.5
"""Who is behind the rear axle by this share of the way to him stays behind the ego's middle, however it steers."""


class CorridorSides(NamedTuple):
    """How far the corridor reaches to the left and right of C at each sample (n,), and the farthest of all, m."""

    left: Floats
    right: Floats
    widest: float


@kept(PLANS_KEPT)
def band_of(curve: Curve, limits: VehicleLimits) -> CorridorSides:
    """Return the corridor that the body sweeps while the front axle follows C.

    In a bend the rear axle cuts the inside and the front bumper swings to the outside.
    """
    half, wheelbase = 0.5 * limits.width, limits.wheelbase
    bend = float(curve.curvature[: int(wheelbase / curve.step) + 1].mean())
    angle = math.asin(min(max(bend * wheelbase, -0.9), 0.9))  # as in a steady turn
    heading = float(curve.heading[0]) - angle
    sizes = wheelbase, limits.front_overhang
    sides = swept_sides(curve.x, curve.y, curve.heading, curve.step, heading, *sizes, STRAIGHT, 1.0)
    reach = np.max(sides, axis=(0, 2)), -np.min(sides, axis=(0, 2))  # between two samples as wide as at the wider one
    left, right = (half + maximum_filter1d(np.maximum(side, limits.parameters.corridor_margin_m), 3) for side in reach)
    return CorridorSides(left, right, float(max(left.max(), right.max())))


@kernel
def _cuts(px: float, py: float, tx: float, ty: float, half: float, box: Floats, c: float, s: float) -> bool:
    """Whether the cross-section of half-width `half` at a place of C meets a box (front x, y, heading, -, length, width).

    C runs along (tx, ty) there, the box along (c, s).
    """
    dx, dy = px - box[0] + 0.5 * box[4] * c, py - box[1] + 0.5 * box[4] * s
    turn_c, turn_s = abs(tx * c + ty * s), abs(ty * c - tx * s)
    if abs(dx * c + dy * s) > 0.5 * box[4] + half * turn_s:
        return False
    if abs(dy * c - dx * s) > 0.5 * box[5] + half * turn_c:
        return False
    return bool(abs(dx * tx + dy * ty) <= 0.5 * (box[4] * turn_c + box[5] * turn_s))


@kernel
def _first_touch(px: float, py: float, heading: float, box: Floats) -> float:
    """Least arc length, relative to a pose of C, at which a corner of the box lies (m)."""
    c, s = math.cos(box[2]), math.sin(box[2])
    tx, ty = math.cos(heading), math.sin(heading)
    middle = (box[0] - 0.5 * box[4] * c - px) * tx + (box[1] - 0.5 * box[4] * s - py) * ty
    return float(middle - 0.5 * (box[4] * abs(tx * c + ty * s) + box[5] * abs(ty * c - tx * s)))


@kernel
def near_boxes(
    boxes: Floats, x: float, y: float, heading: float, speed: float, length: float
) -> tuple[Floats, NDArray[np.int64]]:
    """Return those of `boxes` (n, 6) that are nearer than NEAR_M in |Δx| + |Δy|, (m, 8): with no turn rate and no end of
    their way; and which of them move and could touch an ego of `length` m within the time that turning is foreseen, (k, 2):
    their rows there and in `boxes`.

    The ego's rear axle is at (x, y), m. Who is behind it cannot: he has to look out himself.
    """
    c, s = math.cos(heading), math.sin(heading)
    near, touchable = np.zeros((len(boxes), 8)), np.empty((len(boxes), 2), dtype=np.int64)
    m = k = 0
    for i in range(len(boxes)):
        dx, dy = boxes[i, 0] - x, boxes[i, 1] - y
        away = abs(dx) + abs(dy)
        if not away < NEAR_M:
            continue
        for column in range(6):  # a slice would have numba compile the words of an error
            near[m, column] = boxes[i, column]
        near[m, 7] = np.inf
        if dx * c + dy * s > -BEHIND_SHARE * away and boxes[i, 3] > STANDING_SPEED:
            distance = math.hypot(dx, dy)
            leaving = boxes[i, 3] * (dx * math.cos(boxes[i, 2]) + dy * math.sin(boxes[i, 2])) / max(distance, 1e-3)
            way = max(speed + SPEED_GAINED - leaving, 0.0) * TURN_FORESEEN_S  # by which they can come nearer
            if distance - way < length + boxes[i, 4] + WIDTHS_M:
                touchable[k, 0], touchable[k, 1] = m, i
                k += 1
        m += 1
    return near[:m], touchable[:k]


@kernel
def blocking_ones(
    boxes: Floats, cx: Floats, cy: Floats, ch: Floats, step: float, start: float, end: float, left: Floats,
    right: Floats, widest: float,
) -> tuple[NDArray[np.int64], Floats]:  # fmt: skip
    """Return which of `boxes` (n, 6: front x, y, heading, speed, length, width) block a stretch of C (m,), and (m, 4): the
    first and last arc length that each blocks (m), its velocity along and across C (m/s).

    The search runs from `start` to `end` along C and leaps where the body is far. The corridor reaches `left` and `right`
    (m) of each sample, at most `widest`.
    """
    which, out, n = np.empty(len(boxes), dtype=np.int64), np.empty((len(boxes), 4)), 0
    low, high = max(0, int(start / step)), min(len(cx) - 1, int(end / step))
    for k in range(len(boxes)):
        box = boxes[k]
        c, s = math.cos(box[2]), math.sin(box[2])
        mx, my = box[0] - 0.5 * box[4] * c, box[1] - 0.5 * box[4] * s
        radius = 0.5 * math.hypot(box[4], box[5]) + widest
        i, blocks = low, False
        while i <= high:
            dx, dy = cx[i] - mx, cy[i] - my
            away = math.sqrt(dx * dx + dy * dy) - radius
            if away > step:
                i += int(away / step)
                continue
            half, shift = 0.5 * (left[i] + right[i]), 0.5 * (left[i] - right[i])
            tx, ty = math.cos(ch[i]), math.sin(ch[i])
            if _cuts(cx[i] - shift * ty, cy[i] + shift * tx, tx, ty, half, box, c, s):
                if not blocks:
                    blocks, which[n] = True, k
                    touch = min(max(_first_touch(cx[i], cy[i], ch[i], box), -step), 0.0)
                    out[n, 0] = i * step + (touch if i > low else 0.0)
                    out[n, 2], out[n, 3] = box[3] * math.cos(box[2] - ch[i]), box[3] * math.sin(box[2] - ch[i])
                out[n, 1] = i * step
            elif blocks:
                break
            i += 1
        n += blocks
    return which[:n], out[:n]


@kernel
def related(
    boxes: Floats, x: float, y: float, heading: float, speed: float, length: float,
    cx: Floats, cy: Floats, ch: Floats, step: float, start: float, end: float, left: Floats, right: Floats, widest: float,
) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64], Floats]:  # fmt: skip
    """Return what `near_boxes` and `blocking_ones` return of the same boxes, in one call: a step asks for both."""
    near, touchable = near_boxes(boxes, x, y, heading, speed, length)
    which, stretches = blocking_ones(boxes, cx, cy, ch, step, start, end, left, right, widest)
    return near, touchable, which, stretches


@kept(PLANS_KEPT)
def off_tracking_of(plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits) -> tuple[OffTracking, ...]:
    """Return where the body covers lanes beside its own while the front axle follows C, in order along C.

    Where C itself leads from lane to lane, or aside past somebody, it cuts into none.
    """
    curve, band, found = plan.curve, band_of(plan.curve, limits), []
    places, back = np.column_stack((curve.x, curve.y)), 0.0 if plan.aside is None else plan.aside.until
    for g in plan.segments:
        first, end = max(int(max(g.start, back) / curve.step) + 1, 0), min(int(g.end / curve.step), len(curve.x))
        if first >= end or any(change.start < g.end and change.end > g.start for change in plan.lane_changes):
            continue
        own = graph.lanes[g.lane_id]
        aside = own.spine.offsets(places[first:end])
        for left, reach in ((True, aside + band.left[first:end]), (False, band.right[first:end] - aside)):
            lane = lane_at_side(graph, g.lane_id, left)
            at = first + np.flatnonzero(reach > 0.5 * own.width + OFF_TRACKING_M)
            if lane is not None and len(at):
                runs = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
                ends = ((float(run[0]) * curve.step, float(run[-1]) * curve.step) for run in runs)
                found += [OffTracking(*stretch, left, lane.id) for stretch in ends]
    return tuple(sorted(found))


def next_off_tracking(places: tuple[OffTracking, ...], s: float, front: float) -> OffTracking | None:
    """Return the next of the `places` along C where the body covers the lane of a road that is in sight and not yet passed.

    `s`, `front`: arc length of front axle and front bumper on C, m.
    """
    for found in places:
        if found.start > front + OFF_TRACKING_SIGHT_M:
            break
        if found.end > s and not found.lane_id.startswith(":"):
            return found
    return None


def lane_at_side(graph: RoadGraph, lane_id: str, left: bool) -> Lane | None:
    """Return the lane directly left or right of a lane, inside a junction too."""
    lane = graph.lanes[lane_id]
    if not lane.is_internal:
        return graph.neighbours(lane_id)[0 if left else 1]
    index = lane.index + (1 if left != graph.left_hand else -1)
    return graph.lanes.get(f"{lane.edge_id}_{index}")
