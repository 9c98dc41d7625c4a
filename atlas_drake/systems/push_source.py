"""Pushes on the robot's bodies: those of a plan, and those that are requested.

What a plan may contain is in ``systems.pushes``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.common.value import AbstractValue
from pydrake.math import RollPitchYaw
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.systems.framework import Context, State

from atlas_drake.errors import InvalidMessageError, ScenarioError, did_you_mean, shown
from atlas_drake.frozen import Frozen, replace
from atlas_drake.messages.checks import check_number, check_vector
from atlas_drake.messages.controller_status import ControllerStatus
from atlas_drake.messages.event import PUSH, Event, append_recent
from atlas_drake.messages.footstep import LOADED, UNLOADED
from atlas_drake.robot import TRUNK, Robot
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.pushes import (
    LARGEST_FORCE,
    LIFT_OFF,
    TOUCHDOWN,
    PlannedPush,
)
from atlas_drake.units import GRAVITY

SAME_TIME = 1e-9
"""Times closer than this are the same [s]: times are sums of rounded periods."""
RECENT = 8
"""Least number of recent pushes that are kept for readers."""
LIFTED_FOR = 0.03
"""Time in the air after which a foot has lifted off: less is a jolt [s]."""
DOWN_FOR = 0.1
"""Least time on the ground after a touchdown: a lift-off within it is a bounce [s]."""


@dataclass(frozen=True)
class FootLoad(Frozen):
    """State of one foot of any controller's robot, from the load on its sole."""

    down: bool | None = None  # True on the ground; None before the first load.
    touched: float = -math.inf  # Time of the last touchdown [s].
    unloaded: float | None = None  # Time since which a foot down carries nothing [s].

    def after(self, time: float, load: float) -> tuple[FootLoad, str | None]:
        """Returns the state after a load, and a lift-off or touchdown at it, if any.

        ``load`` is the share of the robot's weight on this foot [-].
        """
        if self.down is None:
            return FootLoad(load > LOADED), None
        if not self.down:
            if load <= LOADED:
                return self, None
            return FootLoad(True, time), TOUCHDOWN
        if load >= UNLOADED or time - self.touched < DOWN_FOR:
            return FootLoad(True, self.touched), None
        unloaded = time if self.unloaded is None else self.unloaded
        if time - unloaded < LIFTED_FOR - 1e-9:
            return FootLoad(True, self.touched, unloaded), None
        return FootLoad(False, self.touched), LIFT_OFF


@dataclass(frozen=True)
class Push(Frozen):
    """A force on a body at its origin, in W [N], from ``time`` on for ``duration``."""

    body: str
    force_W: np.ndarray
    time: float
    duration: float

    @property
    def end(self) -> float:
        """End of the push [s]."""
        return self.time + self.duration

    def event(self) -> Event:
        """Returns the event of its beginning."""
        force = self.force_W.tolist()
        rounded = np.round(self.force_W, 1).tolist()
        text = f"push of {rounded} N on {self.body} for {self.duration:g} s"
        data = {"body": self.body, "force_W": force, "duration": self.duration}
        return Event(self.time, PUSH, text, data)

    def mean_force(self, start: float, stop: float) -> np.ndarray:
        """Computes the mean force over a period [N], shape (3,)."""
        overlap = min(self.end, stop) - max(self.time, start)
        return self.force_W * (max(overlap, 0.0) / (stop - start))


@dataclass(frozen=True)
class PushState(Frozen):
    """State of the pushes."""

    planned: tuple[tuple[float, PlannedPush], ...] = ()  # With their times [s].
    awaited: tuple[tuple[PlannedPush, int], ...] = ()  # With the gait events left.
    feet: tuple[FootLoad, ...] = (FootLoad(), FootLoad())  # Left and right.
    active: tuple[Push, ...] = ()  # Begun, or to begin within the control period.
    forces: tuple[tuple[str, np.ndarray], ...] = ()  # Mean of the period in W [N].
    recent: tuple[Push, ...] = ()  # The latest pushes that began.
    begun: int = 0  # Number of pushes that began in the run.

    def watched(self, time: float, loads: Sequence[float], left: float) -> PushState:
        """Returns the state after a control tick.

        ``loads`` are the shares of the robot's weight on both feet [-], ``left`` is the
        time until the next touchdown as the behavior plans it [s].
        """
        feet, planned, awaited = [], list(self.planned), self.awaited
        for name, foot, load in zip(("left", "right"), self.feet, loads, strict=True):
            after, phase = foot.after(time, load)
            feet.append(after)
            waiting = []
            for plan, count in awaited:
                counts = plan.foot in ("any", name) and plan.phase == phase
                if count > counts:
                    waiting.append((plan, count - counts))
                else:
                    begin = time + plan.delay + plan.fraction * left
                    planned.append((begin, plan))
            awaited = tuple(waiting)
        return replace(self, planned=tuple(planned), awaited=awaited, feet=tuple(feet))

    def with_push(self, push: Push) -> PushState:
        """Returns the state with another push that begins."""
        return replace(
            self,
            active=(*self.active, push),
            recent=append_recent(self.recent, push, RECENT),
            begun=self.begun + 1,
        )


class PushSource(CollectableSystem):
    """External forces in, the same with those of the pushes out.

    The force of a push is constant in each control period: its mean over that period,
    so that the impulse is exact. The state changes at control ticks, so that steps
    between two ticks cost nothing.

    Input ports:
        state: Positions and velocities of the robot.
        foot_loads: Vertical contact forces on the feet [N], shape (2,).
        controller_status: ``ControllerStatus``.
        other_spatial_force: List of ``ExternallyAppliedSpatialForce``; optional.

    Output ports:
        applied_spatial_force: The list of ``other_spatial_force`` with the forces of
            the pushes.
        pushes: ``PushState``.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        plant: MultibodyPlant,
        plans: Sequence[PlannedPush],
        period: float,
    ):
        """Looks at the feet and the planned pushes every ``period`` [s]."""
        super().__init__()
        self._robot, self._period = robot, period
        self._orientation = robot.indices(plant).pelvis.orientation
        own = robot.instance(plant)
        self._bodies = {
            name: plant.GetBodyByName(name, own).index() for name in robot.body_names
        }
        self._state_input = self.DeclareVectorInputPort(
            "state", plant.num_multibody_states(own)
        )
        self._load_input = self.DeclareVectorInputPort("foot_loads", 2)
        self._status_input = self.declare_value_input("controller_status")
        no_forces = AbstractValue.Make([ExternallyAppliedSpatialForce()])
        self._others = self.DeclareAbstractInputPort("other_spatial_force", no_forces)
        self._pushes = self.declare_value_state(self.schedule(plans), "pushes")
        ticket = self.abstract_state_ticket(self._pushes.index)
        self.DeclareAbstractOutputPort(
            "applied_spatial_force",
            no_forces.Clone,
            self._calc_forces,
            {ticket, self._others.ticket()},
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def schedule(self, plans: Sequence[PlannedPush]) -> PushState:
        """Returns the state of a run that begins with these plans."""
        for index, plan in enumerate(plans):
            try:
                self._make(plan, 0.0, 0.0)
            except InvalidMessageError as error:
                field = f"pushes[{index}].{error.field}"
                raise ScenarioError(field, error.value, error.problem) from None
        return PushState(
            planned=tuple((p.time, p) for p in plans if p.time is not None),
            awaited=tuple((p, p.count) for p in plans if p.time is None),
        )

    def begin(self, context: Context, state: PushState) -> None:
        """Begins a run with a state from ``schedule``."""
        self._pushes.set(context, state)

    def push(
        self,
        context: Context,
        body: str,
        force_W: Sequence[float] | np.ndarray,
        duration: float,
    ) -> None:
        """Pushes a body with a force in W [N] from now on, for ``duration`` [s]."""
        now = context.get_time()
        push = self._checked(body, force_W, now, duration)
        after = self.state(context).with_push(push)
        tick = math.ceil(now / self._period - 1e-6) * self._period
        if tick > now + SAME_TIME:  # At a tick, the update is still to come.
            force = (push.body, push.mean_force(now, tick))
            after = replace(after, forces=(*after.forces, force))
        self.begin(context, after)

    def reset(self, context: Context) -> None:
        """Ends the pushes in force; the plan continues."""
        self.begin(context, replace(self.state(context), active=(), forces=()))

    def state(self, context: Context) -> PushState:
        """Returns the state of the pushes."""
        return self._pushes.get(context)

    def _checked(
        self,
        body: str,
        force_W: Sequence[float] | np.ndarray,
        time: float,
        duration: float,
    ) -> Push:
        force = check_vector(force_W, "force_W", 3, LARGEST_FORCE)
        check_number(duration, "duration", SAME_TIME)
        link = self._robot.pushed_link(body)
        if link not in self._bodies:
            known = {TRUNK: None, **self._bodies}
            hint = did_you_mean(str(body), known) or f" It has {', '.join(known)}."
            problem = f"the robot has no body {shown(body)}.{hint}"
            raise InvalidMessageError("body", body, problem)
        return Push(link, force, time, float(duration))

    def _make(self, plan: PlannedPush, heading: float, time: float) -> Push:
        return self._checked(plan.body, plan.force(heading), time, plan.duration)

    def _update(self, context: Context, state: State) -> None:
        now, pushes = context.get_time(), self.state(context)
        if not (pushes.planned or pushes.awaited or pushes.active):
            return
        if pushes.awaited and now > 0.0:  # Loads exist from the first step on.
            weight = self._robot.mass * GRAVITY
            status: ControllerStatus = self._status_input.Eval(context)
            left = max(0.0, getattr(status.feedback, "t_step_rem", 0.0))
            loads = [load / weight for load in self._load_input.Eval(context).tolist()]
            pushes = pushes.watched(now, loads, left)
        stop = now + self._period
        due = [entry for entry in pushes.planned if entry[0] < stop - SAME_TIME]
        if due:
            q_WP = self._state_input.Eval(context)[self._orientation]
            # The plant lets the quaternion's length drift.
            q_WP = q_WP / np.linalg.norm(q_WP)
            heading = RollPitchYaw(Quaternion(q_WP)).yaw_angle()
            planned = tuple(entry for entry in pushes.planned if entry not in due)
            pushes = replace(pushes, planned=planned)
            for time, plan in due:
                pushes = pushes.with_push(self._make(plan, heading, time))
        active = tuple(push for push in pushes.active if push.end > now + SAME_TIME)
        forces = tuple((push.body, push.mean_force(now, stop)) for push in active)
        self._pushes.set(state, replace(pushes, active=active, forces=forces))

    def _calc_forces(self, context: Context, output: AbstractValue) -> None:
        forces = self._others.Eval(context) if self._others.HasValue(context) else []
        output.set_value(
            [*forces, *(self._applied(*entry) for entry in self.state(context).forces)]
        )

    def _applied(self, body: str, force_W: np.ndarray) -> ExternallyAppliedSpatialForce:
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = self._bodies[body]
        applied.F_Bq_W = SpatialForce(np.zeros(3), force_W)
        return applied
