"""Egos that ask to be let in, and whom: SUMO keeps it with the vehicle that is asked."""

from __future__ import annotations

import contextlib

import libsumo

from sumo_reactive.sumo.orders import Tell, nothing

_ASKED_HEADWAY_S, _ASKED_FOR_S, _AT_ONCE = 3.0, 5.0, 10.0
"""Who is asked to let the ego in opens such a gap, and keeps it so long (s); the rate (1/s) with which he turns to it."""

_KEEPS_CLEAR = 1
"""Bit of SUMO's mode of speed: it drives so that it can stop behind who is ahead; egos, moved from outside, do not."""

_ASKERS = "reactive.askers"
"""Parameter of a vehicle: ids of the egos that ask it, with spaces between."""


class Asking:
    """What an ego asks of one other at a time: to fall back gently behind it (`braking`, m/s²)."""

    def __init__(self, ego_id: str, braking: float, tell: Tell) -> None:
        self._ego_id, self._braking, self._tell = ego_id, braking, tell
        self._asked = ""
        self._is_ego = False

    def ask(self, user: str) -> None:
        """Ask somebody on the lane beside, and nobody else any more (empty: nobody).

        SUMO's cars let each other in, but nobody that is moved from outside. Who is so himself sees that he is asked; who
        does not come by the ego's road is not asked.
        """
        if user == self._asked:
            return
        if self._asked:
            self._tell(_drop if self._is_ego else _close_gap, self._asked, self._ego_id, failed=nothing)  # he may have left
            self._asked = ""
        with contextlib.suppress(libsumo.TraCIException):
            if user:
                self._begin(user)

    def _begin(self, user: str) -> None:
        self._is_ego = not libsumo.vehicle.getSpeedMode(user) & _KEEPS_CLEAR
        if self._is_ego:
            self._tell(_add, user, self._ego_id, failed=self._is_refused)
        elif self._is_before(user):
            self._tell(_open_gap, user, self._ego_id, self._braking, failed=self._is_refused)
        else:
            return
        self._asked = user

    def _is_refused(self) -> None:
        self._asked = ""

    def _is_before(self, user: str) -> bool:
        """Whether the way of a user leads past the ego."""
        vehicle = libsumo.vehicle
        edge, position = vehicle.getRoadID(self._ego_id), vehicle.getLanePosition(self._ego_id)
        return bool(edge) and bool(vehicle.getDrivingDistance(user, edge, position) >= 0.0)


def askers_of(ego_id: str) -> list[str]:
    """Return the egos that ask this one to let them in; nobody asks who is not there."""
    try:
        return str(libsumo.vehicle.getParameter(ego_id, _ASKERS)).split()
    except libsumo.TraCIException:
        return []


def _open_gap(user: str, ego_id: str, braking: float) -> None:
    libsumo.vehicle.openGap(user, _ASKED_HEADWAY_S, 0.0, _ASKED_FOR_S, _AT_ONCE, braking, ego_id)


def _close_gap(user: str, _: str) -> None:
    libsumo.vehicle.deactivateGapControl(user)


def _add(user: str, ego_id: str) -> None:
    libsumo.vehicle.setParameter(user, _ASKERS, " ".join((*askers_of(user), ego_id)))


def _drop(user: str, ego_id: str) -> None:
    libsumo.vehicle.setParameter(user, _ASKERS, " ".join(one for one in askers_of(user) if one != ego_id))
