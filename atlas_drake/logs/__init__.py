"""Logs of runs: recorded at the control rate, read again, drawn and replayed.

A log keeps what ports say; nothing here changes what is simulated.
"""

from atlas_drake.logs.log import Log, read_log
from atlas_drake.logs.notes import LogError

__all__ = ["Log", "LogError", "read_log"]
