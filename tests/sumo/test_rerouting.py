"""The quickest way by places in order, from SUMO's answers about its legs, which are scripted."""

from types import SimpleNamespace

import libsumo
import pytest
from scripted import Domain, script

from sumo_reactive.sumo.routes import quickest_way

LEGS = {
    ("a", "x"): (("a", "m", "x"), 30.0),
    ("b", "x"): (("b", "x"), 20.0),
    ("c", "x"): (("c", "x"), 25.0),
    ("x", "y"): (("x", "k", "y"), 10.0),
    ("y", "x"): (("y", "x"), 1.0),
    ("a", "y"): (("a", "y"), 5.0),
    ("n", "x"): ((), 0.0),  # SUMO finds no way
}


@pytest.fixture(autouse=True)
def asked(monkeypatch):
    """Who has asked for ways, of which type, and when."""
    kinds = set()

    def find(start, goal, kind, now):
        kinds.add((kind, now))
        if (start, goal) not in LEGS:
            raise libsumo.TraCIException("unknown edge")
        edges, time = LEGS[start, goal]
        return SimpleNamespace(edges=edges, travelTime=time)

    types = {"ego": "car", "own": "car@own"}
    script(monkeypatch, simulation=Domain(getTime=12.0, findRoute=find), vehicle=Domain(getTypeID=types))
    return kinds


@pytest.mark.parametrize(
    ("firsts", "goals", "way"),
    [
        ("a", "x", ("a", "m", "x")),
        ("ab", "x", ("b", "x")),
        ("bac", "x", ("b", "x")),
        ("cb", "x", ("b", "x")),
        ("ab", "xy", ("b", "x", "k", "y")),  # each place once, the legs' times together
        ("ab", "yx", ("a", "y", "x")),
        ("ab", "xyx", ("b", "x", "k", "y", "x")),
        ("x", "x", ("x",)),
        ("bx", "x", ("x",)),  # who is there needs no time
        ("n", "x", ()),
        ("nb", "x", ("b", "x")),
        ("zb", "x", ("b", "x")),
        ("z", "x", ()),
        ("a", "xz", ()),  # a leg without a way is none
        ("an", "yx", ("a", "y", "x")),
        ("", "x", ()),
    ],
)
def test_the_way_is_the_quickest_that_begins_with_one_of_the_edges_and_leads_by_all_places(firsts, goals, way):
    assert quickest_way("ego", firsts, tuple(goals)) == way


def test_ways_are_asked_for_the_vehicles_type_at_the_present_time(asked):
    quickest_way("ego", "ab", ("x", "y"))
    assert asked == {("car", 12.0)}


def test_a_type_of_the_vehicles_own_which_sumo_would_forget_is_not_asked_for(asked):
    quickest_way("own", "ab", ("x", "y"))
    assert asked == {("car", 12.0)}
