"""How STEP keeps its balance: references of body, feet and center of mass in a phase.

From the memory of ``step`` to the QP's command. Phases and steps are not decided here.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import FULL_LOAD, Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.body_reference import BodyReference, BodyTarget
from atlas_drake.behaviors.step.memory import StepMemory, StepPhase, StepRules
from atlas_drake.behaviors.step.plan import StepPlanner
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.load_share import load_share_range
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.feet.leg_reach import highest_com
from atlas_drake.control.feet.swing_foot import quintic_progress
from atlas_drake.control.feet.toe_off import on_toes, toe_off_reference
from atlas_drake.control.rotations import mean_yaw
from atlas_drake.control.whole_body.command import WholeBodyCommand


class StepBalance:
    """Balance in the phases of STEP. Holds constants only."""

    def __init__(
        self,
        balance: Balance,
        nominal_height: float,
        planner: StepPlanner,
        rules: StepRules,
    ):
        """Stands with the center of mass ``nominal_height`` [m] above the soles."""
        self._balance = balance
        self._nominal_height = nominal_height
        self._planner = planner
        self._rules = rules

    def command(
        self, memory: StepMemory, seen: Observation, body: BodyReference
    ) -> WholeBodyCommand:
        """The QP's command of one tick."""
        omega = self.omega(seen, self._carrying(memory))
        reference, support = memory.dcm_reference(omega), self.support(memory)
        cop = self._balance.wanted_cop(seen, reference, omega, support)
        return self._balance.command(
            seen,
            body,
            reference,
            omega,
            support,
            self._foot_commands(memory, seen, cop),
        )

    def _carrying(self, memory: StepMemory) -> tuple[FootPose, ...]:
        """The feet that are on the ground."""
        return (memory.feet[memory.stance],) if memory.in_air else memory.feet

    def omega(self, seen: Observation, feet: tuple[FootPose, ...]) -> float:
        """Natural frequency of the pendulum on ``feet`` [1/s]."""
        ground = sum(float(foot.p_WF[2]) for foot in feet) / len(feet)
        return feedback.pendulum_frequency(float(seen.terms.com[2]) - ground)

    def body_target(self, memory: StepMemory) -> BodyTarget:
        """Where trunk and posture go: as high as asked for, and as the legs reach."""
        feet = list(memory.feet)
        later = list(enumerate(feet))
        if memory.phase is StepPhase.REST:
            ground = 0.5 * float(feet[0].p_WF[2] + feet[1].p_WF[2])
            height = self._nominal_height
        else:
            ground = float(feet[memory.stance].p_WF[2])
            height = self._planner.height(memory.how)
            foot = memory.step.foot
            if memory.in_air:
                feet[foot] = self._foothold(memory)
                later = list(enumerate(feet))
            elif memory.phase is StepPhase.SWAY:
                # Low enough for the landing, so that the body goes up or down once.
                flat, half_length = feet[foot], self._planner.half_length
                feet[foot] = on_toes(flat, self.heel(memory)[0], half_length)
                later[foot] = (foot, on_toes(flat, memory.heel, half_length))
                later.append((foot, memory.step.pose))
        com = memory.sway.motion(memory.sway_time)[0]
        reach = min(
            highest_com(self._planner.legs, memory.hips, com, enumerate(feet)),
            highest_com(self._planner.legs, memory.hips, memory.sway.end, later),
        )
        return BodyTarget(
            height=min(ground + height, reach),
            yaw=mean_yaw(feet[0].yaw, feet[1].yaw),
            joints=self._balance.robot.stand_prep,
            pelvis_tilt=np.array([0.0, memory.lean]),
        )

    def support(self, memory: StepMemory) -> SupportPolygon:
        """Where the CoP may lie now."""
        if self.heel(memory)[0] == 0.0:
            return memory.support
        return self._balance.support_on_toes(
            memory.feet[memory.stance], memory.feet[memory.step.foot]
        )

    def heel(self, memory: StepMemory) -> tuple[float, float, float]:
        """Angle of the leaving foot's heel in the sway, with its derivatives."""
        if memory.phase is not StepPhase.SWAY or memory.heel == 0.0:
            return 0.0, 0.0, 0.0
        begins = self._rules.heel_begins * memory.sway.duration
        takes = memory.sway.duration - begins
        share = min(max((memory.elapsed - begins) / takes, 0.0), 1.0)
        s, ds, dds = quintic_progress(share)
        return memory.heel * s, memory.heel * ds / takes, memory.heel * dds / takes**2

    def is_fresh(self, memory: StepMemory) -> bool:
        """Whether the weight has hardly begun to move after a landing."""
        on_ground = memory.phase in (StepPhase.REST, StepPhase.SWAY)
        share = memory.sway_time / memory.sway.duration
        return on_ground and share < self._rules.fresh_share

    def _foothold(self, memory: StepMemory) -> FootPose:
        """Where the foot in the air lands: deeper when it finds no ground."""
        goal = memory.step.pose
        z = float(memory.planned_swing.evaluate(memory.elapsed).p_WF[2])
        if z >= goal.p_WF[2]:
            return goal
        return FootPose(np.array([goal.p_WF[0], goal.p_WF[1], z]), goal.R_WF)

    def _load_range(
        self, memory: StepMemory, foot: int, cop: np.ndarray
    ) -> tuple[float, float]:
        """What ``foot`` can carry with the CoP where balance wants it, in weights."""
        balance, other = self._balance, memory.feet[foot]
        on_toes = self.heel(memory)[0] > 0.0
        return load_share_range(
            cop,
            balance.support(memory.feet[1 - foot]),
            balance.toes(other) if on_toes else balance.support(other),
        )

    def _foot_commands(
        self, memory: StepMemory, seen: Observation, cop: np.ndarray
    ) -> tuple[FootCommand, FootCommand]:
        """Commands both feet; balance goes before the load that a phase asks for.

        A foot that has to carry too much or too little would keep the CoP away from
        where balance wants it.
        """
        balance = self._balance
        feet = [balance.planted(seen, 0), balance.planted(seen, 1)]
        pressed = memory.fresh if self.is_fresh(memory) else None
        if memory.phase is StepPhase.SETTLE:
            pressed = memory.step.foot
        if pressed is not None:
            most = self._load_range(memory, pressed, cop)[1]
            load = min(self._rules.settling_load, most)
            feet[pressed] = balance.pressed(seen, pressed, load)
        elif memory.in_air:
            reference = memory.planned_swing.evaluate(memory.elapsed)
            foot = memory.step.foot
            feet[foot] = balance.swinging(seen, foot, reference)
        elif memory.phase is StepPhase.SWAY:
            foot = memory.step.foot
            rest = 1.0 - memory.elapsed / memory.sway.duration
            load = min(max(rest / self._rules.unload_share, 0.01), FULL_LOAD)
            load = max(load, self._load_range(memory, foot, cop)[0])
            angle, rate, acceleration = self.heel(memory)
            if angle > 0.0:
                reference = toe_off_reference(
                    memory.feet[foot],
                    angle,
                    rate,
                    acceleration,
                    self._planner.half_length,
                )
                feet[foot] = balance.toeing_off(seen, foot, reference, load)
            else:
                feet[foot] = balance.planted(seen, foot, load)
        return feet[0], feet[1]
