"""Every control of the cockpit as a function, for the page, for scripts and for tests.

Controls command through the station's ports and the public functions of
``AtlasSimulation``, as any program does.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, cast

from atlas_drake.cockpit.clock_controls import ClockControls
from atlas_drake.cockpit.joint_controls import JointControls
from atlas_drake.cockpit.mode_controls import ModeControls
from atlas_drake.cockpit.next_run import NextRun
from atlas_drake.cockpit.orders import Order
from atlas_drake.cockpit.pelvis_controls import PelvisControls
from atlas_drake.cockpit.plot_controls import PlotControls
from atlas_drake.cockpit.push_controls import PushControls
from atlas_drake.cockpit.record import Recorded
from atlas_drake.cockpit.recording_controls import RecordingControls
from atlas_drake.cockpit.scenario_controls import ScenarioControls
from atlas_drake.cockpit.view_controls import ViewControls
from atlas_drake.cockpit.walk_controls import WalkControls
from atlas_drake.errors import InvalidMessageError
from atlas_drake.visualization.overlays import Overlays

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation


class Operator:
    """The controls over one simulation.

    Attributes:
        clock: Pause, pace, reset, back in time.
        modes: Behaviors.
        walk: Walking by direction or by plan.
        joints: Who has which joint, and where the user's joints go.
        pelvis: The pelvis in MANIPULATE.
        pushes: Pushes on links.
        view: Overlays of the 3D view.
        plots: What is plotted.
        recording: A recording of the 3D view.
        scenario: Settings, other scenarios, and what was done as one.

    Example:
        >>> operator = Operator(sim)
        >>> operator.walk.steer(forward=1.0)
        >>> sim.advance(3.0)  # With ``operator.update()`` in between.
    """

    def __init__(
        self,
        sim: AtlasSimulation,
        overlays: Overlays | None = None,
        next_run: NextRun | None = None,
        recording: RecordingControls | None = None,
    ) -> None:
        """Takes over a simulation in its present state.

        Args:
            sim: The simulation.
            overlays: Switches of the overlays of its 3D view.
            next_run: Takes the scenario that is to follow; None if none can.
            recording: Records its 3D view; None for a recording of its own.
        """
        self.next_run = next_run or NextRun()
        record = self._record = Recorded(sim)
        sim = cast("AtlasSimulation", record)
        self.clock = ClockControls(sim, self._begin)
        self.joints = JointControls(sim)
        self.walk = WalkControls(sim)
        self.pelvis = PelvisControls(sim)
        self.modes = ModeControls(sim, self.walk, self.joints, self.pelvis)
        self.pushes = PushControls(sim)
        self.view = ViewControls(overlays or Overlays())
        self.plots = PlotControls(sim)
        self.recording = recording or RecordingControls(sim.meshcat)
        self.scenario = ScenarioControls(sim, self.clock, record, self.next_run)
        self._seen = sim.time

    def _begin(self) -> None:
        """Forgets what went on before a reset."""
        self.walk.let_go()
        self.walk.drop_plan()
        self.joints.stay()
        self.pelvis.begin()

    def update(self, time: float) -> None:
        """Does what a control goes on to do: steps of a walk, motion of joints.

        Args:
            time: Simulated time [s].
        """
        dt = max(time - self._seen, 0.0)
        self._seen = time
        self.walk.update()
        self.joints.update(dt)
        self.plots.update()

    def do(self, order: Order) -> Any:
        """Carries an order out.

        Returns:
            What the control returns.

        Raises:
            InvalidMessageError: If there is no such control, or a value cannot be used.
            AtlasError: If the simulation refuses it.
        """
        return carry_out(order, vars(self), CONTROLS)


def carry_out(
    order: Order, groups: Mapping[str, object], known: Mapping[str, Collection[str]]
) -> Any:
    """Calls the control that an order names.

    Args:
        order: The order.
        groups: Objects whose methods are controls, by the name of their group.
        known: Names of the controls that may be used, by group.

    Raises:
        InvalidMessageError: If there is no such control, or a value cannot be used.
    """
    group, _, name = order.control.partition(".")
    if name not in known.get(group, ()):
        raise InvalidMessageError(
            "control", order.control, f"there is no control {order.control!r}"
        )
    try:
        return getattr(groups[group], name)(**order.values)
    except TypeError as error:
        raise InvalidMessageError(order.control, order.values, str(error)) from error


CONTROLS = {
    "clock": ("pause", "go_on", "toggle", "single_step", "pace", "reset", "back"),
    "modes": ("request", "stop"),
    "walk": (
        "steer",
        "stop",
        "set_gait",
        "plan_to",
        "move_step",
        "send_plan",
        "drop_plan",
    ),
    "joints": ("share", "move", "gains", "hold", "go_limp", "save_pose", "go_to_pose"),
    "pelvis": ("move",),
    "pushes": ("push",),
    "view": ("show",),
    "plots": ("choose",),
    "recording": ("start", "stop"),
    "scenario": ("check", "start", "written", "done"),
}
"""The controls that the page may use, by group."""
