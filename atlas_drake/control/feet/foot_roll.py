"""How a sole rolls from its heel over its flat to its toes while the robot walks ahead.

The trailing foot rises onto its toes while the weight leaves it, which lengthens its
leg, and the leading foot lands on its heel, or a step down on its toes: Griffin,
Wiedebach, Bertrand, Leonessa, Pratt, "Straight-leg walking through underconstrained
whole-body control", ICRA 2018.
"""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.config import Configuration, NotNegative, Positive
from atlas_drake.control.feet.sole_motion import Pitch
from atlas_drake.messages.footstep import FootPose
from atlas_drake.units import Meters, Radians, RadiansPerMeter, Seconds


@dataclass(frozen=True)
class FootRoll(Configuration):
    """Pitches of the soles in a walk ahead on level ground."""

    toe_off: NotNegative[Radians] = 0.25
    """Pitch of the trailing sole about its toes at lift-off."""
    heel_first: NotNegative[Radians] = 0.10
    """Pitch of the leading sole at touchdown, with its toes up."""
    shortest_stride: NotNegative[Meters] = 0.05
    """Distance between the feet up to which both pitches are 0."""
    full_stride: Positive[Meters] = 0.30
    """Distance between the feet from which both pitches apply in full."""
    level: NotNegative[Meters] = 0.02
    """Largest difference in height of the feet with these pitches."""
    easy_climb: NotNegative[Meters] = 0.05
    """Difference in height of the feet up to which the lower sole stays flat."""
    climb: NotNegative[RadiansPerMeter] = 4.5
    """Pitch of the lower sole about its toes per difference in height beyond that,
    before it leaves a step up and when it lands a step down: the other knee bends
    less."""
    most_climb: NotNegative[Radians] = 0.55
    """Largest pitch for a difference in height."""
    flat_after: Positive[Seconds] = 0.08
    """Time in which a sole that landed on its heel turns flat."""

    def share(self, rear: FootPose, front: FootPose) -> float:
        """Computes the share of the pitches that apply with the feet there [-]."""
        way = front.p_WF - rear.p_WF
        if abs(float(way[2])) > self.level:
            return 0.0
        ahead = float(way @ rear.R_WF[:, 0])
        room = self.full_stride - self.shortest_stride
        return min(max((ahead - self.shortest_stride) / room, 0.0), 1.0)

    def leaving(self, rear: FootPose, front: FootPose) -> float:
        """Computes the pitch of the trailing sole at lift-off [rad]."""
        return self.toe_off * self.share(rear, front) + self._up(rear, front)

    def landing(
        self, stance: FootPose, landing: FootPose, onward: FootPose | None
    ) -> float:
        """Computes the pitch of the leading sole at touchdown [rad].

        Only a walk that goes ``onward`` lands on the heel; one that stops needs the CoP
        at the toes.
        """
        down = self._up(landing, stance)
        if down or onward is None:
            return down
        goes_on = self.share(landing, onward)
        return -self.heel_first * min(self.share(stance, landing), goes_on)

    def _up(self, low: FootPose, high: FootPose) -> float:
        climb = float(high.p_WF[2] - low.p_WF[2])
        return min(max(climb - self.easy_climb, 0.0) * self.climb, self.most_climb)


def rising(angle: float, duration: float, time: float) -> Pitch:
    """Evaluates a pitch that grows with the square of time, up to ``angle`` [rad].

    Its rate at the end of the ``duration`` [s] is carried into the swing. Later it
    stays.
    """
    if time > duration:
        return Pitch(angle)
    s = time / duration
    return Pitch(angle * s * s, 2.0 * angle * s / duration, 2.0 * angle / duration**2)


def falling(angle: float, duration: float, time: float) -> Pitch:
    """Evaluates a pitch that goes from ``angle`` [rad] to rest at 0."""
    pitch, rate, acceleration = rising(angle, duration, max(duration - time, 0.0))
    return Pitch(pitch, -rate, acceleration if time < duration else 0.0)
