"""One score of a trip after nuPlan's closed-loop score: how its parts weigh."""

from __future__ import annotations

from collections.abc import Mapping

LEAST_PROGRESS = 0.2
"""Who makes less progress scores 0."""

WEIGHTS = {"ttc_score": 5.0, "progress_score": 5.0, "speed_limit_score": 4.0, "comfort_score": 2.0}
"""nuPlan's weights of the parts (nuplan_metrics_aggeregation.md)."""


def driving_score(parts: Mapping[str, float | None], collisions: int) -> float | None:
    """Return Σ w p / Σ w over the parts p, 0 after a collision or with progress below 0.2 (None: no parts; nuPlan).

    The weights w are WEIGHTS. A part that is None is left out.
    """
    known = {name: value for name in WEIGHTS if (value := parts.get(name)) is not None}
    if "progress_score" not in known or "ttc_score" not in known:
        return None
    if collisions or known["progress_score"] < LEAST_PROGRESS:
        return 0.0
    total = sum(WEIGHTS[name] for name in known)
    return round(sum(WEIGHTS[name] * value for name, value in known.items()) / total, 4)
