"""What one trial came to: the ego's way, the figures of the judges, the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sumo_reactive.sumo.recount import Recount

Override = tuple[str, str, str]
"""Option, what the scenario says, what was used."""


@dataclass(frozen=True, slots=True)
class Collision:
    """The ego's box and that of user `user_id` overlapped from `time` (s) on; `lane_id` is the ego's."""

    time: float
    user_id: str
    lane_id: str

    def __str__(self) -> str:
        return f"collision with {self.user_id} at {self.time:.1f} s"


@dataclass(frozen=True, slots=True)
class Violation:
    """A rule that the ego broke at `time` (s): `kind` in words, `user_id` the one who suffered (empty: nobody)."""

    time: float
    kind: str
    lane_id: str
    user_id: str = ""

    def __str__(self) -> str:
        return f"{self.kind}{f' of {self.user_id}' if self.user_id else ''} at {self.time:.1f} s"


@dataclass(frozen=True, slots=True)
class HardBrake:
    """User `user_id` behind the ego began to brake hard because of it at `time` (s); `lane_id` is the ego's."""

    time: float
    user_id: str
    lane_id: str

    def __str__(self) -> str:
        return f"hard braking of {self.user_id} at {self.time:.1f} s"


Fault = Collision | Violation | HardBrake
"""What the ego did to somebody, or against a rule, at a time."""


@dataclass(frozen=True)
class TrialResult:
    """One trial. Times are simulation seconds; `end_s` is when the ego arrived or the run ended.

    `chosen` says how the ego was chosen ("as named", "first car to depart"); `ended` why the run ended ("arrived", "until
    120 s"); `stopped_s` is the time at stops of the route, which is no loss; `figures` hold units in their keys, wall-clock
    figures apart under `timing`. `recounts`: what was put right in SUMO's own outputs.
    """

    scenario: str
    ego: str
    chosen: str
    seed: int
    step_length_s: float
    profile: str
    arrived: bool
    ended: str
    begin_s: float
    departure_s: float
    end_s: float
    time_loss_s: float
    distance_m: float
    figures: Mapping[str, float | int | None]
    timing: Mapping[str, float] = field(default_factory=dict)
    collisions: tuple[Collision, ...] = ()
    violations: tuple[Violation, ...] = ()
    hard_brakes: tuple[HardBrake, ...] = ()
    overrides: tuple[Override, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    ghosts: int = 0
    stopped_s: float = 0.0
    recounts: tuple[Recount, ...] = ()

    @property
    def duration_s(self) -> float:
        """Time from departure to the end, s."""
        return self.end_s - self.departure_s

    @property
    def metrics(self) -> dict[str, float | int | None]:
        """Every figure that the same trial gives again, by name, units in the names; None where there is none."""
        return {
            "arrived": int(self.arrived),
            "duration_s": round(self.duration_s, 3),
            "time_loss_s": round(self.time_loss_s, 3),
            "distance_m": round(self.distance_m, 3),
            "collisions": len(self.collisions),
            "violations": len(self.violations),
            **self.figures,
        }

    @property
    def exit_code(self) -> int:
        """0: arrived without a collision or violation; else 1."""
        return 0 if self.arrived and not self.collisions and not self.violations else 1

    @property
    def verdict(self) -> str:
        """The reason for the exit code in one line."""
        faults = [str(fault) for fault in (*self.collisions, *self.violations)]
        if not self.arrived:
            faults.insert(0, f"did not arrive ({self.ended})")
        return "; ".join(faults) if faults else "arrived without a violation"


@dataclass(frozen=True)
class FleetResult:
    """What the trips of all egos came to, in order of departure; `refused`: vehicles that could not be taken over, and why.

    `on_their_way` were those whose trip the run's end cut short: no fault of theirs. `until` is simulation time at the end
    (s). `step_us`: wall-clock time of one ego's share of a step, all that the driver adds to SUMO (observing, deciding,
    placing, judging), µs; `wall_s` that of the whole simulation.
    """

    results: tuple[TrialResult, ...]
    refused: tuple[tuple[str, str], ...]
    on_their_way: frozenset[str]
    until: float
    step_us: float
    wall_s: float
    overrides: tuple[Override, ...] = ()

    @property
    def faulty(self) -> tuple[TrialResult, ...]:
        """Trips with a collision or violation, and those that ended before the goal."""
        return tuple(one for one in self.results if one.collisions or one.violations or not self._is_excused(one))

    def _is_excused(self, result: TrialResult) -> bool:
        return result.arrived or result.ego in self.on_their_way

    @property
    def recounts(self) -> tuple[Recount, ...]:
        """What was put right in SUMO's own outputs."""
        return tuple(dict.fromkeys(one for result in self.results for one in result.recounts))

    @property
    def exit_code(self) -> int:
        """0: no ego has a fault; else 1."""
        return int(bool(self.faulty))
