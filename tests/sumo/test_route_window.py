"""The route that SUMO knows of an ego whose route passes a place twice."""

import libsumo
import pytest

from sumo_reactive.sumo.route_window import RouteWindow


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
    return RouteWindow("ego", ("a", "b", "c", "b", "d"), {"a": "1", "b": "2", "c": "3", "d": "4"}.get)


def test_sumo_is_shown_the_route_up_to_where_it_comes_to_the_same_place_again(told):
    window().follow(1)
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
