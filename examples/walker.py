"""A walking robot in one file: footsteps, DCM plan, whole-body QP, torque.

    python examples/walker.py

Read it from top to bottom. It is made of the parts in ``atlas_drake.control``, and uses
none of the shipped behaviors:

    1. footsteps   where the feet go                        tutorial_steps
    2. DCM plan    how the body follows without a fall      plan_dcm
    3. phases      which foot is in the air                 Walker.next_phase
    4. tasks       what each part of the body does now      Walker.tasks
    5. QP          the torques that fulfill all the tasks   Walker.tick

Symbols, in SI units; W is the world, z up, and F a frame of the robot:

    p_WF, R_WF     position and orientation of F in W
    V_WF, A_WF     spatial velocity and acceleration of F in W, [angular; translational]
    c, ċ           center of mass (CoM) and its velocity
    ω = √(g/z)     natural frequency of a pendulum with its mass at the height z
    ξ = c + ċ/ω    divergent component of motion (DCM)
    p              center of pressure (CoP) under the feet
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
from atlas_drake.control import whole_body as wb
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import CopSegment, DcmPlan
from atlas_drake.control.feet.sole import sole_patches
from atlas_drake.control.feet.swing_foot import (
    FootSwing,
    SwingProfile,
    advance_swing,
    begin_swing,
)
from atlas_drake.control.gains import ControlGains
from atlas_drake.frozen import Frozen
from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import mean_yaw, rotation_z
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.units import GRAVITY

STEP_TIME = 0.63  # from one touchdown to the next [s]
STRIDE, HALF_WIDTH = 0.25, 0.15  # of the steps, ahead and to the side [m]
SWING_HEIGHT = 0.3  # of the soles [m]
DOUBLE_SUPPORT = 0.25  # share of the step time with both feet down [-]
STANDING, SETTLING = 1.0, 0.8  # before the first step, and after the last one [s]
COM_DROP = 0.02  # below the upright pose: straight knees could not reach ahead [m]
FALLEN = 0.8  # height of the CoM of a robot that falls, relative to walking [-]
TOUCHDOWN = 0.03  # load on a foot that has landed, in weights of the robot [-]
GAINS, PROFILE = ControlGains(), SwingProfile()  # Their files give the reasons.


# ---- 1. Footsteps ------------------------------------------------------------


def tutorial_steps(feet, step_time):
    """Place four footsteps ahead, left foot first; the last two are side by side."""
    yaw = mean_yaw(feet[0].yaw, feet[1].yaw)
    p_WM, R_WM = middle(feet), rotation_z(yaw)  # M is in the middle of the soles.
    steps = []
    for index in range(4):
        foot = index % 2  # 0 is left, 1 is right.
        p_MF = [STRIDE * (1 + index // 2), (HALF_WIDTH, -HALF_WIDTH)[foot], 0.0]
        p_WF = p_WM + R_WM @ p_MF
        steps.append(Footstep(index + 1, foot, p_WF, yaw, step_time, SWING_HEIGHT))
    return tuple(steps)


def middle(feet):
    """Return the point in the middle of both soles in W [m], shape (3,)."""
    return 0.5 * (feet[0].p_WF + feet[1].p_WF)


# ---- 2. DCM plan -------------------------------------------------------------


def plan_dcm(cop, hold, feet, steps, omega):
    """Plan the CoP through all coming steps, and the DCM that belongs to it.

    The body is an inverted pendulum on the CoP: c̈ = ω² (c - p). The DCM splits this
    equation of second order into two of first order:

        ċ = ω (ξ - c)    stable: the CoM follows the DCM
        ξ̇ = ω (ξ - p)    unstable: the DCM runs away from the CoP

    So only the DCM needs a plan. The CoP holds still, moves to the next stance foot
    while both feet are down, holds still during the swing, and so on; it ends in the
    middle of the feet, where the DCM comes to rest. ``DcmPlan`` solves the equation of
    the DCM from this end backward in time, in which it is stable.

    Args:
        cop: CoP now in W [m], shape (2,).
        hold: Time for which the CoP holds still at first [s].
        feet: Poses of both soles at the end of this time.
        steps: Steps that begin after this time.
        omega: Natural frequency ω [1/s].
    """
    segments, feet = [CopSegment(hold, cop, cop)] if hold else [], list(feet)
    for step in steps:
        stance = feet[1 - step.foot].p_WF[:2]
        segments.append(CopSegment(transfer_time(step), cop, stance))
        segments.append(CopSegment(swing_time(step), stance, stance))
        cop, feet[step.foot] = stance, step.pose
    segments.append(CopSegment(SETTLING, cop, middle(feet)[:2]))
    return DcmPlan(segments, omega)


def transfer_time(step):
    """Return the time from touchdown to the lift-off of the other foot [s]."""
    return DOUBLE_SUPPORT * step.duration


def swing_time(step):
    """Return the time from lift-off to touchdown [s]."""
    return step.duration - transfer_time(step)


# ---- The controller ----------------------------------------------------------


@dataclass(frozen=True)
class Phase(Frozen):
    """Double or single support: the state of the walker from tick to tick."""

    feet: tuple[FootPose, ...] = ()  # where the soles last stood on the ground
    steps: tuple[
        Footstep, ...
    ] = ()  # to go; the first one is in the air if swing is set
    plan: DcmPlan | None = None  # its time is elapsed
    duration: float = 0.0  # planned [s]
    elapsed: float = 0.0  # since the beginning of the phase [s]
    swing: FootSwing | None = None  # motion of the foot in the air

    @property
    def swing_foot(self):
        """The foot in the air; None in double support."""
        return self.steps[0].foot if self.swing else None

    @property
    def stance_feet(self):
        """The feet on the ground."""
        return tuple(foot for foot in (0, 1) if foot != self.swing_foot)


class Walker(LeafSystem):
    """State of the robot in, joint torques out; the ``Phase`` is in the Context."""

    def __init__(self, robot, scenario, step_time=STEP_TIME):
        """Declare the ports; the simulation connects them by their names."""
        super().__init__()
        self.robot, self.dt, self.step_time = robot, scenario.control_period, step_time
        self.body_weight = robot.mass * GRAVITY  # [N]
        self.height = robot.com_height - COM_DROP  # of the CoM above the soles [m]
        self.omega = feedback.pendulum_frequency(self.height)
        self.soles = tuple(foot.sole_frame for foot in robot.file.feet)
        self.patch = sole_patches(robot.file.sole, GAINS.contact).whole
        self.model, self.qp = wb.WholeBodyModel(robot), wb.WholeBodyQp(robot, GAINS)
        self.scratch = self.model.create_context()  # scratch paper, not state

        self.state = self.DeclareVectorInputPort("state", self.model.num_states)
        self.loads = self.DeclareVectorInputPort("foot_loads", 2)  # [N]
        self.phase = self.DeclareAbstractState(AbstractValue.Make(Phase()))
        self.torque = self.DeclareDiscreteState(robot.num_joints)  # [N·m]
        self.DeclareStateOutputPort("behavior_effort", self.torque)
        self.DeclareAbstractOutputPort(
            "controller_status",
            lambda: AbstractValue.Make(ControllerStatus()),
            self.report,
            prerequisites_of_calc={self.xa_ticket()},
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(self.dt, 0.0, self.tick)

    # ---- 3. Phases -----------------------------------------------------------

    def next_phase(self, phase, terms, loads):
        """Lift a foot by the clock; detect by its load that it has landed."""
        feet = tuple(FootPose(foot.p_WF, foot.R_WF) for foot in terms.feet)
        if phase.plan is None:  # the first tick
            steps = tutorial_steps(feet, self.step_time)
            return self.double_support(feet, steps, terms.com[:2], STANDING)
        phase = replace(phase, elapsed=phase.elapsed + self.dt)
        if phase.swing is None:
            lifts_off = phase.steps and phase.elapsed >= phase.duration
            return self.single_support(feet, phase.steps) if lifts_off else phase
        load = loads[phase.swing_foot]
        if phase.swing.progress > 0.5 and load > TOUCHDOWN * self.body_weight:
            cop = phase.plan.evaluate(phase.elapsed).cop
            return self.double_support(feet, phase.steps[1:], cop)
        swing, _ = advance_swing(phase.swing, phase.steps[0], PROFILE, self.dt)
        return replace(phase, swing=swing)

    def double_support(self, feet, steps, cop, hold=0.0):
        """Hold the CoP still, and then shift it to the next stance foot."""
        plan = plan_dcm(cop, hold, feet, steps, self.omega)
        duration = hold + transfer_time(steps[0]) if steps else SETTLING
        return Phase(feet, steps, plan, duration)

    def single_support(self, feet, steps):
        """Move one foot to its footstep, with the CoP below the other foot."""
        (step, *later), landed = steps, list(feet)
        landed[step.foot] = step.pose
        cop, duration = feet[1 - step.foot].p_WF[:2], swing_time(step)
        plan = plan_dcm(cop, duration, landed, later, self.omega)
        swing = begin_swing(feet[step.foot], duration)
        return Phase(feet, steps, plan, duration, swing=swing)

    # ---- 4. Tasks ------------------------------------------------------------

    def tasks(self, phase, terms):
        """List the desired accelerations, each with its weight in the QP's cost.

        Tasks follow references by PD laws: a_ref + kp (x_ref - x) + kd (v_ref - v).
        """
        return [
            *self.balance_tasks(phase, terms),
            *self.trunk_tasks(phase, terms),
            *self.foot_tasks(phase, terms),
        ]

    def balance_tasks(self, phase, terms):
        """Drive the DCM to its plan by the CoP, and the CoM to its height.

        A CoP beyond the DCM pushes it back: ξ - ξ_ref shrinks as e^{-kωt}, as long as
        the CoP stays within the feet. The CoM accelerates away from the CoP:

            p = p_ref + (1 + k) (ξ - ξ_ref),    c̈ = ω² (c - p)

        The contact forces shall do this without turning the body. Then their sum passes
        through the CoM and through the point E that is g/ω² below the CoM and above p,
        the enhanced centroidal moment pivot (eCMP), and their moment about E is zero.
        """
        reference, weights = phase.plan.evaluate(phase.elapsed), GAINS.weights
        error = feedback.dcm(terms, self.omega) - reference.dcm
        cop = feedback.feedback_cmp(error, reference.cop, GAINS.dcm_gain)
        cop = self.support(phase).clamp(cop)
        a_xy = feedback.com_acceleration_for_cmp(terms.com, cop, self.omega)
        height = middle(phase.feet)[2] + self.height
        a_z = feedback.height_acceleration(terms, height, 0.0, GAINS.com_height)
        p_WE = np.append(cop, terms.com[2] - GRAVITY / self.omega**2)
        com_weight = np.array([weights.com, weights.com, weights.com_height])
        return [
            wb.ComTask(np.append(a_xy, a_z), com_weight),
            wb.MomentTask(p_WE, weights.moment),
        ]

    def trunk_tasks(self, phase, terms):
        """Keep pelvis and chest upright, with the heading of the feet."""
        R_WD = rotation_z(mean_yaw(*(foot.yaw for foot in phase.feet)))
        robot, weights = self.robot.file, GAINS.weights
        return [
            wb.OrientationTask.tracking(terms, frame, R_WD, GAINS.orientation, weight)
            for frame, weight in (
                (robot.pelvis, weights.pelvis_tilt),
                (robot.chest, weights.chest_tilt),
            )
        ]

    def foot_tasks(self, phase, terms):
        """Hold the stance feet still, A_WF = -kd V_WF, and guide the swing foot."""
        weights, tasks = GAINS.weights, []
        for foot in phase.stance_feet:
            still = -GAINS.stance_foot_damping * terms.feet[foot].V_WF
            tasks.append(wb.FrameTask(self.soles[foot], still, weights.stance_foot))
        if phase.swing:
            frame = self.soles[phase.swing_foot]
            _, goal = advance_swing(phase.swing, phase.steps[0], PROFILE, dt=0.0)
            gains, weight = GAINS.swing_position, weights.swing_foot_position
            motion = goal.p_WF, gains, weight, goal.v_WF, goal.a_WF
            tasks.append(wb.PositionTask.tracking(terms, frame, *motion))
            gains, weight = GAINS.swing_orientation, weights.swing_foot_orientation
            motion = goal.R_WF, gains, weight, goal.w_WF, goal.alpha_WF
            tasks.append(wb.OrientationTask.tracking(terms, frame, *motion))
        return tasks

    def posture(self, terms):
        """Draw all joints to the upright pose: q̈ = kp (q_up - q) - kd q̇.

        Its small weights decide every motion that the tasks leave free.
        """
        robot, gains = self.robot, GAINS.posture
        weight = np.full(robot.num_joints, GAINS.arm_posture_weight)
        weight[robot.limb("back")] = GAINS.back_posture_weight
        weight[robot.limb("l_leg", "r_leg")] = GAINS.leg_posture_weight
        target = gains.kp * (robot.stand_prep - terms.q) - gains.kd * terms.v
        return wb.PostureTask(target, weight)

    def contacts(self, phase):
        """List the soles on which the ground can push."""
        most = GAINS.contact.full_load * self.body_weight
        return [
            wb.Contact(self.soles[foot], self.patch, most) for foot in phase.stance_feet
        ]

    def support(self, phase):
        """Return the convex hull of the soles on the ground, less a margin."""
        return SupportPolygon(
            corner
            for pose in (phase.feet[foot] for foot in phase.stance_feet)
            for corner in pose.p_WF + self.patch.corners @ pose.R_WF[:, :2].T
        )

    # ---- 5. QP -> torque -----------------------------------------------------

    def tick(self, context, state):
        """Go through all stages; called at each control tick, every 9 ms.

        The QP finds the accelerations v̇ ∈ R^{6 + n} of the pelvis and the n joints, the
        wrenches λ ∈ R^{6 c} of the c contacts, and the torques τ ∈ R^n:

            min   Σ ½ ‖A v̇ + b + G λ - target‖²_weight    tasks, posture, small λ
            s.t.  M v̇ + h = Sᵀ τ + Jᵀ λ                    dynamics, 6 + n rows
                  C λ ≤ 0,  0 ≤ λ_z ≤ λ_max               friction, CoP within the soles
                  |τ| ≤ τ_max                             motors
                  q̈_min ≤ q̈ ≤ q̈_max                       joint limits, soft
        """
        terms = self.model.evaluate(self.scratch, self.state.Eval(context))
        torque = state.get_mutable_discrete_state(self.torque)
        limit = self.robot.effort_limit
        if terms.com[2] < FALLEN * self.height:
            torque.set_value(np.zeros_like(limit))
            return
        before = context.get_abstract_state(self.phase).get_value()
        phase = self.next_phase(before, terms, self.loads.Eval(context))
        command = wb.WholeBodyCommand(
            self.posture(terms),
            tuple(self.tasks(phase, terms)),
            tuple(self.contacts(phase)),
        )
        nobody = np.zeros(len(limit), dtype=bool)  # No joint is the user's.
        bounds = wb.EffortBounds(-limit, limit, nobody)
        torque.set_value(self.qp.solve(terms, command, bounds).effort)
        state.get_mutable_abstract_state(self.phase).set_value(phase)

    def report(self, context, output):
        """Show views and logs the plan; the walk itself does not need it."""
        phase, plan = context.get_abstract_state(self.phase).get_value(), Plan()
        if phase.plan is not None:
            reference = phase.plan.evaluate(phase.elapsed)
            plan = Plan(
                support=self.support(phase).vertices,
                omega=self.omega,
                dcm_reference=reference.dcm,
                cop_reference=reference.cop,
                footsteps=phase.steps,
            )
        output.set_value(ControllerStatus(plan=plan))


controller = Walker  # what --with takes from this file


def main():
    """Walk, and say where the robot arrived."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    parser.add_argument("--step-time", type=float, default=STEP_TIME, help="[s]")
    parser.add_argument("--push", nargs=2, type=float, metavar=("AHEAD", "LEFT"))
    parser.add_argument("--log", help="FILE.mcap, for atlas-drake plot and replay")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

    walker = partial(Walker, step_time=options.step_time)
    with AtlasSimulation(
        controller=walker, view=not options.headless, log=options.log
    ) as sim:
        sim.advance(STANDING + 1.5 * options.step_time)
        if options.push:  # [N·s], while the second foot is in the air
            sim.apply_push("trunk", 10.0 * np.array([*options.push, 0.0]), 0.1)
        sim.advance(2.5 * options.step_time + SETTLING + 2.0)

    for foot in sim.robot.file.feet:
        x, y, _ = sim.frame_pose(foot.sole_frame).translation()
        print(f"{foot.sole_frame} is at x {x:.3f} m, y {y:+.3f} m.")
    print("Atlas fell." if sim.has_fallen else "Atlas stands.")
    sys.exit(sim.has_fallen)


if __name__ == "__main__":
    main()


# ---- Exercises ---------------------------------------------------------------
#
# 1. The gain of the DCM.  ``GAINS.dcm_gain`` is k in e^{-kωt}.  Which least k carries
#    the four steps, and what does the measured CoP do at k = 6?  (--log, then plot)
# 2. A step that waits.  Let a foot lift off only when the DCM is within 3 cm of its
#    plan, or 0.25 s late.  How much harder a push to the left does the walk bear?
#    (``behaviors/walk/transfer.py`` has the answer of this project.)
# 3. A step that moves.  Shift the landing place by the error of the DCM that the ankle
#    cannot hold until touchdown.  (``control/balance/step_adjustment.py``)
# 4. The arms.  They hang still.  Give the shoulders a posture that swings against the
#    legs, and watch the yaw moment of the stance foot.
# 5. The QP.  ``walker_qp.py`` writes it out for Drake's MathematicalProgram.  It leaves
#    out the limits of the joints: add them.  Then make the friction 0.2, and see which
#    constraint is active before the robot slips.
