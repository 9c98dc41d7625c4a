"""Bounds of the whole-body QP: joint limits, efforts, friction, and the user's own.

Every constraint gives its number of rows and writes them into its block of the program.
Objectives within the bounds are in ``tasks``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from atlas_drake.control.gains import JointLimitGains
from atlas_drake.control.whole_body.contact import WRENCH, Contact
from atlas_drake.control.whole_body.elimination import ReducedDynamics
from atlas_drake.control.whole_body.quadratic_program import EQUALITY, SOFT
from atlas_drake.control.whole_body.tasks import Task, shaped, task_name
from atlas_drake.robot import Robot

INFINITE = 1e30
"""Value that the solver treats as infinite."""


class Block(NamedTuple):
    """Views of one constraint's part of the program: lower ≤ A z ≤ upper.

    The preset values are zero for A, infinite for the bounds, INEQUALITY for every
    kind.

    Attributes:
        A: A ∈ R^{k × size}.
        lower: Lower bounds, shape (k,).
        upper: Upper bounds, shape (k,).
        kind: Kinds of constraint, see ``quadratic_program``, int32, shape (k,).
    """

    A: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    kind: np.ndarray


class Constraint(Protocol):
    """Rows of the program that bound the unknowns."""

    @property
    def num_rows(self) -> int:
        """Number of rows k."""

    def write(self, dynamics: ReducedDynamics, block: Block) -> None:
        """Fills in the constraint's block of the program.

        Args:
            dynamics: The tick's dynamics; turns rows on accelerations into rows on
                the unknowns.
            block: The k rows to fill in.
        """


@dataclass(frozen=True)
class TaskBounds:
    """Keeps the quantities of a task between bounds: lower ≤ A v̇ + b + G λ ≤ upper.

    An infeasible hard bound leaves the QP without a solution, and the robot falls back
    to gravity compensation: make bounds on motions soft.

    Attributes:
        task: Task whose rows are bounded; its target and weight are ignored.
        lower: Lower bounds in the unit of the task's target, shape (k,).
        upper: Upper bounds, shape (k,).
        soft: True if the bounds yield where they contradict others.
    """

    task: Task
    lower: np.ndarray
    upper: np.ndarray
    soft: bool = True

    @property
    def num_rows(self) -> int:
        """Dimension of the task."""
        return self.task.dimension

    def write(self, dynamics: ReducedDynamics, block: Block) -> None:
        """Writes the task's rows and the bounds less their constant part."""
        rows = dynamics.rows_of(self.task)
        owner = f"TaskBounds of {task_name(self.task)}"
        if len(rows) != self.num_rows:
            raise ValueError(
                f"target of {owner} must have shape ({len(rows)},), one for each row, "
                f"has {np.shape(self.task.target)}"
            )
        for name in ("lower", "upper"):
            bound = getattr(self, name)
            shaped(bound, (len(rows),) if np.ndim(bound) else (), name, owner)
        block.A[:] = rows[:, :-1]
        block.lower[:] = np.maximum(self.lower - rows[:, -1], -INFINITE)
        block.upper[:] = np.minimum(self.upper - rows[:, -1], INFINITE)
        if self.soft:
            block.kind[:] = SOFT


@dataclass(frozen=True)
class EffortBounds:
    """Range of each joint's effort in this tick, in message order.

    A joint that the behavior controls alone has its effort limits as bounds; a joint
    under user control has the user's effort as both bounds; a blend lies between.

    Attributes:
        lower: Least total effort [N·m], shape (n,).
        upper: Greatest total effort [N·m], shape (n,).
        user_held: Joints whose effort the user decides alone, bool, shape (n,).
        added_inertia: Decrease of the bounds per acceleration of the joint, because the
            user's law resists it [kg·m²], shape (n,); None for zero.
        behavior_weight: Blend weight 1 - k of the behavior for each joint, 0 to 1,
            shape (n,); None for 1 everywhere.
    """

    lower: np.ndarray
    upper: np.ndarray
    user_held: np.ndarray
    added_inertia: np.ndarray | None = None
    behavior_weight: np.ndarray | None = None

    @property
    def num_rows(self) -> int:
        """Number of joints."""
        return len(self.lower)

    def write(self, dynamics: ReducedDynamics, block: Block) -> None:
        """Writes the efforts' rows; efforts that the user decides are equalities."""
        A, constant = dynamics.effort[:, :-1], dynamics.effort[:, -1]
        block.A[:] = A
        np.subtract(self.lower, constant, out=block.lower)
        np.subtract(self.upper, constant, out=block.upper)
        block.kind[self.user_held] = EQUALITY
        if self.added_inertia is not None:
            joints = np.arange(len(constant))
            block.A[joints, joints] += self.added_inertia


class FrictionCones(NamedTuple):
    """Limits of the contact wrenches: friction, center of pressure, normal force."""

    contacts: Sequence[Contact]  # In the order of their wrenches in z

    @property
    def num_rows(self) -> int:
        """Rows of all patches' cones."""
        return sum([contact.patch.num_rows for contact in self.contacts])

    def write(self, dynamics: ReducedDynamics, block: Block) -> None:
        """Writes the cones, turned from the contacts' frames to W."""
        A, lower, upper, _ = block
        upper[:] = 0.0
        column, end = dynamics.num_joints, 0
        for contact in self.contacts:
            start, end = end, end + contact.patch.num_rows
            R_FW = dynamics.terms.frame(contact.frame).R_WF.T
            # Moment and force turn alike: six columns as two rows of three.
            turned = contact.patch.cone.reshape(-1, 3) @ R_FW
            A[start:end, column : column + WRENCH] = turned.reshape(-1, WRENCH)
            column += WRENCH
            lower[end - 1] = contact.min_normal_force
            upper[end - 1] = contact.max_normal_force


class JointLimits:
    """Soft bounds on joint accelerations that bring legs and back to rest at limits.

    Arms have none: a wrist of half a newton meter cannot keep what a jolt asks of it,
    and the whole body would move in its stead.
    """

    def __init__(self, robot: Robot, gains: JointLimitGains):
        self._gains = gains
        arms = robot.limb("l_arm", "r_arm")
        low = gains.kp * (robot.position_lower + gains.margin)
        high = gains.kp * (robot.position_upper - gains.margin)
        self._low = np.where(arms, -INFINITE, low)
        self._high = np.where(arms, INFINITE, high)

    def write(
        self,
        dynamics: ReducedDynamics,
        bounds: EffortBounds,
        lower: np.ndarray,
        upper: np.ndarray,
    ) -> None:
        """Writes the bounds of the joint accelerations [rad/s²], preset to infinite.

        A joint with a user share above 0 is not bounded: the QP would accelerate the
        whole body to hold a joint that the user drives into its stop.
        """
        terms = dynamics.terms
        approach = self._gains.kp * terms.q + self._gains.kd * terms.v
        np.subtract(self._low, approach, out=lower)
        np.subtract(self._high, approach, out=upper)
        if bounds.behavior_weight is not None:
            shared = bounds.behavior_weight < 1.0
            lower[shared] = -INFINITE
            upper[shared] = INFINITE
