"""``AtlasSimulation`` as users have it: a 3D view and a log join by its sockets."""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from pydrake.geometry import Meshcat

from atlas_drake import simulation
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.errors import ScenarioError
from atlas_drake.messages.event import Event, RunEvent
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.simulation.atlas_simulation import check_types
from atlas_drake.simulation.run_log import Snapshot
from atlas_drake.simulation.sockets import (
    BehaviorEntry,
    ControllerSource,
    Extend,
    WorldMaker,
    additions,
)

if TYPE_CHECKING:
    from atlas_drake.clients.logs.header import LogError
    from atlas_drake.clients.logs.recording import LogRecording
    from atlas_drake.clients.policies.joining import RunningPolicy


class AtlasSimulation(simulation.AtlasSimulation):
    """A simulated Atlas with joint controllers and behaviors, a 3D view and a log.

    Attributes:
        meshcat: Meshcat of the 3D view, None without a view.

    Example:
        >>> sim = AtlasSimulation()
        >>> command = AtlasSimInterfaceCommand()
        >>> command.behavior = command.STAND
        >>> sim.publish(command)
        >>> sim.advance(2.0)
        >>> sim.atlas_sim_interface_state.current_behavior
    """

    def __init__(
        self,
        scenario: Scenario | None = None,
        *,
        controller: ControllerSource | None = None,
        behaviors: Iterable[BehaviorEntry] = (),
        world: Iterable[WorldMaker] = (),
        extend: Extend | Iterable[Extend] = (),
        listeners: Iterable[object] = (),
        view: bool | Meshcat | None = None,
        overlays: Overlays | None = None,
        log: str | Path | None = None,
    ):
        """Builds the diagram and puts the robot on its feet.

        Args:
            scenario: As for the simulation that this one adds to, like the next three.
            controller: In place of the shipped controller.
            behaviors: Beside the shipped behaviors.
            world: Callables that add models.
            extend: As there; called after view and log are added.
            listeners: As there; called after the log.
            view: True opens a 3D view in the browser, prints its address, and shows
                the run in real time. A Meshcat of yours is drawn in at full speed; see
                ``atlas_drake.clients.view.viewer``. None and False show nothing.
            overlays: Plans of the controller that are shown there.
            log: File NAME.mcap that records the run, see ``atlas_drake.clients.logs``.

        Raises:
            TypeError: If an argument is of the wrong type; it names the argument.
            LogError: If the log cannot be written.
            AtlasError: As there.
        """
        check_types(
            scenario=(scenario, Scenario),
            listeners=(listeners, Iterable),
            view=(view, bool | Meshcat),
            overlays=(overlays, Overlays),
            log=(log, str | os.PathLike),
        )
        scenario = scenario or Scenario()
        self.meshcat = view if isinstance(view, Meshcat) else None
        self._recording: LogRecording | None = None
        self._fault: LogError | None = None
        own: list[Extend] = []
        heard: list[object] = []
        # The modules for views and logs load only with a view or a log.
        if view is True:
            from atlas_drake.clients.view.viewer import await_viewer, start_meshcat

            self.meshcat = start_meshcat()
        if self.meshcat is not None:
            from atlas_drake.clients.view.meshcat_view import add_meshcat_view
            from atlas_drake.clients.view.scene import show_start

            shown = {
                "robot": load_robot(scenario.model),
                "meshcat": self.meshcat,
                "overlays": overlays,
            }
            own.append(partial(add_meshcat_view, **shown))
        policy = scenario.policy and scenario.validate().policy
        self._policy: RunningPolicy | None = None
        if policy is not None:
            from atlas_drake.clients.policies.joining import policy_of, policy_parts

            add, overlay = policy_parts(policy, load_robot(scenario.model))
            own.append(add)
            world = [*overlay, *world]
        if log is not None:
            from atlas_drake.clients.logs.recording import LogRecording

            self._recording = LogRecording(Path(log), scenario.log)
            own.append(self._recording.extend)
            heard.append(self._recording)
        super().__init__(
            scenario,
            controller=controller,
            behaviors=behaviors,
            world=world,
            extend=[*own, *additions(extend)],
            listeners=[*heard, *listeners],
        )
        if policy is not None:
            self._policy = policy_of(self)
        if self.meshcat is not None:
            show_start(self.meshcat, self.scenario)
        if view is True and self.meshcat is not None:
            await_viewer(self.meshcat)
            if not self.realtime_rate:
                self.set_realtime_rate(1.0)

    def restore(self, snapshot: Snapshot) -> None:
        """Goes back (or ahead) to a stored snapshot; a 3D view shows it at once.

        As of the simulation that this one adds to.

        Args:
            snapshot: Of this simulation; also of an earlier run.

        Raises:
            ScenarioError: While a log is written, which holds one run.
        """
        self._check_no_log("snapshot", snapshot)
        super().restore(snapshot)

    def _begin_anew(self, scenario: Scenario) -> None:
        self._check_no_log("seed", scenario.seed)
        super()._begin_anew(scenario)

    def _check_no_log(self, field: str, value: object) -> None:
        """Raises ScenarioError while a log is written."""
        if self._recording is not None and self._recording.is_open:
            problem = "a log holds one run: close() completes it"
            raise ScenarioError(field, value, problem)

    def _look(self) -> None:
        super()._look()
        if self._policy is not None:
            self._tell_of(self._policy.events)
        fault = None if self._recording is None else self._recording.fault
        if fault is not self._fault:
            self._fault = fault
            text = f"{fault}; the run continues without it"
            self._tell(self._log.note(RunEvent(self.time, "warning", text)))

    def _tell_of(self, events: Iterable[Event]) -> None:
        """Notes what became of the policy, each event once."""
        for event in events:
            known = {one.time for one in self.events if one.kind == event.kind}
            if round(event.time, 6) not in known:
                self._tell(self._log.note(event))
