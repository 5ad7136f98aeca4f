"""The other processes of a simulation: what they hand over, and what comes of one that fails or is gone."""

import os
import sys

import pytest

from sumo_reactive.errors import ScenarioError, SimulationError
from sumo_reactive.lab.crew import Crew, Part
from sumo_reactive.lab.peers import PeerMessage, Peers

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="several processes are for Linux")


def work(peers: Peers, order: str) -> tuple[Part, None]:
    """Tell a step, hear the others, and hand over who was heard; or go in the way ordered."""
    if order == "raise":
        raise ScenarioError("there is no such road")
    if order == "raise what is no plain value":
        raise ValueError(lambda: None)
    if order == "go":
        os._exit(1)
    heard = peers.others(PeerMessage(on_their_way=10 * peers.index))
    return Part([], [(str(peers.index), f"{order} {[one.on_their_way for one in heard]}")], set(), set(), peers.number), None


def test_all_hear_all_others_and_hand_over_their_parts():
    with Crew(2, work, "heard") as crew:
        heard = crew.hub.others(PeerMessage(on_their_way=7))
        parts = crew.parts()
        crew.shelve([])
    assert [one.on_their_way for one in heard] == [10, 20]
    assert [part.refused for part in parts] == [[("1", "heard [7, 20]")], [("2", "heard [7, 10]")]]
    assert {part.ego_steps for part in parts} == {3}


def test_alone_there_is_nobody_to_hear():
    with Crew(0, work, "heard") as crew:
        assert (crew.hub.others(PeerMessage()), crew.hub.index, crew.hub.number, crew.parts()) == ([], 0, 1, [])


@pytest.mark.parametrize(
    ("order", "kind", "said"),
    [
        ("raise", ScenarioError, "there is no such road"),
        ("raise what is no plain value", SimulationError, "ValueError: "),
        ("go", SimulationError, "a process that drives a part of the egos has ended"),
    ],
)
def test_what_one_fails_of_is_raised_here(order, kind, said):
    with pytest.raises(kind, match=said), Crew(2, work, order) as crew:
        crew.hub.others(PeerMessage())


def test_the_others_end_with_the_first(tmp_path):
    with pytest.raises(KeyboardInterrupt), Crew(1, work, "heard") as crew:
        process = crew._processes[0]
        raise KeyboardInterrupt
    assert not process.is_alive()
