"""NONE and USER: no behavior acts.

In USER all joints are under user control; in NONE all joints that are not under user
control get zero effort.
"""

from __future__ import annotations

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, capture_body
from atlas_drake.messages.commands import BehaviorRequest


class Idle(BehaviorProtocol):
    """Commands no effort and has no state."""

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> None:
        """Returns no state."""

    def update(
        self,
        state: None,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick: the body reference follows the robot."""
        return Outcome(state=None, body=capture_body(observation.terms), command=None)
