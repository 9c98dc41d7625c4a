"""Bounds of a configuration's numbers, declared beside the numbers.

Declarations only; ``kinds`` checks them.
"""

import math
from dataclasses import dataclass
from typing import Annotated


@dataclass(frozen=True)
class Bounds:
    """Range of a number, for ``Annotated[float, Bounds(...)]``.

    Bounds of a dataclass apply to all of its numbers without bounds of their own.
    """

    least: float = -math.inf
    most: float = math.inf
    strict: bool = False
    """True if the ends themselves are excluded."""

    def allow(self, number: float) -> bool:
        """Returns True if ``number`` lies within the bounds; False for NaN."""
        if self.strict:
            return self.least < number < self.most
        return self.least <= number <= self.most and math.isfinite(number)

    def __str__(self) -> str:
        """Completes the sentence "must be ..."."""
        if self == FINITE:
            return "a finite number"
        if self.most == math.inf:
            return f"above {self.least:g}" if self.strict else f"{self.least:g} or more"
        if self.strict:
            return f"above {self.least:g} and below {self.most:g}"
        return f"from {self.least:g} to {self.most:g}"


FINITE = Bounds()
NOT_NEGATIVE = Bounds(least=0.0)

Positive = Annotated[float, Bounds(least=0.0, strict=True)]
"""A number above 0, such as a divisor."""
Share = Annotated[float, Bounds(least=0.0, most=1.0)]
"""A share of a whole [-]."""
ProperShare = Annotated[float, Bounds(least=0.0, most=1.0, strict=True)]
"""A share of a whole, neither 0 nor 1 [-]."""
Signed = Annotated[float, FINITE]
"""A number that may be negative."""
