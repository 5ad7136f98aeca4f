"""A driver that is a program of its own: it reads a line of JSON from standard input and answers by one on standard output.

Messages to it are {"start": mission}, {"step": view} and {"end": result}; it answers the first with {"ready": true} and each
step with one of {"command": [acceleration, steering rate]}, {"lane": [acceleration, index or null, checked]},
{"place": [x, y, heading, speed]}, {"plan": [[time, x, y, heading, speed], …]} and {"go_on": true}, to each of which it may
add a "reason". Its standard error goes to this program's. `docs/drivers.md` has all fields.
"""

from __future__ import annotations

import os
import select
import shlex
import shutil
import subprocess
import time as clock
from collections.abc import Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import to_json

from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.driver.nouns.surroundings import LaneAround
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.errors import DriverError, ScenarioError
from sumo_reactive.lab.drivers.choice import PROGRAM, DriverChoice, DriverOption
from sumo_reactive.lab.drivers.protocol import (
    DriverAnswer,
    DriverView,
    LaneCommand,
    Mission,
    MotionPlan,
    Placement,
    TripEnd,
    Waypoint,
)

ANSWER_LIMIT_S = 10.0
"""A program that is silent for longer (wall clock) has failed."""

MOST_ANSWER_BYTES = 2**20
"""A longer answer is none."""

AWAKE_S = 1e-4
"""So long (wall clock) an answer is waited for without going to sleep: to be woken takes longer than a quick program."""

_FAREWELL_S = 2.0
_CHUNK = 2**12

USER_COLUMNS = ("id", "x", "y", "heading", "speed", "acceleration", "lane_id", "lane_position")
_COLUMNS_OF = attrgetter(*USER_COLUMNS, "body.length", "body.width")


class Message(BaseModel):
    """What a program may answer: exactly one of the answers, and why."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    ready: bool = False
    command: tuple[float, float] | None = None
    lane: tuple[float, int | None, bool] | None = None
    place: tuple[float, float, float, float] | None = None
    plan: tuple[tuple[float, float, float, float, float], ...] | None = None
    go_on: bool = False
    reason: str = ""

    @property
    def answer(self) -> DriverAnswer:
        """The answer that it holds; None: go on with the plan."""
        if self.command is not None:
            return Command(*self.command)
        if self.lane is not None:
            return LaneCommand(*self.lane)
        if self.place is not None:
            return Placement(*self.place)
        return None if self.plan is None else MotionPlan(tuple(Waypoint(*point) for point in self.plan))


def words_of_program(choice: DriverChoice) -> list[str]:
    """Return the command line that a driver's name holds; raise ScenarioError if there is no such program."""
    try:
        words = shlex.split(choice.name.removeprefix(PROGRAM))
    except ValueError as error:
        raise ScenarioError(f"driver '{choice.name}': {error}") from error
    if not words or not (shutil.which(words[0]) or os.access(choice.folder / words[0], os.X_OK)):
        raise ScenarioError(f"driver '{choice.name}': no such program")
    return words


class ProgramDriver:
    """A driver in a process of its own, with the folder that names it as its working directory."""

    def __init__(self, words: Sequence[str], folder: Path, options: Mapping[str, DriverOption]) -> None:
        self.reason = ""
        self._options, self._rest = dict(options), b""
        own = folder / words[0]
        command = [str(own.absolute()) if own.is_file() else words[0], *words[1:]]
        pipes = subprocess.Popen(command, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
        assert pipes.stdin is not None and pipes.stdout is not None
        self._process, self._into, self._out = pipes, pipes.stdin.fileno(), pipes.stdout.fileno()
        os.set_blocking(self._into, False)
        self._room, self._heard = select.poll(), select.poll()
        self._room.register(self._into, select.POLLOUT)
        self._heard.register(self._out, select.POLLIN)

    def start(self, mission: Mission) -> None:
        """Tell the mission, and wait until the program is ready."""
        told = mission_told(mission) | {"options": self._options}
        if not self._asked({"start": told}).ready:
            raise DriverError('its first answer is not {"ready": true}')

    def step(self, view: DriverView) -> DriverAnswer:
        """Tell the view, and return the answer."""
        message = self._asked({"step": view_told(view)})
        self.reason = message.reason
        return message.answer

    def end(self, result: TripEnd) -> None:
        """Tell the end, and wait a little for the program's own; then end it."""
        try:
            self._tell({"end": result._asdict()})
            assert self._process.stdin is not None
            self._process.stdin.close()
            self._process.wait(_FAREWELL_S)
        except (OSError, subprocess.TimeoutExpired, DriverError):
            pass
        finally:
            self._process.kill()
            self._process.wait()

    def _asked(self, message: Mapping[str, Any]) -> Message:
        self._tell(message)
        line = self._line()
        try:
            return Message.model_validate_json(line)
        except ValidationError as error:
            problem = error.errors()[0]
            place = ".".join(map(str, problem["loc"]))
            raise DriverError(f"answered {line[:80].decode(errors='replace')!r}: {place}: {problem['msg']}") from error

    def _tell(self, message: Mapping[str, Any]) -> None:
        rest = to_json(message) + b"\n"
        while rest:
            try:
                rest = rest[os.write(self._into, rest) :]
            except BlockingIOError:
                if not self._room.poll(1e3 * ANSWER_LIMIT_S):
                    raise DriverError(f"has not read what it is told within {ANSWER_LIMIT_S:g} s") from None
            except OSError as error:
                raise DriverError(self._death()) from error

    def _line(self) -> bytes:
        began = clock.monotonic()
        while b"\n" not in self._rest:
            self._wait(began)
            chunk = os.read(self._out, _CHUNK)
            if not chunk:
                raise DriverError(self._death())
            self._rest += chunk
            if len(self._rest) > MOST_ANSWER_BYTES:
                raise DriverError(f"answered with more than {MOST_ANSWER_BYTES} bytes")
        line, _, self._rest = self._rest.partition(b"\n")
        return line

    def _wait(self, began: float) -> None:
        """Wait until there is something to read, awake at first, and leave the core to the program if that needs it."""
        while (waited := clock.monotonic() - began) < AWAKE_S:
            if self._heard.poll(0):
                return
            os.sched_yield()
        if not self._heard.poll(max(0.0, 1e3 * (ANSWER_LIMIT_S - waited))):
            raise DriverError(f"no answer within {ANSWER_LIMIT_S:g} s")

    def _death(self) -> str:
        try:
            return f"the program ended with code {self._process.wait(_FAREWELL_S)}"
        except subprocess.TimeoutExpired:
            return "the program has closed its standard output"


def mission_told(mission: Mission) -> dict[str, Any]:
    """Return a mission as plain data."""
    limits, route = mission.limits, mission.route
    return {
        "ego": mission.ego, "edges": route.edges, "arrival_position": route.arrival_position,
        "step_length": mission.step_length, "seed": mission.seed, "way": mission.way.tolist(),
        "length": limits.length, "width": limits.width, "wheelbase": limits.wheelbase,
        "front_overhang": limits.front_overhang, "max_speed": limits.max_speed,
        "max_acceleration": limits.max_acceleration, "service_deceleration": limits.service_deceleration,
        "emergency_deceleration": limits.emergency_deceleration, "max_steering_angle": limits.max_steering_angle,
        "max_steering_rate": limits.max_steering_rate, "users": (*USER_COLUMNS, "length", "width"),
    }  # fmt: skip


def view_told(view: DriverView) -> dict[str, Any]:
    """Return a view as plain data; a row a user, in the columns that the mission has named."""
    pose, around = view.state.pose, view.surroundings
    return {
        "time": view.time,
        "ego": user_told(view.ego),
        "rear_axle": pose[:2],
        "steering_angle": view.state.steering_angle,
        "users": [*map(_COLUMNS_OF, view.users)],
        "own": around and _lane_told(around.own),
        "inner": around and around.inner and _lane_told(around.inner),
        "outer": around and around.outer and _lane_told(around.outer),
        "light": around and around.light and tuple(around.light),
    }


def _lane_told(lane: LaneAround) -> tuple[Any, ...]:
    """Return a lane as plain tuples, which are written faster than named ones."""
    number, leads_on, limit, leader, follower = lane
    return number, leads_on, limit, leader and tuple(leader), follower and tuple(follower)


def user_told(user: RoadUser) -> dict[str, Any]:
    """Return the ego as others see it, by the same names."""
    return dict(zip((*USER_COLUMNS, "length", "width"), _COLUMNS_OF(user), strict=True))
