"""A scenario started in SUMO, in this process."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from sumo_reactive.lab.result import Override
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.sumo.config import SumoConfig, read_config
from sumo_reactive.sumo.launch import chosen_step_length, runnable_config, sumo_arguments
from sumo_reactive.sumo.session import Session


class Started(NamedTuple):
    """A simulation that runs: its configuration, what was overridden in it, simulation time at its begin (s)."""

    session: Session
    config: SumoConfig
    overrides: tuple[Override, ...]
    begin: float


@contextmanager
def started(scenario: Scenario, more_options: Sequence[str] = ()) -> Iterator[Started]:
    """Start SUMO with the scenario, and `more_options` of its own; close it at the end.

    Raises ScenarioError for what SUMO cannot run.
    """
    config = read_config(scenario.config)
    step_length = chosen_step_length(config, scenario.step_length_s)
    runnable, left_out = runnable_config(config)
    options = (*scenario.sumo_options, *more_options)
    arguments, changed = sumo_arguments(
        config, runnable, seed=scenario.seed, step_length_s=step_length, sumo_options=options
    )
    with Session(arguments) as session:
        yield Started(session, config, (*changed, *left_out), session.time)
