"""Parts of the controller exchanged: a rule beside the pilot's, a pilot around the pilot, an executor of one's own.

    sumo-reactive run my.sumocfg --driver sumo_reactive_examples.own_parts:ROOM_FOR_CYCLISTS
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from sumo_reactive.driver.controller import Parts
from sumo_reactive.driver.field.desired_speed import desired_speed
from sumo_reactive.driver.field.executor import NO_POTENTIALS, Execution
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stay_behind
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.driver.nouns.traffic import TWO_WHEELER_WIDTH_M
from sumo_reactive.driver.pilot.pilot import decide
from sumo_reactive.driver.vehicle.bicycle import advance
from sumo_reactive.driver.vehicle.limits import VehicleLimits

ROOM_M, AHEAD_M = 1.0, 40.0
BRAKING_M_S2 = 5.0
"""A cyclist's at the hardest."""


def room_for_cyclists(snapshot: Snapshot, limits: VehicleLimits) -> Iterator[TimeConstraint]:
    """Pass nobody on two wheels with less than a metre of room: stay behind him."""
    pose = snapshot.ego.pose
    x, y = pose.ahead(limits.front_to_rear_axle)
    for bx, by, heading, speed, length, width, *_ in snapshot.boxes:
        along = (bx - x) * math.cos(pose.heading) + (by - y) * math.sin(pose.heading)
        aside = abs((by - y) * math.cos(pose.heading) - (bx - x) * math.sin(pose.heading))
        rear, room = along - length, aside - 0.5 * (width + limits.width)
        goes_along = math.cos(heading - pose.heading) > 0.5
        if width < TWO_WHEELER_WIDTH_M and goes_along and 0.0 < rear < AHEAD_M and room < ROOM_M:
            yield stay_behind("cyclist", snapshot.front + rear, float(speed), BRAKING_M_S2)


def hurried(view, outlook, events, memory, style):
    """Decide as the pilot does, and keep a shorter headway."""
    completed, memory = decide(view, outlook, events, memory, style)
    profile = replace(completed.tuning.profile, headway=0.7 * completed.tuning.profile.headway)
    return replace(completed, tuning=replace(completed.tuning, profile=profile)), memory


def stanley(snapshot, completed, limits, period, *, nine_commands=False, valley=None) -> Execution:
    """Steer by Stanley's law instead of the field (Hoffmann et al. 2007), at the pilot's desired speed."""
    ego, (_, _, along) = snapshot.ego, completed.plan.curve.at(snapshot.s)
    askew = math.remainder(along - ego.pose.heading, 2.0 * math.pi)
    most, wheel = limits.max_steering_angle, askew - math.atan2(1.5 * snapshot.d, ego.speed + 1.0)
    wheel = min(max(wheel, -most), most)
    rate = min(max((wheel - ego.steering_angle) / period, -limits.max_steering_rate), limits.max_steering_rate)
    wanted = desired_speed(snapshot, completed, limits, period).speed
    gain = min(max((wanted - ego.speed) / period, -limits.emergency_deceleration), limits.max_acceleration)
    command = Command(gain, rate)
    return Execution(command, advance(ego, command, limits.wheelbase, period), wanted, NO_POTENTIALS, False)


ROOM_FOR_CYCLISTS = Parts(rules=(room_for_cyclists,))
HURRIED = Parts(pilot=hurried)
STANLEY = Parts(executor=stanley)
