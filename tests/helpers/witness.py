"""A witness sees a run through SUMO alone: where the ego is, whom it touches, which lights it crosses, who brakes for it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

import libsumo
import shapely

from sumo_reactive.driver.geometry.footprint import Footprint

EGO = "ego"
GHOST = "reactive.ghost."
SHRUNK_M = 0.05
"""The ego's box is smaller by this on every side when it is asked whom it touches."""
SAME_LEVEL_M = 2.5
"""Bodies that differ more in height are on different levels."""
LENGTH_M = 4.7
STANDING_M_S = 0.1
FORCED_LIMIT = -4.6
"""m/s²; SUMO's cars brake with 4.5 of their own accord; harder only where SUMO's own driver forces them to."""
LEADER_REACH_M = 100.0
RED = ("r", "R", "u", "ru", "ur")
"""A light's letter before a step and in it, one if they are the same."""


@dataclass(frozen=True)
class Moment:
    """The ego at a time (s), as SUMO has it."""

    time: float
    x: float
    y: float
    heading: float
    speed: float
    lane: str


@dataclass
class Witness:
    """Sees a run through SUMO alone: where the ego was, whom it touched, which lights it crossed, who braked for it."""

    moments: list[Moment] = field(default_factory=list)
    touched: dict[str, float] = field(default_factory=dict)
    lights: list[tuple[float, str]] = field(default_factory=list)
    forced: list[tuple[float, str, float]] = field(default_factory=list)
    arrived: bool = False
    _speeds: dict[str, float] = field(default_factory=dict)
    _led: set[str] = field(default_factory=set)
    _lane: str = ""
    _letters: dict[tuple[str, str], str] = field(default_factory=dict)

    def __call__(self, _: object = None) -> None:
        """Look once, after a step."""
        names = libsumo.vehicle.getIDList()
        if EGO not in names:
            return
        time, (x, y, z) = libsumo.simulation.getTime(), libsumo.vehicle.getPosition3D(EGO)
        lane = libsumo.vehicle.getLaneID(EGO)
        heading = _heading(libsumo.vehicle.getAngle(EGO))
        self.moments.append(Moment(time, x, y, heading, libsumo.vehicle.getSpeed(EGO), lane))
        self._see_touched(time, z)
        self._see_lights(time, lane)
        self._see_braking(time, names)

    @property
    def duration(self) -> float:
        """Time on the road, s."""
        return self.moments[-1].time - self.moments[0].time

    def slowest(self, *lanes: str) -> float:
        """Return the least speed on lanes whose ids begin so, m/s."""
        return min((m.speed for m in self.moments if m.lane.startswith(lanes)), default=math.inf)

    def stands_in(self, west: float, east: float) -> list[float]:
        """Return when (s) the ego, on its way east, stands or backs up with its body between two places (m, x)."""
        return [
            round(b.time, 2)
            for a, b in pairwise(self.moments)
            if b.x > west and b.x - LENGTH_M < east and b.x - a.x < STANDING_M_S * (b.time - a.time)
        ]

    def lateral(self) -> tuple[float, float]:
        """Return the greatest lateral acceleration (m/s²) and when (s): speed times turn of the body."""
        found = (0.0, 0.0)
        for a, b in pairwise(self.moments):
            turn = abs(math.remainder(b.heading - a.heading, 2.0 * math.pi))
            found = max(found, (0.5 * (a.speed + b.speed) * turn / (b.time - a.time), b.time))
        return found

    def _see_touched(self, time: float, z: float) -> None:
        ego = _body(libsumo.vehicle, EGO, SHRUNK_M)
        for kind in (libsumo.vehicle, libsumo.person):
            for name in kind.getIDList():
                if name == EGO or name.startswith(GHOST) or abs(kind.getPosition3D(name)[2] - z) > SAME_LEVEL_M:
                    continue
                if name not in self.touched and shapely.intersection(ego, _body(kind, name)).area > 0.0:
                    self.touched[name] = round(time, 2)

    def _see_lights(self, time: float, lane: str) -> None:
        letters = {}
        for light in libsumo.trafficlight.getIDList():
            state = libsumo.trafficlight.getRedYellowGreenState(light)
            for letter, ways in zip(state, libsumo.trafficlight.getControlledLinks(light), strict=False):
                for before, behind, inside in ways:
                    letters[before, inside] = letters[before, behind] = letter
        if lane and lane != self._lane:
            before, now = self._letters.get((self._lane, lane), ""), letters.get((self._lane, lane), "")
            if now:
                self.lights.append((round(time, 2), now if now == before else before + now))
            self._lane = lane
        self._letters = letters

    def _see_braking(self, time: float, names: tuple[str, ...]) -> None:
        speeds, led = {}, set()
        for name in names:
            if name == EGO or name.startswith(GHOST):
                continue
            speeds[name] = libsumo.vehicle.getSpeed(name)
            leader = libsumo.vehicle.getLeader(name, LEADER_REACH_M)
            if leader is not None and (leader[0] == EGO or leader[0].startswith(GHOST)):
                led.add(name)
            braking = (speeds[name] - self._speeds.get(name, speeds[name])) / libsumo.simulation.getDeltaT()
            if braking < FORCED_LIMIT and name in led | self._led:
                self.forced.append((round(time, 2), name, round(braking, 1)))
        self._speeds, self._led = speeds, led


def _heading(angle: float) -> float:
    return math.radians(90.0 - angle)


def _body(kind: object, name: str, shrunk: float = 0.0) -> shapely.Polygon:
    (x, y), heading = kind.getPosition(name), _heading(kind.getAngle(name))
    x, y = x - shrunk * math.cos(heading), y - shrunk * math.sin(heading)
    box = Footprint(x, y, heading, kind.getLength(name) - 2 * shrunk, kind.getWidth(name) - 2 * shrunk)
    return shapely.polygons(box.corners())
