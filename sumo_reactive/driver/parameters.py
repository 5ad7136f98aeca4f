"""What a user may vary of the driver, by name: one frozen value that rides on a car's `VehicleLimits`.

Every other number stands at the place of its use.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from enum import Enum
from functools import cached_property
from typing import Any

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.errors import ParameterError


class Profile(Enum):
    """`DEFAULT`: a refined lattice, exact distances. `PAPER`: nine commands, bitmaps, δt = 0.5 s (F&L 1991, §4)."""

    DEFAULT = "default"
    PAPER = "paper"


class Delays(Enum):
    """What becomes of the time constraints after a delay Δt: all later ones are shifted by it (the paper), or the planner
    is asked for new ones that recover it where limits allow (the answer that the paper names)."""

    SHIFT = "shift"
    REPLAN = "replan"


@dataclass(frozen=True, kw_only=True)
class Parameters:
    """The driver's parameters, each with unit, symbol and source: times in s, lengths in m, speeds in m/s, accelerations in
    m/s² unless told otherwise. Raises ParameterError for one that is negative, not finite or too small to divide by."""

    # --- the car, where neither its type nor a `reactive.*` of it says otherwise ---

    comfort_deceleration: float = 2.5
    """Planned braking."""

    planned_deceleration: float = 3.0
    """Hardest braking that is no emergency: what a yellow asks for. Harder is an emergency, and only where this braking does
    not stop clear."""

    comfort_lateral_acceleration: float = 3.3
    """Cornering speed of the plan is √(this / curvature): in tight bends drivers go by what is comfortable (Felipe & Navin
    1998), which passengers on a test track put between 2 m/s², too slow, and 4, too fast."""

    max_lateral_acceleration: float = 4.0
    """A command that exceeds it is discarded (centrifugal limit, F&L 1991, §3.2)."""

    max_steering_rate: float = 1.0
    """φ̇max, rad/s."""

    standstill_gap_m: float = 2.0
    """Gap to a standing leader."""

    # --- the potential field U = w₁U₁ + w₂U₂ + w₃U₃ (F&L 1991, §3.3) ---

    valley_share: float = 1.0
    """Share of every instruction's w₁, which keeps the ego on C."""

    shadow_share: float = 1.0
    """Share of every instruction's w₂, which keeps it away from others."""

    velocity_share: float = 1.0
    """Share of every instruction's w₃, which keeps it at v_d."""

    shares_of: float = 0.0
    """The instruction, by its number from 1, whose weights the three shares are for; 0: those of every one."""

    valley_attraction: float = 1.0
    """α of U₁, 1/m (F&L 1991, §3.3.1)."""

    valley_repulsion: float = 0.5
    """β of U₁ (F&L 1991, §3.3.1)."""

    shadow_scale: float = 1.0
    """k₀ of U₂, s (F&L 1991, §3.3.2)."""

    clearance_m: float = 1.2
    """Room that the ego likes to have beside whom it passes; cars in the middles of lanes of 2.8 m have it."""

    max_lean_m: float = 0.4
    """It takes that room inside its lane, this far beside C at most."""

    look_ahead_s: float = 0.2
    """U₁ is taken where the front axle will be this long after the control period, the steering held."""

    look_ahead_growth: float = 0.02
    """The look-ahead grows with speed so that fast driving steers gently, s per m/s."""

    # --- the executor (F&L 1991, §3.2) ---

    control_period_s: float = 0.1
    """Longest control period δt of the default profile; a coarser simulation step is sub-stepped."""

    paper_control_period_s: float = 0.5
    """δt of the paper (F&L 1991, §4)."""

    collision_horizon_s: float = 0.7
    """Predicted footprints are tested this far; beyond, the others' headings no longer hold and the regions decide."""

    comfort_jerk: float = 8.0
    """The lattice of commands changes the acceleration by no more, unless safety needs it, m/s³."""

    max_lateral_jerk: float = 14.0
    """Bounds φ̇max at road speed, m/s³. With 8 a car at 30 m/s needed 0.9 s to reverse its steering and wove about C."""

    stop_line_margin_m: float = 0.7
    """Planned distance of the front bumper to a line."""

    speed_approach_s: float = 0.6
    """Time constant with which the ego approaches a speed limit from below."""

    time_tolerance_s: float = 2.0
    """The ego slows down for a time constraint only if it would be earlier than this."""

    rolling_share: float = 0.35
    """An ego slows down for a gap that is to open from where this share of the comfortable braking would stop it on: farther
    away the gap before the foe may yet turn out to be enough."""

    slot_headway_s: float = 0.4
    """Time headway to the vehicle on the other lane behind which the ego falls in."""

    pressing_gain: float = 3.0
    """Where a stop or a leader needs more than comfortable braking, the ego brakes by this many times the difference harder
    at once, up to the planned: the way that is won early spares an emergency."""

    # --- what the pilot foresees, and what activates it (F&L 1991, §2) ---

    max_acceleration_in_plan: float = 2.0
    """What the pilot counts on when it foresees the ego's motion (SUMO's default passenger car does 2.6)."""

    assessed_s: float = 8.0
    """The planned manoeuvre is simulated this far ahead: approach and crossing of an intersection at city speed."""

    excessive_delay_s: float = 5.0
    """k₂ (F&L 1991, §2): a plan that will be later than this is degraded."""

    delay_step_s: float = 5.0
    """A delay is excessive, each time, when it has grown by this much."""

    behaviour_tolerance: float = 1.0
    """Another road user keeps its behaviour as long as its speed differs less from the foreseen one, m/s."""

    off_nominal_speed: float = 3.0
    """"v far from nominal" (F&L 1991, §2), m/s: a fifth of city speed."""

    foreseen_tolerance_s: float = 0.5
    """Another road user is where he was foreseen as long as he clears a region less than this sooner or later."""

    trust_s: float = 0.4
    """While a gap beside is sought, while the ego passes somebody, and behind who stands, the others are foreseen anew after
    this long."""

    retry_s: float = 1.5
    """Whether somebody who drives and could not be passed can be is tried out anew after this long."""

    progress_m: float = 3.0
    """Coming on means this far."""

    no_progress_s: float = 20.0
    """An ego that has not come on for this long, though nobody has the right to block it, looks for an escape."""

    halted_room_m: float = 8.0
    """The ego stops this far behind somebody who has halted: room to swing out."""

    corridor_margin_m: float = 0.2
    """Added to each side of the ego when it asks what stands in its way, unless it sweeps more in a bend."""

    narrow_lead_s: float = 0.5
    """The ego goes first through a narrow place if its rear is past it so long before the other comes; at 10 m/s it is 5
    m."""

    narrow_headway: float = 0.5
    """Share of its time headway that the ego keeps to who is first at a narrow place: he will leave its way again."""

    turnaround_patience_s: float = 30.0
    """Who comes over the ground that a turn in several moves needs is let pass, until the ego has stood there for so
    long."""

    # --- lights and lines ---

    cautious_ahead_s: float = 4.0
    """Cautious driving begins this long before a line…"""

    cautious_ahead_m: float = 10.0
    """…and this far, and the way to stop."""

    yellow_s: float = 3.0
    """The least time that a light is yellow (StVO, at 50 km/h), where nobody knows when it ends."""

    yellow_deceleration: float = 3.0
    """A yellow is obeyed where this braking suffices (design value of yellow times: 3.0–3.4 m/s²)."""

    red_margin_s: float = 0.5
    """A line is passed at yellow, by who brakes for something behind it, so long before red."""

    foreseen_lights_s: float = 0.0
    """How far ahead the driver knows when lights of fixed programs switch, as one who is told does: it then comes to a red
    one rolling, where it turns green within this time. 0: not at all."""

    # --- gaps at conflict regions (F&L 1991, §2) ---

    gap_before_s: float = 1.0
    """Margin between leaving a region and the foe's earliest arrival."""

    gap_after_s: float = 0.5
    """Margin between the foe's leaving a region and the ego's arrival."""

    merge_gap_s: float = 0.8
    """Time headway that a foe keeps behind the ego after it merged."""

    committed_patience: float = 0.4
    """Share of the margins that still must remain once the ego is inside the junction."""

    rolling_s: float = 12.0
    """A gap that opens within this time is met rolling; for a later one the ego comes to a stand."""

    foe_acceleration: float = 1.5
    """How a foe may speed up on its way to a region; more if its kind can, see `Body.gains`."""

    leaving_acceleration: float = 1.0
    """No more is counted on of a foe that is seen to gain speed as it leaves the junction: half of what a car does."""

    foe_can_stop_deceleration: float = 4.0
    """A foe that must yield is trusted to while this braking suffices (SUMO's default car brakes at 4.5)."""

    sign_stop_deceleration: float = 5.5
    """A foe that has to stop at an all-way stop, whoever comes, is trusted to while this braking suffices: SUMO's cars brake
    for their line with just the 4.5 that is theirs."""

    follower_deceleration: float = 2.0
    """Braking that the ego may ask of traffic behind it when it merges, and of itself behind traffic ahead."""

    foe_patience_s: float = 3.0
    """A foe with priority that has been standing this long, while the ego has too, is not about to go."""

    least_patience_s: float = 1.0
    """The longer the foe has stood, the less the ego need have: the two times together are twice the foe's patience, the
    ego's at least this."""

    # --- lane changes ---

    lane_change_look_ahead_s: float = 20.0
    """A needed lane change is sought this long before its latest place…"""

    lane_change_look_ahead_m: float = 150.0
    """…and at least this far."""

    lane_change_gap_m: float = 2.0
    """Gap to both sides of the place on the other lane at standstill…"""

    lane_change_reaction_s: float = 0.5
    """…and the time headway added to it."""

    follower_headway_s: float = 0.8
    """Time headway left to who is behind on the other lane, while there is still way for another gap…"""

    easy_stop_deceleration: float = 3.3
    """…and the braking with which he must then be able to stop: at equal speeds of 28 m/s a headway of 1.2 s."""

    urgent_m: float = 60.0
    """A change becomes urgent this far before its last place…"""

    urgent_s: float = 5.0
    """…or this long."""

    urgent_reaction_s: float = 0.15
    """Time headway that is left to both at the last place for a change…"""

    urgent_deceleration: float = 3.5
    """…the braking that the ego asks of itself there behind who is ahead…"""

    hard_stop_deceleration: float = 3.8
    """…and that with which who is behind must be able to stop: SUMO's cars brake 1.2 times as hard as they must, here
    4.6."""

    asked_deceleration: float = 2.0
    """Who is asked to let the ego in slows down by no more than this (0: nobody is asked): less than half of what SUMO's
    cars do for each other."""

    off_tracking_patience_s: float = 15.0
    """After so long a wait for a gap to cut into, the ego takes one that those behind must brake for, though not hard."""

    # --- queues and missed turns ---

    queue_headway_s: float = 2.0
    """A queue lets one car after another pass the line at this interval, at saturation."""

    turner_wait_s: float = 10.0
    """What somebody in the queue who turns off and has to let others go first adds to the wait: two or three gaps
    refused."""

    queue_gain_s: float = 9.0
    """A queue is left for one that is expected to be shorter by this for each lane change, which costs comfort and may not
    come to pass: less than a red light costs, more than four cars."""

    faster_lane_s: float = 30.0
    """So far ahead the ego compares how its lane and those beside get on."""

    faster_gain_s: float = 3.0
    """A lane that gets on faster by this in that time is worth each lane change that it costs."""

    missed_turn_s: float = 25.0
    """An ego that has waited so long at the end of its lane, while traffic keeps passing, looks for another way…"""

    queue_patience_s: float = 90.0
    """…and one that waits beside a queue, or farther back, after this long: a light's cycle; to turn round, twice that."""

    detour_patience_s: float = 90.0
    """An ego that missed a turn waits on for as long as the other way takes longer, but no longer than this, a light's
    cycle."""

    # --- overtaking (F&L 1991, §2) ---

    settled_speed: float = 1.0
    """k₁ (F&L 1991, §2), m/s: the ego has settled behind X if its speed differs less from what following X allows."""

    off_curve_epsilon_m: float = 0.3
    """ε (F&L 1991, §2): the ego is back on C when it is nearer than this."""

    slow_share: float = 0.75
    """X is worth overtaking below this share of the road's speed…"""

    slower_by: float = 2.5
    """…and if it is slower by this much, m/s: a pass then takes less than ten seconds."""

    following_m: float = 12.0
    """The ego follows X with a gap up to this…"""

    following_s: float = 2.0
    """…and this time headway."""

    passing_clearance_m: float = 0.65
    """Room left beside who is passed: a car of 1.8 m then still touches its own lane of 3.2 m, where SUMO maps it…"""

    two_wheeler_clearance_m: float = 1.2
    """…and beside two-wheelers, which sway."""

    overtaking_s: float = 25.0
    """No overtaking takes longer."""

    overtaking_sight_m: float = 600.0
    """How far the ego looks along the oncoming lane when it wants to overtake: 14 s at 22 m/s towards each other."""

    overtaking_end_m: float = 30.0
    """No overtaking nearer to an intersection than this."""

    overtaking_margin_s: float = 3.5
    """Oncoming traffic may be this much earlier than foreseen, or half of it later, and an overtaking still meets nobody…"""

    merge_margin_s: float = 1.0
    """…and traffic on the lane beside that drives the ego's way this much."""

    return_headway_s: float = 0.8
    """Time headway left to who has been passed…"""

    return_gap_m: float = 3.0
    """…and this gap."""

    # --- the run ---

    stuck_s: float = 600.0
    """An ego that has been standing this long ends the run as not arrived."""

    without: Mechanism = Mechanism.NONE
    """The mechanism that is left out, by its number: `tools/ablation.py` measures what is then lost."""

    def __post_init__(self) -> None:
        for name in NAMES:
            value, least = getattr(self, name), LEAST.get(name, 0.0)
            if not (math.isfinite(value) and value >= least):
                raise ParameterError(f"parameter '{name}': {value!r} is less than {least:g}, or not finite")

    @classmethod
    def of(cls, values: Mapping[str, object]) -> Parameters:
        """Return the parameters with other values for those named, in small letters or capitals.

        Raises ParameterError for an unknown name, with those near it, and for what is no number.
        """
        found: dict[str, Any] = {}
        for name, value in values.items():
            if (known := name_of(name)) in found:
                raise ParameterError(f"parameter '{known}' is named twice")
            found[known] = _number(known, value)
        return cls(**found)

    @cached_property
    def varied(self) -> dict[str, float]:
        """What differs from the usual values, by name in the order of the fields."""
        found = {name: getattr(self, name) for name in NAMES if getattr(self, name) != getattr(USUAL, name)}
        return {name: int(value) if name == "without" else value for name, value in found.items()}

    def with_values(self, values: Mapping[str, object]) -> Parameters:
        """Return these parameters with other values for those named; raise what `of` raises."""
        asked = Parameters.of(values)
        return replace(self, **{name_of(name): getattr(asked, name_of(name)) for name in values})

    def has(self, mechanism: Mechanism) -> bool:
        """Whether the driver has a mechanism."""
        return mechanism != self.without


NAMES = tuple(field.name for field in fields(Parameters))
"""Every name, in the order of the fields."""

LEAST = {
    "comfort_deceleration": 0.1, "planned_deceleration": 0.1, "comfort_lateral_acceleration": 0.1,
    "max_lateral_acceleration": 0.1, "max_steering_rate": 0.01, "standstill_gap_m": 0.01, "clearance_m": 0.01,
    "control_period_s": 0.001, "paper_control_period_s": 0.001, "comfort_jerk": 0.1, "max_lateral_jerk": 0.1,
    "speed_approach_s": 0.01, "rolling_share": 0.01, "max_acceleration_in_plan": 0.1, "assessed_s": 1.0,
    "foe_acceleration": 0.01, "leaving_acceleration": 0.01, "follower_deceleration": 0.1, "easy_stop_deceleration": 0.1,
    "urgent_m": 0.1, "urgent_deceleration": 0.1, "hard_stop_deceleration": 0.1, "off_tracking_patience_s": 0.01,
    "overtaking_s": 1.0,
}  # fmt: skip
"""The smallest value of a parameter that is divided by, or simulated for; every other may be 0."""

USUAL = Parameters()
"""The driver as it is without anybody's wishes."""


def name_of(name: str) -> str:
    """Return a parameter's name as the fields spell it; raise ParameterError, with those near it, for an unknown one."""
    found = name.lower()
    if found in NAMES:
        return found
    near = get_close_matches(found, NAMES, n=3, cutoff=0.5)
    raise ParameterError(f"unknown parameter '{name}'" + (f"; near it: {', '.join(near)}" if near else ""))


def _number(name: str, value: object) -> float:
    """Return the value that a parameter takes; raise ParameterError for what is no number, or no mechanism's."""
    if not isinstance(value, float | int) or isinstance(value, bool) or not math.isfinite(value):
        raise ParameterError(f"parameter '{name}': {value!r} is not a finite number")
    if name != "without":
        return float(value)
    try:
        return Mechanism(int(value) if value == int(value) else -1)
    except ValueError as error:
        raise ParameterError(f"parameter '{name}': {value!r} is not a mechanism's number") from error
