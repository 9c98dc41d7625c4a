"""Feeds any number of footsteps to WALK, four at a time.

Makes commands from steps and reports; the caller plans the steps and publishes the
commands.
"""

from __future__ import annotations

from collections.abc import Sequence

from atlas_drake.messages import (
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
)

AHEAD = 2
"""Number of steps in the queue and not begun at which the next steps are sent:
early enough that WALK never waits, late enough for a queue of four."""

ANSWER = 0.02
"""Time after which a report reflects a command [s]: two control ticks of 9 ms."""


class StepStream:
    """One walk over given steps, for a robot that is not in WALK yet.

    Steps are counted from 1, as at the start of a walk.

    Call ``next_command`` about ten times a second, publish the result, and continue
    until ``is_over`` returns True. For a behavior that is derived from WALK, set the
    ``behavior`` of each command.
    """

    def __init__(self, steps: Sequence[AtlasBehaviorStepData]):
        """Takes the steps of a whole walk.

        Args:
            steps: In order, counted from 1.

        Raises:
            ValueError: If a step's index is not its place in the order.
        """
        for index, step in enumerate(steps, 1):
            if step.step_index != index:
                text = f"steps[{index - 1}].step_index is {step.step_index}"
                raise ValueError(f"{text}, and not {index}")
        self._steps = tuple(steps)
        self._sent = 0
        self._sent_at = 0.0

    def next_command(
        self, report: AtlasSimInterfaceState
    ) -> AtlasSimInterfaceCommand | None:
        """Returns the command to publish now; None if there is nothing to command.

        Args:
            report: Latest report of the behaviors.
        """
        if self._sent == len(self._steps) or self.is_over(report):
            return None
        if self._sent and not self._wants_more(report):
            return None
        first = self._sent
        queue = self._steps[first : first + NUM_REQUIRED_WALK_STEPS]
        command = AtlasSimInterfaceCommand()
        command.behavior = command.WALK
        for place, step in enumerate(queue):
            command.walk_params.step_queue[place] = step
        self._sent = first + len(queue)
        self._sent_at = report.header.stamp or 0.0
        return command

    def is_over(self, report: AtlasSimInterfaceState) -> bool:
        """Returns True once the walk has ended, completed or not.

        The events of the run tell if the walk was completed.

        Args:
            report: Latest report of the behaviors.
        """
        if not self._steps:
            return True
        passed = (report.header.stamp or 0.0) - self._sent_at
        answered = self._sent > 0 and passed > ANSWER
        return answered and not report.walk_feedback.is_active

    def _wants_more(self, report: AtlasSimInterfaceState) -> bool:
        walk = report.walk_feedback
        known = walk.next_step_index_needed - walk.current_step_index - 1
        return walk.next_step_index_needed > self._sent and known <= AHEAD
