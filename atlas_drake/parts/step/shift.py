"""SHIFT: both feet are down; the weight moves over the stance foot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.control.feet.curves import quintic_progress
from atlas_drake.control.feet.sole_motion import Pitch, at_rest, pitched_pose
from atlas_drake.parts.step.phase import Decision, Reach, Stepping
from atlas_drake.parts.step.tools import StepTick
from atlas_drake.support_polygon import SupportPolygon


@dataclass(frozen=True, kw_only=True)
class Shift(Stepping):
    """The weight shifts over the stance foot, and the other foot is unloaded."""

    heel: float  # Angle by which the leaving foot's heel has risen at lift-off [rad]
    touchdown_foot: int | None  # Foot that just landed, if any

    def decide(self, tick: StepTick) -> Decision:
        """When does the foot lift off?

        When it is unloaded, and the DCM is at the end of its shift. If that comes too
        late, or the DCM leaves the support, a disturbance acts on the robot.
        """
        rules, duration = tick.rules, self.shift.duration
        if self.elapsed >= duration and self._is_ready(tick):
            return Decision.LIFT_OFF
        inside = -self.region(tick).distance_outside(tick.dcm(self.feet))
        if self.elapsed > duration + rules.longest_wait or inside < rules.dcm_lost:
            return Decision.GIVE_UP
        return Decision.STAY

    def command_feet(self, tick: StepTick) -> tuple[FootCommand, FootCommand]:
        """Unloads the leaving foot and raises its heel, after pressing a new foot."""
        balance, observation = tick.tools.balance, tick.observation
        foot, heel = self.step.foot, self.heel_motion(tick)
        on_toes = heel.angle > 0.0
        if self.touchdown_foot is not None and self.is_early(tick):
            return self.touchdown(self.touchdown_foot, tick, on_toes)
        left = 1.0 - self.elapsed / self.shift.duration
        load = max(left / tick.rules.unload_share, 0.01)
        load = max(load, self.load_range(foot, tick, on_toes)[0])
        if not on_toes:
            return self.with_stance(
                tick, foot, balance.in_contact(observation, foot, load)
            )
        raised = at_rest(self.feet[foot]).pitched(heel, tick.half_length)
        command = balance.toeing_off(observation, foot, raised, load)
        return self.with_stance(tick, foot, command)

    def reach(self, tick: StepTick) -> Reach:
        """Returns the feet, the leaving one on its toes, and the next foothold.

        The body is low enough for the landing, so that it moves up or down only once.
        """
        step, now = self.step, list(self.feet)
        later = list(enumerate(now))
        flat, angle = now[step.foot], self.heel_motion(tick).angle
        now[step.foot] = pitched_pose(flat, angle, tick.half_length)
        raised = pitched_pose(flat, self.heel, tick.half_length)
        later[step.foot] = (step.foot, raised)
        later.append((step.foot, step.pose))
        return Reach(tick.height_over(self.feet[self.stance], step), now, later)

    def region(self, tick: StepTick) -> SupportPolygon:
        """Returns the present region of the CoP; a raised heel carries no load."""
        if self.heel_motion(tick).angle == 0.0:
            return self.support
        return tick.tools.balance.support_on_toes(
            self.feet[self.stance], self.feet[self.step.foot]
        )

    def are_both_flat(self, tick: StepTick) -> bool:
        """Returns True if the heel is down."""
        return self.heel_motion(tick).angle <= 0.0

    def heel_motion(self, tick: StepTick) -> Pitch:
        """Evaluates the pitch of the leaving foot about its toes."""
        if self.heel == 0.0:
            return Pitch()
        begins = tick.rules.heel_begins * self.shift.duration
        takes = self.shift.duration - begins
        share = min(max((self.elapsed - begins) / takes, 0.0), 1.0)
        s, ds, dds = quintic_progress(share)
        return Pitch(self.heel * s, self.heel * ds / takes, self.heel * dds / takes**2)

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry again [s]."""
        left = max(self.shift.duration - self.elapsed, 0.0)
        return left + self.path.duration + settle

    def _is_ready(self, tick: StepTick) -> bool:
        """Returns True if the foot is unloaded, and the DCM at the end of its shift."""
        load = tick.observation.foot_force[self.step.foot]
        if load > tick.rules.still_loaded * tick.tools.balance.weight:
            return False
        error = tick.dcm((self.feet[self.stance],)) - self.shift.end
        return float(np.hypot(*error)) < tick.rules.dcm_ready
