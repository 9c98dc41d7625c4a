"""The PID controllers of user mode, one per joint, at the physics rate.

The law is ``control.joint_pid``; this is its place in a diagram.
"""

from dataclasses import dataclass, replace
from typing import Any

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

from atlas_drake.control.joint_mobility import JointMobility
from atlas_drake.control.joint_pid import (
    PidState,
    StepModel,
    damping_bound,
    estimate_drift,
    integrate,
    static_effort,
    step_model,
    user_effort,
)
from atlas_drake.control.user_share import UserForecast, forecast_user_effort
from atlas_drake.control.whole_body_model import GRAVITY
from atlas_drake.joint_command import JointCommand
from atlas_drake.messages import K_EFFORT_MAX
from atlas_drake.robot import PlantIndices, Robot

MOVED = 0.1
"""A joint that moved this far makes the step's model worth computing anew [rad]."""
PREPARATION_TICKS = 5
"""Control ticks between looks at whether it is [-]."""
PLANTED_SHARE = 0.1
"""A sole that carries this share of the robot's weight is held by the ground [-]."""
PLANTED_LEVER = 0.8
"""As long as its centre of pressure is within this share of its half width [-]."""


@dataclass(frozen=True)
class PreparedLaw:
    """What the law needs and that changes seldom; frozen.

    Attributes:
        source: The command that it was prepared for.
        share: The user's share of each joint, 0 to 1, likewise.
        q: Joint positions that it was prepared at [rad].
        command: ``source`` with set-points within the joints' limits and damping
            within what counts.
        planted: Which soles the ground held.
        model: How velocities respond to efforts.
        integrates: Whether any joint has, or is to lose, an integral term.
    """

    source: JointCommand
    share: np.ndarray
    q: np.ndarray
    command: JointCommand
    planted: tuple[bool, bool]
    model: StepModel
    integrates: bool

    def __deepcopy__(self, memo: dict[int, Any]) -> "PreparedLaw":
        """Frozen, so its copy is itself."""
        return self

    def serves(self, source: JointCommand, share: np.ndarray) -> bool:
        """Whether it was prepared for these commands."""
        # Comparing the bytes costs a tenth of comparing the arrays.
        return source is self.source and share.tobytes() == self.share.tobytes()


@dataclass(frozen=True)
class PidStep:
    """One step's result: what to remember, and the user's effort now [N·m]."""

    after: PidState
    effort: np.ndarray


class JointPidBank(LeafSystem):
    """Set-points, gains and measured joints in, the user's efforts out.

    Input ports:
        state: Positions and velocities of the plant, in plant order.
        joint_command: ``JointCommand``
        k_effort: The user's share of each joint, 0 to 255, shape (n,).
        behavior_effort: What the behaviour gives to its share [N·m], shape (n,).
        foot_wrenches: Of the ground on the soles [N·m; N], shape (12,).

    Output ports:
        user_effort: [N·m], shape (n,), message order; 0 for joints with share 0.
        user_forecast: ``UserForecast`` for the coming control tick.

    State: what ``PidState`` holds, updated at every physics step; the prepared law,
    updated every few control ticks when pose, contact or commands have changed.
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
        self._behavior_input = self.DeclareVectorInputPort("behavior_effort", n)
        self._wrench_input = self.DeclareVectorInputPort("foot_wrenches", 12)
        self._memory = self.DeclareDiscreteState(4 * n)
        nothing = np.zeros(n)
        # Output and update read the same step.
        self._step = self.DeclareCacheEntry(
            "one step of the law",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(None),
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
            PREPARATION_TICKS * control_period, 0.0, self._update_law
        )

    def _calc_step(self, context: Context, result: AbstractValue) -> None:
        state = self._state_input.Eval(context)
        q, v = state[self._q], state[self._v]
        share = self._share_input.Eval(context) * (1.0 / K_EFFORT_MAX)
        memory = context.get_discrete_state(self._memory).value()
        n = len(share)
        last = PidState(
            memory[:n], memory[n : 2 * n], memory[2 * n : 3 * n], memory[3 * n :]
        )
        active = share > 0.0
        if not active.any():
            nothing = np.zeros(n)
            result.set_value(
                PidStep(PidState(last.integral, v, nothing, nothing), nothing)
            )
            return
        others = (1.0 - share) * self._behavior_input.Eval(context)
        law = self._law(context, share)
        integral = last.integral
        if law.integrates or integral.any():
            integral = integrate(last, law.command, q, active, self._dt)
        drift = estimate_drift(last, v, law.model)
        effort = user_effort(
            static_effort(law.command, integral, q),
            v,
            drift,
            others,
            law.model,
            self._robot.effort_limit,
        )
        applied = others + share * effort
        result.set_value(
            PidStep(
                PidState(integral, v, applied, drift + law.model.response @ applied),
                np.where(active, effort, 0.0),
            )
        )

    def _calc_effort(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._step.Eval(context).effort)

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        after = self._step.Eval(context).after
        discrete.get_mutable_vector(self._memory).SetFromVector(
            np.concatenate(
                [after.integral, after.velocity, after.applied, after.expected]
            )
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
        if known is not None and known.serves(self._command_input.Eval(context), share):
            return known
        return self._prepare(context, share)

    def _prepare(self, context: Context, share: np.ndarray) -> PreparedLaw:
        robot = self._robot
        source: JointCommand = self._command_input.Eval(context)
        state = self._state_input.Eval(context)
        planted = self._planted(context)
        mobility = self._mobility.evaluate(
            self._scratch.Eval(context), state[: self._num_positions], planted
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
            planted,
            step_model(damping, share, mobility, self._dt),
            bool(command.i_effort_min.any() or command.i_effort_max.any()),
        )

    def _planted(self, context: Context) -> tuple[bool, bool]:
        """Which soles the ground holds: they carry weight, and not on an edge."""
        wrenches = self._wrench_input.Eval(context)
        return self._held(wrenches[:6]), self._held(wrenches[6:])

    def _held(self, wrench: np.ndarray) -> bool:
        load = wrench[5]
        if load < PLANTED_SHARE * self._robot.mass * GRAVITY:
            return False
        sole = self._robot.file.sole
        # The lever of the load about the sole's centre, whatever the foot's heading.
        lever = np.hypot(wrench[0], wrench[1]) / load
        return bool(lever < PLANTED_LEVER * 0.5 * min(sole.length, sole.width))

    def _update_law(self, context: Context, state: State) -> None:
        share = self._share_input.Eval(context) * (1.0 / K_EFFORT_MAX)
        if not share.any():
            return
        known = context.get_abstract_state(self._prepared).get_value()
        if known is not None and known.serves(self._command_input.Eval(context), share):
            q = self._state_input.Eval(context)[self._q]
            moved = np.abs(q - known.q).max() > MOVED
            if not moved and self._planted(context) == known.planted:
                return
        state.get_mutable_abstract_state(self._prepared).set_value(
            self._prepare(context, share)
        )
