"""The whole-body QP: accelerations, contact wrenches and efforts of one tick.

Minimizes the weighted errors of a ``WholeBodyCommand``'s tasks subject to the
floating-base dynamics and the constraints: Wensing, Orin, "Generation of dynamic
humanoid behaviors through task-space control with conic optimization", ICRA 2013;
Kuindersma et al., "Optimization-based locomotion planning, estimation, and control
design for the Atlas humanoid robot", Autonomous Robots 2016; Koolen et al., "Design of
a momentum-based control framework and application to the humanoid robot Atlas",
International Journal of Humanoid Robotics 2016. The QP has no state and makes no plan.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.gains import ControlGains, QpWeights
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.constraints import (
    INFINITE,
    Block,
    Constraint,
    EffortBounds,
    FrictionCones,
    JointLimits,
)
from atlas_drake.control.whole_body.contact import WRENCH, Contact
from atlas_drake.control.whole_body.diagnosis import why_unsolved
from atlas_drake.control.whole_body.elimination import BASE, ReducedDynamics, TaskStack
from atlas_drake.control.whole_body.quadratic_program import (
    INEQUALITY,
    SOFT,
    QuadraticProgram,
    solve,
)
from atlas_drake.control.whole_body.tasks import PostureTask, shaped
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.robot import Robot
from atlas_drake.units import GRAVITY


@dataclass(frozen=True)
class WholeBodySolution:
    """Solution of the QP; n joints in message order.

    Attributes:
        effort: Joint efforts [N·m], shape (n,), within the given bounds up to the
            solver's tolerance.
        joint_acceleration: [rad/s²], shape (n,).
        contact_wrenches: Wrench on each contact's frame at its origin, in W
            [N·m; N], shape (6,), by the name of the frame.
        found: False when there was no solution; the other fields then hold gravity
            compensation.
        iterations: Active-set changes of the solver.
        why: Why there was no solution, in words, as far as it is known.
    """

    effort: np.ndarray
    joint_acceleration: np.ndarray
    contact_wrenches: dict[str, np.ndarray]
    found: bool
    iterations: int
    why: str = ""


class WholeBodyQp:
    """Builds and solves the QP for one robot. Holds constants only."""

    def __init__(self, robot: Robot, gains: ControlGains):
        self._joint_limits = JointLimits(robot, gains.joint_limits)
        self._weights = gains.weights

    def solve(
        self, terms: WholeBodyTerms, command: WholeBodyCommand, bounds: EffortBounds
    ) -> WholeBodySolution:
        """Finds the efforts for one tick.

        Args:
            terms: Model terms at the tick's state.
            command: Tasks, contacts and constraints.
            bounds: Range of each joint's effort.

        Raises:
            RobotDescriptionError: If a task or contact names a frame that the robot
                does not have.
        """
        contacts = command.contacts
        stack = TaskStack(command.tasks, terms, contacts)
        dynamics = ReducedDynamics(terms, contacts, stack)
        for name in ("target", "weight"):
            given = getattr(command.posture, name)
            shaped(given, (len(terms.q),), name, "the command's posture")
        posture = within_behavior_share(command.posture, terms, bounds, self._weights)
        H, f = _cost(dynamics, stack, posture)
        constraints: list[Constraint] = [bounds, FrictionCones(contacts)]
        constraints += command.constraints
        program = self._program(dynamics, bounds, constraints, H, f)
        answer = solve(program)
        if not answer.found:
            why = why_unsolved(terms, command, program, constraints)
            return _gravity_compensation(terms, bounds, contacts, why)
        n = dynamics.num_joints
        wrenches = answer.x[n:].reshape(-1, WRENCH)
        return WholeBodySolution(
            effort=dynamics.effort[:, :-1] @ answer.x + dynamics.effort[:, -1],
            joint_acceleration=answer.x[:n],
            contact_wrenches={
                contact.frame: wrench
                for contact, wrench in zip(contacts, wrenches, strict=True)
            },
            found=True,
            iterations=answer.iterations,
        )

    def _program(
        self,
        dynamics: ReducedDynamics,
        bounds: EffortBounds,
        constraints: Sequence[Constraint],
        H: np.ndarray,
        f: np.ndarray,
    ) -> QuadraticProgram:
        """Stacks the blocks of the constraints."""
        n, size = dynamics.num_joints, dynamics.size
        num_rows = [constraint.num_rows for constraint in constraints]
        rows = sum(num_rows)
        A = np.zeros((rows, size))
        lower = np.full(size + rows, -INFINITE)
        upper = np.full(size + rows, INFINITE)
        kind = np.full(size + rows, INEQUALITY, dtype=np.int32)
        kind[:n] = SOFT
        self._joint_limits.write(dynamics, bounds, lower[:n], upper[:n])
        end = 0
        for constraint, k in zip(constraints, num_rows, strict=True):
            start, end = end, end + k
            part = slice(size + start, size + end)
            block = Block(A[start:end], lower[part], upper[part], kind[part])
            constraint.write(dynamics, block)
        return QuadraticProgram(H, f, A, lower, upper, kind)


def _gravity_compensation(
    terms: WholeBodyTerms, bounds: EffortBounds, contacts: Sequence[Contact], why: str
) -> WholeBodySolution:
    """Computes efforts that balance gravity alone, the weight shared by contacts."""
    effort = terms.h[BASE:].copy()
    total = sum(contact.support_share for contact in contacts)
    wrenches = {}
    for contact in contacts:
        wrench = wrenches[contact.frame] = np.zeros(WRENCH)
        if contact.support_share > 0.0:
            wrench[5] = terms.mass * GRAVITY * (contact.support_share / total)
            effort -= terms.frame(contact.frame).J_WF[:, BASE:].T @ wrench
    return WholeBodySolution(
        effort=np.clip(effort, bounds.lower, bounds.upper),
        joint_acceleration=np.zeros(len(effort)),
        contact_wrenches=wrenches,
        found=False,
        iterations=0,
        why=why,
    )


def within_behavior_share(
    posture: PostureTask,
    terms: WholeBodyTerms,
    bounds: EffortBounds,
    weights: QpWeights,
) -> PostureTask:
    """Limits the posture to what the behavior's share of each joint can achieve.

    The user decides the motion of a joint under user control. A posture target for such
    a joint, or for a shared joint beyond what the behavior's share can do, would make
    the QP move the joint through its neighbors. The weight therefore fades with the
    behavior's share, and the target is an acceleration that the total effort can give.
    """
    if bounds.behavior_weight is None or bounds.added_inertia is None:
        return posture
    inertia = terms.M.diagonal()[BASE:] + bounds.added_inertia
    gravity = terms.h[BASE:]
    lowest, highest = bounds.lower - gravity, bounds.upper - gravity
    target = np.minimum(np.maximum(posture.target, lowest / inertia), highest / inertia)
    fading = bounds.behavior_weight**2 / (
        1.0 + weights.user_yielding * (1.0 - bounds.behavior_weight)
    )
    return PostureTask(
        target, np.maximum(posture.weight * fading, weights.least_posture)
    )


def _cost(
    dynamics: ReducedDynamics, stack: TaskStack, posture: PostureTask
) -> tuple[np.ndarray, np.ndarray]:
    """Adds up ½ ‖error‖²_weight of all tasks, and the cost of the contact wrenches.

    Args:
        dynamics: Dynamics of the tick, reduced together with the stack.
        stack: All tasks but the posture.
        posture: The posture task, whose weights go on the diagonal.

    Returns:
        Hessian H ∈ R^{size × size} and gradient f ∈ R^{size} at z = 0.
    """
    n, size = dynamics.num_joints, dynamics.size
    rows = dynamics.tasks
    R = rows[:, :size]
    weighted = R.T * stack.weight
    H = weighted @ R
    f = weighted @ (rows[:, size] - stack.target)
    diagonal = np.empty(size)
    diagonal[:n] = posture.weight
    for k, contact in enumerate(dynamics.contacts):
        start = n + WRENCH * k
        diagonal[start : start + 3] = contact.moment_weight
        diagonal[start + 3 : start + 6] = contact.force_weight
    H.reshape(-1)[:: size + 1] += diagonal
    f[:n] -= posture.weight * posture.target
    return H, f
