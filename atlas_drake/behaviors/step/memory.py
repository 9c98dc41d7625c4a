"""What STEP remembers between ticks, and the thresholds it goes by.

Frozen data; what is done with it is in ``step``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from atlas_drake.behaviors.step.action import DesiredStep, StepAction
from atlas_drake.bounds import Positive, ProperShare, Share
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.balance.weight_shift import WeightShift
from atlas_drake.control.feet.footstep import FootPose, Footstep
from atlas_drake.control.feet.step_swing import StepSwing


class StepPhase(Enum):
    """Where in its work the behavior is."""

    REST = "both feet down, over their middle"
    SWAY = "both feet down, to the one that stays"
    SWING = "one foot in the air, up and across"
    LOWER = "one foot in the air, coming down"
    SETTLE = "both feet down, the new one pressed flat"


@dataclass(frozen=True)
class StepRules:
    """Thresholds of STEP."""

    touchdown_force: float = 0.04
    """Normal force that counts as touchdown, in weights of the robot [-]."""
    settle: float = 0.25
    """Time for which a new foot is pressed flat before the weight moves [s]."""
    settling_load: float = 0.06
    """Least that it then carries, in weights [-]."""
    fresh_share: Share = 0.4
    """First share of the sway after landing in which it stays pressed [-]."""
    unload_share: Positive = 0.35
    """Last share of a sway in which the leaving foot is unloaded [-]."""
    still_loaded: float = 0.10
    """A foot that carries more than this does not lift off, in weights [-]."""
    dcm_ready: float = 0.02
    """DCM error with which a foot may lift off [m]."""
    dcm_lost: float = 0.01
    """How far inside the support the DCM keeps, or a weight shift is given up [m]."""
    cop_inside: float = 0.01
    """How far inside the support a weight shift plans the CoP [m]."""
    begin_inside: float = 0.015
    """How far inside the support the DCM is when a weight shift may begin [m]."""
    longest_wait: float = 0.3
    """Time after the sway for which a foot waits to leave; then it stays [s]."""
    lean_inside: float = 0.025
    """How far inside the standing sole the center of mass stays when it leans into a
    step [m]."""
    rest_speed: float = 0.05
    """Speed of the center of mass below which the robot is at rest [m/s]."""
    heel_begins: ProperShare = 0.5
    """Share of the sway after which it rises [-]: the weight is off the heel then."""
    level: float = 0.02
    """Feet at rest that differ less in height let the trunk be upright [m]."""
    least_clearance: float = 0.04
    """Height above its footholds to which a foot is lifted even by a leg short of
    room [m]."""


@dataclass(frozen=True)
class StepMemory:
    """State of STEP.

    Attributes:
        phase: Of the behavior.
        elapsed: Time in this phase, in LOWER since lift-off [s].
        feet: Where the soles are or last were on the ground.
        support: Where the CoP may lie.
        hips: As seen from the center of mass in W [m], shape (2, 3).
        sway: Of the center of mass.
        sway_time: Time since it began [s].
        index: Of the step being taken or taken last; 0 before the first.
        sent: That step as it was asked for.
        taken: The same as it is taken.
        action: What it is taken with.
        swing: Of its foot; planned when the step begins.
        heel: Angle that the leaving foot's heel has risen by at lift-off [rad].
        lean: Pitch of the trunk in this phase [rad].
        fresh: The foot that landed just now, if any.
        went_back: Whether the foot found no ground and goes to where it came from.
        gave_up: Whether the last weight shift was given up.
        leaving: Whether STAND was asked for with a foot in the air.
        refused: Parameters whose step cannot be taken.
        looked_at: The parameters that were last read, to notice new ones.
    """

    phase: StepPhase
    elapsed: float
    feet: tuple[FootPose, FootPose]
    support: SupportPolygon
    hips: np.ndarray
    sway: WeightShift
    sway_time: float
    index: int = 0
    sent: DesiredStep | None = None
    taken: Footstep | None = None
    action: StepAction | None = None
    swing: StepSwing | None = None
    heel: float = 0.0
    lean: float = 0.0
    fresh: int | None = None
    went_back: bool = False
    gave_up: bool = False
    leaving: bool = False
    refused: object = None
    looked_at: object = None

    def dcm_reference(self, omega: float) -> DcmReference:
        """Where DCM and CoP shall be now, with the pendulum's frequency [1/s]."""
        return self.sway.evaluate(self.sway_time, omega)

    @property
    def in_air(self) -> bool:
        """Whether one foot is off the ground."""
        return self.phase in (StepPhase.SWING, StepPhase.LOWER)

    @property
    def step(self) -> Footstep:
        """The step being taken or taken last; there is one once a sway has begun."""
        assert self.taken is not None
        return self.taken

    @property
    def wanted(self) -> DesiredStep:
        """The same step as it was asked for."""
        assert self.sent is not None
        return self.sent

    @property
    def how(self) -> StepAction:
        """What that step is taken with."""
        assert self.action is not None
        return self.action

    @property
    def planned_swing(self) -> StepSwing:
        """The swing of that step."""
        assert self.swing is not None
        return self.swing

    @property
    def stance(self) -> int:
        """The foot that stays on the ground."""
        return 1 - self.step.foot
