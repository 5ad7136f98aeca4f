"""The route that SUMO knows of an ego whose route passes a place twice."""

import libsumo
import pytest

from sumo_reactive.sumo.routes import RouteWindow

NOWHERE = (-1,) * 5
"""No edge crosses an earlier one."""


@pytest.fixture
def told(monkeypatch):
    """What SUMO is told; it refuses a route once when the `refused` list is not empty."""
    said = {"added": [], "set": [], "refused": []}

    def set_route(_, name):
        if said["refused"]:
            raise libsumo.TraCIException(said["refused"].pop())
        said["set"].append(name)

    monkeypatch.setattr(libsumo.route, "add", lambda name, edges: said["added"].append(edges))
    monkeypatch.setattr(libsumo.vehicle, "setRouteID", set_route)
    monkeypatch.setattr(libsumo.vehicle, "getRoadID", lambda _: "b")
    return said


def window():
    return RouteWindow("ego", ("a", "b", "c", "b", "d"), {"a": "1", "b": "2", "c": "3", "d": "4"}.get, NOWHERE)


def test_sumo_is_shown_the_route_up_to_where_it_comes_to_the_same_place_again(told):
    window().follow(1)
    assert told["added"] == [("b", "c")]


def test_sumo_is_shown_the_route_up_to_where_it_crosses_itself(told):
    RouteWindow("ego", ("a", "b", "c", "d"), {"a": "1", "b": "2", "c": "3", "d": "4"}.get, (-1, -1, -1, 1)).follow(1)
    assert told["added"] == [("b", "c")]


def test_on_another_edge_sumo_is_shown_nothing(told):
    window().follow(0)
    assert told["set"] == []


def test_a_route_that_sumo_refuses_is_shown_again_in_the_next_step(told):
    told["refused"].append("current edge 'a' not found in new route")
    route = window()
    for _ in range(3):
        route.follow(1)
    assert (len(told["added"]), len(told["set"])) == (1, 1)


@pytest.mark.parametrize(
    ("edges", "ends", "crossed", "is_shown"),
    [
        (("a", "b", "c"), "123", NOWHERE, False),  # no place twice
        (("a", "b", "a"), "121", NOWHERE, True),  # an edge twice
        (("a", "b", "c"), "121", NOWHERE, True),  # a junction twice
        (("a", "b", "c"), "123", (-1, -1, 0), True),  # under a bridge and over it
    ],
)
def test_only_a_route_that_passes_a_place_twice_is_shown_in_parts(told, edges, ends, crossed, is_shown):
    RouteWindow("ego", edges, dict(zip(edges, ends, strict=True)).get, crossed).follow(1)
    assert bool(told["set"]) is is_shown


def test_a_part_is_shown_once_and_each_route_of_the_ego_has_names_of_its_own(told):
    first, second = window(), RouteWindow("ego", ("a", "b", "a"), {"a": "1", "b": "2"}.get, NOWHERE, number=2)
    for _ in range(2):
        first.follow(1)
        second.follow(1)
    assert told["set"] == ["reactive.route.ego.1.1", "reactive.route.ego.2.1"]
    assert told["added"] == [("b", "c"), ("b", "a")]
