"""Borders: where the carriageway ends for a class of vehicles, and that the centre line is none."""

import numpy as np
import pytest
from world_pieces import lane

from sumo_reactive.driver.world.borders import BORDER_STEP_M, borders
from sumo_reactive.driver.world.road_graph import RoadGraph

CARS, WALKERS = frozenset({"passenger"}), frozenset({"pedestrian"})


def road(*own, oncoming=(), left_hand=False) -> RoadGraph:
    """A road ab of 100 m along y = 0 with lanes for the classes `own`, outermost first, each 3.2 m; ba beside it."""
    left, right = (-1.0, 1.0) if left_hand else (1.0, -1.0)
    ab = [lane(f"ab_{i}", [(0, left * 3.2 * i), (100, left * 3.2 * i)], allowed=allowed) for i, allowed in enumerate(own)]
    first = left * 3.2 * (len(own) + len(oncoming) - 1)
    ba = [
        lane(f"ba_{i}", [(100, first + right * 3.2 * i), (0, first + right * 3.2 * i)], allowed=allowed)
        for i, allowed in enumerate(oncoming)
    ]
    edge_lanes = {"ab": tuple(ab), "ba": tuple(ba)}
    opposite = {"ab": "ba", "ba": "ab"} if oncoming else {}
    return RoadGraph(
        lanes={one.id: one for one in ab + ba}, edge_lanes=edge_lanes, junctions={}, connections={}, regions={}, arcs=(),
        opposite=opposite, left_hand=left_hand,
    )  # fmt: skip


def lines(graph: RoadGraph, vehicle_class: str = "passenger") -> list[float]:
    """The y of each line of points beside the road ab."""
    return sorted({round(float(y), 3) for y in borders(graph, "ab", vehicle_class)[:, 1]})


def test_a_road_with_one_lane_has_its_two_borders():
    assert lines(road(CARS)) == [-1.6, 1.6]


def test_the_line_between_two_lanes_is_no_border():
    assert lines(road(CARS, CARS)) == [-1.6, 4.8]


def test_the_centre_line_is_no_border_for_the_oncoming_side_may_be_used_to_overtake():
    assert lines(road(CARS, oncoming=(CARS,))) == [-1.6, 4.8]


def test_an_oncoming_side_that_is_closed_to_the_class_is_beyond_the_border():
    assert lines(road(CARS, oncoming=(WALKERS,))) == [-1.6, 1.6]


def test_a_footway_beside_the_road_begins_at_the_border():
    assert lines(road(WALKERS, CARS, oncoming=(WALKERS, CARS))) == [1.6, 8.0]


def test_a_closed_lane_inside_the_carriageway_has_both_its_borders():
    assert lines(road(CARS, WALKERS, CARS)) == [-1.6, 1.6, 4.8, 8.0]
    assert lines(road(CARS, WALKERS, oncoming=(CARS,))) == [-1.6, 1.6, 4.8, 8.0]


def test_what_is_closed_depends_on_the_class():
    buses = frozenset({"bus"})
    assert lines(road(CARS | buses, buses, CARS | buses), "bus") == [-1.6, 8.0]
    assert lines(road(buses, CARS), "passenger") == [1.6, 4.8]


def test_in_left_hand_traffic_the_outer_border_is_on_the_left():
    assert lines(road(CARS, oncoming=(CARS,), left_hand=True)) == [-4.8, 1.6]


def test_who_may_not_drive_at_all_has_no_border():
    assert borders(road(WALKERS), "ab", "passenger").shape == (0, 2)


def test_the_points_reach_from_end_to_end_with_no_gap_wider_than_the_step():
    points = borders(road(CARS), "ab", "passenger")
    for y in (-1.6, 1.6):
        x = np.sort(points[np.isclose(points[:, 1], y), 0])
        assert (x[0], x[-1]) == pytest.approx((0.0, 100.0))
        assert np.diff(x).max() <= BORDER_STEP_M + 1e-9


def test_the_borders_of_a_road_are_worked_out_once():
    graph = road(CARS)
    assert borders(graph, "ab", "passenger") is borders(graph, "ab", "passenger")
