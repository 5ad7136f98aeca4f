"""How SUMO is started on a configuration: without a window, with what keeps harm visible and runs repeatable."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import content_of, is_there, require_file
from sumo_reactive.sumo.config import (
    INPUT_FILES,
    INSTEAD_OF_RUNNING,
    LEFT_OUT,
    OUTPUT_FILES,
    SPECIAL_FILES,
    SumoConfig,
    given_options,
    is_true,
    option_words,
    paths_beside,
    seconds_of,
)

MAX_STEP_LENGTH_S = 1.0
DEFAULT_STEP_LENGTH_S = 0.1
"""Used where the scenario steps coarser and nobody asks otherwise."""


class OptionOverride(NamedTuple):
    """An option, what the scenario says of it (SUMO's default where it says nothing), what is used."""

    option: str
    scenario: str
    used: str


Runnable = Path | Mapping[str, str]
"""A configuration file, or the options that stand in place of one."""

OVERRIDES = {
    "collision.action": ("warn", "teleport"),
    "collision.check-junctions": ("true", "false"),
    "collision.mingap-factor": ("0", "-1"),
    "collision.stoptime": ("0", "0"),
    "ignore-junction-blocker": ("-1", "-1"),
    "random": ("false", "false"),
}
"""Option: (value used, SUMO's default). What would hide harm, or make two runs differ."""

_END = "end"
_PORT, _NO_PORT = "remote-port", "0"
"""Where a port is given, SUMO waits for a client to connect and tell it to step."""

_LOGS = ("no-warnings", "verbose", "log", "error-log", "message-log")
_INCLUDED = re.compile(rb"<include\s[^>]*?href\s*=\s*[\"']([^\"'\0]+)")
_FOR_SHOW = re.compile(r"poly|poi|view|gui|background|decal", re.IGNORECASE)
"""Names of additional files that only draw something."""


def runnable_config(config: SumoConfig) -> tuple[Runnable, tuple[OptionOverride, ...]]:
    """Return what SUMO runs without a window: the file, or options in place of it; and what they leave out.

    Left out are options that only a window needs or that let SUMO end before it runs, and missing files that only draw
    something. A missing file of any other kind raises ScenarioError, and so does what is there and no file.
    """
    needless = {name: value for name, value in config.options.items() if name in LEFT_OUT}
    missing = [file for file in config.additional_files if not is_there(file)]
    for file in missing:
        if not _FOR_SHOW.search(file.name):
            raise ScenarioError(f"{file}: no such file (additional-files of {config.path})")
    _require_files(config)
    if not needless and not missing:
        return config.path, ()
    left_out = [OptionOverride(name, value, "left out") for name, value in needless.items()]
    kept = {name: value for name, value in _found_from_anywhere(config, missing) if name not in needless}
    left_out += [OptionOverride("additional-files", str(file), "left out: missing") for file in missing]
    return kept, tuple(left_out)


def _require_files(config: SumoConfig) -> None:
    """Raise ScenarioError for what SUMO would read as a file although it is a pipe, for whose writer it would wait.

    That is what the options name, and what route and additional files include.
    """
    for name in sorted(INPUT_FILES & set(config.options)):
        for part in paths_beside(config.path, config.options[name]):
            if not part.is_dir():
                require_file(part)
    waiting, seen = [*config.route_files, *config.additional_files], set[Path]()
    while waiting:
        file = waiting.pop()
        if file not in seen and is_there(file):
            seen.add(file)
            waiting += [file.parent / os.fsdecode(name) for name in _INCLUDED.findall(content_of(file))]


def _found_from_anywhere(config: SumoConfig, missing: Sequence[Path]) -> Iterator[tuple[str, str]]:
    """Yield the options with paths that do not depend on where the configuration lies."""
    for name, value in config.options.items():
        if name == "additional-files":
            there = [str(file) for file in config.additional_files if file not in missing]
            if there:
                yield name, ",".join(there)
        elif name in INPUT_FILES or name in OUTPUT_FILES:
            yield name, ",".join(_absolute(config.path.absolute().parent, part.strip()) for part in value.split(","))
        else:
            yield name, value


def _absolute(folder: Path, name: str) -> str:
    is_socket = re.fullmatch(r"[^/\\]+:\d+", name) is not None
    if not name or name.lower() in SPECIAL_FILES or is_socket or name.startswith("${"):
        return name
    return str(folder / name)


def chosen_step_length(config: SumoConfig, asked: float | None) -> float:
    """Return the step length to use, s: as asked, else the scenario's own or 0.1 s, whichever is finer."""
    if asked is None:
        return min(config.step_length_s, DEFAULT_STEP_LENGTH_S)
    milliseconds = 1000.0 * asked
    if not 0.0 < asked <= MAX_STEP_LENGTH_S or abs(milliseconds - round(milliseconds)) > 1e-6:
        raise ScenarioError(
            f"{config.path}: impossible step length {asked:g} s: it is whole milliseconds, at most {MAX_STEP_LENGTH_S:g} s"
        )
    return asked


def sumo_arguments(
    config: SumoConfig, runnable: Runnable, *, seed: int, step_length_s: float, sumo_options: Sequence[str] = ()
) -> tuple[list[str], tuple[OptionOverride, ...]]:
    """Return the arguments to start SUMO with, and each override that changes what the scenario says.

    `sumo_options` go last, unchanged; an option named there is the user's, not ours. Raises ScenarioError for one with
    which nothing would be simulated.
    """
    given = given_options(sumo_options)
    _require_a_run(given)
    ours = {name: used for name, (used, _) in OVERRIDES.items()} | {"seed": str(seed), "step-length": f"{step_length_s:g}"}
    ours[_PORT] = _NO_PORT
    defaults = {name: default for name, (_, default) in OVERRIDES.items()}
    defaults |= {"seed": str(seed), "step-length": "1", _PORT: _NO_PORT}
    ours = {name: used for name, used in ours.items() if name not in given}
    said = {name: config.options.get(name, defaults.get(name, "")) for name in ours}
    changed = tuple(OptionOverride(name, said[name], used) for name, used in ours.items() if not _same(said[name], used))
    ours |= _silence(config, given)
    if isinstance(runnable, Path):
        arguments = ["--configuration-file", str(runnable)]
    else:
        arguments = [f"--{name}={value}" for name, value in runnable.items() if name not in ours and name not in given]
    return [*arguments, *option_words(ours), *sumo_options], changed


def passed_end(config: SumoConfig, time: float, sumo_options: Sequence[str]) -> tuple[OptionOverride, ...]:
    """Return the override of the scenario's `end` by an ego that has driven on until `time`, s; empty if there is none."""
    if config.end_s is None or time <= config.end_s or _END in given_options(sumo_options):
        return ()
    return (OptionOverride(_END, config.options[_END], f"{time:.10g}"),)


def _require_a_run(given: Mapping[str, str]) -> None:
    """Raise ScenarioError for an option of the user's that lets SUMO end, or wait for ever, before it simulates."""
    if _PORT in given:
        raise ScenarioError(f"option '{_PORT}': SUMO runs inside this program and would wait for a client for ever")
    for name in sorted(INSTEAD_OF_RUNNING & given.keys()):
        raise ScenarioError(f"option '{name}': SUMO would answer that and end, and nothing be simulated")


def _silence(config: SumoConfig, given: Mapping[str, str]) -> dict[str, str]:
    """Return options that keep SUMO's log off the terminal, where neither scenario nor user says otherwise."""
    quiet = {} if any(name in config.options or name in given for name in _LOGS) else {"no-warnings": "true"}
    return quiet if "no-step-log" in given else {"no-step-log": "true", **quiet}


def _same(text: str, other: str) -> bool:
    try:
        return seconds_of(text) == seconds_of(other)
    except ValueError:
        return text.strip().lower() == other or (is_true(text) and is_true(other))
