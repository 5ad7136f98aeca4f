"""The lights whose stop lines a vehicle crosses: from SUMO's lights and the vehicle's lane alone, whoever drives it."""

from __future__ import annotations

from typing import NamedTuple

import libsumo

from sumo_reactive.sumo.net_file import edge_id_of


class Signals(NamedTuple):
    """What SUMO's lights rule: `links` maps ways over a stop line to (light, index of its letter), `before` edges to the
    lights at their ends.

    A way is (lane, lane), or (edge, lane inside the junction): SUMO may have a body that swings out on the lane beside.
    """

    links: dict[tuple[str, str], tuple[str, int]]
    before: dict[str, tuple[str, ...]]


def read_signals() -> Signals:
    """Return what the lights of the running simulation rule."""
    links: dict[tuple[str, str], tuple[str, int]] = {}
    before: dict[str, tuple[str, ...]] = {}
    for light in libsumo.trafficlight.getIDList():
        for index, ways in enumerate(libsumo.trafficlight.getControlledLinks(light)):
            for lane, behind, inside in ways:
                edge = edge_id_of(lane)
                links[lane, behind] = links[lane, inside] = links[edge, inside] = light, index
                before[edge] = tuple(dict.fromkeys((*before.get(edge, ()), light)))
    return Signals(links, before)


class StopLines:
    """Watches one vehicle."""

    def __init__(self, signals: Signals) -> None:
        self._signals = signals
        self._lane = ""
        self._letters: dict[str, str] = {}

    def crossed(self, lane_id: str) -> str:
        """Return the letters that the light showed before a step and in it, if the vehicle crosses its stop line in that
        step; else an empty text. `lane_id`: where SUMO has the vehicle after the step (empty: nowhere)."""
        found, links = "", self._signals.links
        if lane_id and lane_id != self._lane:
            link = links.get((self._lane, lane_id)) or links.get((edge_id_of(self._lane), lane_id))
            if link is not None:
                light, index = link
                found = self._letters[light][index] + libsumo.trafficlight.getRedYellowGreenState(light)[index]
            self._lane = lane_id
        ahead = self._signals.before.get(edge_id_of(self._lane), ())
        self._letters = {light: libsumo.trafficlight.getRedYellowGreenState(light) for light in ahead}
        return found
