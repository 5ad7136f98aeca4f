"""Wording: what every event, outcome, behaviour, instruction and reason is in plain English."""

from __future__ import annotations

from typing import NamedTuple

from sumo_reactive.driver.nouns.assessment import PlanOutcome
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.nouns.event import EventKind

EVENTS: dict[EventKind, str] = {
    EventKind.NEW_PLAN: "a new nominal plan begins",
    EventKind.NEW_ROUTE: "the route is planned anew, since the turn to the edge named was missed",
    EventKind.NEW_OBSTACLE: "a new obstacle is ahead",
    EventKind.INTERSECTION: "the ego reaches the next stage of an intersection",
    EventKind.STOP_AHEAD: "a stop of the route, or a turn in several moves, comes into reach",
    EventKind.LANE_CHANGE: "a lane change comes into reach",
    EventKind.LIGHT_CHANGE: "a light changes",
    EventKind.OTHER_BEHAVIOUR: "somebody does something else than foreseen",
    EventKind.CAUSE_VANISHED: "the cause of the last instruction is gone",
    EventKind.OFF_NOMINAL: "the speed is far from nominal",
    EventKind.CONSTRAINT_MISSED: "a time constraint is missed",
    EventKind.DELAY: "the delay is excessive",
    EventKind.NO_COMMAND: "no command was admissible",
    EventKind.STANDSTILL: "the ego comes to a stand or moves off",
    EventKind.TIME_REACHED: "the time that the instruction named is reached",
    EventKind.GAP_OPENED: "the gap at a region has opened",
    EventKind.GAP_CLOSED: "the gap at a region has closed",
    EventKind.ROOM_BEHIND: "the room behind the intersection is taken, or free again",
    EventKind.GAP_SOUGHT: "a gap on the lane beside is looked for anew",
    EventKind.ASKED: "somebody asks to be let in, or no longer does",
    EventKind.PASS_TRIED: "whether somebody ahead can be passed is tried out anew",
    EventKind.NO_PROGRESS: "the ego does not get on, though nobody has the right to block it",
    EventKind.LOCKED: "no rule holds it",
    EventKind.MOVE_ENDED: "a move of the turn is over",
    EventKind.PROGRESS: "the ego gets on again",
}
"""What happened; the causes follow in brackets."""

OUTCOMES: dict[PlanOutcome, str] = {
    PlanOutcome.FINE: "Going on would meet nobody",
    PlanOutcome.DEGRADED: "Going on would meet nobody, but be {lateness:.1f} s late",
    PlanOutcome.FAILURE: "Going on would touch {user} at {time:.1f} s",
}

BEHAVIOURS: dict[Behaviour, str] = {
    Behaviour.NORMAL: "Normal driving", Behaviour.CAUTIOUS: "Cautious driving", Behaviour.OVERTAKING: "Overtaking",
    Behaviour.STOPPING: "Stopping at a location", Behaviour.CROSSING: "Crossing the intersection",
    Behaviour.CHANGING_LANES: "Changing lanes", Behaviour.CHANGING_QUEUES: "Changing queues",
    Behaviour.TURNING_ROUND: "Turning round", Behaviour.BACKING_UP: "Backing up",
    Behaviour.GIVING_WAY: "Giving way",
    Behaviour.TAKING_ANOTHER_WAY: "Taking another way",
}  # fmt: skip

ENDINGS: dict[tuple[Behaviour, Behaviour], str] = {
    **{(Behaviour.OVERTAKING, after): "The ego is back on C" for after in Behaviour if after is not Behaviour.OVERTAKING},
    (Behaviour.CROSSING, Behaviour.NORMAL): "The ego has left the intersection",
}
"""What it means that one behaviour gives way to another, where it means anything."""

INSTRUCTIONS: dict[Instruction, str] = {
    Instruction.FOLLOW_CURVE: "follows C",
    Instruction.APPROACH: "approaches, ready to stop",
    Instruction.STOP: "stops at the place named",
    Instruction.CROSS: "crosses without stopping",
    Instruction.OVERTAKE: "pulls out to pass",
    Instruction.RETURN: "returns to C",
    Instruction.FALL_BACK: "falls back and returns to C",
    Instruction.BACK_UP: "backs up at walking speed",
    Instruction.TURN_ROUND: "turns round, forwards and backwards by turns",
    Instruction.WIDEN: "searches more commands",
}
"""What the ego is told to do."""


class Wording(NamedTuple):
    """What the ego does for a reason: when it waits, and when it `passes`.

    `{order}` is "before" or "after", `{place}` "region r" or "the same region", `{region}` the bare id.
    """

    waits: str
    passes: str


REASONS: dict[Reason, Wording] = {
    Reason.ON_SCHEDULE: Wording("keeps to the times of its plan", "goes on although its plan has it later"),
    Reason.RED_LIGHT: Wording("stops at the line, since light {cause} is red", "goes on although light {cause} is red"),
    Reason.YELLOW_LIGHT: Wording(
        "stops at the line, since light {cause} is yellow and stopping is comfortable",
        "goes on although light {cause} is yellow",
    ),
    Reason.YELLOW_TOO_CLOSE: Wording(
        "stops, although light {cause} is yellow and the line close",
        "goes on, since light {cause} is yellow but the line too close to stop",
    ),
    Reason.STOP_SIGN: Wording("stops at the line, since a full stop is due there", "goes on after the full stop"),
    Reason.WAIT_FOR_TURN: Wording(
        "stops before {place}, since it is the turn of {cause}", "goes {order} {cause}, whose turn it is, through {place}"
    ),
    Reason.YIELD_TO: Wording(
        "stops before {place}, since {cause} has priority", "goes {order} {cause}, which has priority, through {place}"
    ),
    Reason.REGION_OCCUPIED: Wording(
        "stops before {place}, since {cause} is in it", "goes after {cause}, which is still in {place}"
    ),
    Reason.FOE_CANNOT_STOP: Wording(
        "stops before {place}, since {cause} should yield but can no longer stop",
        "goes {order} {cause}, which should yield but can no longer stop, through {place}",
    ),
    Reason.NO_RULE: Wording(
        "stops before {place}, since no rule makes {cause} wait",
        "goes {order} {cause}, which no rule makes wait, through {place}",
    ),
    Reason.PEDESTRIAN: Wording(
        "stops before {place}, since {cause} is on or near the crossing",
        "goes {order} {cause}, who is on or near the crossing, through {place}",
    ),
    Reason.EXIT_BLOCKED: Wording(
        "stops before connection {region}, since {cause} leaves no room behind it",
        "enters connection {region} although {cause} leaves no room behind it",
    ),
    Reason.SCHEDULED_STOP: Wording(
        "stops on lane {cause}, since the route has a stop there", "goes on from the stop on lane {cause}"
    ),
    Reason.NO_GAP: Wording(
        "stops where it has to change to lane {region}, since {cause} leaves no gap there",
        "changes to lane {region} beside {cause}",
    ),
    Reason.GAP_CLOSED: Wording(
        "calls off the change to lane {region}, since {cause} has closed the gap there",
        "changes to lane {region} although {cause} has closed the gap there",
    ),
    Reason.MERGE_AHEAD: Wording(
        "stays on its lane, which ends in a merge, since {cause} leaves no gap on lane {region}",
        "changes to lane {region}, since its own ends in a merge",
    ),
    Reason.ASKS: Wording(
        "stays on its lane, since {cause} does not let it in on lane {region}",
        "asks {cause} to let it in on lane {region}",
    ),
    Reason.LETS_IN: Wording("keeps behind {cause}, which asks to be let in", "lets {cause} in, which has asked for it"),
    Reason.QUEUE_CHANGE: Wording(
        "keeps room to change to lane {region}, since {cause} holds up the queue ahead",
        "changes to lane {region}, since {cause} holds up the queue ahead",
    ),
    Reason.FASTER_LANE: Wording(
        "stays on its lane behind {cause} although lane {region} gets on faster",
        "changes to lane {region}, which gets on faster than behind {cause}",
    ),
    Reason.BLOCKED: Wording("is blocked by {cause}", "goes on although {cause} blocks the way"),
    Reason.SLOW_AHEAD: Wording(
        "keeps behind {cause}, which is slow or has halted",
        "{cause} is slow or has halted, and the simulated pass meets nobody",
    ),
    Reason.GAP_LOST: Wording(
        "gives up passing, since {cause} takes the gap", "goes on passing although {cause} takes the gap"
    ),
    Reason.NARROW_TURN: Wording(
        "stops to turn round, since the road is too narrow for one sweep",
        "turns round in {cause}, since the road is too narrow for one sweep",
    ),
    Reason.COMES_OVER: Wording(
        "does not begin to turn round yet, since {cause} comes over the ground that it needs",
        "turns round although {cause} comes over the ground that it needs",
    ),
    Reason.FOLLOWS: Wording("keeps behind {cause}", "follows {cause}, which is slower than the road allows"),
    Reason.STAYS_THERE: Wording(
        "does not begin to turn round yet, since {cause} leaves no room where the turn ends",
        "turns round although {cause} leaves no room where the turn ends",
    ),
    Reason.NO_ROOM_TO_PASS: Wording(
        "keeps behind {cause}, which is slow or has halted, since there is no gap to pass ({region})",
        "passes {cause} although the gap is short",
    ),
    Reason.NO_PROGRESS: Wording(
        "looks for a way out, since nobody has the right to block it, yet it does not get on",
        "goes on, since nobody has the right to block it",
    ),
    Reason.MUTUAL_WAIT: Wording(
        "backs up, since {cause} and it keep each other from going",
        "lets {cause} go first, since each waits for the other",
    ),
}

MEANWHILE: dict[tuple[Instruction, Reason], str] = {
    (Instruction.RETURN, Reason.SLOW_AHEAD): "{cause} is passed",
    (Instruction.FALL_BACK, Reason.SLOW_AHEAD): "stays behind {cause}",
}
"""What a reason means late in a manoeuvre, where that differs from its beginning."""

MEETINGS: dict[tuple[bool, str], str] = {
    (True, "before"): "it arrives in {foe_arrival_s:.1f} s, the ego has cleared after {clearance_s:.1f} s",
    (True, "merges before"): "it arrives in {foe_arrival_s:.1f} s, the ego in {arrival_s:.1f} s",
    (True, "after"): "it has cleared after {foe_clearance_s:.1f} s, the ego arrives in {arrival_s:.1f} s",
    (False, "before"): "the ego would leave after {clearance_s:.1f} s and it arrive in {foe_arrival_s:.1f} s: too close",
    (False, "after"): "it would leave after {foe_clearance_s:.1f} s and the ego arrive in {arrival_s:.1f} s: too close",
    (False, "together"): "it would be there in {foe_arrival_s:.1f} s, the ego would leave after {clearance_s:.1f} s",
    (False, "inside"): "it leaves after {foe_clearance_s:.1f} s, the ego would be there in {arrival_s:.1f} s",
}
"""Who would be in a region when, by whether the ego passes and in which order."""

BRAKING = "{to_line_m:.1f} m away, which would take {braking_needed_m_s2:.1f} m/s²"

FIGURES: dict[str, str] = {
    "arrival_s": "the ego arrives in {:.2f} s",
    "clearance_s": "the ego has cleared after {:.2f} s",
    "foe_arrival_s": "the other arrives in {:.2f} s",
    "foe_clearance_s": "the other has cleared after {:.2f} s",
    "to_line_m": "the line is {:.2f} m away",
    "braking_needed_m_s2": "stopping needs {:.2f} m/s²",
}
"""A decision's figures one by one; one without wording is shown by its name."""

EMERGENCY_BRAKING = "An emergency: milder braking than this would not stop the ego clear of {}"
ALONG_C = "No command is admissible: the ego brakes as hard as it can along C"
