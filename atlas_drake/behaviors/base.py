"""Inputs, outputs and protocol of all behaviors.

Behaviors are pure: their state is a frozen value that each call receives and returns,
so that the Context of a diagram can own it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from atlas_drake.behaviors.body_reference import (
    BodyRates,
    BodyReference,
    BodyTarget,
    advance_body,
)
from atlas_drake.control.balance.feedback import pendulum_frequency
from atlas_drake.control.balance.foothold import WHOLE, Foothold
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.frozen import read_only
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import FootPose


def _no_wrenches() -> np.ndarray:
    return np.zeros(12)


@dataclass(frozen=True)
class Observation:
    """Input of a behavior in one tick; n joints in message order.

    All arrays are read-only: copy what shall be changed.

    Attributes:
        time: [s]
        dt: Time since the last tick [s].
        terms: Kinematics and dynamics at the present state.
        foot_force: Normal force on the left and right sole [N], shape (2,); NaN at the
            first tick, before any was measured.
        k: The user's blend weight of each joint, 0 to 1, shape (n,).
        foot_wrenches: Measures the contact wrenches on left and right foot, in W at
            the sole's center [N·m; N], shape (12,). A call costs a tenth of a
            millisecond.
        footholds: What of each sole is known to carry; the supervisor fills it in.
    """

    time: float
    dt: float
    terms: WholeBodyTerms
    foot_force: np.ndarray
    k: np.ndarray
    foot_wrenches: Callable[[], np.ndarray] = _no_wrenches
    footholds: tuple[Foothold, Foothold] = (WHOLE, WHOLE)

    @cached_property
    def user_held(self) -> np.ndarray:
        """Joints that the user controls alone, bool, shape (n,)."""
        return read_only(self.k >= 1.0)

    @cached_property
    def _user_holds_any(self) -> bool:
        return bool(self.user_held.any())

    def user_holds(self, joints: np.ndarray) -> bool:
        """Returns True if the user controls one of these joints alone."""
        return self._user_holds_any and bool(self.user_held[joints].any())

    def advance_body(
        self, body: BodyReference, target: BodyTarget, rates: BodyRates
    ) -> BodyReference:
        """Moves the reference of trunk and posture towards ``target`` for this tick."""
        measured = self.terms.q
        return advance_body(body, target, rates, self.dt, measured, self.user_held)

    def foot_pose(self, foot: int) -> FootPose:
        """Present pose of a sole in W, with the part of it that carries."""
        terms, part = self.terms.feet[foot], self.footholds[foot].part
        return FootPose(terms.p_WF.copy(), terms.R_WF.copy(), part)

    def foot_cop(self, foot: int) -> np.ndarray:
        """Measured center of pressure of a loaded foot, in F [m], shape (2,)."""
        R_WF = self.terms.feet[foot].R_WF
        wrench = self.foot_wrenches()[6 * foot : 6 * foot + 6]
        (mx, my, _), (_, _, fz) = R_WF.T @ wrench[:3], R_WF.T @ wrench[3:]
        return np.array([-my / fz, mx / fz])

    @property
    def foot_poses(self) -> tuple[FootPose, FootPose]:
        """Present poses of both soles in W."""
        return self.foot_pose(0), self.foot_pose(1)

    def pendulum_frequency(self, ground: float) -> float:
        """Natural frequency of the pendulum on ground at this height in W [1/s]."""
        return pendulum_frequency(float(self.terms.com[2]) - ground)

    def has_slipped(self, feet: tuple[FootPose, FootPose], limit: float) -> bool:
        """Returns True if a sole is farther than ``limit`` [m] from its pose.

        It returns True, too, if another part of a sole carries now.
        """
        return any(
            pose.part is not foothold.part
            for pose, foothold in zip(feet, self.footholds, strict=True)
        ) or any(
            abs(x - latched) > limit
            for pose, now in zip(feet, self.terms.feet, strict=True)
            for x, latched in zip(now.p_WF.tolist(), pose.p_WF.tolist(), strict=True)
        )


@dataclass(frozen=True)
class Outcome:
    """Output of a behavior in one tick.

    Attributes:
        state: State of the behavior for the next tick; frozen.
        body: The body reference, advanced by one tick.
        command: Command to the whole-body QP; None for zero effort.
        finished: True when the behavior is over and STAND shall follow.
        status_flags: The behavior's own feedback flags, which the supervisor latches.
        events: New events for the log.
        landing: Index of a foot that has landed, and the pose of the ground there as
            far as it was planned; None if no foot has.
    """

    state: Any
    body: BodyReference
    command: WholeBodyCommand | None
    finished: bool = False
    status_flags: int = 0
    events: tuple[Event, ...] = ()
    landing: tuple[int, FootPose] | None = None


class BehaviorProtocol(Protocol):
    """One behavior. Objects hold constants only.

    A class derived from it needs ``enter`` and ``update`` only.
    """

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> Any:
        """Returns the state in which the behavior starts."""

    def update(
        self,
        state: Any,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick; ``leaving`` requests an orderly end of the behavior."""

    def idle(self, state: Any, observation: Observation) -> Any:
        """Returns the state after a tick in which the stance guard held the pose."""
        return state

    def resume(
        self,
        state: Any,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> Any:
        """Returns the state in which the behavior continues after the stance guard."""
        return self.enter(observation, body, request)

    def feedback(self, state: Any, status_flags: int) -> Any:
        """Returns the behavior's feedback for the state message; None without one.

        A feedback message of the interface, such as ``AtlasBehaviorWalkFeedback``, is
        reported in its own field, any other frozen value in ``feedback``.

        Args:
            state: State of the behavior after the last tick.
            status_flags: The behavior's own flags, latched.
        """
        return None

    def plan(self, state: Any, com: np.ndarray, omega: float) -> Plan:
        """Returns the behavior's plan, for viewers and logs; empty without one.

        Args:
            state: State of the behavior after the last tick.
            com: Center of mass at that tick, horizontal in W [m], shape (2,).
            omega: Natural frequency of the pendulum at that tick [1/s].
        """
        return Plan()

    def paths(self, state: Any, com: np.ndarray, omega: float) -> PlannedPaths:
        """Returns the motion that is planned from now on; nothing without a plan.

        It is called only when a viewer or log reads the paths, because they often cost
        more than a control tick. The arguments are those of ``plan``.
        """
        return PlannedPaths()
