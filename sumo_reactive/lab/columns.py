"""What is recorded as columns: the names of a trajectory's, and how a table becomes a Parquet file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.nouns.record import StepRecord
from sumo_reactive.lab.tables import as_os_errors

COLUMNS = {
    "time": "time_s", "x": "x_m", "y": "y_m", "heading": "heading_rad", "speed": "speed_m_s",
    "acceleration": "acceleration_m_s2", "steering_angle": "steering_angle_rad", "lane_id": "lane_id",
    "s": "s_m", "d": "d_m",
    "command_acceleration": "command_acceleration_m_s2", "command_steering_rate": "command_steering_rate_rad_s",
    "desired_speed": "desired_speed_m_s", "stop_s": "stop_m", "u": "u", "u1": "u1", "u2": "u2", "u3": "u3",
    "leader": "leader", "gap": "gap_m", "behaviour": "behaviour", "instruction": "instruction", "pilot": "pilot",
    "emergency": "emergency", "hazard": "hazard", "light": "light", "control_us": "control_us",
}  # fmt: skip
"""Column of each field of `StepRecord`; decisions have a file of their own."""

_FLAGS, _TEXTS = ("emergency",), ("lane_id", "leader", "hazard", "behaviour", "instruction", "light")
_TYPES: dict[str, type] = {"pilot": np.int64} | dict.fromkeys(_FLAGS, np.bool_) | dict.fromkeys(_TEXTS, object)


def trajectory_columns(steps: Sequence[StepRecord]) -> dict[str, NDArray[Any]]:
    """Return `steps` as arrays by the names of their columns; numbers that a driver does not have are NaN."""
    return {column: _array([getattr(step, field) for step in steps], field) for field, column in COLUMNS.items()}


def _array(values: Sequence[Any], field: str) -> NDArray[Any]:
    kind = _TYPES.get(field, np.float64)
    return np.array(values, dtype=np.float64 if kind is not object and None in values else kind)


def write_columns(path: Path, table: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays of one length as a Parquet file; NaN becomes NULL. Raises OSError if that cannot be done."""
    with duckdb.connect() as database:
        database.register("steps", dict(table))
        with as_os_errors():
            database.table("steps").write_parquet(str(path))
