"""The action server ``atlas/bdi_control`` of the original.

It carries out one goal at a time: it places the goal's steps relative to the robot,
feeds them to WALK, and tells when the goal is reached. It is part of the simulation,
whose ``hooks`` call it, so that a goal continues when its program has ended. Clients
are in ``actionlib_module``.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

from atlas_drake.clients.ros_scripts.message_types import (
    GOAL_BEHAVIORS,
    atlas_msgs,
    from_ours,
    to_ours,
)
from atlas_drake.clients.ros_scripts.poses import (
    Frame,
    Rotation,
    Vector,
    from_msg,
    to_msg,
)
from atlas_drake.clients.ros_scripts.ros_types import GOAL_STATUS
from atlas_drake.clients.steering.step_stream import ANSWER, StepStream
from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import (
    AtlasBehaviorManipulateParams,
    AtlasBehaviorStepAction,
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    Behavior,
    BehaviorStatus,
    StepStatus,
)
from atlas_drake.messages.event import STEPS_LEFT
from atlas_drake.simulation import AtlasSimulation

WALKING = (Behavior.WALK, Behavior.STEP)
"""Behaviors that lead to STAND alone."""
FAILED = (
    BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR
    | BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR
    | BehaviorStatus.FAILED_TRANS_COM_POS
    | BehaviorStatus.FAILED_TRANS_COM_VEL
    | BehaviorStatus.FAILED_TRANS_VEL
    | BehaviorStatus.ERROR_FALLING
)
"""Flags of a transition after which a goal cannot be reached."""

Work = Generator[None, None, str]
"""Work on a goal in turns; returns why the goal was not reached, or nothing."""


@dataclass(eq=False)
class Goal:
    """A goal and what became of it.

    Attributes:
        message: The ``WalkDemoGoal``.
        status: A number of ``GOAL_STATUS``; LOST before the server has the goal.
        text: Why the goal was not reached.
        result: The ``WalkDemoResult`` when the goal is done, None before.
    """

    message: Any
    status: int = GOAL_STATUS["LOST"]
    text: str = ""
    result: Any = None


class ActionServer:
    """Carries out goals; a hook of the simulation while one is not done."""

    def __init__(self, sim: AtlasSimulation, say: Callable[[str], object]) -> None:
        """Begins without a goal; ``say`` prints why one was not reached."""
        self._sim, self._say = sim, say
        self._goal: Goal | None = None
        self._work: Work

    def accept(self, goal: Goal) -> None:
        """Takes a goal in place of the present one."""
        self._end("PREEMPTED", "")
        self._goal, self._work = goal, carry_out(self._sim, goal.message)
        goal.status = GOAL_STATUS["ACTIVE"]
        self._sim.hooks.append(self)

    def cancel(self) -> None:
        """Ends the present goal, if any; a walking robot goes to STAND."""
        if self._goal is not None and self._sim.current_behavior in WALKING:
            self._sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND))
        self._end("PREEMPTED", "")

    def __call__(self, sim: AtlasSimulation) -> None:
        """Works on the goal for one turn."""
        try:
            next(self._work)
        except StopIteration as end:
            self._end("ABORTED" if end.value else "SUCCEEDED", end.value)
        except InvalidMessageError as error:
            self._end("ABORTED", str(error))

    def _end(self, status: str, text: str) -> None:
        """Ends the present goal, if any."""
        if self._goal is None:
            return
        self._goal.status, self._goal.text = GOAL_STATUS[status], text
        self._goal.result = atlas_msgs["WalkDemoResult"](
            end_state=from_ours(self._sim.atlas_sim_interface_state),
            success=status == "SUCCEEDED",
        )
        if text:
            self._say(f"! atlas/bdi_control: goal aborted: {text}")
        self._goal = None
        self._sim.hooks.remove(self)


def carry_out(sim: AtlasSimulation, goal: Any) -> Work:
    """Carries out a ``WalkDemoGoal``; its steps are relative to where it begins."""
    names = tuple(GOAL_BEHAVIORS)
    if goal.behavior not in range(len(names)):
        return f"behavior must be 0 to {len(names) - 1}, is {goal.behavior!r}"
    command = AtlasSimInterfaceCommand(behavior=GOAL_BEHAVIORS[names[goal.behavior]])
    present = sim.current_behavior
    if present in WALKING and (present, command.behavior) != (Behavior.STEP,) * 2:
        sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND))
        while sim.current_behavior in WALKING:
            yield
    command.k_effort, begun = list(goal.k_effort), sim.time
    if command.behavior == Behavior.WALK:
        return (yield from _walk(sim, goal.steps, command))
    if command.behavior == Behavior.STEP:
        step = placed(sim, goal.step_params.desired_step)
        step.duration = step.duration or AtlasBehaviorStepAction().step_duration
        command.step_params.desired_step = step
    command.manipulate_params = to_ours(
        goal.manipulate_params, AtlasBehaviorManipulateParams
    )
    sim.publish(command)
    answered = sim.time + ANSWER
    while sim.time <= answered:  # Reports do not reflect the command yet.
        yield
    if command.behavior == Behavior.STEP:
        return (yield from _step(sim, begun))
    while sim.current_behavior != command.behavior:
        if failure := _failure(sim, begun):
            return failure
        yield
    return ""


def _walk(sim: AtlasSimulation, goal: Any, command: AtlasSimInterfaceCommand) -> Work:
    """Feeds the steps to WALK; a step with index 0 is where the foot stands."""
    steps = [placed(sim, step) for step in goal if step.step_index > 0]
    if not steps:
        return "steps of the goal must have one with a step_index above 0"
    for index, step in enumerate(steps, 1):
        step.step_index = index
    stream, taken, begun = StepStream(steps), 0, sim.time
    report = sim.atlas_sim_interface_state
    while not stream.is_over(report):
        following = stream.next_command(report)
        if following is not None:
            following.k_effort, command.k_effort = command.k_effort, []
            sim.publish(following)
        yield
        report = sim.atlas_sim_interface_state
        taken = max(taken, report.walk_feedback.current_step_index)
    if taken < len(steps):
        text = f"WALK ended after {taken} of {len(steps)} steps"
        return _failure(sim, begun) or text
    return ""


def _step(sim: AtlasSimulation, begun: float) -> Work:
    """Waits until the foot of STEP has been in the air and is down again."""
    while not _is_stepping(sim):
        failure = _failure(sim, begun)
        if failure or sim.current_behavior is not Behavior.STEP:
            return failure or "STEP ended without a step"
        yield
    while _is_stepping(sim):
        yield
    return _failure(sim, begun)


def _is_stepping(sim: AtlasSimulation) -> bool:
    flags = sim.atlas_sim_interface_state.step_feedback.status_flags
    return bool(flags & StepStatus.SUBSTATE_STEPPING)


def _failure(sim: AtlasSimulation, since: float) -> str:
    """Returns which steps were left since a time [s], or why a transition failed."""
    flags = FAILED & sim.atlas_sim_interface_state.behavior_feedback.status_flags
    texts = [str(BehaviorStatus(flags).name)] if flags else []
    texts += [e.text for e in sim.events if e.kind == STEPS_LEFT and e.time >= since]
    return "; ".join(texts)


def placed(sim: AtlasSimulation, message: Any) -> AtlasBehaviorStepData:
    """Moves a step from the robot's frame into the world's.

    That frame is below the pelvis, at the height of the lower foot, and turned as the
    pelvis about the vertical. The original's was at height 0 of the world.
    """
    report, q = sim.atlas_sim_interface_state, sim.atlas_state.orientation
    _, _, yaw = Rotation.Quaternion(q.x, q.y, q.z, q.w).GetRPY()
    p = report.pos_est.position
    ground = min(foot.position.z for foot in report.foot_pos_est)
    robot = Frame(Rotation.RPY(0.0, 0.0, yaw), Vector(p.x, p.y, ground))
    step = to_ours(message, AtlasBehaviorStepData)
    placed_pose = to_msg(robot * from_msg(message.pose))
    step.pose = to_ours(placed_pose, type(step.pose))
    return step
