"""Protocol of a phase of the walk, called by ``walk`` in every tick.

``double_support``, ``single_support`` and ``settling`` implement the protocol for their
phases.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.walk.phases import WalkPhase, WalkState
from atlas_drake.messages.event import Event

P = TypeVar("P", bound=WalkPhase)


class WalkPhaseControl(ABC, Generic[P]):
    """Computes the ticks of a phase and its end. Holds constants only."""

    def leave(self, phase: P) -> P | WalkState:
        """Ends the walk as soon as the phase allows; its pending steps are dropped."""
        return phase

    @abstractmethod
    def advance(
        self, phase: P, observation: Observation
    ) -> tuple[WalkState, tuple[Event, ...]]:
        """Returns the next phase if the phase is over, or else the same phase."""

    @abstractmethod
    def command_feet(
        self, phase: P, observation: Observation
    ) -> tuple[P, tuple[FootCommand, FootCommand]]:
        """Commands both feet, and advances their references by one tick."""

    def end(
        self, phase: P, observation: Observation, leaving: bool
    ) -> tuple[bool, tuple[Event, ...]]:
        """Returns True if the walk is over, and events about steps that it leaves out.

        Args:
            phase: The phase after ``advance`` and ``command_feet``.
            observation: Observation of this tick.
            leaving: True if the end of the walk was requested.
        """
        return False, ()
