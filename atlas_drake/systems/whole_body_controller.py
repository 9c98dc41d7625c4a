"""The shipped controller: behaviors and whole-body QP, at the control rate.

It is connected to the station's controller socket like any other controller.

The update is unrestricted: Drake runs unrestricted updates before the discrete updates
of the same instant, so that the plant's step that begins at a control tick already has
the efforts of that tick. The only latency is the hold over the control period.
"""

import time
from collections.abc import Iterable, MutableSequence
from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Context, State

from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.supervisor import Supervisor
from atlas_drake.behaviors.supervisor_state import SupervisorState
from atlas_drake.control.balance.feedback import pendulum_frequency
from atlas_drake.control.joints.blend import behavior_share, effort_bounds
from atlas_drake.control.joints.speed_hold import SpeedHold, damped
from atlas_drake.control.whole_body.constraints import EffortBounds
from atlas_drake.control.whole_body.contact_tasks import ComTask
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.control.whole_body.qp import WholeBodyQp, WholeBodySolution
from atlas_drake.control.whole_body.terms import mean_sole_height
from atlas_drake.frozen import NOTHING, Frozen, Nothing, read_only, replace
from atlas_drake.messages import Behavior
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import ControllerStatus, Plan, PlannedPaths
from atlas_drake.messages.event import Event
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem

LONG_UNSOLVED = 5
"""Control ticks in a row without a solution for a warning; the fallback handles one or
two."""
YIELDING = 0.01
"""Share of the held speeds' damping in a leg in the air. Not 0: a motor that loses its
gains as Drake prepares a step stops the program."""
_UNKNOWN = read_only(np.full(2, np.nan))


@dataclass(frozen=True)
class ControllerState(Frozen):
    """State of the controller from one tick to the next."""

    supervisor: SupervisorState
    effort: np.ndarray  # Of the behavior, per joint [N·m], shape (n,).
    com: np.ndarray  # Center of mass, horizontal in W [m], shape (2,).
    hands: np.ndarray  # Wrenches on the hands, followed slowly [N·m; N], shape (2, 6).
    omega: float = 1.0  # Natural frequency of the pendulum [1/s].
    solution: WholeBodySolution | None = None  # None without a QP.
    unsolved: int = 0  # Number of ticks whose QP had no solution.
    in_a_row: int = 0  # Number of them since the last solution.
    warned: bool = False  # True once the run has its warning of many of them.
    com_push: np.ndarray | None = None  # Horizontal acceleration commanded [m/s²].
    hold: SpeedHold | Nothing = NOTHING  # What the motors add to these efforts.


class WholeBodyController(CollectableSystem):
    """State, user efforts and the behavior request in, behavior efforts out.

    Input ports:
        state: Measured positions and velocities, in plant order.
        foot_loads: Vertical forces of the ground on left and right foot [N], (2,).
        foot_wrenches: Contact wrenches on left and right foot, in W at the sole's
            center [N·m; N], (12,): read while a sole is not down as a whole.
        hand_wrenches: Wrenches on left and right hand, in W [N·m; N], (12,): what they
            carry becomes part of the model.
        user_forecast: ``UserForecast``, the forecast of the user's law for the tick.
        commands: ``ActiveCommand``

    Output ports:
        behavior_effort: Efforts of the behavior [N·m], shape (n,).
        speed_hold: ``SpeedHold``, what the motors add to these efforts, or
            ``NOTHING``.
        controller_status: ``ControllerStatus``
        planned_paths: ``PlannedPaths``
        event_count: Number of events so far, shape (1,): read at every tick, where the
            status would cost more.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        config: ControllerConfig,
        period: float,
        initial_behavior: Behavior,
        entries: Iterable[BehaviorEntry],
    ):
        """Makes the behaviors of ``entries``; ticks every ``period`` [s]."""
        super().__init__()
        n = robot.num_joints
        self._robot = robot
        self._period = period
        self._limit = limit = robot.effort_limit
        carrying = robot.limb("l_leg", "r_leg", "back")
        self._damping = config.gains.speed_hold * limit * carrying
        self._damped = damped(limit)
        self._own_bounds = EffortBounds(-limit, limit, np.zeros(n, dtype=bool))
        self._model = WholeBodyModel(robot)
        self._qp = WholeBodyQp(robot, config.gains)
        height = robot.com_height - config.stance.com_drop
        self._supervisor = Supervisor(self._model, config, height, entries)
        self.tick_seconds: MutableSequence[float] | None = None
        """Wall-clock time of each tick [s], kept only when set to a list; it depends on
        the machine, and is not part of the Context."""

        start = ControllerState(
            self._supervisor.start(initial_behavior),
            np.zeros(n),
            read_only(np.zeros(2)),
            read_only(np.zeros((2, 6))),
        )
        self._state_input = self.DeclareVectorInputPort("state", self._model.num_states)
        self._load_input = self.DeclareVectorInputPort("foot_loads", 2)
        self._wrench_input = self.DeclareVectorInputPort("foot_wrenches", 12)
        self._hand_input = self.DeclareVectorInputPort("hand_wrenches", 12)
        self._hand_loads = config.hand_loads
        self._user_input = self.declare_value_input("user_forecast")
        self._command_input = self.declare_value_input("commands")
        self._scratch = self.declare_scratch_context(self._model.create_context)
        self._state = self.declare_value_state(start)
        sources = {self.xa_ticket()}
        self.declare_vector_output(
            "behavior_effort",
            n,
            lambda context: self._state.get(context).effort,
            sources,
        )
        self.declare_value_output(
            "speed_hold", lambda context: self._state.get(context).hold, sources
        )
        self.declare_vector_output(
            "event_count",
            1,
            lambda context: [self._state.get(context).supervisor.event_count],
            sources,
        )
        self.declare_value_output("controller_status", self._status, sources)
        self.declare_value_output("planned_paths", self._paths, sources)
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, 0.0, self._update)

    def reset(self, context: Context, behavior: Behavior) -> None:
        """Starts again with ``behavior``; the events and their count are kept."""
        before = self._state.get(context)
        after = ControllerState(
            self._supervisor.restart(before.supervisor, behavior),
            np.zeros(self._robot.num_joints),
            before.com,
            read_only(np.zeros((2, 6))),
            unsolved=before.unsolved,
            warned=before.warned,
        )
        self._state.set(context, after)

    def _update(self, context: Context, state: State) -> None:
        begin = time.perf_counter()
        after = self._tick(context, self._state.get(context))
        self._state.set(state, after)
        if self.tick_seconds is not None:
            self.tick_seconds.append(time.perf_counter() - begin)

    def _tick(self, context: Context, before: ControllerState) -> ControllerState:
        hands = read_only(
            self._hand_loads.follow(
                before.hands, self._felt(context, before), self._period
            )
        )
        terms = self._model.evaluate(
            self._scratch.Eval(context),
            self._state_input.Eval(context),
            self._hand_loads.carried(hands),
            hands,
        )
        commands: ActiveCommand = self._command_input.Eval(context)
        k = commands.joints.k
        first = not before.supervisor.has_begun
        observation = Observation(
            time=context.get_time(),
            dt=self._period,
            terms=terms,
            foot_force=_UNKNOWN if first else read_only(self._load_input.Eval(context)),
            k=k,
            foot_wrenches=lambda: self._wrench_input.Eval(context),
        )
        supervisor, command = self._supervisor.update(
            before.supervisor, observation, commands.requests
        )
        for text in self._hand_loads.news(before.hands, hands):
            event = Event(context.get_time(), "load", text)
            supervisor = supervisor.with_event(event)
        com = read_only(terms.com[:2].copy())
        omega = pendulum_frequency(float(terms.com[2]) - mean_sole_height(terms))
        if command is None:
            return ControllerState(
                supervisor,
                np.zeros(self._robot.num_joints),
                com,
                hands,
                omega,
                unsolved=before.unsolved,
                warned=before.warned,
                hold=self._damped if supervisor.in_damping_mode else NOTHING,
            )
        if commands.joints.has_user:
            user, limit = self._user_input.Eval(context), self._limit
            bounds = effort_bounds(k, user, limit)
            solution = self._qp.solve(terms, command, bounds)
            effort = behavior_share(
                solution.effort, solution.joint_acceleration, k, user, limit
            )
        else:
            solution = self._qp.solve(terms, command, self._own_bounds)
            effort = solution.effort
        unsolved = before.unsolved + (not solution.found)
        in_a_row = 0 if solution.found else before.in_a_row + 1
        warned = before.warned or in_a_row == LONG_UNSOLVED
        if warned and not before.warned:
            text = (
                f"the controller has found no solution in {unsolved} control ticks so "
                "far; a fallback that does not balance holds the robot "
                f"({solution.why or 'the reason is not known'})"
            )
            warning = Event(context.get_time(), "warning", text)
            supervisor = supervisor.with_event(warning)
        targets = (task.target for task in command.tasks if isinstance(task, ComTask))
        push = next(targets, None)
        return ControllerState(
            supervisor,
            effort,
            com,
            hands,
            omega,
            solution,
            unsolved,
            in_a_row,
            warned,
            None if push is None else push[:2],
            self._held(terms.v, solution),
        )

    def _held(self, v: np.ndarray, solution: WholeBodySolution) -> SpeedHold | Nothing:
        """Returns the speeds to hold; a leg in the air yields as it lands."""
        if not self._damping.any():
            return NOTHING
        damping = self._damping.copy()
        for leg, foot in zip(self._robot.legs, self._robot.file.feet, strict=True):
            if foot.sole_frame not in solution.contact_wrenches:
                damping[leg.joints] *= YIELDING
        acceleration = solution.joint_acceleration
        return SpeedHold.planned(v, acceleration, damping, self._period)

    def _felt(self, context: Context, before: ControllerState) -> np.ndarray:
        """Returns the wrenches on the hands, shape (2, 6).

        Without those that a behavior of a user has among its contacts: the QP chooses
        their forces.
        """
        felt = self._hand_input.Eval(context).reshape(2, 6).copy()
        if felt.any() and before.solution is not None:
            held = {
                self._model.plant.GetFrameByName(frame).body().name()
                for frame in before.solution.contact_wrenches
            }
            felt[[hand in held for hand in self._robot.file.hands]] = 0.0
        return felt

    def _status(self, context: Context) -> ControllerStatus:
        state = self._state.get(context)
        solution = state.solution
        status = self._supervisor.status(state.supervisor, state.com, state.omega)
        return replace(
            status,
            plan=self._with_pivots(status.plan, state),
            solved=None if solution is None else solution.found,
            unsolved=state.unsolved,
            why_unsolved="" if solution is None else solution.why,
        )

    def _with_pivots(self, plan: Plan, state: ControllerState) -> Plan:
        """Adds the CMP that balance commands, and the one that the forces give."""
        solution, push = state.solution, state.com_push
        if solution is None or push is None:
            return plan
        force = sum(solution.contact_wrenches.values(), state.hands.sum(axis=0))[3:5]
        rate = (plan.omega or state.omega) ** 2
        mass = self._robot.mass + float(self._hand_loads.carried(state.hands).sum())
        return replace(
            plan,
            cmp_reference=read_only(state.com - push / rate),
            cmp=read_only(state.com - force / (mass * rate)),
        )

    def _paths(self, context: Context) -> PlannedPaths:
        state = self._state.get(context)
        return self._supervisor.paths(state.supervisor, state.com, state.omega)
