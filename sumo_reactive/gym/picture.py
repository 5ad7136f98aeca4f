"""The road around the ego from above, in pixels."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.lab.drivers.protocol import DriverView, Mission

SIDE_PX, SHOWN_M = 400, 80.0
_GRASS, _ROAD, _WAY, _OTHER, _EGO = (214, 222, 208), (150, 156, 163), (86, 180, 233), (60, 66, 72), (213, 94, 0)


def picture(view: DriverView, way: NDArray[np.float64], mission: Mission) -> NDArray[np.uint8]:
    """Return (SIDE_PX, SIDE_PX, 3) pixels: SHOWN_M of road around the ego, north up: lanes, way, bodies."""
    image = np.empty((SIDE_PX, SIDE_PX, 3), dtype=np.uint8)
    image[:] = _GRASS
    scale, own = SIDE_PX / SHOWN_M, view.ego
    columns, rows = np.meshgrid(np.arange(SIDE_PX), np.arange(SIDE_PX))
    xs, ys = own.x + (columns - 0.5 * SIDE_PX) / scale, own.y - (rows - 0.5 * SIDE_PX) / scale

    def box(x: float, y: float, heading: float, length: float, width: float, colour: tuple[int, int, int]) -> None:
        along = (xs - x) * math.cos(heading) + (ys - y) * math.sin(heading)
        across = (ys - y) * math.cos(heading) - (xs - x) * math.sin(heading)
        image[(along <= 0.0) & (along >= -length) & (np.abs(across) <= 0.5 * width)] = colour

    def line(points: NDArray[np.float64], width: float, colour: tuple[int, int, int]) -> None:
        for (x0, y0), (x1, y1) in pairwise(points):
            if math.hypot(x1 - own.x, y1 - own.y) < SHOWN_M or math.hypot(x0 - own.x, y0 - own.y) < SHOWN_M:
                box(x1, y1, math.atan2(y1 - y0, x1 - x0), math.hypot(x1 - x0, y1 - y0), width, colour)

    for lane in mission.roads.lanes.values():
        if np.hypot(*(lane.spine.points - (own.x, own.y)).T).min() < lane.length + SHOWN_M:
            line(lane.spine.points, lane.width, _ROAD)
    near = way[np.hypot(*(way - (own.x, own.y)).T) < SHOWN_M]
    line(near[::4], 0.4, _WAY)
    for user in view.users:
        box(user.x, user.y, user.heading, user.body.length, user.body.width, _OTHER)
    box(own.x, own.y, own.heading, own.body.length, own.body.width, _EGO)
    return image
