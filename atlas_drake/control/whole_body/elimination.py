"""The unknowns of the whole-body QP, and everything else as rows on them.

The unknowns are z = [q̈; λ]: the n joint accelerations and one wrench per contact.
The pelvis' acceleration is eliminated with the six rows of the dynamics that no motor
acts on, which makes the QP smaller and those rows exact; the other rows give the
efforts, as in Herzog et al., "Momentum control with hierarchical inverse dynamics on a
torque-controlled humanoid", Autonomous Robots 2016.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from atlas_drake.control.whole_body.contact import WRENCH, Contact
from atlas_drake.control.whole_body.tasks import Task, TaskRows, shaped, task_name
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.errors import shown

BASE = 6
"""Number of generalized velocities of the free pelvis."""
_NONE = np.empty(0)


class TaskStack:
    """Tasks with their rows at one state, those with rows on accelerations first.

    Rows on the contact wrenches alone need no elimination, which keeps the products
    small.

    Attributes:
        target: Targets of all rows.
        weight: Weights of all rows.
        A: A ∈ R^{k × n_v} of each task with rows on accelerations.
        b: Constant parts of the rows on accelerations, b ∈ R^k.
        G: G ∈ R^{k × 6 c} of each task with rows on the contact wrenches alone.
        g: Constant parts of the rows on the contact wrenches alone.
        mixed: Tasks that have both: first row and G ∈ R^{k × 6 c}.
    """

    __slots__ = ("A", "G", "b", "g", "mixed", "target", "weight")

    def __init__(
        self, tasks: Sequence[Task], terms: WholeBodyTerms, contacts: Sequence[Contact]
    ):
        self.A: list[np.ndarray] = []
        self.b: list[np.ndarray] = []
        self.G: list[np.ndarray] = []
        self.g: list[np.ndarray] = []
        self.mixed: list[tuple[int, np.ndarray]] = []
        moving: list[Task] = []
        others: list[Task] = []
        for task in tasks:
            A, b, G = rows_of(task, terms, contacts)
            shaped(task.target, b.shape, "target", task)
            if not isinstance(task.weight, float):
                shape = b.shape if np.ndim(task.weight) else ()
                shaped(task.weight, shape, "weight", task)
            if A is not None:
                if G is not None:
                    self.mixed.append((sum(map(len, self.b)), G))
                moving.append(task)
                self.A.append(A)
                self.b.append(b)
            elif G is not None:
                others.append(task)
                self.G.append(G)
                self.g.append(b)
        ordered = moving + others
        self.target = np.concatenate([_NONE, *[task.target for task in ordered]])
        self.weight = np.concatenate([_NONE, *map(_weights, ordered)])


def _weights(task: Task) -> np.ndarray:
    """Returns one weight for each row of a task."""
    weight = task.weight
    if isinstance(weight, np.ndarray) and weight.ndim:
        return weight
    return np.full(len(task.target), weight)


def rows_of(task: Task, terms: WholeBodyTerms, contacts: Sequence[Contact]) -> TaskRows:
    """Returns the rows of a task as arrays, checked: a user's own may be anything.

    Args:
        task: Whose rows.
        terms: Model terms of the tick.
        contacts: In the order of their wrenches.

    Raises:
        TypeError: If the task returns no rows.
        ValueError: If their shapes do not fit the robot and the contacts; it names the
            task.
    """
    rows = task.rows(terms, contacts)
    if not (isinstance(rows, tuple) and len(rows) == len(TaskRows._fields)):
        raise TypeError(
            f"rows of {task_name(task)} must return TaskRows, returned {shown(rows)}"
        )
    A, b, G = rows
    k = np.size(b)
    wrenches = WRENCH * len(contacts)
    return TaskRows(
        None if A is None else shaped(A, (k, len(terms.h)), "A", task),
        shaped(b, (k,), "b", task),
        None if G is None else shaped(G, (k, wrenches), "G", task),
    )


class ReducedDynamics:
    """The equations of motion of one tick in the unknowns z ∈ R^{size}.

    Attributes:
        terms: Model terms of the tick.
        contacts: In the order of their wrenches in z.
        num_joints: Number of joints n.
        size: Number of unknowns n + 6 c.
        effort: Joint efforts [N·m] as rows R ∈ R^{n × (size + 1)} on [z; 1].
        tasks: Quantities of the stacked tasks, as rows on [z; 1].
    """

    def __init__(
        self, terms: WholeBodyTerms, contacts: Sequence[Contact], stack: TaskStack
    ):
        self.terms = terms
        self.contacts = contacts
        self.num_joints = n = len(terms.q)
        self.size = size = n + WRENCH * len(contacts)
        J = [terms.frame(contact.frame).J_WF for contact in contacts]
        M, h = terms.M, terms.h
        J_contacts = np.concatenate(J) if J else np.empty((0, n + BASE))
        right = np.empty((BASE, size + 1))
        np.negative(M[:BASE, BASE:], out=right[:, :n])
        right[:, n:size] = J_contacts[:, :BASE].T
        np.negative(h[:BASE], out=right[:, size])
        # Acceleration of the pelvis as X [z; 1].
        self._X = np.linalg.solve(M[:BASE, :BASE], right)

        # One product for efforts and motions together: many small ones cost more.
        A = np.concatenate([M[BASE:], *stack.A])
        b = np.concatenate([h[BASE:], *stack.b])
        g = np.concatenate(stack.g) if stack.g else b[:0]
        end = len(A)
        rows = np.empty((end + len(g), size + 1))
        self._reduce(A, b, rows[:end])
        rows[:n, n:size] -= J_contacts[:, BASE:].T
        for start, G in stack.mixed:
            rows[n + start : n + start + len(G), n:size] += G
        if len(g):
            rows[end:, :n] = 0.0
            np.concatenate(stack.G, out=rows[end:, n:size])
            rows[end:, size] = g
        self.effort, self.tasks = rows[:n], rows[n:]

    def rows_of(self, task: Task) -> np.ndarray:
        """Returns the quantities of one task as rows R ∈ R^{k × (size + 1)}."""
        n = self.num_joints
        A, b, G = rows_of(task, self.terms, self.contacts)
        rows = np.empty((len(b), self.size + 1))
        self._reduce(np.zeros((len(b), n + BASE)) if A is None else A, b, rows)
        if G is not None:
            rows[:, n : self.size] += G
        return rows

    def _reduce(self, A: np.ndarray, b: np.ndarray, rows: np.ndarray) -> None:
        """Writes A v̇ + b as rows R ∈ R^{k × (size + 1)}: A v̇ + b = R [z; 1]."""
        np.matmul(A[:, :BASE], self._X, out=rows)
        rows[:, : self.num_joints] += A[:, BASE:]
        rows[:, self.size] += b
