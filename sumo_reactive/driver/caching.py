"""What is worked out once for a value is kept with that value, and goes with it."""

from __future__ import annotations

from collections.abc import Callable
from functools import update_wrapper
from typing import Any, Concatenate, ParamSpec, TypeVar

PLANS_KEPT = 512
"""What is worked out once for a plan is kept for so many: one for each of several hundred egos."""

Owner = TypeVar("Owner")
Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def kept(most: int) -> Callable[[Callable[Concatenate[Owner, Rest], Result]], Callable[Concatenate[Owner, Rest], Result]]:
    """Keep the last `most` results of a function with its first argument, to whose world they belong.

    That argument counts by identity, the others by value. A cache of the function's own would hold worlds that are gone.
    """

    def decorate(function: Callable[Concatenate[Owner, Rest], Result]) -> Callable[Concatenate[Owner, Rest], Result]:
        place = f"_kept_{function.__module__}.{function.__qualname__}"

        def found(owner: Owner, /, *rest: Rest.args, **named: Rest.kwargs) -> Result:
            key: Any = (rest, *named.items()) if named else rest
            try:
                result: Result = owner.__dict__[place][key]
            except KeyError:
                result = function(owner, *rest, **named)
                results = owner.__dict__.setdefault(place, {})
                if len(results) >= most:
                    del results[next(iter(results))]
                results[key] = result
            return result

        update_wrapper(found, function)
        return found

    return decorate
