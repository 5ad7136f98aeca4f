"""A bundle is driven again, and what comes is compared step by step, by digest, with what it holds."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import NamedTuple

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.trials import release
from sumo_reactive.lab.bundle.manifest import Manifest, RunKeys
from sumo_reactive.lab.bundle.unpacking import opened_bundle, require_closed, require_inputs, task_in, unpack_inputs
from sumo_reactive.lab.runner import run_all
from sumo_reactive.lab.task import Ending, Outcome, Task


class Reproduced(NamedTuple):
    """A run of a bundle, and what became of it now."""

    run: RunKeys
    outcome: Outcome

    @property
    def is_same(self) -> bool:
        """Whether every step is the same, to the last bit."""
        return self.outcome.ending is Ending.DONE and self.outcome.trajectory == self.run.trajectory

    @property
    def verdict(self) -> str:
        """What became of it, in a line."""
        if self.outcome.ending is not Ending.DONE:
            return f"{self.outcome.ending.value}: {self.outcome.reason}"
        return "the same to the last bit" if self.is_same else "another trip"


class Reproduction(NamedTuple):
    """All runs of a bundle, and what was of another version when they were recorded: its name, then, now."""

    runs: tuple[Reproduced, ...]
    changed: tuple[tuple[str, str, str], ...]


def drive_again(
    bundle: Path, *, inputs: Path | None = None, drivers: Collection[str] = (), jobs: int = 1, wall_limit_s: float = 3600.0,
    progress: Callable[[Outcome], None] | None = None,
) -> Reproduction:  # fmt: skip
    """Drive the runs of a bundle again in processes of their own, `jobs` at a time; nothing else of it is run or kept.

    `inputs`: the folder with the files of a bundle that holds their digests alone. Whose drivers are the user's runs only
    where `drivers` names them, as they are installed here. Raises ScenarioError for what is no bundle, or leads elsewhere.
    """
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        manifest, tasks = _read(bundle, inputs, Path(folder))
        foreign = {task.scenario.driver.name for task in tasks if task.scenario.driver.is_users} - set(drivers)
        if foreign:
            told = f"was driven by '{min(foreign)}': name it with --driver, to run its code as it is here"
            raise ScenarioError(f"{bundle}: {told}")
        outcomes = run_all(tasks, jobs, wall_limit_s, progress)
        runs = tuple(Reproduced(run, outcome) for run, outcome in zip(manifest.runs, outcomes, strict=True))
    return Reproduction(runs, tuple(_changed(manifest)))


def _read(bundle: Path, inputs: Path | None, folder: Path) -> tuple[Manifest, list[Task]]:
    """Return what a bundle asks for, with its inputs unpacked into a folder, or those in `inputs`."""
    with opened_bundle(bundle) as (archive, manifest):
        if manifest.has_inputs:
            root = folder.resolve()
            unpack_inputs(archive, manifest, root)
        elif inputs is None:
            raise ScenarioError(f"{bundle}: holds digests alone: name the folder of its inputs with --inputs")
        else:
            root = inputs
            require_inputs(manifest, root)
        tasks = [task_in(run, manifest, root) for run in manifest.runs]
        if manifest.has_inputs:
            for task in {(one.scenario.config, one.scenario.sumo_options): one for one in tasks}.values():
                require_closed(task, root)
        return manifest, tasks


def _changed(manifest: Manifest) -> Iterator[tuple[str, str, str]]:
    """Yield what is of another version now, or differs among the runs themselves."""
    now = release()
    for name in dict.fromkeys(name for versions in manifest.versions for name in versions):
        then = dict.fromkeys(versions.get(name, "unknown") for versions in manifest.versions)
        if list(then) != [now.get(name, "unknown")]:
            yield name, ", ".join(then), now.get(name, "not there")
