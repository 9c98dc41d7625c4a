"""Logs of runs: recorded at the control rate, read again, drawn and replayed.

A log holds the values of ports; a log never changes the simulation.
"""

from atlas_drake.logs.log import Log, read_log
from atlas_drake.logs.notes import LogError

__all__ = ["Log", "LogError", "read_log"]
