"""The topics of the original, in one table, and what their messages do.

Commands go through ``AtlasSimulation.publish`` like those of any other commander; the
topics that are read are outputs of the station. ``control_mode`` requests a behavior
with all joints, or gives all joints to the user; ``mode`` puts the robot into the
gantry and releases it. Topics that name joints are in ``joint_topics``. Any other
topic is the program's own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import partial
from typing import Any

from atlas_drake.clients.ros_scripts.joint_topics import (
    command_joints,
    follow_trajectory,
    move_joint,
)
from atlas_drake.clients.ros_scripts.message_types import (
    atlas_msgs,
    from_ours,
    osrf_msgs,
    to_ours,
)
from atlas_drake.clients.ros_scripts.ros_message import RosMessage, Time
from atlas_drake.clients.ros_scripts.ros_types import (
    rosgraph_msgs,
    sensor_msgs,
    std_msgs,
    trajectory_msgs,
)
from atlas_drake.clients.ros_scripts.unknown import ScriptError, unknown
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.scenario import Start
from atlas_drake.simulation import AtlasSimulation


def _joint_states(sim: AtlasSimulation) -> RosMessage:
    state = sim.atlas_state
    message: Any = sensor_msgs["JointState"]()
    message.header.stamp = Time.from_sec(state.header.stamp or 0.0)
    message.name = list(sim.robot.joint_names)
    for array in ("position", "velocity", "effort"):
        setattr(message, array, list(getattr(state, array)))
    return message


CONTROL_MODES = {
    "None": Behavior.NONE,
    "Freeze": Behavior.FREEZE,
    "StandPrep": Behavior.STAND_PREP,
    "Stand": Behavior.STAND,
    "Walk": Behavior.WALK,
    "Step": Behavior.STEP,
    "Manip": Behavior.MANIPULATE,
    "User": Behavior.USER,
}
"""Words of ``atlas/control_mode``, in any case."""
HARNESSED, NOMINAL = "harnessed", "nominal"
"""Words of ``atlas/mode``."""
OTHER_MODES = (
    *("bdi_stand", "feet", "no_gravity", "pid_stand"),
    *("pinned", "pinned_with_gravity"),
)
"""Words of the original that have no meaning here."""


def _change_control_mode(sim: AtlasSimulation, message: Any) -> None:
    """Send the command for the behavior that a message names."""
    word = _word(message, "control mode", CONTROL_MODES)
    behavior = CONTROL_MODES[word]
    command = AtlasSimInterfaceCommand()
    command.behavior = behavior
    # The message has no steps, so these behaviors take their demo steps.
    command.walk_params.use_demo_walk = behavior is Behavior.WALK
    command.step_params.use_demo_walk = behavior is Behavior.STEP
    k_effort = K_EFFORT_MAX if behavior is Behavior.USER else 0
    command.k_effort = [k_effort] * sim.robot.num_joints
    sim.publish(command)


def _change_mode(sim: AtlasSimulation, message: Any) -> str | None:
    """Put the robot onto the gantry, or release it."""
    if message.data in OTHER_MODES:
        return f"! mode {message.data!r} has no stand-in; Atlas stays as it is"
    word = _word(message, "mode", (HARNESSED, NOMINAL))
    start = sim.scenario.start
    if word == NOMINAL:
        if start.on_gantry:
            sim.release()
    elif start.on_gantry:
        pose = Start(position=start.position, yaw=start.yaw, on_gantry=True)
        sim.reset(behavior=Behavior.FREEZE, pose=pose)
    else:
        return (
            f"mode {HARNESSED!r}: there is no gantry, and Atlas stays on its feet; "
            "--set start.on_gantry=true --set initial_behavior=FREEZE gives it one"
        )
    return None


def _word(message: Any, what: str, known: Iterable[str]) -> str:
    """Return the known word that a message has, in any case and with underscores."""
    plain = str(message.data).strip().lower().replace("_", "")
    for word in known:
        if word.lower() == plain:
            return word
    raise unknown(f"{what} {message.data!r}", str(message.data), known)


def _atlas_command(sim: AtlasSimulation, message: Any) -> str | None:
    command = to_ours(message, AtlasCommand)
    sim.publish(command)
    if len(command.k_effort) or any(sim.atlas_state.k_effort):
        return None
    return (
        "! This AtlasCommand moves nothing: it has no k_effort, and no joint is the "
        "user's. The original began with all of them: --set initial_behavior=USER"
    )


Table = dict[str, tuple[type[RosMessage], Any]]

WRITE: Table = {
    "/atlas/atlas_command": (atlas_msgs["AtlasCommand"], _atlas_command),
    "/atlas/atlas_sim_interface_command": (
        atlas_msgs["AtlasSimInterfaceCommand"],
        lambda sim, message: sim.publish(to_ours(message, AtlasSimInterfaceCommand)),
    ),
    "/atlas/joint_commands": (osrf_msgs["JointCommands"], command_joints),
    "/atlas/control_mode": (std_msgs["String"], _change_control_mode),
    "/atlas/mode": (std_msgs["String"], _change_mode),
    "/joint_trajectory": (trajectory_msgs["JointTrajectory"], follow_trajectory),
}
"""Topics to publish on: class of the messages, and the function that executes one and
returns a note to print or None."""
READ: Table = {
    "/atlas/atlas_state": (
        atlas_msgs["AtlasState"],
        lambda sim: from_ours(sim.atlas_state),
    ),
    "/atlas/atlas_sim_interface_state": (
        atlas_msgs["AtlasSimInterfaceState"],
        lambda sim: from_ours(sim.atlas_sim_interface_state),
    ),
    "/atlas/imu": (sensor_msgs["Imu"], lambda sim: from_ours(sim.imu)),
    "/atlas/joint_states": (sensor_msgs["JointState"], _joint_states),
    "/joint_states": (sensor_msgs["JointState"], _joint_states),
    "/clock": (
        rosgraph_msgs["Clock"],
        lambda sim: rosgraph_msgs["Clock"](Time.from_sec(sim.time)),
    ),
}
"""Topics to subscribe to: class of the messages, and the function that returns one."""
_ONE_JOINT = re.compile(r"/(\w+)_position_controller/command")
"""Topics of the first versions, one for each joint."""


def find_topic(name: object, kind: object, topics: Table) -> tuple[str, Any]:
    """Return a topic's resolved name, and its function in ``WRITE`` or ``READ``.

    The slash before a name may be missing; ``kind`` is the program's message class.
    The function is None for a topic of the program's own.
    """
    resolved = "/" + str(name).lstrip("/~")
    one_joint = _ONE_JOINT.fullmatch(resolved)
    if one_joint and topics is WRITE:
        move = partial(move_joint, one_joint[1])
        topics = {resolved: (std_msgs["Float64"], move)}
    if resolved not in topics:
        return resolved, None
    expected, function = topics[resolved]
    if not (isinstance(kind, type) and issubclass(kind, expected)):
        given = getattr(kind, "_type", repr(kind))
        raise ScriptError(
            f"topic {resolved} has messages {expected._type}, not {given}"
        )
    return resolved, function
