"""Faults and decisions told to people: what the pilot had judged before a fault, why a case failed, a table of all."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from operator import attrgetter
from typing import Any, NamedTuple

from sumo_reactive.driver.nouns.decision import Decision
from sumo_reactive.lab.check import Verdict
from sumo_reactive.lab.fault import COLLISION, HARD_BRAKING, Fault
from sumo_reactive.lab.recorder import PAGE
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.explain import decision_told, paragraph
from sumo_reactive.show.page import BEHAVIOUR_COLOURS, Html, table
from sumo_reactive.show.recording import CLOSE_S

_MOST_FAULTS, _ENTRIES_BEFORE = 3, 3
"""So many faults of a case are told in full, and so many entries of the trace before each."""

_JUDGEMENT_AGE_S = 10.0
"""An older decision to go on is not why something happened, s."""

_FAULT_WORDS = {COLLISION: "ran into {user}", HARD_BRAKING: "made {user} brake hard"}
_RIGHT_OF_WAY = "got into the way of {user}"
_RECORDED = {"collisions": COLLISION, "violations": "", "hard_brakes": HARD_BRAKING}
"""Lists of faults in a summary, and the kind of all in them (empty: each says its own)."""

_HEAD = ("time (s)", "behaviour", "what happened, what going on would lead to, what the ego does and why")
_HOVER_WIDTH = 72
"""Characters in a line of a text to hover over."""


class EarlierJudgement(NamedTuple):
    """What the pilot decided at `time` (s) about the one who suffered later."""

    time: float
    entry: Entry
    decision: Decision


def failure_told(verdict: Verdict) -> Iterator[str]:
    """Yield the reasons, the faults with the judgements before them, the trace around them and the replay, a line each."""
    yield from verdict.reasons
    result, entries = verdict.outcome.result, verdict.outcome.entries
    if result is not None:
        yield from (line for failure in result.metric_failures for line in failure.traceback)
        faults = result.faults
        for fault in faults[:_MOST_FAULTS]:
            yield f"{fault_told(fault, entries)}:"
            yield from _trace(entries, fault.time)
            yield from reasons_before(verdict.outcome.reasons, fault.time)
        if len(faults) > _MOST_FAULTS:
            yield f"… and {len(faults) - _MOST_FAULTS} more"
        waits = longest_waits(entries, result.end_s) if result.arrived and not faults else []
        if waits:
            yield "what it waited for longest:"
            yield from (_line(entries, k) for k in waits)
        elif not faults and entries:
            yield "the last decisions:"
            yield from _trace(entries, math.inf)
        yield from result.failure.splitlines()
    yield f"replay: {verdict.case.replay}"
    if verdict.record is not None:
        yield f"record: {verdict.record}, page: {verdict.record / PAGE}"


def reasons_before(reasons: Sequence[tuple[float, str]], time: float) -> Iterator[str]:
    """Yield what a driver of the user's gave last as its reasons before a time (s), a line each."""
    before = [(since, reason) for since, reason in reasons if since <= time + CLOSE_S and reason]
    yield from (f"  {since:.1f} s  the driver: {reason}" for since, reason in before[-_ENTRIES_BEFORE:])


def faults_in(summary: Mapping[str, Any]) -> list[Fault]:
    """Return what the ego did to others and against rules by a recorded summary, in order of time."""
    found = (
        Fault(one["time_s"], kind or one["kind"], one["user_id"], one["lane_id"])
        for name, kind in _RECORDED.items()
        for one in summary.get(name, ())
    )
    return sorted(found, key=attrgetter("time"))


def fault_told(fault: Fault, entries: Sequence[Entry]) -> str:
    """Return who suffered when, what the pilot had judged of him, and what came of it."""
    if not fault.user_id:
        return f"at {fault.time:.1f} s: {fault.what}"
    did = _FAULT_WORDS.get(fault.kind, _RIGHT_OF_WAY).format(user=fault.user_id)
    judged = judgement_of(fault, entries)
    if judged is None:
        return f"{did} at {fault.time:.1f} s; no decision before speaks of it"
    told = decision_told(judged.decision, judged.entry.instruction)
    return f"{did} at {fault.time:.1f} s; at {judged.time:.1f} s the ego judged: {told}{_came(fault, judged)}"


def fault_sentence(fault: Fault, entries: Sequence[Entry]) -> str:
    """Return `fault_told` as a sentence."""
    told = fault_told(fault, entries)
    return f"{told[0].upper()}{told[1:]}."


def judgement_of(fault: Fault, entries: Sequence[Entry]) -> EarlierJudgement | None:
    """Return the last decision about the one who suffered: rather one, not long before, by which the ego went on."""
    about = [
        EarlierJudgement(entry.time, entry, decision)
        for entry in entries
        if entry.time <= fault.time + CLOSE_S
        for decision in entry.decisions
        if decision.cause == fault.user_id
    ]

    def weight(one: EarlierJudgement) -> tuple[bool, float, bool]:
        is_why = one.decision.passes and fault.time - one.time <= _JUDGEMENT_AGE_S
        return is_why, one.time, bool(one.decision.figures)

    return max(about, key=weight, default=None)


def longest_waits(entries: Sequence[Entry], end: float) -> list[int]:
    """Return the indices, in order of time, of the entries that kept the ego from going on for longest; `end` in s."""
    ends = [*(entry.time for entry in entries[1:]), end]
    waiting = (k for k, entry in enumerate(entries) if any(not decision.passes for decision in entry.decisions))
    return sorted(sorted(waiting, key=lambda k: entries[k].time - ends[k])[:_ENTRIES_BEFORE])


def decision_table(entries: Sequence[Entry], faults: Sequence[Fault]) -> Html:
    """Return every entry and every fault, a row each, in order of time."""
    rows: list[tuple[float, str, str]] = []
    for k, entry in enumerate(entries):
        chip = f'<span class="chip" style="background:{BEHAVIOUR_COLOURS[entry.behaviour]}"></span>'
        rows.append((entry.time, Html(f"{chip}{escape(entry.behaviour.value)}"), _entry_told(entries, k)))
    bad = Html('<span class="bad">fault</span>')
    rows += [(fault.time, bad, fault_sentence(fault, entries)) for fault in faults]
    ordered = sorted(rows, key=lambda row: row[0])
    return table(_HEAD, [(f"{time:.1f}", *told) for time, *told in ordered], is_long=True)


def hover_of(entries: Sequence[Entry], k: int) -> str:
    """Return the k-th entry in lines short enough to hover over; what could be a mark-up is escaped."""
    return _in_lines(_entry_told(entries, k))


def fault_hover(fault: Fault, entries: Sequence[Entry]) -> str:
    """Return `fault_told` in such lines."""
    return _in_lines(fault_told(fault, entries))


def _in_lines(text: str) -> str:
    return "<br>".join(escape(line) for line in textwrap.wrap(text, _HOVER_WIDTH))


def _entry_told(entries: Sequence[Entry], k: int) -> str:
    return paragraph(entries[k], entries[k - 1] if k else None)


def _came(fault: Fault, judged: EarlierJudgement) -> str:
    """Return how what happened differs from the figures of the judgement, as far as the fault's time tells."""
    figures, after = dict(judged.decision.figures), fault.time - judged.time
    if not judged.decision.passes or not {"clearance_s", "foe_arrival_s"} <= set(figures):
        return f"; that was {after:.1f} s before"
    clears, arrives = figures["clearance_s"], figures["foe_arrival_s"]
    if clears >= arrives:
        return f"; {'they met' if fault.kind == COLLISION else 'it suffered'} after {after:.1f} s"
    if after >= arrives:
        return f"; the ego was still there after {after:.1f} s"
    if fault.kind == COLLISION:
        return f"; judged the gap {arrives:.1f} s, it was {after:.1f} s"
    late = after - clears
    ego = f"{-late:.1f} s before the ego was to be clear" if late < 0.0 else f"when the ego was late by {late:.1f} s"
    return f"; it suffered after {after:.1f} s, {arrives - after:.1f} s before it was expected there, {ego}"


def _trace(entries: Sequence[Entry], until: float) -> Iterator[str]:
    """Yield the last entries up to a time (s), a line each."""
    last = sum(entry.time <= until + CLOSE_S for entry in entries)
    yield from (_line(entries, k) for k in range(max(0, last - _ENTRIES_BEFORE), last))


def _line(entries: Sequence[Entry], k: int) -> str:
    return f"  {entries[k].time:.1f} s  {_entry_told(entries, k)}"
