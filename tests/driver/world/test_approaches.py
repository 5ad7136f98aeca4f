"""Approaches: from which lanes others come to a connection."""

from dataclasses import dataclass, field

from sumo_reactive.driver.world.approaches import Approach, approaches_to


@dataclass
class Roads:
    """Lanes of given lengths; `ways` maps a lane to the (lane before, internal lanes) that lead into it."""

    lengths: dict[str, float]
    ways: dict[str, list[tuple[str, tuple[str, ...]]]] = field(default_factory=dict)
    beside: dict[tuple[str, str], list[str]] = field(default_factory=dict)
    ends: dict[str, tuple[str, str]] = field(default_factory=dict)

    def edge_of(self, lane_id):
        return lane_id.rpartition("_")[0]

    def ends_of(self, edge_id):
        return self.ends.get(edge_id, (f"before {edge_id}", f"behind {edge_id}"))

    def spine_length(self, lane_id):
        return self.lengths[lane_id]

    def arrivals(self, lane_id):
        return self.ways.get(lane_id, [])

    def detours(self, lane_id, edge_id):
        return self.beside.get((lane_id, edge_id), [])


def test_the_lane_before_the_stop_line_is_as_far_as_it_is_long():
    assert approaches_to("a_0", "z", Roads({"a_0": 80.0}), 200.0) == (Approach("a_0", 80.0, ("a", "z")),)


def test_internal_lanes_and_the_lanes_before_them_lie_farther_upstream():
    roads = Roads({"a_0": 80.0, ":j_0_0": 4.0, ":j_1_0": 6.0, "b_0": 50.0}, {"a_0": [("b_0", (":j_0_0", ":j_1_0"))]})
    assert approaches_to("a_0", "z", roads, 200.0) == (
        Approach("a_0", 80.0, ("a", "z")),
        Approach(":j_1_0", 86.0, ("a", "z")),
        Approach(":j_0_0", 90.0, ("a", "z")),
        Approach("b_0", 140.0, ("b", "a", "z")),
    )


def test_the_search_ends_at_the_horizon():
    roads = Roads({"a_0": 80.0, ":j_0_0": 4.0, "b_0": 50.0}, {"a_0": [("b_0", (":j_0_0",))]})
    assert [found.lane_id for found in approaches_to("a_0", "z", roads, 80.0)] == ["a_0"]
    assert [found.lane_id for found in approaches_to("a_0", "z", roads, 82.0)] == ["a_0", ":j_0_0"]


def test_a_lane_beside_that_does_not_lead_there_is_an_approach_too():
    roads = Roads({"a_0": 80.0, "a_1": 81.0}, beside={("a_0", "z"): ["a_1"]})
    assert Approach("a_1", 81.0, ("a", "z")) in approaches_to("a_0", "z", roads, 200.0)


def test_a_ring_road_is_searched_once_around():
    ends = {"a": ("k", "j"), "b": ("j", "k")}
    roads = Roads({"a_0": 20.0, "b_0": 20.0}, {"a_0": [("b_0", ())], "b_0": [("a_0", ())]}, ends=ends)
    assert [found.edges for found in approaches_to("a_0", "z", roads, 200.0)] == [("a", "z")]


def test_vehicles_that_would_turn_around_first_are_left_out():
    ends = {"a": ("k", "j"), "-a": ("j", "k"), "b": ("m", "k")}
    roads = Roads({"a_0": 20.0, "-a_0": 20.0, "b_0": 20.0}, {"a_0": [("-a_0", ()), ("b_0", ())]}, ends=ends)
    assert [found.lane_id for found in approaches_to("a_0", "z", roads, 200.0)] == ["a_0", "b_0"]


def test_a_connection_that_turns_around_has_approaches_itself():
    ends = {"a": ("k", "j"), "-a": ("j", "k")}
    assert approaches_to("a_0", "-a", Roads({"a_0": 20.0}, ends=ends), 200.0)
