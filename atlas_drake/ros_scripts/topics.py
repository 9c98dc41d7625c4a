"""The topics of the original, in one table, and what their messages do.

Commands go through ``AtlasSimulation.publish`` like those of any other commander; the
topics that are read are outputs of the station. ``control_mode`` requests a behavior
with all joints, or gives all joints to the user; ``mode`` puts the robot into the
gantry and releases it. ``JointCommands`` is older than ``AtlasCommand``: it names the
joints, in the v1 or the v3 names, with or without the prefix ``atlas::``, and has no
``k_effort``, because its sender controls the named joints.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from atlas_drake.errors import RobotDescriptionError
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.ros_scripts.message_types import (
    JOINT_ARRAYS,
    atlas_msgs,
    from_ours,
    osrf_msgs,
    rosgraph_msgs,
    sensor_msgs,
    std_msgs,
    to_ours,
)
from atlas_drake.ros_scripts.ros_message import RosMessage, Time
from atlas_drake.ros_scripts.unknown import ScriptError, unknown
from atlas_drake.scenario import Start
from atlas_drake.simulation import AtlasSimulation


def joint_name(name: str) -> str:
    """Return ``back_bkz`` for ``atlas::back_bkz``: without the name of the model."""
    return name.rpartition("::")[2]


def _joint_states(sim: AtlasSimulation) -> RosMessage:
    state = sim.atlas_state
    message: Any = sensor_msgs["JointState"]()
    message.header.stamp = Time.from_sec(state.header.stamp or 0.0)
    message.name = list(sim.robot.joint_names)
    for array in ("position", "velocity", "effort"):
        setattr(message, array, list(getattr(state, array)))
    return message


def _joint_commands(sim: AtlasSimulation, message: Any) -> None:
    """Send an ``AtlasCommand`` that puts the named joints under user control.

    Other joints, and arrays that the message leaves empty, keep the values in force.
    """
    try:
        indices = [sim.robot.joint_index(joint_name(name)) for name in message.name]
    except RobotDescriptionError as error:
        raise ScriptError(f"name of osrf_msgs/JointCommands: {error}") from error
    in_force = sim.output("commands").joints
    command = AtlasCommand()
    command.header.stamp = message.header.stamp.to_sec()
    for field in JOINT_ARRAYS:
        values = getattr(message, field)
        if len(values) not in (0, len(indices)):
            raise ScriptError(
                f"{field} of osrf_msgs/JointCommands must have {len(indices)} "
                f"elements, one per name, or none, has {len(values)}"
            )
        if len(values):
            array = np.array(getattr(in_force, field))
            array[indices] = values
            setattr(command, field, array)
    k_effort = np.array(in_force.k_effort)
    k_effort[indices] = K_EFFORT_MAX
    command.k_effort = k_effort
    sim.publish(command)


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


def _sim_interface_command(sim: AtlasSimulation, message: Any) -> None:
    sim.publish(to_ours(message, AtlasSimInterfaceCommand))


def _clock(sim: AtlasSimulation) -> RosMessage:
    return rosgraph_msgs["Clock"](Time.from_sec(sim.time))


WRITE = (
    "publishing on",
    {
        "/atlas/atlas_command": (atlas_msgs["AtlasCommand"], _atlas_command),
        "/atlas/atlas_sim_interface_command": (
            atlas_msgs["AtlasSimInterfaceCommand"],
            _sim_interface_command,
        ),
        "/atlas/joint_commands": (osrf_msgs["JointCommands"], _joint_commands),
        "/atlas/control_mode": (std_msgs["String"], _change_control_mode),
        "/atlas/mode": (std_msgs["String"], _change_mode),
    },
)
"""Topics to publish on: class of the messages, and the function that executes one and
returns a note to print or None."""
READ = (
    "subscribing to",
    {
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
        "/clock": (rosgraph_msgs["Clock"], _clock),
    },
)
"""Topics to subscribe to: class of the messages, and the function that returns one."""


def find_topic(
    name: object, kind: object, direction: tuple[str, dict[str, Any]]
) -> tuple[str, Any]:
    """Return a topic's resolved name, and its function in ``WRITE`` or ``READ``.

    The slash before a name may be missing; ``kind`` is the program's message class.
    """
    verb, topics = direction
    resolved = "/" + str(name).lstrip("/~")
    if resolved not in topics:
        raise unknown(f"{verb} topic {name!r}", resolved, topics)
    expected, function = topics[resolved]
    if not (isinstance(kind, type) and issubclass(kind, expected)):
        given = getattr(kind, "_type", repr(kind))
        raise ScriptError(
            f"topic {resolved} has messages {expected._type}, not {given}"
        )
    return resolved, function
