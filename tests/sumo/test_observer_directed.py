"""Where an observer directs the look, and when it looks elsewhere; the sensor and the world are scripted."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from helpers.cars import CAR, car_at

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.nouns.traffic import NO_POINTS, packed_boxes
from sumo_reactive.sumo import observer as room
from sumo_reactive.sumo.observer import EgoObserver
from sumo_reactive.sumo.sensor import OnLane, SeenCrossing, SeenLane
from sumo_reactive.sumo.static_obstacles import LANES_REFRESH_M

BENT = Polyline(np.array([(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)]))
"""A crossing's lane: first to the east, then to the north."""


def lane(name, scale=1.0, internal=False, spine=BENT):
    edge = name.rpartition("_")[0]
    return SimpleNamespace(id=name, edge_id=edge, scale=scale, is_internal=internal, spine=spine)


def user(name):
    return car_at(name, 0.0, 0.0, 0.0, 5.0)


class Eyes:
    """A sensor that tells whom it is asked for; what stands is asked for by place."""

    def __init__(self):
        self.asked = []
        self.static = SimpleNamespace(users=(user("stone"),), outlines=(np.array([(50.0, 0.0)]),), parked={}, changes=0)

    def look(self):
        self.asked.append("look")
        return 7.5

    def letters(self, light):
        return f"{light}:G"

    def yellow_until(self, letters):
        return dict.fromkeys(letters, 9.0)

    def vehicles(self, lanes, ego_id):
        self.asked.append((*lanes, ego_id))
        return [OnLane(users, packed_boxes(users)) for users in ((user("a"),), (), (user("b"),))]

    def asker_of(self, ego_id, lanes):
        return f"who asks {ego_id} on {', '.join(lanes)}"

    def on_crossing(self, crossing):
        yield user(f"on {crossing.lane_id}")

    def about_to_cross(self, crossing):
        yield user(f"before {crossing.lane_id}")


@pytest.fixture
def world(monkeypatch):
    """A graph of lanes and crossings, a plan, and the questions about what is in sight."""
    crossing = SimpleNamespace(is_crossing=True, from_lane=":c_w0_0", to_lane=":c_w1_0", light=None)
    way = SimpleNamespace(is_crossing=False, light=None)
    lamps = [None, SimpleNamespace(light_id="s"), SimpleNamespace(light_id="t"), SimpleNamespace(light_id="s")]
    junction = SimpleNamespace(connections=[SimpleNamespace(light=one) for one in lamps])
    graph = SimpleNamespace(
        lanes={one.id: one for one in (lane("a_0", 1.5), lane(":c_0_0", internal=True), lane(":c_c0_0", internal=True))},
        connection_of={":c_0_0": way, ":c_c0_0": crossing},
        junctions={"c": junction, "d": SimpleNamespace(connections=[])},
    )
    passages = [SimpleNamespace(junction_id=name) for name in "dcd"]
    plan = SimpleNamespace(passages=passages, curve=SimpleNamespace(at=lambda s: (s, 0.0, 0.0)))
    asked = []
    seen = {"lanes": ("a_0", ":c_0_0", ":c_c0_0"), "passages": (1, 2)}
    monkeypatch.setattr(room, "lanes_in_sight", lambda *of: (asked.append(of), seen["lanes"])[1])
    monkeypatch.setattr(room, "in_sight", lambda *of: (asked.append(of), seen["passages"])[1])
    return SimpleNamespace(graph=graph, plan=plan, asked=asked, seen=seen)


def test_all_that_matters_is_told_with_the_time_and_without_the_ego_itself(world):
    eyes = Eyes()
    traffic = EgoObserver("ego", eyes, CAR).observe(world.graph, world.plan, 12.0, 8.0, 90.0)
    assert (traffic.time, traffic.sight, traffic.lights) == (7.5, 90.0, {"s": "s:G", "t": "t:G"})
    assert traffic.yellow_until == {"s": 9.0, "t": 9.0}
    assert [one.id for one in traffic.users] == ["a", "b", "on :c_c0_0", "stone"]
    assert [one.id for one in traffic.beside] == ["before :c_c0_0"] and traffic.asker == "who asks ego on a_0, :c_0_0"
    assert traffic.static.tolist() == [[50.0, 0.0]]
    assert eyes.asked == ["look", ("a_0", ":c_0_0", "ego")]
    assert world.asked == [(world.graph, world.plan, CAR, 12.0, 8.0, 90.0), (world.plan, 12.0, 8.0)]


def test_where_nothing_is_in_sight_nothing_is_told(world):
    world.seen |= {"lanes": (), "passages": ()}
    eyes = Eyes()
    eyes.static = SimpleNamespace(users=(), outlines=(), parked={}, changes=0)
    traffic = EgoObserver("ego", eyes, CAR).observe(world.graph, world.plan, 12.0, 8.0, 90.0)
    assert ([one.id for one in traffic.users], traffic.beside, traffic.lights) == (["a", "b"], (), {})
    assert traffic.static is NO_POINTS


def test_what_stands_is_looked_for_about_the_front_and_an_ego_that_is_parked_is_no_obstacle_to_itself(world):
    eyes = Eyes()
    eyes.static.parked = {"ego": np.array([(12.0, 0.0)]), "x": np.array([(13.0, 0.0)])}
    observe = EgoObserver("ego", eyes, CAR).observe
    assert observe(world.graph, world.plan, 12.0, 8.0, 90.0).static.tolist() == [[50.0, 0.0], [13.0, 0.0]]
    assert observe(world.graph, world.plan, 100.0, 8.0, 90.0).static.tolist() == [[50.0, 0.0]]


@pytest.mark.parametrize(
    ("change", "is_anew"),
    [
        ({}, False),
        ({"speed": 9.0}, False),
        ({"front": 2.0 * LANES_REFRESH_M - 0.1}, False),
        ({"front": 2.0 * LANES_REFRESH_M + 0.1}, True),
        ({"front": LANES_REFRESH_M - 0.1}, True),
        ({"sight": 91.0}, True),
        ({"plan": "another"}, True),
    ],
)
def test_the_look_goes_elsewhere_with_another_plan_or_sight_and_every_few_metres(world, change, is_anew):
    observer = EgoObserver("ego", Eyes(), CAR)
    first = {"plan": world.plan, "front": LANES_REFRESH_M + 0.1, "speed": 8.0, "sight": 90.0}
    observer.observe(world.graph, *first.values())
    world.asked.clear()
    if "plan" in change:
        change = {"plan": SimpleNamespace(**vars(world.plan))}
    for _ in range(2):
        observer.observe(world.graph, *(first | change).values())
    assert len(world.asked) == (2 if is_anew else 0)


def test_even_the_first_metres_of_a_plan_are_looked_at(world):
    eyes = Eyes()
    EgoObserver("ego", eyes, CAR).observe(world.graph, world.plan, 0.0, 0.0, 0.0)
    assert eyes.asked[-1] == ("a_0", ":c_0_0", "ego")


def test_lanes_and_crossings_are_looked_at_as_the_network_has_them(world):
    assert room._seen(world.graph, "a_0") == SeenLane("a_0", "a", 1.5, False)
    assert room._seen(world.graph, ":c_0_0") == SeenLane(":c_0_0", ":c_0", 1.0, True)
    seen = room._seen(world.graph, ":c_c0_0")
    first, last = (0.0, 0.0, 0.0, 0.0), (3.0, 4.0, 7.0, pytest.approx(1.5 * math.pi))
    assert seen == SeenCrossing(":c_c0", ":c_c0_0", (":c_w0", ":c_w1"), (first, last))


@pytest.mark.parametrize(
    ("ends", "walks"), [((":c_w0_0", ":c_w0_0"), (":c_w0",)), ((":c_w0_0", ":c_c0_0"), (":c_w0",)), ((":c_c0_0",) * 2, ())]
)
def test_a_walking_area_counts_once_and_the_crossing_itself_is_none(world, ends, walks):
    connection = world.graph.connection_of[":c_c0_0"]
    connection.from_lane, connection.to_lane = ends
    assert room._seen(world.graph, ":c_c0_0").walks == walks
