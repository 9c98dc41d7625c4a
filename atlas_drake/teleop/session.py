"""A session at the panel: read, command, simulate a slice, keep to real time.

The session owns the clock only; ``commander`` makes the commands.
"""

from __future__ import annotations

import time

from atlas_drake.frozen import replace
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.teleop.commander import Commander
from atlas_drake.teleop.controls import Action, Button, Controls
from atlas_drake.teleop.panel import PanelLike

SLICE = 0.04
"""Simulated time between readings of the panel [s]: the longest delay of a click."""
SINGLE_STEP = 0.02
"""Simulated time of a single time step [s]."""
PAUSED_LOOK = 0.03
"""Wall time between readings of the panel while paused [s]."""
_OF_TIME = {Action.PAUSE, Action.SINGLE_STEP}


class Session:
    """One robot and one panel."""

    def __init__(
        self, sim: AtlasSimulation, panel: PanelLike, *, real_time: bool = True
    ) -> None:
        """Starts at the present state of the simulation.

        With ``real_time`` it simulates no faster than real time.
        """
        self._sim = sim
        self._panel = panel
        self._real_time = real_time
        self._commander = Commander(
            sim.robot,
            sim.atlas_sim_interface_state,
            sim.scenario.controller_config().gait(),
        )
        self._waiting: tuple[Button, ...] = ()
        self.paused = False

    def advance(self) -> None:
        """Reads the panel once, carries out its orders and simulates one slice.

        While paused nothing is simulated; buttons pressed then act when time continues.
        """
        begin = time.perf_counter()
        controls = self._panel.read()
        clicks = controls.clicks
        before = self.paused
        if Action.PAUSE in clicks:
            self.paused = not self.paused
        single = Action.SINGLE_STEP in clicks
        if single:
            self.paused = True
        if self.paused != before:
            self._panel.show_paused(self.paused)
        others = tuple(action for action in clicks if action not in _OF_TIME)
        self._waiting += others
        if self.paused and not single and Action.RESET not in others:
            time.sleep(PAUSED_LOOK)
            return
        span = SINGLE_STEP if self.paused else SLICE
        controls = replace(controls, clicks=self._waiting)
        self._waiting = ()
        self._command(controls, span)
        self._sim.advance(span)
        if self._real_time and not self.paused:
            # Lost time is not made up for: a robot that rushes is hard to steer.
            time.sleep(max(begin + span - time.perf_counter(), 0.0))

    def _command(self, controls: Controls, span: float) -> None:
        sim, panel = self._sim, self._panel
        report = sim.atlas_sim_interface_state
        orders = self._commander.look(controls, report, sim.atlas_state, span)
        if orders.reset:
            sim.reset()
            orders = self._commander.restart(sim.atlas_sim_interface_state)
        for message in (orders.atlas_command, orders.sim_command):
            if message is not None:
                sim.publish(message)
        if orders.push is not None:
            push = orders.push
            sim.apply_push(push.body, push.force_W, push.duration)
        for slider, value in orders.sliders.items():
            panel.set(slider, value)
        panel.show_joints(orders.joints)
