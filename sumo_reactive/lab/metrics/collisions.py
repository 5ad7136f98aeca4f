"""Collisions: the ego's box overlaps another's."""

from __future__ import annotations

from sumo_reactive.lab.metrics.moment import Figures, Moment
from sumo_reactive.lab.result import Collision


class Collisions:
    """Counts each contact once, from touch to parting; pedestrians count too."""

    def __init__(self) -> None:
        self.collisions: list[Collision] = []
        self._touching: frozenset[str] = frozenset()

    def see(self, moment: Moment) -> None:
        """Note who touches the ego now and did not before."""
        for user_id in sorted(moment.touching - self._touching):
            self.collisions.append(Collision(moment.step.time, user_id, moment.step.lane_id))
        self._touching = moment.touching

    def figures(self) -> Figures:
        """Return the number of collisions."""
        return {"collisions": len(self.collisions)}
