"""A walking robot in one file: footsteps, DCM plan, whole-body QP, torque.

    python examples/walker.py
    python examples/walker.py --headless --step-time 0.7 --push 15

Read it from top to bottom. Every control tick, 9 ms, runs through four stages:

    1. footsteps   where the feet go                             ``tutorial_steps``
    2. DCM plan    how the CoM follows the feet                  ``plan_dcm``
    3. tasks       what each part of the body does now           ``Walker.tasks``
    4. QP          which torques do all of this, within limits   ``Walker.tick``

Frames and symbols, in SI units; W is the world, z up, and F a sole:

    p_WF, R_WF     position and orientation of the sole in W
    V_WF, J_WF     its spatial velocity [ω; v] in W, and the Jacobian: V_WF = J_WF v
    c, ċ           position and velocity of the center of mass (CoM)
    ω = √(g / z)   natural frequency of a pendulum with its mass at the height z
    ξ = c + ċ / ω  divergent component of motion (DCM)
    p              center of pressure below the feet (CoP)
"""

import argparse
import signal
import sys
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import LeafSystem

from atlas_drake import AtlasSimulation, ControllerStatus, Footstep, Plan
from atlas_drake.control.balance.dcm_plan import CopSegment, DcmPlan
from atlas_drake.control.balance.feedback import dcm, pendulum_frequency
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.footstep import outward
from atlas_drake.control.feet.sole import sole_corners, sole_patches
from atlas_drake.control.feet.swing_foot import (
    FootSwing,
    SwingProfile,
    advance_swing,
    begin_swing,
)
from atlas_drake.control.gains import ControlGains
from atlas_drake.control.whole_body import (
    ComTask,
    Contact,
    EffortBounds,
    FrameTask,
    InternalContactTask,
    MomentTask,
    OrientationTask,
    PositionTask,
    PostureTask,
    WholeBodyCommand,
    WholeBodyModel,
    WholeBodyQp,
)
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.frozen import Frozen
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import mean_yaw, rotation_z

STRIDE, HALF_WIDTH = 0.25, 0.15  # of the steps, ahead and to the side [m]
STEP_TIME, SWING_HEIGHT = 0.63, 0.3  # [s], [m]
TRANSFER = 0.25  # share of the step time with both feet on the ground [-]
FIRST_SHIFT, SETTLE = 1.0, 0.8  # before the first and after the last step [s]
TOUCHDOWN = 0.03  # load that counts as touchdown, in weights of the robot [-]
COM_DROP = 0.02  # below the stand-prep pose: bent knees have reach [m]
GAINS, PROFILE = ControlGains(), SwingProfile()  # each with its reason there


# ---- 1. Footsteps ------------------------------------------------------------


def tutorial_steps(feet, step_time):
    """Left, right, left, right: two strides ahead, and the feet side by side."""
    yaw = mean_yaw(feet[0].yaw, feet[1].yaw)
    p_WM = 0.5 * (feet[0].p_WF + feet[1].p_WF)  # M: the middle between the soles
    steps = []
    for number in range(4):
        foot = number % 2  # 0 left, 1 right
        p_MF = [(1 + number // 2) * STRIDE, outward(foot) * HALF_WIDTH, 0.0]
        p_WF = p_WM + rotation_z(yaw) @ p_MF
        steps.append(Footstep(number + 1, foot, p_WF, yaw, step_time, SWING_HEIGHT))
    return tuple(steps)


# ---- 2. DCM plan -------------------------------------------------------------


def plan_dcm(cop, shift, feet, steps, swing_time, omega):
    """Plan the CoP through all coming steps, and the DCM that goes with it.

    A pendulum on the CoP p accelerates away from it, c̈ = ω² (c - p). In terms of the
    DCM these are two equations of first order:

        ċ = ω (ξ - c)    stable: the CoM follows the DCM
        ξ̇ = ω (ξ - p)    unstable: the DCM runs away from the CoP

    The CoP moves to each stance foot in turn and rests there during the swing. The DCM
    is solved backward in time from the end, where it rests over the CoP: backward the
    unstable equation is stable.
    """
    feet, segments = list(feet), []
    for step in steps:
        stance = feet[1 - step.foot].p_WF[:2]
        if shift > 0.0:
            segments.append(CopSegment(shift, cop, stance))
        segments.append(CopSegment(swing_time, stance, stance))
        cop, feet[step.foot] = stance, step.pose
        shift = TRANSFER * step.duration
    middle = 0.5 * (feet[0].p_WF + feet[1].p_WF)[:2]
    segments.append(CopSegment(SETTLE, cop, middle))
    return DcmPlan(segments, omega)


@dataclass(frozen=True)
class Phase(Frozen):
    """One foot is in the air, or both are on the ground: the walker's whole memory."""

    feet: tuple[FootPose, FootPose] = ()  # on the ground, as last measured
    steps: tuple[Footstep, ...] = ()  # to take, the one in the air first
    plan: DcmPlan | None = None  # from the beginning of the phase on
    swing: FootSwing | None = None  # motion of the foot in the air
    elapsed: float = 0.0  # [s]

    @property
    def is_over(self):
        """True at the end of the plan's first segment."""
        return self.elapsed >= self.plan.segments[0].duration


class Walker(LeafSystem):
    """The controller: state of the robot in, joint torques out."""

    def __init__(self, robot, scenario, step_time=STEP_TIME):
        super().__init__()
        n, limit = robot.num_joints, robot.effort_limit
        self.robot, self.dt, self.step_time = robot, scenario.control_period, step_time
        self.weight = robot.mass * GRAVITY
        self.height = robot.com_height - COM_DROP
        self.omega = pendulum_frequency(self.height)
        self.soles = [foot.sole_frame for foot in robot.file.feet]
        self.patches = sole_patches(robot.file.sole, GAINS.contact)
        self.model = WholeBodyModel(robot)
        self.scratch = self.model.create_context()
        self.qp = WholeBodyQp(robot, GAINS)
        self.bounds = EffortBounds(-limit, limit, np.zeros(n, dtype=bool))
        # The simulation connects these by their names.
        self.state = self.DeclareVectorInputPort("state", self.model.num_states)
        self.loads = self.DeclareVectorInputPort("foot_loads", 2)
        self.phase = self.DeclareAbstractState(AbstractValue.Make(Phase()))
        self.effort = self.DeclareDiscreteState(n)
        self.DeclareStateOutputPort("behavior_effort", self.effort)
        self.DeclareAbstractOutputPort(
            "controller_status",
            lambda: AbstractValue.Make(ControllerStatus()),
            self.report,
            prerequisites_of_calc={self.xa_ticket()},
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(self.dt, 0.0, self.tick)

    # ---- 4. QP -> torque -----------------------------------------------------

    def tick(self, context, state):
        """Find the torques for this tick.

            min   Σ ½ ‖A v̇ + b + G λ - target‖²_weight        tasks
            s.t.  M v̇ + h = Sᵀ τ + Jᵀ λ                        dynamics
                  C λ ≤ 0                                       friction, CoP in the sole
                  τ_min ≤ τ ≤ τ_max,  q̈_min ≤ q̈ ≤ q̈_max        motors, joint limits

        over v̇ ∈ R^{6 + n}, the contact wrenches λ ∈ R^{6 c} and the torques τ ∈ R^n.
        """
        terms = self.model.evaluate(self.scratch, self.state.Eval(context))
        loads = self.loads.Eval(context)
        phase = context.get_abstract_state(self.phase).get_value()
        phase = self.advance(phase, terms, loads)
        phase, command = self.tasks(phase, terms, loads)
        solution = self.qp.solve(terms, command, self.bounds)
        state.get_mutable_abstract_state(self.phase).set_value(phase)
        state.get_mutable_discrete_state(self.effort).set_value(solution.effort)

    # ---- phases --------------------------------------------------------------

    def advance(self, phase, terms, loads):
        feet = tuple(FootPose(foot.p_WF, foot.R_WF) for foot in terms.feet)
        if phase.plan is None:
            cop = 0.5 * (feet[0].p_WF + feet[1].p_WF)[:2]
            steps = tutorial_steps(feet, self.step_time)
            return self.stand(feet, steps, cop, FIRST_SHIFT)
        cop = phase.plan.evaluate(phase.elapsed).cop
        if phase.swing is not None:
            late = phase.swing.progress > 0.75
            if late and loads[phase.steps[0].foot] > TOUCHDOWN * self.weight:
                shift = TRANSFER * self.step_time
                return self.stand(feet, phase.steps[1:], cop, shift)
        elif phase.steps and phase.is_over:
            return self.lift_off(feet, phase.steps)
        return replace(phase, elapsed=phase.elapsed + self.dt)

    @property
    def swing_time(self):
        return (1.0 - TRANSFER) * self.step_time

    def stand(self, feet, steps, cop, shift):
        plan = plan_dcm(cop, shift, feet, steps, self.swing_time, self.omega)
        return Phase(feet, steps, plan)

    def lift_off(self, feet, steps):
        foot = steps[0].foot
        cop = feet[1 - foot].p_WF[:2]
        plan = plan_dcm(cop, 0.0, feet, steps, self.swing_time, self.omega)
        return Phase(feet, steps, plan, begin_swing(feet[foot], self.swing_time))

    # ---- 3. Tasks ------------------------------------------------------------

    def tasks(self, phase, terms, loads):
        weights = GAINS.weights
        # Balance
        reference = phase.plan.evaluate(phase.elapsed)
        support = self.support(phase)
        error = dcm(terms, self.omega) - reference.dcm
        cop = support.clamp(reference.cop + (1.0 + GAINS.dcm_gain) * error)
        floor = min(foot.p_WF[2] for foot in phase.feet)
        gains = GAINS.com_height
        a = np.empty(3)
        a[:2] = self.omega**2 * (terms.com[:2] - cop)
        a[2] = gains.kp * (floor + self.height - terms.com[2])
        a[2] -= gains.kd * terms.com_velocity[2]
        p_WE = np.array([*cop, terms.com[2] - GRAVITY / self.omega**2])
        tasks = [
            ComTask(a, np.array([weights.com, weights.com, weights.com_height])),
            MomentTask(p_WE, np.full(2, weights.moment)),
        ]
        # Body
        R = rotation_z(mean_yaw(phase.feet[0].yaw, phase.feet[1].yaw))
        for frame, weight in (
            (self.robot.file.pelvis, weights.pelvis_orientation),
            (self.robot.file.chest, weights.chest_orientation),
        ):
            tasks.append(
                OrientationTask.tracking(terms, frame, R, GAINS.orientation, weight)
            )
        # Feet
        contacts = []
        in_air = phase.steps[0].foot if phase.swing else None
        for foot, sole in enumerate(self.soles):
            if foot == in_air:
                motion, r = advance_swing(phase.swing, phase.steps[0], PROFILE, self.dt)
                phase = replace(phase, swing=motion)
                tasks += [
                    PositionTask.tracking(
                        terms, sole, r.p_WF, GAINS.swing_position,
                        weights.swing_foot_position, r.v_WF, r.a_WF,
                    ),
                    OrientationTask.tracking(
                        terms, sole, r.R_WF, GAINS.swing_orientation,
                        weights.swing_foot_orientation, r.w_WF, r.alpha_WF,
                    ),
                ]
            else:
                still = -GAINS.stance_foot_damping * terms.feet[foot].V_WF
                tasks.append(FrameTask(sole, still, weights.stance_foot))
                contacts.append(self.contact(phase, foot, loads[foot]))
        if in_air is None:
            f = weights.internal_contact_force
            tasks.append(InternalContactTask(
                tuple(self.soles), np.array([weights.internal_contact_moment, f, f])))
        # Posture
        g = GAINS.posture
        posture = PostureTask(
            g.kp * (self.robot.stand_prep - terms.q) - g.kd * terms.v,
            self.posture_weight(in_air),
        )
        return phase, WholeBodyCommand(posture, tuple(tasks), tuple(contacts))

    def posture_weight(self, in_air):
        limb = self.robot.limb
        weight = np.full(self.robot.num_joints, GAINS.arm_posture_weight)
        weight[limb("back")] = GAINS.back_posture_weight
        weight[limb("l_leg", "r_leg")] = GAINS.leg_posture_weight
        if in_air is not None:
            weight[limb(("l_leg", "r_leg")[in_air])] = GAINS.swing_leg_posture_weight
        return weight

    def contact(self, phase, foot, load):
        model = GAINS.contact
        most = self.weight * model.unloaded_share + model.load_growth * max(load, 0.0)
        if phase.plan is not None and phase.elapsed == 0.0 and len(phase.steps) == 4:
            most = 3.0 * self.weight
        if phase.steps and phase.swing is None and phase.steps[0].foot == foot:
            left = 1.0 - phase.elapsed / phase.plan.segments[0].duration
            most = min(most, self.weight * min(max(left / 0.4, 0.01), 1.0))
        return Contact(self.soles[foot], self.patches.whole, most)

    def support(self, phase):
        sole, model = self.robot.file.sole, GAINS.contact
        corners = []
        for foot, pose in enumerate(phase.feet):
            if phase.swing is None or foot != phase.steps[0].foot:
                corners += [*sole_corners(
                    pose.p_WF, pose.R_WF,
                    sole.length / 2 - model.length_margin,
                    sole.width / 2 - model.width_margin)]
        return SupportPolygon(corners)

    def report(self, context, output):
        """Tell views and logs the plan."""
        phase = context.get_abstract_state(self.phase).get_value()
        if phase.plan is None:
            return
        now = phase.plan.evaluate(phase.elapsed)
        plan = Plan(
            support=self.support(phase).vertices,
            omega=self.omega,
            dcm_reference=now.dcm,
            cop_reference=now.cop,
            footsteps=phase.steps,
        )
        output.set_value(ControllerStatus(plan=plan))


def main():
    """Walks, and says where the robot arrived."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    parser.add_argument("--step-time", type=float, default=STEP_TIME, help="[s]")
    parser.add_argument("--push", type=float, default=0.0, help="to the left [N s]")
    parser.add_argument("--log", help="file .mcap")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado
    sim = AtlasSimulation(
        controller=partial(Walker, step_time=options.step_time),
        view=not options.headless, log=options.log, on_event=print,
    )
    sim.advance(7.0)
    sim.close()
    for name in ("l_sole", "r_sole", "pelvis"):
        print(name, sim.frame_pose(name).translation())
    print("Atlas fell." if sim.has_fallen else "Atlas stands")
    sys.exit(sim.has_fallen)


if __name__ == "__main__":
    main()
