"""The environment: one ego, driven by actions, in the simulation that all drivers share."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple, cast

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict, Space
from numpy.typing import NDArray

from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.gym.observation import BOXES, SAMPLE_M, Floats32, Observation, observation_of, sampled
from sumo_reactive.gym.picture import picture
from sumo_reactive.lab.drivers.protocol import Driver, DriverAnswer, DriverView, LaneCommand, Mission, TripEnd
from sumo_reactive.lab.drivers.users_trip import UsersTrip
from sumo_reactive.lab.egos import find_ego
from sumo_reactive.lab.fault import Fault
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import Simulation, started
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.net_reader import read_net


class ActionKind(Enum):
    """What an action means, in shares of what the car can: acceleration and steering rate, or the speed to drive at."""

    STEER = "steer"
    SPEED = "speed"


class Transition(NamedTuple):
    """What a reward is made of: the views before and after a step, way won (m), what the ego has done amiss in it."""

    before: DriverView
    after: DriverView
    advanced: float
    faults: tuple[Fault, ...]


Reward = Callable[[Transition], float]

FAULT_COST, JERK_COST = 10.0, 0.02


def progress_reward(one: Transition) -> float:
    """Return a tenth of the metres won, less for a change of acceleration, and much less for a fault."""
    jerk = abs(one.after.state.acceleration - one.before.state.acceleration)
    return 0.1 * one.advanced - JERK_COST * jerk - FAULT_COST * len(one.faults)


class _Seat(Driver):
    """The driver whose answer is the action."""

    def __init__(self) -> None:
        self.answer: DriverAnswer = LaneCommand(0.0)
        self.mission: Mission | None = None

    def start(self, mission: Mission) -> None:
        self.mission = mission

    def step(self, view: DriverView) -> DriverAnswer:
        return self.answer

    def end(self, result: TripEnd) -> None:
        self.answer = LaneCommand(0.0)


LOST_M = 25.0
"""More than a carriageway of lanes beside each other."""

WINDOW = 200
"""So many points of the way, SAMPLE_M apart, are looked at for the front: 100 m."""


class SumoReactiveEnv(gymnasium.Env[Observation, Floats32]):
    """The ego of a scenario file, `horizon_s` long at most; `action` is "steer" or "speed", `reward` any function.

    An episode is `terminated` at the goal or by a contact, `truncated` at the horizon, when the trip ends otherwise, or when
    the ego is LOST_M off its way. `info`
    tells the faults of a step, and at the end the verdict and every figure of the judges. A seed is SUMO's.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 (as Gymnasium has it)
    _open: SumoReactiveEnv | None = None

    def __init__(
        self, scenario: str | Path, *, action: str = "steer", reward: Reward = progress_reward, horizon_s: float = 300.0,
        render_mode: str | None = None,
    ) -> None:  # fmt: skip
        self._scenario = replace(load_scenario(Path(scenario)), horizon_s=horizon_s)
        self._net = read_net(read_config(self._scenario.config).net_file)
        self._kind, self._reward, self.render_mode = ActionKind(action), reward, render_mode
        self._running, self._seat = ExitStack(), _Seat()
        self._simulation: Simulation | None = None
        self._trip: UsersTrip | None = None
        self._way, self._k, self._known = np.zeros((1, 2)), 0, 0
        self.observation_space: Space[Observation] = cast("Space[Observation]", Dict(dict[str, Space[Any]](BOXES)))
        self.action_space: Space[Floats32] = Box(-1.0, 1.0, (2 if self._kind is ActionKind.STEER else 1,), np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Start SUMO anew with the seed (drawn where none is given), and take the ego over where it departs."""
        super().reset(seed=seed)
        if SumoReactiveEnv._open is not None:
            SumoReactiveEnv._open.close()
        SumoReactiveEnv._open = self
        drawn = int(self.np_random.integers(2**31 - 1)) if seed is None else seed
        scenario, self._seat = replace(self._scenario, seed=drawn), _Seat()
        start = self._running.enter_context(started(scenario))

        def take_over(ego: str) -> UsersTrip:
            self._trip = UsersTrip(start.session, ego, self._net, scenario, lambda: self._seat)
            return self._trip

        self._simulation = Simulation(start, scenario, take_over, None, None)
        self._simulation.admit(*find_ego(start.session, scenario, start.config, None))
        assert self._trip is not None and self._seat.mission is not None
        self._way, self._k, self._known = sampled(self._seat.mission.way), 0, 0
        self._view = self._trip.view()
        self._advance(self._view)
        return observation_of(self._view, self._way, self._k), {"ego": self._trip.id, "seed": drawn}

    def step(self, action: Floats32) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive one step of the simulation by an action."""
        if self._simulation is None or self._trip is None:
            raise gymnasium.error.ResetNeeded("no episode is under way in this process")
        simulation, trip, before = self._simulation, self._trip, self._view
        jury = simulation.juries[trip.id]
        self._seat.answer = self._meant(np.asarray(action, dtype=float), before)
        simulation.step()
        has_ended = bool(simulation.results)
        after = before if has_ended else trip.view()
        faults = jury.faults[self._known :]
        self._known += len(faults)
        advanced = self._advance(after)
        reward = float(self._reward(Transition(before, after, advanced, faults)))
        self._view = after
        touches = any(fault.kind == "collision" for fault in faults)
        info: dict[str, Any] = {"faults": [str(fault) for fault in faults]}
        if has_ended or touches:
            result = simulation.results[0] if has_ended else None
            verdict, figures = (result.verdict, result.figures) if result else (str(faults[0]), jury.figures())
            info |= {"verdict": verdict, "figures": figures}
        terminated = touches or (has_ended and trip.arrived)
        is_lost = math.dist((after.ego.x, after.ego.y), self._way[self._k]) > LOST_M
        return observation_of(after, self._way, self._k), reward, terminated, not terminated and (has_ended or is_lost), info

    def close(self) -> None:
        """End the simulation."""
        self._running.close()
        self._simulation = self._trip = None
        if SumoReactiveEnv._open is self:
            SumoReactiveEnv._open = None

    def render(self) -> NDArray[np.uint8]:
        """Return a picture of the road from above, the ego in its middle."""
        if self._trip is None or self._seat.mission is None:
            raise gymnasium.error.ResetNeeded("no episode is under way in this process")
        return picture(self._view, self._way, self._seat.mission)

    def _meant(self, action: NDArray[np.float64], view: DriverView) -> DriverAnswer:
        assert self._seat.mission is not None
        limits, share = self._seat.mission.limits, np.clip(action, -1.0, 1.0)
        most, least = limits.max_acceleration, limits.service_deceleration
        if self._kind is ActionKind.STEER:
            gain = share[0] * (most if share[0] > 0.0 else least)
            return Command(float(gain), float(share[1]) * limits.max_steering_rate)
        limit = view.surroundings.own.limit if view.surroundings else limits.max_speed
        gain = 0.5 * (1.0 + float(share[0])) * min(limit, limits.max_speed) - view.ego.speed
        return LaneCommand(min(max(gain, -least), most))

    def _advance(self, view: DriverView) -> float:
        """Find the front on the way; return the way that it has won, m."""
        near = self._way[self._k : self._k + WINDOW] - (view.ego.x, view.ego.y)
        won = int(np.argmin(np.einsum("ij,ij->i", near, near))) if len(near) else 0
        self._k += won
        return SAMPLE_M * won
