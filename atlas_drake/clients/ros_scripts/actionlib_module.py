"""The names of ``actionlib``: clients of the action server, for one run."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

from atlas_drake.clients.ros_scripts.action_server import ActionServer, Goal
from atlas_drake.clients.ros_scripts.clock import Clock
from atlas_drake.clients.ros_scripts.message_types import atlas_msgs, from_ours
from atlas_drake.clients.ros_scripts.ros_message import Duration
from atlas_drake.clients.ros_scripts.ros_types import GOAL_STATUS, GoalStatus
from atlas_drake.clients.ros_scripts.unknown import ScriptError, unknown

SERVER, ACTION = "atlas/bdi_control", "atlas_msgs/WalkDemoAction"
"""Name of the only action server, and its action."""


class SimpleActionClient:
    """``actionlib.SimpleActionClient``."""

    def __init__(
        self, clock: Clock, server: ActionServer, name: str, action: Any
    ) -> None:
        """Finds the server by name and class of the action."""
        if str(name).strip("/") != SERVER:
            raise unknown(f"action {name!r}", str(name), [SERVER])
        if getattr(action, "_type", None) != ACTION:
            raise ScriptError(f"action {SERVER} is of type {ACTION}, not {action!r}")
        self._clock, self._server = clock, server
        self._goal = Goal(None)

    def wait_for_server(self, _timeout: object = None) -> bool:
        """Returns True at once: the server is there."""
        return True

    def send_goal(
        self,
        goal: Any,
        done_cb: Callable[..., object] | None = None,
        active_cb: Callable[..., object] | None = None,
        feedback_cb: Callable[..., object] | None = None,
    ) -> None:
        """Sends a goal in place of the present one."""
        self._goal = Goal(goal)
        with self._clock.undisturbed():
            self._server.accept(self._goal)
        self._clock.last_command = self._clock.sim.time
        if done_cb or active_cb or feedback_cb:
            follow = partial(self._follow, self._goal, done_cb, active_cb, feedback_cb)
            self._clock.start_callbacks(follow)

    def send_goal_and_wait(self, goal: Any, timeout: Any = None, *_: object) -> int:
        """Sends a goal, waits for its result, and returns its state."""
        self.send_goal(goal)
        if not self.wait_for_result(timeout):
            self.cancel_goal()
        return self.get_state()

    def wait_for_result(self, timeout: Any = None) -> bool:
        """Waits until the goal is done, at most for a ``Duration`` or a number [s].

        As in the original, 0 is no limit. Returns False after the limit.
        """
        seconds = timeout.to_sec() if isinstance(timeout, Duration) else timeout
        limit = seconds or math.inf
        return self._clock.wait_for(lambda: self._goal.result is not None, limit)

    def get_result(self) -> Any:
        """Returns the ``WalkDemoResult``; None before the goal is done."""
        return self._goal.result

    def get_state(self) -> int:
        """Returns the goal's state; LOST without one."""
        return self._goal.status

    def get_goal_status_text(self) -> str:
        """Returns why the goal was not reached."""
        return self._goal.text

    def cancel_goal(self) -> None:
        """Ends the goal; a walking robot goes to STAND."""
        if self._goal.status == GOAL_STATUS["ACTIVE"]:
            self.cancel_all_goals()

    def cancel_all_goals(self) -> None:
        """Ends the goal of any client."""
        with self._clock.undisturbed():
            self._server.cancel()

    def _follow(
        self,
        goal: Goal,
        done_cb: Callable[..., object] | None,
        active_cb: Callable[..., object] | None,
        feedback_cb: Callable[..., object] | None,
    ) -> None:
        """Calls back until the goal is done."""
        clock = self._clock
        if active_cb:
            active_cb()
        while goal.result is None and clock.advance_to(clock.sim.time + clock.period):
            if feedback_cb:
                state = from_ours(clock.sim.atlas_sim_interface_state)
                feedback_cb(atlas_msgs["WalkDemoFeedback"](state=state))
        if goal.result is not None and done_cb:
            done_cb(goal.status, goal.result)


def actionlib_names(clock: Clock, say: Callable[[str], object]) -> dict[str, Any]:
    """Returns the contents of the module ``actionlib``."""
    server = ActionServer(clock.sim, say)
    return {
        "GoalStatus": GoalStatus,
        "SimpleActionClient": partial(SimpleActionClient, clock, server),
    }
