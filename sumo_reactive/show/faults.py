"""Why a case failed: what was not met, what the pilot had judged before, what it did around, and how to see it again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from sumo_reactive.driver.nouns.decision import Decision
from sumo_reactive.lab.check import Verdict
from sumo_reactive.lab.result import Collision, Fault, HardBrake, TrialResult
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.explain import decision_told, paragraph

MOST_FAULTS = 3
"""So many faults of a case are told in full."""

ENTRIES_BEFORE = 3
"""So many entries of the trace are told before a fault."""

JUDGEMENT_AGE_S = 10.0
"""An older decision to go on is not why something happened, s."""

REPLAY_LABEL = "replay: "
CLOSE_S = 1e-6
"""Times nearer than this are the same, s."""

FAULT_WORDS: dict[type[Fault], str] = {
    Collision: "ran into {user}",
    HardBrake: "made {user} brake hard",
}
RIGHT_OF_WAY = "got into the way of {user}"


class Judgement(NamedTuple):
    """What the pilot decided at `time` (s) about the one who suffered later."""

    time: float
    entry: Entry
    decision: Decision


def failure_told(verdict: Verdict) -> Iterator[str]:
    """Yield the reasons, the faults with the judgements before them, the trace around them and the replay, a line each."""
    yield from verdict.reasons
    result, entries = verdict.outcome.result, verdict.outcome.entries
    if result is not None:
        faults = faults_of(result)
        for fault in faults[:MOST_FAULTS]:
            yield f"{fault_told(fault, entries)}:"
            yield from _trace(entries, fault.time)
        if len(faults) > MOST_FAULTS:
            yield f"… and {len(faults) - MOST_FAULTS} more"
        waits = longest_waits(entries, result.end_s) if result.arrived and not faults else []
        if waits:
            yield "what it waited for longest:"
            yield from (_line(entries, k) for k in waits)
        elif not faults:
            yield "the last decisions:"
            yield from _trace(entries, math.inf)
    yield f"{REPLAY_LABEL}{verdict.case.replay}"


def faults_of(result: TrialResult) -> list[Fault]:
    """Return what the ego did to others and against rules, in order of time."""
    return sorted((*result.collisions, *result.violations, *result.hard_brakes), key=lambda fault: fault.time)


def fault_told(fault: Fault, entries: Sequence[Entry]) -> str:
    """Return who suffered when, what the pilot had judged of him, and what came of it."""
    if not fault.user_id:
        return f"at {fault.time:.1f} s: {str(fault).removesuffix(f' at {fault.time:.1f} s')}"
    did = FAULT_WORDS.get(type(fault), RIGHT_OF_WAY).format(user=fault.user_id)
    judged = judgement_of(fault, entries)
    if judged is None:
        return f"{did} at {fault.time:.1f} s; no decision before speaks of it"
    told = decision_told(judged.decision, judged.entry.instruction)
    return f"{did} at {fault.time:.1f} s; at {judged.time:.1f} s the ego judged: {told}{_came(fault, judged)}"


def judgement_of(fault: Fault, entries: Sequence[Entry]) -> Judgement | None:
    """Return the last decision about the one who suffered: rather one, not long before, by which the ego went on."""
    about = [
        Judgement(entry.time, entry, decision)
        for entry in entries
        if entry.time <= fault.time + CLOSE_S
        for decision in entry.decisions
        if decision.cause == fault.user_id
    ]

    def weight(one: Judgement) -> tuple[bool, float, bool]:
        is_why = one.decision.passes and fault.time - one.time <= JUDGEMENT_AGE_S
        return is_why, one.time, bool(one.decision.figures)

    return max(about, key=weight, default=None)


def longest_waits(entries: Sequence[Entry], end: float) -> list[int]:
    """Return the indices, in order of time, of the entries that kept the ego from going on for longest; `end` in s."""
    ends = [*(entry.time for entry in entries[1:]), end]
    lasting = {
        k: ends[k] - entry.time
        for k, entry in enumerate(entries)
        if any(not decision.passes for decision in entry.decisions)
    }
    return sorted(sorted(lasting, key=lambda k: -lasting[k])[:ENTRIES_BEFORE])


def _came(fault: Fault, judged: Judgement) -> str:
    """Return how what happened differs from the figures of the judgement, as far as the fault's time tells."""
    figures, after = dict(judged.decision.figures), fault.time - judged.time
    if not judged.decision.passes or not {"clearance_s", "foe_arrival_s"} <= set(figures):
        return f"; that was {after:.1f} s before"
    clears, arrives = figures["clearance_s"], figures["foe_arrival_s"]
    if clears >= arrives:
        return f"; {'they met' if isinstance(fault, Collision) else 'it suffered'} after {after:.1f} s"
    if after >= arrives:
        return f"; the ego was still there after {after:.1f} s"
    if isinstance(fault, Collision):
        return f"; judged the gap {arrives:.1f} s, it was {after:.1f} s"
    late = after - clears
    ego = f"{-late:.1f} s before the ego was to be clear" if late < 0.0 else f"when the ego was late by {late:.1f} s"
    return f"; it suffered after {after:.1f} s, {arrives - after:.1f} s before it was expected there, {ego}"


def _trace(entries: Sequence[Entry], until: float) -> Iterator[str]:
    """Yield the last entries up to a time (s), a line each."""
    last = sum(entry.time <= until + CLOSE_S for entry in entries)
    yield from (_line(entries, k) for k in range(max(0, last - ENTRIES_BEFORE), last))


def _line(entries: Sequence[Entry], k: int) -> str:
    return f"  {entries[k].time:.1f} s  {paragraph(entries[k], entries[k - 1] if k else None)}"
