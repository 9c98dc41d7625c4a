"""Confidence intervals and tests for shares and paired differences, by scipy.

Needs ``scipy``, which is imported on the first call: it takes a second to load.
"""

from __future__ import annotations

from collections.abc import Sequence

LEVEL = 0.95
"""Confidence level of every interval [-]."""


def share_interval(successes: int, trials: int) -> tuple[float, float]:
    """Returns Wilson's score interval of a probability.

    Args:
        successes: Number of successes.
        trials: Number of trials, 1 or more.
    """
    from scipy.stats import binomtest

    interval = binomtest(successes, trials).proportion_ci(LEVEL, method="wilson")
    return float(interval.low), float(interval.high)


def mcnemar(only_first: int, only_second: int) -> float:
    """Returns McNemar's exact two-sided p-value that two success rates are equal.

    Args:
        only_first: Number of pairs of which only the first succeeded.
        only_second: Number of pairs of which only the second succeeded.
    """
    from scipy.stats import binomtest

    discordant = only_first + only_second
    return float(binomtest(only_first, discordant).pvalue) if discordant else 1.0


def mean_interval(values: Sequence[float]) -> tuple[float, float] | None:
    """Returns Student's t interval of a mean; None for fewer than two values."""
    from scipy.stats import sem, t

    if len(values) < 2:
        return None
    mean = sum(values) / len(values)
    half = t.ppf(0.5 + 0.5 * LEVEL, len(values) - 1) * sem(values)
    return float(mean - half), float(mean + half)
