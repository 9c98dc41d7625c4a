"""Distributions that a campaign draws a scenario's values from.

As YAML has them: ``{uniform: [10, 60]}``. What they are put into is in ``plan``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.errors import did_you_mean, shown
from atlas_drake.numeric import is_number

FORMS = {
    "uniform": "[lowest, highest]",
    "log_uniform": "[lowest, highest], both above 0",
    "normal": "[mean, standard deviation]",
    "choice": "a list of values",
    "sign": "a number, drawn with either sign",
}
"""What each distribution is given."""


def is_distribution(value: object) -> bool:
    """Tells a distribution from the fields of a structure."""
    return isinstance(value, Mapping) and len(value) == 1 and set(value) <= set(FORMS)


def check_distribution(value: object, path: str) -> dict[str, Any]:
    """Checks a distribution.

    Args:
        value: As YAML has it.
        path: Of the field, for the error.

    Returns:
        The same with Python's own numbers.

    Raises:
        CampaignError: If it is none.
    """
    if not isinstance(value, Mapping) or len(value) != 1:
        raise CampaignError(
            path, value, f"is {shown(value)}; must be such as {{uniform: [10, 60]}}"
        )
    ((kind, given),) = value.items()
    if kind not in FORMS:
        hint = did_you_mean(str(kind), FORMS) or f" There are {', '.join(FORMS)}."
        raise CampaignError(f"{path}.{kind}", given, f"is no distribution.{hint}")
    if kind == "sign":
        numbers = _numbers([given])
        if numbers is not None:
            return {kind: numbers[0]}
    elif kind == "choice":
        if isinstance(given, Sequence) and not isinstance(given, str) and given:
            return {kind: list(given)}
    else:
        numbers = _numbers(given)
        if numbers is not None and len(numbers) == 2 and _allowed(kind, *numbers):
            return {kind: numbers}
    problem = f"is {shown(given)}; must be {FORMS[kind]}"
    raise CampaignError(f"{path}.{kind}", given, problem)


def _allowed(kind: str, first: float, second: float) -> bool:
    if kind == "normal":
        return second >= 0.0
    return first <= second and (kind == "uniform" or first > 0.0)


def _numbers(values: object) -> list[float] | None:
    """Finite numbers, also 1e-3, which YAML takes for a word; None for others."""
    if isinstance(values, str) or not isinstance(values, Sequence):
        return None
    numbers: list[float] = []
    for value in values:
        if not (is_number(value) or isinstance(value, str)):
            return None
        try:
            number = float(value)
        except ValueError:
            return None
        if not math.isfinite(number):
            return None
        numbers.append(number)
    return numbers


def draw(distribution: Mapping[str, Any], random: np.random.Generator) -> Any:
    """Draws one value.

    Args:
        distribution: As ``check_distribution`` returns it.
        random: Drawn from once.
    """
    ((kind, given),) = distribution.items()
    if kind == "choice":
        return given[int(random.integers(len(given)))]
    if kind == "sign":
        return float(given * (1.0 if random.random() < 0.5 else -1.0))
    first, second = given
    if kind == "normal":
        return float(random.normal(first, second))
    if kind == "log_uniform":
        return float(math.exp(random.uniform(math.log(first), math.log(second))))
    return float(random.uniform(first, second))


def example(distribution: Mapping[str, Any]) -> Any:
    """A value in the middle, to check that the field takes such values."""
    ((kind, given),) = distribution.items()
    if kind == "choice":
        return given[0]
    if kind == "sign":
        return given
    if kind == "normal":
        return given[0]
    return given[1]
