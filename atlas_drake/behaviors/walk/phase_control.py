"""What ``walk`` asks of a phase in every tick.

The protocol of ``double_support``, ``single_support`` and ``settling``, each of which
implements it for phases of its own.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.walk.phases import Phase, WalkPhase
from atlas_drake.messages.event import Event

P = TypeVar("P", bound=WalkPhase)


class PhaseControl(ABC, Generic[P]):
    """Decides what happens in a phase. Holds constants only."""

    def leave(self, phase: P) -> P | Phase:
        """Ends the walk as soon as the phase allows; its pending steps are dropped."""
        return phase

    @abstractmethod
    def advance(
        self, phase: P, observation: Observation
    ) -> tuple[Phase, tuple[Event, ...]]:
        """Returns the phase that follows if the phase is over, or else the same."""

    @abstractmethod
    def command_feet(
        self, phase: P, observation: Observation
    ) -> tuple[P, tuple[FootCommand, FootCommand]]:
        """Commands both feet, and moves their references on by one tick."""

    def end(
        self, phase: P, observation: Observation, leaving: bool
    ) -> tuple[bool, tuple[Event, ...]]:
        """Returns whether the walk is over, and events about steps that it leaves.

        Args:
            phase: After ``advance`` and ``command_feet``.
            observation: Of this tick.
            leaving: Whether the walk was asked to end.
        """
        return False, ()
