"""Distributions, from which a campaign draws values of a scenario.

Their form is that of YAML, such as ``{uniform: [10, 60]}``; ``plan`` draws the values.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.config import is_number
from atlas_drake.errors import did_you_mean, shown

FORMS = {
    "uniform": "[lowest, highest]",
    "integers": "[lowest, highest], both whole",
    "log_uniform": "[lowest, highest], both above 0",
    "normal": "[mean, standard deviation]",
    "choice": "a list of values",
    "sign": "a number, drawn with either sign",
}
"""Arguments of each distribution."""


def is_distribution(value: object) -> bool:
    """Returns True for a distribution, and False for fields of a structure."""
    return isinstance(value, Mapping) and len(value) == 1 and set(value) <= set(FORMS)


def check_distribution(value: object, path: str) -> dict[str, Any]:
    """Returns a distribution with numbers of type float.

    Raises:
        CampaignError: Naming the ``path``, if the value is not a distribution.
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
    if kind == "integers" and not (first.is_integer() and second.is_integer()):
        return False
    return first <= second and (kind != "log_uniform" or first > 0.0)


def _numbers(values: object) -> list[float] | None:
    """Converts finite numbers; returns None for others."""
    if not isinstance(values, Sequence) or not all(map(is_number, values)):
        return None
    numbers = [float(value) for value in values]
    return numbers if all(map(math.isfinite, numbers)) else None


def draw(distribution: Mapping[str, Any], random: np.random.Generator) -> Any:
    """Draws one value of a valid distribution, by one call of the generator."""
    ((kind, given),) = distribution.items()
    if kind == "choice":
        return given[int(random.integers(len(given)))]
    if kind == "sign":
        return float(given * (1.0 if random.random() < 0.5 else -1.0))
    first, second = given
    if kind == "integers":
        return int(random.integers(int(first), int(second), endpoint=True))
    if kind == "normal":
        return float(random.normal(first, second))
    if kind == "log_uniform":
        return float(math.exp(random.uniform(math.log(first), math.log(second))))
    return float(random.uniform(first, second))


def example(distribution: Mapping[str, Any]) -> Any:
    """Returns one value of the distribution, to check that a field accepts it."""
    ((kind, given),) = distribution.items()
    if kind == "sign":
        return given
    if kind == "integers":
        return int(given[1])
    return given[0] if kind in ("choice", "normal") else given[1]
