"""SWING: one foot is in the air, and balance may move its landing place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.phases import TIME_STEP, on_present_parts, with_foot
from atlas_drake.behaviors.walk.phase import Decision, WalkPhase, WalkTick
from atlas_drake.control.feet import swing_foot
from atlas_drake.control.feet.sole_motion import pitch_from
from atlas_drake.frozen import replace
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.footstep import LEFT, FootPose, Footstep


@dataclass(frozen=True, kw_only=True)
class Swing(WalkPhase):
    """One foot swings to its landing place, and the other foot carries the robot."""

    sent: Footstep  # The step being taken, as commanded
    planned_step: Footstep  # The same, as the plan began with it
    motion: swing_foot.FootSwing  # Reference of the swing foot
    sensitivity: float  # ∂(DCM planned for touchdown)/∂(landing place) [-]
    stops: bool  # True if the plan comes to rest: no step was known after this step

    @property
    def step(self) -> Footstep:
        """The step being taken; balance may move its landing place."""
        step = self.progress.in_air
        assert step is not None
        return step

    @property
    def stance(self) -> FootPose:
        """Pose of the foot on the ground."""
        return self.progress.feet[1 - self.step.foot]

    @property
    def accepted_sensitivity(self) -> float:
        """∂(DCM accepted at touchdown)/∂(landing place) [-].

        After the last step the plan moves the CoP slowly to the middle of the feet; to
        save the balance it may be below the landed foot at once, and the DCM with it.
        """
        return 1.0 if self.stops else self.sensitivity

    @property
    def beyond_plan(self) -> np.ndarray:
        """DCM accepted at touchdown, from the planned one in W [m], shape (2,)."""
        moved = self.step.p_WF - self.planned_step.p_WF
        return (self.accepted_sensitivity - self.sensitivity) * moved[:2]

    def decide(self, tick: WalkTick) -> Decision:
        """When has the foot landed?

        As soon as it is loaded, or the ground turns it. A contact early in the swing is
        a stumble. In the last part the ground is expected, and a small force counts.
        """
        rules, weight = tick.config.rules, tick.balance.weight
        if self.motion.progress < rules.earliest_touchdown:
            return Decision.STAY
        least = rules.touchdown_force
        if self.duration - self.elapsed < rules.frozen_end:
            least = min(least, rules.landing_force)
        loaded = tick.observation.foot_force[self.step.foot] > least * weight
        by_ground = loaded and self._is_pushed_up(tick)
        landed = by_ground or self._is_turned_by_ground(tick)
        return Decision.LAND if landed else Decision.STAY

    def command_feet(
        self, tick: WalkTick
    ) -> tuple[Swing, tuple[FootCommand, FootCommand]]:
        """Advances the swing foot; the other foot stays planted."""
        balance, observation, foot = tick.balance, tick.observation, self.step.foot
        motion, reference = swing_foot.advance_swing(
            self.motion, self.step, tick.config.swing, tick.dt
        )
        stance = balance.in_contact(observation, 1 - foot, planted=self.stance)
        swing = balance.swinging(observation, foot, reference)
        feet = (swing, stance) if foot == LEFT else (stance, swing)
        return replace(self, motion=motion), feet

    def on_what_carries(self, tick: WalkTick) -> Swing:
        """Returns the phase on the part of the stance sole that carries now."""
        foot, feet = 1 - self.step.foot, self.progress.feet
        stance = on_present_parts(feet, tick.observation)[foot]
        if stance is feet[foot]:
            return self
        progress = replace(self.progress, feet=with_foot(feet, foot, stance))
        return replace(self, progress=progress, support=tick.balance.support(stance))

    def _is_pushed_up(self, tick: WalkTick) -> bool:
        """Returns True if the force on the foot is that of the ground on its sole.

        The ground pushes up; the other leg, or a hand, pushes aside. On a foot that a
        push has turned it meets an edge.
        """
        foot = self.step.foot
        upright = float(self.step.normal @ tick.observation.terms.feet[foot].R_WF[:, 2])
        if upright < tick.config.rules.landing_upright:
            return False
        x, y, z = tick.observation.foot_wrenches()[6 * foot + 3 : 6 * foot + 6].tolist()
        return bool(z > math.hypot(x, y))

    def _is_turned_by_ground(self, tick: WalkTick) -> bool:
        """Returns True if the ground turns a sole that lands on its toes.

        The ankle yields to forces that are too small to count as touchdown.
        """
        motion, rules = self.motion, tick.config.rules
        if motion.landing_pitch <= 0.0 or motion.remaining > rules.frozen_end:
            return False
        pose = tick.observation.foot_pose(self.step.foot)
        lowest = float(pose.p_WF[2]) - tick.half_length * abs(float(pose.R_WF[2, 0]))
        if lowest > float(self.step.p_WF[2]) + rules.ground_near:
            return False
        turned = motion.pitch.angle - pitch_from(pose, self.step.normal)
        return turned > rules.landing_turn

    # ---- references ----------------------------------------------------------

    @property
    def lower_pitch(self) -> float:
        """Pitch with which a foot lands on its toes [rad]."""
        return max(self.motion.landing_pitch, 0.0)

    def may_sink(self, profile: swing_foot.SwingProfile) -> bool:
        """Returns True in the part of the swing in which a foot steps down."""
        return self.motion.progress >= 1.0 - profile.climb_share

    def paths(self, com: np.ndarray, profile: swing_foot.SwingProfile) -> PlannedPaths:
        """Adds the path of the swing sole from lift-off to touchdown."""
        swing = swing_foot.begin_swing(
            self.motion.start, self.motion.duration, around=self.motion.around
        )
        points = [swing.start.p_WF]
        while swing.remaining > 0.0:
            step = min(TIME_STEP, max(swing.remaining, 1e-6))
            swing, reference = swing_foot.advance_swing(swing, self.step, profile, step)
            points.append(reference.p_WF)
        return replace(super().paths(com, profile), swing=np.array(points))
