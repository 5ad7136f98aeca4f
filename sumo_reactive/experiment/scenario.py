"""Scenarios: what to run, by whom, from a scenario `.toml` or straight from a SUMO configuration."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sumo_reactive.controller import Profile
from sumo_reactive.errors import ScenarioError
from sumo_reactive.parameters import OBSTACLE_POLYGONS
from sumo_reactive.pilot.schedule import Delays
from sumo_reactive.sumo.config import read_config

DEFAULT_SEED = 42


@dataclass(frozen=True)
class Scenario:
    """One run: SUMO configuration `config`, vehicle `ego` (None: to be chosen), as named by the file `source`.

    `step_length_s` None: the scenario's own or 0.1 s, whichever is finer. `until_s` is the simulation time at which the
    run ends at the latest. `until_end` plays the scenario out after the ego's arrival. Polygons of the type
    `obstacle_polygons` stand on the road as bodies.
    """

    config: Path
    ego: str | None = None
    seed: int = DEFAULT_SEED
    step_length_s: float | None = None
    until_s: float | None = None
    profile: Profile = Profile.DEFAULT
    delays: Delays = Delays.REPLAN
    until_end: bool = False
    sumo_options: tuple[str, ...] = ()
    obstacle_polygons: str = OBSTACLE_POLYGONS
    source: Path = Path()


class _Keys(BaseModel):
    """The table `[scenario]`."""

    model_config = ConfigDict(extra="forbid", strict=True)

    config: str
    ego: str | None = None
    seed: int = Field(default=DEFAULT_SEED, ge=0, le=2**31 - 1)
    step_length_s: float | None = Field(default=None, gt=0.0, le=1.0)
    until_s: float | None = Field(default=None, gt=0.0)
    profile: Profile = Field(default=Profile.DEFAULT, strict=False)
    delays: Delays = Field(default=Delays.REPLAN, strict=False)
    obstacle_polygons: str = OBSTACLE_POLYGONS


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid")

    scenario: _Keys


def load_scenario(path: Path) -> Scenario:
    """Read a scenario `.toml`, or a SUMO configuration whatever its name; raise ScenarioError naming file and key."""
    if path.suffix == ".toml":
        return _from_toml(path)
    config = read_config(path)
    return Scenario(config=path, seed=_own_seed(config.options.get("seed", "")), source=path)


def _from_toml(path: Path) -> Scenario:
    try:
        keys = _File.model_validate(tomllib.loads(path.read_text(encoding="utf-8"))).scenario
    except ValidationError as error:
        raise ScenarioError(f"{path}: {_first_problem(error)}") from error
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}{_line_of(str(error))}: not TOML: {_without_place(str(error))}") from error
    except FileNotFoundError as error:
        raise ScenarioError(f"{path}: no such file") from error
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    config = path.parent / keys.config
    read_config(config)
    return Scenario(**(dict(keys) | {"config": config, "source": path}))


def _first_problem(error: ValidationError) -> str:
    problem = error.errors()[0]
    place = ".".join(str(part) for part in problem["loc"])
    kind = {"extra_forbidden": "unknown key", "missing": "missing key"}.get(problem["type"])
    return f"{kind} '{place}'" if kind else f"key '{place}': {problem['msg']}, got {problem['input']!r}"


def _line_of(message: str) -> str:
    found = re.search(r"at line (\d+)", message)
    return f":{found[1]}" if found else ""


def _without_place(message: str) -> str:
    return re.sub(r" \(at .*\)$", "", message)


def _own_seed(text: str) -> int:
    """Return the seed that the configuration states; SUMO itself judges a text that is no number."""
    return int(text) if text.strip().isdecimal() else DEFAULT_SEED
