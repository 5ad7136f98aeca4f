"""Paired differences and how sure one can be of their mean."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import bootstrap

CONFIDENCE = 0.95
RESAMPLES = 9999
"""An odd number below 10 000, as usual: the limits of 95 % are then two of the sorted resamples."""

BOOTSTRAP_SEED = 0
"""The same values give the same interval."""

MIN_EXACT = 2
"""Fewer differences than this have no interval."""


@dataclass(frozen=True, slots=True)
class ConfidenceInterval:
    """Limits of a mean at 95 %; `method` is "BCa", or "percentile" where the former is not defined."""

    low: float
    high: float
    method: str

    @property
    def holds_zero(self) -> bool:
        """Whether no difference at all is among the likely ones."""
        return self.low <= 0.0 <= self.high


@dataclass(frozen=True, slots=True)
class PairedDifference:
    """Two measurements of the same n things: mean of each, mean difference (second − first), its interval (None: n = 1)."""

    n: int
    first: float
    second: float
    difference: float
    interval: ConfidenceInterval | None


def paired_difference(pairs: Sequence[tuple[float, float]]) -> PairedDifference | None:
    """Return the mean difference over pairs (first, second); None of nothing."""
    if not pairs:
        return None
    values = np.array(pairs, dtype=float)
    differences = values[:, 1] - values[:, 0]
    first, second = values.mean(axis=0)
    return PairedDifference(
        len(pairs), float(first), float(second), float(differences.mean()), interval_of([float(one) for one in differences])
    )


def interval_of(differences: Sequence[float]) -> ConfidenceInterval | None:
    """Return the bootstrap interval of a mean (Efron 1987, BCa; percentile where BCa is not defined); None for n = 1."""
    if len(differences) < MIN_EXACT:
        return None
    if len(set(differences)) == 1:
        return ConfidenceInterval(differences[0], differences[0], "percentile")
    for method in ("BCa", "percentile"):
        low, high = _limits(differences, method)
        if math.isfinite(low) and math.isfinite(high):
            return ConfidenceInterval(low, high, method)
    return None


def _limits(differences: Sequence[float], method: str) -> tuple[float, float]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # "degenerate": the limits are NaN then, which is looked at
        found = bootstrap(
            (np.array(differences),), np.mean, confidence_level=CONFIDENCE, n_resamples=RESAMPLES, method=method,
            random_state=np.random.default_rng(BOOTSTRAP_SEED),
        )  # fmt: skip
    return float(found.confidence_interval.low), float(found.confidence_interval.high)
