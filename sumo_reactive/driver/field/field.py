"""The potential field over the command space: one compiled pass over all commands (F&L 1991, §3.2, §3.3)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.field.collision import braking_collides
from sumo_reactive.driver.field.foreseen_shadow import foreseen_potential, foreseen_shadows
from sumo_reactive.driver.field.shadow import corners_of, shadow_sum
from sumo_reactive.driver.field.valley import least_to_static, valley_potential
from sumo_reactive.driver.field.valley_map import map_potential
from sumo_reactive.driver.field.velocity import velocity_potential
from sumo_reactive.driver.geometry.curve import project_on_curve
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.vehicle.bicycle import advance_pose

SHADOW_HORIZON_M = 40.0
"""Obstacles farther away cast no potential."""

MIN_LOOK_AHEAD_M = 0.6
"""F is looked at no nearer than this ahead, so that a standing car knows where to steer."""

COLLISION_STEP_S = 0.1
"""Time between tested footprints."""


ADMISSIBLE, EMERGENCY, NO_COMMAND = 0, 1, 2

_HARDER = 1e9
"""More than any U: a command that brakes harder than it should is chosen when no milder one is admissible."""

_WINDOW_M = 2.0

HOLD_PARTS = 5
"""Parts in which a held command is driven."""

MAP_STEERINGS = 2
"""Further steerings that U₁ of the bitmaps looks ahead: 1 s at δt = 0.5 s, a turn's entry."""

HARSH_FROM = 0.1
"""m/s; braking below the desired speed by more than this in one period…"""

HARSHNESS = 20.0
"""…counts so many times: it is for stopping in time, not for keeping to C."""

MIN_MAP_SPEED = 2.0
"""m/s; …driven at least so fast, so that a standing car knows where to steer and may start beside C."""


ALPHA, BETA, K0, CLEARANCE, AHEAD_S, AHEAD_GROWTH, TESTED_S = range(7)
"""Places in `driver` (7) of α (1/m), β, k₀ (s), the room beside others (m), the look-ahead (s, s²/m), and of how far
footprints are tested (s)."""


@kept(1)
def driver_of(parameters: Parameters) -> Floats:
    """Return what the kernels read of the driver's parameters, (7,): an array is the cheapest to hand over."""
    p = parameters
    read = (
        p.valley_attraction, p.valley_repulsion, p.shadow_scale, p.clearance_m, p.look_ahead_s, p.look_ahead_growth,
        p.collision_horizon_s,
    )  # fmt: skip
    return np.array(read)


@kernel
def look_ahead(speed: float, driver: Floats) -> float:
    """Return the way (m) after which F is looked at, at `speed` (m/s)."""
    return float(max(speed * (driver[AHEAD_S] + driver[AHEAD_GROWTH] * speed), MIN_LOOK_AHEAD_M))


@kernel
def leads_to(
    x: float, y: float, heading: float, speed: float, angle: float, wheelbase: float, period: float,
    cx: Floats, cy: Floats, ch: Floats, step: float, s: float, driver: Floats,
) -> float:  # fmt: skip
    """Return how far to the left of C (m) F will be a look-ahead after a pose if its velocity keeps the angle to C that it
    has in the middle of the period: zero for a car that follows C, whatever the curvature."""
    fx, fy = x + wheelbase * math.cos(heading), y + wheelbase * math.sin(heading)
    at, d = project_on_curve(fx, fy, cx, cy, step, s + speed * period, _WINDOW_M)
    u = (at - 0.5 * speed * period) / step
    i = min(max(int(u), 0), len(ch) - 2)
    along = ch[i] + min(max(u - i, 0.0), 1.0) * (ch[i + 1] - ch[i])
    turned = 0.5 * speed * math.sin(angle) / wheelbase * period
    return d + look_ahead(speed, driver) * math.sin(heading - turned + angle - along)


@kernel
def ramped(
    x: float, y: float, heading: float, speed: float, angle: float, to_speed: float, to_angle: float, wheelbase: float,
    period: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the pose after `period` s in which speed (m/s) and steering angle (rad) change as the held command does."""
    for part in range(1, HOLD_PARTS + 1):
        share = part / HOLD_PARTS
        v, w = speed + share * (to_speed - speed), angle + share * (to_angle - angle)
        x, y, heading = advance_pose(x, y, heading, v, w, wheelbase, period / HOLD_PARTS)
    return x, y, heading


@kernel
def mapped_valley(
    x: float, y: float, heading: float, speed: float, angle: float, turn: float, limits: Floats, period: float,
    bitmaps: Floats, x0: float, y0: float, cell: float,
) -> float:  # fmt: skip
    """U₁ of a pose on the `bitmaps` of F and R: the least that MAP_STEERINGS further periods at `speed` can reach.

    Each adds −`turn`, 0 or +`turn` rad to the steering angle, within the limits; holding it always is. Reading: a distance
    without its direction does not damp, so U₁ is looked up where the nine commands themselves can lead.
    """
    least = np.inf
    for path in range(3**MAP_STEERINGS):  # no recursion: a recursive kernel crashes when it comes from the disk cache
        qx, qy, qh, now, left, allowed = x, y, heading, angle, path, True
        for _ in range(MAP_STEERINGS):
            after = now + (left % 3 - 1) * turn
            left //= 3
            lateral = abs(speed * speed * math.sin(after) / limits[0])
            allowed = allowed and abs(after) <= limits[5] + 1e-9 and lateral <= max(limits[6], limits[8])
            qx, qy, qh = ramped(qx, qy, qh, speed, now, speed, after, limits[0], period)
            now = after
        if allowed:
            fx, fy = qx + limits[0] * math.cos(qh), qy + limits[0] * math.sin(qh)
            front = map_potential(bitmaps[0], fx, fy, x0, y0, cell)
            least = min(least, max(front, map_potential(bitmaps[1], qx, qy, x0, y0, cell)))
    return least


@kernel
def expand(
    state: Floats, accelerations: Floats, rates: Floats, limits: Floats, period: float, room: float, out: Floats
) -> None:
    """Fill `out` (a·w, 4) with speed, angle, kinematically allowed, stops in time.

    `state` (5): x, y, heading, speed, angle. `limits` (9): wheelbase, to front, length, width, top speed, φmax, lateral
    limit, emergency deceleration, present lateral acceleration. `room`: way left to a stop, m.
    """
    for j in range(len(rates)):
        angle = state[4] + rates[j] * period
        turn, within = math.sin(angle), abs(angle) <= limits[5] + 1e-9
        for i in range(len(accelerations)):
            v = min(max(0.0, state[3] + accelerations[i] * period), max(limits[4], state[3]))
            stops = v * period + v * v / (2.0 * limits[7]) <= room or v == 0.0
            lateral = max(v, state[3]) * v * turn / limits[0]  # braking, it is faster at first than in the end
            allowed = within and abs(lateral) <= max(limits[6], limits[8])
            q = out[i * len(rates) + j]
            q[0], q[1], q[2], q[3] = v, angle, 1.0 if allowed else 0.0, 1.0 if stops else 0.0


@kernel
def valley_of_command(
    state: Floats, pose: tuple[float, float, float], speed: float, angle: float, turn: float, limits: Floats, period: float,
    cx: Floats, cy: Floats, ch: Floats, step: float, s: float, sides: Floats,
    bitmaps: Floats, x0: float, y0: float, cell: float, driver: Floats,
) -> tuple[float, float]:  # fmt: skip
    """Return U₁ of the command that leads from `state` (5) to `pose`, `speed` (m/s) and steering `angle` (rad) within the
    period, and how far to the left of C (m) it leads, which the bitmaps do not tell.

    `turn`: what the steering angle can change by in a period, rad. `sides` (4), m: room to lean to the left and right, way
    from the body on C to O_S on the left and right.
    """
    if len(bitmaps) == 0:
        d = leads_to(pose[0], pose[1], pose[2], speed, angle, limits[0], period, cx, cy, ch, step, s, driver)
        return valley_potential(abs(d), min(sides[2] - d, sides[3] + d), driver[ALPHA], driver[BETA]), d
    x, y, heading = ramped(state[0], state[1], state[2], state[3], state[4], speed, angle, limits[0], period)
    v = max(speed, MIN_MAP_SPEED)
    return mapped_valley(x, y, heading, v, angle, turn, limits, period, bitmaps, x0, y0, cell), 0.0


MIDDLE = 2
"""Place of the command that a finer lattice lies around, of five along one axis."""

WHOLE = 3
"""What a command has grown to of which nothing is due."""


class Chosen(NamedTuple):
    """A chosen command: ADMISSIBLE, EMERGENCY or NO_COMMAND, the `cost` that it was chosen by, U₁, U₂, U₃, and x, y,
    heading, speed, steering angle where it leads."""

    verdict: int
    cost: float
    valley: float
    shadow: float
    velocity: float
    x: float
    y: float
    heading: float
    speed: float
    angle: float


@kernel
def nothing_known() -> Chosen:
    """Return what is known of a command of which nothing is."""
    return Chosen(NO_COMMAND, np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def best_of(
    known: Chosen, car: Floats, accelerations: Floats, rates: Floats, fine: bool, turn: float, period: float, room: float,
    wanted: float, lowest: float, cx: Floats, cy: Floats, ch: Floats, step: float, s: float, sides: Floats,
    bitmaps: Floats, x0: float, y0: float, cell: float, boxes: Floats, corners: Floats, shadows: Floats, driver: Floats,
) -> tuple[int, Chosen]:  # fmt: skip
    """Return the chosen command with its place in the lattice: that with the least U = w₁U₁ + w₂U₂ + w₃U₃ among those that
    break no kinematic limit, leave a way to stop and touch no predicted footprint.

    One that brakes below `lowest` m/s is an emergency: the least U decides among them when no other is left. When there is
    none at all, it is the hardest brake with the least U₁, the wheels held if none of these keeps the limits. `car` (17)
    holds the state (5), the limits (9), see `expand`, and w₁, w₂, w₃; `boxes` (n, 8) are tested for contact and, on
    bitmaps, cast U₂; else `shadows` (n, 3) do. `sides` (4): see `valley_of_command`.

    No term is negative, so U₁ and U₂ are due only for what would win without them: of each command U grows term by term
    until the least one is whole. That of the command in the MIDDLE is `known` already, unless it is NO_COMMAND.
    """
    state, limits, weights = car[:5], car[5:14], car[14:]
    n = len(accelerations) * len(rates)
    ahead = np.empty((n, 4))
    expand(state, accelerations, rates, limits, period, room, ahead)
    terms, places = np.zeros((n, 4)), np.empty((n, 4))
    total, grown = np.full(n, np.inf), np.zeros(n, dtype=np.int64)
    for k in range(n):
        v, _, allowed, stops = ahead[k]
        if allowed == 0.0:
            continue
        terms[k, 2] = velocity_potential(v, wanted)
        harsh = max(0.0, wanted - v - HARSH_FROM) if fine else 0.0
        terms[k, 3] = weights[2] * (terms[k, 2] + HARSHNESS * harsh)
        if stops > 0.0:
            total[k] = terms[k, 3] + (_HARDER if v < lowest - 1e-6 else 0.0)
    if known.verdict != NO_COMMAND:
        total[MIDDLE], grown[MIDDLE] = known.cost, WHOLE
    is_mapped = len(bitmaps) > 0
    casts = weights[1] > 0.0 and (len(boxes) if is_mapped else len(shadows)) > 0
    while True:
        best = int(np.argmin(total))
        if total[best] == np.inf:
            break
        v, angle = ahead[best, 0], ahead[best, 1]
        x, y, h, leads = places[best, 0], places[best, 1], places[best, 2], places[best, 3]
        if grown[best] == WHOLE:
            return best, known
        if grown[best] == 0:
            x, y, h = advance_pose(state[0], state[1], state[2], v, angle, limits[0], period)
            terms[best, 0], leads = valley_of_command(
                state, (x, y, h), v, angle, turn, limits, period, cx, cy, ch, step, s, sides, bitmaps, x0, y0, cell, driver
            )
            places[best, 0], places[best, 1], places[best, 2], places[best, 3] = x, y, h, leads
            total[best] = weights[0] * terms[best, 0] + terms[best, 3] + (_HARDER if v < lowest - 1e-6 else 0.0)
            grown[best] = 1
        elif grown[best] == 1 and casts:
            terms[best, 1] = (
                shadow_sum(
                    x, y, h, v, limits[1], limits[2] - limits[1], limits[3], boxes, corners, driver[K0], SHADOW_HORIZON_M
                )
                if is_mapped
                else foreseen_potential(shadows, leads, sides, driver[CLEARANCE])
            )
            total[best] += weights[1] * terms[best, 1]
            grown[best] = 2
        elif braking_collides(
            x, y, h, v, angle, limits[0], limits[1], limits[2], limits[3], limits[7], boxes, period, driver[TESTED_S],
            COLLISION_STEP_S,
        ):  # fmt: skip
            total[best] = np.inf
        else:
            verdict = EMERGENCY if v < lowest - 1e-6 else ADMISSIBLE
            return best, Chosen(verdict, total[best], terms[best, 0], terms[best, 1], terms[best, 2], x, y, h, v, angle)
    hardest = int(np.argmin(accelerations))
    fallback, least = -1, np.inf
    for k in range(hardest * len(rates), (hardest + 1) * len(rates)):
        v, angle, allowed, _ = ahead[k]
        if allowed == 0.0:
            continue
        pose = advance_pose(state[0], state[1], state[2], v, angle, limits[0], period)
        terms[k, 0], _ = valley_of_command(
            state, pose, v, angle, turn, limits, period, cx, cy, ch, step, s, sides, bitmaps, x0, y0, cell, driver
        )
        if terms[k, 0] < least:
            fallback, least = k, terms[k, 0]
    if fallback < 0:
        fallback = hardest * len(rates) + int(np.argmin(np.abs(rates)))
        terms[fallback, 0] = 0.0
    v, angle = ahead[fallback, 0], ahead[fallback, 1]
    x, y, h = advance_pose(state[0], state[1], state[2], v, angle, limits[0], period)
    u1, u2, u3 = terms[fallback, 0], terms[fallback, 1], terms[fallback, 2]
    return fallback, Chosen(NO_COMMAND, np.inf, u1, u2, u3, x, y, h, v, angle)


@kernel
def room_and_shadows(
    car: Floats, cx: Floats, cy: Floats, ch: Floats, step: float, s: float, static: Floats, boxes: Floats,
    left: float, right: float, driver: Floats,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return the `sides` (4) of C that `valley_of_command` takes, and the foreseen shadows (n, 3) of `boxes` on it."""
    half, front, behind = 0.5 * car[8], car[6] - car[5], car[7] - car[6] + car[5]
    sides, shadows = np.array((left, right, np.inf, np.inf)), np.empty((0, 3))
    sides[2], sides[3] = least_to_static(static, cx, cy, ch, step, s, half, front + look_ahead(car[3], driver), behind)
    if len(boxes) > 0 and car[15] > 0.0:
        shadows = foreseen_shadows(
            boxes, car[3], half, front, behind, cx, cy, ch, step, s, sides, driver[K0], driver[CLEARANCE]
        )
    return sides, shadows


@kernel
def potentials_over(
    car: Floats, accelerations: Floats, rates: Floats, period: float, room: float, wanted: float, lowest: float,
    cx: Floats, cy: Floats, ch: Floats, step: float, s: float, static: Floats, bitmaps: Floats, boxes: Floats,
    left: float, right: float, driver: Floats,
) -> Floats:  # fmt: skip
    """Return U (a, w) of each command of the lattice `accelerations` × `rates` as if there were no other, infinite where it
    is not admissible. The arguments are those of `choose_command`; `bitmaps`: none."""
    sides, shadows = room_and_shadows(car, cx, cy, ch, step, s, static, boxes, left, right, driver)
    corners, fine = np.empty((0, 6, 2)), len(bitmaps) > 0  # never: but a literal False would compile another `best_of`
    known = nothing_known()
    potentials = np.full((len(accelerations), len(rates)), np.inf)
    for i in range(len(accelerations)):
        for j in range(len(rates)):
            _, one = best_of(
                known, car, accelerations[i : i + 1], rates[j : j + 1], fine, rates[j] * period, period, room, wanted,
                lowest, cx, cy, ch, step, s, sides, bitmaps, 0.0, 0.0, 1.0, boxes, corners, shadows, driver,
            )  # fmt: skip
            if one.verdict != NO_COMMAND:
                potentials[i, j] = car[14] * one.valley + car[15] * one.shadow + car[16] * one.velocity
    return potentials


@kernel
def choose_command(
    car: Floats, accelerations: Floats, rates: Floats, rounds: int, period: float, room: float, wanted: float, lowest: float,
    cx: Floats, cy: Floats, ch: Floats, step: float, s: float, static: Floats,
    bitmaps: Floats, x0: float, y0: float, cell: float, boxes: Floats, left: float, right: float,
    driver: Floats,
) -> tuple[float, float, Chosen]:  # fmt: skip
    """Return acceleration, steering rate and the rest of the chosen command.

    The command with the least U = w₁U₁ + w₂U₂ + w₃U₃ of the lattice `accelerations` × `rates`, then of ever finer lattices
    around it, `rounds` times. `car` (17) holds the state (5), the limits (9), see `expand`, and w₁, w₂, w₃; `boxes` (n, 8)
    cast U₂ and are tested for contact. The ego may lean `left` and `right` (m) of C. `driver` (7): see `driver_of`.
    """
    turn, corners = rates[-1] * period, np.empty((0, 6, 2))
    if len(bitmaps) > 0:
        corners, sides, shadows = corners_of(boxes), np.array((left, right, np.inf, np.inf)), np.empty((0, 3))
    else:
        sides, shadows = room_and_shadows(car, cx, cy, ch, step, s, static, boxes, left, right, driver)
    index, best = best_of(
        nothing_known(), car, accelerations, rates, rounds > 0, turn, period, room, wanted, lowest, cx, cy, ch, step, s,
        sides, bitmaps, x0, y0, cell, boxes, corners, shadows, driver,
    )  # fmt: skip
    i, j = index // len(rates), index % len(rates)
    for half in range(2 * rounds):
        if half % 2 == 0:
            rates, j = around(rates, j), MIDDLE
        else:
            accelerations, i = around(accelerations, i), MIDDLE
        steers = half % 2 == 0
        index, best = best_of(
            best, car, accelerations[i : i + 1] if steers else accelerations, rates if steers else rates[j : j + 1],
            rounds > 0, turn, period, room, wanted, lowest, cx, cy, ch, step, s, sides, bitmaps, x0, y0, cell, boxes,
            corners, shadows, driver,
        )  # fmt: skip
        if steers:
            j = index
        else:
            i = index
    return accelerations[i], rates[j], best


@kernel
def around(axis: Floats, i: int) -> Floats:
    """Return five nodes around node `i` of a rising `axis`, its gaps to the neighbours divided by three."""
    down = (axis[i] - axis[i - 1]) / 3.0 if i > 0 else 0.0
    up = (axis[i + 1] - axis[i]) / 3.0 if i + 1 < len(axis) else 0.0
    return np.array([axis[i] - 2.0 * down, axis[i] - down, axis[i], axis[i] + up, axis[i] + 2.0 * up])
