"""The PID controllers of user mode, one per joint, at the physics rate.

The law is ``control.joint_pid``; this is its place in a diagram.
"""

from dataclasses import replace

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DiscreteValues,
    LeafSystem,
    ValueProducer,
)

from atlas_drake.commands import JointCommand
from atlas_drake.control.joint_inertia import lower_joint_inertia
from atlas_drake.control.joint_pid import (
    PidState,
    damping_bound,
    integrate,
    user_effort,
)
from atlas_drake.messages import K_EFFORT_MAX
from atlas_drake.robot import PlantIndices, Robot


class JointPidBank(LeafSystem):
    """Set-points, gains and measured joints in, the user's efforts out.

    Input ports:
        state: Positions and velocities of the plant, in plant order.
        joint_command: ``JointCommand``
        k_effort: The user's share of each joint, 0 to 255, shape (n,).

    Output ports:
        user_effort: [N·m], shape (n,), message order; 0 for joints with share 0.

    State: integral term, last velocity and last effort of each joint, updated at
    every physics step.
    """

    def __init__(
        self,
        robot: Robot,
        indices: PlantIndices,
        num_positions: int,
        physics_step: float,
    ):
        """Runs every ``physics_step`` [s] on a plant with the given indices."""
        super().__init__()
        n = robot.num_joints
        self._robot = robot
        self._q = indices.q
        self._v = num_positions + indices.v
        self._dt = physics_step
        self._inertia = lower_joint_inertia(robot)
        self._damping_bound = damping_bound(robot.effort_limit, robot.velocity_limit)
        num_states = num_positions + len(indices.generalized)
        self._state_input = self.DeclareVectorInputPort("state", num_states)
        self._command_input = self.DeclareAbstractInputPort(
            "joint_command", AbstractValue.Make(None)
        )
        self._share_input = self.DeclareVectorInputPort("k_effort", n)
        self._memory = self.DeclareDiscreteState(3 * n)
        nothing = np.zeros(n)
        self._limited = self.DeclareCacheEntry(
            "command within limits",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(None), calc=self._calc_limited
            ),
            {self.input_port_ticket(self._command_input.get_index())},
        )
        # One step's result: (integral, velocity, effort), read by output and update.
        self._step = self.DeclareCacheEntry(
            "one step of the law",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(
                    PidState(nothing, nothing, nothing)
                ),
                calc=self._calc_step,
            ),
            {self.all_input_ports_ticket(), self.xd_ticket()},
        )
        self.DeclareVectorOutputPort(
            "user_effort",
            n,
            self._calc_effort,
            prerequisites_of_calc={self._step.ticket()},
        )
        self.DeclarePeriodicDiscreteUpdateEvent(physics_step, 0.0, self._update)

    def _calc_limited(self, context: Context, result: AbstractValue) -> None:
        """Set-points within the joints' limits, damping within what counts."""
        command: JointCommand = self._command_input.Eval(context)
        robot = self._robot
        result.set_value(
            replace(
                command,
                position=np.clip(
                    command.position, robot.position_lower, robot.position_upper
                ),
                kp_velocity=np.minimum(command.kp_velocity, self._damping_bound),
            )
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
        command = self._limited.Eval(context)
        memory = PidState(integral, last_v, last_effort)
        grown = integrate(memory, command, q, active, self._dt)
        effort = user_effort(
            memory,
            command,
            grown,
            q,
            v,
            share,
            self._inertia,
            self._robot.effort_limit,
            self._dt,
        )
        result.set_value(PidState(grown, v, np.where(active, effort, 0.0)))

    def _calc_effort(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._step.Eval(context).effort)

    def _update(self, context: Context, discrete: DiscreteValues) -> None:
        step: PidState = self._step.Eval(context)
        discrete.get_mutable_vector(self._memory).SetFromVector(
            np.concatenate([step.integral, step.velocity, step.effort])
        )
