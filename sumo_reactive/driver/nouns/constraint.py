"""What limits the ego, and why: the one currency between pilot and executor (F&L 1991, §1.3)."""

from __future__ import annotations

import math
from typing import NamedTuple

from sumo_reactive.driver.nouns.decision import Reason


class TimeConstraint(NamedTuple):
    """(l, t_l): the front bumper is not past arc length `s` (m of C) before `time` (s of simulation time), and there no
    faster than `speed` (m/s).

    A stop has no time at which it ends (infinite). With `behind`, `s` is the rear of that road user and moves with him, at
    `speed`; he can brake with `braking` (m/s²) at the hardest.
    One that `is_hard` leaves the ego a way to stop before `s` for as long as the pilot holds it, whatever `time` says; the
    others only set the desired speed. `reason`, `region` and `cause` say who or what asks for it.
    """

    s: float
    time: float = math.inf
    speed: float = math.inf
    is_hard: bool = False
    reason: Reason = Reason.ON_SCHEDULE
    region: str = ""
    cause: str = ""
    behind: str = ""
    braking: float = math.inf

    @property
    def is_certain(self) -> bool:
        """Whether `time` is no forecast of what others will do, but known."""
        return self.time < math.inf and self.reason in (Reason.RED_LIGHT, Reason.YELLOW_LIGHT)


def stop_at(s: float, reason: Reason, region: str = "", cause: str = "", until: float = math.inf) -> TimeConstraint:
    """Return the constraint to stop with the front bumper at `s` (m of C) at the latest, `until` a time (s) is foreseen."""
    return TimeConstraint(s, until, is_hard=True, reason=reason, region=region, cause=cause)


def stay_behind(user_id: str, s: float, speed: float, braking: float) -> TimeConstraint:
    """Return the constraint to stay behind a leader: his rear is at `s` (m of C), his `speed` along C (m/s), his hardest
    `braking` (m/s²)."""
    return TimeConstraint(s, math.inf, speed, True, Reason.FOLLOWS, "", user_id, user_id, braking)  # by place: at every step
