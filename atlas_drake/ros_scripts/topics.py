"""The topics of the original, in one table, and what their messages do.

Commands go through ``AtlasSimulation.publish`` like those of any other commander; the
topics that are read are outputs of the station. ``control_mode`` requests a behavior
with all joints, or gives all joints to the user; ``mode`` puts the robot into the
gantry and releases it. ``JointCommands`` is older than ``AtlasCommand``: it names the
joints, in the v1 or the v3 names, with or without the prefix ``atlas::``, and has no
``k_effort``, because its sender controls the named joints.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from atlas_drake.errors import RobotDescriptionError
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.robot import Robot
from atlas_drake.ros_scripts.conversion import from_ours, to_ours
from atlas_drake.ros_scripts.message_types import (
    JOINT_ARRAYS,
    atlas_msgs,
    osrf_msgs,
    rosgraph_msgs,
    sensor_msgs,
    std_msgs,
)
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.ros_time import Time
from atlas_drake.ros_scripts.unknown import ScriptError, unknown
from atlas_drake.scenario import Start
from atlas_drake.simulation import AtlasSimulation


def joint_states(sim: AtlasSimulation) -> RosMessage:
    """Return names, positions, velocities and efforts of all joints."""
    state = sim.atlas_state
    message: Any = sensor_msgs["JointState"]()
    message.header.stamp = Time.from_sec(state.header.stamp or 0.0)
    message.name = list(sim.robot.joint_names)
    message.position = list(state.position)
    message.velocity = list(state.velocity)
    message.effort = list(state.effort)
    return message


def joint_commands(sim: AtlasSimulation, message: RosMessage) -> None:
    """Send an ``AtlasCommand`` that puts the named joints under user control.

    Other joints, and arrays that the message leaves empty, keep the values in force.

    Raises:
        ScriptError: If a name is not a joint of the robot, or an array does not have
            one number per name.
    """
    given: Any = message
    indices = [_index(sim.robot, str(name), i) for i, name in enumerate(given.name)]
    in_force = sim.output("commands").joints
    command = AtlasCommand()
    command.header.stamp = given.header.stamp.to_sec()
    for field in JOINT_ARRAYS:
        values = getattr(given, field)
        if len(values) == 0:
            continue
        if len(values) != len(indices):
            raise ScriptError(
                f"{field} of osrf_msgs/JointCommands must have {len(indices)} "
                f"elements, one per name, or none, has {len(values)}"
            )
        setattr(command, field, _at(indices, values, getattr(in_force, field)))
    command.k_effort = _at(indices, [K_EFFORT_MAX] * len(indices), in_force.k_effort)
    sim.publish(command)


def joint_name(name: str) -> str:
    """Return ``back_bkz`` for ``atlas::back_bkz``: without the name of the model."""
    return name.rpartition("::")[2]


def _index(robot: Robot, name: str, place: int) -> int:
    try:
        return robot.joint_index(joint_name(name))
    except RobotDescriptionError as error:
        problem = f"name[{place}] of osrf_msgs/JointCommands: {error.problem}"
        raise ScriptError(problem) from error


def _at(indices: list[int], values: Any, others: Any) -> list[Any]:
    """Return ``others`` with ``values`` at ``indices``."""
    result = list(others)
    for index, value in zip(indices, values, strict=True):
        result[index] = value
    return result


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


def change_control_mode(sim: AtlasSimulation, message: RosMessage) -> None:
    """Send the command for the behavior that a message names.

    Raises:
        ScriptError: If there is no such mode.
    """
    word = _word(message)
    known = {_plain(name): behavior for name, behavior in CONTROL_MODES.items()}
    known |= {_plain(b.name): b for b in CONTROL_MODES.values()}
    if _plain(word) not in known:
        raise unknown(f"control mode {word!r}", word, CONTROL_MODES)
    behavior = known[_plain(word)]
    command = AtlasSimInterfaceCommand()
    command.behavior = behavior
    # The message has no steps, so these behaviors take their demo steps.
    command.walk_params.use_demo_walk = behavior is Behavior.WALK
    command.step_params.use_demo_walk = behavior is Behavior.STEP
    share = K_EFFORT_MAX if behavior is Behavior.USER else 0
    command.k_effort = [share] * sim.robot.num_joints
    sim.publish(command)


def change_mode(sim: AtlasSimulation, message: RosMessage) -> str | None:
    """Put the robot onto the gantry, or release it.

    Returns:
        A note to print, if the robot stays as it is.

    Raises:
        ScriptError: If there is no such mode.
    """
    word = _word(message)
    if _plain(word) not in (HARNESSED, NOMINAL):
        raise unknown(f"mode {word!r}", word, (HARNESSED, NOMINAL))
    has_gantry = sim.scenario.start.on_gantry
    if _plain(word) == NOMINAL:
        if has_gantry:
            sim.release()
        return None
    if not has_gantry:
        return (
            f"mode {HARNESSED!r}: there is no gantry, and Atlas stays on its feet; "
            "--set start.on_gantry=true --set initial_behavior=FREEZE gives it one"
        )
    start = sim.scenario.start
    pose = Start(position=start.position, yaw=start.yaw, on_gantry=True)
    sim.reset(behavior=Behavior.FREEZE, pose=pose)
    return None


def _word(message: RosMessage) -> str:
    said: Any = message
    return str(said.data)


def _plain(word: str) -> str:
    return word.strip().lower().replace("_", "")


@dataclass(frozen=True)
class Topic:
    """One topic.

    Attributes:
        type: Class of the messages.
        read: Returns the latest message; None if the topic cannot be subscribed to.
        write: Executes a message and returns a note to print, if any; None if the topic
            cannot be published on.
    """

    type: type[RosMessage]
    read: Callable[[AtlasSimulation], RosMessage] | None = None
    write: Callable[[AtlasSimulation, RosMessage], str | None] | None = None


def _atlas_command(sim: AtlasSimulation, message: RosMessage) -> str | None:
    command = to_ours(message, AtlasCommand)
    sim.publish(command)
    if len(command.k_effort) or any(sim.atlas_state.k_effort):
        return None
    return (
        "! This AtlasCommand moves nothing: it has no k_effort, and no joint is the "
        "user's. The original began with all of them: --set initial_behavior=USER"
    )


def _sim_interface_command(sim: AtlasSimulation, message: RosMessage) -> None:
    sim.publish(to_ours(message, AtlasSimInterfaceCommand))


def _clock(sim: AtlasSimulation) -> RosMessage:
    return rosgraph_msgs["Clock"](clock=Time.from_sec(sim.time))


TOPICS = {
    "/atlas/atlas_command": Topic(
        atlas_msgs["AtlasCommand"],
        write=_atlas_command,
    ),
    "/atlas/atlas_sim_interface_command": Topic(
        atlas_msgs["AtlasSimInterfaceCommand"],
        write=_sim_interface_command,
    ),
    "/atlas/joint_commands": Topic(osrf_msgs["JointCommands"], write=joint_commands),
    "/atlas/control_mode": Topic(std_msgs["String"], write=change_control_mode),
    "/atlas/mode": Topic(std_msgs["String"], write=change_mode),
    "/atlas/atlas_state": Topic(
        atlas_msgs["AtlasState"], read=lambda sim: from_ours(sim.atlas_state)
    ),
    "/atlas/atlas_sim_interface_state": Topic(
        atlas_msgs["AtlasSimInterfaceState"],
        read=lambda sim: from_ours(sim.atlas_sim_interface_state),
    ),
    "/atlas/imu": Topic(sensor_msgs["Imu"], read=lambda sim: from_ours(sim.imu)),
    "/atlas/joint_states": Topic(sensor_msgs["JointState"], read=joint_states),
    "/joint_states": Topic(sensor_msgs["JointState"], read=joint_states),
    "/clock": Topic(rosgraph_msgs["Clock"], read=_clock),
}
"""All topics by resolved name."""


def find_topic(name: object, kind: object, *, to_write: bool) -> tuple[str, Topic]:
    """Return a topic's resolved name and the topic.

    Args:
        name: Name in the program, with or without the leading slash.
        kind: Class of the messages in the program.
        to_write: True to publish, False to subscribe.

    Raises:
        ScriptError: If there is no such topic, or its messages have another type.
    """
    usable = {
        key: topic
        for key, topic in TOPICS.items()
        if (topic.write if to_write else topic.read) is not None
    }
    resolved = "/" + str(name).lstrip("/~")
    if resolved not in usable:
        verb = "publishing on" if to_write else "subscribing to"
        raise unknown(f"{verb} topic {name!r}", resolved, usable)
    topic = usable[resolved]
    if not (isinstance(kind, type) and issubclass(kind, topic.type)):
        given = getattr(kind, "_type", repr(kind))
        raise ScriptError(
            f"topic {resolved} has messages {topic.type._type}, not {given}"
        )
    return resolved, topic
