"""Where a decision turns over as one figure of a scene grows."""

from __future__ import annotations

from collections.abc import Callable


def turns_at(holds: Callable[[float], bool], low: float, high: float, within: float = 0.002) -> float:
    """Return the value between `low` and `high` at which `holds` changes, to `within`; it must differ at the two ends."""
    first = holds(low)
    assert holds(high) is not first, f"the same at {low} and {high}: {first}"
    while high - low > within:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) is first else (low, middle)
    return 0.5 * (low + high)
