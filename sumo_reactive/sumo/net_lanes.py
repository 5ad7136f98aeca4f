"""Lanes from a parsed network: shapes, permissions, lengths."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Points, Polyline
from sumo_reactive.driver.parameters import MIN_PATH_LENGTH_M
from sumo_reactive.driver.world.lane import VEHICLE_CLASSES, Lane
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_file import RawNet, edge_id_of

DEFAULT_LANE_WIDTH_M = 3.2
"""SUMO's width of a lane that states none."""

_SMALLEST_STEP_M = 1e-6  # closer points are one


def lane_from(raw: RawNet, lane_id: str) -> Lane:
    """Build one lane; raise NetworkError naming it if it is missing or malformed."""
    edge = raw.edge(edge_id_of(lane_id))
    found = next(((k, lane.attrib) for k, lane in enumerate(edge.iterfind("lane")) if lane.get("id") == lane_id), None)
    if found is None:
        raise NetworkError(f"{raw.path}: unknown lane '{lane_id}'")
    try:
        return _built(edge.attrib, *found)
    except KeyError as error:
        raise NetworkError(f"{raw.path}: lane '{lane_id}' lacks attribute {error}") from error
    except ValueError as error:
        raise NetworkError(f"{raw.path}: lane '{lane_id}': {error}") from error


def _built(edge: Mapping[str, str], index: int, lane: Mapping[str, str]) -> Lane:
    """Build a lane. Its index is its place: what netconvert has written as the index is wrong inside some junctions."""
    return Lane(
        id=lane["id"],
        edge_id=edge["id"],
        index=index,
        spine=Polyline(lengthened(_distinct(coordinates(lane["shape"])))),
        length=max(float(lane["length"]), MIN_PATH_LENGTH_M),
        width=float(lane.get("width", DEFAULT_LANE_WIDTH_M)),
        speed_limit=float(lane["speed"]),
        allowed=permitted(lane.get("allow") or None, lane.get("disallow")),
        is_internal=edge["id"].startswith(":"),
        change_left=permitted(lane.get("changeLeft")),  # the driver's left in left-hand traffic too
        change_right=permitted(lane.get("changeRight")),
    )


def permitted(allow: str | None, disallow: str | None = None) -> frozenset[str]:
    """Return the vehicle classes that the two attributes permit; `allow` wins over `disallow`."""
    if allow is not None:
        return _classes(allow)
    return VEHICLE_CLASSES - _classes(disallow) if disallow else VEHICLE_CLASSES


def _classes(words: str) -> frozenset[str]:
    return VEHICLE_CLASSES if words == "all" else VEHICLE_CLASSES.intersection(words.replace(",", " ").split())


def coordinates(shape: str) -> list[tuple[float, ...]]:
    """Return the points of a `shape` attribute, each (x, y) or (x, y, z), m; raise ValueError if there is none."""
    points = [tuple(map(float, point.split(","))) for point in shape.split()]
    if not points or any(len(point) not in (2, 3) or not all(map(math.isfinite, point)) for point in points):
        raise ValueError(f"shape '{shape[:40]}' is not a list of x,y or x,y,z")
    return points


def heights_of(shape: str) -> NDArray[np.float64] | None:
    """Return the elevation of the points that make the spine, shape (n,), m; None in a flat network."""
    points = _distinct(coordinates(shape))
    if any(len(point) < 3 for point in points):
        return None
    return np.array([point[2] for point in points] + ([points[0][2]] if len(points) == 1 else []))


def _distinct(points: Sequence[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """Drop each point that repeats the one before it."""
    kept = [points[0]]
    for point in points[1:]:
        if math.dist(point[:2], kept[-1][:2]) > _SMALLEST_STEP_M:
            kept.append(point)
    return kept


def lengthened(points: Sequence[tuple[float, ...]], heading: float = 0.0) -> Points:
    """Return points of shape (n ≥ 2, 2); a single point becomes a stub of the shortest length towards `heading` (rad)."""
    if len(points) == 1:
        x, y = points[0][:2]
        end = (x + MIN_PATH_LENGTH_M * math.cos(heading), y + MIN_PATH_LENGTH_M * math.sin(heading))
        return np.array([(x, y), end])
    return np.array([point[:2] for point in points])
