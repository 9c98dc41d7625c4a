"""The PID controllers of user mode, one per joint.

The law is ``control.joints.joint_pid``. The plant's own motors carry it out in every
physics step, together with contact; ``EffortSelector`` gives it to them.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, State

from atlas_drake.control.joints.blend import UserForecast, forecast_user_effort, limited
from atlas_drake.control.joints.joint_pid import (
    MotorLaw,
    integrate,
    motor_law,
    step_damping,
    user_effort,
    within_limits,
)
from atlas_drake.frozen import NOTHING, Frozen, read_only, replace
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem


@dataclass(frozen=True)
class PreparedLaw(Frozen):
    """The law of a command and an integral, kept because both change seldom."""

    source: JointCommand
    command: JointCommand  # ``source`` ``within_limits`` of the joints.
    integral: np.ndarray  # Of the position error times its gain [N·m], shape (n,).
    motors: MotorLaw
    excess: np.ndarray  # Efforts beyond the limits at the last tick [N·m], shape (n,).


class Present(NamedTuple):
    """The law in force at the present state; arrays (n,), message order."""

    static: np.ndarray  # Efforts of joints at rest [N·m].
    damping: np.ndarray  # [N·m·s/rad]
    v: np.ndarray  # Velocities [rad/s].
    excess: np.ndarray  # Efforts beyond the motors' limits [N·m].


class JointPidBank(CollectableSystem):
    """Set-points and gains in, the law of the plant's motors out.

    Input ports:
        state: Positions and velocities of the robot, in plant order.
        acceleration: Generalized accelerations of the robot, in the order of its
            velocities: the step that the plant makes from the present state.
        joint_command: ``JointCommand``

    Output ports:
        motor_law: ``MotorLaw``; zero without a user share.
        user_effort: Efforts of the user's law in the step from the present state [N·m],
            shape (n,), message order; 0 for joints with share 0. They are not limited:
            the effort limit applies to their blend with the behavior's efforts.
        user_forecast: ``UserForecast`` for the coming control tick.

    State, updated at control ticks: the prepared law with its integrals, and by how
    much it exceeded the motors' limits at the last tick.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        plant: MultibodyPlant,
        physics_step: float,
        control_period: float,
    ):
        """Controls the motors of ``robot`` in ``plant``; step and period in [s]."""
        super().__init__()
        n = robot.num_joints
        self._robot = robot
        self._step, self._period = physics_step, control_period
        indices, own = robot.indices(plant), robot.instance(plant)
        self._q, self._v = indices.q, indices.v
        self._v_state = plant.num_positions(own) + indices.v
        self._nothing = nothing = read_only(np.zeros(n))
        self._no_law = MotorLaw(nothing, nothing, nothing, nothing)
        self._state_input = self.DeclareVectorInputPort(
            "state", plant.num_multibody_states(own)
        )
        self._acceleration_input = self.DeclareVectorInputPort(
            "acceleration", plant.num_velocities(own)
        )
        self._command_input = self.declare_value_input("joint_command")
        self._prepared = self.declare_value_state(NOTHING)
        command = self.input_port_ticket(self._command_input.get_index())
        state = self.input_port_ticket(self._state_input.get_index())
        sources = {command, self.xa_ticket()}
        self.declare_value_output("motor_law", self._motor_law, sources)
        self.declare_vector_output("user_effort", n, self._user_effort)
        sources |= {state}
        # Forecast and update read the same efforts.
        self._present = self.declare_cached("present", self._at_present, sources)
        self.declare_value_output("user_forecast", self._forecast, sources)
        self.DeclarePeriodicUnrestrictedUpdateEvent(
            control_period, 0.0, self._update_law
        )

    def reset(self, context: Context) -> None:
        """Clears the state of the law, its integrals included."""
        self._prepared.set(context, NOTHING)

    def _in_force(self, context: Context) -> PreparedLaw | None:
        """Returns the law in force; None while the user has no share of any joint."""
        source: JointCommand = self._command_input.Eval(context)
        if not source.has_user:
            return None
        known = self._prepared.get(context)
        if known is not NOTHING and known.source is source:
            return known
        return self._prepare(
            source, self._nothing if known is NOTHING else known.integral
        )

    def _prepare(self, source: JointCommand, integral: np.ndarray) -> PreparedLaw:
        robot = self._robot
        command = within_limits(source, robot.position_lower, robot.position_upper)
        motors = motor_law(command, integral, self._step)
        return PreparedLaw(source, command, integral, motors, self._nothing)

    def _motor_law(self, context: Context) -> MotorLaw:
        law = self._in_force(context)
        return self._no_law if law is None else law.motors

    def _user_effort(self, context: Context) -> np.ndarray:
        law = self._in_force(context)
        if law is None:
            return self._nothing
        state = self._state_input.Eval(context)
        acceleration = self._acceleration_input.Eval(context).take(self._v)
        v_next = state.take(self._v_state) + self._step * acceleration
        effort = user_effort(
            law.command, law.integral, state.take(self._q), v_next, self._step
        )
        return effort * (law.source.k > 0.0)

    def _forecast(self, context: Context) -> UserForecast:
        law = self._in_force(context)
        if law is None:
            return UserForecast(*[self._nothing] * 3)
        now: Present = self._present.Eval(context)
        # A damper may exceed the limit now and be at rest within the step: it counts if
        # it did so at the last tick, too, or has a spring to hold.
        at_rest = self._beyond_limit(now.static)
        held = (now.excess * law.excess > 0.0) | (now.excess * at_rest > 0.0)
        return forecast_user_effort(
            now.static,
            law.command.kp_position,
            now.damping,
            now.v,
            now.excess * held,
            self._period,
            self._step,
        )

    def _at_present(self, context: Context) -> Present:
        law = self._in_force(context)
        assert law is not None  # Only a law in force is asked about.
        state, command = self._state_input.Eval(context), law.command
        v, q = state.take(self._v_state), state.take(self._q)
        static = user_effort(command, law.integral, q, self._nothing, self._step)
        damping = step_damping(command, self._step)
        return Present(static, damping, v, self._beyond_limit(static - damping * v))

    def _beyond_limit(self, effort: np.ndarray) -> np.ndarray:
        return effort - limited(effort, self._robot.effort_limit)

    def _update_law(self, context: Context, state: State) -> None:
        law = self._in_force(context)
        if law is None:
            return
        if law.command.ki_position.any() or law.integral.any():
            q = self._state_input.Eval(context)[self._q]
            integral = read_only(integrate(law.integral, law.command, q, self._period))
            motors = motor_law(law.command, integral, self._step)
            law = replace(law, integral=integral, motors=motors)
        excess = read_only(self._present.Eval(context).excess)
        self._prepared.set(state, replace(law, excess=excess))
