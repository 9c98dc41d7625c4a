"""The sockets of a run: types and functions of what clients, and users, join to it.

``behaviors=`` takes ``BehaviorEntry`` values, ``controller=`` a ``ControllerSource``,
``world=`` ``WorldMaker`` functions, ``extend=`` one or several ``Extend`` functions. A
system that reads records has ``RecordInputs``; ``add_listener`` adds one that hands
them to a function.
"""

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.diagrams.control_mode_switch import Extend, additions
from atlas_drake.diagrams.controller_socket import ControllerSource
from atlas_drake.shipped import registered
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.record_reader import (
    RecordInputs,
    RecordListener,
    add_listener,
)
from atlas_drake.worlds.world import WorldMaker

__all__ = [
    "BehaviorEntry",
    "CollectableSystem",
    "ControllerSource",
    "Extend",
    "RecordInputs",
    "RecordListener",
    "WorldMaker",
    "add_listener",
    "additions",
    "registered",
]
