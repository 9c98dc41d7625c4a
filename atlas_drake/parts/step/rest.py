"""REST: both feet are down, the weight between them, until a step is requested."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.messages.footstep import Footstep
from atlas_drake.parts.step.phase import Decision, Reach, StepPhase
from atlas_drake.parts.step.tools import StepTick


@dataclass(frozen=True, kw_only=True)
class Rest(StepPhase):
    """Both feet are down; the weight shifts to between them and stays there."""

    last: Footstep | None = None  # The last step; None before the first step
    touchdown_foot: int | None = None  # Foot that just landed, if any
    gave_up: bool = False  # True if the last weight shift was abandoned

    def decide(self, tick: StepTick) -> Decision:
        """When does the next step begin?

        When it is requested, and the DCM is not too near the edge of the support; after
        an abandoned step, once the weight is back between the feet.
        """
        if self.gave_up and self.elapsed < self.shift.duration:
            return Decision.STAY
        if tick.leaving or self.requested(tick) is None:
            return Decision.STAY
        inside = -self.support.distance_outside(tick.dcm(self.feet))
        ready = inside >= tick.rules.begin_inside
        return Decision.BEGIN if ready else Decision.STAY

    def command_feet(self, tick: StepTick) -> tuple[FootCommand, FootCommand]:
        """Keeps both feet planted; a foot that just landed is pressed flat."""
        if self.touchdown_foot is None or not self.is_early(tick):
            return tick.tools.balance.standing(tick.observation, self.feet)
        return self.touchdown(self.touchdown_foot, tick)

    def reach(self, tick: StepTick) -> Reach:
        """Returns both feet, with the body half-way between them."""
        left, right = self.feet
        ground = 0.5 * float(left.p_WF[2] + right.p_WF[2])
        height = ground + tick.tools.nominal_height
        return Reach(height, self.feet, list(enumerate(self.feet)))

    @property
    def reported(self) -> Footstep | None:
        """The last step, if any."""
        return self.last
