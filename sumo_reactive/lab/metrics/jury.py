"""The jury: all judges, one look a step."""

from __future__ import annotations

from typing import Protocol

from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.lab.metrics.comfort import Comfort, PilotActivity, Timing
from sumo_reactive.lab.metrics.encounters import Collisions, HardBraking, PostEncroachment, TimeToCollision
from sumo_reactive.lab.metrics.moment import Figures, Moment, Watch
from sumo_reactive.lab.metrics.rules import RedLights, RightOfWayViolations
from sumo_reactive.lab.result import Collision, HardBrake, Violation


class _Judge(Protocol):
    def see(self, moment: Moment) -> None: ...
    def figures(self) -> Figures: ...


class Jury:
    """Judges a trip of an ego of the given size (m); without `graph` nobody judges the right of way."""

    def __init__(self, length_m: float, width_m: float, wheelbase_m: float, graph: RoadGraph | None = None) -> None:
        self._watch = Watch(length_m, width_m)
        self._collisions, self._red_lights, self._right_of_way = Collisions(), RedLights(), RightOfWayViolations(graph)
        self._hard_braking, self._timing = HardBraking(), Timing()
        self._judges: tuple[_Judge, ...] = (
            self._collisions,
            self._red_lights,
            self._right_of_way,
            TimeToCollision(),
            PostEncroachment(length_m, width_m),
            self._hard_braking,
            Comfort(wheelbase_m),
            PilotActivity(),
        )

    def enter(self, graph: RoadGraph) -> None:
        """Judge in the world around a new route from now on."""
        self._right_of_way.enter(graph)

    def see(self, scene: Scene) -> None:
        """Judge one step."""
        moment = self._watch.moment(scene)
        for judge in self._judges:
            judge.see(moment)
        self._timing.see(moment)

    def figures(self) -> Figures:
        """Return every figure that the same seed gives again, units in the keys."""
        return {name: value for judge in self._judges for name, value in judge.figures().items()}

    def timing(self) -> dict[str, float]:
        """Return the wall-clock figures."""
        return self._timing.figures()

    @property
    def collisions(self) -> tuple[Collision, ...]:
        """Every collision, in order of time."""
        return tuple(self._collisions.collisions)

    @property
    def hard_brakes(self) -> tuple[HardBrake, ...]:
        """Every hard braking caused, in order of time."""
        return tuple(self._hard_braking.hard_brakes)

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Red lights run and rights of way taken, in order of time."""
        found = (*self._red_lights.violations, *self._right_of_way.violations)
        return tuple(sorted(found, key=lambda violation: violation.time))
