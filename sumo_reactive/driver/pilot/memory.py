"""What the pilot must remember from step to step: an argument and a result, never a hidden field."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.pilot.passages import Exit, View
from sumo_reactive.driver.pilot.rules.gaps import Judgement
from sumo_reactive.driver.pilot.rules.lights import SHUT
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.route import ScheduledStop

NEVER_SHUT: Mapping[str, tuple[float, ...]] = {}
"""No light has been seen."""


class Premises(NamedTuple):
    """What the pilot took for granted when it last decided, on the `view` that it had; what differs from it is an event.

    `speeds`: of everybody in the corridor and of every foe by id, m/s. `judged`: what it made of each foe who matters at a
    region, by the ids of both; `exits`: what it found behind the passages. `regions`: ids of those that somebody could
    reach. `stages`: how far the ego had come in each passage in sight, and how many of the `regions` there it had reached.
    `is_seeking`: it sought a gap for a lane change. `is_settled`: it rests on none of the others, for a light or a time
    decides. `asks`: it rests on those who can reach a region, for the behaviour asks who goes first. `halts`: a stop of the
    route or a turn in several moves is in reach. `due` (s): when it looks anew, whatever happens.
    """

    view: View
    speeds: Mapping[str, float]
    judged: Mapping[tuple[str, str], Judgement]
    exits: tuple[Exit, ...]
    regions: frozenset[str]
    stages: tuple[tuple[int, ...], ...]
    is_standing: bool
    is_off_nominal: bool
    is_seeking: bool
    is_settled: bool
    asks: bool
    halts: bool
    due: Mapping[EventKind, float]

    @property
    def plan(self) -> NominalPlan:
        """The nominal plan that it decided on."""
        return self.view.plan

    @property
    def time(self) -> float:
        """When it decided, s."""
        return self.view.snapshot.time


class Overtaking(NamedTuple):
    """An overtaking under way: who is passed, the last first, since when (s), and what the ego is about: OVERTAKE, RETURN or
    FALL_BACK."""

    user_ids: tuple[str, ...]
    since: float
    instruction: Instruction


class PilotMemory(NamedTuple):
    """Since when the ego stands (s; None: it moves), at which connection's line it has come to a full stop and when (s),
    which scheduled stops it has served, and until when it serves the present one (s; None: it serves none).

    `behaviour` is the present one; `premises` what it rests on; `overtaking` what it is about; `schedule` the adjusted
    (l, t_l) of the plan, `delay` (s) the one that they allow for; `progress_s` (m of C), `progress_time` (s): the last
    place where the ego got on, and from when on that is held against it; `got_on` (s): when it did; `escapes`: how many it
    has tried there. `waiting_since` (s): since when it waits for a gap
    to change lanes (None: it does not). `released`: the next connection whose light lets the ego go (empty: none does),
    since when (s); `lost`: that before which the ego has stood through a whole green (empty: none). `move`: which of
    the plan's turns in several moves is under way, and which of its moves (None: none is). `yellows`: the connections whose
    light is yellow, each since when (s). `kept`: foes who stand because they let somebody pass, each until when (s).
    `let_go`: whom the ego lets go although they would wait for it. `shut`: since when each link of the lights in sight has
    not been green (s; infinite: it is), as far as the ego has seen it.
    """

    standing_since: float | None = None
    stopped_at: str = ""
    stopped_since: float = 0.0
    served: tuple[ScheduledStop, ...] = ()
    serving_until: float | None = None
    behaviour: Behaviour = Behaviour.NORMAL
    premises: Premises | None = None
    overtaking: Overtaking | None = None
    schedule: tuple[TimeConstraint, ...] = ()
    delay: float = 0.0
    progress_s: float = -math.inf
    progress_time: float = 0.0
    got_on: float = 0.0
    escapes: int = 0
    waiting_since: float | None = None
    released: tuple[str, float] = ("", 0.0)
    lost: str = ""
    move: tuple[int, int] | None = None
    yellows: tuple[tuple[str, float], ...] = ()
    kept: tuple[tuple[str, float], ...] = ()
    let_go: tuple[str, ...] = ()
    shut: Mapping[str, tuple[float, ...]] = NEVER_SHUT

    def with_lights(self, lights: Mapping[str, str], time: float) -> PilotMemory:
        """Return the memory of which links of the `lights` in sight are not green at `time`, s."""
        shut = {}
        for light, letters in lights.items():
            known = self.shut.get(light, ())
            before = known if len(known) == len(letters) else (time,) * len(letters)
            shut[light] = tuple(
                min(since, time) if one in SHUT else math.inf for one, since in zip(letters, before, strict=True)
            )
        return self._replace(shut=shut)

    def shut_for(self, connection: Connection, time: float) -> float:
        """How long the light of a connection has not been green at `time`, as far as the ego has seen it, s."""
        link = connection.light
        since = () if link is None else self.shut.get(link.light_id, ())
        return 0.0 if link is None or link.index >= len(since) else max(time - since[link.index], 0.0)

    def with_released(self, connection_id: str, since: float) -> PilotMemory:
        """Return the memory of by which connection the ego may go next (empty: none), since when (s)."""
        before, green = self.released
        has_stood = self.standing_since is not None and self.standing_since <= green
        lost = before if before and not connection_id and has_stood else self.lost
        return self._replace(released=(connection_id, since), lost=lost)

    def waited_at(self, connection_id: str, time: float) -> float:
        """How long the ego has not got on at `time`, first before a junction whose light lets its connection go, s: the reds
        before that count as well where it has stood through a whole green."""
        released, since = self.released
        since = self.got_on if self.lost == connection_id else max(since, self.got_on)
        return time - since if released == connection_id else 0.0

    def standing_for(self, time: float) -> float:
        """How long the ego has been standing at `time`, s."""
        return 0.0 if self.standing_since is None else time - self.standing_since
