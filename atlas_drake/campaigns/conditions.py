"""Rules of success: conditions on a trial's figures, as short texts."""

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
_FORM = re.compile(r"\s*([\w.\[\]]+)\s*(?:(<=|>=|==|!=|<|>)\s*(\S+)\s*)?")


def check_conditions(conditions: Iterable[str]) -> None:
    """Checks their form.

    Raises:
        CampaignError: Naming the first that is none.
    """
    for index, text in enumerate(conditions):
        if _parsed(text) is None:
            raise CampaignError(
                f"success[{index}]",
                text,
                f"is {shown(text)}; must be the name of a figure, alone or compared "
                "with a number, such as landing_max_m <= 0.02",
            )


def figure_of(condition: str) -> str:
    """The name of the figure that a valid condition is about."""
    parsed = _parsed(condition)
    assert parsed is not None
    return parsed[0]


def unmet(conditions: Iterable[str], figures: Mapping[str, Any]) -> list[str]:
    """The conditions that do not hold; a figure that is missing meets none."""
    return [text for text in conditions if not _holds(text, figures)]


def _holds(text: str, figures: Mapping[str, Any]) -> bool:
    parsed = _parsed(text)
    assert parsed is not None
    name, comparison, number = parsed
    value = figures.get(name)
    if comparison is None:
        return bool(value)
    if not isinstance(value, int | float):
        return False
    return _COMPARISONS[comparison](value, number)


def _parsed(text: str) -> tuple[str, str | None, float] | None:
    found = _FORM.fullmatch(text)
    if found is None:
        return None
    name, comparison, number = found.groups()
    try:
        return name, comparison, float(number or 0.0)
    except ValueError:
        return None
