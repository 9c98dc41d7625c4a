"""Tasks of the whole-body QP on the motion of frames and joints.

A task asks k quantities that are affine in accelerations and contact wrenches to take
a value. Tasks are frozen values: a behavior makes new ones in every tick. Tasks on the
contact wrenches alone are in ``contact_tasks``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from atlas_drake.control.gains import PdGains
from atlas_drake.control.whole_body.contact import Contact
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.errors import shown
from atlas_drake.rotations import rotation_error

_STILL = np.zeros(3)


class TaskRows(NamedTuple):
    """The k quantities of a task as A v̇ + b + G λ.

    v̇ ∈ R^{n_v} are the generalized accelerations, λ ∈ R^{6 c} the wrenches of the c
    contacts, stacked, each [moment; force] at the origin of the contact's frame in W.

    Attributes:
        A: A ∈ R^{k × n_v}; None for zero.
        b: b ∈ R^k.
        G: G ∈ R^{k × 6 c}; None for zero.
    """

    A: np.ndarray | None
    b: np.ndarray
    G: np.ndarray | None = None


class Task(ABC):
    """Adds ½ ‖A v̇ + b + G λ - target‖²_weight to the cost of the QP.

    Attributes:
        target: Desired value of each row, shape (k,).
        weight: Cost of a unit of error squared: one number, or one per row, shape (k,).
    """

    target: np.ndarray
    weight: np.ndarray | float

    @property
    def dimension(self) -> int:
        """Number of rows k."""
        return len(self.target)

    @abstractmethod
    def rows(self, terms: WholeBodyTerms, contacts: Sequence[Contact]) -> TaskRows:
        """Computes the task's rows at one state.

        Args:
            terms: Model terms of this tick.
            contacts: Contacts of this tick, in the order of their wrenches in λ.
        """


@dataclass(frozen=True)
class FrameTask(Task):
    """Spatial acceleration of a frame F: J_WF v̇ + J̇_WF v → target.

    Attributes:
        frame: Name of the frame in the robot's URDF.
        target: [angular; translational] acceleration in W [rad/s²; m/s²], shape (6,).
        weight: [cost]/[rad/s²]² for the first three rows, [cost]/[m/s²]² for the rest.
    """

    frame: str
    target: np.ndarray
    weight: np.ndarray | float

    ROWS: ClassVar[slice] = slice(0, 6)
    """Rows of the spatial acceleration that the task is about."""

    def rows(self, terms: WholeBodyTerms, contacts: Sequence[Contact]) -> TaskRows:
        """Returns these rows of the frame's Jacobian J ∈ R^{6 × n_v} and of J̇·v."""
        F = terms.frame(self.frame)
        return TaskRows(F.J_WF[self.ROWS], F.bias[self.ROWS])


@dataclass(frozen=True)
class OrientationTask(FrameTask):
    """Angular acceleration of a frame F: the first three rows of its Jacobian.

    Attributes:
        frame: Name of the frame in the robot's URDF.
        target: Angular acceleration in W [rad/s²], shape (3,).
        weight: [cost]/[rad/s²]².
    """

    ROWS: ClassVar[slice] = slice(0, 3)

    @classmethod
    def tracking(
        cls,
        terms: WholeBodyTerms,
        frame: str,
        R_WD: np.ndarray,
        gains: PdGains,
        weight: np.ndarray | float,
        w_WD: np.ndarray = _STILL,
        alpha_WD: np.ndarray = _STILL,
    ) -> OrientationTask:
        """Makes the task that turns a frame to an orientation with a PD law.

        Args:
            terms: Model terms of this tick.
            frame: Name of the frame in the robot's URDF.
            R_WD: Desired orientation in W, shape (3, 3).
            gains: Stiffness and damping of the motion [1/s²], [1/s].
            weight: [cost]/[rad/s²]².
            w_WD: Desired angular velocity in W [rad/s], shape (3,).
            alpha_WD: Desired angular acceleration in W [rad/s²], shape (3,).

        Raises:
            ValueError: If one of these has another shape; it names it.
        """
        F = terms.frame(frame)
        name = f"{cls.__name__} on {frame!r}"
        R_WD = shaped(R_WD, (3, 3), "R_WD", name)
        w_WD = shaped(w_WD, (3,), "w_WD", name)
        alpha_WD = shaped(alpha_WD, (3,), "alpha_WD", name)
        toward = orientation_acceleration(R_WD, w_WD, F.R_WF, F.V_WF[:3], gains)
        return cls(frame, alpha_WD + toward, weight)


@dataclass(frozen=True)
class PositionTask(FrameTask):
    """Acceleration of a frame's origin: the last three rows of its Jacobian.

    Attributes:
        frame: Name of the frame in the robot's URDF.
        target: Acceleration of the origin in W [m/s²], shape (3,).
        weight: [cost]/[m/s²]².
    """

    ROWS: ClassVar[slice] = slice(3, 6)

    @classmethod
    def tracking(
        cls,
        terms: WholeBodyTerms,
        frame: str,
        p_WD: np.ndarray,
        gains: PdGains,
        weight: np.ndarray | float,
        v_WD: np.ndarray = _STILL,
        a_WD: np.ndarray = _STILL,
    ) -> PositionTask:
        """Makes the task that moves a frame's origin to a point with a PD law.

        Args:
            terms: Model terms of this tick.
            frame: Name of the frame in the robot's URDF.
            p_WD: Desired position in W [m], shape (3,).
            gains: Stiffness and damping of the motion [1/s²], [1/s].
            weight: [cost]/[m/s²]².
            v_WD: Desired velocity in W [m/s], shape (3,).
            a_WD: Desired acceleration in W [m/s²], shape (3,).

        Raises:
            ValueError: If one of these has another shape; it names it.
        """
        F = terms.frame(frame)
        name = f"{cls.__name__} on {frame!r}"
        p_WD = shaped(p_WD, (3,), "p_WD", name)
        v_WD = shaped(v_WD, (3,), "v_WD", name)
        a_WD = shaped(a_WD, (3,), "a_WD", name)
        toward = position_acceleration(p_WD, v_WD, F.p_WF, F.V_WF[3:], gains)
        return cls(frame, a_WD + toward, weight)


@dataclass(frozen=True)
class PostureTask(Task):
    """Acceleration of all joints: q̈ → target.

    Attributes:
        target: Joint accelerations in message order [rad/s²], shape (n,).
        weight: [cost]/[rad/s²]²; positive where it is the posture of a command.
    """

    target: np.ndarray
    weight: np.ndarray

    def rows(self, terms: WholeBodyTerms, contacts: Sequence[Contact]) -> TaskRows:
        """Returns the identity on the joints [0 I] ∈ R^{n × n_v}.

        The QP does not call this method for a command's posture: the posture's weights
        go on the diagonal of the Hessian, which costs a tenth of the time.
        """
        n = len(terms.q)
        return TaskRows(np.eye(n, n + 6, 6), np.zeros(n))


def position_acceleration(
    p_WD: np.ndarray,
    v_WD: np.ndarray,
    p_WF: np.ndarray,
    v_WF: np.ndarray,
    gains: PdGains,
) -> np.ndarray:
    """Computes the acceleration of a point F toward the point D in W [m/s²], (3,)."""
    return gains.kp * (p_WD - p_WF) + gains.kd * (v_WD - v_WF)


def orientation_acceleration(
    R_WD: np.ndarray,
    w_WD: np.ndarray,
    R_WF: np.ndarray,
    w_WF: np.ndarray,
    gains: PdGains,
) -> np.ndarray:
    """Computes the angular acceleration of F toward the orientation D in W, (3,)."""
    return gains.kp * rotation_error(R_WD, R_WF) + gains.kd * (w_WD - w_WF)


def task_name(task: object) -> str:
    """Return what to call a task in an error: its kind, and its frame if it has one."""
    name = type(task).__name__
    frame = getattr(task, "frame", None)
    return name if frame is None else f"{name} on {frame!r}"


def shaped(value: Any, shape: tuple[int, ...], name: str, owner: object) -> np.ndarray:
    """Returns a value as an array of a shape; an error names value and owner."""
    if type(value) is np.ndarray and value.shape == shape:
        return value
    named = f"{name} of {owner if isinstance(owner, str) else task_name(owner)} must"
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        text = f"{named} be numbers of shape {shape}, is {shown(value)}"
        raise ValueError(text) from None
    if array.shape != shape:
        raise ValueError(f"{named} have shape {shape}, has {array.shape}")
    return array
