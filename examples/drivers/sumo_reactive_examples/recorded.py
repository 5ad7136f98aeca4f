"""A driver that does again what a record says: every step of a `trajectory.parquet`, whatever the others do now."""

from __future__ import annotations

from pathlib import Path

import duckdb

from sumo_reactive.lab.drivers.protocol import DriverView, Mission, MotionPlan, TripEnd, Waypoint


class Recorded:
    """The driver; option: `file`, the trajectory of a run of the same ego in the same scenario."""

    def __init__(self, file: str) -> None:
        self.file, self.reason = Path(file), "drives as recorded"

    def start(self, mission: Mission) -> None:
        """Read the trajectory."""
        query = "SELECT time_s, x_m, y_m, heading_rad, speed_m_s FROM read_parquet(?) ORDER BY time_s"
        self.plan = MotionPlan(tuple(Waypoint(*row) for row in duckdb.execute(query, [str(self.file)]).fetchall()))

    def step(self, view: DriverView) -> MotionPlan | None:
        """Return the whole trajectory once, and go on with it from then on."""
        plan, self.plan = self.plan, None
        return plan

    def end(self, result: TripEnd) -> None:
        """Nothing is left to do."""
