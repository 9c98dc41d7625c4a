"""What ``step`` asks of a phase in every tick.

The protocol of ``both_feet``, ``shift`` and ``single_support``, which implement it for
phases of their own.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.step.action import DesiredStep
from atlas_drake.behaviors.step.balance import Reach, StepBalance
from atlas_drake.behaviors.step.phases import Phase, StepPhase
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.messages.event import Event

P = TypeVar("P", bound=StepPhase)


class PhaseControl(ABC, Generic[P]):
    """Decides what happens in a phase. Holds constants only."""

    def __init__(self, balance: StepBalance):
        self._balance = balance

    @abstractmethod
    def advance(
        self, phase: P, observation: Observation, wanted: DesiredStep | None
    ) -> tuple[Phase, tuple[Event, ...]]:
        """Returns the phase that follows if the phase is over, or else the same.

        Args:
            phase: After the time of this tick was added.
            observation: Of this tick.
            wanted: The step asked for that has not begun, if any.
        """

    @abstractmethod
    def reach(self, phase: P) -> Reach:
        """Returns the soles that the legs have to reach, and how high the body is."""

    @abstractmethod
    def command_feet(
        self, phase: P, observation: Observation, cop: np.ndarray
    ) -> tuple[FootCommand, FootCommand]:
        """Commands both feet; balance goes before the load that the phase asks for.

        A foot that has to carry too much or too little would keep the CoP away from
        where balance wants it.

        Args:
            phase: Of this tick.
            observation: Of this tick.
            cop: Where balance wants the CoP in W [m], shape (2,).
        """

    def support(self, phase: P) -> SupportPolygon:
        """Returns where the CoP may lie now."""
        return phase.support

    def are_both_flat(self, phase: P) -> bool:
        """Returns whether both soles lie flat on the ground."""
        return True
