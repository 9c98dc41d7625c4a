"""Behaviours and whole-body QP, at the control rate.

The update is an unrestricted one: Drake runs these before the discrete updates of the
same instant, so that the plant's step that begins at a control tick already has that
tick's efforts. There is no latency but the hold over the control period.
"""

import time
from collections.abc import MutableSequence
from dataclasses import dataclass

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform
from pydrake.systems.framework import (
    BasicVector,
    Context,
    State,
)

from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.supervisor import Supervisor, SupervisorState
from atlas_drake.control.gains import ControlGains
from atlas_drake.control.joints.blend import behavior_share, effort_bounds
from atlas_drake.control.joints.damping import limp_effort
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.constraints import EffortBounds
from atlas_drake.control.whole_body.model import WholeBodyModel, nominal_com_height
from atlas_drake.control.whole_body.qp import WholeBodyQp, WholeBodySolution
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import NOTHING, Frozen
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
    Pose,
    Quaternion,
    Vector3,
)
from atlas_drake.messages.commands import CommandsInForce
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.scratch import declare_scratch_context


@dataclass(frozen=True)
class ControllerState(Frozen):
    """What the controller remembers.

    Attributes:
        supervisor: Of the behaviours.
        effort: The behaviour's effort per joint [N·m], shape (n,).
        solution: Of the last QP; None before the first one.
        unsolved: Ticks whose QP had no solution.
    """

    supervisor: SupervisorState
    effort: np.ndarray
    solution: WholeBodySolution | None = None
    unsolved: int = 0


class BehaviorController(CollectableSystem):
    """State, user efforts and the behaviour request in, behaviour efforts out.

    Input ports:
        state: Measured positions and velocities, in plant order.
        foot_loads: Vertical forces of the ground on left and right foot [N], (2,).
        user_forecast: ``UserForecast``, what the user's law will do in the tick.
        commands: ``CommandsInForce``

    Output ports:
        behavior_effort: [N·m], shape (n,).
        controller_state: ``ControllerState``, for whoever watches.
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        gains: ControlGains,
        period: float,
        initial_behavior: Behavior,
    ):
        """Runs every ``period`` [s]."""
        super().__init__()
        n = robot.num_joints
        self._robot = robot
        self._period = period
        self._limit = limit = robot.effort_limit
        self._own_bounds = EffortBounds(-limit, limit, np.zeros(n, dtype=bool))
        self._model = WholeBodyModel(robot)
        self._pelvis = robot.indices(self._model.plant).pelvis
        self._qp = WholeBodyQp(robot, gains)
        height = nominal_com_height(self._model) - gains.com_drop
        self._supervisor = Supervisor(self._model, gains, height)
        self.tick_seconds: MutableSequence[float] | None = None
        """Wall-clock time of each tick, kept only when set to a list: a measurement of
        the machine, no part of the Context."""

        start = ControllerState(self._supervisor.start(initial_behavior), np.zeros(n))
        self._state_input = self.DeclareVectorInputPort("state", self._model.num_states)
        self._load_input = self.DeclareVectorInputPort("foot_loads", 2)
        self._user_input = self.DeclareAbstractInputPort(
            "user_forecast", AbstractValue.Make(NOTHING)
        )
        self._command_input = self.DeclareAbstractInputPort(
            "commands", AbstractValue.Make(NOTHING)
        )
        self._scratch = declare_scratch_context(self, self._model.create_context)
        self._memory = self.DeclareAbstractState(AbstractValue.Make(start))
        self.DeclareVectorOutputPort(
            "behavior_effort",
            n,
            self._calc_effort,
            prerequisites_of_calc={self.xa_ticket()},
        )
        self.DeclareAbstractOutputPort(
            "controller_state",
            lambda: AbstractValue.Make(start),
            lambda context, out: out.set_value(self._remembered(context)),
            prerequisites_of_calc={self.xa_ticket()},
        )
        self.DeclareAbstractOutputPort(
            "atlas_sim_interface_state",
            lambda: AbstractValue.Make(AtlasSimInterfaceState()),
            self._calc_report,
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def reset(self, context: Context, behavior: Behavior) -> None:
        """Begins anew with ``behavior``; the log of events and its count are kept."""
        before = self._remembered(context)
        supervisor = self._supervisor.restart(
            before.supervisor, behavior, context.get_time()
        )
        after = ControllerState(
            supervisor, np.zeros(self._robot.num_joints), unsolved=before.unsolved
        )
        context.get_mutable_abstract_state(self._memory).set_value(after)

    def _remembered(self, context: Context) -> ControllerState:
        return context.get_abstract_state(self._memory).get_value()

    def _update(self, context: Context, state: State) -> None:
        begin = time.perf_counter()
        after = self._tick(context, self._remembered(context))
        state.get_mutable_abstract_state(self._memory).set_value(after)
        if self.tick_seconds is not None:
            self.tick_seconds.append(time.perf_counter() - begin)

    def _tick(self, context: Context, before: ControllerState) -> ControllerState:
        terms = self._model.evaluate(
            self._scratch.Eval(context), self._state_input.Eval(context)
        )
        commands: CommandsInForce = self._command_input.Eval(context)
        share = commands.joints.k_effort * (1.0 / K_EFFORT_MAX)
        seen = Observation(
            time=context.get_time(),
            dt=self._period,
            terms=terms,
            foot_force=self._load_input.Eval(context),
            user_share=share,
        )
        supervisor, command = self._supervisor.update(
            before.supervisor, seen, commands.requests
        )
        if command is None:
            effort = (
                limp_effort(terms.v, self._limit)
                if supervisor.limp
                else np.zeros(self._robot.num_joints)
            )
            return ControllerState(supervisor, effort, unsolved=before.unsolved)
        if share.any():
            solution, effort = self._solve_shared(context, terms, command, share)
        else:
            solution = self._qp.solve(terms, command, self._own_bounds)
            effort = solution.effort
        return ControllerState(
            supervisor, effort, solution, before.unsolved + (not solution.found)
        )

    def _solve_shared(
        self,
        context: Context,
        terms: WholeBodyTerms,
        command: WholeBodyCommand,
        share: np.ndarray,
    ) -> tuple[WholeBodySolution, np.ndarray]:
        """The QP's answer where the user has a share; the behaviour's part of it."""
        user = self._user_input.Eval(context)
        solution = self._qp.solve(
            terms, command, effort_bounds(share, user, self._limit)
        )
        own = behavior_share(
            solution.effort, solution.joint_acceleration, share, user, self._limit
        )
        return solution, own

    def _calc_effort(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._remembered(context).effort)

    def _calc_report(self, context: Context, output: AbstractValue) -> None:
        memory = self._remembered(context)
        commands = self._command_input.Eval(context)
        state = self._state_input.Eval(context)
        message = AtlasSimInterfaceState()
        message.header.stamp = context.get_time()
        self._supervisor.report(memory.supervisor, message)
        last = commands.messages[-1].message if commands.messages else None
        if last is not commands.request.command:
            # Another message than the one that the behaviours heard.
            message.error_code = commands.error_code
        if commands.error_code is ErrorCode.NO_SUCH_BEHAVIOR:
            message.behavior_feedback.status_flags |= (
                BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR
            )
        message.f_out = memory.effort.tolist()
        message.k_effort = commands.k_effort.astype(int).tolist()
        message.pos_est.position = Vector3.from_array(state[self._pelvis.position])
        message.pos_est.velocity = Vector3.from_array(state[self._pelvis.velocity])
        soles = self._model.soles(self._scratch.Eval(context), state)
        message.foot_pos_est = [_pose(X_WF) for X_WF in soles]
        output.set_value(message)


def _pose(X_WF: RigidTransform) -> Pose:
    quaternion = X_WF.rotation().ToQuaternion()
    return Pose(
        position=Vector3.from_array(X_WF.translation()),
        orientation=Quaternion.from_wxyz(quaternion.wxyz()),
    )
