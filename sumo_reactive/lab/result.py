"""What one trial came to: the ego's way, the judges' figures, the verdict; as plain data for files, as lines for people."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

from sumo_reactive.errors import ExitCode
from sumo_reactive.lab.driving_score import driving_score
from sumo_reactive.lab.fault import COLLISION, HARD_BRAKING, Fault, MetricFailure
from sumo_reactive.lab.fundamental_diagram import DiagramPoint
from sumo_reactive.lab.metric_names import EVERY, METRICS, TIMINGS, metric_of
from sumo_reactive.lab.schema import RECORD_VERSION

if TYPE_CHECKING:
    from sumo_reactive.sumo.launch import OptionOverride
    from sumo_reactive.sumo.recount import Recount


@dataclass(frozen=True, kw_only=True)
class TrialResult:
    """One trial. Times are simulation seconds."""

    scenario: str
    """The file that names it."""
    ego: str
    """The vehicle driven."""
    chosen: str
    """How it was chosen: "as named", "first car to depart"."""
    seed: int
    """Seed of the random numbers."""
    step_length_s: float
    """Simulation step."""
    profile: str
    """`default` or `paper` of this project's driver, else the driver's name."""
    arrived: bool
    """Whether the ego has arrived."""
    ended: str
    """Why the run ended: "arrived", "until 120 s"."""
    begin_s: float
    """When the run began."""
    departure_s: float
    """When the ego departed."""
    end_s: float
    """When the ego arrived or the run ended."""
    time_loss_s: float
    """Time lost by driving slower than the road allows."""
    distance_m: float
    """Way driven."""
    figures: Mapping[str, float | int | None]
    """What the judges measured, by key of the metric; None: there is none."""
    timing: Mapping[str, float] = field(default_factory=dict)
    """Wall-clock figures, by key."""
    faults: tuple[Fault, ...] = ()
    """What the ego did to others or against rules, in order of time."""
    overrides: tuple[OptionOverride, ...] = ()
    """What was changed in the scenario."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """Of this package, SUMO and the libraries that numbers depend on."""
    ghosts: int = 0
    """How many stand-ins showed the ego on another lane."""
    stopped_s: float = 0.0
    """Time at stops of the route, which is no loss."""
    recounts: tuple[Recount, ...] = ()
    """What was put right in SUMO's own outputs."""
    failure: str = ""
    """Traceback of a driver of the user's that has failed; empty: none has."""
    metric_failures: tuple[MetricFailure, ...] = ()
    """Metrics of the user's own that gave no number, and why."""
    command: str = ""
    """The command that drives it again; empty: one of several egos."""
    trajectory: str = ""
    """Digest of every step but for wall-clock times, where it was recorded: equal trips, equal digests."""
    length_m: float = field(kw_only=True)
    """The ego's length."""
    width_m: float = field(kw_only=True)
    """The ego's width."""

    @property
    def duration_s(self) -> float:
        """Time from departure to the end, s."""
        return self.end_s - self.departure_s

    @property
    def collisions(self) -> tuple[Fault, ...]:
        """Whom the ego touched."""
        return tuple(fault for fault in self.faults if fault.kind == COLLISION)

    @property
    def hard_brakes(self) -> tuple[Fault, ...]:
        """Whom it made brake hard."""
        return tuple(fault for fault in self.faults if fault.kind == HARD_BRAKING)

    @property
    def violations(self) -> tuple[Fault, ...]:
        """Which rules it broke."""
        return tuple(fault for fault in self.faults if fault.kind not in (COLLISION, HARD_BRAKING))

    @property
    def metrics(self) -> dict[str, float | int | None]:
        """Every figure that the same trial gives again, by name, units in the names; None where there is none."""
        return {
            "arrived": int(self.arrived),
            "duration_s": round(self.duration_s, 3),
            "time_loss_s": round(self.time_loss_s, 3),
            "distance_m": round(self.distance_m, 3),
            **self._scores,
            "collisions": len(self.collisions),
            "violations": len(self.violations),
            **self.figures,
        }

    @property
    def _scores(self) -> dict[str, float | None]:
        """The score, and the part of it that the judges do not know: progress, the share of the driving time not lost."""
        driven = self.duration_s - self.stopped_s
        progress = round(min(max(1.0 - self.time_loss_s / driven, 0.0), 1.0), 4) if driven > 0.0 else None
        parts = {**self.figures, "progress_score": progress}
        return {"driving_score": driving_score(parts, len(self.collisions)), "progress_score": progress}

    @property
    def exit_code(self) -> int:
        """0: arrived without a collision or violation, and every metric asked for is there; else 1."""
        is_wanting = not self.arrived or self.collisions or self.violations or self.metric_failures
        return ExitCode.WANTING if is_wanting else ExitCode.DONE

    @property
    def verdict(self) -> str:
        """The reason for the exit code in one line."""
        faults = [str(fault) for fault in (*self.collisions, *self.violations)]
        if not self.arrived:
            faults.insert(0, f"did not arrive ({self.ended})")
        return "; ".join((*(faults or ["arrived without a violation"]), *map(str, self.metric_failures)))


@dataclass(frozen=True, kw_only=True)
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
    overrides: tuple[OptionOverride, ...] = ()

    @property
    def faulty(self) -> tuple[TrialResult, ...]:
        """Trips with a collision, a violation or a metric that failed, and those that ended before the goal."""
        lost = {one.ego for one in self.stranded}
        wanting = (one.violations or one.collisions or one.metric_failures or one.ego in lost for one in self.results)
        return tuple(one for one, is_wanting in zip(self.results, wanting, strict=True) if is_wanting)

    @property
    def recounts(self) -> tuple[Recount, ...]:
        """What was put right in SUMO's own outputs."""
        return tuple(dict.fromkeys(one for result in self.results for one in result.recounts))

    @property
    def stranded(self) -> tuple[TrialResult, ...]:
        """Trips that ended before the goal though the run went on."""
        return tuple(one for one in self.results if not (one.arrived or one.ego in self.on_their_way))

    @property
    def exit_code(self) -> int:
        """0: no ego has a fault; else 1."""
        return ExitCode.WANTING if self.faulty else ExitCode.DONE


@dataclass(frozen=True, kw_only=True)
class NetworkResult:
    """What a run came to whose egos a rule chose, a `share` of those it can draw: `metrics` of the egos and of the whole
    network; the faults `by_ego`, in order of time; egos that were `stranded`, for they ended before their goal though the
    run went on, and why; simulation time at the begin (s); the fundamental `diagram`, a point a group of edges and interval.
    """

    share: float
    metrics: Mapping[str, float | None]
    by_ego: tuple[tuple[str, Fault], ...]
    departure_s: float
    ego: str = ""
    stranded: tuple[tuple[str, str], ...] = ()
    diagram: tuple[DiagramPoint, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)

    @property
    def faults(self) -> tuple[Fault, ...]:
        """What the egos did to others or against rules."""
        return tuple(fault for _, fault in self.by_ego)

    @property
    def is_clean(self) -> bool:
        """Whether no ego is to blame for anything."""
        return not (self.metrics["egos_collisions"] or self.metrics["egos_violations"] or self.stranded)

    @property
    def verdict(self) -> str:
        """What the run came to, in a line."""
        egos, of_all = self.metrics["egos"], self.metrics["network_vehicles"]
        faults = [f"{EVERY[name].counted(int(self.metrics[name] or 0))}" for name in ("egos_collisions", "egos_violations")]
        return f"{egos:.0f} egos among {of_all:.0f} vehicles: {', '.join(faults)}"


Row = tuple[str, str]

_PROFILES = "default", "paper"
"""Those of this project's driver."""

_OF_THIS_DRIVER = "off_road_s", "emergencies", "emergency_s", "pilot_activations", "pilot_free_share"
"""What other drivers do not have, and is then not told of them."""


def summary_of(result: TrialResult) -> dict[str, object]:
    """Return `summary.json` as a dictionary: units in the keys, wall-clock figures under `timing`, null for "none"."""
    plain = asdict(result)
    plain |= changes_of(result)
    plain["metric_failures"] = [one._asdict() for one in result.metric_failures]
    del plain["faults"]
    harms = {"collisions": result.collisions, "hard_brakes": result.hard_brakes}
    plain |= {name: [_fault_line(one) for one in faults] for name, faults in harms.items()}
    plain["violations"] = [_fault_line(one) | {"kind": one.kind} for one in result.violations]
    ends = {"duration_s": result.duration_s, "verdict": result.verdict, "exit_code": result.exit_code}
    return {"version": RECORD_VERSION} | {name: _finite(value) for name, value in (ends | plain).items()}


def rows_of(result: TrialResult) -> list[Row]:
    """Return the summary as (label, text) rows."""
    rows = [
        ("verdict", result.verdict),
        ("ego", f"{result.ego} ({result.chosen})"),
        (METRICS["arrived"].label, f"yes, at {result.end_s:.1f} s" if result.arrived else f"no ({result.ended})"),
    ]
    figures = {**result.metrics, **result.timing}
    is_ours = result.profile in _PROFILES
    lacking = set() if is_ours else {key for key in _OF_THIS_DRIVER if figures.get(key) is None}
    every = (*METRICS.values(), *TIMINGS.values())
    shown = (metric for metric in every if metric.is_shown and metric.key not in lacking)
    rows += [(metric.label, metric.text(figures[metric.key])) for metric in shown if metric.key in figures]
    own = (metric_of(key) for key in figures if key not in EVERY)
    rows += [(metric.title, metric.text(figures[metric.key])) for metric in own]
    return [*rows, *changed_rows(result)]


def changes_of(result: TrialResult | FleetResult) -> dict[str, list[dict[str, str]]]:
    """Return what was changed in the scenario, and in SUMO's own outputs, as plain data."""
    return {
        "overrides": [one._asdict() for one in result.overrides],
        "recounts": [one._asdict() for one in result.recounts],
    }


def changed_rows(result: TrialResult | FleetResult) -> list[Row]:
    """Return the same as (label, text) rows."""
    rows = [(f"override {option}", f"{said} → {used}") for option, said, used in result.overrides]
    for one in result.recounts:
        rows.append((" ".join(filter(None, (one.file, one.vehicle, one.attribute))), f"{one.sumo} → {one.used}".lstrip()))
    return rows


def _fault_line(fault: Fault) -> dict[str, object]:
    return {"time_s": fault.time, "user_id": fault.user_id, "lane_id": fault.lane_id}


def _finite(value: object) -> object:
    """Return `value` with None for every number that JSON cannot hold."""
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value
