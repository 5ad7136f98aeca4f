"""Metrics of the user's own: functions that a scenario or experiment file names, told apart from what is measured here.

Naming one runs its module's code, with all that this process may do; a file that names none runs none.
"""

from __future__ import annotations

import hashlib
import importlib.util
import math
import re
import sys
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from numbers import Real
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import content_of, is_there
from sumo_reactive.lab.fault import MetricFailure
from sumo_reactive.lab.metric_names import EVERY
from sumo_reactive.lab.schema import nearest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sumo_reactive.driver.nouns.record import StepRecord

GROUP = "sumo_reactive.metrics"
"""The entry points among which a metric without a module is looked for."""

MOST_LETTERS, MOST_VALUE = 64, 1e12
"""No name of an own metric is longer, and no value larger."""

MOST_TOLD, MOST_LINES_TOLD = 300, 60
"""So many letters of why a metric failed are told, and so many lines of its traceback, the last ones."""

OWN_NAME = re.compile(rf"[A-Za-z_][A-Za-z0-9_]{{0,{MOST_LETTERS - 1}}}")
"""What the name of an own metric is like, whole: it is a key in files and a column in tables."""

TAKEN = frozenset((
    "key", "scenario", "ego", "seed", "driver", "parameters", "options", "ending", "reason", "verdict", "attempts",
    "departure_s", "wall_s", "trajectory", "replay", "versions", "finished", "share", "varied", "metrics",
))  # fmt: skip
"""Names of a trial's other columns."""


class OwnMetric(Protocol):
    """A function that a user writes: what a trip came to, as one number.

    `trajectory` holds a step a value, by the names of the columns of `trajectory.parquet`; `encounters` a pair of the ego
    and a user near, and step, by those of `encounters.parquet`. Both are numpy arrays, NaN or None where there is none.
    The unit is the ending of the function's name. None says that a trip has no such figure.
    """

    def __call__(self, trajectory: Mapping[str, NDArray[Any]], encounters: Mapping[str, NDArray[Any]], /) -> float | None:
        """Return the figure of a trip."""


class MetricSource(NamedTuple):
    """An own metric as a file names it: its `name` in every table, the function `attribute` of `module`, which is in `file`.

    `digest` is that of the file: what it imports in turn is not looked at. `folder` is where the file that names it lies
    (None: the module is on Python's path).
    """

    name: str
    module: str
    attribute: str
    file: Path
    digest: str
    folder: Path | None


def metric_source(asked: str, folder: Path) -> MetricSource:
    """Return what "module:function", or the name of an entry point, stands for in a file of `folder`.

    The module is looked for in that folder, then on Python's path; it is loaded here, so that a mistake is told at once.
    Raises ScenarioError, which names no place.
    """
    module, colon, attribute = asked.partition(":")
    if colon:
        name, where = attribute.rpartition(".")[2], folder.absolute()
    else:
        found = _entry_point(asked)
        name, module, attribute, where = found.name, found.module, found.attr, None
    if not all(part.isidentifier() for part in (*module.split("."), *attribute.split("."))):
        raise ScenarioError(f"'{asked}' is not 'module:function'")
    if not OWN_NAME.fullmatch(name) or name in EVERY or name in TAKEN:
        raise ScenarioError(f"a metric of one's own cannot be called '{name}': {_why_not(name)}")
    local = where and where.joinpath(*module.split(".")).with_suffix(".py")
    is_local = local is not None and is_there(local)
    file = local if local is not None and is_local else _file_of(module)
    source = MetricSource(name, module, attribute, file, _digest(file), where if is_local else None)
    function_of(source)
    return source


def own_metrics() -> list[str]:
    """Return the names of the entry points."""
    return sorted(entry_points(group=GROUP).names)


@cache
def function_of(source: MetricSource) -> OwnMetric:
    """Load the module of a metric and return the function; raise ScenarioError if that cannot be done.

    A module that has changed since it was named is not loaded: the figures would be another's.
    """
    if _digest(source.file) != source.digest:
        raise ScenarioError(f"{source.file}: has changed since a file named it as a metric")
    try:
        found: Any = _module_of(source)
    except (Exception, SystemExit) as error:
        raise ScenarioError(f"{source.module} cannot be loaded: {_told(error)}") from error
    for part in source.attribute.split("."):
        near = nearest(part, [name for name in dir(found) if not name.startswith("_")])
        found = getattr(found, part, None)
        if found is None:
            raise ScenarioError(f"{source.file.name} has no function '{source.attribute}'{near}")
    if not callable(found):
        raise ScenarioError(f"'{source.attribute}' of {source.file.name} is no function")
    metric: OwnMetric = found
    return metric


def measured(
    sources: Sequence[MetricSource], steps: Sequence[StepRecord], encounters: Mapping[str, NDArray[Any]]
) -> tuple[dict[str, float | None], tuple[MetricFailure, ...]]:
    """Return the figures of a trip by name, None for a metric that failed, and the failures."""
    from sumo_reactive.lab.columns import trajectory_columns

    figures: dict[str, float | None] = {}
    failures: list[MetricFailure] = []
    trajectory = trajectory_columns(steps)
    for source in sources:
        function, figures[source.name] = function_of(source), None
        copies = ({name: column.copy() for name, column in table.items()} for table in (trajectory, encounters))
        try:
            figures[source.name] = _number(function(*copies))
        except (Exception, SystemExit) as error:
            failures.append(MetricFailure(source.name, _told(error, source.file), _lines(error)))
    return figures, tuple(failures)


def merged(*sources: Sequence[MetricSource]) -> tuple[MetricSource, ...]:
    """Return all of them, each once; raise ScenarioError for two of one name."""
    found: dict[str, MetricSource] = {}
    for source in (one for some in sources for one in some):
        if found.setdefault(source.name, source) != source:
            raise ScenarioError(f"two metrics are called '{source.name}'")
    return tuple(found.values())


def _number(value: object) -> float | None:
    if value is None:
        return None
    from numpy import bool_

    number = float(value) if isinstance(value, Real | bool_) else math.nan
    if not abs(number) <= MOST_VALUE:
        raise ValueError(f"gave {value!r:.60}, which is no number up to {MOST_VALUE:g}")
    return number


def _entry_point(name: str) -> EntryPoint:
    for found in entry_points(group=GROUP, name=name):
        return found
    raise ScenarioError(f"unknown metric '{name}'{nearest(name, (*EVERY, *own_metrics()))}")


def _why_not(name: str) -> str:
    if OWN_NAME.fullmatch(name):
        return "there is one already"
    return f"letters, digits and underscores, {MOST_LETTERS} at most"


def _file_of(module: str) -> Path:
    try:
        spec = importlib.util.find_spec(module)
    except (Exception, SystemExit) as error:
        raise ScenarioError(f"{module} cannot be loaded: {_told(error)}") from error
    if spec is None:
        raise ScenarioError(f"no module '{module}' beside the file or on Python's path")
    if spec.origin is None or not spec.origin.endswith(".py"):
        raise ScenarioError(f"module '{module}' has no source of its own")
    return Path(spec.origin)


def _digest(file: Path) -> str:
    return hashlib.sha256(content_of(file)).hexdigest()[:16]


def _module_of(source: MetricSource) -> ModuleType:
    """Import a module; one beside a file under a name of its own, since another folder may have one of the same name."""
    if source.folder is None:
        return importlib.import_module(source.module)
    spec = importlib.util.spec_from_file_location(f"_metrics_{source.digest}_{source.module}", source.file)
    assert spec is not None and spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)  # data classes look their module up there
    with _on_path(source.folder):
        spec.loader.exec_module(module)
    return module


@contextmanager
def _on_path(folder: Path) -> Iterator[None]:
    """Let a module import what lies beside it."""
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))


def _told(error: BaseException, file: Path | None = None) -> str:
    """Return an error in one line, with the place in the user's code: the last one in `file`, else the last of all."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename != __file__]
    frames = [frame for frame in frames if not frame.filename.startswith("<frozen")]
    frames = [frame for frame in frames if frame.filename == str(file)] or frames
    place = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {' '.join(str(error).split())[:MOST_TOLD]}{place}"


def _lines(error: BaseException) -> tuple[str, ...]:
    """Return the traceback of the user's own code, a line each."""
    own = error.__traceback__
    while own is not None and own.tb_frame.f_code.co_filename == __file__:
        own = own.tb_next
    return tuple("".join(traceback.format_exception(type(error), error, own)).splitlines()[-MOST_LINES_TOLD:])
