"""Static obstacles to the centimetre: boxes, fronts, outlines, who is near and when anybody looks anew; SUMO is scripted."""

import math

import libsumo
import numpy as np
import pytest
import shapely
from scripted import Domain, script

from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.static_obstacles import (
    LANES_REFRESH_M,
    LARGEST_OBSTACLE_M,
    POLYGON_REACH_M,
    STATIC_SIGHT_M,
    THIN_POLYGON_M,
    StaticObstacles,
    StaticView,
    hull_of,
    standing,
)

LONG, WIDE = ((0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)), ((0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (0.0, 4.0))


class Traffic:
    """What SUMO says of polygons and of who parks; to be changed under way."""

    def __init__(self, monkeypatch, polygons=None, parked=(), angle=90.0, **vehicle):
        self.begun, self.ended, self.arrived, self.lanes = (), (), (), {}
        polygons = polygons or {}
        car = {"getPosition": (100.0, 50.0), "getAngle": 0.0, "getLength": 4.0, "getWidth": 2.0}
        script(
            monkeypatch,
            polygon=Domain(
                getIDList=tuple(polygons), getType=lambda one: one.partition("-")[0], getShape=lambda one: polygons[one]
            ),
            vehicle=Domain(
                getIDList=("a", "b"), isStoppedParking=lambda one: one in parked,
                getLaneID=lambda one: self.lanes.get(one, ""), **(car | vehicle),
            ),
            lane=Domain(getAngle=lambda lane_id, position: {("e_2", 7.0): angle}[lane_id, position]),
            simulation=Domain(
                convertRoad=("e", 7.0, 2), getParkingStartingVehiclesIDList=lambda: self.begun,
                getParkingEndingVehiclesIDList=lambda: self.ended, getArrivedIDList=lambda: self.arrived,
            ),
        )  # fmt: skip


@pytest.mark.parametrize(
    ("shape", "angle", "front", "heading", "length", "width"),
    [
        (LONG, 90.0, (4.0, 1.0), 0.0, 4.0, 2.0),
        (LONG, 270.0, (0.0, 1.0), math.pi, 4.0, 2.0),
        (LONG, 0.0, (2.0, 2.0), 0.5 * math.pi, 2.0, 4.0),
        (LONG, 180.0, (2.0, 0.0), -0.5 * math.pi, 2.0, 4.0),
        (LONG, 60.0, (4.0, 1.0), 0.0, 4.0, 2.0),
        (LONG, 30.0, (2.0, 2.0), 0.5 * math.pi, 2.0, 4.0),
        (WIDE, 90.0, (2.0, 2.0), 0.0, 2.0, 4.0),
        (WIDE, 20.0, (1.0, 4.0), 0.5 * math.pi, 4.0, 2.0),
    ],
)
def test_a_shape_stands_as_its_box_with_the_side_that_looks_most_along_the_road_in_front(
    monkeypatch, shape, angle, front, heading, length, width
):
    Traffic(monkeypatch, angle=angle)
    one = standing("stone", shapely.Polygon(shape))
    assert (one.x, one.y) == pytest.approx(front)
    assert math.cos(one.heading - heading) == pytest.approx(1.0)
    assert (one.body.length, one.body.width) == pytest.approx((length, width))
    assert (one.id, one.speed, one.lane_id, one.lane_position, one.route) == ("stone", 0.0, "", 0.0, ())
    assert one.is_halted and one.body.max_speed == STANDING_SPEED and one.body.emergency_deceleration >= 9.0


def test_where_sumo_finds_no_road_a_shape_looks_to_the_east(monkeypatch):
    Traffic(monkeypatch, angle=0.0)
    libsumo.simulation.answers["convertRoad"] = libsumo.TraCIException("no road")
    assert standing("stone", shapely.Polygon(LONG)).heading == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("shape", "bounds", "area"),
    [
        (((1.0, 2.0),), (1.0, 2.0, 1.0, 2.0), 0.01),
        (((1.0, 2.0), (4.0, 2.0)), (1.0, 2.0, 4.0, 2.0), 3.1 * 0.1),
        (((0.0, 0.0), (0.0, 5.0), (0.0, 3.0)), (0.0, 0.0, 0.0, 5.0), 5.1 * 0.1),
    ],
)
def test_a_point_or_a_line_gets_a_little_width_all_around_with_square_ends(shape, bounds, area):
    hull, w = hull_of(shape), THIN_POLYGON_M
    assert w == 0.05
    assert hull.bounds == pytest.approx((bounds[0] - w, bounds[1] - w, bounds[2] + w, bounds[3] + w))
    assert hull.area == pytest.approx(area)


def test_the_hull_of_a_shape_is_convex_whatever_its_heights():
    hull = hull_of(((0.0, 0.0, 3.0), (4.0, 0.0, 1.0), (2.0, 1.0, 7.0), (4.0, 2.0, 2.0), (0.0, 2.0, 0.0)))
    assert hull.equals(shapely.Polygon(LONG))


@pytest.mark.parametrize(
    ("shape", "says"),
    [
        (((0.0, 0.0), (LARGEST_OBSTACLE_M, LARGEST_OBSTACLE_M)), None),
        (((0.0, 0.0), (1.0, LARGEST_OBSTACLE_M + 1.0)), "an obstacle of more than 10 km"),
        (((-1.0, 0.0), (LARGEST_OBSTACLE_M, 0.0)), "an obstacle of more than 10 km"),
        (((0.0, 0.0, math.inf), (1.0, 1.0, 2.0 * LARGEST_OBSTACLE_M)), None),  # heights do not matter
        (((0.0, math.nan),), "its shape is not a list of finite x,y"),
        ((), "its shape is not a list of finite x,y"),
    ],
)
def test_a_shape_that_cannot_stand_on_a_road_is_told(monkeypatch, shape, says):
    Traffic(monkeypatch, {"obstacle-1": shape})
    if says is None:
        assert [one.id for one in StaticObstacles("obstacle").users] == ["polygon:obstacle-1"]
        return
    with pytest.raises(ScenarioError) as told:
        StaticObstacles("obstacle")
    assert str(told.value) == f"polygon 'obstacle-1': {says}"


def test_only_polygons_of_the_type_stand_each_with_its_outline(monkeypatch):
    Traffic(monkeypatch, {"obstacle-1": LONG, "house-1": LONG, "obstacle-2": WIDE})
    obstacles = StaticObstacles("obstacle")
    assert [one.id for one in obstacles.users] == ["polygon:obstacle-1", "polygon:obstacle-2"]
    assert [(*one.min(axis=0), *one.max(axis=0)) for one in obstacles.outlines] == [(0, 0, 4, 2), (0, 0, 2, 4)]
    assert all(len(one) == len(np.unique(one, axis=0)) == 24 for one in obstacles.outlines)


def test_who_parks_beside_the_road_counts_as_his_box_as_long_as_he_does(monkeypatch):
    traffic = Traffic(monkeypatch, parked=("a",))
    obstacles, steps = StaticObstacles("obstacle"), []
    points = obstacles.parked["a"]
    assert [*points.min(axis=0), *points.max(axis=0)] == pytest.approx([99.0, 46.0, 101.0, 50.0])  # he looks to the north
    for begun, ended, arrived, lanes in (
        ((), (), (), {}),
        (("b",), (), (), {}),
        (("c",), (), (), {"c": "e_0"}),  # on the lane, where others see him
        ((), ("a",), (), {}),
        ((), ("x",), ("y",), {}),
        (("a",), ("b",), (), {}),
        ((), (), ("a",), {}),
        ((), (), ("a",), {}),
    ):
        traffic.begun, traffic.ended, traffic.arrived, traffic.lanes = begun, ended, arrived, lanes
        obstacles.update()
        steps.append((sorted(obstacles.parked), obstacles.changes))
    assert steps == [
        (["a"], 0), (["a", "b"], 1), (["a", "b"], 1), (["b"], 2), (["b"], 2), (["a"], 3), ([], 4), ([], 4),
    ]  # fmt: skip


def test_who_stands_on_a_lane_at_the_beginning_is_not_beside_the_road(monkeypatch):
    traffic = Traffic(monkeypatch, parked=("a", "b"))
    traffic.lanes = {"a": "e_0"}
    assert list(StaticObstacles("obstacle").parked) == ["b"]


@pytest.mark.parametrize(("dx", "dy"), [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 0.5)])
def test_an_ego_looks_anew_where_it_has_come_on_to_any_side_or_something_has_changed(monkeypatch, dx, dy):
    traffic = Traffic(monkeypatch, {"obstacle-1": LONG})
    obstacles = StaticObstacles("obstacle")
    view, far = StaticView(obstacles, "b"), LANES_REFRESH_M + 0.1
    first = view.near(0.0, 0.0)
    assert [one.id for one in first.users] == ["polygon:obstacle-1"] and len(first.points) == 24
    assert view.near(dx * (LANES_REFRESH_M - 0.1), dy * (LANES_REFRESH_M - 0.1)) is first
    second = view.near(dx * far, dy * far)
    assert second is not first
    assert view.near(dx * (far + 1.0), dy * (far + 1.0)) is second
    traffic.begun = ("a", "b")
    obstacles.update()
    third = view.near(dx * far, dy * far)
    assert third is not second and view.near(dx * far, dy * far) is third


def test_points_of_all_but_the_ego_itself_are_seen_within_sight_on_both_axes(monkeypatch):
    traffic = Traffic(monkeypatch, {"obstacle-1": LONG})
    obstacles = StaticObstacles("obstacle")
    traffic.begun = ("a", "b")
    obstacles.update()
    assert len(StaticView(obstacles, "b").near(50.0, 25.0).points) == 2 * 24
    assert len(StaticView(obstacles).near(50.0, 25.0).points) == 3 * 24
    points = [*obstacles.outlines[0], *obstacles.parked["a"]]
    for x, y in ((2.0 + STATIC_SIGHT_M, 1.0), (2.0, 1.0 - STATIC_SIGHT_M), (2.0 - STATIC_SIGHT_M, 1.0)):
        seen = StaticView(obstacles, "b").near(x, y).points
        there = [p for p in points if max(abs(p[0] - x), abs(p[1] - y)) < STATIC_SIGHT_M]
        assert seen.tolist() == [list(p) for p in there] and 0 < len(there) < len(points)


def test_where_nothing_stands_there_are_no_points_and_no_users(monkeypatch):
    Traffic(monkeypatch)
    seen = StaticView(StaticObstacles("obstacle")).near(0.0, 0.0)
    assert seen.users == () and seen.points.shape == (0, 2)


@pytest.mark.parametrize(("dx", "dy"), [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0)])
@pytest.mark.parametrize(("more", "is_near"), [(-0.1, True), (0.1, False)])
def test_a_polygon_is_near_within_its_own_size_beyond_the_reach(monkeypatch, dx, dy, more, is_near):
    """The box of 4 m by 2 m has its front at (4, 1)."""
    Traffic(monkeypatch, {"obstacle-1": LONG})
    away = POLYGON_REACH_M + 6.0 + more
    seen = StaticView(StaticObstacles("obstacle")).near(4.0 + dx * away, 1.0 + dy * away)
    assert bool(seen.users) is is_near
