"""A running SUMO simulation in this process: start, step until the ego departs, end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import TracebackType

import libsumo

from sumo_reactive.errors import ScenarioError, SimulationError

Progress = Callable[[float, str], None]


class Session:
    """Context manager around libsumo; SUMO's own messages become errors with SUMO's own words."""

    def __init__(self, arguments: Sequence[str]) -> None:
        self._arguments = ["sumo", *arguments]

    def __enter__(self) -> Session:
        try:
            libsumo.start(self._arguments)
        except (libsumo.TraCIException, libsumo.FatalTraCIError) as error:
            raise ScenarioError(f"SUMO rejects the scenario: {_first_line(error)}") from error
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        libsumo.close()

    @property
    def time(self) -> float:
        """Simulation time, s."""
        return float(libsumo.simulation.getTime())

    @property
    def step_length(self) -> float:
        """Length of a step, s."""
        return float(libsumo.simulation.getDeltaT())

    def step(self) -> None:
        """Simulate one step."""
        try:
            libsumo.simulationStep()
        except (libsumo.TraCIException, libsumo.FatalTraCIError) as error:
            raise SimulationError(f"SUMO failed at {self.time:.1f} s: {_first_line(error)}") from error

    def is_over(self) -> bool:
        """Whether no vehicle is left or to come, or the scenario's end has passed."""
        end = float(libsumo.simulation.getEndTime())
        return libsumo.simulation.getMinExpectedNumber() <= 0 or (0.0 <= end <= self.time)

    def wait_for(self, wanted: Callable[[str], bool], until: float | None, progress: Progress | None) -> str:
        """Step until a vehicle that is `wanted` departs and return its id; empty if the scenario ends before."""
        while True:
            self.step()
            for vehicle_id in libsumo.simulation.getDepartedIDList():
                if wanted(vehicle_id):
                    return str(vehicle_id)
            if self.is_over() or (until is not None and self.time >= until):
                return ""
            if progress is not None:
                progress(self.time, "waiting for the ego to depart")


def type_of(vehicle_id: str) -> str:
    """Return a vehicle's type id."""
    return str(libsumo.vehicle.getTypeID(vehicle_id))


def class_of(vehicle_id: str) -> str:
    """Return a vehicle's class."""
    return str(libsumo.vehicle.getVehicleClass(vehicle_id))


def sumo_version() -> str:
    """Return the version of the SUMO library in use."""
    return str(libsumo.getVersion()[1])


def _first_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[0] if lines else type(error).__name__
