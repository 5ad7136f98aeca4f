"""A running SUMO simulation in this process: start, step until the ego departs, end."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
import time as clock
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from traceback import walk_tb
from types import TracebackType
from typing import IO

import libsumo

from sumo_reactive.errors import ScenarioError, SimulationError, WindowClosedError
from sumo_reactive.sumo.orders import SumoOrders
from sumo_reactive.sumo.stand_ins import is_stand_in
from sumo_reactive.sumo.vehicle_type import NOT_ROAD_CARS
from sumo_reactive.sumo.waking import threads_here, woken
from sumo_reactive.sumo.window import window_arguments

_ERRORS = (libsumo.TraCIException, libsumo.FatalTraCIError)

_CLOSING_S, _ASKED_EVERY_S = 1.0, 0.02
"""While its window closes, SUMO fails at what it is asked before it is gone: so long that takes at most."""

Progress = Callable[[float, str], None]


class Session:
    """Context manager around libsumo; what SUMO says of an error becomes a SimulationError with SUMO's own words.

    With a window, closing it ends the simulation with a WindowClosedError. `says_arrivals`: a trip may say where on its last
    edge it ends. What `orders` keep is carried out before the next step.
    """

    def __init__(self, arguments: Sequence[str], *, has_window: bool = False, says_arrivals: bool = True) -> None:
        self._arguments, self._has_window, self.says_arrivals = arguments, has_window, says_arrivals
        self._window_threads = frozenset[int]()
        self._loaded, self.orders = False, SumoOrders()

    def __enter__(self) -> Session:
        with tempfile.TemporaryFile() as heard, _program(self._has_window) as program:
            before = threads_here()
            try:
                with _standard_error_to(heard):
                    libsumo.start([*program, *self._arguments])
            except (*_ERRORS, RuntimeError) as error:
                reason = _first_error(heard) or " ".join(str(error).split()) or type(error).__name__
                raise ScenarioError(f"SUMO rejects the scenario: {reason}") from error
            if not libsumo.isLoaded():
                raise ScenarioError(f"SUMO rejects the scenario: {_first_error(heard) or 'it ends before it loads'}")
            sys.stderr.write("" if self._has_window else _text_of(heard))  # toolkits have much to say
            self._window_threads = threads_here() - before if self._has_window else self._window_threads
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        may_be_closed = self._has_window and isinstance(value, (*_ERRORS, RuntimeError, SimulationError))
        time = self._time_if_known(_CLOSING_S if may_be_closed else 0.0)
        with contextlib.suppress(*_ERRORS), woken(self._window_threads):
            libsumo.close()
        if may_be_closed and not time:
            raise WindowClosedError("SUMO's window was closed") from value
        if isinstance(value, _ERRORS) or (type(value) is RuntimeError and _is_from_sumo(value)):
            said = (line.strip() for line in str(value).splitlines() if line.strip())
            raise SimulationError(f"SUMO failed{time}: {next(said, type(value).__name__)}") from value

    def _time_if_known(self, patience: float) -> str:
        """Return the time in words, empty once SUMO is gone: so long (s) that is waited for."""
        until = clock.monotonic() + patience
        with contextlib.suppress(*_ERRORS):
            while True:
                time = f" at {self.time:.1f} s"
                if clock.monotonic() >= until:
                    return time
                clock.sleep(_ASKED_EVERY_S)
        return ""

    @property
    def has_window(self) -> bool:
        """Whether SUMO shows the simulation in its window."""
        return self._has_window

    @property
    def time(self) -> float:
        """Simulation time, s."""
        return float(libsumo.simulation.getTime())

    @cached_property
    def step_length(self) -> float:
        """Length of a step, s."""
        return float(libsumo.simulation.getDeltaT())

    @property
    def departed(self) -> tuple[str, ...]:
        """Ids of the vehicles that departed in the last step, stand-ins left out."""
        return tuple(name for name in libsumo.simulation.getDepartedIDList() if not is_stand_in(name))

    def step(self) -> None:
        """Simulate one step."""
        self.orders.carry_out()
        libsumo.simulationStep()

    def is_over(self) -> bool:
        """Whether no vehicle is left or to come, or the scenario's end has passed."""
        end = float(libsumo.simulation.getEndTime())
        return libsumo.simulation.getMinExpectedNumber() <= 0 or (0.0 <= end <= self.time)

    def is_past_end(self) -> bool:
        """Whether the scenario's end lies behind."""
        return 0.0 <= float(libsumo.simulation.getEndTime()) < self.time

    def wait_for(
        self, wanted: Callable[[str], bool], until: float | None, progress: Progress | None, name: str = ""
    ) -> str:
        """Step until a vehicle that is `wanted` departs and return its id; empty if the scenario ends before.

        `name` is looked for among the loaded vehicles and persons, so that `why_not` can tell what became of it.
        """
        while True:
            self.step()
            if name:
                self._note(name)
            for vehicle_id in libsumo.simulation.getDepartedIDList():
                if wanted(vehicle_id):
                    return str(vehicle_id)
            if self.is_over() or (until is not None and self.time >= until):
                return ""
            if progress is not None:
                progress(self.time, "waiting for the ego to depart")

    def _note(self, name: str) -> None:
        if not self._loaded and name in libsumo.simulation.getLoadedIDList():
            self._loaded = True
        if name in libsumo.simulation.getDepartedPersonIDList():
            raise ScenarioError(f"ego '{name}' is not a road car: it is a pedestrian")

    def why_not(self, name: str) -> str:
        """Say why vehicle `name` did not depart until now."""
        if self._loaded or name in libsumo.simulation.getPendingVehicles():
            return f"ego '{name}' never departs before {self.time:.1f} s, where the run ends"
        return f"unknown ego '{name}': no such vehicle until {self.time:.1f} s, where the run ends"

    def play_out(self, until: float | None, progress: Progress | None) -> None:
        """Step until the scenario or the run ends."""
        while not self.is_over() and (until is None or self.time < until):
            self.step()
            if progress is not None:
                progress(self.time, "playing out")


def type_of(vehicle_id: str) -> str:
    """Return a vehicle's type id."""
    return str(libsumo.vehicle.getTypeID(vehicle_id))


def class_and_place_of(vehicle_id: str) -> tuple[str, tuple[float, float]]:
    """Return a vehicle's class, and where its front is: x, y, m."""
    x, y = libsumo.vehicle.getPosition(vehicle_id)
    return str(libsumo.vehicle.getVehicleClass(vehicle_id)), (x, y)


def is_road_car(vehicle_id: str) -> bool:
    """Whether a vehicle is driven like a car."""
    return libsumo.vehicle.getVehicleClass(vehicle_id) not in NOT_ROAD_CARS


def sumo_version() -> str:
    """Return the version of the SUMO library in use."""
    return str(libsumo.getVersion()[1])


@contextmanager
def _program(has_window: bool) -> Iterator[list[str]]:
    """Give what SUMO is called with; a window reads how it looks from a file that is gone when SUMO has started."""
    if not has_window:
        yield ["sumo"]
        return
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        yield window_arguments(Path(folder, "window.xml"))


@contextmanager
def _standard_error_to(file: IO[bytes]) -> Iterator[None]:
    """Write what SUMO's own code writes to standard error to `file`: some reasons are said nowhere else."""
    before = os.dup(2)
    os.dup2(file.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(before, 2)
        os.close(before)


def _text_of(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode("utf-8", errors="replace")


def _first_error(file: IO[bytes]) -> str:
    lines = (line.strip() for line in _text_of(file).splitlines())
    return next((line.removeprefix("Error:").strip() for line in lines if line.startswith("Error:")), "")


def _is_from_sumo(error: BaseException) -> bool:
    """Whether SUMO's own code raised an error: one that its library does not know, it hands on as a RuntimeError."""
    *_, (frame, _) = walk_tb(error.__traceback__)
    return Path(frame.f_code.co_filename).parent == Path(libsumo.__file__).parent
