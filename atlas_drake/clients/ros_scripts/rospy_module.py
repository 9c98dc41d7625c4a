"""The names of ``rospy``, for one run.

Publishers, subscribers and waits are in ``node``, time is in ``clock``. The module
object is made in ``world``.
"""

from __future__ import annotations

import copy
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from atlas_drake.clients.ros_scripts.clock import Clock, RosError, RosInterruptError
from atlas_drake.clients.ros_scripts.joint_topics import joint_name
from atlas_drake.clients.ros_scripts.network import Network
from atlas_drake.clients.ros_scripts.node import (
    Publisher,
    Rate,
    Subscriber,
    sleep,
    spin,
    wait_for_message,
)
from atlas_drake.clients.ros_scripts.ros_message import Duration
from atlas_drake.clients.ros_scripts.ros_message import Time as RosTime
from atlas_drake.clients.ros_scripts.services import (
    ServiceError,
    ServiceProxy,
    find_service,
)
from atlas_drake.clients.ros_scripts.unknown import UnknownNameError, unknown
from atlas_drake.robot import Robot

GAINS = "atlas_controller/gains"
"""Path of the joint controllers' default gains: .../JOINT/p, i, d, i_clamp."""
_NOT_GIVEN = object()


class NoParameterError(UnknownNameError, KeyError):
    """A parameter that does not exist, requested without a default."""

    def __str__(self) -> str:
        """Return the message without the quotes of ``KeyError``."""
        return str(self.args[0])


class Parameters:
    """The parameters of one run, a tree of groups."""

    def __init__(self, robot: Robot, resolve: Callable[[str], str]) -> None:
        """Reads the robot's gains, by the v3 and the v1 names of the joints.

        ``resolve`` returns the full name of a parameter, such as ``/node/x`` of ``~x``.
        """
        kp, kd = robot.default_kp.tolist(), robot.default_kd.tolist()
        gains = {
            name: {"p": kp[index], "i": 0.0, "d": kd[index], "i_clamp": 0.0}
            for name, index in vars(robot.joints).items()
        }
        self._resolve = resolve
        self._tree: dict[str, Any] = {"use_sim_time": True}
        self.set(f"/{GAINS}", gains)

    def get(self, name: str, default: Any = _NOT_GIVEN) -> Any:
        """Returns a parameter, or a dict of all in a group."""
        value: Any = self._tree
        for part in self._path(name):
            if not isinstance(value, dict) or part not in value:
                if default is not _NOT_GIVEN:
                    return default
                known = [*self._tree, f"{GAINS}/JOINT/p"]
                raise unknown(f"parameter {name!r}", name, known, NoParameterError)
            value = value[part]
        return copy.deepcopy(value)

    def has(self, name: str) -> bool:
        """Tells whether a parameter or a group exists."""
        return self.get(name, self) is not self

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter, or by a dict a group; the robot does not read it."""
        *groups, last = self._path(name)
        group = self._tree
        for part in groups:
            group = group.setdefault(part, {})
        group[last] = copy.deepcopy(value)

    def _path(self, name: str) -> list[str]:
        return [joint_name(part) for part in self._resolve(name).split("/") if part]


LEVELS = {"DEBUG": 1, "INFO": 2, "WARN": 4, "ERROR": 8, "FATAL": 16}
"""Levels of log messages; DEBUG is not shown."""
LOGGERS = {"info": "INFO", "warn": "WARN", "err": "ERROR", "fatal": "FATAL"}
"""Levels by the endings of ``rospy.loginfo`` and related functions."""


class RosNode:
    """The node of one program."""

    def __init__(self, clock: Clock, say: Callable[[str], object]) -> None:
        """Makes a node without a name; ``say`` prints a line."""
        self._clock, self._say = clock, say
        self._name = "unnamed"
        self._at_end: list[Callable[..., object]] = []

    def names(self) -> dict[str, Any]:
        """Returns the contents of the module ``rospy``."""
        clock, network = self._clock, Network(self._clock, self._say)
        parameters = Parameters(clock.sim.robot, self._resolve)

        class Time(RosTime):
            """``rospy.Time``."""

            __slots__ = ()

            @staticmethod
            def now() -> RosTime:
                """Return the simulated time."""
                return Time.from_sec(clock.now())

        return {
            **LEVELS,
            **{f"log{end}": partial(self._log, LOGGERS[end]) for end in LOGGERS},
            "init_node": self._init,
            "get_name": lambda: f"/{self._name}",
            "myargv": _own_arguments,
            "Publisher": partial(Publisher, network),
            "Subscriber": partial(Subscriber, network),
            "wait_for_message": partial(wait_for_message, network),
            "Rate": partial(Rate, clock),
            "Time": Time,
            "Duration": Duration,
            "sleep": partial(sleep, clock),
            "spin": partial(spin, clock),
            "get_time": clock.now,
            "get_rostime": Time.now,
            "is_shutdown": self._is_shut_down,
            "on_shutdown": self._at_end.append,
            "signal_shutdown": self._shut_down,
            "ROSException": RosError,
            "ServiceException": ServiceError,
            "ServiceProxy": partial(ServiceProxy, clock),
            "wait_for_service": lambda name, _timeout=None: find_service(name),
            "ROSInterruptException": RosInterruptError,
            "get_param": parameters.get,
            "has_param": parameters.has,
            "set_param": parameters.set,
            "logdebug": lambda *_arguments: None,
        }

    def end(self) -> None:
        """Calls the functions given to ``on_shutdown``, once."""
        while self._at_end:
            self._at_end.pop(0)()

    def _init(self, name: str, *_arguments: object, **_options: object) -> None:
        """Sets the name; meanwhile earlier subscribers get their first message."""
        self._name = str(name).lstrip("/")
        self._clock.advance_to(self._clock.sim.time + self._clock.period)

    def _resolve(self, name: str) -> str:
        """Return a full name; those that begin with ~ are the node's own."""
        own = str(name).removeprefix("~")
        return f"/{self._name}/{own}" if own != name else own

    def _is_shut_down(self) -> bool:
        self._clock.count_query()
        return self._clock.over

    def _shut_down(self, reason: object = "") -> None:
        self._clock.shut_down()
        self.end()

    def _log(self, level: str, text: object, *arguments: object, **_: object) -> None:
        line = str(text) % arguments if arguments else str(text)
        self._say(f"[{level}] [{self._clock.sim.time:.3f}]: {line}")


def _own_arguments(argv: Sequence[str] | None = None) -> list[str]:
    """``rospy.myargv``: the arguments without remappings."""
    return [os.fspath(word) for word in argv or sys.argv if ":=" not in word]
