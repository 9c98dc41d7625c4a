"""The names of ``rospy``, for one run.

Their code is in ``node``, ``waiting``, ``parameters`` and ``clock``. The module object
is made in ``stand_ins``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from atlas_drake.ros_scripts import waiting
from atlas_drake.ros_scripts.clock import Clock, RosError, RosInterruptError
from atlas_drake.ros_scripts.node import Publisher, Subscriber
from atlas_drake.ros_scripts.parameters import Parameters
from atlas_drake.ros_scripts.ros_time import Duration
from atlas_drake.ros_scripts.ros_time import Time as RosTime

LEVELS = {"DEBUG": 1, "INFO": 2, "WARN": 4, "ERROR": 8, "FATAL": 16}
"""Levels of log messages; DEBUG is not shown."""
LOGGERS = {
    "debug": "DEBUG",
    "info": "INFO",
    "warn": "WARN",
    "err": "ERROR",
    "fatal": "FATAL",
}
"""Levels by the endings of ``rospy.loginfo`` and related functions."""


class RosNode:
    """The node of one program."""

    def __init__(self, clock: Clock, say: Callable[[str], object]) -> None:
        """Makes a node without a name.

        Args:
            clock: Clock of the run.
            say: Prints a line.
        """
        self._clock, self._say = clock, say
        self._name = "unnamed"
        self._at_end: list[Callable[..., object]] = []
        self._parameters = Parameters(clock.sim, self._resolve)

    def init_node(self, name: str, *_arguments: object, **_options: object) -> None:
        """Sets the name; the registration takes one control period."""
        self._name = str(name).lstrip("/")
        self._clock.advance_to(self._clock.sim.time + self._clock.period)

    def names(self) -> dict[str, Any]:
        """Returns the contents of the module ``rospy``."""
        clock, parameters = self._clock, self._parameters
        time = self._time_class()
        return {
            **LEVELS,
            "init_node": self.init_node,
            "get_name": lambda: f"/{self._name}",
            "myargv": _own_arguments,
            "Publisher": partial(Publisher, clock, self._say),
            "Subscriber": partial(Subscriber, clock),
            "wait_for_message": partial(waiting.wait_for_message, clock),
            "Rate": partial(waiting.Rate, clock),
            "Timer": partial(waiting.Timer, clock),
            "Time": time,
            "Duration": Duration,
            "sleep": partial(waiting.sleep, clock),
            "spin": partial(waiting.spin, clock),
            "get_time": lambda: clock.now,
            "get_rostime": time.now,
            "is_shutdown": self._is_shut_down,
            "on_shutdown": self._at_end.append,
            "signal_shutdown": self._shut_down,
            "ROSException": RosError,
            "ROSInterruptException": RosInterruptError,
            "get_param": self._get_param,
            "has_param": parameters.has,
            "set_param": parameters.set,
            **{
                f"log{name}": partial(self._log, level)
                for name, level in LOGGERS.items()
            },
        }

    def end(self) -> None:
        """Calls the functions given to ``on_shutdown``, once."""
        while self._at_end:
            self._at_end.pop(0)()

    def _time_class(self) -> Any:
        clock = self._clock

        class Time(RosTime):
            """``rospy.Time``."""

            __slots__ = ()

            @staticmethod
            def now() -> RosTime:
                """Return the simulated time."""
                return Time.from_sec(clock.now)

        return Time

    def _resolve(self, name: str) -> str:
        """Return a full name; those that begin with ~ are the node's own."""
        own = str(name).removeprefix("~")
        return f"/{self._name}/{own}" if own != name else "/" + own.lstrip("/")

    def _is_shut_down(self) -> bool:
        self._clock.glance()
        return self._clock.over

    def _shut_down(self, reason: object = "") -> None:
        self._clock.shut_down()
        self.end()

    def _get_param(self, name: str, *default: Any, **named: Any) -> Any:
        self._clock.glance()
        return self._parameters.get(name, *default, **named)

    def _log(self, level: str, text: object, *arguments: object, **_: object) -> None:
        if level != "DEBUG":
            said = str(text) % arguments if arguments else str(text)
            self._say(f"[{level}] [{self._clock.sim.time:.3f}]: {said}")


def _own_arguments(argv: Sequence[str] | None = None) -> list[str]:
    """``rospy.myargv``: the arguments without remappings."""
    given = sys.argv if argv is None else argv
    return [os.fspath(word) for word in given if ":=" not in word]
