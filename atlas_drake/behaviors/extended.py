"""A behavior with additions to its command or feedback, composed from another one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.frozen import replace
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan, PlannedPaths


class Extended(BehaviorProtocol):
    """Runs a behavior, and changes its command or its feedback."""

    def __init__(
        self,
        behavior: BehaviorProtocol,
        command: Callable[[WholeBodyCommand, Observation], WholeBodyCommand]
        | None = None,
        feedback: Callable[[Any], Any] | None = None,
    ):
        """Extends ``behavior``.

        Args:
            behavior: The behavior, such as one that ``shipped_entry`` makes.
            command: Returns the command with further tasks, for example, at each tick.
            feedback: Returns the feedback from the behavior's state.
        """
        self._behavior = behavior
        self._command = command
        self._feedback = feedback

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> Any:
        """Enters the behavior."""
        return self._behavior.enter(observation, body, request)

    def update(
        self,
        state: Any,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick of the behavior, and changes its command."""
        outcome = self._behavior.update(state, observation, body, request, leaving)
        if self._command is None or outcome.command is None:
            return outcome
        return replace(outcome, command=self._command(outcome.command, observation))

    def feedback(self, state: Any, status_flags: int) -> Any:
        """Returns the changed feedback, or the behavior's own."""
        if self._feedback is not None:
            return self._feedback(state)
        return self._behavior.feedback(state, status_flags)

    def plan(self, state: Any, com: np.ndarray, omega: float) -> Plan:
        """Returns the behavior's plan."""
        return self._behavior.plan(state, com, omega)

    def paths(self, state: Any, com: np.ndarray, omega: float) -> PlannedPaths:
        """Returns the behavior's paths."""
        return self._behavior.paths(state, com, omega)
