"""The pilot's entries and the ego's faults as one table in order of time, and as texts to hover over."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from html import escape

from sumo_reactive.lab.result import Fault
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.explain import paragraph
from sumo_reactive.show.faults import fault_told
from sumo_reactive.show.frame.colours import BEHAVIOUR_COLOURS
from sumo_reactive.show.frame.page import Html, table

_HEAD = ("time (s)", "behaviour", "what happened, what going on would lead to, what the ego does and why")
_WIDTH = 72
"""Characters in a line of a text to hover over."""


def decision_table(entries: Sequence[Entry], faults: Sequence[Fault]) -> Html:
    """Return every entry and every fault, a row each."""
    return table(_HEAD, [row for _, row in sorted(_rows(entries, faults), key=lambda one: one[0])], is_long=True)


def hover_of(entries: Sequence[Entry], k: int) -> str:
    """Return the k-th entry in lines short enough to hover over; what could be a mark-up is escaped."""
    return _in_lines(paragraph(entries[k], entries[k - 1] if k else None))


def fault_hover(fault: Fault, entries: Sequence[Entry]) -> str:
    """Return a fault, and what the pilot had judged before, in lines short enough to hover over."""
    return _in_lines(fault_told(fault, entries))


def fault_sentence(fault: Fault, entries: Sequence[Entry]) -> str:
    """Return a fault, and what the pilot had judged before, as a sentence."""
    told = fault_told(fault, entries)
    return f"{told[0].upper()}{told[1:]}."


def _rows(entries: Sequence[Entry], faults: Sequence[Fault]) -> Iterator[tuple[float, tuple[str, str, str]]]:
    for k, entry in enumerate(entries):
        chip = f'<span class="chip" style="background:{BEHAVIOUR_COLOURS[entry.behaviour]}"></span>'
        behaviour = Html(f"{chip}{escape(entry.behaviour.value)}")
        yield entry.time, (f"{entry.time:.1f}", behaviour, paragraph(entry, entries[k - 1] if k else None))
    for fault in faults:
        yield fault.time, (f"{fault.time:.1f}", Html('<span class="bad">fault</span>'), fault_sentence(fault, entries))


def _in_lines(text: str) -> str:
    return "<br>".join(escape(line) for line in textwrap.wrap(text, _WIDTH))
