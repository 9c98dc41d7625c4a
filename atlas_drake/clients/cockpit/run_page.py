"""A simulation as the page sees it: what it may ask of the run, what it is shown."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from pydrake.geometry import Meshcat

from atlas_drake.clients.cockpit.calls import offered
from atlas_drake.clients.cockpit.clock import Clock
from atlas_drake.clients.cockpit.describe import describe_run
from atlas_drake.clients.cockpit.fields import settings_of
from atlas_drake.clients.cockpit.frame import events_after, frame_json
from atlas_drake.clients.cockpit.hands import Hands
from atlas_drake.clients.cockpit.recording import Recording
from atlas_drake.clients.cockpit.scenario_requests import NextRun, ScenarioRequests
from atlas_drake.clients.cockpit.wire import Frame, Robot, Run, Settings
from atlas_drake.clients.logs.failure_modes import FailureWatch
from atlas_drake.clients.policies.joining import policy_of
from atlas_drake.clients.steering.joint_motion import JointFacts
from atlas_drake.clients.steering.pilot import reports_of
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.config import checked
from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import Behavior, BehaviorStatus
from atlas_drake.messages.behavior_catalog import BehaviorInterface
from atlas_drake.messages.checks import check_vector
from atlas_drake.scenario.timed_message import TimedMessage
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.simulation.sockets import BehaviorEntry

LATELY = 2.0
"""Wall time over which the real-time factor is taken [s]."""
TICKS = 50
"""Number of control ticks whose median is shown."""
WATCH_PERIOD = 0.1
"""Simulated time between two looks for what fails [s]; each costs as much as a tick."""
PUSH_DURATION = 0.1
"""Duration of a push, over which its impulse is spread [s]."""
LARGEST_PUSH = 500.0
"""Largest impulse along an axis [N·s]."""


class RunPage:
    """Requests of the page to a simulation, and frames for it.

    Attributes:
        requests: What the page may ask for, by name.
    """

    def __init__(
        self,
        sim: AtlasSimulation,
        meshcat: Meshcat,
        overlays: Overlays,
        next_run: NextRun,
        recording: Recording,
    ) -> None:
        """Shows a simulation in its present state."""
        self._sim, self._meshcat, self._overlays = sim, meshcat, overlays
        self._next_run, self._recording = next_run, recording
        self.clock = Clock(sim)
        self._hands = Hands(sim)
        self._rate = _Rate()
        self._failures, self._watched = FailureWatch(sim.robot), sim.time
        self._run = self._events_seen = 0
        self._last_time, self._beginning = sim.time, sim.beginning
        scenarios = ScenarioRequests(sim, self.clock, next_run)
        self.requests = offered(
            message=self._send,
            pause=self.clock.pause,
            step=self.clock.step,
            rate=self.clock.rate,
            reset=self.clock.reset,
            push=self._push,
            plan_hand=self._hands.plan,
            move_hand=self._move_hand,
            stop_hand=self._hands.stop,
            back=self.clock.back,
            take_over=sim.drop_schedule,
            show=self._show,
            record=recording.record,
            check=scenarios.check,
            start=scenarios.start,
            written=scenarios.written,
            done=scenarios.done,
        )
        self._policy = policy_of(sim)
        if self._policy is not None:
            self.requests |= offered(
                steer_policy=self._steer_policy,
                take_policy=self._take_policy,
                watch_policy=self._policy.watch,
            )

    def described(self) -> Run:
        """Describes the run."""
        facts = JointFacts.of(self._sim.robot)
        gait = self._sim.scenario.controller_config().gait()
        page = orjson.dumps(describe_run(self._sim))
        return Run(page, self._meshcat.port(), Robot(facts, gait))

    def settings(self) -> Settings:
        """Describes the settings of the present scenario."""
        described = settings_of(self._sim.scenario, self._next_run.why_not)
        return Settings(orjson.dumps(described))

    # ---- requests ------------------------------------------------------------

    def _send(self, **message: Any) -> None:
        """Publishes a message, in the form of a scenario's ``messages``."""
        sim = self._sim
        timed = checked(TimedMessage, message, "")
        sim.publish(timed.message(sim.robot, "", sim.behaviors))

    def _push(self, body: str, impulse_W: Sequence[float]) -> float:
        """Pushes a link now; returns the change of the robot's velocity [m/s]."""
        impulse = check_vector(impulse_W, "impulse_W", 3, LARGEST_PUSH)
        self._sim.apply_push(body, impulse / PUSH_DURATION, PUSH_DURATION)
        return float(np.linalg.norm(impulse) / self._sim.robot.mass)

    def _show(self, overlay: str, on: bool) -> None:
        """Switches an overlay."""
        self._overlays.switch(overlay, on)

    def _move_hand(
        self, hand: str, position_W: Sequence[float], orientation_W: Sequence[float]
    ) -> float:
        """Lets a hand go somewhere, see ``Hands.move``; not one of a policy's arm."""
        policy = self._policy
        if policy is not None and policy.runs:
            problem = "the policy has joints: take them first (None mine)"
            raise InvalidMessageError("hand", hand, problem)
        return self._hands.move(hand, position_W, orientation_W)

    def _take_policy(self) -> None:
        """Lets the policy take its joints."""
        assert self._policy is not None
        self._hands.stop()
        self._policy.take()

    def _steer_policy(self, forward: float, left: float, turn: float) -> None:
        """Asks the policy for a velocity, as shares of its greatest one."""
        assert self._policy is not None
        shares = check_vector([forward, left, turn], "velocity", 3, 1.0)
        self._policy.steer(self._policy.user.fastest * shares)

    # ---- frames --------------------------------------------------------------

    def frame(self) -> Frame:
        """Shows the present, with the events since the last frame."""
        sim, record = self._sim, self._sim.record
        self._note_jumps()
        reports = reports_of(sim)
        rate = 0.0 if self.clock.paused else self._rate.at(sim.time)
        facts = {
            "time": sim.time,
            "rate": rate,
            "pace": sim.realtime_rate,
            "paused": self.clock.paused,
            "tick_ms": _median_ms(sim.tick_seconds),
            "fallen": sim.has_fallen,
            "failure": self._first_failure(),
            "run": self._run,
            "refusals": self._refusals(),
            "overlays": sorted(self._overlays.on),
            "recording": self._recording.is_on,
            "policy": self._shown_policy(),
        }
        events = events_after(sim.events, self._events_seen)
        self._events_seen += len(events)
        return Frame(
            page=frame_json(record, sim.behaviors, reports.command, **facts),
            run=self._run,
            time=sim.time,
            rate=rate,
            behavior=sim.current_behavior.name,
            user=float(reports.command.k.mean()),
            events=events,
            reports=reports,
            steered_policy=self._steered_policy(),
        )

    def _shown_policy(self) -> dict[str, Any] | None:
        policy = self._policy
        if policy is None:
            return None
        return {
            "name": Path(policy.user.policy.description.network).stem,
            "joints": policy.user.joints.indices,
            "runs": policy.runs,
            "velocity": policy.velocity,
            "watched": policy.is_watched,
        }

    def _steered_policy(self) -> tuple[float, float, float] | None:
        policy = self._policy
        if policy is None or not policy.runs:
            return None
        fastest = policy.user.fastest
        ratios = np.zeros(3)
        np.divide(policy.velocity, fastest, out=ratios, where=fastest != 0.0)
        forward, left, turn = map(float, ratios)
        return forward, left, turn

    def watch(self) -> None:
        """Looks for what fails, also between two frames of a run that is fast."""
        self._note_jumps()
        self._hands.attend()
        sim = self._sim
        if sim.time >= self._watched + WATCH_PERIOD - 1e-9 and not sim.has_fallen:
            self._watched = sim.time
            self._failures.update(sim.record)

    def _note_jumps(self) -> None:
        """Counts the jumps of time: by the page, or by the program itself."""
        sim = self._sim
        if sim.time < self._last_time or sim.beginning is not self._beginning:
            self._run, self._events_seen = self._run + 1, 0
            self._hands.stop()
            self._failures, self._watched = FailureWatch(sim.robot), sim.time
            self._rate = _Rate()
        self._last_time, self._beginning = sim.time, sim.beginning

    def _first_failure(self) -> str | None:
        first = self._failures.first
        if first is None or not self._sim.has_fallen:
            return None
        return f"{first.kind} {first.place}".strip() + f" at {first.time:.1f} s"

    def _refusals(self) -> dict[str, str]:
        """Returns why a behavior would be refused now, by name; empty if it would not.

        Only what the order of behaviors says is known before a request.
        """
        sim = self._sim
        source = sim.behaviors.entry(sim.current_behavior)
        return {
            entry.name: why_refused(entry, source, sim.behaviors, fallen=sim.has_fallen)
            for entry in sim.behaviors
        }


class _Rate:
    """The simulated seconds per second, lately."""

    def __init__(self) -> None:
        self._past: deque[tuple[float, float]] = deque()

    def at(self, simulated: float) -> float:
        """Notes the simulated time [s]; returns the rate."""
        now = time.perf_counter()
        self._past.append((now, simulated))
        while now - self._past[0][0] > LATELY:
            self._past.popleft()
        passed = now - self._past[0][0]
        return (simulated - self._past[0][1]) / passed if passed > 0.0 else 0.0


def _median_ms(ticks: Sequence[float]) -> float:
    return 1e3 * float(np.median(ticks[-TICKS:])) if len(ticks) else 0.0


def why_refused(
    entry: BehaviorInterface,
    source: BehaviorInterface,
    catalog: Iterable[BehaviorInterface],
    *,
    fallen: bool,
) -> str:
    """Returns why a behavior would be refused after another; empty if it would not.

    Args:
        entry: The behavior that is asked for.
        source: The active behavior.
        catalog: All behaviors.
        fallen: True for a robot that lies on the ground.
    """
    if not isinstance(entry, BehaviorEntry) or not isinstance(source, BehaviorEntry):
        return ""  # A controller of the user's own has rules of its own.
    if fallen and entry.upright:
        return "The robot has fallen: reset it (r)"
    # WALK is reached through STAND.
    on_the_way = entry.behavior is Behavior.WALK and "STAND" in source.leads_to
    if on_the_way or entry.may_follow(source):
        return ""
    illegal = BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR
    return entry.refusal_in_words(illegal, source, catalog)
