"""What the pilot must remember from step to step: an argument and a result, never a hidden field."""

from __future__ import annotations

from typing import NamedTuple

from sumo_reactive.world.route import ScheduledStop


class PilotMemory(NamedTuple):
    """Since when the ego stands (s; None: it moves), at which connection's line it has come to a full stop and when (s),
    which scheduled stops it has served, and until when it serves the present one (s; None: it serves none)."""

    standing_since: float | None = None
    stopped_at: str = ""
    stopped_since: float = 0.0
    served: tuple[ScheduledStop, ...] = ()
    serving_until: float | None = None

    def standing_for(self, time: float) -> float:
        """How long the ego has been standing at `time`, s."""
        return 0.0 if self.standing_since is None else time - self.standing_since
