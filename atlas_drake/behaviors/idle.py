"""NONE and USER: no behavior acts.

In USER every joint is the user's; in NONE joints that the user does not hold get no
effort at all.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.base import Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, capture_body
from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan


class Idle:
    """Does nothing and remembers nothing."""

    def enter(
        self,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> None:
        """There is nothing to note."""

    def update(
        self,
        memory: None,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """One tick: the body reference follows the robot."""
        return Outcome(memory=None, body=capture_body(observation.terms), command=None)

    def plan(self, memory: None, com: np.ndarray, omega: float) -> Plan:
        """Nothing is planned."""
        return Plan()

    def report(self, memory: None, state: AtlasSimInterfaceState) -> None:
        """There is nothing to report beyond the behavior's name."""
