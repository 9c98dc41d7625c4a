"""Confidence intervals and tests for shares and paired differences."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

Z_95 = 1.959963984540054
"""Quantile of the normal distribution for intervals of 95 % [-]."""
RESAMPLES = 2000
"""Of a bootstrap."""


def wilson(successes: int, trials: int, z: float = Z_95) -> tuple[float, float]:
    """Interval for a probability: Wilson's score interval.

    E. B. Wilson, "Probable inference, the law of succession, and statistical
    inference", JASA 22 (1927), without continuity correction.

    Args:
        successes: Number of successes.
        trials: Number of trials; with none the interval is all of [0, 1].
        z: Quantile of the normal distribution.
    """
    if trials == 0:
        return 0.0, 1.0
    share, spread = successes / trials, z * z / trials
    middle = (share + 0.5 * spread) / (1.0 + spread)
    half = z * math.sqrt(share * (1.0 - share) / trials + 0.25 * spread / trials)
    half /= 1.0 + spread
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    high = 1.0 if successes == trials else min(1.0, middle + half)
    return low, high


def mcnemar(only_first: int, only_second: int) -> float:
    """Exact two-sided p-value that two paired success rates are the same.

    Args:
        only_first: Pairs of which only the first succeeded.
        only_second: Pairs of which only the second did.
    """
    n, k = only_first + only_second, min(only_first, only_second)
    tail = sum(math.comb(n, i) for i in range(k + 1))
    return min(1.0, 2.0 * tail / 2**n)


def mean_interval(differences: Sequence[float]) -> tuple[float, float]:
    """Interval of 95 % for the mean of paired differences, by percentile bootstrap.

    The resamples are always the same, so that a table is, too.
    """
    values = np.asarray(differences, dtype=float)
    random = np.random.default_rng(0)
    picks = random.integers(len(values), size=(RESAMPLES, len(values)))
    low, high = np.percentile(values[picks].mean(axis=1), [2.5, 97.5])
    return float(low), float(high)
