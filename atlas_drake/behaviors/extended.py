"""A behavior whose command is extended, composed from another behavior."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.frozen import replace
from atlas_drake.messages.commands import BehaviorRequest


class Extended:
    """Runs a behavior, and extends its command, with one more task for example."""

    def __init__(
        self,
        behavior: BehaviorProtocol,
        extend: Callable[[WholeBodyCommand, Observation], WholeBodyCommand],
    ):
        """Extends ``behavior``, such as one that ``shipped_entry`` makes."""
        self._behavior = behavior
        self._extend = extend

    def __getattr__(self, name: str) -> Any:
        """Returns all other methods of the behavior."""
        return getattr(self._behavior, name)

    def update(
        self,
        state: Any,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick of the behavior, and extends its command."""
        outcome = self._behavior.update(state, observation, body, request, leaving)
        if outcome.command is None:
            return outcome
        return replace(outcome, command=self._extend(outcome.command, observation))
