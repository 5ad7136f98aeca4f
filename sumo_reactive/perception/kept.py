"""Results that are kept as long as what they were computed from is in use."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

Key = TypeVar("Key")
Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def kept(function: Callable[Concatenate[Key, Rest], Result]) -> Callable[Concatenate[Key, Rest], Result]:
    """Cache `function` by identity of its first argument, for as long as that one lives, and by its other arguments.

    Each ego has a plan of its own: a cache of a fixed size would be too small for many egos and hold the plans of the past.
    """
    results: WeakKeyDictionary[Key, dict[Hashable, Result]] = WeakKeyDictionary()

    @wraps(function)
    def cached(key: Key, /, *rest: Rest.args, **more: Rest.kwargs) -> Result:
        of_key = results.get(key)
        if of_key is None:
            of_key = results[key] = {}
        if rest not in of_key:
            of_key[rest] = function(key, *rest, **more)
        return of_key[rest]

    return cached
