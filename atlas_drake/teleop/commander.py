"""Converts the panel's buttons and sliders to orders: messages, pushes, a reset.

The commander reads the panel and the robot's reports; ``session`` sends the orders.
Walking is in ``driving``, joints are in ``limbs``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.control.feet.footstep import LEFT
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasBehaviorManipulateParams,
    AtlasBehaviorStepParams,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    AtlasState,
    Behavior,
    BehaviorStatus,
)
from atlas_drake.planning.footholds import Gait, foothold, step_data, step_from
from atlas_drake.robot import Robot
from atlas_drake.teleop.controls import (
    DIRECTIONS,
    PELVIS_HEIGHT,
    PELVIS_YAW,
    PUSH_BODY,
    PUSH_DIRECTION,
    PUSH_IMPULSE,
    SHARES,
    Action,
    BehaviorButton,
    Button,
    Controls,
    Slider,
)
from atlas_drake.teleop.driving import Drive, drive, steer
from atlas_drake.teleop.limbs import (
    Limbs,
    group_of,
    hand_over,
    joint_shares,
    move_joints,
)

PUSH_DURATION = 0.1
"""Duration of a push, over which its impulse is spread [s]."""

_USERS = (Behavior.USER, Behavior.NONE)


@dataclass(frozen=True)
class PushOrder:
    """A push on a body: force in W [N], shape (3,), for a time [s]."""

    body: str
    force_W: np.ndarray
    duration: float


@dataclass
class Orders:
    """Orders of one reading of the panel.

    Attributes:
        atlas_command: Command to publish, or None.
        sim_command: Command to publish, or None.
        push: Push to apply, or None.
        reset: True to put the robot back on its feet; all other orders are ignored.
        sliders: New positions of sliders, so that they show the values in force.
        joints: Joints that get sliders, with set-points [rad].
    """

    atlas_command: AtlasCommand | None = None
    sim_command: AtlasSimInterfaceCommand | None = None
    push: PushOrder | None = None
    reset: bool = False
    sliders: dict[Slider, float] = field(default_factory=dict)
    joints: Mapping[int, float] = field(default_factory=dict)


@dataclass(frozen=True)
class _Look:
    """One look at the panel and the robot, and the orders that it leads to."""

    controls: Controls
    report: AtlasSimInterfaceState
    state: AtlasState
    orders: Orders


class Commander:
    """Converts readings of the panel to orders."""

    def __init__(
        self, robot: Robot, report: AtlasSimInterfaceState, gait: Gait | None = None
    ) -> None:
        """Takes over a robot in its reported state.

        Args:
            robot: The robot.
            report: Its latest report.
            gait: The usual gait; None for the robot's.
        """
        self._robot = robot
        self._gait = gait or ControllerConfig.of(robot.file).gait()
        groups = group_of(robot)
        self._first_joint = {
            group: groups.index(group) if group in groups else None for group in SHARES
        }
        self._begin(report)

    def _begin(self, report: AtlasSimInterfaceState) -> None:
        self._limbs = Limbs(self._in_force(report), self._robot.stand_prep.copy())
        self._drive = Drive()
        self._last_shares: dict[str, int] | None = None
        self._shares_before_user = dict.fromkeys(SHARES, 0)
        self._pose: tuple[float, float] | None = None
        self._pose_moved = False
        self._step_foot = LEFT
        self._stick_used = False

    def look(
        self,
        controls: Controls,
        report: AtlasSimInterfaceState,
        state: AtlasState,
        dt: float,
    ) -> Orders:
        """Makes the orders for the present state of the panel.

        The next reading comes after ``dt`` [s].
        """
        orders = Orders()
        if Action.RESET in controls.clicks:
            orders.reset = True
            return orders
        now = _Look(controls, report, state, orders)
        self._give_joints(now, dt)
        self._look_at_pose(now)
        for action in controls.clicks:
            if action in DIRECTIONS:
                self._drive = steer(self._drive, DIRECTIONS[action])
            elif action is Action.STOP:
                self._drive = steer(self._drive, None)
            elif action is Action.PUSH:
                orders.push = push_of(controls, report, self._robot)
            elif (behavior := _behavior_of(action)) is not None:
                self._drive = Drive()
                self._ask_for(behavior, now)
        self._follow_stick(controls)
        if orders.sim_command is None:
            if report.behavior_feedback.status_flags & BehaviorStatus.ERROR_FALLING:
                self._drive = Drive()
            self._drive, orders.sim_command = drive(
                self._drive, controls.gait(self._gait), report
            )
        if orders.sim_command is not None:
            self._change_hands(orders.sim_command, now)
        shares = joint_shares(self._robot, self._limbs.shares)
        orders.joints = {
            i: float(self._limbs.position[i]) for i in np.flatnonzero(shares).tolist()
        }
        return orders

    def restart(self, report: AtlasSimInterfaceState) -> Orders:
        """Clears the state after a reset; the sliders show the values in force."""
        self._begin(report)
        return Orders(sliders={SHARES[g]: s for g, s in self._limbs.shares.items()})

    # ---- joints --------------------------------------------------------------

    def _in_force(self, report: AtlasSimInterfaceState) -> dict[str, int]:
        """Returns the share of each group's first joint; 0 if it has no joints."""
        return {
            group: 0 if joint is None else int(report.k_effort[joint])
            for group, joint in self._first_joint.items()
        }

    def _give_joints(self, now: _Look, dt: float) -> None:
        """Hands limbs over by the sliders, and moves the user's joints."""
        in_force = self._in_force(now.report)
        if in_force != dict(self._limbs.shares):
            # Another commander has changed the shares: the sliders follow.
            self._limbs, _ = hand_over(self._limbs, in_force, now.state, self._robot)
            self._show_shares(in_force, now.orders)
            return
        wanted = now.controls.shares
        moved = self._last_shares is not None and wanted != self._last_shares
        if self._last_shares is None and wanted != in_force:
            self._show_shares(in_force, now.orders)
            return
        self._last_shares = wanted
        if moved:
            self._limbs, now.orders.atlas_command = hand_over(
                self._limbs, wanted, now.state, self._robot
            )
        else:
            self._limbs, now.orders.atlas_command = move_joints(
                self._limbs, now.controls.joints, dt
            )

    def _show_shares(self, shares: Mapping[str, int], orders: Orders) -> None:
        orders.sliders.update({SHARES[g]: share for g, share in shares.items()})
        self._last_shares = dict(shares)

    def _change_hands(self, command: AtlasSimInterfaceCommand, now: _Look) -> None:
        """Gives USER all limbs as they are, and the next behavior its limbs back."""
        was_users = now.report.current_behavior in _USERS
        if command.behavior == Behavior.USER:
            if not was_users:
                self._shares_before_user = dict(self._limbs.shares)
            shares = {
                group: 0 if joint is None else K_EFFORT_MAX
                for group, joint in self._first_joint.items()
            }
        elif was_users:
            shares = self._shares_before_user
        else:
            return
        self._limbs, message = hand_over(self._limbs, shares, now.state, self._robot)
        now.orders.atlas_command = message or now.orders.atlas_command
        self._show_shares(shares, now.orders)

    # ---- behaviors ----------------------------------------------------------

    def _ask_for(self, behavior: Behavior, now: _Look) -> None:
        command = AtlasSimInterfaceCommand(behavior=behavior)
        if behavior is Behavior.STEP:
            self._fill_step(command.step_params, now)
        elif behavior is Behavior.MANIPULATE:
            self._fill_pose(command.manipulate_params, now)
        now.orders.sim_command = command

    def _fill_step(self, params: AtlasBehaviorStepParams, now: _Look) -> None:
        """Requests one step ahead, with alternating feet."""
        gait, report = now.controls.gait(self._gait), now.report
        active = report.current_behavior == Behavior.STEP
        index = report.step_feedback.next_step_index_needed if active else 1
        foot = self._step_foot
        stance = foothold(report.foot_pos_est[1 - foot])
        place = step_from(stance, foot, gait, gait.stride, 0.0, 0.0)
        params.desired_step = step_data(index, foot, place, gait)
        params.use_relative_step_height = True
        self._step_foot = 1 - foot

    def _fill_pose(self, params: AtlasBehaviorManipulateParams, now: _Look) -> None:
        """Requests the sliders' pose if they were moved, else the present pose."""
        params.use_desired = self._pose_moved
        if self._pose_moved:
            params.desired.pelvis_height = now.controls.value(PELVIS_HEIGHT)
            params.desired.pelvis_yaw = now.controls.value(PELVIS_YAW)
            return
        feet = [pose.position.z for pose in now.report.foot_pos_est]
        height = now.report.pos_est.position.z - 0.5 * sum(feet)
        now.orders.sliders[PELVIS_HEIGHT] = height
        self._pose = None

    def _look_at_pose(self, now: _Look) -> None:
        """Sends the pelvis to the sliders' pose when they move in MANIPULATE."""
        pose = now.controls.value(PELVIS_HEIGHT), now.controls.value(PELVIS_YAW)
        before, self._pose = self._pose, pose
        if before is None or pose == before:
            return
        self._pose_moved = True
        if now.report.desired_behavior == Behavior.MANIPULATE:
            self._ask_for(Behavior.MANIPULATE, now)

    def _follow_stick(self, controls: Controls) -> None:
        """Steers by gamepad while its sticks are held."""
        stick = controls.stick
        if stick is not None and any(stick):
            self._drive = steer(self._drive, stick)
            self._stick_used = True
        elif self._stick_used:
            self._drive = steer(self._drive, None)
            self._stick_used = False


def _behavior_of(button: Button) -> Behavior | None:
    """Returns the behavior that a button requests, if any."""
    if isinstance(button, BehaviorButton):
        return button.behavior
    return Behavior.__members__.get(button.name)


def push_of(
    controls: Controls, report: AtlasSimInterfaceState, robot: Robot
) -> PushOrder:
    """Makes the push of the sliders, with its direction from the robot's heading."""
    heading = foothold(report.foot_pos_est[0]).yaw
    angle = heading + math.radians(controls.value(PUSH_DIRECTION))
    force = controls.value(PUSH_IMPULSE) / PUSH_DURATION
    return PushOrder(
        body=robot.file.pushed[int(controls.value(PUSH_BODY)) - 1],
        force_W=force * np.array([math.cos(angle), math.sin(angle), 0.0]),
        duration=PUSH_DURATION,
    )
