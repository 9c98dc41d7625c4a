"""What differs from run to run, and what a reset of the robot forgets.

Who of its systems remembers what; where the robot is put is not decided here.
"""

from collections.abc import Sequence
from typing import Any

from pydrake.systems.framework import Context, Diagram

from atlas_drake.diagrams.controller_socket import CONTROLLER
from atlas_drake.diagrams.ground_friction import set_ground_friction
from atlas_drake.messages import Behavior
from atlas_drake.scenario.terrain import Block

_FORGET = ("joint_pid_bank", "robot_sensors", "inertial_sensor", "state_estimator")
"""Systems that forget all; a station need not have every one."""
_BEGIN = ("command_interface", CONTROLLER)
"""Systems that begin anew with a behavior."""


def begin_run(
    station: Diagram,
    root: Context,
    seed: int,
    terrain: Sequence[Block],
    friction: float,
) -> None:
    """Gives a default context what differs from run to run.

    Args:
        station: An AtlasStation.
        root: Context of the diagram that holds it.
        seed: Of the sensors' noise.
        terrain: Blocks on the ground.
        friction: Coefficient of the ground [-].
    """
    for name in ("robot_sensors", "inertial_sensor"):
        if station.HasSubsystemNamed(name):
            sensor: Any = station.GetSubsystemByName(name)
            sensor.set_seed(sensor.GetMyMutableContextFromRoot(root), seed)
    scene_graph: Any = station.GetSubsystemByName("scene_graph")
    context = scene_graph.GetMyMutableContextFromRoot(root)
    plant = station.GetSubsystemByName("plant")
    set_ground_friction(plant, scene_graph, context, terrain, friction)


def reset_station(station: Diagram, root: Context, behavior: Behavior) -> None:
    """Lets joint controllers, sensors, commands and behaviors begin anew.

    Args:
        station: An AtlasStation.
        root: Context of the diagram that holds it.
        behavior: The behavior to begin with.
    """
    for names, arguments in ((_FORGET, ()), (_BEGIN, (behavior,))):
        for name in names:
            if station.HasSubsystemNamed(name):
                system: Any = station.GetSubsystemByName(name)
                context = system.GetMyMutableContextFromRoot(root)
                if hasattr(system, "reset"):
                    system.reset(context, *arguments)
                else:  # A controller that knows nothing of resets.
                    system.SetDefaultContext(context)
