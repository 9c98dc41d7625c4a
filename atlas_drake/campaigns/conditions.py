"""Conditions of success: a figure's name, alone or compared with a number."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.errors import shown

_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf"
_FORM = re.compile(rf"\s*([\w.\[\]]+)\s*(?:(<=|>=|==|!=|<|>)\s*({_NUMBER})\s*)?")


def check_conditions(conditions: Iterable[str]) -> None:
    """Checks that every text is a condition.

    Raises:
        CampaignError: Naming the first text that is not.
    """
    for index, text in enumerate(conditions):
        if _FORM.fullmatch(text) is None:
            raise CampaignError(
                f"success[{index}]",
                text,
                f"is {shown(text)}; must be the name of a figure, alone or compared "
                "with a number, such as landing_max_m <= 0.02",
            )


def figure_of(condition: str) -> str:
    """Returns the name of the figure in a valid condition."""
    return _parts(condition)[0]


def unmet(conditions: Iterable[str], figures: Mapping[str, Any]) -> list[str]:
    """Returns the conditions that do not hold; a missing figure meets none."""
    return [text for text in conditions if not _holds(text, figures)]


def _holds(text: str, figures: Mapping[str, Any]) -> bool:
    name, comparison, number = _parts(text)
    value = figures.get(name)
    if comparison is None:
        return bool(value)
    if not isinstance(value, int | float):
        return False
    return _COMPARISONS[comparison](value, float(number))


def _parts(condition: str) -> tuple[Any, ...]:
    """Returns figure, comparison and number; the last two are None without one."""
    found = _FORM.fullmatch(condition)
    assert found is not None  # check_conditions has checked it.
    return found.groups()
