"""Results are kept with the value that they belong to, and go with it."""

import gc
import weakref

from sumo_reactive.driver.caching import kept


class World:
    """Something to work things out for."""


def counting(most):
    """Return a function whose results are kept, and the arguments of its calls."""
    calls = []

    @kept(most)
    def sums(world, first, second=0):
        calls.append((first, second))
        return [first + second]

    return sums, calls


def test_the_same_arguments_are_worked_out_once_for_each_world():
    sums, calls = counting(9)
    one, other = World(), World()
    assert sums(one, 1) is sums(one, 1) and sums(one, 1) is not sums(other, 1)
    assert sums(one, 1, second=2) is sums(one, 1, second=2) and sums(one, 1, 2) == [3]
    assert calls == [(1, 0), (1, 0), (1, 2), (1, 2)]


def test_nothing_is_a_result_as_well():
    calls = []
    nothing = kept(9)(lambda world: calls.append(world))
    world = World()
    assert nothing(world) is nothing(world) is None and calls == [world]


def test_the_oldest_result_goes_first():
    sums, calls = counting(2)
    world = World()
    for first in (1, 2, 3, 3, 2, 1):
        sums(world, first)
    assert [first for first, _ in calls] == [1, 2, 3, 1]


def test_results_go_with_their_world_even_if_they_hold_it():
    holding = kept(9)(lambda world, key: [world, key])
    world = World()
    gone = weakref.ref(world)
    holding(world, 1)
    del world
    gc.collect()
    assert gone() is None
