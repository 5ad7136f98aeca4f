"""Drivers that do what none should, and simple ones, for the tests of who drives."""

from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.lab.drivers.protocol import LaneCommand, MotionPlan, Placement, Waypoint


class Obedient:
    """Drives as SUMO allows, and keeps what it is told."""

    def __init__(self, gain: float = 2.0) -> None:
        self.gain, self.missions, self.ends, self.reason = gain, [], [], "drives"

    def start(self, mission):
        """Keep it."""
        self.missions.append(mission)

    def step(self, view):
        """Go."""
        return LaneCommand(self.gain, None, True)

    def end(self, result):
        """Keep it."""
        self.ends.append(result)


class CrashesAt20(Obedient):
    """Divides by zero from 20 s on."""

    def step(self, view):
        """Fail."""
        self.reason = "all is well" if view.time < 20.0 else "oh"
        return super().step(view) if view.time < 20.0 - 1e-6 else 1 / 0


class LooksAround(Obedient):
    """Tells on which kind of lane it is, and whether it is shown what is around."""

    def step(self, view):
        """Look around."""
        place = "junction" if view.ego.lane_id.startswith(":") else "edge"
        self.reason = f"{place}: {'nothing' if view.surroundings is None else view.surroundings.own.number}"
        return super().step(view)


class LooksBack(Obedient):
    """Looks at the lanes around when it has left them behind."""

    def step(self, view):
        """Look at what was shown in the step before."""
        self.shown, before = view, getattr(self, "shown", None)
        return LaneCommand(self.gain, before.surroundings.own.number if before else None, True)


class Quits(Obedient):
    """Ends the whole process, or tries to."""

    def step(self, view):
        """Quit."""
        raise SystemExit(3)


class Leaps(Obedient):
    """Is somewhere else at once."""

    def step(self, view):
        """Leap."""
        return Placement(view.ego.x + 500.0, view.ego.y, 0.0, 10.0)


class Babbles(Obedient):
    """Answers with what is no answer."""

    def step(self, view):
        """Babble."""
        return "faster"


class Silent(Obedient):
    """Goes on with a plan that it never made."""

    def step(self, view):
        """Say nothing."""


class Infinite(Obedient):
    """Wants to be infinitely fast."""

    def step(self, view):
        """Want it."""
        return Command(float("inf"), 0.0)


class Straight(Obedient):
    """Plans 1 s ahead once a second, straight on at 5 m/s, and says nothing in between."""

    def start(self, mission):
        """Nothing is planned."""
        super().start(mission)
        self.until = 0.0

    def step(self, view):
        """Return a plan when the last is over."""
        if view.time < self.until - 1e-6:
            return None
        import math

        own, self.until = view.ego, view.time + 1.0
        ahead = own.x + 5.0 * math.cos(own.heading), own.y + 5.0 * math.sin(own.heading)
        return MotionPlan((
            Waypoint(view.time, own.x, own.y, own.heading, 5.0), Waypoint(self.until, *ahead, own.heading, 5.0),
        ))  # fmt: skip


class NoDriver:
    """Has no `step`."""

    def start(self, mission):
        """Nothing."""

    def end(self, result):
        """Nothing."""
