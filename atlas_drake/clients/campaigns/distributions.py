"""Distributions, from which a campaign draws values of a scenario.

Their form is that of YAML, such as ``{uniform: [10, 60]}``; ``plan`` draws the values.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from annotated_types import Len, MinLen
from pydantic import FiniteFloat

from atlas_drake.config import checked
from atlas_drake.errors import ScenarioError, did_you_mean

_TWO = Annotated[list[FiniteFloat], Len(2, 2)]
FORMS: dict[str, tuple[Any, str]] = {
    "uniform": (_TWO, "[min, max]"),
    "integers": (Annotated[list[int], Len(2, 2)], "[min, max], both whole"),
    "log_uniform": (_TWO, "[min, max], both above 0"),
    "normal": (_TWO, "[mean, standard deviation]"),
    "choice": (Annotated[list[Any], MinLen(1)], "a list of values"),
    "sign": (FiniteFloat, "a number, drawn with either sign"),
}
"""Type and description of the arguments of each distribution."""


def is_distribution(value: object) -> bool:
    """Returns True for a distribution, and False for fields of a structure."""
    return isinstance(value, Mapping) and len(value) == 1 and set(value) <= set(FORMS)


def check_distribution(value: object, path: str) -> dict[str, Any]:
    """Returns a distribution with numbers of their declared type."""
    if not isinstance(value, Mapping) or len(value) != 1:
        problem = "must be such as {uniform: [10, 60]}"
        raise ScenarioError.about(path, value, problem)
    ((kind, given),) = value.items()
    path = f"{path}.{kind}"
    if kind not in FORMS:
        hint = did_you_mean(str(kind), FORMS) or f" There are {', '.join(FORMS)}."
        raise ScenarioError(path, given, f"is no distribution.{hint}")
    declared, form = FORMS[kind]
    arguments = checked(declared, given, path)
    if not _allowed(kind, arguments):
        raise ScenarioError.about(path, given, f"must be {form}")
    return {kind: arguments}


def _allowed(kind: str, arguments: Any) -> bool:
    if kind in ("choice", "sign"):
        return True
    first, second = arguments
    if kind == "normal":
        return second >= 0.0
    return first <= second and (kind != "log_uniform" or first > 0.0)


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
    return given[0] if kind in ("choice", "normal") else given[1]
