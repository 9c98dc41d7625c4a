"""The command of a behavior to the whole-body QP for one control tick."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.whole_body.constraints import Constraint
from atlas_drake.control.whole_body.contact import Contact
from atlas_drake.control.whole_body.tasks import PostureTask, Task
from atlas_drake.errors import shown
from atlas_drake.frozen import replace


@dataclass(frozen=True)
class WholeBodyCommand:
    """Tasks, contacts and constraints of one tick.

    Attributes:
        posture: Accelerations of all joints. Required, with a positive weight for
            each joint: it determines every motion that the tasks leave free.
        tasks: Open list of tasks, met as well as their weights allow.
        contacts: Open list of contacts with the surroundings. A frame without a contact
            gets no force.
        constraints: Open list of bounds beyond those that always hold (joint limits,
            effort bounds, friction).
    """

    posture: PostureTask
    tasks: tuple[Task, ...]
    contacts: tuple[Contact, ...]
    constraints: tuple[Constraint, ...] = ()

    def plus(
        self,
        *tasks: Task,
        contacts: Iterable[Contact] = (),
        constraints: Iterable[Constraint] = (),
    ) -> WholeBodyCommand:
        """Returns the command with more tasks, contacts and constraints.

        Args:
            *tasks: Appended to the tasks.
            contacts: Appended to the contacts.
            constraints: Appended to the constraints.

        Raises:
            TypeError: If a task is none.
        """
        for task in tasks:
            if not isinstance(task, Task):
                raise TypeError(f"tasks must be Task values, has {shown(task)}")
        return replace(
            self,
            tasks=(*self.tasks, *tasks),
            contacts=(*self.contacts, *contacts),
            constraints=(*self.constraints, *constraints),
        )

    def with_posture_scaled(
        self, joints: np.ndarray, factor: float
    ) -> WholeBodyCommand:
        """Returns the command with the posture of some joints weighted differently.

        Args:
            joints: Which joints, bool or indices into the messages' order.
            factor: Factor of their weight, positive [-]; small for joints that a task
                moves, such as 0.01 for the arm of a hand task.
        """
        weight = self.posture.weight.copy()
        weight[joints] *= factor
        return replace(self, posture=replace(self.posture, weight=weight))
