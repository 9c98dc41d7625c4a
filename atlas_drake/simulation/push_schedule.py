"""When the pushes of a scenario begin: at their times, or with the gait.

Remembers one run. The forces themselves are in ``pushes``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.errors import InvalidMessageError, ScenarioError
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.robot import Robot
from atlas_drake.scenario.pushes import PlannedPush
from atlas_drake.simulation.gait_watch import GaitWatch
from atlas_drake.simulation.pushes import make_push


class PushSchedule:
    """The pushes of one run that have not begun."""

    def __init__(self, plans: Sequence[PlannedPush], robot: Robot) -> None:
        """Begins a run.

        Raises:
            ScenarioError: If the robot lacks a body that is to be pushed.
        """
        self._timed: list[tuple[float, PlannedPush]] = []
        self._awaited: list[tuple[PlannedPush, int]] = []
        for index, plan in enumerate(plans):
            try:
                body = plan.body or robot.file.chest
                make_push(robot.body_names, body, plan.force(0.0), plan.duration, 0.0)
            except InvalidMessageError as error:
                field = f"pushes[{index}].{error.field}"
                raise ScenarioError(field, error.value, error.problem) from None
            if plan.time is None:
                self._awaited.append((plan, plan.count))
            else:
                self._timed.append((plan.time, plan))
        self._watch = GaitWatch(robot.mass * GRAVITY)

    @property
    def awaits_gait(self) -> bool:
        """True if a push depends on what the feet will do."""
        return bool(self._awaited)

    @property
    def next_time(self) -> float:
        """When the next push begins, as far as that is known [s]; infinite for none."""
        return min((time for time, _ in self._timed), default=math.inf)

    def due(self, time: float) -> list[PlannedPush]:
        """Takes out the pushes that begin by now.

        Args:
            time: Now [s].
        """
        begun = [plan for at, plan in self._timed if at <= time + 1e-9]
        self._timed = [entry for entry in self._timed if entry[0] > time + 1e-9]
        return begun

    def look(self, time: float, wrenches: np.ndarray, time_left: float) -> None:
        """Takes in what the feet did in a control tick.

        Args:
            time: Now [s].
            wrenches: Of the ground on the soles [N·m; N], shape (12,).
            time_left: Until the next touchdown as the behavior plans it [s].
        """
        for event in self._watch.look(time, wrenches):
            still = []
            for plan, count in self._awaited:
                of_foot = plan.foot in ("any", ("left", "right")[event.foot])
                left = count - (of_foot and plan.phase == event.phase)
                if left:
                    still.append((plan, left))
                else:
                    begin = time + plan.delay + plan.fraction * time_left
                    self._timed.append((begin, plan))
            self._awaited = still


def time_to_touchdown(status: ControllerStatus) -> float:
    """Time until the next touchdown as the active behavior plans it [s]; else 0."""
    return max(0.0, status.walk_feedback.t_step_rem, status.step_feedback.t_step_rem)
