"""SUMO configuration files and options: what they say, what options are called, which hold files (SUMO 1.28)."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import ParseError, fromstring

from sumo_reactive.errors import NetworkError, ScenarioError
from sumo_reactive.files import content_of, is_there, require_file

OBSTACLE_POLYGONS = "obstacle"
"""Polygons of this type stand on the road, unless the scenario names another."""


def _names(text: str) -> frozenset[str]:
    return frozenset(text.split())


GUI_ONLY = _names(
    """
    alternative-net-file breakpoints delay demo disable-textures edgedata-files game game.mode gui-settings-file
    gui-testing gui-testing-debug gui-testing.setting-output osg-terrain osg-view quit-on-end registry-viewport
    selection-file start tracker-interval window-pos window-size
    """
)
"""Section "GUI Only Options" of `sumo --help`, and the two that only sumo-gui builds with 3D know."""

INSTEAD_OF_RUNNING = _names("help save-configuration save-schema save-template version")
"""SUMO prints or writes what it is asked for, and ends with nothing loaded."""

LEFT_OUT = GUI_ONLY | INSTEAD_OF_RUNNING
"""What a run does without; some of it is an error or the end where there is no window."""

SYNONYMS = {
    "n": "net-file", "net": "net-file", "r": "route-files", "routes": "route-files", "a": "additional-files",
    "additional": "additional-files", "w": "weight-files", "weights": "weight-files", "b": "begin", "e": "end",
    "srand": "seed", "abs-rand": "random", "W": "no-warnings", "suppress-warnings": "no-warnings", "v": "verbose",
    "l": "log", "log-file": "log", "g": "gui-settings-file", "Q": "quit-on-end", "G": "game", "S": "start", "d": "delay",
    "B": "breakpoints", "m": "edgedata-files", "data-files": "edgedata-files", "N": "alternative-net-file", "D": "demo",
    "T": "disable-textures", "tripinfo": "tripinfo-output", "summary": "summary-output",
    "vehroutes": "vehroute-output", "personinfo": "personinfo-output", "personroutes": "personroute-output",
    "person-fcd": "person-fcd-output", "statistics-output": "statistic-output", "ndump": "netstate-dump",
    "netstate": "netstate-dump", "netstate-output": "netstate-dump", "C": "save-configuration",
    "save-config": "save-configuration", "V": "version", "?": "help", "device.fcd-replay.file": "device.fcd-replay.files",
}  # fmt: skip
"""From the `synonymes` of `sumo --save-template`: those of options that are read or hold files."""

INPUT_FILES = _names(
    """
    net-file route-files additional-files weight-files load-state fcd-output.filter-edges.input-file
    device.ssm.filter-edges.input-file device.fcd-replay.files astar.all-distances astar.landmark-distances phemlight-path
    """
)

OUTPUT_FILES = _names(
    """
    netstate-dump emission-output battery-output elechybrid-output chargingstations-output
    overheadwiresegments-output substations-output fcd-output person-fcd-output full-output queue-output vtk-output
    amitran-output summary-output person-summary-output tripinfo-output personinfo-output vehroute-output
    personroute-output link-output railsignal-block-output railsignal-vehicle-output bt-output lanechange-output
    stop-output collision-output edgedata-output lanedata-output statistic-output deadlock-output save-state.prefix
    save-state.files pedestrian.jupedsim.wkt pedestrian.jupedsim.py device.rerouting.output device.ssm.file
    device.toc.file log message-log error-log device.taxi.dispatch-algorithm.output device.taxi.idle-algorithm.output
    """
)
"""Options of type FILE in `sumo --help`, and the two device files that SUMO resolves beside the configuration."""

SPECIAL_FILES = ("stdout", "stderr", "-", "nul")
"""Names that SUMO does not take for paths (in any case)."""


def canonical(name: str) -> str:
    """Return the full name of an option."""
    return SYNONYMS.get(name, name)


def given_options(words: Sequence[str]) -> dict[str, str]:
    """Return value by full name of each option on a command line; letters behind a single dash may stand together."""
    given: dict[str, str] = {}
    for k, option in enumerate(words):
        if not option.startswith("-"):
            continue
        name, is_joined, value = option.lstrip("-").partition("=")
        names = [name] if option.startswith("--") or name in SYNONYMS else list(name)
        given |= dict.fromkeys(map(canonical, names), value if is_joined else "".join(words[k + 1 : k + 2]))
    return given


def option_words(options: Mapping[str, str]) -> list[str]:
    """Return options as a command line takes them."""
    return [word for name, value in options.items() for word in (f"--{name.lstrip('-')}", value)]


@dataclass(frozen=True, eq=False, kw_only=True)
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

    def mentions(self, marks: Sequence[bytes]) -> bool:
        """Whether a route or additional file, compressed or not, contains one of `marks`."""
        contents = map(content_of, filter(is_there, (*self.route_files, *self.additional_files)))
        return any(mark in content for content in contents for mark in marks)


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
        end_s=end if (end := _time(path, options, "end", "-1")) >= 0.0 else None,
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


@contextmanager
def xml_read(path: Path) -> Iterator[None]:
    """Turn what is wrong with an XML file into a ScenarioError that names its line."""
    try:
        yield
    except ParseError as error:
        line, column = error.position
        raise ScenarioError(f"{path}:{line}: not XML: {str(error).split(':')[0]} at column {column}") from error
    except (ValueError, LookupError) as error:
        raise ScenarioError(f"{path}: not XML: {error}") from error


def _options(path: Path) -> dict[str, str]:
    with xml_read(path):
        root = fromstring(content_of(path))
    if root.tag not in ("configuration", "sumoConfiguration"):
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
