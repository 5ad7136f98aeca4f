"""The pilot: activated by events, it assesses the plan and completes it anew (F&L 1991, §2)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.assessment import Assessment
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan, Replanning, Request, Tuning
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Reason
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.forecast import FREE_GROUND, Outlook
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.parameters import Delays, Parameters
from sumo_reactive.driver.pilot.assessment import assess, failing_at
from sumo_reactive.driver.pilot.behaviours import overtaking
from sumo_reactive.driver.pilot.behaviours.backing_up import escape, room_behind
from sumo_reactive.driver.pilot.behaviours.changing_lanes import merge_early, seek_gap
from sumo_reactive.driver.pilot.behaviours.changing_queues import LEAVES_FOR, leave_queue, released, seek_faster
from sumo_reactive.driver.pilot.behaviours.giving_way import give_way
from sumo_reactive.driver.pilot.behaviours.taking_another_way import waiting_since
from sumo_reactive.driver.pilot.behaviours.turning_round import Turning, is_behind_queue, place_to_begin, turn_round
from sumo_reactive.driver.pilot.behaviours.turning_round import is_near as turn_is_near
from sumo_reactive.driver.pilot.events import premises_of
from sumo_reactive.driver.pilot.instructions import PAPER_TUNINGS, TUNINGS
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import View
from sumo_reactive.driver.pilot.rules.highway_code import Rule, Rules, ask, decision_of, nearest_stop, unconditional_stop
from sumo_reactive.driver.pilot.rules.region import intent_of, kept_waiting
from sumo_reactive.driver.pilot.schedule import adjusted
from sumo_reactive.driver.pilot.situation import LaneChanging, Situation, next_on_way
from sumo_reactive.driver.pilot.transitions import RULES, next_behaviour

_SETTLED = (Reason.RED_LIGHT, Reason.YELLOW_LIGHT, Reason.SCHEDULED_STOP)
"""An ego that stands for one of these need not watch the others."""


class Style(NamedTuple):
    """How the pilot works: the paper's coefficients or the default ones, and what becomes of delays."""

    paper: bool = False
    delays: Delays = Delays.REPLAN


class Orders(NamedTuple):
    """What the pilot orders: instruction, every place to stop at, what it asks of the planner, why; the memory of it; a
    speed not to exceed (m/s), and why not; whom a standing ego lets go."""

    instruction: Instruction
    stops: tuple[TimeConstraint, ...]
    request: Request
    decisions: tuple[Decision, ...]
    memory: PilotMemory
    top_speed: float = math.inf
    slow_because: Reason = Reason.GAP_LOST
    let_go: tuple[str, ...] = ()


def notice(snapshot: Snapshot, memory: PilotMemory) -> PilotMemory:
    """Remember, at every step, since when the ego stands, where it last got on, and whom others keep waiting."""
    if snapshot.ego.speed >= STANDING_SPEED:
        if memory.standing_since is not None:
            memory = memory._replace(standing_since=None)
    elif memory.standing_since is None:
        memory = memory._replace(standing_since=snapshot.time)
    if abs(snapshot.s - memory.progress_s) > snapshot.parameters.progress_m:
        memory = memory._replace(progress_s=snapshot.s, progress_time=snapshot.time, got_on=snapshot.time, escapes=0)
    kept = kept_waiting(snapshot, memory) if snapshot.foes else memory.kept
    return memory if kept == memory.kept else memory._replace(kept=kept)


def decide(
    view: View,
    outlook: Outlook,
    events: tuple[Event, ...],
    memory: PilotMemory,
    style: Style,
) -> tuple[CompletedPlan, PilotMemory]:
    """Complete the plan because of `events`.

    1. Assess: how does it end if everybody goes on? 2. Choose the behaviour. 3. Ask the rules that it names. 4. Carry it
    out. 5. Adjust the time constraints. 6. Note what the decision rests on.
    """
    snapshot, plan = view.snapshot, view.plan
    memory = _brought_up_to_date(view, memory)
    situation = _considered(view, outlook, events, memory)
    behaviour = next_behaviour(situation)
    wishes = situation.changing.wishes
    situation, asked = _asked(situation, behaviour)
    turning = _turn(situation)
    situation, rules = _with_turn(*_with_room(situation, asked))
    waits_since = waiting_since(snapshot, plan, view.ahead, situation.stop, situation.memory)
    situation = situation._replace(memory=situation.memory._replace(waiting_since=waits_since))
    orders = _ordered(situation, behaviour, rules)
    orders = (_passing if behaviour is Behaviour.OVERTAKING else _escaping)(situation, orders)
    if turning is not None:
        orders = _turning(orders, turning, snapshot)
    constraints, asks_for, memory = adjusted(snapshot, plan, orders.memory, events, style.delays)
    if orders.request.what is Replanning.NOTHING:
        orders = orders._replace(request=Request(what=asks_for))
    constraints += _limits_of(orders, situation.changing, snapshot) + asked.arrivals
    completed = _completed(situation, behaviour, orders, constraints, rules, style)
    if turning is not None:
        completed = replace(completed, move=turning.move)
    changing, p = situation.changing, snapshot.parameters
    waits = bool(changing.slot or changing.stop) or outlook.ground != FREE_GROUND
    beside = waits or view.plan.merging(snapshot.front) is not None
    again = p.trust_s if beside else p.retry_s if wishes else math.inf
    settled = completed.stop is not None and completed.stop.reason in _SETTLED and snapshot.ego.speed < STANDING_SPEED
    premises = premises_of(view, completed, memory, asked, looks_beside_s=again, is_settled=settled)
    return completed, memory._replace(behaviour=behaviour, premises=premises)


def _brought_up_to_date(view: View, memory: PilotMemory) -> PilotMemory:
    """Return the memory of what lights have shown, and of whom others have kept waiting, until now."""
    snapshot = view.snapshot
    memory = memory.with_lights(snapshot.lights, snapshot.time).with_released(*released(snapshot, view.ways, memory))
    return memory._replace(kept=kept_waiting(snapshot, memory))


def _considered(view: View, outlook: Outlook, events: tuple[Event, ...], memory: PilotMemory) -> Situation:
    """Return what the behaviours look at: how going on ends, what the lane beside asks for, and whether X can be passed."""
    found = Situation(
        view.snapshot, view.plan, view.limits, memory, events, view.ahead, view.ways, next_on_way(view.snapshot), None,
        _assess(view, outlook, memory), outlook, None, _changing(view, outlook, memory),
    )  # fmt: skip
    return found._replace(proof=overtaking.try_out(found))


def _asked(situation: Situation, behaviour: Behaviour) -> tuple[Situation, Rules]:
    """Ask the rules that a behaviour names; return the situation with the nearest stop and whom the ego would meet."""
    asks = RULES[behaviour].asks
    changing = situation.changing if Rule.LANE_GAP in asks else LaneChanging()
    asked, memory = ask(situation.view, asks, changing.stop, situation.memory)
    assessment = failing_at(situation.assessment, asked.met)
    return situation._replace(assessment=assessment, memory=memory, stop=nearest_stop(asked.stops), changing=changing), asked


def _turn(situation: Situation) -> Turning | None:
    """Return what a turn in several moves asks for, if one is under way or begins now."""
    due = any(event.kind is EventKind.NO_PROGRESS for event in situation.events)
    is_stuck = due and not is_behind_queue(situation)
    return turn_round(
        situation.snapshot, situation.plan, situation.stop, situation.memory,
        ground=situation.outlook.ground, is_stuck=is_stuck,
    )  # fmt: skip


def _changing(view: View, outlook: Outlook, memory: PilotMemory) -> LaneChanging:
    """Return what the lane beside asks for: the one that the route needs, else one whose queue is over sooner or that
    gets on faster."""
    snapshot, plan, limits = view.snapshot, view.plan, view.limits
    changing = seek_gap(snapshot, plan, limits, memory.standing_for(snapshot.time))
    if changing == LaneChanging():
        changing = merge_early(snapshot, plan, view.ways, limits)
    if changing == LaneChanging():
        changing = leave_queue(snapshot, plan, outlook, view.ways, memory, limits)
    if changing == LaneChanging():
        changing = seek_faster(view, outlook, memory)
    return changing


def _assess(view: View, outlook: Outlook, memory: PilotMemory) -> Assessment:
    """Simulate going on, up to the stops that nothing can put off; who has to yield and still can is trusted."""
    snapshot, plan = view.snapshot, view.plan
    stop = unconditional_stop(view, memory)
    trusted = {f.user.id for f in snapshot.foes if f.conflict.is_yielded_to and not f.conflict.must_yield}
    target = next((c for c in plan.time_constraints if c.s > snapshot.front), None)
    return assess(view, outlook.forecast, stop, target, trusted)


def _with_room(situation: Situation, rules: Rules) -> tuple[Situation, Rules]:
    """Return both with room kept behind somebody who has halted."""
    keeps_room = situation.memory.overtaking is None and situation.limits.parameters.has(Mechanism.ESCAPE)
    room = room_behind(situation) if keeps_room else None
    if room is None or (situation.stop is not None and situation.stop.s <= room.s):
        return situation, rules
    return situation._replace(stop=room), rules._replace(stops=(*rules.stops, (room, decision_of(room))))


def _with_turn(situation: Situation, rules: Rules) -> tuple[Situation, Rules]:
    """Return both with the stop before a turn in several moves."""
    stop = place_to_begin(situation.snapshot, situation.plan, situation.memory, situation.outlook.ground)
    if stop is None or not turn_is_near(situation) or (situation.stop is not None and situation.stop.s < stop.s):
        return situation, rules
    return situation._replace(stop=stop), rules._replace(stops=(*rules.stops, (stop, decision_of(stop))))


def _turning(orders: Orders, turning: Turning, snapshot: Snapshot) -> Orders:
    """Return the orders with those of a turn in several moves: nothing but others' bodies stops it."""
    begins_or_moves = orders.memory.move is None or abs(snapshot.ego.speed) >= STANDING_SPEED
    since = snapshot.time if begins_or_moves else orders.memory.progress_time
    return orders._replace(
        instruction=Instruction.TURN_ROUND,
        stops=(),
        request=turning.request,
        decisions=(*(decision for decision in orders.decisions if decision.passes), turning.decision),
        memory=orders.memory._replace(move=turning.memory.move, escapes=0, progress_time=since, waiting_since=None),
    )


def _ordered(situation: Situation, behaviour: Behaviour, rules: Rules) -> Orders:
    """Return the orders that follow from the behaviour alone."""
    why = situation.changing.why
    return Orders(
        instruction=RULES[behaviour].instruction(situation),
        stops=tuple(stop for stop, _ in rules.stops),
        request=_request(situation, behaviour),
        decisions=(
            *(one for _, one in rules.stops),
            *rules.passes,
            *_behind(situation),
            *_lets_in(situation),
            *(() if why is None else (why,)),
        ),
        memory=situation.memory._replace(overtaking=None),
    )


def _request(situation: Situation, behaviour: Behaviour) -> Request:
    """Ask for the curve of a lane change that begins now, or for another way when nobody lets the ego change."""
    changing = situation.changing
    if changing.side or changing.calls_off:
        left = changing.why is not None and changing.why.reason in LEAVES_FOR
        return Request(what=Replanning.CURVE, change_lane=changing.side, stays=left)
    return Request(what=Replanning.ROUTE) if behaviour is Behaviour.TAKING_ANOTHER_WAY else Request()


def _behind(situation: Situation) -> tuple[Decision, ...]:
    """Say that the ego follows X, and why X is not passed, if there is reason to: whom or what the simulated pass met."""
    x, proof = situation.ahead_of_ego, situation.proof
    if x is None or situation.memory.overtaking is not None or not overtaking.follows_x(situation):
        return ()
    if proof is None:
        return (Decision(behaviour=Behaviour.NORMAL, reason=Reason.FOLLOWS, cause=x.user.id, passes=True),)
    if proof.aside is not None:
        return ()
    return (Decision(behaviour=Behaviour.OVERTAKING, reason=Reason.NO_ROOM_TO_PASS, region=proof.obstacle, cause=x.user.id),)


def _lets_in(situation: Situation) -> tuple[Decision, ...]:
    """Say whom the ego lets in."""
    asker = situation.snapshot.asker
    if asker is None:
        return ()
    return (Decision(behaviour=Behaviour.NORMAL, reason=Reason.LETS_IN, cause=asker.user.id, passes=True),)


def _passing(situation: Situation, orders: Orders) -> Orders:
    """Return the orders with those of an overtaking that begins or goes on."""
    under_way = situation.memory.overtaking
    step = overtaking.carry_on(situation, under_way) if under_way else overtaking.begin(situation)
    if step is None:
        return orders
    reason, cause = step.reason or Reason.SLOW_AHEAD, step.cause or step.overtaking.user_ids[0]
    decision = Decision(behaviour=Behaviour.OVERTAKING, reason=reason, cause=cause, passes=reason is Reason.SLOW_AHEAD)
    return orders._replace(
        instruction=step.overtaking.instruction,
        stops=tuple(stop for stop in orders.stops if stop.reason is not Reason.BLOCKED),
        request=Request(what=Replanning.CURVE, aside=step.aside) if step.replans else orders.request,
        decisions=(*(d for d in orders.decisions if d.reason is not Reason.BLOCKED), decision),
        memory=situation.memory._replace(overtaking=step.overtaking),
        top_speed=step.top_speed,
    )


def _escaping(situation: Situation, orders: Orders) -> Orders:
    """Return the orders with a way out of a local minimum, if the ego is in one."""
    may_escape, memory = situation.limits.parameters.has(Mechanism.ESCAPE), orders.memory._replace(let_go=())
    way = (give_way(situation) or escape(situation)) if may_escape else None
    due = any(event.kind is EventKind.NO_PROGRESS for event in situation.events)
    if way is None:
        return orders._replace(memory=memory._replace(progress_time=situation.snapshot.time)) if due else orders
    if due:
        memory = memory._replace(escapes=memory.escapes + 1)
    return orders._replace(
        instruction=way.instruction or orders.instruction,
        stops=orders.stops if way.stop is None else (way.stop,),
        request=orders.request if orders.request.what is not Replanning.NOTHING else Request(what=way.replanning),
        decisions=(*(d for d in orders.decisions if d.reason is not way.decision.reason), way.decision),
        memory=memory._replace(let_go=way.let_go),
        top_speed=way.top_speed,
        slow_because=way.decision.reason,
        let_go=way.let_go,
    )


def _completed(
    situation: Situation,
    behaviour: Behaviour,
    orders: Orders,
    constraints: tuple[TimeConstraint, ...],
    rules: Rules,
    style: Style,
) -> CompletedPlan:
    return CompletedPlan(
        plan=situation.plan,
        behaviour=behaviour,
        instruction=orders.instruction,
        tuning=_tuning(orders.instruction, style, situation.limits.parameters),
        constraints=constraints,
        intent=intent_of(min(orders.stops, key=lambda stop: stop.s, default=None), situation.snapshot, situation.memory),
        decisions=orders.decisions,
        request=orders.request,
        sight=_sight(situation, behaviour),
        assessment=situation.assessment,
        events=situation.events,
        regions=rules.regions,
        rooms=rules.rooms,
        let_go=orders.let_go,
    )


def _limits_of(orders: Orders, changing: LaneChanging, snapshot: Snapshot) -> tuple[TimeConstraint, ...]:
    """Return what limits the ego beside the schedule: where to stop, whom to fall in behind or let in, how slow to fall
    back."""
    found = list(orders.stops)
    if snapshot.asker is not None:
        found.append(TimeConstraint(snapshot.front, reason=Reason.LETS_IN, behind=snapshot.asker.user.id))
    if changing.slot:
        found.append(TimeConstraint(snapshot.front, reason=Reason.NO_GAP, behind=changing.slot))
    if orders.top_speed < math.inf:
        found.append(TimeConstraint(snapshot.front, speed=orders.top_speed, reason=orders.slow_because))
    return tuple(found)


def _tuning(instruction: Instruction, style: Style, parameters: Parameters) -> Tuning:
    tunings = PAPER_TUNINGS if style.paper else TUNINGS
    return tunings[instruction if parameters.has(Mechanism.TUNING) else Instruction.FOLLOW_CURVE]


def _sight(situation: Situation, behaviour: Behaviour) -> float:
    """How far to look along the oncoming lane: far while the ego overtakes, or would if it had the gap."""
    wants = behaviour is Behaviour.OVERTAKING or (overtaking.follows_x(situation) and overtaking.is_legal(situation))
    return situation.limits.parameters.overtaking_sight_m if wants else 0.0
