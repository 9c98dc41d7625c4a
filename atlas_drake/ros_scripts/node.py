"""Publishers and subscribers of a program.

The topics are in ``topics``; the rest of ``rospy`` is in ``rospy_module``.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from atlas_drake.errors import InvalidMessageError
from atlas_drake.ros_scripts.clock import Clock
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.threads import start_callbacks
from atlas_drake.ros_scripts.topics import find_topic


class Publisher:
    """``rospy.Publisher``: sends messages of one type on one topic."""

    def __init__(
        self,
        clock: Clock,
        say: Callable[[str], object],
        name: str,
        data_class: type[RosMessage],
        subscriber_listener: object = None,
        tcp_nodelay: bool = False,
        latch: bool = False,
        headers: object = None,
        queue_size: int | None = None,
    ) -> None:
        """Finds the topic; options of the network are ignored.

        Raises:
            ScriptError: If such messages cannot be published there.
        """
        self.resolved_name, self._topic = find_topic(name, data_class, to_write=True)
        self.name, self.data_class = self.resolved_name, data_class
        self.type = data_class._type
        self._clock, self._say = clock, say
        self._told: set[str] = set()

    def publish(self, *values: Any, **named: Any) -> None:
        """Sends a message, or the values of one.

        A refused message is an event of the run and raises nothing, since a publisher
        in ROS gets no reply.

        Raises:
            TypeError: If the message has another type than the topic.
            ScriptError: If a part of the message has the wrong type.
        """
        if len(values) == 1 and isinstance(values[0], RosMessage) and not named:
            message = values[0]
        else:
            message = self.data_class(*values, **named)
        if message._type != self.type:
            raise TypeError(
                f"{self.name} has messages {self.type}, not {message._type}"
            )
        if self._topic.write is None or self._clock.over:
            return
        # The robot reports refused messages by error code and event.
        with suppress(InvalidMessageError), self._clock.undisturbed():
            told = self._topic.write(self._clock.sim, message)
            if told and told not in self._told:
                self._told.add(told)
                self._say(told)
        self._clock.last_command = self._clock.sim.time

    def get_num_connections(self) -> int:
        """Returns 1: the robot."""
        return 1

    def unregister(self) -> None:
        """Does nothing."""


class Subscriber:
    """``rospy.Subscriber``: calls back with messages of one topic."""

    def __init__(
        self,
        clock: Clock,
        name: str,
        data_class: type[RosMessage],
        callback: Callable[..., object] | None = None,
        callback_args: object = None,
        queue_size: int | None = None,
        buff_size: int = 0,
        tcp_nodelay: bool = False,
    ) -> None:
        """Finds the topic; messages arrive while the program waits.

        Raises:
            ScriptError: If such messages cannot be subscribed to there.
        """
        self.resolved_name, self._topic = find_topic(name, data_class, to_write=False)
        self.name, self.data_class = self.resolved_name, data_class
        self._clock = clock
        self._callback, self._arguments = callback, callback_args
        if callback is not None:
            start_callbacks(clock, self._listen)

    def _listen(self) -> None:
        """Calls the callback in every control period, unless its last call waits."""
        clock, read = self._clock, self._topic.read
        assert read is not None  # find_topic checked it.
        while clock.advance_to(clock.sim.time + clock.period) and self._callback:
            with clock.undisturbed():
                message = read(clock.sim)
            if self._arguments is None:
                self._callback(message)
            else:
                self._callback(message, self._arguments)

    def get_num_connections(self) -> int:
        """Returns 1: the robot."""
        return 1

    def unregister(self) -> None:
        """Stops the callbacks."""
        self._callback = None
