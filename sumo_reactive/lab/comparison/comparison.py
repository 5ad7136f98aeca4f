"""The same trips with the same seeds under SUMO's own driver and under another: paired differences.

Trips of one ego each, in which the others are looked at from its departure on; or of several egos that a rule chooses, which
are judged alike under both drivers, as is the whole network.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from sumo_reactive.errors import ExitCode, ScenarioError
from sumo_reactive.lab.comparison.network_effects import NetworkEffects, Outputs, effects_of, means_over_both
from sumo_reactive.lab.comparison.statistics import PairedDifference, paired_difference
from sumo_reactive.lab.drivers.choice import REACTIVE, SUMO, DriverChoice
from sumo_reactive.lab.metric_names import NETWORK, OTHERS
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.runner import run_all
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.task import Ending, Outcome, Task, replay_command
from sumo_reactive.lab.trial_process import scratch
from sumo_reactive.sumo.config import OUTPUT_FILES, canonical, option_words, read_config
from sumo_reactive.sumo.launch import chosen_step_length, sumo_arguments

EGO_METRICS = (
    "arrived", "duration_s", "time_loss_s", "distance_m", "collisions", "min_time_to_collision_s",
    "min_post_encroachment_s", "hard_braking_caused", "max_acceleration_m_s2", "max_braking_m_s2",
    "max_lateral_acceleration_m_s2", "rms_jerk_m_s3", "standstill_s",
)  # fmt: skip
"""What the same judges say of both drivers."""

WHATEVER_THE_END = ("arrived", "collisions")
"""The others are compared only where the ego has arrived with both drivers."""

OTHERS_METRICS = tuple(OTHERS)

MetricValue = float | int | None


@dataclass(frozen=True)
class Side:
    """One driver's run: what became of it, and what one ego did to the others (None: it did not get to its end, or there
    are several)."""

    outcome: Outcome
    effects: NetworkEffects | None

    @property
    def is_driven(self) -> bool:
        """Whether the run got to its end."""
        return self.effects is not None or self.outcome.network is not None

    @property
    def result(self) -> TrialResult | None:
        """The judged trip of one ego, if it got to its end."""
        return self.outcome.result

    @property
    def is_clean(self) -> bool:
        """Whether it got to its end, and nobody is to blame for anything."""
        network = self.outcome.network
        return network.is_clean if network else self.result is not None and self.result.exit_code == ExitCode.DONE

    @property
    def figures(self) -> dict[str, MetricValue]:
        """Every metric of the run by name, of the ego and of the others, or of several egos and the network."""
        judged = self.outcome.judged
        return {**(judged.metrics if judged else {}), **(self.effects.figures if self.effects else {})}

    @property
    def verdict(self) -> str:
        """What the run came to, in a line."""
        judged = self.outcome.judged
        return judged.verdict if judged else f"{self.outcome.ending.value}: {self.outcome.reason}"


@dataclass(frozen=True)
class Pair:
    """A scenario with a seed under both drivers, as asked for, without what the comparison adds."""

    scenario: Scenario
    sumo: Side
    driven: Side

    @property
    def is_driven(self) -> bool:
        """Whether both runs got to their end."""
        return self.sumo.is_driven and self.driven.is_driven

    @property
    def names(self) -> tuple[str, ...]:
        """Keys of its metrics."""
        return (*EGO_METRICS, *OTHERS_METRICS) if self.scenario.egos is None else tuple(NETWORK)

    @property
    def ego(self) -> str:
        """The ego's id, as chosen where nobody named one; of several egos the rule that chooses them."""
        if self.scenario.egos is not None:
            return str(self.scenario.egos)
        found = self.sumo.result or self.driven.result
        return found.ego if found else self.scenario.ego or ""

    @cached_property
    def metrics(self) -> dict[str, tuple[MetricValue, MetricValue]]:
        """Every metric of the comparison by name: SUMO's own driver's, this project's; None where there is none."""
        theirs, ours = self.sumo.figures, self.driven.figures
        if self.sumo.effects and self.driven.effects:
            their_means, our_means = means_over_both(self.sumo.effects, self.driven.effects)
            theirs, ours = {**theirs, **their_means}, {**ours, **our_means}
        return {name: (theirs.get(name), ours.get(name)) for name in self.names}

    def of(self, metric: str) -> tuple[float, float] | None:
        """Return both values of a metric where they can be compared."""
        theirs, ours = self.metrics[metric]
        if not self.is_driven or theirs is None or ours is None:
            return None
        is_of_trip = metric in EGO_METRICS and metric not in WHATEVER_THE_END
        if is_of_trip and self.metrics["arrived"] != (1, 1):
            return None
        return float(theirs), float(ours)

    @property
    def plain_sumo(self) -> str:
        """The command that makes the baseline with plain `sumo`; its `tripinfo` of the ego holds the baseline's numbers."""
        config = read_config(self.scenario.config)
        length = chosen_step_length(config, self.scenario.step_length_s)
        arguments, _ = sumo_arguments(
            config, config.path, seed=self.scenario.seed, step_length_s=length, sumo_options=self.scenario.sumo_options
        )
        return shlex.join(["sumo", *arguments, "--tripinfo-output", "tripinfo.xml"])

    @property
    def replay(self) -> str:
        """The command that drives the trip again under the driver that is compared."""
        run = self.driven.outcome.task.scenario
        named = None if run.egos else self.ego
        return replay_command(Task(replace(run, ego=named, sumo_options=self.scenario.sumo_options)))


@dataclass(frozen=True)
class Comparison:
    """All pairs of SUMO's own driver and `driver`, with the window after each ego's departure (s) in which the others were
    looked at; None: of several egos, the whole run counts."""

    pairs: tuple[Pair, ...]
    horizon_s: float | None
    driver: DriverChoice = REACTIVE

    @cached_property
    def differences(self) -> dict[str, PairedDifference]:
        """Every metric that at least one pair has, in order: means and their paired difference, ours − SUMO's."""
        found = {}
        for name in dict.fromkeys(name for pair in self.pairs for name in pair.names):
            values = [value for pair in self.pairs if (value := pair.of(name)) is not None]
            if (difference := paired_difference(values)) is not None:
                found[name] = difference
        return found

    @property
    def failed(self) -> tuple[Pair, ...]:
        """The pairs of which a run did not get to its end."""
        return tuple(pair for pair in self.pairs if not pair.is_driven)

    @property
    def exit_code(self) -> int:
        """0: both drivers have driven every trip; else 1."""
        return ExitCode.WANTING if self.failed else ExitCode.DONE


def compare(
    scenarios: Sequence[Scenario],
    *,
    horizon_s: float,
    jobs: int,
    wall_limit_s: float,
    drivers: Sequence[DriverChoice] = (REACTIVE,),
    progress: Callable[[Outcome], None] | None = None,
) -> list[Comparison]:
    """Let SUMO's own driver and each of `drivers` drive each scenario in processes of their own, `jobs` at a time; return a
    comparison for each.

    All runs of one ego go on until `horizon_s` after its departure, or the scenario's end if that is earlier; those of
    several until the scenario's end. Raises ScenarioError for what cannot be run at all.
    """
    with scratch() as folder:
        runs = [
            (driver, scenario, Outputs(folder, f"{k}_{number}_"))
            for k, scenario in enumerate(scenarios)
            for number, driver in enumerate((SUMO, *drivers))
        ]
        tasks = [_task(scenario, driver, outputs, horizon_s) for driver, scenario, outputs in runs]
        outcomes = run_all(tasks, jobs, wall_limit_s, progress, folder)
        sides = [_side(outcome, run[2]) for outcome, run in zip(outcomes, runs, strict=True)]
    if all(side.outcome.ending is Ending.FAILED for side in sides):
        raise ScenarioError(sides[0].outcome.reason)
    many = 1 + len(drivers)
    found = []
    for number, driver in enumerate(drivers, start=1):
        asked = (replace(scenario, driver=driver) for scenario in scenarios)
        pairs = zip(asked, sides[::many], sides[number::many], strict=True)
        window = None if scenarios[0].egos else horizon_s
        found.append(Comparison(tuple(Pair(*pair) for pair in pairs), window, driver))
    return found


def _task(scenario: Scenario, driver: DriverChoice, outputs: Outputs, horizon_s: float) -> Task:
    """Return the run of a scenario that goes on for the others, and writes what tells of them; with several egos that is
    seen to where it is run."""
    if scenario.egos is not None:
        return Task(replace(scenario, driver=driver))
    config = read_config(scenario.config)
    ends = [end for end in (scenario.until_s, config.end_s) if end is not None]
    options = outputs.options(config)
    _require_free(scenario, options)
    asked = replace(
        scenario, until_s=min(ends, default=None), horizon_s=horizon_s, until_end=True, driver=driver,
        sumo_options=(*scenario.sumo_options, *option_words(options)),
    )  # fmt: skip
    return Task(asked)


def _require_free(scenario: Scenario, ours: Mapping[str, str]) -> None:
    """Raise ScenarioError if the user asks for an output, which several runs would write to at once."""
    given = [option.lstrip("-").partition("=")[0] for option in scenario.sumo_options if option.startswith("-")]
    for name in given:
        if canonical(name) in ours or canonical(name) in OUTPUT_FILES:
            raise ScenarioError(f"{scenario.source}: SUMO option '{name}' cannot be given: a comparison makes several runs")


def _side(outcome: Outcome, outputs: Outputs) -> Side:
    """Return a run with its effects on the others, and remove what it has written."""
    result = outcome.result
    effects = effects_of(outputs, result.ego, int(result.figures.get("teleports") or 0)) if result else None
    for file in (outputs.trips, outputs.totals, outputs.contacts):
        file.unlink(missing_ok=True)
    return Side(outcome, effects)
