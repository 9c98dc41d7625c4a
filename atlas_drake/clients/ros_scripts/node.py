"""Publishers, subscribers and the waiting parts of ``rospy``, such as ``Rate``.

The topics are in ``topics``, time is in ``clock``, the rest in ``rospy_module``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

from atlas_drake.clients.ros_scripts.clock import Clock, RosError, RosInterruptError
from atlas_drake.clients.ros_scripts.network import Network
from atlas_drake.clients.ros_scripts.ros_message import Duration, RosMessage
from atlas_drake.clients.ros_scripts.topics import READ, WRITE, find_topic
from atlas_drake.errors import InvalidMessageError

SPIN = 1.0
"""Length of each wait in ``spin`` [s]."""


class Publisher:
    """``rospy.Publisher``: sends messages of one type on one topic."""

    def __init__(
        self,
        network: Network,
        name: str,
        data_class: type[RosMessage],
        *_options: object,
        **_named: object,
    ) -> None:
        """Finds the topic; options of the transport are ignored."""
        self.resolved_name, self._write = find_topic(name, data_class, WRITE)
        self.name, self.data_class = self.resolved_name, data_class
        self._network, self._clock = network, network.clock
        if self._write is None:
            network.note_own(self.name, "reads")

    def publish(self, *values: Any, **named: Any) -> None:
        """Sends a message, or the values of one.

        A refused message is an event of the run and raises nothing, since a publisher
        in ROS gets no reply.
        """
        if len(values) == 1 and isinstance(values[0], RosMessage) and not named:
            message = values[0]
        else:
            message = self.data_class(*values, **named)
        if message._type != self.data_class._type:
            raise TypeError(
                f"{self.name} has messages {self.data_class._type}, not {message._type}"
            )
        if self._clock.over:
            return
        if self._write is None:
            self._network.send(self.name, message)
            return
        # The robot reports refused messages by error code and event.
        with suppress(InvalidMessageError), self._clock.undisturbed():
            self._network.note(self._write(self._clock.sim, message))
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
        network: Network,
        name: str,
        data_class: type[RosMessage],
        callback: Callable[..., object] | None = None,
        callback_args: object = None,
        *_options: object,
        **_named: object,
    ) -> None:
        """Finds the topic; messages arrive while the program waits."""
        self.resolved_name, self._read = find_topic(name, data_class, READ)
        self.name, self._callback = self.resolved_name, callback
        self._clock = network.clock
        self._arguments = () if callback_args is None else (callback_args,)
        if self._read is None:
            self._inbox = network.receive(self.name)
        if callback is not None:
            self._clock.start_callbacks(self._listen)

    def _listen(self) -> None:
        """Calls the callback in every control period, unless its last call waits."""
        clock = self._clock
        while clock.advance_to(clock.sim.time + clock.period) and self._callback:
            for message in self._arrived():
                if self._callback is not None:
                    self._callback(message, *self._arguments)

    def _arrived(self) -> Iterator[RosMessage]:
        """Returns the robot's present message, or those of the program since."""
        if self._read is None:
            while self._inbox:
                yield self._inbox.popleft()
        else:
            with self._clock.undisturbed():
                message = self._read(self._clock.sim)
            yield message

    def get_num_connections(self) -> int:
        """Returns 1: the robot."""
        return 1

    def unregister(self) -> None:
        """Stops the callbacks."""
        self._callback = None


class Rate:
    """``rospy.Rate``: keeps a loop at a frequency."""

    def __init__(self, clock: Clock, hz: float, reset: bool = False) -> None:
        """Starts the first cycle now."""
        if not hz > 0.0:
            raise ValueError(f"rospy.Rate: {hz!r} times a second; must be more than 0")
        self._clock, self._period = clock, 1.0 / hz
        self._last = clock.sim.time

    def sleep(self) -> None:
        """Waits until the end of the cycle; returns at once if that is past."""
        now, due = self._clock.sim.time, self._last + self._period
        if due > now and not self._clock.advance_to(due):
            raise RosInterruptError("ROS shutdown request")
        # A loop that is late by a whole cycle does not catch up.
        self._last = due if due > now - self._period else now


def sleep(clock: Clock, duration: Any) -> None:
    """Waits for a ``Duration`` or a number [s]; a negative one does not wait."""
    seconds = duration.to_sec() if isinstance(duration, Duration) else float(duration)
    if not clock.advance_to(clock.sim.time + seconds):
        raise RosInterruptError("ROS shutdown request")


def spin(clock: Clock) -> None:
    """Waits until the run ends."""
    while clock.advance_to(clock.sim.time + SPIN):
        pass


def wait_for_message(
    network: Network,
    topic: str,
    topic_type: type[RosMessage],
    timeout: float | None = None,
) -> RosMessage:
    """Waits for a topic's next message: of the robot, one control period."""
    clock = network.clock
    resolved, read = find_topic(topic, topic_type, READ)
    if read is None:
        inbox = network.receive(resolved)
        limit = math.inf if timeout is None else timeout
        if not clock.wait_for(lambda: bool(inbox), limit):
            raise RosError(f"no message on topic {resolved} within {limit:g} s")
        return inbox.popleft()
    sleep(clock, clock.period)
    message: RosMessage = read(clock.sim)
    return message
