"""Polygons and parked vehicles in a real simulation: who is a body, who is a point of O_S, and nobody twice."""

from types import SimpleNamespace

import libsumo
import numpy as np
import pytest
import shapely
from net_recipes import converted
from simulations import running, simulated

from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.static_obstacles import (
    LANES_REFRESH_M,
    LARGEST_OBSTACLE_M,
    OUTLINE_STEP_M,
    STATIC_SIGHT_M,
    StaticObstacles,
    StaticView,
    hull_of,
    outline,
)

NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="500" y="0"/></nodes>'
EDGES = '<edges><edge id="ab" from="a" to="b" numLanes="1" speed="13.9"/></edges>'
ADDITIONAL = """<additional>
<poly id="block" type="obstacle" shape="100,-2.5 101,-2.5 101,-0.5 100,-0.5"/>
<poly id="chain" type="obstacle" shape="110,-3 110,-1"/>
<poly id="house" type="building" shape="100,20 104,20 104,30"/>
<poly id="far" type="obstacle" shape="480,-2.5 481,-2.5 481,-0.5 480,-0.5"/>
<parkingArea id="bay" lane="ab_0" startPos="150" endPos="180" roadsideCapacity="3"/>
<parkingArea id="kerb" lane="ab_0" startPos="185" endPos="205" roadsideCapacity="2" onRoad="true"/>
</additional>"""
ROUTES = """<vType id="car" length="5" width="1.8"/>
<vehicle id="long" type="car" depart="0" departPos="stop"><route edges="ab"/>
  <stop parkingArea="bay" duration="99"/></vehicle>
<vehicle id="kerbed" type="car" depart="0" departPos="stop"><route edges="ab"/>
  <stop parkingArea="kerb" duration="99"/></vehicle>
<vehicle id="late" type="car" depart="0" departPos="50"><route edges="ab"/>
  <stop lane="ab_0" endPos="80" parking="true" duration="8"/></vehicle>
<vehicle id="halted" type="car" depart="0" departPos="225"><route edges="ab"/>
  <stop lane="ab_0" endPos="230" duration="99"/></vehicle>
<vehicle id="later" type="car" depart="1" departPos="0"><route edges="ab"/>
  <stop lane="ab_0" endPos="95" parking="true" duration="6"/></vehicle>"""


def watched(folder, kind="obstacle") -> list[dict]:
    """What is seen from the road's middle in each of 30 steps."""
    more = folder / "more.add.xml"
    more.write_text(ADDITIONAL)
    with running(converted(folder, NODES, EDGES), folder, ROUTES, "-a", str(more), step=1.0):
        simulated(6)
        obstacles, steps = StaticObstacles(kind), []
        seen = StaticView(obstacles)
        for _ in range(30):
            obstacles.update()
            near = seen.near(120.0, -1.6)
            users = [
                (u.id, u.x, u.y, u.heading, u.speed, u.lane_id, u.is_halted, u.body.length, u.body.width) for u in near.users
            ]
            steps.append({"users": users, "points": near.points, "on_lane": libsumo.lane.getLastStepVehicleIDs("ab_0")})
            simulated()
    return steps


@pytest.fixture(scope="module")
def steps(tmp_path_factory):
    return watched(tmp_path_factory.mktemp("obstacles"))


def box(points, x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    """The points inside a box, and nearly on its rim."""
    p = np.array(points).reshape(-1, 2)
    return p[(p[:, 0] > x0 - 0.1) & (p[:, 0] < x1 + 0.1) & (p[:, 1] > y0 - 0.1) & (p[:, 1] < y1 + 0.1)]


def test_polygons_of_the_type_stand_as_bodies_that_look_along_the_road_and_others_do_not(steps):
    users = {user[0]: user[1:] for user in steps[0]["users"]}
    assert set(users) == {"polygon:block", "polygon:chain"}
    assert users["polygon:block"] == pytest.approx([101.0, -1.5, 0.0, 0.0, "", True, 1.0, 2.0], abs=1e-9)


def test_a_polygon_that_is_but_a_line_gets_a_little_width(steps):
    (chain,) = [user for user in steps[0]["users"] if user[0] == "polygon:chain"]
    assert chain[-2:] == pytest.approx([0.1, 2.1])


def test_the_type_is_configurable(tmp_path):
    first = watched(tmp_path, "building")[0]
    assert [user[0] for user in first["users"]] == ["polygon:house"]


def test_a_vehicle_parked_beside_the_road_is_points_on_its_outline(steps):
    for step in steps:
        points = box(step["points"], 165.0, 170.0, -5.7, -3.9)
        assert len(points) >= (5.0 + 1.8) * 2.0 / OUTLINE_STEP_M
        assert [*points.min(axis=0), *points.max(axis=0)] == pytest.approx([165.0, -5.7, 170.0, -3.9])


def test_a_vehicle_counts_from_the_step_in_which_it_parks_until_it_is_on_the_lane_again(steps):
    for name, front in (("late", 80.0), ("later", 95.0)):
        parked = [len(box(step["points"], front - 5.0, front, -5.7, -3.9)) > 0 for step in steps]
        on_lane = [name in step["on_lane"] for step in steps]
        assert any(parked)
        assert parked == [not there for there in on_lane]


def test_vehicles_that_stand_on_the_lane_are_seen_there_and_are_no_points(steps):
    for step in steps:
        assert {"halted", "kerbed"} <= set(step["on_lane"])
        assert not len(box(step["points"], 185.0, 240.0, -3.2, 0.0))


def test_an_ego_that_has_come_on_looks_anew_and_one_that_has_not_does_not(tmp_path):
    more = tmp_path / "more.add.xml"
    more.write_text(ADDITIONAL)
    with running(converted(tmp_path, NODES, EDGES), tmp_path, ROUTES, "-a", str(more), step=1.0):
        simulated(6)
        seen = StaticView(StaticObstacles(), "long")
        first = seen.near(120.0, -1.6)
        assert seen.near(120.0 + 0.9 * LANES_REFRESH_M, -1.6) is first
        there = seen.near(470.0, -1.6)
        assert [user.id for user in there.users] == ["polygon:far"]
        assert not len(box(first.points, 165.0, 170.0, -5.7, -3.9))  # the ego itself, parked


def test_what_is_far_is_left_out(steps):
    points = np.array(steps[0]["points"])
    assert np.abs(points - (120.0, -1.6)).max() < STATIC_SIGHT_M


@pytest.mark.parametrize("shape", [[(1.0, 2.0)], [(0.0, 0.0), (3.0, 4.0)], [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]])
def test_every_shape_has_an_outline_without_gaps(shape):
    points = outline(hull_of(shape))
    gaps = np.hypot(*np.diff(np.vstack((points, points[:1])), axis=0).T)
    assert 0.0 < gaps.max() <= OUTLINE_STEP_M + 1e-9
    assert shapely.Polygon(points).buffer(0.01).covers(shapely.MultiPoint(shape))


@pytest.mark.parametrize(
    ("shape", "says"),
    [
        ([(0.0, 0.0), (float("nan"), 1.0)], "not a list of finite x,y"),
        ([(float("inf"), 0.0)], "not a list of finite x,y"),
        ([], "not a list of finite x,y"),
        ([(0.0, 0.0), (2.0 * LARGEST_OBSTACLE_M, 1.0)], "more than 10 km"),
    ],
)
def test_a_polygon_that_cannot_stand_on_a_road_is_named(monkeypatch, shape, says):
    polygon = SimpleNamespace(getIDList=lambda: ["stone"], getType=lambda _: "obstacle", getShape=lambda _: shape)
    monkeypatch.setattr("libsumo.polygon", polygon)
    with pytest.raises(ScenarioError, match=f"polygon 'stone': .*{says}"):
        StaticObstacles()
