"""SETTLE: the robot comes to rest over both feet, where the walk ends or goes on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.walk.config import GaitTiming
from atlas_drake.behaviors.walk.phase import Decision, WalkPhase, WalkTick
from atlas_drake.messages import WalkStatus


@dataclass(frozen=True, kw_only=True)
class Settle(WalkPhase):
    """The weight moves to the middle of the feet, and the robot comes to rest."""

    def decide(self, tick: WalkTick) -> Decision:
        """Is the walk over?

        It is when the robot is at rest and no step can be taken. If the DCM is lost, or
        a push has lifted a foot, a step catches it.
        """
        if self.has_lost_dcm(tick) or self.airborne(tick) is not None:
            return Decision.CATCH
        if self.progress.coming:
            return Decision.SHIFT_WEIGHT
        return Decision.FINISH if self._is_at_rest(tick) else Decision.STAY

    @property
    def obstacle(self) -> str:
        """Why the walk ends before a commanded step; empty if it does not."""
        return "" if self.progress.coming else self.progress.preview.obstacle

    def command_feet(
        self, tick: WalkTick
    ) -> tuple[Settle, tuple[FootCommand, FootCommand]]:
        """Keeps both feet planted."""
        return self, tick.balance.standing(tick.observation, self.progress.feet)

    def _is_at_rest(self, tick: WalkTick) -> bool:
        if not self.elapsed > self.duration + tick.config.timing.rest:
            return False
        speed = float(np.abs(tick.observation.terms.com_velocity).max())
        return speed < tick.config.rules.rest_speed

    def time_to_touchdown(self, timing: GaitTiming) -> float:
        """Returns 0: no foot lifts off."""
        return 0.0

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of settling with the reason for the walk's end."""
        if self.obstacle:
            why = WalkStatus.ERROR_INCONSISTENT_STEPS
        elif leaving:
            why = WalkStatus.OKAY
        else:
            why = WalkStatus.WARNING_INSUFFICIENT_STEP_DATA
        return WalkStatus.SUBSTATE_CATCHING | why
