"""Logs of runs: the records of all control ticks, written, read and drawn.

A log never changes the simulation.
"""

from atlas_drake.clients.logs.header import LogError
from atlas_drake.clients.logs.log import Log
from atlas_drake.clients.logs.mcap_reader import read_log

__all__ = ["Log", "LogError", "read_log"]
