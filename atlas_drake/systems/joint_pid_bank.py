"""The PID controllers of user mode, one per joint, at the physics rate.

The law is ``control.joints.joint_pid``; this is its system in the diagram.
"""

import math
from dataclasses import dataclass, fields

import numpy as np
from pydrake.systems.framework import Context, DiscreteValues, State

from atlas_drake.control.joints.blend import UserForecast, forecast_user_effort
from atlas_drake.control.joints.joint_pid import (
    InverseMass,
    PidState,
    StepModel,
    change_without_user,
    integrate,
    static_effort,
    step_model,
    user_effort,
    within_limits,
)
from atlas_drake.frozen import NOTHING, Frozen, read_only, replace
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.robot import PlantIndices, Robot
from atlas_drake.systems.collectable_system import CollectableSystem

MOVED = 0.1
"""Refresh the model when a joint has moved farther than this [rad]."""
REFRESH_PERIOD = 0.01
"""Least time between two refreshes of the model [s]."""
_PID_FIELDS = [field.name for field in fields(PidState)]


@dataclass(frozen=True)
class PreparedLaw(Frozen):
    """Data of the law that change seldom, computed for a command and a pose."""

    time: float  # At which the data were computed [s].
    source: JointCommand
    q: np.ndarray  # Joint positions [rad].
    command: JointCommand  # ``source`` ``within_limits`` of the joints.
    rest: np.ndarray  # 1 - k, the behavior's share of each joint.
    active: np.ndarray  # True for each joint with k > 0.
    offset: np.ndarray  # Static effort at joint positions zero, no integral [N·m].
    integrates: bool  # True if any joint has an integral term.
    model: StepModel  # Response of velocities to efforts.

    def static_effort(self, integral: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Computes ``static_effort`` of the command from the precomputed offset."""
        return self.offset - self.command.kp_position * q + integral


@dataclass(frozen=True)
class PidStep:
    """Result of one step: the next state, and the present user's effort [N·m]."""

    after: PidState
    effort: np.ndarray


class JointPidBank(CollectableSystem):
    """Set-points, gains and measured joints in, the user's efforts out.

    Input ports:
        state: Positions and velocities of the robot, in plant order.
        joint_command: ``JointCommand``
        behavior_effort: Efforts of the behavior, before the blend [N·m], shape (n,).

    Output ports:
        user_effort: Efforts of the user's control law [N·m], shape (n,), message
            order; 0 for joints with share 0. They are not limited: the effort limit
            applies to their blend with the behavior's efforts.
        user_forecast: ``UserForecast`` for the coming control tick.

    State: the fields of ``PidState``, updated at every physics step in which the user
    has a share, with NaN for a velocity that is not known; the prepared law,
    updated at a control tick when pose or commands have changed; the behavior's
    efforts since the last control tick.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        indices: PlantIndices,
        num_positions: int,
        physics_step: float,
        control_period: float,
    ):
        """Runs every ``physics_step`` [s] on a plant with the given indices.

        The forecast is for the coming ``control_period`` [s].
        """
        super().__init__()
        n = robot.num_joints
        self._robot = robot
        self._limit = robot.effort_limit
        self._q = indices.q
        self._v = num_positions + indices.v
        self._dt = physics_step
        self._control_period = control_period
        self._inverse_mass = InverseMass(robot)
        self._num_positions = num_positions
        num_states = num_positions + len(indices.generalized)
        self._state_input = self.DeclareVectorInputPort("state", num_states)
        self._command_input = self.declare_value_input("joint_command")
        self._behavior_input = self.DeclareVectorInputPort("behavior_effort", n)
        # The fields of ``PidState`` in their order: one vector is read at once.
        self._at_start = np.zeros(len(_PID_FIELDS) * n)
        self._at_start[n : 2 * n] = np.nan
        self._memory = self.DeclareDiscreteState(self._at_start)
        self._nothing = read_only(np.zeros(n))
        # Output and update read the same step.
        self._step = self.declare_cached(
            "one step of the law",
            self._compute_step,
            {self.all_input_ports_ticket(), self.xd_ticket(), self.xa_ticket()},
        )
        self.declare_value_output("user_forecast", self._forecast)
        self.declare_vector_output(
            "user_effort", n, self._effort, {self._step.ticket()}
        )
        self._scratch = self.declare_scratch_context(self._inverse_mass.create_context)
        self._prepared = self.declare_value_state(NOTHING)
        self._carried = self.DeclareDiscreteState(n)
        self.DeclarePeriodicDiscreteUpdateEvent(physics_step, 0.0, self._update)
        self.DeclarePeriodicDiscreteUpdateEvent(
            control_period, 0.0, self._update_carried
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(
            control_period, 0.0, self._update_law
        )

    def reset(self, context: Context) -> None:
        """Clears the state of the law, its integrals included."""
        context.SetDiscreteState(self._memory, self._at_start)
        context.SetDiscreteState(self._carried, self._nothing)
        self._prepared.set(context, NOTHING)

    def _compute_step(self, context: Context) -> PidStep:
        source: JointCommand = self._command_input.Eval(context)
        state = self._state_input.Eval(context)
        v = state.take(self._v)
        last = self._remembered(context)
        q = state.take(self._q)
        law = self._law(context, source)
        integral = last.integral
        if law.integrates or integral.any():
            integral = integrate(last, law.command, q, law.active, self._dt)
        others = law.rest * self._behavior_input.Eval(context)
        static = law.static_effort(integral, q)
        if math.isnan(last.velocity[0]):
            # Joints that the behavior moved, at a steady velocity. The law knows what
            # their motors carried: weight and ground forces that balanced the
            # behavior's efforts will balance those of the user.
            carried = context.get_discrete_state(self._carried).value()
            applied = np.clip(carried, -self._limit, self._limit)
            last = replace(last, velocity=v, applied=applied, static=static)
        idle = change_without_user(last, static, v, others, law.model)
        effort, total = user_effort(static, v + idle, others, law.model, self._limit)
        expected = idle + law.model.response @ (total - others)
        after = PidState(integral, v, total, expected, static)
        return PidStep(after, effort * law.active)

    def _effort(self, context: Context) -> np.ndarray:
        idle = self._is_idle(context)
        return self._nothing if idle else self._step.Eval(context).effort

    def _is_idle(self, context: Context) -> bool:
        """Returns True while the user has no share of any joint."""
        source: JointCommand = self._command_input.Eval(context)
        return not source.has_user

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        if not self._is_idle(context):
            after = self._step.Eval(context).after
            values = [getattr(after, name) for name in _PID_FIELDS]
            discrete.set_value(self._memory, np.concatenate(values))
            return
        before = context.get_discrete_state(self._memory).value()
        n = len(self._nothing)
        # Without a share the state is set once: this runs at every physics step.
        if not math.isnan(before[n]):
            # Velocity and efforts of the last step are not kept.
            after = self._at_start.copy()
            after[:n] = before[:n]
            discrete.set_value(self._memory, after)

    def _update_carried(self, context: Context, discrete: DiscreteValues) -> None:
        discrete.set_value(self._carried, self._behavior_input.Eval(context))

    def _remembered(self, context: Context) -> PidState:
        """Returns the state, with NaN for velocities before the first step."""
        values = context.get_discrete_state(self._memory).value()
        return PidState(*values.reshape(len(_PID_FIELDS), -1))

    def _forecast(self, context: Context) -> UserForecast:
        if self._is_idle(context):
            return UserForecast(*[self._nothing] * 3)
        source: JointCommand = self._command_input.Eval(context)
        state = self._state_input.Eval(context)
        law = self._law(context, source)
        v = state.take(self._v)
        integral = self._remembered(context).integral
        static = law.static_effort(integral, state.take(self._q))
        damping, limit, excess = law.model.damping, self._limit, self._nothing
        # Solve the implicit law only if the static or the explicit one exceeds the
        # limit of a joint of which the user has a share.
        explicit = static - damping * v
        if any((np.abs(e) > limit)[law.active].any() for e in (static, explicit)):
            effort = self._step.Eval(context).effort
            excess = effort - np.clip(effort, -limit, limit)
        return forecast_user_effort(
            static,
            law.command.kp_position,
            damping,
            v,
            excess,
            self._control_period,
            self._dt,
        )

    def _law(self, context: Context, source: JointCommand) -> PreparedLaw:
        """Returns the prepared law, computed again if the command has changed."""
        known = self._prepared.get(context)
        if known is not NOTHING and known.source is source:
            return known
        return self._prepare(context, source)

    def _prepare(self, context: Context, source: JointCommand) -> PreparedLaw:
        robot = self._robot
        state = self._state_input.Eval(context)
        inverse_mass = self._inverse_mass.evaluate(
            self._scratch.Eval(context), state[: self._num_positions]
        )
        command = within_limits(source, robot.position_lower, robot.position_upper)
        damping = command.kd_position + command.kp_velocity
        share = source.share
        return PreparedLaw(
            time=context.get_time(),
            source=source,
            q=state[self._q],
            command=command,
            rest=1.0 - share,
            active=share > 0.0,
            offset=static_effort(command, self._nothing, self._nothing),
            integrates=bool(command.i_effort_min.any() or command.i_effort_max.any()),
            model=step_model(
                command.kp_position, damping, share, inverse_mass, self._dt
            ),
        )

    def _update_law(self, context: Context, state: State) -> None:
        if self._is_idle(context):
            return
        source: JointCommand = self._command_input.Eval(context)
        known = self._prepared.get(context)
        if known is not NOTHING and known.source is source:
            q = self._state_input.Eval(context)[self._q]
            is_due = context.get_time() >= known.time + REFRESH_PERIOD - 1e-9
            if not (is_due and np.abs(q - known.q).max() > MOVED):
                return
        self._prepared.set(state, self._prepare(context, source))
