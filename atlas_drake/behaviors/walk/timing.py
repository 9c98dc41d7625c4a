"""Durations of a walk's phases. Values only."""

from dataclasses import dataclass

from atlas_drake.config import Configuration, NotNegative, ProperShare


@dataclass(frozen=True, kw_only=True)
class GaitTiming(Configuration):
    """Durations of a walk's phases that the duration of a step does not define."""

    first_shift: NotNegative = 0.80
    """Weight shift before the first lift-off [s]."""
    transfer_share: ProperShare = 0.25
    """Share of a step's duration in double support [-]. The error of the DCM grows in
    single support; but the shorter the swing, the harder the almost straight trailing
    leg jerks the robot at lift-off."""
    settle: NotNegative = 0.70
    """Weight shift to the middle of the feet after the last step [s]."""
    rest: NotNegative = 0.50
    """Time at rest before STAND takes over [s]."""

    def transfer(self, duration: float) -> float:
        """Computes the double support before the lift-off of a step [s]."""
        return self.transfer_share * duration

    def swing(self, duration: float) -> float:
        """Computes the single support of a step of this duration [s]."""
        return (1.0 - self.transfer_share) * duration
