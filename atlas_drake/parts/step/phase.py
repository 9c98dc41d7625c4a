"""The common part of STEP's phases, and their decisions.

``rest``, ``shift``, ``swing`` and ``settle`` have one phase each. A phase decides what
follows it; ``transitions`` makes the phase that follows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.phases import TIME_STEP, Phase, sampled
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.footstep import LEFT, FootPose, Footstep
from atlas_drake.parts.step.action import demo_step, desired_step
from atlas_drake.parts.step.swing_path import SwingPath
from atlas_drake.parts.step.tools import StepTick
from atlas_drake.parts.step.weight_shift import WeightShift
from atlas_drake.support_polygon import SupportPolygon, load_share_range


class Decision(Enum):
    """What a phase decides in a tick."""

    STAY = "The phase goes on."
    BEGIN = "A step is requested: the weight shifts to the stance foot."
    GIVE_UP = "The foot cannot be unloaded: the step is abandoned."
    LIFT_OFF = "The foot is unloaded, and lifts off."
    LOWER = "The foot is above its foothold, and comes down."
    LAND = "The foot has touched the ground, and is pressed flat."
    GO_BACK = "The foot has found no ground, and returns to where it was."
    REST = "The step is done: the weight shifts to between the feet."


@dataclass(frozen=True)
class StepProgress:
    """Progress of STEP in any phase."""

    index: int = 0  # Index of the present or last step; 0 before the first step
    leaving: bool = False  # True if STAND was requested with a foot in the air
    request: BehaviorRequest | None = None  # Last request read; None before the first
    done: BehaviorRequest | None = None  # Last request whose step has begun, or cannot


@dataclass(frozen=True)
class Reach:
    """Poses that the legs have to reach."""

    height: float  # Height of the center of mass in W, if the legs can reach it [m]
    now: Sequence[FootPose]  # Present poses of the soles; on landing, if in the air
    later: Sequence[tuple[int, FootPose]]  # Foot and pose after the weight shift


@dataclass(frozen=True, kw_only=True)
class StepPhase(Phase, ABC):
    """A phase of STEP: its data, its decision, and the commands of its feet.

    ``support`` is the region of the CoP with both soles flat, or on the stance foot;
    ``elapsed`` counts from lift-off in single support.
    """

    progress: StepProgress
    feet: tuple[FootPose, FootPose]  # Poses of the soles, the last ones on the ground
    hips: np.ndarray  # Hip positions from the center of mass in W [m], shape (2, 3)
    shift: WeightShift  # Motion of the center of mass
    shift_time: float = 0.0  # Time since the beginning of that motion [s]
    lean: float = 0.0  # Pitch of the trunk [rad]

    @abstractmethod
    def decide(self, tick: StepTick) -> Decision:
        """Decides whether the phase goes on, and what follows it."""

    @abstractmethod
    def command_feet(self, tick: StepTick) -> tuple[FootCommand, FootCommand]:
        """Commands both feet.

        Balance has priority over the loads of a phase: a foot with too large or too
        small a load would keep the CoP away from its desired position.
        """

    @abstractmethod
    def reach(self, tick: StepTick) -> Reach:
        """Returns the sole poses that the legs have to reach, and the body's height."""

    def requested(self, tick: StepTick) -> Footstep | None:
        """Returns the requested step that has not begun, if any."""
        progress, tools = self.progress, tick.tools
        request = progress.request
        if request is None or not request.is_newer(progress.done):
            return None
        params = request.command.step_params
        if params.use_demo_walk:
            index = progress.index + 1
            return demo_step(self.feet, index, tools.usual_action, tools.gait)
        feet_z = (float(self.feet[0].p_WF[2]), float(self.feet[1].p_WF[2]))
        return desired_step(params, feet_z, tools.usual_action, tools.config.action)

    # ---- ground --------------------------------------------------------------

    @property
    def carrying(self) -> tuple[FootPose, ...]:
        """Poses of the feet that are on the ground."""
        return self.feet

    @property
    def in_air(self) -> Footstep | None:
        """The step whose foot is in the air; None while both feet are down."""
        return None

    def are_both_flat(self, tick: StepTick) -> bool:
        """Returns True if both soles are flat on the ground."""
        return True

    def region(self, tick: StepTick) -> SupportPolygon:
        """Returns the present region of the CoP."""
        return self.support

    # ---- references ----------------------------------------------------------

    def dcm_reference(self, omega: float) -> DcmReference:
        """Evaluates the present references of DCM and CoP."""
        return self.shift.evaluate(self.shift_time, omega)

    def is_early(self, tick: StepTick) -> bool:
        """Returns True in the first part of the weight shift."""
        return self.shift_time / self.shift.duration < tick.rules.fresh_share

    def cop(self, tick: StepTick) -> np.ndarray:
        """Computes the desired CoP in W [m], shape (2,)."""
        omega = tick.omega(self.carrying)
        reference = self.dcm_reference(omega)
        return tick.tools.balance.desired_cop(
            tick.observation, reference, omega, self.region(tick)
        )

    def load_range(
        self, foot: int, tick: StepTick, on_toes: bool = False
    ) -> tuple[float, float]:
        """Computes the loads that ``foot`` can carry for the CoP, in weights [-]."""
        balance, pose = tick.tools.balance, self.feet[foot]
        return load_share_range(
            self.cop(tick),
            balance.support(self.feet[1 - foot]),
            balance.toes(pose) if on_toes else balance.support(pose),
        )

    def touchdown(
        self, foot: int, tick: StepTick, on_toes: bool = False
    ) -> tuple[FootCommand, FootCommand]:
        """Commands ``foot`` to be pressed flat, within the load that balance allows."""
        most = self.load_range(foot, tick, on_toes)[1]
        load = min(tick.rules.settling_load, most)
        command = tick.tools.balance.touchdown(tick.observation, foot, load)
        return self.with_stance(tick, foot, command)

    def with_stance(
        self, tick: StepTick, foot: int, command: FootCommand
    ) -> tuple[FootCommand, FootCommand]:
        """Commands ``foot``, and the other foot to stay planted."""
        planted = self.feet[1 - foot]
        other = tick.tools.balance.in_contact(
            tick.observation, 1 - foot, planted=planted
        )
        return (command, other) if foot == LEFT else (other, command)

    # ---- what STEP reports ---------------------------------------------------

    @property
    def reported(self) -> Footstep | None:
        """The present or last step, if any."""
        return None

    def time_left(self, settle: float) -> float:
        """Computes the time until both feet carry load on the planned ground [s]."""
        return 0.0

    def paths(self, omega: float) -> PlannedPaths:
        """Returns the paths of the weight shift; in single support, of the foot."""
        shift = self.shift
        times = np.arange(self.shift_time, shift.duration, TIME_STEP)
        if times.size < 2:
            return PlannedPaths()
        dcm, cop = sampled(lambda time: shift.evaluate(time, omega), times)
        com = np.array([shift.motion(time)[0] for time in times])
        return PlannedPaths(com=com, dcm=dcm, cop=cop)


@dataclass(frozen=True, kw_only=True)
class Stepping(StepPhase):
    """Common part of the phases of a step: ``Shift``, ``Swing`` and ``Settle``."""

    sent: Footstep  # The step as requested
    step: Footstep  # The same step as executed
    path: SwingPath  # Path of the swing foot

    @property
    def stance(self) -> int:
        """The foot that stays on the ground."""
        return 1 - self.step.foot

    @property
    def reported(self) -> Footstep:
        """The step being taken."""
        return self.step
