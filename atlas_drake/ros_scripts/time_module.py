"""The module ``time`` of a program: simulated time where Python's would be real.

Only the program gets this module; Drake and all other code keep Python's.
"""

from __future__ import annotations

import time
from types import ModuleType

from atlas_drake.ros_scripts.clock import Clock, RunEnded


def simulated_time(clock: Clock) -> ModuleType:
    """Return the module; its clocks are simulated time and start at 0 s."""

    def now() -> float:
        return clock.now

    def now_ns() -> int:
        return round(clock.now * 1e9)

    def sleep(seconds: float) -> None:
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        if not clock.advance_to(clock.sim.time + seconds):
            raise RunEnded

    module = ModuleType("time", time.__doc__)
    vars(module).update(vars(time))
    vars(module).update(
        dict.fromkeys(("time", "monotonic", "perf_counter", "clock"), now)
        | dict.fromkeys(("time_ns", "monotonic_ns", "perf_counter_ns"), now_ns)
        | {"sleep": sleep}
    )
    return module
