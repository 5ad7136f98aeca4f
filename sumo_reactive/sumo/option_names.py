"""SUMO's option names: which hold files, which a run does without, and what else they are called (SUMO 1.28)."""

from __future__ import annotations

from collections.abc import Sequence


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
