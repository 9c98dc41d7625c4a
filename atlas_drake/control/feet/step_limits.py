"""Limits of one step, and the tolerance by which a step may exceed them.

Data only; ``footstep`` saturates steps by the limits.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Any, Self

from annotated_types import Unit
from pydantic import BeforeValidator

from atlas_drake.config import (
    Configuration,
    LeastGreatest,
    NotNegative,
    Positive,
    Range,
    is_number,
)
from atlas_drake.errors import ScenarioError
from atlas_drake.frozen import replace
from atlas_drake.units import Meters, Radians, Seconds

LONGEST = 3.0
"""Longest duration of a step where only the shortest is given [s]. A setting may
give both."""


def _shortest(value: Any) -> Any:
    return [value, max(value, LONGEST)] if is_number(value) else value


@dataclass(frozen=True, kw_only=True)
class StepLimits(Configuration):
    """Limits of one step relative to the stance foot.

    Lateral distances and turns are positive away from the stance foot: a left foot
        turns its toes to the left.
    """

    forward: NotNegative[Meters] = 0.42
    """Longest step ahead."""
    backward: NotNegative[Meters] = 0.32
    """Longest step back."""
    width: Annotated[Range, Unit("m")] = LeastGreatest(0.18, 0.50)
    """Lateral distance between the feet, center to center."""
    passing: NotNegative[Meters] = 0.167
    """Lateral distance at which a foot passes the other leg without touching it."""
    reach: Positive[Meters] = 0.70
    """Longest distance between the feet; a wide step leads less far ahead."""
    rise: NotNegative[Meters] = 0.10
    """Largest step up or down."""
    easy_rise: NotNegative[Meters] = 0.10
    """Largest step up or down that may take the shortest duration."""
    rise_duration: Positive[Seconds] = 1.1
    """Shortest duration of the largest step up or down: a knee that has less time to
    raise the body would need more than its torque. It grows from that of
    ``easy_rise``."""
    level: NotNegative[Meters] = 0.02
    """Largest step up or down that stays on its level."""
    astray: NotNegative[Meters] = 0.02
    """Largest distance of a step to another level from its commanded place."""
    meant_rise: NotNegative[Meters] = 0.40
    """Heights farther than this from the stance foot are treated as not given: on level
    ground a step may have the height of the pelvis."""
    tilt: NotNegative[Radians] = 0.30
    """Steepest slope of the ground at a foothold."""
    toe_out: NotNegative[Radians] = 0.5
    """Largest turn outward."""
    toe_in: NotNegative[Radians] = 0.25
    """Largest turn inward."""
    duration: Annotated[
        Range,
        Unit("s"),
        BeforeValidator(_shortest, json_schema_input_type=Range | float),
    ] = LeastGreatest(0.60, 3.0)
    """Duration of a step from and to a place near the other foot; one number is the
    shortest."""
    near: NotNegative[Meters] = 0.40
    """Distance of the feet up to which a step may take the longest duration."""
    far: NotNegative[Meters] = 0.60
    """Distance of the feet from which a step takes ``far_duration`` at most."""
    far_duration: Positive[Seconds] = 1.0
    """Longest duration of a step with the feet far apart: in a slower step the center
    of mass would have to be over the stance foot while the other leg cannot reach."""
    swing_height: Annotated[Range, Unit("m")] = LeastGreatest(0.03, 0.30)
    """Apex of a swing above the middle of its ends."""

    def extended(self, outward: float, inward: float = 0.0) -> Self:
        """Returns limits with the feet farther apart or nearer to each other [m]."""
        narrowest, widest = self.width
        return replace(
            self,
            forward=self.forward + outward,
            backward=self.backward + outward,
            width=LeastGreatest(narrowest - inward, widest + outward),
            reach=self.reach + outward,
        )

    def longest_ahead(self, aside: float) -> float:
        """Computes how far ahead a step may lead at a lateral distance [m]."""
        return math.sqrt(max(self.reach**2 - aside**2, 0.0))

    def check(self) -> None:
        """Checks that the limits leave a range."""
        for name, least in (("width", 0.0), ("duration", 1e-3), ("swing_height", 0.0)):
            given = getattr(self, name)
            if given.least < least:
                raise ScenarioError.about(
                    name, list(given), f"must be {least:g} or more"
                )
        shortest, longest = self.duration
        if not shortest <= self.far_duration <= longest:
            desired = f"must be within duration ({shortest:g} to {longest:g})"
            raise ScenarioError.about("far_duration", self.far_duration, desired)
        if self.far <= self.near:
            raise ScenarioError.about(
                "far", self.far, f"must be more than near ({self.near:g})"
            )


def quasi_static_limits() -> StepLimits:
    """Returns the default limits of STEP; slow steps may be larger than a walk's."""
    return StepLimits(
        forward=0.42,
        backward=0.36,
        width=LeastGreatest(0.18, 0.45),
        rise=0.20,
        tilt=0.25,
        duration=LeastGreatest(0.1, 20.0),
        swing_height=LeastGreatest(0.0, 0.60),
    )


@dataclass(frozen=True)
class StepSlack(Configuration):
    """Tolerance beyond the limits of a step, to make up for landing errors.

    Limits are relative to the actual or the commanded place of the stance foot. Without
    the tolerance a foot that landed a little short would shorten every later step.
    """

    distance: NotNegative[Meters] = 0.02
    """Tolerance of the horizontal distance."""
    turn: NotNegative[Radians] = 0.05
    """Tolerance of the heading."""
    rise: NotNegative[Meters] = 0.01
    """Tolerance of the height, for ground that differs from the step's height."""

    def loosen(self, limits: StepLimits) -> StepLimits:
        """Returns the limits of a step from the actual place of the stance foot."""
        return replace(
            limits.extended(self.distance, self.distance),
            rise=limits.rise + self.rise,
            toe_out=limits.toe_out + self.turn,
            toe_in=limits.toe_in + self.turn,
        )
