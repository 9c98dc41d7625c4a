"""Initialization of a run, and the reset of a station's systems.

The pose of the robot after a reset is set in ``standing``.
"""

from collections.abc import Sequence
from typing import Any

from pydrake.systems.framework import Context, Diagram

from atlas_drake.diagrams.contact import set_ground_friction
from atlas_drake.diagrams.controller_socket import CONTROLLER
from atlas_drake.messages import Behavior
from atlas_drake.scenario.terrain import Block

_FORGET = (
    "joint_pid_bank",
    "robot_sensors",
    "inertial_sensor",
    "state_estimator",
    "push_source",
    "fall_monitor",
    "tick_recorder",
)
"""Systems that return to a state of rest; a station need not have every one."""
_BEGIN = ("command_interface", CONTROLLER)
"""Systems that restart with a behavior."""


def begin_run(
    station: Diagram,
    root: Context,
    seed: int,
    terrain: Sequence[Block],
    friction: float,
) -> None:
    """Sets the values in a default context that differ between runs."""
    for name in ("robot_sensors", "inertial_sensor"):
        if station.HasSubsystemNamed(name):
            sensor: Any = station.GetSubsystemByName(name)
            sensor.set_seed(sensor.GetMyMutableContextFromRoot(root), seed)
    scene_graph: Any = station.GetSubsystemByName("scene_graph")
    context = scene_graph.GetMyMutableContextFromRoot(root)
    plant = station.GetSubsystemByName("plant")
    set_ground_friction(plant, scene_graph, context, terrain, friction)


def reset_station(station: Diagram, root: Context, behavior: Behavior) -> None:
    """Resets joint controllers, sensors, commands and behaviors."""
    for names, arguments in ((_FORGET, ()), (_BEGIN, (behavior,))):
        for name in names:
            if station.HasSubsystemNamed(name):
                system: Any = station.GetSubsystemByName(name)
                context = system.GetMyMutableContextFromRoot(root)
                if hasattr(system, "reset"):
                    system.reset(context, *arguments)
                else:  # A controller without a reset method.
                    system.SetDefaultContext(context)
