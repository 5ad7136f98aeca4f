"""What is around a car along the lanes, for drivers that think in lanes: positions and gaps in m, speeds in m/s."""

from __future__ import annotations

from typing import NamedTuple


class NextUser(NamedTuple):
    """Who is next on a lane: free way to him, bumper to bumper (m), and his speed (m/s)."""

    id: str
    gap: float
    speed: float


class LaneAround(NamedTuple):
    """A lane of the ego's edge: its number (0: the outermost), how far it leads on along the route without another change
    (m), its speed limit (m/s), who is next ahead and behind on it (None: nobody near)."""

    number: int
    leads_on: float
    limit: float
    leader: NextUser | None
    follower: NextUser | None


class NextLight(NamedTuple):
    """The next light on the way: how far its line is (m) and its letter for the ego, as SUMO writes it."""

    id: str
    distance: float
    letter: str


class Surroundings(NamedTuple):
    """What is next to the ego along the lanes: its own lane, those beside it (`inner`: the next index, to the left where
    traffic keeps right; None: there is none), and the next light."""

    own: LaneAround
    inner: LaneAround | None
    outer: LaneAround | None
    light: NextLight | None
