"""The PID controllers of user mode, one per joint, at the physics rate.

The law is ``control.joint_pid``; this is its place in a diagram.
"""

from dataclasses import dataclass, replace

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DiscreteValues,
    LeafSystem,
    State,
    ValueProducer,
)

from atlas_drake.commands import JointCommand
from atlas_drake.control.joint_mobility import JointMobility
from atlas_drake.control.joint_pid import (
    PidState,
    damping_bound,
    implicit_gain,
    integrate,
    static_effort,
    user_effort,
)
from atlas_drake.control.user_share import UserForecast, forecast_user_effort
from atlas_drake.messages import K_EFFORT_MAX
from atlas_drake.robot import PlantIndices, Robot


MOVED = 0.1
"""A joint that moved this far makes the implicit damping worth computing anew [rad]."""


@dataclass(frozen=True)
class PreparedLaw:
    """What the law needs and that changes seldom; frozen.

    Attributes:
        source: The command that it was prepared for.
        share: The user's share of each joint, 0 to 1, likewise.
        q: Joint positions that it was prepared at [rad].
        command: ``source`` with set-points within the joints' limits and damping
            within what counts.
        gain: Of the implicit damping.
    """

    source: JointCommand
    share: np.ndarray
    q: np.ndarray
    command: JointCommand
    gain: np.ndarray

    def __deepcopy__(self, memo: dict) -> "PreparedLaw":
        """Frozen, so its copy is itself."""
        return self

    def serves(self, source: JointCommand, share: np.ndarray) -> bool:
        """Whether it was prepared for these commands."""
        return source is self.source and np.array_equal(share, self.share)


class JointPidBank(LeafSystem):
    """Set-points, gains and measured joints in, the user's efforts out.

    Input ports:
        state: Positions and velocities of the plant, in plant order.
        joint_command: ``JointCommand``
        k_effort: The user's share of each joint, 0 to 255, shape (n,).

    Output ports:
        user_effort: [N·m], shape (n,), message order; 0 for joints with share 0.
        user_forecast: ``UserForecast`` for the coming control tick.

    State: integral term, last velocity and last effort of each joint, updated at
    every physics step; the gain matrix of the implicit damping, updated at the control
    rate when the pose or the commands have changed.
    """

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
        self._q = indices.q
        self._v = num_positions + indices.v
        self._dt = physics_step
        self._control_period = control_period
        self._mobility = JointMobility(robot)
        self._num_positions = num_positions
        self._damping_bound = damping_bound(robot.effort_limit, robot.velocity_limit)
        num_states = num_positions + len(indices.generalized)
        self._state_input = self.DeclareVectorInputPort("state", num_states)
        self._command_input = self.DeclareAbstractInputPort(
            "joint_command", AbstractValue.Make(None)
        )
        self._share_input = self.DeclareVectorInputPort("k_effort", n)
        self._memory = self.DeclareDiscreteState(3 * n)
        nothing = np.zeros(n)
        # One step's result: (integral, velocity, effort), read by output and update.
        self._step = self.DeclareCacheEntry(
            "one step of the law",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(
                    PidState(nothing, nothing, nothing)
                ),
                calc=self._calc_step,
            ),
            {self.all_input_ports_ticket(), self.xd_ticket(), self.xa_ticket()},
        )
        self.DeclareAbstractOutputPort(
            "user_forecast",
            lambda: AbstractValue.Make(UserForecast(nothing, nothing)),
            self._calc_forecast,
        )
        self.DeclareVectorOutputPort(
            "user_effort",
            n,
            self._calc_effort,
            prerequisites_of_calc={self._step.ticket()},
        )
        self._scratch = self.DeclareCacheEntry(
            "scratch context of the mobility",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(self._mobility.create_context()),
                calc=ValueProducer.NoopCalc,
            ),
            {self.nothing_ticket()},
        )
        self._prepared = self.DeclareAbstractState(AbstractValue.Make(None))
        self.DeclarePeriodicDiscreteUpdateEvent(physics_step, 0.0, self._update)
        self.DeclarePeriodicUnrestrictedUpdateEvent(
            control_period, 0.0, self._update_law
        )

    def _calc_step(self, context: Context, result: AbstractValue) -> None:
        state = self._state_input.Eval(context)
        q, v = state[self._q], state[self._v]
        share = self._share_input.Eval(context) * (1.0 / K_EFFORT_MAX)
        integral, last_v, last_effort = np.split(
            context.get_discrete_state(self._memory).value(), 3
        )
        active = share > 0.0
        if not active.any():
            result.set_value(PidState(integral, v, np.zeros_like(v)))
            return
        law = self._law(context, share)
        memory = PidState(integral, last_v, last_effort)
        grown = integrate(memory, law.command, q, active, self._dt)
        effort = user_effort(
            memory,
            law.command,
            grown,
            q,
            v,
            law.gain,
            self._robot.effort_limit,
        )
        result.set_value(PidState(grown, v, np.where(active, effort, 0.0)))

    def _calc_effort(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._step.Eval(context).effort)

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        step: PidState = self._step.Eval(context)
        discrete.get_mutable_vector(self._memory).SetFromVector(
            np.concatenate([step.integral, step.velocity, step.effort])
        )

    def _calc_forecast(self, context: Context, output: AbstractValue) -> None:
        share = self._share_input.Eval(context) * (1.0 / K_EFFORT_MAX)
        if not share.any():
            nothing = np.zeros_like(share)
            output.set_value(UserForecast(nothing, nothing))
            return
        state = self._state_input.Eval(context)
        command = self._law(context, share).command
        integral = context.get_discrete_state(self._memory).value()[: len(share)]
        output.set_value(
            forecast_user_effort(
                static_effort(command, integral, state[self._q]),
                command.kp_position,
                command.kd_position + command.kp_velocity,
                state[self._v],
                self._robot.effort_limit,
                self._control_period,
            )
        )

    def _law(self, context: Context, share: np.ndarray) -> PreparedLaw:
        """The law in the state if it serves, else one prepared afresh."""
        known = context.get_abstract_state(self._prepared).get_value()
        if known is not None and known.serves(
            self._command_input.Eval(context), share
        ):
            return known
        return self._prepare(context, share)

    def _prepare(self, context: Context, share: np.ndarray) -> PreparedLaw:
        robot = self._robot
        source: JointCommand = self._command_input.Eval(context)
        state = self._state_input.Eval(context)
        mobility = self._mobility.evaluate(
            self._scratch.Eval(context), state[: self._num_positions]
        )
        command = replace(
            source,
            position=np.clip(
                source.position, robot.position_lower, robot.position_upper
            ),
            kp_velocity=np.minimum(source.kp_velocity, self._damping_bound),
        )
        damping = command.kd_position + command.kp_velocity
        return PreparedLaw(
            source,
            share,
            state[self._q],
            command,
            implicit_gain(damping, share, mobility, self._dt),
        )

    def _update_law(self, context: Context, state: State) -> None:
        share = self._share_input.Eval(context) * (1.0 / K_EFFORT_MAX)
        if not share.any():
            return
        known = context.get_abstract_state(self._prepared).get_value()
        if known is not None and known.serves(
            self._command_input.Eval(context), share
        ):
            q = self._state_input.Eval(context)[self._q]
            if np.abs(q - known.q).max() < MOVED:
                return
        state.get_mutable_abstract_state(self._prepared).set_value(
            self._prepare(context, share)
        )
