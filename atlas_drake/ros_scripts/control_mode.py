"""The topics ``atlas/control_mode`` and ``atlas/mode``, whose messages are words.

``control_mode`` requests a behavior with all joints, or gives all joints to the user.
``mode`` puts the robot into the harness and releases it.
"""

from __future__ import annotations

from typing import Any

from atlas_drake.messages import K_EFFORT_MAX, AtlasSimInterfaceCommand, Behavior
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.unknown import unknown
from atlas_drake.scenario import Start
from atlas_drake.simulation import AtlasSimulation

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
    """Put the robot into the harness, or release it.

    Returns:
        A note to print, if the robot stays as it is.

    Raises:
        ScriptError: If there is no such mode.
    """
    word = _word(message)
    if _plain(word) not in (HARNESSED, NOMINAL):
        raise unknown(f"mode {word!r}", word, (HARNESSED, NOMINAL))
    harness = sim.scenario.start.harnessed
    if _plain(word) == NOMINAL:
        if harness:
            sim.release()
        return None
    if not harness:
        return (
            f"mode {HARNESSED!r}: there is no harness, and Atlas stays on its feet; "
            "--set start.harnessed=true --set initial_behavior=FREEZE gives it one"
        )
    start = sim.scenario.start
    pose = Start(position=start.position, yaw=start.yaw, harnessed=True)
    sim.reset(behavior=Behavior.FREEZE, pose=pose)
    return None


def _word(message: RosMessage) -> str:
    said: Any = message
    return str(said.data)


def _plain(word: str) -> str:
    return word.strip().lower().replace("_", "")
