"""Results that are kept as long as what they were computed from is in use."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar
from weakref import finalize

Key = TypeVar("Key")
Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def kept(function: Callable[Concatenate[Key, Rest], Result]) -> Callable[Concatenate[Key, Rest], Result]:
    """Cache `function` by identity of its first argument, for as long as that one lives, and by its other arguments.

    A result is never None.

    Each ego has a plan of its own: a cache of a fixed size would be too small for many egos and hold the plans of the past.
    """
    results: dict[int, dict[Hashable, Result]] = {}

    @wraps(function)
    def cached(key: Key, /, *rest: Rest.args, **more: Rest.kwargs) -> Result:
        of_key = results.get(id(key))
        if of_key is None:
            of_key = results[id(key)] = {}
            finalize(key, results.pop, id(key)).atexit = False
        found = of_key.get(rest)
        if found is None:
            found = of_key[rest] = function(key, *rest, **more)
        return found

    return cached
