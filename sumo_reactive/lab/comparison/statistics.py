"""Paired differences and how sure one can be of their mean."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import bootstrap, false_discovery_control, permutation_test

CONFIDENCE = 0.95
RESAMPLES = 9999
"""An odd number below 10 000, as usual: the limits of 95 % are then two of the sorted resamples."""

BOOTSTRAP_SEED = 0
"""The same values give the same interval."""

FEW = 10
"""Fewer pairs than this show too little of how much they vary."""

ALIKE = 1e-9
"""Differences that vary by no more than this share are equal but for rounding: they have no effect size."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedDifference:
    """Two measurements of the same n things: mean of each, mean difference (second − first), its interval (None: n = 1)."""

    n: int
    first: float
    second: float
    difference: float
    interval: ConfidenceInterval | None

    @property
    def is_sure(self) -> bool:
        """Whether the interval leaves out zero, of FEW pairs or more."""
        return self.interval is not None and not self.interval.holds_zero and self.n >= FEW


@dataclass(frozen=True, slots=True)
class Effect:
    """A paired difference with its size, mean over standard deviation (Cohen's d_z; None: all differences are equal), and
    how probable one as large is if drivers made none: `p` alone, `corrected` as one of many (both None: n = 1)."""

    found: PairedDifference
    size: float | None
    p: float | None
    corrected: float | None = None

    @property
    def is_shown(self) -> bool:
        """Whether it is there beyond doubt: among many, by at least FEW pairs."""
        return self.corrected is not None and self.corrected < 1.0 - CONFIDENCE and self.found.n >= FEW


def effects_among(pairs: Mapping[str, Sequence[tuple[float, float]]]) -> dict[str, Effect]:
    """Return the effect on each metric from its pairs (first, second), those without a pair left out.

    p is of a two-sided test that flips the signs of the differences at random, of all flips where they are few; corrected
    for all metrics together, which depend on each other (Benjamini & Yekutieli 2001).
    """
    found = {name: _effect(values) for name, values in pairs.items() if values}
    tested = [name for name, effect in found.items() if effect.p is not None]
    if tested:
        corrected = false_discovery_control([found[name].p for name in tested], method="by")
        for name, value in zip(tested, corrected.tolist(), strict=True):
            found[name] = replace(found[name], corrected=value)
    return found


def _effect(pairs: Sequence[tuple[float, float]]) -> Effect:
    difference = paired_difference(pairs)
    assert difference is not None
    values = np.array([second - first for first, second in pairs])
    if len(values) < MIN_EXACT:
        return Effect(difference, None, None)
    spread = float(values.std(ddof=1))
    if not values.any():
        return Effect(difference, None, 1.0)
    is_alike = spread <= ALIKE * float(np.abs(values).max())
    test = permutation_test(
        (values,), np.mean, permutation_type="samples", vectorized=True, n_resamples=RESAMPLES,
        random_state=np.random.default_rng(BOOTSTRAP_SEED),
    )  # fmt: skip
    return Effect(difference, None if is_alike else float(values.mean()) / spread, float(test.pvalue))


def paired_difference(pairs: Sequence[tuple[float, float]]) -> PairedDifference | None:
    """Return the mean difference over pairs (first, second); None of nothing."""
    if not pairs:
        return None
    values = np.array(pairs, dtype=float)
    differences = values[:, 1] - values[:, 0]
    first, second = values.mean(axis=0)
    return PairedDifference(
        n=len(pairs), first=float(first), second=float(second), difference=float(differences.mean()),
        interval=interval_of([float(one) for one in differences]),
    )  # fmt: skip


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
