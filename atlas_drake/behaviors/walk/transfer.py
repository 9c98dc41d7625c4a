"""TRANSFER: both feet are down; the weight moves to one, and the other lifts off."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.walk.phase import Decision, WalkPhase, WalkTick
from atlas_drake.behaviors.walk.recovery_steps import may_step_again
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.feet.foot_roll import falling, rising
from atlas_drake.control.feet.sole_motion import Pitch, at_rest
from atlas_drake.frozen import replace
from atlas_drake.messages import WalkStatus
from atlas_drake.messages.footstep import LEFT, RIGHT


@dataclass(frozen=True, kw_only=True)
class Transfer(WalkPhase):
    """The weight moves to the next stance foot, and the other foot is unloaded.

    A walk begins ``from_rest``, with the weight between the feet. Between two steps,
    the next stance foot is the foot that has just landed.
    """

    unloading: int | None  # Foot that lifts off; None if no step was known
    from_rest: bool = False
    toe_off: float = 0.0  # Pitch of that foot about its toes at lift-off [rad]
    landed: float = 0.0  # Pitch with which the other foot landed [rad]

    def decide(self, tick: WalkTick) -> Decision:
        """When does the foot lift off?

        As planned; later, until the DCM is near its plan; at once, if the DCM is lost
        or a push has lifted a foot.
        """
        lost, coming = self.has_lost_dcm(tick), self.progress.coming
        airborne = self.airborne(tick)
        if airborne is not None and coming:
            leaves = airborne == coming[0].foot
            return Decision.LIFT_OFF if leaves else Decision.STEP_AGAIN
        if airborne is not None or (lost and not coming):
            return Decision.CATCH
        if tick.leaving:
            return Decision.STOP
        if coming and coming[0].foot != self.unloading:
            return Decision.SHIFT_WEIGHT
        if lost:
            again = not self.from_rest and may_step_again(self.progress, tick)
            return Decision.STEP_AGAIN if again else Decision.LIFT_OFF
        if self.elapsed < self.duration:
            return Decision.STAY
        if not coming:
            return Decision.STOP
        if self._may_wait(tick) and not self._is_dcm_ready(tick):
            return Decision.WAIT
        return Decision.LIFT_OFF

    def command_feet(
        self, tick: WalkTick
    ) -> tuple[Transfer, tuple[FootCommand, FootCommand]]:
        """Unloads the foot that lifts off; the other foot stays, or rolls flat."""
        return self, (self._command(LEFT, tick), self._command(RIGHT, tick))

    # ---- lift-off ------------------------------------------------------------

    @property
    def is_late(self) -> bool:
        """True while lift-off is later than planned."""
        return self.elapsed > self.duration

    def leaving_pitch(self, time: float) -> Pitch:
        """Evaluates the pitch of the leaving foot about its toes at a ``time`` [s]."""
        return rising(self.toe_off, self.duration, time)

    def _may_wait(self, tick: WalkTick) -> bool:
        """Returns True while waiting may bring the DCM nearer to its plan.

        The straight leg of a planted foot holds the pelvis back: then waiting does not
        help.
        """
        rules = tick.config.rules
        if self.elapsed - self.duration >= rules.longest_wait:
            return False
        if self.unloading is None:
            return True
        leg = tick.balance.robot.legs[self.unloading]
        flexion = leg.flexion(tick.observation.terms.q[leg.knee])
        return flexion >= rules.straight_flexion

    def _is_dcm_ready(self, tick: WalkTick) -> bool:
        """Returns True if the DCM is near enough to its plan for single support."""
        error = tick.dcm - self.planned.dcm
        return float(np.hypot(*error)) < tick.config.rules.dcm_ready

    # ---- references ----------------------------------------------------------

    @property
    def on_toes(self) -> int | None:
        """The leaving foot, if it rises to its toes."""
        return self.unloading if self.toe_off else None

    @property
    def lower_pitch(self) -> float:
        """Pitch that the leaving foot has at lift-off [rad]."""
        return self.toe_off

    def dcm_reference(self) -> DcmReference:
        """Evaluates the plan; while lift-off waits, the CoP reference is the DCM's."""
        planned = self.planned
        return replace(planned, cop=planned.dcm) if self.is_late else planned

    def status_flags(self, leaving: bool) -> int:
        """Returns the feedback flags of the phase."""
        if self.from_rest:
            return WalkStatus.SUBSTATE_SWAYING
        return WalkStatus.SUBSTATE_STEPPING

    def _command(self, foot: int, tick: WalkTick) -> FootCommand:
        balance, observation = tick.balance, tick.observation
        planted = self.progress.feet[foot]
        flat = at_rest(planted)
        if foot == self.unloading:
            load = self._load(tick)
            if not self.toe_off:
                return balance.in_contact(observation, foot, load)
            pitch = self.leaving_pitch(self.elapsed)
            raised = flat.pitched(pitch, tick.half_length)
            return balance.toeing_off(observation, foot, raised, load)
        flat_after = tick.config.roll.flat_after
        if self.landed and self.elapsed < flat_after:
            pitch = falling(self.landed, flat_after, self.elapsed)
            edge = math.copysign(tick.half_length, self.landed)
            lowered = flat.pitched(pitch, edge)
            return balance.rolling_flat(observation, foot, lowered, edge > 0)
        return balance.in_contact(observation, foot, planted=planted)

    def _load(self, tick: WalkTick) -> float:
        """Computes the largest load of the leaving foot, in weights of the robot.

        The load falls to almost 0 at the planned lift-off; while lift-off waits, both
        feet carry.
        """
        if self.is_late:
            return math.inf
        left = 1.0 - self.elapsed / self.duration
        return min(max(left / tick.config.rules.unload_share, 0.01), 1.0)
