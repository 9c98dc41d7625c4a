"""SETTLE: the robot comes to rest over both feet, and the walk ends.

Computes each tick of the phase; ``planner`` makes the plan that it follows.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.balance import Balance, FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.phase_control import WalkPhaseControl
from atlas_drake.behaviors.walk.phases import WalkSettle, WalkShift
from atlas_drake.behaviors.walk.planner import WalkPlanner
from atlas_drake.messages.event import STEPS_LEFT, Event


class Settling(WalkPhaseControl[WalkSettle]):
    """Stands still until the walk is over or new steps arrive."""

    def __init__(self, balance: Balance, planner: WalkPlanner, config: WalkConfig):
        self._balance = balance
        self._planner = planner
        self._rest = config.timing.rest
        self._rest_speed = config.rules.rest_speed

    def advance(
        self, phase: WalkSettle, observation: Observation
    ) -> tuple[WalkSettle | WalkShift, tuple[Event, ...]]:
        """Begins a new weight shift if new steps arrived that can be taken."""
        if phase.obstacle or not self._planner.coming(phase.progress):
            return phase, ()
        now = phase.planned
        return self._planner.shift(phase.progress, now.dcm, now.cop), ()

    def command_feet(
        self, phase: WalkSettle, observation: Observation
    ) -> tuple[WalkSettle, tuple[FootCommand, FootCommand]]:
        """Keeps both feet planted."""
        left = self._balance.planted(observation, 0)
        right = self._balance.planted(observation, 1)
        return phase, (left, right)

    def end(
        self, phase: WalkSettle, observation: Observation, leaving: bool
    ) -> tuple[bool, tuple[Event, ...]]:
        """Ends the walk when the robot is at rest, and names the steps left out."""
        speed = float(np.abs(observation.terms.com_velocity).max())
        at_rest = (
            phase.elapsed > phase.duration + self._rest and speed < self._rest_speed
        )
        if not at_rest:
            return False, ()
        progress = phase.progress
        if progress.pending:
            left = ", ".join(str(step.index) for step in progress.pending)
            text = f"WALK ends without the steps {left}"
            if phase.obstacle:
                text += f": {phase.obstacle}"
        elif progress.last_foot is None and not leaving:
            text = "WALK ends without a step: walk_params.step_queue has none"
        else:
            return True, ()
        return True, (Event(observation.time, STEPS_LEFT, text),)
