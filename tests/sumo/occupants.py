"""Where an ego is shown besides, asked value by value."""

import math

from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.sumo import stand_ins
from sumo_reactive.sumo.stand_ins import Occupant
from sumo_reactive.sumo.vehicle_type import pose_of


def occupied(graph, plan, here, ego, s, limits, edges, stop=math.inf):
    """The lane besides that of C, and where on it."""
    return stand_ins.occupied_lane(Occupant(graph, plan, here, ego, limits), s, edges, stop)


def in_change(graph, plan, here, x, y, s, limits):
    """The lane of a change that SUMO does not map a front at (x, y) to."""
    ego = VehicleState(pose_of(x, y, 0.0, limits), 5.0, 0.0)
    return stand_ins.lane_in_change(Occupant(graph, plan, here, ego, limits), s)


def cut_in_bend(graph, plan, here, s, speed, limits, stop=math.inf):
    """The lane that a body at `s` m of C, at `speed` m/s, cuts."""
    ego = VehicleState(Pose(0.0, 0.0, 0.0), speed, 0.0)
    return stand_ins.lane_off_tracked(Occupant(graph, plan, here, ego, limits), s, stop)[0]


def behind(graph, plan, turn, ego, limits, edges):
    """Where it began to turn round."""
    return stand_ins.left_behind(Occupant(graph, plan, None, ego, limits), turn, edges)


def ahead(graph, turn, ego, limits, edges, mapped=""):
    """On the lane that it turns into."""
    return stand_ins.ahead_of_mapping(Occupant(graph, None, None, ego, limits, mapped), turn, edges)


def elsewhere(graph, plan, mapped, s, ego, limits, edges):
    """Where it drives while SUMO has it on another way."""
    return stand_ins.mapped_elsewhere(Occupant(graph, plan, plan.segments[1], ego, limits, mapped), s, edges)


def rear(graph, plan, here, ego, s, limits, edges, mapped=""):
    """On the lane beside the one that it has left a road by."""
    return stand_ins.rear_beside(Occupant(graph, plan, here, ego, limits, mapped), s, edges)


def unseen(graph, plan, here, ego, limits, edges):
    """Where SUMO does not see its rear on a lane declared longer than drawn."""
    return stand_ins.rear_unseen(Occupant(graph, plan, here, ego, limits), edges)
