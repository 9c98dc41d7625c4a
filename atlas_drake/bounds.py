"""Bounds of a configuration's numbers, declared beside the numbers.

Declarations only; ``kinds`` checks them.
"""

import math
from dataclasses import dataclass
from typing import Annotated


@dataclass(frozen=True)
class Bounds:
    """Range of a number, for ``Annotated[float, Bounds(...)]``.

    Bounds of a dataclass hold for all numbers in it that have none of their own.
    """

    least: float = -math.inf
    most: float = math.inf
    strict: bool = False
    """True if the ends themselves are excluded."""

    def allow(self, number: float) -> bool:
        """Tell whether ``number`` lies within the bounds; NaN never does."""
        if self.strict:
            return self.least < number < self.most
        return self.least <= number <= self.most and math.isfinite(number)

    def __str__(self) -> str:
        """Complete the sentence "must be ..."."""
        if self == FINITE:
            return "a finite number"
        if self.most == math.inf:
            return f"above {self.least:g}" if self.strict else f"{self.least:g} or more"
        if self.strict:
            return f"between {self.least:g} and {self.most:g}, and neither of them"
        return f"from {self.least:g} to {self.most:g}"


FINITE = Bounds()
NOT_NEGATIVE = Bounds(least=0.0)

Positive = Annotated[float, Bounds(least=0.0, strict=True)]
"""A number above 0, such as a divisor."""
Share = Annotated[float, Bounds(least=0.0, most=1.0)]
"""A share of a whole [-]."""
ProperShare = Annotated[float, Bounds(least=0.0, most=1.0, strict=True)]
"""A share of a whole that leaves something of both parts [-]."""
Signed = Annotated[float, FINITE]
"""A number that may be negative."""
