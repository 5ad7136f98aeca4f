"""What a comparison's folder says of its pairs: `comparison.json`, read again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.comparison.record import COMPARISON_VERSION, JSON_FILE
from sumo_reactive.lab.drivers.choice import SUMO_NAME
from sumo_reactive.lab.schema import Keys, Number, read_json, require_version

_Name = Annotated[str, Field(min_length=1)]
_Figures = dict[str, Number | None]


class SideKeys(Keys):
    """One driver's run of a pair; without figures if it did not get to its end."""

    ending: Literal["done", "failed", "crashed", "timeout"]
    verdict: str
    command: str
    figures: Annotated[_Figures, Field(default_factory=dict)]
    trajectory: str = ""


class PairKeys(Keys):
    """A trip with a seed; the run of the driver that is compared is under that driver's name."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, SideKeys]

    scenario: _Name
    ego: str
    seed: int
    sumo: SideKeys
    metrics: dict[str, _Figures]

    def side(self, driver: str) -> SideKeys:
        """Return the run of a driver; raise KeyError if there is none."""
        return self.sumo if driver == SUMO_NAME else self.__pydantic_extra__[driver]


class ComparisonKeys(Keys):
    """`comparison.json`: SUMO's own driver and one other, in this order, and their pairs."""

    version: int = 0
    drivers: Annotated[list[_Name], Field(min_length=2, max_length=2)]
    pairs: list[PairKeys]


def read_comparison(folder: Path) -> ComparisonKeys:
    """Return what the `comparison.json` in a folder says; raise ScenarioError if it is no comparison."""
    path = folder / JSON_FILE
    found = read_json(path, ComparisonKeys, "a comparison")
    require_version(found.version, COMPARISON_VERSION, str(path))
    first, other = found.drivers
    if first != SUMO_NAME or other == SUMO_NAME:
        raise ScenarioError(f"{path}: not a comparison: key 'drivers': not SUMO's own and another")
    for k, pair in enumerate(found.pairs):
        if other not in pair.__pydantic_extra__:
            raise ScenarioError(f"{path}: not a comparison: key 'pairs.{k}.{other}' is missing")
    return found
