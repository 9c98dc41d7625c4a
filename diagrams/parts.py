"""``Parts``: what users put into a simulation of their own."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.diagrams.controller_socket import ControllerSource
from atlas_drake.scenario.world import WorldMaker

Extend = Callable[[DiagramBuilder, Diagram], None]
"""Adds systems to a diagram that holds a station, before it is built."""


@dataclass(frozen=True)
class Parts:
    """Parts of a user's own, as ``AtlasSimulation`` takes them and explains them."""

    controller: ControllerSource | None = None
    behaviors: Iterable[BehaviorEntry] = ()
    world: Iterable[WorldMaker] = ()
    extend: Extend | None = None
