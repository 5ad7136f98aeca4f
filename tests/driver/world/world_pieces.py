"""Hand-made connections and junctions for the tests of the world."""

import numpy as np

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.world.junction import Connection, Control, Junction, Turn
from sumo_reactive.driver.world.lane import VEHICLE_CLASSES, Lane
from sumo_reactive.driver.world.regions import ConflictRegion
from sumo_reactive.driver.world.right_of_way import RightOfWay


def connection(name, points, index=0, heights=None, **details) -> Connection:
    """Return a connection `name` = "a_0->b_0" along `points`."""
    from_lane, _, to_lane = name.partition("->")
    return Connection(
        id=name,
        junction_id="j",
        index=index,
        from_lane=from_lane,
        to_lane=to_lane,
        parts=(f":j_{index}_0",),
        path=Polyline(np.array(points, dtype=float)),
        turn=Turn.STRAIGHT,
        control=Control.MAJOR,
        heights=None if heights is None else np.array(heights, dtype=float),
        **details,
    )


def junction(*connections, foes=()) -> Junction:
    """Return a junction whose connections conflict in the index pairs `foes`; the first of a pair yields."""
    size = len(connections)
    yields, conflicts = np.zeros((size, size), dtype=bool), np.zeros((size, size), dtype=bool)
    for i, j in foes:
        yields[i, j] = conflicts[i, j] = conflicts[j, i] = True
    return Junction(
        id="j", kind="priority", outline=np.zeros((1, 2)), connections=connections,
        right_of_way=RightOfWay(yields, conflicts),
    )  # fmt: skip


def lane(lane_id, points=((0, 0), (100, 0)), **details) -> Lane:
    """Return a lane of 3.2 m for everyone."""
    edge, _, index = lane_id.rpartition("_")
    spine = Polyline(np.array(points, dtype=float))
    fixed = {"length": spine.length, "width": 3.2, "speed_limit": 13.9, "allowed": VEHICLE_CLASSES}
    return Lane(id=lane_id, edge_id=edge, index=int(index), spine=spine, **{**fixed, **details})


def only(regions: tuple[ConflictRegion, ...]) -> ConflictRegion:
    """Return the one region there is."""
    (region,) = regions
    return region
