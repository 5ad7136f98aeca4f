"""What a judge finds: what the ego did to somebody, or against a rule, and which figure asked for is missing."""

from __future__ import annotations

from typing import NamedTuple

COLLISION, HARD_BRAKING = "collision", "hard braking"
RED_LIGHT_RUN, RIGHT_OF_WAY_TAKEN = "red light run", "right of way taken"

FAULT_MEANINGS = {
    COLLISION: "the ego's box and another's overlap from then on",
    HARD_BRAKING: "somebody behind the ego begins to brake hard because of it",
    RED_LIGHT_RUN: "the ego crosses a stop line on a letter that forbids it",
    RIGHT_OF_WAY_TAKEN: "the ego obstructs somebody with priority",
}
"""Every kind of fault; the first two are no breach of a rule."""


class Fault(NamedTuple):
    """What the ego did to user `user_id` (empty: to nobody), or against a rule, at `time` (s), on its lane `lane_id`."""

    time: float
    kind: str
    user_id: str
    lane_id: str

    @property
    def what(self) -> str:
        """What it was, in words."""
        return f"{self.kind} {'with' if self.kind == COLLISION else 'of'} {self.user_id}" if self.user_id else self.kind

    def __str__(self) -> str:
        return f"{self.what} at {self.time:.1f} s"


class MetricFailure(NamedTuple):
    """An own metric that gave no number: why, in a line, and the lines of its traceback."""

    name: str
    why: str
    traceback: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"metric '{self.name}' failed: {self.why}"
