"""The keys of the files of a record that explanations and pages read."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.lab.schema import Keys, Number

Text = Annotated[str, Field(min_length=1)]
Point = Annotated[list[Number], Field(min_length=2, max_length=2)]
Regions = dict[str, Annotated[list[Point], Field(min_length=1)]]
"""`regions.json`: the outline of each region by id, m."""


class FaultKeys(Keys):
    """What the ego did to somebody."""

    model_config = ConfigDict(extra="forbid")

    time_s: Number
    user_id: str
    lane_id: str


class ViolationKeys(FaultKeys):
    """What the ego did against a rule."""

    kind: str


class SummaryKeys(Keys):
    """`summary.json`."""

    model_config = ConfigDict(extra="allow")

    ego: Text
    scenario: Text
    verdict: Text
    figures: dict[str, Number | None]
    seed: int | None = None
    departure_s: Number | None = None
    end_s: Number | None = None
    duration_s: Number | None = None
    time_loss_s: Number | None = None
    distance_m: Number | None = None
    collisions: tuple[FaultKeys, ...] = ()
    violations: tuple[ViolationKeys, ...] = ()
    hard_brakes: tuple[FaultKeys, ...] = ()


_Numbers, _Gaps, _Texts = list[Number], list[Number | None], list[str]

COLUMNS: dict[str, Any] = {
    **dict.fromkeys(("time_s", "x_m", "y_m", "speed_m_s", "s_m", "desired_speed_m_s", "u", "u1", "u2", "u3"), _Numbers),
    **dict.fromkeys(("stop_m", "gap_m"), _Gaps),
    **dict.fromkeys(("lane_id", "leader"), _Texts),
    "behaviour": list[Annotated[str, AfterValidator(lambda name: Behaviour(name).value)]],
    "emergency": list[bool],
}
"""The columns of `trajectory.parquet` that are read, and what each holds."""
