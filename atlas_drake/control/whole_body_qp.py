"""The whole-body QP: accelerations, contact wrenches and efforts of one tick.

Minimises the weighted task errors of a ``WholeBodyCommand`` subject to the
floating-base dynamics, effort bounds, friction and the soles' edges. It plans
nothing and remembers nothing.

The unknowns are z = [joint accelerations; one wrench per foot in contact]. The
pelvis' acceleration is eliminated with the six rows of the dynamics that no motor
acts on, which makes the program smaller and those rows exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.gains import ControlGains
from atlas_drake.control.quadratic_program import (
    EQUALITY,
    INEQUALITY,
    SOFT,
    QuadraticProgram,
    solve,
)
from atlas_drake.control.whole_body_command import EffortBounds, WholeBodyCommand
from atlas_drake.control.whole_body_model import GRAVITY, WholeBodyTerms
from atlas_drake.robot import Robot

_BASE = 6
_WRENCH = 6
_HUGE = 1e30
"""What the solver takes for infinity."""


@dataclass(frozen=True)
class WholeBodySolution:
    """The QP's answer; n joints in message order.

    Attributes:
        effort: Joint efforts within the bounds given [N·m], shape (n,).
        joint_acceleration: [rad/s²], shape (n,).
        foot_wrenches: Wrench of the ground on each sole's centre in W
            [N·m; N], shape (2, 6); zero for a foot in the air.
        found: False when there was no solution; the other fields then hold the
            efforts that only carry the robot's weight.
        iterations: Of the solver.
    """

    effort: np.ndarray
    joint_acceleration: np.ndarray
    foot_wrenches: np.ndarray
    found: bool
    iterations: int


class WholeBodyQp:
    """Builds and solves the QP for one robot. Holds constants only."""

    def __init__(self, robot: Robot, gains: ControlGains):
        self._robot = robot
        self._gains = gains
        self._num_joints = robot.num_joints
        self._cone = _wrench_cone(robot, gains)
        weights = gains.weights
        n = self._num_joints
        self._wrench_weight = np.repeat(
            [weights.contact_moment, weights.contact_force], 3
        )
        self._stance_weight = np.full(6, weights.stance_foot)
        self._swing_weight = np.repeat(
            [weights.swing_foot_orientation, weights.swing_foot_position], 3
        )
        # Constant parts of the constraints for zero, one and two feet in contact.
        self._layouts = [_Layout(n, feet, self._cone.shape[0]) for feet in range(3)]

    def solve(
        self,
        terms: WholeBodyTerms,
        command: WholeBodyCommand,
        bounds: EffortBounds,
    ) -> WholeBodySolution:
        """Finds the efforts for one tick."""
        n = self._num_joints
        contacts = [i for i in (0, 1) if command.feet[i].in_contact]
        size = n + _WRENCH * len(contacts)
        layout = self._layouts[len(contacts)]
        M, h = terms.M, terms.h

        # Pelvis acceleration = B z + b, from the unactuated rows.
        right = np.empty((_BASE, size + 1))
        right[:, :n] = -M[:_BASE, _BASE:]
        for k, i in enumerate(contacts):
            columns = slice(n + _WRENCH * k, n + _WRENCH * (k + 1))
            right[:, columns] = terms.feet[i].J_WF[:, :_BASE].T
        right[:, size] = -h[:_BASE]
        solved = np.linalg.solve(M[:_BASE, :_BASE], right)
        B, b = solved[:, :size], solved[:, size]

        # Efforts = T z + t.
        T = M[_BASE:, :_BASE] @ B
        T[:, :n] += M[_BASE:, _BASE:]
        for k, i in enumerate(contacts):
            columns = slice(n + _WRENCH * k, n + _WRENCH * (k + 1))
            T[:, columns] -= terms.feet[i].J_WF[:, _BASE:].T
        t = M[_BASE:, :_BASE] @ b + h[_BASE:]

        H, f = self._cost(terms, command, contacts, B, b, size)
        problem = self._constrain(terms, command, bounds, contacts, layout, H, f, T, t)
        answer = solve(problem)
        if not answer.found:
            return self._carry_weight(terms, bounds, contacts)
        effort = T @ answer.x + t
        wrenches = np.zeros((2, _WRENCH))
        for k, i in enumerate(contacts):
            wrenches[i] = answer.x[n + _WRENCH * k : n + _WRENCH * (k + 1)]
        return WholeBodySolution(
            effort=effort,
            joint_acceleration=answer.x[:n],
            foot_wrenches=wrenches,
            found=True,
            iterations=answer.iterations,
        )

    def _cost(
        self,
        terms: WholeBodyTerms,
        command: WholeBodyCommand,
        contacts: list[int],
        B: np.ndarray,
        b: np.ndarray,
        size: int,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Hessian and linear cost from all tasks stacked as rows on z."""
        n = self._num_joints
        weights = self._gains.weights
        balance = float(command.balance)
        rows = np.empty((21, 6 + n))
        target = np.empty(21)
        weight = np.empty(21)
        for i in (0, 1):
            part = slice(6 * i, 6 * i + 6)
            foot, wanted = terms.feet[i], command.feet[i]
            rows[part] = foot.J_WF
            target[part] = wanted.acceleration - foot.bias
            weight[part] = (
                self._stance_weight if wanted.in_contact else self._swing_weight
            )
        rows[12:15] = terms.J_chest
        target[12:15] = command.chest_angular_acceleration - terms.chest_bias
        weight[12:15] = balance * weights.chest_orientation
        rows[15:18] = 0.0
        rows[15, 0] = rows[16, 1] = rows[17, 2] = 1.0
        target[15:18] = command.pelvis_angular_acceleration
        weight[15:18] = balance * weights.pelvis_orientation

        tasks = np.empty((21, size))
        base = rows[:18, :_BASE]
        np.matmul(base, B, out=tasks[:18])
        tasks[:18, :n] += rows[:18, _BASE:]
        target[:18] -= base @ b
        # Centre of mass through the contact forces: m·c̈ = Σ F + m·g.
        tasks[18:] = 0.0
        for k in range(len(contacts)):
            start = n + _WRENCH * k + 3
            tasks[18, start] = tasks[19, start + 1] = tasks[20, start + 2] = (
                1.0 / self._robot.mass
            )
        target[18:] = command.com_acceleration
        target[20] += GRAVITY
        weight[18:] = balance * weights.com

        weighted = tasks.T * weight
        H = weighted @ tasks
        f = -(weighted @ target)
        diagonal = H.reshape(-1)[:: size + 1]
        diagonal[:n] += command.joint_weight
        f[:n] -= command.joint_weight * command.joint_acceleration
        for k in range(len(contacts)):
            start = n + _WRENCH * k
            diagonal[start : start + _WRENCH] += self._wrench_weight
        return H, f

    def _constrain(
        self,
        terms: WholeBodyTerms,
        command: WholeBodyCommand,
        bounds: EffortBounds,
        contacts: list[int],
        layout: _Layout,
        H: np.ndarray,
        f: np.ndarray,
        T: np.ndarray,
        t: np.ndarray,
    ) -> QuadraticProgram:
        """Adds bounds on accelerations, efforts and contact wrenches."""
        n = self._num_joints
        A = layout.rows.copy()
        lower, upper = layout.lower.copy(), layout.upper.copy()
        kind = layout.kind.copy()
        low, high = self._acceleration_bounds(terms)
        free = bounds.user_held
        lower[:n] = np.where(free, -_HUGE, low)
        upper[:n] = np.where(free, _HUGE, high)

        size = layout.size
        A[:n] = T
        A[layout.joints, layout.joints] += bounds.added_inertia
        lower[size : size + n] = bounds.lower - t
        upper[size : size + n] = bounds.upper - t
        kind[size : size + n][free] = EQUALITY
        for k, i in enumerate(contacts):
            start = n + _WRENCH * k
            R_FW = terms.feet[i].R_WF.T
            cone_rows = layout.cone_rows(k)
            cone_bounds = slice(size + cone_rows.start, size + cone_rows.stop)
            A[cone_rows, start : start + 3] = self._cone[:, :3] @ R_FW
            A[cone_rows, start + 3 : start + 6] = self._cone[:, 3:] @ R_FW
            last = cone_bounds.stop - 1
            lower[last] = command.feet[i].min_normal_force
            upper[last] = command.feet[i].max_normal_force
        return QuadraticProgram(H, f, A, lower, upper, kind)

    def _acceleration_bounds(
        self, terms: WholeBodyTerms
    ) -> tuple[np.ndarray, np.ndarray]:
        """Bounds on joint accelerations that bring a joint to rest at its limits."""
        robot, limits = self._robot, self._gains.joint_limits
        braking = -limits.kd * terms.v
        low = limits.kp * (robot.position_lower + limits.margin - terms.q) + braking
        high = limits.kp * (robot.position_upper - limits.margin - terms.q) + braking
        return low, high

    def _carry_weight(
        self, terms: WholeBodyTerms, bounds: EffortBounds, contacts: list[int]
    ) -> WholeBodySolution:
        """Efforts that balance gravity alone, the load shared by the feet."""
        n = self._num_joints
        effort = terms.h[_BASE:].copy()
        wrenches = np.zeros((2, _WRENCH))
        for i in contacts:
            wrenches[i, 5] = self._robot.mass * GRAVITY / len(contacts)
            effort -= terms.feet[i].J_WF[:, _BASE:].T @ wrenches[i]
        return WholeBodySolution(
            effort=np.clip(effort, bounds.lower, bounds.upper),
            joint_acceleration=np.zeros(n),
            foot_wrenches=wrenches,
            found=False,
            iterations=0,
        )


class _Layout:
    """Rows, bounds and kinds that are the same every tick for a number of feet."""

    def __init__(self, num_joints: int, feet: int, cone_size: int):
        n = num_joints
        self.size = n + _WRENCH * feet
        self.joints = np.arange(n)
        self._first_cone_row = n
        self._cone_size = cone_size
        rows = n + feet * cone_size
        self.rows = np.zeros((rows, self.size))
        self.lower = np.full(self.size + rows, -_HUGE)
        self.upper = np.full(self.size + rows, _HUGE)
        self.kind = np.full(self.size + rows, INEQUALITY, dtype=np.int32)
        self.kind[:n] = SOFT
        for k in range(feet):
            cone = self.cone_rows(k)
            self.upper[self.size + cone.start : self.size + cone.stop] = 0.0

    def cone_rows(self, k: int) -> slice:
        """Rows of the k-th foot in contact."""
        start = self._first_cone_row + k * self._cone_size
        return slice(start, start + self._cone_size)


def _wrench_cone(robot: Robot, gains: ControlGains) -> np.ndarray:
    """Rows C with C·[moment; force] ≤ 0 in the sole's frame; last row: normal force.

    Friction as a pyramid inside the cone, the centre of pressure inside the sole
    less its margins, and the yaw moment by a lever of friction.
    """
    contact, sole = gains.contact, robot.file.sole
    friction = contact.friction / np.sqrt(2.0)
    x = sole.length / 2 - contact.length_margin
    y = sole.width / 2 - contact.width_margin
    yaw = contact.friction * contact.yaw_moment_arm
    rows = []
    for index, bound in ((3, friction), (4, friction), (0, y), (1, x), (2, yaw)):
        for sign in (1.0, -1.0):
            row = np.zeros(_WRENCH)
            row[index] = sign
            row[5] = -bound
            rows.append(row)
    normal = np.zeros(_WRENCH)
    normal[5] = 1.0
    return np.array([*rows, normal])
