"""Publishers, subscribers and the waiting parts of ``rospy``, such as ``Rate``.

The topics are in ``topics``, time is in ``clock``, the rest in ``rospy_module``.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from atlas_drake.errors import InvalidMessageError
from atlas_drake.ros_scripts.clock import Clock, RosInterruptError
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.ros_time import Duration, Time
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


SPIN = 1.0
"""Length of each wait in ``spin`` [s]."""


def seconds_of(duration: Any) -> float:
    """Return the seconds of a ``Duration`` or a number."""
    return float(duration.to_sec() if isinstance(duration, Duration) else duration)


def sleep(clock: Clock, duration: Any) -> None:
    """Waits.

    Args:
        clock: Clock of the run.
        duration: A ``Duration`` or a number [s]; a negative one does not wait.

    Raises:
        RosInterruptError: If the run ends during the wait.
    """
    if not clock.advance_to(clock.sim.time + seconds_of(duration)):
        raise RosInterruptError("ROS shutdown request")


def spin(clock: Clock) -> None:
    """Waits until the run ends."""
    while clock.advance_to(clock.sim.time + SPIN):
        pass


def wait_for_message(
    clock: Clock, topic: str, topic_type: type[RosMessage], timeout: float | None = None
) -> RosMessage:
    """Waits one control period and returns a topic's message.

    Raises:
        RosInterruptError: If the run ends during the wait.
        ScriptError: If such messages cannot be subscribed to there.
    """
    _, found = find_topic(topic, topic_type, to_write=False)
    sleep(clock, clock.sim.scenario.control_period)
    assert found.read is not None  # find_topic checked it.
    return found.read(clock.sim)


class Rate:
    """``rospy.Rate``: keeps a loop at a frequency."""

    def __init__(self, clock: Clock, hz: float, reset: bool = False) -> None:
        """Starts the first cycle now.

        Raises:
            ValueError: If ``hz`` is not above 0.
        """
        if not hz > 0.0:
            raise ValueError(f"rospy.Rate: {hz!r} times a second; must be more than 0")
        self._clock, self._period = clock, 1.0 / hz
        self.sleep_dur = Duration.from_sec(self._period)
        self._last = clock.sim.time

    def sleep(self) -> None:
        """Waits until the end of the cycle; returns at once if that is past.

        Raises:
            RosInterruptError: If the run ends during the wait.
        """
        now, due = self._clock.sim.time, self._last + self._period
        if due > now and not self._clock.advance_to(due):
            raise RosInterruptError("ROS shutdown request")
        # A loop that is late by a whole cycle does not catch up.
        self._last = due if due > now - self._period else now

    def remaining(self) -> Duration:
        """Returns the rest of the present cycle."""
        return Duration.from_sec(self._last + self._period - self._clock.sim.time)


@dataclass
class TimerEvent:
    """Argument of a timer's callback; ``last_duration`` stays None."""

    last_expected: Time | None
    last_real: Time | None
    current_expected: Time
    current_real: Time
    last_duration: float | None = None


class Timer:
    """``rospy.Timer``: calls a callback periodically while the program waits."""

    def __init__(
        self,
        clock: Clock,
        period: Any,
        callback: Callable[[TimerEvent], object],
        oneshot: bool = False,
        reset: bool = False,
    ) -> None:
        """Starts now; the first call comes after one period."""
        self._clock, self._rate = clock, Rate(clock, 1.0 / seconds_of(period))
        self._callback, self._oneshot = callback, oneshot
        self._stopped = False
        start_callbacks(clock, self._run)

    def _run(self) -> None:
        last_expected = last_real = None
        while True:
            due = self._clock.sim.time + self._rate.remaining().to_sec()
            self._rate.sleep()
            if self._stopped:
                return
            expected = Time.from_sec(due)
            real = Time.from_sec(self._clock.sim.time)
            self._callback(TimerEvent(last_expected, last_real, expected, real))
            if self._oneshot:
                return
            last_expected, last_real = expected, real

    def shutdown(self) -> None:
        """Stops the calls."""
        self._stopped = True
