"""How often the pilot ran, and what activated it (F&L 1991, §2: between events it does not run)."""

from __future__ import annotations

from collections import Counter

from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.lab.metric_names import event_key
from sumo_reactive.lab.metrics.moment import Figures, Moment


class PilotActivity:
    """Steps in which the pilot decided, runs of the highway code, share of the steps that needed neither, events by kind."""

    def __init__(self) -> None:
        self._steps = self._activations = self._asked = self._free = 0
        self._events: Counter[EventKind] = Counter()

    def see(self, moment: Moment) -> None:
        """Add one step."""
        if moment.step.pilot is None:  # SUMO's own driver has none
            return
        asked = moment.step.asked or 0
        self._steps += 1
        self._activations += moment.step.pilot
        self._asked += asked
        self._free += not (moment.step.pilot or asked)
        for event in moment.step.events:
            self._events[event.kind] += 1

    def figures(self) -> Figures:
        """Return the figures, the share from 0 to 1; None without a pilot."""
        steps = self._steps
        activity: Figures = {
            "pilot_activations": self._activations,
            "highway_code_runs": self._asked,
            "pilot_free_share": round(self._free / steps, 4) if steps else None,
        }
        activity |= {event_key(kind): self._events[kind] for kind in EventKind}
        return activity if steps else dict.fromkeys(activity)
