"""O_S near the ego: the borders of its roads, what was observed, and nothing inside junctions."""

import numpy as np
import pytest
from helpers.cars import CAR
from helpers.situations import before

from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.nouns.traffic import NO_POINTS, Traffic
from sumo_reactive.driver.view.perceive import locate, perceive
from sumo_reactive.driver.view.static import STATIC_REACH_M, borders_along, static_near, static_within


@pytest.fixture(scope="module")
def ego():
    return before("four_way_priority", ("from_south", "to_north"), 40.0, 8.0)


def near(ego, s: float, extra=NO_POINTS):
    """The points of O_S with the front axle on C at `s`."""
    return static_near(borders_along(ego.plan, ego.graph, "passenger"), s, Pose(*ego.plan.curve.at(s)), 0.0, extra)


def test_the_own_side_of_the_road_ends_half_a_lane_and_the_other_one_and_a_half_lanes_away(ego):
    seen = ego.seen()
    lane = ego.graph.lanes["from_south_0"]
    offsets = np.array([lane.spine.project(x, y)[1] for x, y in seen.static])
    assert np.unique(np.round(offsets / lane.width, 2)) == pytest.approx([-0.5, 1.5], abs=0.05)


def test_borders_are_seen_ahead_within_reach_and_beside_but_not_behind(ego):
    _, y = ego.ego.pose.ahead(CAR.wheelbase)
    ahead = ego.seen().static[:, 1] - y  # the road leads north
    assert -1.5 <= ahead.min() <= 0.0
    assert STATIC_REACH_M - 1.5 < ahead.max() <= STATIC_REACH_M


def test_a_junction_is_open_ground(ego):
    passage = ego.plan.passages[0]
    x, y, _ = ego.plan.curve.at(0.5 * (passage.start + passage.end))
    points = static_within(ego.graph, ego.plan, "passenger", (x, y), 100.0)
    south, north = (ego.plan.curve.at(s)[1] for s in (passage.start, passage.end))
    assert not ((points[:, 1] > south + 1.5) & (points[:, 1] < north - 1.5)).any()


def test_behind_the_junction_the_borders_go_on(ego):
    assert len(near(ego, ego.plan.passages[0].end + 1.0)) >= 10


def test_what_was_observed_counts_within_reach_on_all_sides(ego):
    x, y = ego.ego.pose.ahead(CAR.wheelbase)
    seen = np.array([(x, y - 4.0), (x + 5.0, y + 6.9), (x + 5.0, y + 7.1)])
    traffic = Traffic(time=100.0, users=(), lights={}, static=seen)
    points = perceive(traffic, ego.ego, ego.plan, ego.graph, CAR, locate(ego.ego, ego.plan, CAR, 0.0)).static
    assert [bool((points == p).all(axis=1).any()) for p in seen] == [True, True, False]


def test_a_window_holds_all_points_inside_it(ego):
    x, y, _ = ego.plan.curve.at(20.0)
    far, inside = (x + 51.0, y), (x - 49.0, y + 49.0)
    points = static_within(ego.graph, ego.plan, "passenger", (x, y), 100.0, np.array([far, inside]))
    assert np.abs(points - (x, y)).max() <= 50.0
    assert (points == inside).all(axis=1).any()
    assert len(points) > 100
