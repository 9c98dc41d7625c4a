"""What the phases of STEP add to the shared framework: the legs' reach and the CoP."""

from __future__ import annotations

from abc import abstractmethod
from typing import TypeVar

import numpy as np

from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.phases import PhaseControl
from atlas_drake.behaviors.step.phases import StepPhase
from atlas_drake.behaviors.step.step_balance import Reach, StepBalance
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.support_polygon import SupportPolygon

P = TypeVar("P", bound=StepPhase)


class StepPhaseControl(PhaseControl[P]):
    """Computes the ticks of a phase of STEP and its end. Holds constants only.

    Balance has priority over the loads of a phase: a foot with too large or too small a
    load would keep the CoP away from its desired position.
    """

    def __init__(self, balance: StepBalance):
        self._balance = balance

    @abstractmethod
    def reach(self, phase: P) -> Reach:
        """Returns the sole poses that the legs have to reach, and the body's height."""

    def reference(
        self, phase: P, observation: Observation
    ) -> tuple[DcmReference, float]:
        """Computes the references of DCM and CoP, and the pendulum's frequency."""
        omega = self._balance.omega(observation, phase.carrying)
        return phase.dcm_reference(omega), omega

    def cop(self, phase: P, observation: Observation) -> np.ndarray:
        """Computes the desired CoP in W [m], shape (2,)."""
        reference, omega = self.reference(phase, observation)
        support = self.support(phase)
        return self._balance.balance.wanted_cop(observation, reference, omega, support)

    def support(self, phase: P) -> SupportPolygon:
        """Returns the present region of the CoP."""
        return phase.support

    def are_both_flat(self, phase: P) -> bool:
        """Returns True if both soles are flat on the ground."""
        return True
