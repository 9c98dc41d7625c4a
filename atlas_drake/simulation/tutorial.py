"""The tutorial's command schedule: switching Atlas between user and behavior control.

The commands and their times, message by message. ``systems.command_scheduler`` sends
them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from pydrake.common.eigen_geometry import Quaternion as DrakeQuaternion
from pydrake.math import RigidTransform

from atlas_drake.errors import ScenarioError
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Pose,
    Quaternion,
    Vector3,
)
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import ATLAS, Robot
from atlas_drake.scenario import Scenario
from atlas_drake.systems.command_scheduler import Feedback, ScheduledCommand

FIRST_COMMAND = 2.0
"""Time of the first command; the robot stands by itself until then [s]."""
DURATION = 17.0
"""Duration of the schedule, from the start to the end of the last motion [s]."""

_TRUNK = {"back_bkz": 20.0, "back_bky": 4000.0, "back_bkx": 2000.0, "neck_ry": 20.0}
_LEG = {"hpz": 5.0, "hpx": 100.0, "hpy": 2000.0, "kny": 1000.0, "aky": 900.0}
_LEG |= {"akx": 300.0}
_ARM = {"shy": 2000.0, "shx": 1000.0, "ely": 200.0, "elx": 200.0, "wry": 50.0}
_ARM |= {"wrx": 100.0}
KP_POSITION = _TRUNK | {
    f"{side}_{limb}_{joint}": gain
    for limb, gains in (("leg", _LEG), ("arm", _ARM))
    for side in ("l", "r")
    for joint, gain in gains.items()
}
"""Position gains of the commands with gains, by joint [N·m/rad]."""
KP_VELOCITY = 50.0
"""Velocity gain of every joint in the commands with gains [N·m·s/rad]."""

USER_TARGETS = {
    "neck_ry": -0.1,
    "l_arm_ely": 2.1,
    "l_arm_wrx": -0.1,
    "r_arm_ely": 2.1,
    "r_arm_wrx": -0.1,
}
"""Target positions of the joints under user control while the behavior stands and walks
[rad]."""

NEEDED = [name for name in KP_POSITION if "_arm_" not in name or name in USER_TARGETS]
"""Joints of Atlas and its kin, by name or alias. Other joints of the arms may differ;
they get the robot's own gains."""
MOVED = {"neck": (0,), "l_arm": (2, -1), "r_arm": (2, -1)}
"""Joints of any other robot that the user moves, by limb and place in it."""
WAY = 0.1
"""Way of such a joint from the stand-prep pose [rad]."""


class TutorialStep(NamedTuple):
    """A step of the tutorial, for people who watch it."""

    begin: float  # Time of its first command [s].
    title: str
    text: str


STEPS = (
    TutorialStep(
        FIRST_COMMAND,
        "Stand prep",
        "You have every joint; your joint controllers go to the pose from which the "
        "robot can stand.",
    ),
    TutorialStep(
        FIRST_COMMAND + 2.0,
        "Stand",
        "The behavior warms up beside you, then gets every joint and balances.",
    ),
    TutorialStep(
        FIRST_COMMAND + 5.0,
        "Arms and neck",
        "You take neck and arms and move them; the behavior stands with the rest.",
    ),
    TutorialStep(
        FIRST_COMMAND + 7.0,
        "Walk",
        "The behavior takes four steps while neck and arms stay yours.",
    ),
    TutorialStep(
        FIRST_COMMAND + 13.0,
        "Home",
        "You have every joint again; all go home, on the legs alone.",
    ),
)
"""The steps of the tutorial, in order."""
NUM_STEPS = 4
STEP_LENGTH = 0.25
"""Length of each step [m]."""
STEP_DURATION = 0.63
"""Duration of each step [s]."""
SWING_HEIGHT = 0.3
"""Swing height of each step [m]."""
HALF_STANCE = 0.15
"""Sideways distance of each foot from the robot's middle [m]."""


def tutorial_schedule(robot: Robot, literal: bool = False) -> list[ScheduledCommand]:
    """Makes the commands of the whole tutorial, with their times.

    The published script sends the arm command, ``literal``, without the velocity gains
    that its comment intends. Robots without Atlas' joints move those of the same limbs,
    with their own gains, and take steps of their size. Raises ScenarioError if a robot
    has not two arms.
    """
    n = robot.num_joints
    targets = _user_targets(robot)
    user_k_effort = [0] * n
    for joint in targets:
        user_k_effort[joint] = K_EFFORT_MAX

    stand_prep = AtlasCommand()
    stand_prep.position = robot.stand_prep.tolist()
    stand_prep.velocity = [0.0] * n
    stand_prep.effort = [0.0] * n
    stand_prep.k_effort = [K_EFFORT_MAX] * n

    warm_up = AtlasSimInterfaceCommand()
    warm_up.behavior = warm_up.STAND_PREP
    warm_up.k_effort = [K_EFFORT_MAX] * n

    stand = AtlasSimInterfaceCommand()
    stand.behavior = stand.STAND
    stand.k_effort = [0] * n

    arms = _posture(robot, None if literal else KP_VELOCITY)
    for joint, position in targets.items():
        arms.position[joint] = position
    arms.k_effort = user_k_effort

    def walk(feedback: Feedback) -> AtlasSimInterfaceCommand:
        message = walk_command(feedback, _size(robot), 0.5 * _stance(robot))
        message.k_effort = user_k_effort
        return message

    home = _posture(robot, KP_VELOCITY)
    home.k_effort = [K_EFFORT_MAX] * n

    t = FIRST_COMMAND
    return [
        ScheduledCommand(t, stand_prep, "[USER] Going to stand prep position..."),
        ScheduledCommand(t + 2.0, warm_up, "[USER] Warming up BDI stand..."),
        ScheduledCommand(t + 3.0, stand, "[BDI] Standing..."),
        ScheduledCommand(t + 5.0, arms, "[USER/BDI] Command neck and arms..."),
        ScheduledCommand(t + 7.0, walk, "[USER/BDI] Walking..."),
        ScheduledCommand(t + 13.0, home, "[USER] Going to home position..."),
    ]


def _has_atlas_joints(robot: Robot) -> bool:
    known = {name for joint in robot.file.joints for name in (joint.name, joint.alias)}
    return known.issuperset(NEEDED)


def _user_targets(robot: Robot) -> dict[int, float]:
    """Returns the joints that the user moves, and their target positions [rad]."""
    if _has_atlas_joints(robot):
        return {robot.joint_index(name): at for name, at in USER_TARGETS.items()}
    targets = {}
    for limb, places in MOVED.items():
        joints = np.flatnonzero(robot.limb(limb))
        if not len(joints) and limb != "neck":
            raise ScenarioError(
                "schedule",
                "tutorial",
                f"the tutorial moves two arms, and robot '{robot.name}' has no joint "
                f"of limb {limb}; choose schedule: none",
            )
        for place in places if len(joints) else ():
            joint = int(joints[min(place, len(joints) - 1)])
            goal = robot.stand_prep[joint] + (WAY if place > 0 else -WAY)
            low, high = robot.position_lower[joint], robot.position_upper[joint]
            targets[joint] = float(min(max(goal, low), high))
    return targets


def _size(robot: Robot) -> float:
    """Returns the size by which steps scale: 1 for Atlas and its kin [-]."""
    return robot.com_height / ATLAS.height if robot.file.scaled else 1.0


def _stance(robot: Robot) -> float:
    return robot.stance_width if robot.file.scaled else 2.0 * HALF_STANCE


def _posture(robot: Robot, kp_velocity: float | None) -> AtlasCommand:
    """Makes a command of all joints to zero with the tutorial's gains.

    Robots without Atlas' joints keep their stand-prep pose, with their own gains: with
    straight legs and unknown gains few stand.
    """
    message, num_joints = AtlasCommand(), robot.num_joints
    if not _has_atlas_joints(robot):
        message.position = robot.stand_prep.tolist()
        message.velocity = message.effort = [0.0] * num_joints
        return message
    message.position = [0.0] * num_joints
    message.velocity = [0.0] * num_joints
    message.effort = [0.0] * num_joints
    message.kp_position = [
        KP_POSITION.get(joint.name, KP_POSITION.get(joint.alias, joint.kp))
        for joint in robot.file.joints
    ]
    message.ki_position = [0.0] * num_joints
    message.kd_position = [0.0] * num_joints
    if kp_velocity is not None:
        message.kp_velocity = [kp_velocity] * num_joints
    message.i_effort_min = [0.0] * num_joints
    message.i_effort_max = [0.0] * num_joints
    return message


def walk_command(
    feedback: Feedback, size: float = 1.0, half_stance: float = HALF_STANCE
) -> AtlasSimInterfaceCommand:
    """Makes a command of four steps ahead, with the feet side by side at the end.

    The steps are defined in the robot's frame, and transformed to the world frame with
    the IMU's orientation and the estimated position of the pelvis at the time of the
    command. Lengths are Atlas' times ``size`` [-], durations times its root;
    ``half_stance`` is the sideways distance of each foot from the middle [m].
    """
    message = AtlasSimInterfaceCommand()
    message.behavior = message.WALK
    message.walk_params.use_demo_walk = False
    orientation = feedback.imu.orientation
    position = feedback.atlas_sim_interface_state.pos_est.position
    X_WP = RigidTransform(DrakeQuaternion(orientation.to_wxyz()), position.to_array())
    for i in range(NUM_STEPS):
        step = AtlasBehaviorStepData()
        step.step_index = i + 1
        step.foot_index = i % 2
        step.swing_height = SWING_HEIGHT * size
        step.duration = STEP_DURATION * math.sqrt(size)
        side = half_stance if step.foot_index == 0 else -half_stance
        p_PF = np.array([(1 + i // 2) * STEP_LENGTH * size, side, 0.0])
        step.pose = pose_message(X_WP @ RigidTransform(p_PF))
        message.walk_params.step_queue[i] = step
    return message


def pose_message(X_WF: RigidTransform) -> Pose:
    """Converts a pose to its message."""
    return Pose(
        position=Vector3.from_array(X_WF.translation()),
        orientation=Quaternion.from_wxyz(X_WF.rotation().ToQuaternion().wxyz()),
    )


def scheduled(
    scenario: Scenario, robot: Robot, catalog: BehaviorCatalog
) -> tuple[ScheduledCommand, ...]:
    """Returns the tutorial's and the scenario's own commands, in order of time.

    Args:
        scenario: Says whether the tutorial is played, and has messages.
        robot: Of the scenario.
        catalog: Its behaviors.
    """
    schedule = []
    if scenario.schedule != "none":
        literal = scenario.schedule == "tutorial_literal"
        schedule = tutorial_schedule(robot, literal)
    for index, entry in enumerate(scenario.messages):
        message = entry.message(robot, f"messages[{index}]", catalog)
        if isinstance(message, AtlasCommand):
            kind = "joint command"
        else:
            kind = catalog.find(message.behavior, "behavior").name
        text = entry.text or f"[{kind}]"
        schedule.append(ScheduledCommand(entry.time, message, text))
    return tuple(sorted(schedule, key=lambda entry: entry.time))
