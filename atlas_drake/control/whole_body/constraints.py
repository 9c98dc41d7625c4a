"""Bounds of the whole-body QP: joint limits, efforts, friction, and a user's own.

Every constraint says how many rows it has and writes them into its block of the
program. What is asked within the bounds is the business of ``tasks``.
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
from atlas_drake.control.whole_body.shapes import shaped, task_name
from atlas_drake.control.whole_body.tasks import Task
from atlas_drake.robot import Robot

INFINITE = 1e30
"""What the solver takes for infinity."""


class Block(NamedTuple):
    """Views of a constraint's own part of the program: lower ≤ A z ≤ upper.

    All of it is preset: A zero, the bounds infinite, every kind INEQUALITY.

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

    A hard bound that nothing can keep leaves the QP without a solution, and the robot
    with gravity compensation: make bounds on motions soft.

    Attributes:
        task: Whose rows are bounded; its target and weight do not count.
        lower: Lower bounds in the unit of the task's target, shape (k,).
        upper: Upper bounds, shape (k,).
        soft: Whether the bounds yield where they contradict others.
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
    """What each joint's effort can be this tick, in message order.

    A joint that the behavior commands alone ranges over its limits; a joint under user
    control has its user's effort as both bounds; a blend lies between.

    Attributes:
        lower: Least total effort [N·m], shape (n,).
        upper: Greatest total effort [N·m], shape (n,).
        user_held: Joints whose effort the user decides alone, bool, shape (n,).
        added_inertia: By how much the bounds fall per acceleration of the joint,
            because the user's law resists it [kg·m²], shape (n,); None for nowhere.
        authority: The behavior's share of each joint, 0 to 1, shape (n,); None for 1
            everywhere.
    """

    lower: np.ndarray
    upper: np.ndarray
    user_held: np.ndarray
    added_inertia: np.ndarray | None = None
    authority: np.ndarray | None = None

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
    """Wrenches that contacts can give: friction, center of pressure, normal force.

    Attributes:
        contacts: All contacts, in the order of their wrenches among the unknowns.
    """

    contacts: Sequence[Contact]

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
            turned = contact.patch.cone_vectors @ R_FW
            A[start:end, column : column + WRENCH] = turned.reshape(-1, WRENCH)
            column += WRENCH
            lower[end - 1] = contact.min_normal_force
            upper[end - 1] = contact.max_normal_force


class JointLimits:
    """Soft bounds on joint accelerations that bring a joint to rest at its limits."""

    def __init__(self, robot: Robot, gains: JointLimitGains):
        self._gains = gains
        self._low = gains.kp * (robot.position_lower + gains.margin)
        self._high = gains.kp * (robot.position_upper - gains.margin)

    def write(
        self,
        dynamics: ReducedDynamics,
        bounds: EffortBounds,
        lower: np.ndarray,
        upper: np.ndarray,
    ) -> None:
        """Writes the bounds of the joint accelerations [rad/s²].

        A joint that the user has a share of is not the behavior's to bound: it would
        throw the whole body about to hold one that the user drives into its stop.

        Args:
            dynamics: The tick's dynamics.
            bounds: Who commands the joints.
            lower: Lower bounds to fill in, preset to infinite, shape (n,).
            upper: Upper bounds, likewise.
        """
        terms = dynamics.terms
        approach = self._gains.kp * terms.q + self._gains.kd * terms.v
        np.subtract(self._low, approach, out=lower)
        np.subtract(self._high, approach, out=upper)
        if bounds.authority is not None:
            shared = bounds.authority < 1.0
            lower[shared] = -INFINITE
            upper[shared] = INFINITE
