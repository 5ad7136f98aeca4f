"""Room for those who drive abreast of the ego through a junction, from a neighbour lane of its road."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Points
from sumo_reactive.driver.parameters import CORRIDOR_MARGIN_M, HOLD_BACK_REACH_M, WAITING_WIDTH_M
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.abreast import Abreast, beside

Floats = NDArray[np.float64]

ABREAST_REACH_M = HOLD_BACK_REACH_M
"""Ways abreast are looked at this far behind the junction: the one may still be inside it where the other has left it."""

SPARE_M = 0.05
"""Room left beyond what the corridor of the ego takes."""


def keep_abreast(shift: Floats, line: Points, ways: Iterable[Abreast], limits: VehicleLimits) -> None:
    """Set in `shift` (n,), m to the left, how far `line` (n, 2) has to be moved to leave room for a car on each of `ways`.

    Between two of them it runs in the middle. A way that leads to the other side is crossed, not kept clear of.
    """
    room = 0.5 * (limits.width + WAITING_WIDTH_M) + CORRIDOR_MARGIN_M + SPARE_M
    left, right = np.zeros(len(line)), np.zeros(len(line))
    for abreast in ways:
        aside = beside(abreast.way, line)
        needed = np.sign(aside) * np.maximum(room - np.abs(aside), 0.0)
        if needed.min() >= 0.0 or needed.max() <= 0.0:
            left, right = np.maximum(left, needed), np.minimum(right, needed)
    needed = np.where((left > 0.0) & (right < 0.0), 0.5 * (left + right), left + right)
    more = np.abs(needed) > np.abs(shift)
    shift[more] = needed[more]
