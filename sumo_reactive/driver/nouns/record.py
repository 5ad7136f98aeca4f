"""What is kept of a step: everything a figure, a verdict or an explanation is made from later."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.nouns.assessment import NOT_ASSESSED, Assessment
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Decision, PostConflictState, RegionState
from sumo_reactive.driver.nouns.event import Event
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.world.road_graph import RoadGraph

STOP_PLACE = "the place to stop at"
BEND = "the bend"
TOO_NEAR = "somebody near"
"""What an emergency may be for, other than a leader, whose id is named."""


NO_LIGHTS: Mapping[str, str] = {}
"""A driver that sees none, or does not tell."""


class StepRecord(NamedTuple):
    """The ego at the end of a simulation step, and why it is there; None: its driver has no such thing.

    SUMO's own driver has place and motion alone.

    `x`, `y` is the front bumper's centre (m), `heading` in rad. `s`, `d`: front axle on C (m). `stop_s` is the planned
    stop (m on C, NaN: none). `u`, `u1`, `u2`, `u3`: potential and its terms for the chosen command. `leader`, `gap`: the
    vehicle that limits the ego and its distance (m, NaN: none). `control_us`: time of the control step. `lane_id` is
    where SUMO maps the ego (empty: nowhere). `light`: letter that applied to the stop line crossed in this step (empty: none
    crossed). `pilot`: how often `events` activated the pilot in this step; `decisions`, `assessment` and `regions` are those
    of its last activation. `hazard`: what milder braking would not have stopped clear of when `emergency`: a leader's id or
    one of the names above (empty: no command was admissible). `reason`: what a driver of the user's says of why.
    `constraints`: the places to stop at, `rooms`: the post-conflict regions ahead, as the pilot holds them.
    """

    time: float
    x: float
    y: float
    heading: float
    speed: float
    lane_id: str
    acceleration: float | None = None
    steering_angle: float | None = None
    s: float | None = None
    d: float | None = None
    command_acceleration: float | None = None
    command_steering_rate: float | None = None
    desired_speed: float | None = None
    stop_s: float | None = None
    u: float | None = None
    u1: float | None = None
    u2: float | None = None
    u3: float | None = None
    leader: str | None = None
    gap: float | None = None
    behaviour: str | None = None
    instruction: str | None = None
    pilot: int | None = None
    emergency: bool | None = None
    light: str | None = None
    control_us: float | None = None
    decisions: tuple[Decision, ...] = ()
    events: tuple[Event, ...] = ()
    assessment: Assessment = NOT_ASSESSED
    regions: tuple[RegionState, ...] = ()
    hazard: str | None = None
    reason: str = ""
    constraints: tuple[TimeConstraint, ...] = ()
    rooms: tuple[PostConflictState, ...] = ()


class CommandField(NamedTuple):
    """U over a lattice of commands: accelerations (a,) in m/s², steering rates (w,) in rad/s, potentials (a, w), infinite
    where a command is not admissible."""

    accelerations: NDArray[np.float64]
    steering_rates: NDArray[np.float64]
    potentials: NDArray[np.float64]


class GroundField(NamedTuple):
    """w₁U₁ + w₂U₂ over the ground: the front bumper's centre `x`, `y` (m) and `heading` (rad), places `ahead` (n,) and
    `left` (m,) of it where the ego's middle would be (m), potentials (n, m), NaN where it would touch somebody."""

    x: float
    y: float
    heading: float
    ahead: NDArray[np.float64]
    left: NDArray[np.float64]
    potentials: NDArray[np.float64]


class CastShadow(NamedTuple):
    """The shadow R_D of a road user: the weight of U_D, and the outline (n, 2) of what his foreseen motion covers along C
    until the ego meets him, m."""

    user_id: str
    weight: float
    outline: NDArray[np.float64]


class Bystander(NamedTuple):
    """A road user as it is seen from outside: the middle of its front bumper (m), heading (rad), speed (m/s), size (m), and
    SUMO's bits of its signals: 1 right, 2 left, 8 brakes."""

    id: str
    x: float
    y: float
    heading: float
    speed: float
    length: float
    width: float
    signals: int


class Scene(NamedTuple):
    """All that a judge may look at after a step of `ego`, as SUMO has it: the ego's record and every road user near.

    `crossed`: the letters, before the step and in it, of a light whose stop line the ego crosses (empty: none crossed).
    `beside`: all other vehicles so near that they might touch the ego, though its driver does not look at them. `world`: the
    roads around the route on which the step was driven (None: nobody knows them). `plan`: the nominal plan then in force
    (None: its driver has none). `lights`: the letters that the driver sees, by light. `field` works out U over the commands
    among which this step's was chosen, `ground` over the places around, `shadows` what casts U₂ (None: its driver has none),
    `around` everybody near, also who is no matter of the driver's (None: they are not told); it is asked before the next
    step or not at all. `boxes` (n, 6): those of `users`, if they are packed already. `apart` tells of two lanes, by id,
    whether no junction joins them (None: nobody knows).
    """

    step: StepRecord
    users: tuple[RoadUser, ...]
    crossed: str = ""
    beside: tuple[RoadUser, ...] = ()
    ego: str = ""
    world: RoadGraph | None = None
    plan: NominalPlan | None = None
    lights: Mapping[str, str] = NO_LIGHTS
    field: Callable[[], CommandField | None] | None = None
    ground: Callable[[], GroundField] | None = None
    shadows: Callable[[], tuple[CastShadow, ...]] | None = None
    around: Callable[[], tuple[Bystander, ...]] | None = None
    boxes: NDArray[np.float64] | None = None
    apart: Callable[[str, str], bool] | None = None
