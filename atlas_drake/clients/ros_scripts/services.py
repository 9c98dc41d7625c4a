"""Services of the simulator that have a meaning here: pause, continue, reset."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from atlas_drake.clients.ros_scripts.clock import Clock, RosError
from atlas_drake.clients.ros_scripts.ros_message import RosMessage
from atlas_drake.clients.ros_scripts.ros_types import std_srvs
from atlas_drake.clients.ros_scripts.unknown import ScriptError, unknown


class ServiceError(ScriptError, RosError):
    """``rospy.ServiceException``: a service without a stand-in was called."""


def _reset(clock: Clock) -> None:
    with clock.undisturbed():
        clock.sim.reset()


def _set_paused(paused: bool, clock: Clock) -> None:
    clock.paused = paused


SERVICES: dict[str, Callable[[Clock], None]] = {
    "/gazebo/pause_physics": partial(_set_paused, True),
    "/gazebo/unpause_physics": partial(_set_paused, False),
    **dict.fromkeys(
        (
            "/gazebo/reset_models",
            "/gazebo/reset_simulation",
            "/gazebo/reset_world",
        ),
        _reset,
    ),
}
"""The services, which are of type ``std_srvs/Empty``, and what they do."""


def find_service(name: object) -> Callable[[Clock], None]:
    """Return what a service does; the slash before its name may be missing."""
    resolved = "/" + str(name).lstrip("/")
    if resolved not in SERVICES:
        raise unknown(f"service {name!r}", resolved, SERVICES, ServiceError)
    return SERVICES[resolved]


class ServiceProxy:
    """``rospy.ServiceProxy``."""

    def __init__(self, clock: Clock, name: str, *_options: object, **_: object) -> None:
        """Makes a proxy; a service without a stand-in is an error when called."""
        self.resolved_name, self._clock = str(name), clock

    def __call__(self, *_request: Any) -> RosMessage:
        """Calls the service, which takes no time."""
        find_service(self.resolved_name)(self._clock)
        return std_srvs["EmptyResponse"]()

    call = __call__
