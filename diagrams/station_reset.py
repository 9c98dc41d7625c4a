"""What a station forgets when its robot is put back on its feet.

Who of its systems remembers what; where the robot is put is not decided here.
"""

from typing import Any

from pydrake.systems.framework import Context, Diagram

from atlas_drake.diagrams.controller_socket import CONTROLLER
from atlas_drake.messages import Behavior

_FORGET = ("joint_pid_bank", "robot_sensors", "inertial_sensor", "state_estimator")
"""Systems that forget all; a station need not have every one."""
_BEGIN = ("command_interface", CONTROLLER)
"""Systems that begin anew with a behavior."""


def reset_station(station: Diagram, root: Context, behavior: Behavior) -> None:
    """Lets joint controllers, sensors, commands and behaviours begin anew.

    Args:
        station: An AtlasStation.
        root: Context of the diagram that holds it.
        behavior: The behaviour to begin with.
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
