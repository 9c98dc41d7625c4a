"""Progress of STEP and its present step; the same in every phase."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.behaviors.step.action import DesiredStep, StepAction
from atlas_drake.control.feet.footstep import Footstep
from atlas_drake.control.feet.step_swing import StepSwing
from atlas_drake.messages.commands import BehaviorRequest


@dataclass(frozen=True)
class Progress:
    """Progress of STEP in any phase.

    Attributes:
        index: Index of the present or last step; 0 before the first step.
        leaving: True if STAND was requested with a foot in the air.
        request: The last request that was read; None before the first one.
        refused: The request whose step cannot be taken.
    """

    index: int = 0
    leaving: bool = False
    request: BehaviorRequest | None = None
    refused: BehaviorRequest | None = None


@dataclass(frozen=True)
class TakenStep:
    """A step as executed.

    Attributes:
        sent: The step as requested.
        step: The same step as executed.
        action: Parameters of the step as executed.
        swing: Path of the swing foot.
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
