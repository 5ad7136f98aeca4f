"""What is recorded as columns: the names of a trajectory's, and how a table becomes a Parquet file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import duckdb
import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.nouns.record import StepRecord
from sumo_reactive.lab.metric_names import metric_of
from sumo_reactive.lab.schema import RECORD_VERSION
from sumo_reactive.lab.tables import as_os_errors


class StepColumn(NamedTuple):
    """A column of the trajectory: its name, which ends in its unit, what it holds, the type of its values."""

    name: str
    meaning: str
    kind: type = np.float64


STEP_COLUMNS = {
    "time": StepColumn("time_s", "simulation time at the end of the step"),
    "x": StepColumn("x_m", "centre of the front bumper"),
    "y": StepColumn("y_m", "centre of the front bumper"),
    "heading": StepColumn("heading_rad", "counter-clockwise from the x axis"),
    "speed": StepColumn("speed_m_s", "speed; negative: backwards"),
    "acceleration": StepColumn("acceleration_m_s2", "acceleration of the step"),
    "steering_angle": StepColumn("steering_angle_rad", "steering angle φ, positive to the left"),
    "lane_id": StepColumn("lane_id", "lane on which SUMO maps the ego; empty: none", object),
    "s": StepColumn("s_m", "front axle along C"),
    "d": StepColumn("d_m", "front axle beside C, positive to the left"),
    "command_acceleration": StepColumn("command_acceleration_m_s2", "chosen command v̇"),
    "command_steering_rate": StepColumn("command_steering_rate_rad_s", "chosen command φ̇"),
    "desired_speed": StepColumn("desired_speed_m_s", "desired speed v_d"),
    "stop_s": StepColumn("stop_m", "planned stop along C; NULL: none"),
    "u": StepColumn("u", "potential U of the chosen command"),
    "u1": StepColumn("u1", "its term U₁, which keeps the ego on C"),
    "u2": StepColumn("u2", "its term U₂, which keeps it away from others"),
    "u3": StepColumn("u3", "its term U₃, which keeps it at v_d"),
    "leader": StepColumn("leader", "the vehicle that limits the ego; empty: none", object),
    "gap": StepColumn("gap_m", "distance to it; NULL: none"),
    "behaviour": StepColumn("behaviour", "what the ego is doing", object),
    "instruction": StepColumn("instruction", "what the pilot tells the executor", object),
    "pilot": StepColumn("pilot", "how often the pilot decided in this step", np.int64),
    "emergency": StepColumn("emergency", "the ego brakes harder than planned, or has no admissible command", np.bool_),
    "hazard": StepColumn("hazard", "who or what that is for; empty: no command is admissible, or no emergency", object),
    "light": StepColumn("light", "letter that applied at a stop line crossed in this step; empty: none crossed", object),
    "control_us": StepColumn("control_us", "wall-clock time of the control step"),
}  # fmt: skip
"""The columns by the field of `StepRecord` that each holds; what a driver does not have is NULL. Decisions have a file of
their own."""

COLUMNS = {field: column.name for field, column in STEP_COLUMNS.items()}
"""The names alone."""


def trajectory_columns(steps: Sequence[StepRecord]) -> dict[str, NDArray[Any]]:
    """Return `steps` as arrays by the names of their columns; numbers that a driver does not have are NaN."""
    return {one.name: _array([getattr(step, field) for step in steps], one.kind) for field, one in STEP_COLUMNS.items()}


def _array(values: Sequence[Any], kind: type) -> NDArray[Any]:
    return np.array(values, dtype=np.float64 if kind is not object and None in values else kind)


_SQL_TYPES: Mapping[type, str] = {np.int64: "BIGINT", np.bool_: "BOOLEAN", object: "VARCHAR"}
STEP_TYPES = {one.name: _SQL_TYPES[one.kind] for one in STEP_COLUMNS.values() if one.kind in _SQL_TYPES}
"""Types of the columns that are no floating-point numbers, also where a driver has none of them."""


def write_columns(path: Path, table: Mapping[str, NDArray[Any]], types: Mapping[str, str] | None = None) -> None:
    """Write arrays of one length as a Parquet file; NaN becomes NULL. Raises OSError if that cannot be done.

    Its metadata tell the `version` of a record's files and, as JSON, the `units` of the columns that are numbers.

    `types` are those of DuckDB by column; a column of objects is text in any case, also one that is empty or all None.
    """
    cast = {name: "VARCHAR" for name, column in table.items() if column.dtype == object} | dict(types or {})
    columns = (f'CAST("{name}" AS {cast[name]}) AS "{name}"' if name in cast else f'"{name}"' for name in table)
    units = json.dumps({name: metric_of(name).unit for name in table if name not in cast}, ensure_ascii=False)
    with duckdb.connect() as database:
        database.register("steps", dict(table))
        with as_os_errors():
            told = f"(FORMAT parquet, KV_METADATA {{version: '{RECORD_VERSION}', units: '{units}'}})"
            database.execute(f"COPY (SELECT {', '.join(columns)} FROM steps) TO ? {told}", [str(path)])


def digest_of(steps: Iterable[StepRecord]) -> str:
    """Return a digest of all that the steps hold as it is written to a trajectory, but for wall-clock times."""
    digest, fields = hashlib.sha256(), [field for field in COLUMNS if field != "control_us"]
    for step in steps:
        digest.update(repr([getattr(step, field) for field in fields]).encode())
    return digest.hexdigest()
