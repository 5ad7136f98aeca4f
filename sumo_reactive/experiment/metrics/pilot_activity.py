"""How often the pilot ran, and what activated it (F&L 1991, §2: between events it does not run)."""

from __future__ import annotations

from collections import Counter

from sumo_reactive.experiment.metrics.moment import Figures, Moment
from sumo_reactive.messages.event import EventKind


class PilotActivity:
    """Steps in which the pilot ran, share of those that needed none, events by kind."""

    def __init__(self) -> None:
        self._steps = self._activations = 0
        self._events: Counter[EventKind] = Counter()

    def see(self, moment: Moment) -> None:
        """Add one step."""
        self._steps += 1
        self._activations += moment.step.pilot
        for event in moment.step.events:
            self._events[event.kind] += 1

    def figures(self) -> Figures:
        """Return the figures; the share (0..1) is None without a step."""
        share = round(1.0 - self._activations / self._steps, 4) if self._steps else None
        activity: Figures = {"pilot_activations": self._activations, "pilot_free_share": share}
        return activity | {key_of(kind): self._events[kind] for kind in EventKind}


def key_of(kind: EventKind) -> str:
    """Return the figure that counts a kind of event."""
    return f"events_{kind.name.lower()}"
