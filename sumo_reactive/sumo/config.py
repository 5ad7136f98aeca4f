"""SUMO configuration files: what they say, a copy that runs without a window, and the arguments to start SUMO with."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, ElementTree, ParseError, SubElement, fromstring

from sumo_reactive.errors import NetworkError, ScenarioError
from sumo_reactive.sumo.option_names import GUI_ONLY, INPUT_FILES, OUTPUT_FILES, SPECIAL_FILES, canonical

ROOT_TAGS = ("configuration", "sumoConfiguration")

MAX_STEP_LENGTH_S = 1.0
DEFAULT_STEP_LENGTH_S = 0.1
"""Used where the scenario steps coarser and nobody asks otherwise."""

Override = tuple[str, str, str]
"""Option, what the scenario says (SUMO's default where it says nothing), what is used."""

OVERRIDES = {
    "collision.action": ("warn", "teleport"),
    "collision.check-junctions": ("true", "false"),
    "collision.mingap-factor": ("0", "-1"),
    "ignore-junction-blocker": ("-1", "-1"),
    "random": ("false", "false"),
}
"""Option: (value used, SUMO's default). What would hide harm, or make two runs differ."""

_LOGS = ("no-warnings", "verbose", "log", "error-log", "message-log")
_FOR_SHOW = re.compile(r"poly|poi|view|gui|background|decal", re.IGNORECASE)
"""Names of additional files that only draw something."""


@dataclass(frozen=True, eq=False)
class SumoConfig:
    """A `.sumocfg` as read: `options` by full name, files resolved beside it, times in s."""

    path: Path
    options: Mapping[str, str]
    net_file: Path
    route_files: tuple[Path, ...]
    additional_files: tuple[Path, ...]
    begin_s: float
    end_s: float | None
    step_length_s: float
    is_mesoscopic: bool


def is_config(path: Path) -> bool:
    """Whether a file is XML whose root is a SUMO configuration."""
    return _root(path).tag in ROOT_TAGS


def read_config(path: Path) -> SumoConfig:
    """Read a SUMO configuration; raise ScenarioError or NetworkError if SUMO could not run it or the ego not drive in it."""
    options = _options(path)
    config = SumoConfig(
        path=path,
        options=options,
        net_file=_net_file(path, options),
        route_files=_paths(path, options.get("route-files", "")),
        additional_files=_paths(path, options.get("additional-files", "")),
        begin_s=_time(path, options, "begin", "0"),
        end_s=_end(path, options),
        step_length_s=_time(path, options, "step-length", "1"),
        is_mesoscopic=is_true(options.get("mesosim", "false")),
    )
    if config.is_mesoscopic:
        raise ScenarioError(f"{path}: option 'mesosim': a mesoscopic simulation has no lanes to drive on")
    if config.step_length_s <= 0.0:
        raise ScenarioError(f"{path}: option 'step-length': impossible step length '{options['step-length']}'")
    return config


def is_true(text: str) -> bool:
    """Whether SUMO takes an option's text for yes."""
    return text.strip().lower() in ("true", "1", "yes", "on", "x", "t")


def seconds_of(text: str) -> float:
    """Return a SUMO time in s: `57600`, `16:0:0` or `1:16:0:0`; raise ValueError if it is none."""
    parts = [float(part) for part in text.strip().split(":")]
    if len(parts) not in (1, 3, 4):
        raise ValueError(text)
    return sum(part * unit for part, unit in zip(reversed(parts), (1.0, 60.0, 3600.0, 86400.0), strict=False))


def _root(path: Path) -> Element:
    try:
        return fromstring(path.read_bytes())
    except ParseError as error:
        line, column = error.position
        raise ScenarioError(f"{path}:{line}: not XML: {str(error).split(':')[0]} at column {column}") from error
    except FileNotFoundError as error:
        raise ScenarioError(f"{path}: no such file") from error
    except IsADirectoryError as error:
        raise ScenarioError(f"{path}: a directory, not a SUMO configuration") from error
    except (OSError, ValueError, LookupError) as error:
        raise ScenarioError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error


def _options(path: Path) -> dict[str, str]:
    root = _root(path)
    if root.tag not in ROOT_TAGS:
        raise ScenarioError(f"{path}: not a SUMO configuration: root element is <{root.tag}>")
    values = ((canonical(node.tag), node.get("value", node.get("v"))) for node in root.iter())
    return {name: value for name, value in values if value is not None}


def _net_file(path: Path, options: Mapping[str, str]) -> Path:
    named = options.get("net-file", "").strip()
    if not named:
        raise ScenarioError(f"{path}: no net-file")
    net = _paths(path, named)[0]
    if net.is_dir():
        raise NetworkError(f"{net}: a directory, not a network (net-file of {path})")
    if not net.exists():
        raise NetworkError(f"{net}: no such file (net-file of {path})")
    return net


def _paths(path: Path, value: str) -> tuple[Path, ...]:
    names = (os.path.expandvars(name.strip()) for name in value.split(","))
    return tuple(path.absolute().parent / name for name in names if name)


def _time(path: Path, options: Mapping[str, str], name: str, default: str) -> float:
    text = options.get(name, "").strip() or default
    try:
        return seconds_of(text)
    except ValueError as error:
        raise ScenarioError(f"{path}: option '{name}': '{text}' is not a time") from error


def _end(path: Path, options: Mapping[str, str]) -> float | None:
    end = _time(path, options, "end", "-1")
    return None if end < 0.0 else end


def runnable_config(config: SumoConfig, folder: Path) -> tuple[Path, tuple[Override, ...]]:
    """Return a configuration that SUMO runs without a window, and what it leaves out.

    That is the file itself, or a copy in `folder` where it has options that only a window needs, or names missing files
    that only draw something. A missing file of any other kind raises ScenarioError.
    """
    gui = {name: value for name, value in config.options.items() if name in GUI_ONLY}
    missing = [file for file in config.additional_files if not file.exists()]
    for file in missing:
        if not _FOR_SHOW.search(file.name):
            raise ScenarioError(f"{file}: no such file (additional-files of {config.path})")
    if not gui and not missing:
        return config.path, ()
    copy = folder / "runnable.sumocfg"
    _written(config, gui, missing).write(copy, encoding="utf-8", xml_declaration=True)
    left_out = [(name, value, "left out") for name, value in gui.items()]
    return copy, (*left_out, *(("additional-files", str(file), "left out: missing") for file in missing))


def _written(config: SumoConfig, gui: Mapping[str, str], missing: Sequence[Path]) -> ElementTree[Element]:
    root = Element("configuration")
    for name, value in config.options.items():
        kept = value
        if name == "additional-files":
            kept = ",".join(str(file) for file in config.additional_files if file not in missing)
        elif name in INPUT_FILES or name in OUTPUT_FILES:
            kept = ",".join(_absolute(config.path.absolute().parent, part.strip()) for part in value.split(","))
        if name not in gui and (kept or name != "additional-files"):
            SubElement(root, name, {"value": kept})
    return ElementTree(root)


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
            f"{config.path}: impossible step length {asked:g} s: more than 0, at most {MAX_STEP_LENGTH_S:g}, in whole milliseconds"
        )
    return asked


def sumo_arguments(
    config: SumoConfig, runnable: Path, *, seed: int, step_length_s: float, sumo_options: Sequence[str] = ()
) -> tuple[list[str], tuple[Override, ...]]:
    """Return the arguments to start SUMO with, and each override that changes what the scenario says.

    `sumo_options` go last, unchanged; an option named there is the user's, not ours.
    """
    given = {canonical(option.lstrip("-").partition("=")[0]) for option in sumo_options if option.startswith("-")}
    ours = {name: used for name, (used, _) in OVERRIDES.items()} | {"seed": str(seed), "step-length": f"{step_length_s:g}"}
    defaults = {name: default for name, (_, default) in OVERRIDES.items()} | {"seed": str(seed), "step-length": "1"}
    ours = {name: used for name, used in ours.items() if name not in given}
    said = {name: config.options.get(name, defaults[name]) for name in ours}
    changed = tuple((name, said[name], used) for name, used in ours.items() if not _same(said[name], used))
    arguments = ["--configuration-file", str(runnable)]
    for name, used in (ours | _silence(config, given)).items():
        arguments += [f"--{name}", used]
    return [*arguments, *sumo_options], changed


def _silence(config: SumoConfig, given: set[str]) -> dict[str, str]:
    """Return options that keep SUMO's log off the terminal, where neither scenario nor user says otherwise."""
    quiet = {} if any(name in config.options or name in given for name in _LOGS) else {"no-warnings": "true"}
    return quiet if "no-step-log" in given else {"no-step-log": "true", **quiet}


def _same(text: str, other: str) -> bool:
    try:
        return seconds_of(text) == seconds_of(other)
    except ValueError:
        return text.strip().lower() == other or (is_true(text) and is_true(other))
