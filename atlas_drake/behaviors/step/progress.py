"""How far STEP has come, and the step that it has in hand; the same in every phase."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.behaviors.step.action import DesiredStep, StepAction
from atlas_drake.control.feet.footstep import Footstep
from atlas_drake.control.feet.step_swing import StepSwing
from atlas_drake.messages.commands import BehaviorRequest


@dataclass(frozen=True)
class Progress:
    """What is done and asked for, whatever the phase.

    Attributes:
        index: Of the step being taken or taken last; 0 before the first step.
        leaving: Whether STAND was asked for with a foot in the air.
        request: The last one that was read; None before the first.
        refused: The request whose step cannot be taken.
    """

    index: int = 0
    leaving: bool = False
    request: BehaviorRequest | None = None
    refused: BehaviorRequest | None = None


@dataclass(frozen=True)
class TakenStep:
    """A step as it is taken.

    Attributes:
        sent: The step as it was asked for.
        step: The same as it is taken.
        action: What it is taken with.
        swing: Of its foot.
    """

    sent: DesiredStep
    step: Footstep
    action: StepAction
    swing: StepSwing

    @property
    def foot(self) -> int:
        """The foot that steps."""
        return self.step.foot

    @property
    def stance(self) -> int:
        """The foot that stays on the ground."""
        return 1 - self.step.foot
