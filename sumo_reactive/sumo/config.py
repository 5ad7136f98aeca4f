"""SUMO configuration files: what they say."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, fromstring

from sumo_reactive.errors import NetworkError, ScenarioError
from sumo_reactive.files import content_of, is_there, require_file
from sumo_reactive.sumo.option_names import canonical

ROOT_TAGS = ("configuration", "sumoConfiguration")


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

    def mentions(self, marks: Iterable[bytes]) -> bool:
        """Whether a route or additional file, compressed or not, contains one of `marks`."""
        contents = [content_of(file) for file in (*self.route_files, *self.additional_files) if is_there(file)]
        return any(mark in content for mark in marks for content in contents)


def read_config(path: Path) -> SumoConfig:
    """Read a SUMO configuration; raise ScenarioError or NetworkError if SUMO could not run it or the ego not drive in it."""
    options = _options(path)
    config = SumoConfig(
        path=path,
        options=options,
        net_file=_net_file(path, options),
        route_files=paths_beside(path, options.get("route-files", "")),
        additional_files=paths_beside(path, options.get("additional-files", "")),
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
    seconds = sum(part * unit for part, unit in zip(reversed(parts), (1.0, 60.0, 3600.0, 86400.0), strict=False))
    if not math.isfinite(seconds):
        raise ValueError(text)
    return seconds


def _root(path: Path) -> Element:
    try:
        return fromstring(content_of(path))
    except ParseError as error:
        line, column = error.position
        raise ScenarioError(f"{path}:{line}: not XML: {str(error).split(':')[0]} at column {column}") from error
    except (ValueError, LookupError) as error:
        raise ScenarioError(f"{path}: not XML: {error}") from error


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
    net = paths_beside(path, named)[0]
    require_file(net, NetworkError)
    if not is_there(net):
        raise NetworkError(f"{net}: no such file (net-file of {path})")
    return net


def paths_beside(path: Path, value: str) -> tuple[Path, ...]:
    """Return the files that an option of the configuration at `path` names, separated by commas."""
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
