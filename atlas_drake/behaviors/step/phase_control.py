"""Protocol of a phase of STEP, called by ``step`` in every tick.

``both_feet``, ``shift`` and ``single_support`` implement the protocol for their phases.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.step.action import DesiredStep
from atlas_drake.behaviors.step.phases import StepPhase, StepState
from atlas_drake.behaviors.step.step_balance import Reach, StepBalance
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.messages.event import Event

P = TypeVar("P", bound=StepPhase)


class StepPhaseControl(ABC, Generic[P]):
    """Computes the ticks of a phase and its end. Holds constants only."""

    def __init__(self, balance: StepBalance):
        self._balance = balance

    @abstractmethod
    def advance(
        self, phase: P, observation: Observation, wanted: DesiredStep | None
    ) -> tuple[StepState, tuple[Event, ...]]:
        """Returns the next phase if the phase is over, or else the same phase.

        Args:
            phase: The phase, with the time of this tick added.
            observation: Observation of this tick.
            wanted: The requested step that has not begun, if any.
        """

    @abstractmethod
    def reach(self, phase: P) -> Reach:
        """Returns the sole poses that the legs have to reach, and the body's height."""

    @abstractmethod
    def command_feet(
        self, phase: P, observation: Observation, cop: np.ndarray
    ) -> tuple[FootCommand, FootCommand]:
        """Commands both feet; balance has priority over the load of the phase.

        A foot with too large or too small a load would keep the CoP away from its
        desired position.

        Args:
            phase: StepState of this tick.
            observation: Observation of this tick.
            cop: Desired CoP in W [m], shape (2,).
        """

    def support(self, phase: P) -> SupportPolygon:
        """Returns the present region of the CoP."""
        return phase.support

    def are_both_flat(self, phase: P) -> bool:
        """Returns True if both soles are flat on the ground."""
        return True
