"""The paper's nine motion commands (F&L 1991, §3.3): of three accelerations and three steering rates the pair that leaves
the car nearest to the way, at the speed nearest to the wished one."""

from __future__ import annotations

import itertools
import math

import numpy as np

from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.driver.vehicle.bicycle import advance
from sumo_reactive.lab.drivers.protocol import DriverView
from sumo_reactive_examples.pure_pursuit import PurePursuit

AHEAD_S, PARTS = 0.8, 4
FAR, FAST = 1.0, 1.0
"""Weights of a metre off the way, and of a metre per second off the wished speed."""


class NineCommands(PurePursuit):
    """The driver; options as for `PurePursuit`."""

    def step(self, view: DriverView) -> Command:
        """Return the best of the nine commands."""
        state, limits = view.state, self.limits
        front = np.array(state.pose.ahead(limits.wheelbase))
        self.k += int(np.argmin(np.hypot(*(self.way[self.k : self.k + 400] - front).T)))
        wished = self.wished(view, state.steering_angle)
        rate = 0.5 * limits.max_steering_rate
        gains = -1.5 * self.braking, 0.0, limits.max_acceleration
        commands = (Command(*pair) for pair in itertools.product(gains, (-rate, 0.0, rate)))
        return min(commands, key=lambda command: self.cost(command, view, wished))

    def cost(self, command: Command, view: DriverView, wished: float) -> float:
        """Return the potential of a command that is held for a step, the wheels as they then are from there on."""
        state = advance(view.state, command, self.limits.wheelbase, self.step_length)
        if abs(state.steering_angle) > self.limits.max_steering_angle:
            return math.inf
        off = 0.0
        for _ in range(PARTS):
            state = advance(state, Command(0.0, 0.0), self.limits.wheelbase, AHEAD_S / PARTS)
            front = np.array(state.pose.ahead(self.limits.wheelbase))
            off += float(np.hypot(*(self.way[self.k : self.k + 200] - front).T).min()) / PARTS
        return FAR * off + FAST * abs(state.speed - wished)
