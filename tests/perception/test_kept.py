"""Results are kept as long as what they were computed from."""

import gc
import weakref

from sumo_reactive.perception.kept import kept


class Thing:
    pass


def test_a_result_is_computed_once_for_each_thing_and_argument():
    calls = []

    @kept
    def doubled(thing: Thing, number: int) -> int:
        calls.append((thing, number))
        return 2 * number

    first, second = Thing(), Thing()
    assert [doubled(first, 1), doubled(first, 1), doubled(first, 2), doubled(second, 1)] == [2, 2, 4, 2]
    assert calls == [(first, 1), (first, 2), (second, 1)]


def test_a_thing_out_of_use_is_not_held():
    @kept
    def nothing(thing: Thing) -> None:
        return None

    thing = Thing()
    nothing(thing)
    gone = weakref.ref(thing)
    del thing
    gc.collect()
    assert gone() is None
