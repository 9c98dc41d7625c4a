"""The topics of the original, in one table.

Commands go through ``AtlasSimulation.publish`` like those of any other commander; the
topics that are read are outputs of the station.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from atlas_drake.messages import AtlasCommand, AtlasSimInterfaceCommand
from atlas_drake.ros_scripts.control_mode import change_control_mode, change_mode
from atlas_drake.ros_scripts.conversion import from_ours, to_ours
from atlas_drake.ros_scripts.joint_topics import joint_commands, joint_states
from atlas_drake.ros_scripts.message_types import (
    atlas_msgs,
    osrf_msgs,
    rosgraph_msgs,
    sensor_msgs,
    std_msgs,
)
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.ros_time import Time
from atlas_drake.ros_scripts.unknown import ScriptError, unknown
from atlas_drake.simulation import AtlasSimulation


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
