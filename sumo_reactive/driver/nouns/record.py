"""What is kept of a step: everything a figure, a verdict or an explanation is made from later."""

from __future__ import annotations

from typing import NamedTuple

from sumo_reactive.driver.nouns.assessment import NOT_ASSESSED, Assessment
from sumo_reactive.driver.nouns.decision import Decision, RegionState
from sumo_reactive.driver.nouns.event import Event
from sumo_reactive.driver.nouns.traffic import RoadUser

STOP_PLACE = "the place to stop at"
BEND = "the bend"
TOO_NEAR = "somebody near"
"""What an emergency may be for, other than a leader, whose id is named."""


class StepRecord(NamedTuple):
    """The ego at the end of a simulation step, and why it is there.

    `x`, `y` is the front bumper's centre (m), `heading` in rad. `s`, `d`: front axle on C (m). `stop_s` is the planned
    stop (m on C, NaN: none). `u`, `u1`, `u2`, `u3`: potential and its terms for the chosen command. `leader`, `gap`: the
    vehicle that limits the ego and its distance (m, NaN: none). `control_us`: time of the control step. `lane_id` is
    where SUMO maps the ego (empty: nowhere). `light`: letter that applied to
    the stop line crossed in this step (empty: none crossed). `pilot`: whether `events` activated the pilot in this step,
    `asked` how often the highway code was asked in it, by the pilot or to confirm a decision;
    `decisions`, `assessment` and `regions` are those of its last activation. `hazard`: what milder braking would not have
    stopped clear of when `emergency`: a leader's id or one of the names above (empty: no command was admissible).
    """

    time: float
    x: float
    y: float
    heading: float
    speed: float
    acceleration: float
    steering_angle: float
    lane_id: str
    s: float
    d: float
    command_acceleration: float
    command_steering_rate: float
    desired_speed: float
    stop_s: float
    u: float
    u1: float
    u2: float
    u3: float
    leader: str
    gap: float
    behaviour: str
    instruction: str
    pilot: bool
    emergency: bool
    light: str
    control_us: float
    decisions: tuple[Decision, ...]
    events: tuple[Event, ...] = ()
    assessment: Assessment = NOT_ASSESSED
    regions: tuple[RegionState, ...] = ()
    hazard: str = ""
    asked: int = 0


class Scene(NamedTuple):
    """All that a judge may look at after a step, as SUMO has it: the ego's record and every road user near.

    `crossed`: the letters, before the step and in it, of a light whose stop line the ego crosses (empty: none crossed).
    `beside`: all vehicles so near that they might touch the ego, whether its driver looks at them or not.
    """

    step: StepRecord
    users: tuple[RoadUser, ...]
    crossed: str = ""
    beside: tuple[RoadUser, ...] = ()
