"""The waiting parts of ``rospy``: ``sleep``, ``Rate``, ``Timer``, ``spin``.

Time itself is in ``clock``; the rest of ``rospy`` is in ``rospy_module``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from atlas_drake.ros_scripts.clock import Clock, RosInterruptError
from atlas_drake.ros_scripts.ros_message import RosMessage
from atlas_drake.ros_scripts.ros_time import Duration, Time
from atlas_drake.ros_scripts.threads import start_callbacks
from atlas_drake.ros_scripts.topics import find_topic

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
