"""Red lights run."""

from __future__ import annotations

from sumo_reactive.lab.metrics.moment import Figures, Moment
from sumo_reactive.lab.result import Violation

NO_GO = frozenset("rRu")
"""Red, and red with yellow; "s" (stop, then go) is not among them."""


class RedLights:
    """Counts stop lines crossed under a letter that forbids it, before the step and in it.

    Lights and the line are SUMO's, not what the driver has seen of them.
    """

    def __init__(self) -> None:
        self.violations: list[Violation] = []

    def see(self, moment: Moment) -> None:
        """Note a crossing on red."""
        if moment.crossed and NO_GO.issuperset(moment.crossed):
            self.violations.append(Violation(moment.step.time, "red light run", moment.step.lane_id))

    def figures(self) -> Figures:
        """Return the number of red lights run."""
        return {"red_lights_run": len(self.violations)}
