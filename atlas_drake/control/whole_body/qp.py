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

from atlas_drake.control.gains import ControlGains, QpWeights
from atlas_drake.control.whole_body.command import (
    TOES,
    EffortBounds,
    Pressure,
    WholeBodyCommand,
)
from atlas_drake.control.whole_body.model import GRAVITY, WholeBodyTerms
from atlas_drake.control.whole_body.quadratic_program import (
    EQUALITY,
    INEQUALITY,
    SOFT,
    QuadraticProgram,
    solve,
)
from atlas_drake.frozen import replace
from atlas_drake.robot import Robot

_BASE = 6
_WRENCH = 6
MIDDLE = 0.01
"""Half the size of what counts as the middle of a sole [m]."""
USER_JOINT_WEIGHT = 1e-5
"""Least weight of a posture: keeps the QP well posed, far below any task
[1/(rad/s²)²]."""
YIELDING = 100.0
"""How much weaker a posture is at the user's full share than at none, before it fades
altogether [-]. While nothing else asks for the joint, any weight holds the posture;
when the user moves it fast, a strong one would fight them with the whole body."""
_NO_MOMENT = np.zeros(2)
_HUGE = 1e30
"""What the solver takes for infinity."""


@dataclass(frozen=True)
class WholeBodySolution:
    """The QP's answer; n joints in message order.

    Attributes:
        effort: Joint efforts [N·m], shape (n,), within the bounds given but for the
            solver's tolerance.
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
        self._cones = {kind: _wrench_cone(robot, gains, kind) for kind in Pressure}
        weights = gains.weights
        # Constant parts of the program for zero, one and two feet in contact.
        size = len(self._cones[Pressure.SOLE])
        self._layouts = [_Layout(robot, gains, size, k) for k in range(3)]
        self._task_weights = {
            (left, right, balance): _task_weight(weights, left, right, balance)
            for left in (False, True)
            for right in (False, True)
            for balance in (False, True)
        }
        limits = gains.joint_limits
        self._low = limits.kp * (robot.position_lower + limits.margin)
        self._high = limits.kp * (robot.position_upper - limits.margin)

    def solve(
        self,
        terms: WholeBodyTerms,
        command: WholeBodyCommand,
        bounds: EffortBounds,
    ) -> WholeBodySolution:
        """Finds the efforts for one tick."""
        n = self._num_joints
        contacts = [i for i in (0, 1) if command.feet[i].in_contact]
        layout = self._layouts[len(contacts)]
        size = layout.size
        rows = self._rows_on_unknowns(terms, command, contacts, size)
        T, t = rows[:n, :size], rows[:n, size]
        command = _within_authority(command, terms, bounds)
        H, f = self._cost(command, layout, rows[n:, :size], rows[n:, size])
        problem = self._constrain(terms, command, bounds, contacts, layout, H, f, T, t)
        answer = solve(problem)
        if not answer.found:
            return self._carry_weight(terms, bounds, contacts)
        wrenches = np.zeros((2, _WRENCH))
        for i, wrench in zip(contacts, answer.x[n:].reshape(-1, _WRENCH), strict=True):
            wrenches[i] = wrench
        return WholeBodySolution(
            effort=T @ answer.x + t,
            joint_acceleration=answer.x[:n],
            foot_wrenches=wrenches,
            found=True,
            iterations=answer.iterations,
        )

    def _rows_on_unknowns(
        self,
        terms: WholeBodyTerms,
        command: WholeBodyCommand,
        contacts: list[int],
        size: int,
    ) -> np.ndarray:
        """Efforts and task accelerations as affine functions of the unknowns z.

        Returns:
            Rows [A a] with A z + a: n joint efforts, then the accelerations of left
            sole, right sole, chest and pelvis, and the pendulum's, shape
            (n + 20, size + 1).
        """
        n = self._num_joints
        stack, J = terms.stack, terms.J
        on_joints = stack[_BASE:, _BASE:]
        J_contacts = J[: 2 * _WRENCH] if len(contacts) == 2 else None
        if len(contacts) == 1:
            J_contacts = terms.feet[contacts[0]].J_WF

        # Pelvis acceleration = X [z; 1], from the rows that no motor acts on.
        right = np.empty((_BASE, size + 1))
        np.negative(stack[:_BASE, _BASE:], out=right[:, :n])
        np.negative(terms.h[:_BASE], out=right[:, size])
        if J_contacts is not None:
            right[:, n:size] = J_contacts[:, :_BASE].T
        X = np.linalg.solve(stack[:_BASE, :_BASE], right)

        rows = np.empty((n + 20, size + 1))
        np.matmul(stack[_BASE:, :_BASE], X, out=rows[:-5])
        rows[-5:-2] = X[:3]
        rows[:-5, :n] += on_joints
        rows[:n, size] += terms.h[_BASE:]
        rows[n:-5, size] += terms.bias
        if J_contacts is not None:
            rows[:n, n:size] -= J_contacts[:, _BASE:].T
        self._pendulum_rows(terms, command, contacts, rows[-2:])
        return rows

    def _pendulum_rows(
        self,
        terms: WholeBodyTerms,
        command: WholeBodyCommand,
        contacts: list[int],
        rows: np.ndarray,
    ) -> None:
        """Moments of the contact forces about the pendulum's base, into ``rows``.

        About y and x, divided by m·h: a moment m·h·a about the base accelerates a point
        mass at the height h of the centre of mass by a, to +x and to -y.
        """
        rows[:] = 0.0
        if not command.balance:
            return
        base = command.pendulum_base
        scale = 1.0 / (self._robot.mass * float(terms.com[2] - base[2]))
        for k, i in enumerate(contacts):
            start = self._num_joints + _WRENCH * k
            x, y, z = (scale * (terms.feet[i].p_WF - base)).tolist()
            rows[0, start + 1] = rows[1, start] = scale
            rows[0, start + 3] = z
            rows[0, start + 5] = -x
            rows[1, start + 4] = -z
            rows[1, start + 5] = y

    def _cost(
        self,
        command: WholeBodyCommand,
        layout: _Layout,
        tasks: np.ndarray,
        drift: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Hessian and linear cost; accelerations of the tasks are tasks·z + drift."""
        n = self._num_joints
        left, right = command.feet
        weight = self._task_weights[left.in_contact, right.in_contact, command.balance]
        target = np.concatenate(
            [
                left.acceleration,
                right.acceleration,
                command.chest_angular_acceleration,
                command.pelvis_angular_acceleration,
                _NO_MOMENT,
            ]
        )
        weighted = tasks.T * weight
        H = weighted @ tasks
        f = weighted @ (drift - target)
        H += layout.regularization
        H.reshape(-1)[: n * layout.size : layout.size + 1] += command.joint_weight
        f[:n] -= command.joint_weight * command.joint_acceleration
        if command.balance:
            # Centre of mass through the contact forces: m·c̈ = Σ F + m·g.
            wanted = command.com_acceleration.copy()
            wanted[2] += GRAVITY
            H += layout.com_hessian
            f -= layout.com_gradient @ wanted
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
        # Accelerations that bring a joint to rest at its limits. A joint that the user
        # has a share of is not the behaviour's to bound: it would throw the whole body
        # about to hold one that the user drives into its stop.
        limits = self._gains.joint_limits
        approach = limits.kp * terms.q + limits.kd * terms.v
        np.subtract(self._low, approach, out=lower[:n])
        np.subtract(self._high, approach, out=upper[:n])
        if bounds.authority is not None:
            shared = bounds.authority < 1.0
            lower[:n][shared] = -_HUGE
            upper[:n][shared] = _HUGE

        size = layout.size
        A[:n] = T
        lower[size : size + n] = bounds.lower - t
        upper[size : size + n] = bounds.upper - t
        kind[size : size + n][bounds.user_held] = EQUALITY
        if bounds.added_inertia is not None:
            A.reshape(-1)[: n * size : size + 1] += bounds.added_inertia
        for k, i in enumerate(contacts):
            start = n + _WRENCH * k
            R_FW = terms.feet[i].R_WF.T
            cone_rows = layout.cone_rows(k)
            cone_bounds = slice(size + cone_rows.start, size + cone_rows.stop)
            # Moment and force turn alike: six columns as two rows of three.
            cone = self._cones[command.feet[i].pressure]
            turned = cone.reshape(-1, 3) @ R_FW
            A[cone_rows, start : start + _WRENCH] = turned.reshape(-1, _WRENCH)
            last = cone_bounds.stop - 1
            lower[last] = command.feet[i].min_normal_force
            upper[last] = command.feet[i].max_normal_force
        return QuadraticProgram(H, f, A, lower, upper, kind)

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
    """What is the same every tick for a number of feet in contact."""

    def __init__(self, robot: Robot, gains: ControlGains, cone_size: int, feet: int):
        n = robot.num_joints
        self.size = n + _WRENCH * feet
        self._first_cone_row = n
        self._cone_size = cone_size
        rows = n + feet * self._cone_size
        self.rows = np.zeros((rows, self.size))
        self.lower = np.full(self.size + rows, -_HUGE)
        self.upper = np.full(self.size + rows, _HUGE)
        self.kind = np.full(self.size + rows, INEQUALITY, dtype=np.int32)
        self.kind[:n] = SOFT
        weights = gains.weights
        self.regularization = np.zeros((self.size, self.size))
        self.regularization[n:, n:] = _wrench_cost(weights, feet)
        com = np.zeros((3, self.size))
        for k in range(feet):
            cone_part = self.cone_rows(k)
            self.upper[self.size + cone_part.start : self.size + cone_part.stop] = 0.0
            start = n + _WRENCH * k
            com[:, start + 3 : start + 6] = np.eye(3) / robot.mass
        self.com_gradient = com.T * [weights.com, weights.com, weights.com_height]
        self.com_hessian = self.com_gradient @ com

    def cone_rows(self, k: int) -> slice:
        """Rows of the k-th foot in contact."""
        start = self._first_cone_row + k * self._cone_size
        return slice(start, start + self._cone_size)


def _within_authority(
    command: WholeBodyCommand, terms: WholeBodyTerms, bounds: EffortBounds
) -> WholeBodyCommand:
    """The posture as far as it is the behaviour's to ask for.

    How a joint moves that the user has is the user's business. A posture asked of it,
    or of a shared joint beyond what the behaviour's share can do, would make the QP
    steer it by moving its neighbours. So the weight fades with the behaviour's share,
    and the acceleration asked for is one that the total effort can give to the joint.
    """
    if bounds.authority is None or bounds.added_inertia is None:
        return command
    inertia = terms.M.diagonal()[_BASE:] + bounds.added_inertia
    gravity = terms.h[_BASE:]
    lowest, highest = bounds.lower - gravity, bounds.upper - gravity
    wanted = np.minimum(
        np.maximum(command.joint_acceleration, lowest / inertia), highest / inertia
    )
    fading = bounds.authority**2 / (1.0 + YIELDING * (1.0 - bounds.authority))
    weight = command.joint_weight * fading
    return replace(
        command,
        joint_acceleration=wanted,
        joint_weight=np.maximum(weight, USER_JOINT_WEIGHT),
    )


def _task_weight(
    weights: QpWeights, left: bool, right: bool, balance: bool
) -> np.ndarray:
    """Weights of the stacked task rows, shape (20,)."""
    foot = {
        True: [weights.stance_foot] * 6,
        False: [weights.swing_foot_orientation] * 3 + [weights.swing_foot_position] * 3,
    }
    body = [weights.chest_orientation] * 3 + [weights.pelvis_orientation] * 3
    body += [weights.pendulum] * 2
    return np.array(foot[left] + foot[right] + [float(balance) * w for w in body])


def _wrench_cost(weights: QpWeights, feet: int) -> np.ndarray:
    """Hessian of what contact wrenches cost by themselves, shape (6 feet, 6 feet).

    What two feet do against each other moves nothing, and so would be all but free.
    Yet the program finds a use for it. Across a sole rolled by 0.002 rad, 160 N count
    as 0.3 N more on the sole, and so as 0.04 N·m more at its toe: whenever the pressure
    is at the edge the feet would push apart or together, as the soles happen to lie,
    and rub over the ground. An uneven split of a force that both have to give is
    charged too, which shifts it by less than a hundredth.
    """
    each = [weights.contact_moment] * 3 + [weights.contact_force] * 3
    cost = np.diag(each * feet)
    if feet == 2:
        twist, force = weights.opposed_twist, weights.opposed_force
        apart = np.diag([0.0, 0.0, twist, force, force, 0.0])
        cost += np.block([[apart, -apart], [-apart, apart]])
    return cost


def _wrench_cone(robot: Robot, gains: ControlGains, pressure: Pressure) -> np.ndarray:
    """Rows C with C·[moment; force] ≤ 0 in the sole's frame; last row: normal force.

    Friction as a pyramid inside the cone, the centre of pressure inside the sole
    less its margins or a part of it, and the yaw moment by a lever of friction.
    """
    contact, sole = gains.contact, robot.file.sole
    friction = contact.friction / np.sqrt(2.0)
    x = sole.length / 2 - contact.length_margin
    y = sole.width / 2 - contact.width_margin
    if pressure is Pressure.MIDDLE:
        x = y = MIDDLE
    yaw = contact.friction * contact.yaw_moment_arm
    rows = []
    for index, bound in ((3, friction), (4, friction), (0, y), (1, x), (2, yaw)):
        for sign in (1.0, -1.0):
            row = np.zeros(_WRENCH)
            row[index] = sign
            row[5] = -bound
            rows.append(row)
    if pressure is Pressure.TOES:
        # A moment about y that is no more than -x·f puts the pressure beyond x.
        ahead = next(row for row in rows if row[1] > 0.0)
        ahead[5] = sole.length / 2 - TOES
        behind = next(row for row in rows if row[1] < 0.0)
        behind[5] = -sole.length / 2
    normal = np.zeros(_WRENCH)
    normal[5] = 1.0
    return np.array([*rows, normal])
