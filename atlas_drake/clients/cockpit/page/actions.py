"""What a browser asks for, and how it becomes messages and requests to the run."""

from __future__ import annotations

import asyncio
import itertools
import logging
import time
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from typing import Any

from atlas_drake.clients.cockpit.calls import call, offered
from atlas_drake.clients.cockpit.page.session import Session, Viewer
from atlas_drake.clients.cockpit.wire import Answer, Frame, Request, Run
from atlas_drake.clients.steering.pilot import Pilot
from atlas_drake.messages import AtlasCommand, AtlasSimInterfaceCommand
from atlas_drake.records.plain import to_plain

PATIENCE, LONG_PATIENCE = 5.0, 60.0
"""Longest wait for an answer, and for one that takes work [s]."""
TAKES_WORK = ("record", "check", "start")
MOST_OPEN, MOST_OPEN_WATCHING = 30, 3
"""Requests without an answer of who has control, and of others, beyond which further
ones are dropped, but for STOP."""
STALE = 0.5
"""Age of a frame beyond which the run may have stopped [s]."""

SESSION = {
    "take_control": Session.take_control,
    "release_control": Session.release_control,
}
"""What concerns the viewers alone, by name."""
PILOT = offered(
    stop=Pilot.stop,
    behave=Pilot.behave,
    walk=Pilot.walk,
    stop_walking=Pilot.stop_walking,
    gait=Pilot.gait,
    plan_to=Pilot.plan_to,
    move_step=Pilot.move_step,
    send_plan=Pilot.send_plan,
    drop_plan=Pilot.drop_plan,
    share=Pilot.share,
    move=Pilot.move,
    hold=Pilot.hold,
    go_limp=Pilot.go_limp,
    save_pose=Pilot.save_pose,
    go_to_pose=Pilot.go_to_pose,
)
"""What the pilot does, by name. All else is asked of the run, or of the log."""
STEER_POLICY = "steer_policy"
"""What walking by direction is asked of while a policy has its joints."""
REST = {"forward": 0.0, "left": 0.0, "turn": 0.0}
STOP, COLUMNS = "stop", "columns"
"""What any viewer with the token may do, and any viewer at all."""
ENDS_HANDS = (STOP, "share", "move", "hold", "go_limp", "go_to_pose")
"""What of the pilot ends the way of a hand, which commands joints, too."""

_log = logging.getLogger(__name__)


class Refused(Exception):
    """Something that was not done; says why."""


class Actions:
    """Carries out what browsers ask for, one thing after the other; STOP at once."""

    def __init__(self, send: Callable[[Request], object], session: Session) -> None:
        """Asks a run by ``send``."""
        self._send, self._session = send, session
        self._numbers = itertools.count(1)
        self._open: dict[int, asyncio.Future[Any]] = {}
        self._in_turn = asyncio.Lock()
        self._run: Run | None = None
        self._frame: Frame | None = None
        self._has_seen = asyncio.Event()  # A frame of the run.
        self._received = 0.0
        self._pilot: Pilot | None = None
        self._published: list[Request] = []
        self._fault = ""

    # ---- from the simulation -------------------------------------------------

    def join(self, run: Run) -> None:
        """Asks another run from now on."""
        self._run, self._frame, self._pilot = run, None, None
        self._has_seen.clear()

    def see(self, frame: Frame) -> None:
        """Sees a frame; a walk goes on."""
        before, self._frame = self._frame, frame
        self._received = time.monotonic()
        robot = self._run.robot if self._run else None
        if robot is None or frame.reports is None:
            return
        pilot = self._pilot or Pilot(
            robot.joints, robot.gait, self._publish, frame.reports
        )
        jumped = before is not None and before.run != frame.run
        pilot.see(frame.reports, jumped=jumped)
        self._pilot = pilot
        self._has_seen.set()
        self._unasked(lambda: pilot.update(0.0))

    def take(self, answer: Answer) -> None:
        """Hands an answer to who waits for it."""
        waiting = self._open.pop(answer.number, None)
        if waiting is None or waiting.done():
            return
        if answer.problem:
            waiting.set_exception(Refused(answer.problem))
        else:
            waiting.set_result(answer.value)

    @property
    def beside(self) -> dict[str, Any]:
        """What the page shows of the pilot, beside a frame."""
        pilot, frame = self._pilot, self._frame
        if pilot is None or frame is None:  # A log.
            return {
                "walking": {"direction": None, "gait": {}, "plan": []},
                "poses": [],
            }
        steered = frame.steered_policy
        of_policy = steered if steered is not None and any(steered) else None
        return {
            "walking": {
                "direction": pilot.direction or of_policy,
                "gait": pilot.gait_in_force,
                "plan": pilot.plan_marks,
            },
            "poses": pilot.poses,
        }

    # ---- as time goes on -----------------------------------------------------

    def move(self, dt: float) -> None:
        """Moves the set-points of joints for ``dt`` on the wall [s]."""
        pilot, frame = self._pilot, self._frame
        if pilot is None or frame is None:
            return
        if time.monotonic() - self._received < STALE and frame.rate > 0.0:
            self._unasked(lambda: pilot.update(dt * frame.rate))

    def end_walk(self) -> None:
        """Ends a walk by direction, or a policy's, which nobody steers any more."""
        if self._steers_policy:
            self._send(Request(0, STEER_POLICY, REST))
        pilot = self._pilot
        if pilot is not None and pilot.direction is not None:
            self._unasked(pilot.stop_walking)

    @property
    def _steers_policy(self) -> bool:
        return self._frame is not None and self._frame.steered_policy is not None

    def _unasked(self, does: Callable[[], object]) -> None:
        """Lets the pilot do something that no browser waits for."""
        try:
            does()
        except Exception as error:  # The page goes on; it is said once.
            if str(error) != self._fault:
                self._fault = str(error)
                _log.warning("%s: %s", type(error).__name__, error)
        for request in self._take_published():
            self._send(request)

    # ---- from browsers -------------------------------------------------------

    async def do(self, viewer: Viewer, name: str, given: Mapping[str, Any]) -> Any:
        """Does what a viewer asks for, and returns its value, or raises Refused."""
        if name in SESSION:
            return self._change_session(viewer, name)
        self._check_may(viewer, name)
        is_holder = viewer is self._session.holder
        if is_holder and name != COLUMNS:
            self._session.acted(viewer)
        most = MOST_OPEN if is_holder else MOST_OPEN_WATCHING
        if viewer.open >= most and name != STOP:
            raise Refused("Too many commands at once: this one is dropped")
        viewer.open += 1
        patience = LONG_PATIENCE if name in TAKES_WORK else PATIENCE
        try:
            async with asyncio.timeout(patience):
                if name == STOP:
                    self._session.show_stopping(viewer)
                if name in (STOP, COLUMNS):
                    return await self._carry_out(name, given)
                async with self._in_turn:
                    return await self._carry_out(name, given)
        except TimeoutError:
            raise Refused("The simulation does not answer: is it running?") from None
        finally:
            viewer.open -= 1

    def _change_session(self, viewer: Viewer, name: str) -> bool:
        if not viewer.may_steer:
            raise Refused("Open the address with its token to steer")
        SESSION[name](self._session, viewer)
        if self._session.holder is None:
            self.end_walk()
        return True

    def _check_may(self, viewer: Viewer, name: str) -> None:
        if self._run is None:
            raise Refused("The simulation has not begun")
        if name in PILOT and self._run.robot is None:
            raise Refused("A log is shown: it can be played, not commanded")
        if name != COLUMNS and not viewer.may_steer:
            raise Refused("You are watching: the address with its token lets you steer")
        if name not in (STOP, COLUMNS) and viewer is not self._session.holder:
            raise Refused("You are watching: ask for control first")

    async def _carry_out(self, name: str, given: Mapping[str, Any]) -> Any:
        if name in ("walk", "stop_walking") and self._steers_policy:
            velocity = REST | (dict(given) if name == "walk" else {})
            return await self._ask(Request(0, STEER_POLICY, velocity))
        if name == "move_hand" and self._pilot is not None:
            self._pilot.forget_joints()
        if name not in PILOT:
            return await self._ask(Request(0, name, given))
        while (pilot := self._pilot) is None:
            await self._has_seen.wait()
        try:
            value = call(PILOT, name, given, pilot)
            pilot.update(0.0)
        finally:
            published = self._take_published()
        if name in ENDS_HANDS:
            self._send(Request(0, "stop_hand"))
        await asyncio.gather(*map(self._ask, published))
        return True if value is None else value

    def _ask(self, request: Request) -> Awaitable[Any]:
        """Sends a request, and returns what its answer will be."""
        number = next(self._numbers)
        waiting: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._open[number] = waiting
        waiting.add_done_callback(lambda _: self._open.pop(number, None))
        self._send(replace(request, number=number))
        return waiting

    def _publish(self, message: AtlasCommand | AtlasSimInterfaceCommand) -> None:
        """Collects a message of the pilot's."""
        kind = (
            "atlas_command"
            if isinstance(message, AtlasCommand)
            else "atlas_sim_interface_command"
        )
        self._published.append(Request(0, "message", {kind: to_plain(message)}))

    def _take_published(self) -> list[Request]:
        published, self._published = self._published, []
        return published
