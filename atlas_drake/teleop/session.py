"""A session at the panel: look, command, simulate a slice, keep to real time.

It owns nothing but the clock: what to command is the commander's business.
"""

from __future__ import annotations

import time

from atlas_drake.frozen import replace
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.teleop.commander import Commander
from atlas_drake.teleop.controls import Action, Button, Controls
from atlas_drake.teleop.panel import PanelLike

SLICE = 0.04
"""Simulated time between looks at the panel [s]: a click acts after at most that."""
SINGLE_STEP = 0.02
"""What a single time step simulates [s]."""
PAUSED_LOOK = 0.03
"""Between looks at the panel while time stands still [s of wall time]."""
_OF_TIME = {Action.PAUSE, Action.SINGLE_STEP}


class Session:
    """One robot and one panel."""

    def __init__(
        self, sim: AtlasSimulation, panel: PanelLike, *, real_time: bool = True
    ) -> None:
        """Begins where the simulation is.

        Args:
            sim: The robot.
            panel: Whoever steers.
            real_time: Simulate at most as fast as time passes.
        """
        self._sim = sim
        self._panel = panel
        self._real_time = real_time
        self._commander = Commander(sim.robot, sim.atlas_sim_interface_state)
        self._waiting: tuple[Button, ...] = ()
        self.paused = False

    def advance(self) -> None:
        """Looks at the panel once, does what it says and simulates one slice.

        While paused nothing is simulated; what is pressed then acts when time goes on.
        """
        begin = time.perf_counter()
        controls = self._panel.read()
        clicks = controls.clicks
        if Action.PAUSE in clicks:
            self.paused = not self.paused
        single = Action.SINGLE_STEP in clicks
        if single:
            self.paused = True
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
            # Lost time is not made up for: steering a robot that rushes is no fun.
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
