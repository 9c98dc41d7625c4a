"""Hands that move along straight lines, in a user's hands: commands, one at a time.

A line of the hands, not of the joints: two hands that squeeze a crate must not drag it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from pydrake.systems.framework import Context

from atlas_drake.messages import K_EFFORT_MAX, AtlasCommand
from atlas_drake.messages.checks import check_number
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.planning.arm_motion import ArmSteps, arm_speed, joints_between
from atlas_drake.planning.hand_goal import HandGoal, goal_between
from atlas_drake.planning.palms import (
    arms_of,
    context_of,
    frame_of,
    holding_effort,
    palm_of,
    palm_stiffness,
)
from atlas_drake.planning.reach import Reach, reach
from atlas_drake.robot import TRUNK, Robot

STIFFNESS, DAMPING = 2000.0, 80.0
"""Largest ``kp_position`` [N·m/rad] and ``kp_velocity`` [N·m·s/rad] of the arms."""
FULL_EFFORT_AT = 0.05
"""Least error of a joint at which it exerts all of its effort [rad]: weak joints get
smaller gains."""
PULL = 0.02
"""Share of what joints are off from the pose that ``aim`` found, made up for by each
command as far as the hands leave it open."""
LONGEST = 600.0
"""Longest duration of a motion [s]."""


class HandMotion:
    """Where the hands go, and the commands that bring them there.

    The arms of hands with a goal are the user's, every other joint is the behavior's.
    Gravity and the forces of the goals are fed forward, so that neither the arms' own
    weight nor a load lets the hands sag.
    """

    PERIOD = 0.02
    """Time between two commands [s]."""
    FASTEST = 3.0
    """Largest speed of a set-point [rad/s]."""

    def __init__(self, robot: Robot) -> None:
        """Moves the hands of a robot, held as stiffly as the goals ask for."""
        self._robot = robot
        self._stiffest = np.minimum(STIFFNESS, robot.effort_limit / FULL_EFFORT_AT)
        # Factors of these gains in the last command, and before the motion began.
        self._scale: np.ndarray | None = None
        self._scale_from: np.ndarray | None = None
        self._steps = ArmSteps(robot, ())
        self._from: tuple[HandGoal, ...] = ()
        self._to: tuple[HandGoal, ...] = ()
        self._begin = self._duration = 0.0
        # Set-points of the last command; where the joints come from, and where they go.
        self._last: np.ndarray | None = None
        self._joints_from = self._joints_to = robot.stand_prep

    def aim(
        self,
        time: float,
        state: np.ndarray,
        goals: Sequence[HandGoal],
        duration: float,
    ) -> Reach:
        """Begins a motion of all hands that have a goal from now on.

        Args:
            time: Present time [s].
            state: Positions and velocities of the robot, in the order of its plant.
            goals: At most one for each hand.
            duration: Time in which the hands get there [s], from ``PERIOD`` to
                ``LONGEST``.

        Returns:
            The arms at the end, as seen from here.

        Raises:
            InvalidMessageError: If a goal is out of reach, or a value cannot be used;
                the motion before goes on.
        """
        duration = check_number(duration, "duration", self.PERIOD, LONGEST)
        last = self._joints(state)
        there = reach(self._robot, state, goals, last)
        there.check()
        context = context_of(self._robot, state)
        self._steps = ArmSteps(self._robot, goals)
        self._joints_from, self._joints_to = last, there.joints
        going = {goal.hand: goal for goal in self._now(time)}
        self._from = tuple(self._start(context, goal, going) for goal in goals)
        self._to = tuple(goals)
        self._begin, self._duration = time, duration
        self._scale_from = self._scale
        return there

    def is_there(self, time: float) -> bool:
        """Returns True once the hands have got where they were told to go.

        Args:
            time: Present time, or an earlier one [s].
        """
        return time >= self._begin + self._duration

    def carried(self, time: float, state: np.ndarray) -> list[HandGoal]:
        """Returns goals with which the hands stay where they are at the chest.

        Args:
            time: Present time [s].
            state: Positions and velocities of the robot, in the order of its plant.
        """
        now, context = self._now(time), context_of(self._robot, state)
        going = {goal.hand: goal for goal in now}
        return [self._start(context, replace(goal, frame=TRUNK), going) for goal in now]

    def command(
        self, time: float, state: np.ndarray, others: JointCommand | None = None
    ) -> AtlasCommand:
        """Returns the command for the next ``PERIOD``.

        Args:
            time: Present time [s].
            state: Positions and velocities of the robot, in the order of its plant.
            others: What the joints of no hand with a goal keep; None gives these to the
                behavior.
        """
        robot, goals, most = self._robot, self._now(time), self.FASTEST * self.PERIOD
        soon, last = time + self.PERIOD, self._joints(state)
        planned, next_planned = self._planned(time), self._planned(soon)
        way = next_planned - planned + PULL * (planned - last)
        self._last = joints = self._steps.step(state, goals, last, way, most)
        later = self._now(soon)
        speed = arm_speed(robot, state, goals, later, self.PERIOD)
        speed = np.clip(speed, -self.FASTEST, self.FASTEST)
        context = context_of(robot, state, joints)
        self._scale = scale = self._gain_scale(time, context, goals)
        # The same share of the critical damping.
        damping = DAMPING / STIFFNESS * self._stiffest * np.sqrt(scale)
        mine = arms_of(robot, goals)
        kept = {"position": joints} if others is None else vars(others)

        def beside_kept(name: str, value: np.ndarray | float) -> np.ndarray:
            return np.where(mine, value, kept.get(name, 0))

        return AtlasCommand(
            position=beside_kept("position", joints),
            velocity=beside_kept("velocity", speed),
            effort=beside_kept("effort", holding_effort(robot, context, goals)),
            kp_position=beside_kept("kp_position", scale * self._stiffest),
            kp_velocity=beside_kept("kp_velocity", damping),
            k_effort=beside_kept("k_effort", K_EFFORT_MAX),
        )

    def _passed(self, time: float) -> float:
        """Returns the share of the motion's time that has passed."""
        passed = (time - self._begin) / max(self._duration, self.PERIOD)
        return min(max(passed, 0.0), 1.0)

    def _joints(self, state: np.ndarray) -> np.ndarray:
        """Returns the set-points of the joints, at first where they are."""
        if self._last is not None:
            return self._last
        return np.asarray(state[self._robot.indices(self._robot.plant).q])

    def _planned(self, time: float) -> np.ndarray:
        """Returns the joints on their way to the pose that ``aim`` found."""
        return joints_between(self._joints_from, self._joints_to, self._passed(time))

    def _now(self, time: float) -> tuple[HandGoal, ...]:
        """Returns the goals on the way at a time."""
        passed, ends = self._passed(time), zip(self._from, self._to, strict=True)
        return tuple(goal_between(start, end, passed) for start, end in ends)

    def _gain_scale(
        self, time: float, context: Context, goals: Sequence[HandGoal]
    ) -> np.ndarray:
        """Computes by which factor of the stiffest gains joints are held, (n,).

        It goes over from that of the motion before.
        """
        robot, scale = self._robot, np.ones(self._robot.num_joints)
        for goal in goals:
            if goal.stiffness is not None:
                most = palm_stiffness(robot, context, goal, self._stiffest)
                scale[arms_of(robot, [goal])] = min(goal.stiffness / most, 1.0)
        if self._scale_from is None:
            return scale
        passed = self._passed(time)
        return (1.0 - passed) * self._scale_from + passed * scale

    def _start(
        self, context: Context, goal: HandGoal, going: dict[str, HandGoal]
    ) -> HandGoal:
        """Returns where the way to a goal begins: where the hand is going, or is."""
        plant, palm = self._robot.plant, palm_of(self._robot, goal)
        X_WH = plant.GetFrameByName(goal.hand).CalcPoseInWorld(context)
        p, R_WH, force = X_WH @ palm, X_WH.rotation(), np.zeros(3)
        directed, turned = goal.direction is not None, goal.orientation is not None
        direction = R_WH @ (palm / np.linalg.norm(palm)) if directed else np.zeros(3)
        before = going.get(goal.hand)
        if before is not None and before.palm == goal.palm:
            X_WF = frame_of(self._robot, before).CalcPoseInWorld(context)
            p = X_WF @ np.array(before.position)
            force = X_WF.rotation() @ np.array(before.force)
            if before.direction is not None:
                direction = X_WF.rotation() @ np.array(before.direction)
            if before.orientation is not None:
                R_WH = X_WF.rotation() @ before.rotation
        X_FW = frame_of(self._robot, goal).CalcPoseInWorld(context).inverse()
        R_FW = X_FW.rotation()
        return replace(
            goal,
            position=(X_FW @ p).tolist(),
            direction=(R_FW @ direction).tolist() if directed else None,
            force=(R_FW @ force).tolist(),
            orientation=(R_FW @ R_WH).ToQuaternion().wxyz() if turned else None,
        )
