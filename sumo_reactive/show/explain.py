"""Why the ego did what it did: a recorded run told in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from itertools import groupby
from typing import Any

from sumo_reactive.driver.nouns.assessment import Assessment
from sumo_reactive.driver.nouns.decision import Decision, Instruction
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.metric_names import event_key
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show import sentences
from sumo_reactive.show.recording import CLOSE_S, Recording, state_at


def story(recording: Recording) -> Iterator[str]:
    """Yield the whole run: a header, a line an entry, and what the pilot had to do."""
    yield header(recording)
    for before, entry in zip((None, *recording.entries), recording.entries, strict=False):
        yield f"{entry.time:.1f} s  {paragraph(entry, before)}"
    yield from (f"{time:.1f} s  {_said(reason)}" for time, reason in recording.reasons)
    if not recording.reasons:
        yield footer(recording.summary["figures"])


def moment(recording: Recording, time: float) -> Iterator[str]:
    """Yield everything that was in force at `time` (s); raise ScenarioError for a time outside the run."""
    ego = state_at(recording, time)
    if said := [reason for since, reason in recording.reasons if since <= time + CLOSE_S]:
        yield from (header(recording), _state_text(ego), _said(said[-1]))
        return
    found = [i for i, entry in enumerate(recording.entries) if entry.time <= time + CLOSE_S]
    if not found:
        raise ScenarioError(f"{recording.folder}: nothing was decided up to {time:g} s")
    index = found[-1]
    before = recording.entries[index - 1] if index else None
    yield header(recording)
    yield _state_text(ego)
    yield from _in_full(recording.entries[index], before)
    for label, near in (("before", recording.entries[:index][-1:]), ("next", recording.entries[index + 1 :][:1])):
        yield from (f"{label:<11} {entry.time:.1f} s  {in_short(entry)}" for entry in near)


def _said(reason: str) -> str:
    """Return what a driver of the user's gave as its reason."""
    return f"The driver: {reason}." if reason else "The driver gives no reason."


_TOLD = 3
"""So many reasons of a behaviour are told in brief."""


def brief(recording: Recording) -> Iterator[str]:
    """Yield the run in brief: a header, and a line a behaviour, from when on, with its reasons, stops first."""
    yield header(recording)
    for behaviour, group in groupby(recording.entries, key=lambda entry: entry.behaviour):
        entries = list(group)
        yield f"{entries[0].time:.1f} s  {sentences.BEHAVIOURS[behaviour]}: {_reasons_told(entries)}."


def _reasons_told(entries: Sequence[Entry]) -> str:
    """Return what an ego did in some entries of one behaviour, and why, once for each reason and road user."""
    said: dict[tuple[object, ...], tuple[Decision, Instruction]] = {}
    for entry in entries:
        for one in _nearest(entry.decisions):
            said.setdefault((one.reason, one.cause, one.passes), (one, entry.instruction))
    ordered = sorted(said.values(), key=lambda pair: pair[0].passes)
    clauses = [decision_told(*pair, with_figures=False) for pair in ordered]
    if not clauses:
        return sentences.INSTRUCTIONS[entries[-1].instruction]
    more = len(clauses) - _TOLD
    return "; ".join(clauses[:_TOLD]) + (f"; and {more} more" if more > 0 else "")


def about(recording: Recording, user_id: str) -> Iterator[str]:
    """Yield what a road user had to do with the run, a line an entry that names him; raise ScenarioError if none does."""
    told = [(entry, " ".join(_said_about(entry, user_id))) for entry in recording.entries]
    if not any(text for _, text in told):
        known = sorted({name for entry in recording.entries for name in _named(entry)})
        near = get_close_matches(user_id, known, n=3)
        raise ScenarioError(
            f"{recording.folder}: nothing was decided about '{user_id}'" + (f"; near it: {', '.join(near)}" if near else "")
        )
    yield header(recording)
    yield from (f"{entry.time:.1f} s  {text}" for entry, text in told if text)


def _named(entry: Entry) -> Iterator[str]:
    """Yield the causes that an entry names: road users, lights and places."""
    yield from (event.cause for event in entry.events)
    yield from (decision.cause for decision in entry.decisions)
    yield from ([entry.assessment.encounter.user_id] if entry.assessment.encounter else [])
    yield entry.hazard


def _said_about(entry: Entry, user_id: str) -> Iterator[str]:
    """Yield the sentences of an entry that name a road user."""
    meets = entry.assessment.encounter
    parts = events_told(event for event in entry.events if event.cause == user_id)
    parts += [assessment_told(entry.assessment)] if meets and meets.user_id == user_id else []
    parts += [sentences.EMERGENCY_BRAKING.format(user_id)] if entry.emergency and entry.hazard == user_id else []
    decisions = _nearest(one for one in entry.decisions if one.cause == user_id)
    parts += [f"the ego {decision_told(one, entry.instruction)}" for one in decisions]
    yield from (f"{part[0].upper()}{part[1:]}." for part in parts)


def header(recording: Recording) -> str:
    """Who drove where, and how it ended."""
    summary = recording.summary
    return f"{summary['ego']} in {summary['scenario']}: {summary['verdict']}."


def footer(figures: Mapping[str, Any]) -> str:
    """How often the pilot ran, and what activated it, the most frequent first."""
    runs, share = figures.get("pilot_activations", 0), figures.get("pilot_free_share")
    counts = [(figures.get(event_key(kind), 0), kind) for kind in EventKind]
    told = [f"{sentences.EVENTS[kind]} ({count})" for count, kind in sorted(counts, key=lambda one: -one[0]) if count]
    rested = "" if share is None else f"; {100.0 * share:.0f} % of the steps went without it"
    return f"The pilot decided {runs} times{rested}." + (f" What activated it: {', '.join(told)}." if told else "")


def paragraph(entry: Entry, before: Entry | None = None) -> str:
    """Return event, assessment, behaviour and instruction, and the rule and the road user behind them, as sentences."""
    ending = sentences.ENDINGS.get((before.behaviour, entry.behaviour), "") if before else ""
    braking = sentences.EMERGENCY_BRAKING.format(entry.hazard) if entry.hazard else sentences.ALONG_C
    emergency = braking if entry.emergency else ""
    parts = (*events_told(entry.events), assessment_told(entry.assessment), emergency, ending, _behaviour_told(entry))
    return " ".join(f"{part[0].upper()}{part[1:]}." for part in parts if part)


def in_short(entry: Entry) -> str:
    """Return behaviour, instruction and reasons, without figures."""
    return f"{_behaviour_told(entry, with_figures=False)}."


def events_told(events: Iterable[Event]) -> list[str]:
    """Return a sentence for each kind of event, with its causes."""
    causes: dict[EventKind, list[str]] = {}
    for event in events:
        causes.setdefault(event.kind, []).extend([event.cause] if event.cause else [])
    return [sentences.EVENTS[kind] + (f" ({', '.join(found)})" if found else "") for kind, found in causes.items()]


def assessment_told(assessment: Assessment) -> str:
    """Return what would have happened, and when."""
    meets = assessment.encounter
    user, time = (meets.user_id, meets.time) if meets else ("somebody", math.nan)
    return sentences.OUTCOMES[assessment.outcome].format(lateness=assessment.lateness, user=user, time=time)


def decision_told(decision: Decision, instruction: Instruction, named: str = "", *, with_figures: bool = True) -> str:
    """Return what the ego does because of a decision: "stops before region r, since veh_12 has priority (…)".

    `named`: the region that has been named already.
    """
    wording, figures = sentences.REASONS[decision.reason], dict(decision.figures)
    usual = wording.passes if decision.passes else wording.waits
    order = _order(decision, figures).removeprefix("merges ")
    text = sentences.MEANWHILE.get((instruction, decision.reason), usual)
    place = "the same region" if decision.region == named else f"region {decision.region}"
    text = text.format(order=order, cause=decision.cause or "somebody", place=place, region=decision.region)
    told = _figures_told(decision, figures) if with_figures else ""
    return f"{text} ({told})" if told else text


def _figures_told(decision: Decision, figures: Mapping[str, float]) -> str:
    if not all(math.isfinite(value) for value in figures.values()):
        return ""
    if "foe_arrival_s" in figures:
        return sentences.MEETINGS[decision.passes, _order(decision, figures)].format(**figures)
    return sentences.BRAKING.format(**figures) if "to_line_m" in figures else ""


def _order(decision: Decision, figures: Mapping[str, float]) -> str:
    """Who would be in the region first: the ego "before" or "after" the other, the two "together", the other "inside"."""
    if "foe_arrival_s" not in figures:
        return "before"
    leaves_first = figures["clearance_s"] < figures["foe_arrival_s"]
    if decision.passes and figures["arrival_s"] < figures["foe_arrival_s"]:
        return "before" if leaves_first else "merges before"
    if decision.passes:
        return "after"
    if figures["foe_arrival_s"] <= 0.0:
        return "inside"
    comes_later = figures["foe_clearance_s"] < figures["arrival_s"]
    return "before" if leaves_first else "after" if comes_later else "together"


def _behaviour_told(entry: Entry, *, with_figures: bool = True) -> str:
    """Return behaviour, instruction and a clause a decision; a decision to stop says more than the instruction."""
    decisions = _nearest(sorted(entry.decisions, key=lambda decision: decision.passes))
    named = ["", *(decision.region for decision in decisions[:-1])]
    clauses = [
        decision_told(decision, entry.instruction, region, with_figures=with_figures)
        for decision, region in zip(decisions, named, strict=False)
    ]
    stops = any(not decision.passes for decision in decisions)
    if entry.instruction is not Instruction.STOP or not stops:
        clauses.insert(0, sentences.INSTRUCTIONS[entry.instruction])
    return f"{sentences.BEHAVIOURS[entry.behaviour]}: {'; '.join(clauses)}"


def _nearest(decisions: Iterable[Decision]) -> list[Decision]:
    """Return one decision for each road user and reason: at the first of the regions where they meet."""
    kept: dict[tuple[object, ...], Decision] = {}
    for decision in decisions:
        key = decision.reason, decision.cause, decision.passes
        if key not in kept or _arrival(decision) < _arrival(kept[key]):
            kept[key] = decision
    return list(kept.values())


def _arrival(decision: Decision) -> float:
    return dict(decision.figures).get("arrival_s", math.inf)


def _state_text(ego: Mapping[str, Any]) -> str:
    if ego["desired_speed_m_s"] is None:  # a driver that tells no more
        return f"{ego['time_s']:.1f} s: the ego drives at {ego['speed_m_s']:.1f} m/s."
    leader, gap = ego["leader"], ego["gap_m"]
    behind = f"behind {leader} at {gap:.1f} m" if leader and gap is not None else "no leader"
    speeds = f"drives at {ego['speed_m_s']:.1f} m/s, wants {ego['desired_speed_m_s']:.1f} m/s"
    return f"{ego['time_s']:.1f} s: the ego {speeds}, {behind}."


def _in_full(entry: Entry, before: Entry | None) -> Iterator[str]:
    """Yield the paragraph of an entry, then everything that it holds, a line each."""
    yield f"in force since {entry.time:.1f} s: {paragraph(entry, before)}"
    yield from (f"{'event':<11} {event.kind.value}{f' ({event.cause})' if event.cause else ''}" for event in entry.events)
    yield f"{'assessment':<11} {_assessment_in_full(entry.assessment)}"
    yield f"{'behaviour':<11} {entry.behaviour.value}"
    yield f"{'instruction':<11} {entry.instruction.value}"
    for decision in entry.decisions:
        told = decision_told(decision, entry.instruction, with_figures=False)
        yield f"{'decision':<11} {decision.behaviour.value}: {told}"
        figures = [sentences.FIGURES.get(name, name + " {:.2f}").format(value) for name, value in decision.figures]
        yield from ([f"{'':<11}   {', '.join(figures)}"] if figures else [])
    for state in entry.regions:
        user = f" ({state.user_id})" if state.user_id else ""
        yield f"{'region':<11} {state.region}: {state.occupancy.value}{user}"


def _assessment_in_full(assessment: Assessment) -> str:
    late = f"{assessment.outcome.value}, {assessment.lateness:.1f} s late for {assessment.constraint:.1f} m of C"
    meets = assessment.encounter
    if meets is None:
        return late
    place = f"{meets.s:.1f} m of C (x {meets.x:.1f} m, y {meets.y:.1f} m)"
    return f"{late}, touches {meets.user_id} at {meets.time:.1f} s, {place}"
