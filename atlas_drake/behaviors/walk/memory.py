"""What the walk remembers between ticks, and the thresholds it goes by.

Frozen data; what is done with it is in ``walk``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from atlas_drake.behaviors.step.queue import next_runs
from atlas_drake.bounds import Positive, Share
from atlas_drake.control.balance.dcm_plan import DcmPlan, DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.feet.footstep import FootPose, Footstep
from atlas_drake.control.feet.swing_foot import Swing
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasBehaviorWalkParams


class Phase(Enum):
    """Where in the walk the robot is."""

    SHIFT = "swaying"
    SWING = "swing"
    TRANSFER = "double support"
    SETTLE = "catching"


@dataclass(frozen=True)
class WalkRules:
    """Thresholds of the walk."""

    touchdown_force: float = 0.08
    """Normal force that counts as touchdown, in weights of the robot [-]."""
    earliest_touchdown: Share = 0.75
    """Share of the swing before which contact is a stumble, not a touchdown."""
    unload_share: Positive = 0.4
    """Last share of a transfer in which the leaving foot is unloaded [-]."""
    dcm_ready: float = 0.025
    """DCM error with which a foot may lift off [m]."""
    longest_wait: float = 0.25
    """Time that lift-off waits at most for that [s]."""
    straight_flexion: float = 0.12
    """A leg whose knee is bent by less, counted from the straight leg, does not wait
    any longer [rad]."""
    frozen_end: float = 0.06
    """Last part of a swing in which the landing place stays put [s]."""
    rest_speed: float = 0.08
    """Speed of the center of mass below which the walk is over [m/s]."""
    replan_shift: float = 0.002
    """Change of the landing place that is worth a new plan [m]."""
    transfer_change: float = 0.15
    """Share by which a transfer is longer or shorter, at most, to make up for a
    touchdown before or after its time. A foot that is farther off was disturbed, and
    the next step shall not wait for the clock [-]."""
    leg_stretch: float = 0.04
    """Stretch of the lower leg where the ground is uneven [m]."""


@dataclass(frozen=True)
class WalkMemory:
    """State of the walk.

    Attributes:
        phase: Of the walk.
        elapsed: Time in this phase [s].
        duration: Planned duration of this phase [s].
        feet: Where the soles are or last were on the ground.
        aimed: Where each of them was to land; at first, where it was.
        pending: Steps not begun, by index.
        current: Step being taken (SWING) or taken last (TRANSFER, SETTLE).
        commanded: ``current`` as it was sent.
        swing: Reference of the swinging foot, in SWING.
        plan: Of the DCM.
        plan_time: Time into the plan [s].
        unloading: Foot that leaves the ground when this phase is over, if any.
        sensitivity: How the DCM planned for touchdown moves with the next foot [-].
        support: Where the CoP may lie.
        omega: Natural frequency used in the plan [1/s].
        next_index: Index of the next step to begin.
        seen_params: What was last read of the messages, to notice a new one.
        obstacle: Why the walk ends before a step that was sent; empty if it does not.
        told: What was warned about: indices of steps, and what of them.
    """

    phase: Phase
    elapsed: float
    duration: float
    feet: tuple[FootPose, FootPose]
    aimed: tuple[FootPose, FootPose]
    pending: tuple[Footstep, ...]
    current: Footstep | None
    commanded: Footstep | None
    swing: Swing | None
    plan: DcmPlan
    plan_time: float
    unloading: int | None
    sensitivity: float
    support: SupportPolygon
    omega: float
    next_index: int
    seen_params: AtlasBehaviorWalkParams
    obstacle: str = ""
    told: frozenset[tuple[int, str]] = frozenset()

    @property
    def swinging(self) -> bool:
        """Whether a foot is in the air."""
        return self.phase is Phase.SWING

    @property
    def waiting(self) -> bool:
        """Whether both feet are down longer than planned, until the DCM is ready."""
        return (
            self.phase in (Phase.SHIFT, Phase.TRANSFER) and self.elapsed > self.duration
        )

    @property
    def step(self) -> Footstep:
        """The step being taken or taken last; there is one once a foot has lifted."""
        assert self.current is not None
        return self.current

    @property
    def sent(self) -> Footstep:
        """The same step as it was sent."""
        assert self.commanded is not None
        return self.commanded

    @property
    def last_foot(self) -> int | None:
        """The foot that steps now or has stepped last, if any."""
        return None if self.current is None else self.current.foot

    @property
    def swing_in_progress(self) -> Swing:
        """The swing of the foot in the air; only while ``swinging``."""
        assert self.swing is not None
        return self.swing

    def dcm_reference(self) -> DcmReference:
        """The plan at this moment; where it waits, the DCM rests over the CoP."""
        reference = self.plan.evaluate(self.plan_time)
        if self.waiting:
            return replace(reference, cop=reference.dcm)
        return reference

    @property
    def known(self) -> tuple[Footstep, ...]:
        """Steps to come that follow each other without a gap."""
        return next_runs(self.pending, self.next_index)
