"""SETTLE: the new foot is pressed flat, before the weight moves."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.parts.step.phase import Decision, Reach, Stepping
from atlas_drake.parts.step.tools import StepTick


@dataclass(frozen=True, kw_only=True)
class Settle(Stepping):
    """Both feet are down; the new foot is pressed flat."""

    went_back: bool  # True if the foot returned to its lift-off pose

    def decide(self, tick: StepTick) -> Decision:
        """Is the step done?  It is after the time that pressing the foot takes."""
        done = self.elapsed >= tick.rules.settle
        return Decision.REST if done else Decision.STAY

    def command_feet(self, tick: StepTick) -> tuple[FootCommand, FootCommand]:
        """Keeps the stance foot planted and presses the new foot flat."""
        return self.touchdown(self.step.foot, tick)

    def reach(self, tick: StepTick) -> Reach:
        """Returns both feet, with the body over the stance foot."""
        height = tick.height_over(self.feet[self.stance], self.step)
        return Reach(height, self.feet, list(enumerate(self.feet)))

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry again [s]."""
        return max(settle - self.elapsed, 0.0)
