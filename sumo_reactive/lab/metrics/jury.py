"""The jury: all judges, one look a step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.lab.fault import Fault, MetricFailure
from sumo_reactive.lab.metrics.comfort import Comfort, PilotActivity, Timing
from sumo_reactive.lab.metrics.encounters import Collisions, HardBraking, PostEncroachment, TimeToCollision
from sumo_reactive.lab.metrics.moment import Figures, Moment, Watch
from sumo_reactive.lab.metrics.rules import RedLights, RightOfWayViolations
from sumo_reactive.lab.metrics.safety.surrogate import SurrogateSafety
from sumo_reactive.lab.metrics.score import Score
from sumo_reactive.lab.own_metrics import MetricSource, function_of, measured


class _Judge(Protocol):
    def see(self, moment: Moment) -> None: ...
    def figures(self) -> Figures: ...


class Jury:
    """Judges a trip of an ego of the given size (m), also by metrics of the user's `own`."""

    def __init__(
        self, length_m: float, width_m: float, wheelbase_m: float, own: Sequence[MetricSource] = ()
    ) -> None:
        self._watch, self._timing = Watch(length_m, width_m), Timing()
        self._own, self._steps = own, list[StepRecord]()
        for source in own:
            function_of(source)  # what cannot be loaded is told before the trip
        self._safety = SurrogateSafety(length_m, width_m)
        self._accusers = Collisions(), RedLights(), RightOfWayViolations(), HardBraking()
        how_near = TimeToCollision(), PostEncroachment(length_m, width_m), self._safety
        self._judges: tuple[_Judge, ...] = (
            *self._accusers[:-1], *how_near, self._accusers[-1], Comfort(wheelbase_m), Score(), PilotActivity(),
        )  # fmt: skip

    def see(self, scene: Scene) -> None:
        """Judge one step."""
        moment = self._watch.moment(scene)
        for judge in self._judges:
            judge.see(moment)
        self._timing.see(moment)
        if self._own:
            self._steps.append(scene.step)

    def figures(self) -> Figures:
        """Return every figure that the same seed gives again, units in the keys."""
        return {name: value for judge in self._judges for name, value in judge.figures().items()}

    def own_figures(self) -> tuple[dict[str, float | None], tuple[MetricFailure, ...]]:
        """Return what the user's own metrics say, and which of them failed."""
        return measured(self._own, self._steps, self._safety.encounters) if self._own else ({}, ())

    def timing(self) -> dict[str, float]:
        """Return the wall-clock figures."""
        return self._timing.figures()

    @property
    def faults(self) -> tuple[Fault, ...]:
        """What the ego did to others and against rules, in order of time."""
        found = (fault for judge in self._accusers for fault in judge.faults)
        return tuple(sorted(found, key=lambda fault: fault.time))
