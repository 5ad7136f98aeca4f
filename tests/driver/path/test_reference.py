"""Lanes that end beyond the start of the next one, or are drawn over themselves: what of them C leaves out."""

from __future__ import annotations

import numpy as np
import pytest
from planner_roads import CAR, graph, road, start_on

from sumo_reactive.driver.path.planner import plan
from sumo_reactive.driver.path.reference import fold_of, overrun_of
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route

AB = Route(("a", "b"))
PASSAGE = "a_0->b_0"


def overrunning(start: tuple[float, float], end: tuple[float, float], *bends: tuple[float, float]) -> RoadGraph:
    """A road of 60 m along the x axis, and one from `start` to `end`; the path between them has inner points `bends`."""
    a, b = road("a", [(0.0, 0.0), (60.0, 0.0)]), road("b", [start, end])
    return graph([a, b], [("a_0", "b_0")], {"a_0": list(bends)})


def test_the_lane_is_left_where_the_next_one_crosses_it() -> None:
    found = overrun_of(overrunning((54.0, 2.0), (54.0, -60.0), (57.0, 0.5)), PASSAGE)
    assert found is not None
    assert found.leaves == pytest.approx(54.0, abs=0.1)
    assert found.joins == pytest.approx(np.hypot(3.0, 0.5) + np.hypot(3.0, 1.5) + 2.0, abs=0.6)


def test_the_lane_is_left_where_the_way_behind_it_leaves_it_to_the_side() -> None:
    found = overrun_of(overrunning((50.0, -6.0), (50.0, -60.0), (54.0, 0.0)), PASSAGE)
    assert found is not None
    assert 52.0 < found.leaves < 54.0


@pytest.mark.parametrize(
    "world",
    [
        overrunning((66.0, -6.0), (66.0, -60.0)),
        overrunning((60.0, 6.0), (0.0, 6.0), (62.0, 3.0)),
        overrunning((56.0, 6.0), (0.0, 6.0)),
        overrunning((59.0, -1.0), (59.0, -60.0)),
    ],
    ids=["a turn ahead", "a U-turn", "a way back to the lane beside", "hardly beyond"],
)
def test_other_lanes_are_driven_to_their_end(world: RoadGraph) -> None:
    assert overrun_of(world, PASSAGE) is None


@pytest.mark.parametrize("position", [10.0, 40.0])
def test_c_turns_once_and_its_passage_begins_where_it_leaves_the_lane(position: float) -> None:
    world = overrunning((54.0, 2.0), (54.0, -60.0), (57.0, 0.5))
    found = plan(world, AB, CAR, start_on(world.lanes["a_0"], position))
    assert float(np.ptp(found.curve.heading)) < 2.0
    assert found.curve.x.max() < 56.0
    (passage,) = found.passages
    x, y, _ = found.curve.at(passage.start)
    assert np.hypot(x - 54.0, y) < 1.8  # C rounds the corner there
    assert found.turnarounds == ()
    behind = next(segment for segment in found.segments if segment.lane_id == "b_0")
    assert behind.lane_offset == pytest.approx(2.0, abs=0.6)


def test_who_is_past_that_place_follows_the_lane() -> None:
    world = overrunning((54.0, 2.0), (54.0, -60.0), (57.0, 0.5))
    found = plan(world, AB, CAR, start_on(world.lanes["a_0"], 59.0, speed=2.0))
    assert found.passages[0].start > 3.0


FOLDED = [(0.0, 0.0), (60.0, 0.2), (30.0, 0.4), (90.0, 0.0)]


def test_what_is_drawn_forth_and_back_is_left_out_of_c() -> None:
    lanes = road("a", FOLDED)
    found = fold_of(lanes[0])
    assert found is not None
    assert (found.leaves, found.joins) == pytest.approx((30.0, 90.0), abs=0.1)
    c = plan(graph([lanes], []), Route(("a",)), CAR, start_on(lanes[0], 10.0))
    assert float(np.ptp(c.curve.heading)) < 0.1
    first, second = c.segments
    assert second.lane_offset == found.joins
    assert c.goal == pytest.approx(90.0 - first.lane_offset, abs=0.1)


@pytest.mark.parametrize(
    "points",
    [
        [(0.0, 0.0), (60.0, 0.0), (30.0, 8.0), (0.0, 9.0)],
        [(0.0, 0.0), (60.0, 0.0), (0.0, 10.0), (60.0, 20.0)],
        [(0.0, 0.0), (60.0, 0.0), (60.0, 20.0), (0.0, 20.0), (0.0, 0.0), (60.0, 0.0)],
    ],
    ids=["a hairpin", "two hairpins", "a helix"],
)
def test_a_lane_that_turns_where_it_has_not_been_or_not_at_once_is_driven_as_it_is_drawn(points) -> None:
    assert fold_of(road("a", points)[0]) is None
