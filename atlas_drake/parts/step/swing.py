"""SWING: one foot is lifted, moved and lowered, and the body stands over the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.phases import TIME_STEP, with_foot
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.parts.step.phase import Decision, Reach, Stepping
from atlas_drake.parts.step.tools import StepTick


@dataclass(frozen=True, kw_only=True)
class Swing(Stepping):
    """One foot is in the air, and the body is at rest over the other foot."""

    lowers: bool = False  # True from the moment at which the foot comes down
    went_back: bool = False  # The foot found no ground and returns to where it was

    def decide(self, tick: StepTick) -> Decision:
        """When has the foot landed?

        When it carries a little, while it comes down. A foot that finds no ground goes
        back to where it was.
        """
        if not self.lowers:
            above = self.path.is_lowering(self.elapsed)
            return Decision.LOWER if above else Decision.STAY
        least = tick.rules.touchdown_force * tick.tools.balance.weight
        if tick.observation.foot_force[self.step.foot] > least:
            return Decision.LAND
        missed = self.path.has_missed(self.elapsed)
        return Decision.GO_BACK if missed else Decision.STAY

    def command_feet(self, tick: StepTick) -> tuple[FootCommand, FootCommand]:
        """Keeps the stance foot planted and moves the other foot along its path."""
        foot, reference = self.step.foot, self.path.evaluate(self.elapsed)
        command = tick.tools.balance.swinging(tick.observation, foot, reference)
        return self.with_stance(tick, foot, command)

    def reach(self, tick: StepTick) -> Reach:
        """Returns the stance foot and the foothold, lower if no ground was found."""
        feet = with_foot(self.feet, self.step.foot, self.foothold())
        height = tick.height_over(self.feet[self.stance], self.step)
        return Reach(height, feet, list(enumerate(feet)))

    def foothold(self) -> FootPose:
        """Computes the landing pose, lower if the foot has found no ground yet."""
        goal = self.step.pose
        z = float(self.path.evaluate(self.elapsed).p_WF[2])
        if z >= goal.p_WF[2]:
            return goal
        return FootPose(np.array([goal.p_WF[0], goal.p_WF[1], z]), goal.R_WF)

    @property
    def carrying(self) -> tuple[FootPose, ...]:
        """Pose of the stance foot."""
        return (self.feet[self.stance],)

    @property
    def in_air(self) -> Footstep:
        """The step being taken."""
        return self.step

    def are_both_flat(self, tick: StepTick) -> bool:
        """Returns False: one foot is in the air."""
        return False

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry again [s]."""
        return max(self.path.duration - self.elapsed, 0.0) + settle

    def paths(self, omega: float) -> PlannedPaths:
        """Returns the path of the swing foot."""
        path = self.path
        count = max(int(path.duration / TIME_STEP), 2)
        times = np.linspace(0.0, path.duration, count)
        return PlannedPaths(swing=np.array([path.evaluate(t).p_WF for t in times]))
