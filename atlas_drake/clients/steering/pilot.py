"""What steers a robot by hand: one object for a page, a gamepad or a script.

It makes messages from what people want, and publishes them; it knows the robot by its
reports alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from atlas_drake.clients.steering.joint_motion import (
    SHOWN_WITHIN,
    JointFacts,
    JointMotion,
)
from atlas_drake.clients.steering.reports import Publish, Reports
from atlas_drake.clients.steering.walker import Walker
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.messages.footstep import LEFT
from atlas_drake.planning.footholds import Gait, foothold, step_data, step_from

_USERS = (Behavior.USER, Behavior.NONE)


if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation


class Pilot(Walker, JointMotion):
    """Walks, moves joints, and asks for behaviors with what people expect of them.

    ``see`` needs the latest reports, ten times a second at least. ``update`` does what
    goes on by itself. ``pilot_of`` makes one that a simulation calls.

    Example:
        >>> pilot = pilot_of(sim)
        >>> pilot.walk(forward=1.0)
        >>> sim.advance(3.0)
        >>> pilot.stop()
    """

    def __init__(
        self, joints: JointFacts, gait: Gait, publish: Publish, reports: Reports
    ) -> None:
        """Begins without a walk.

        Args:
            joints: Of the robot.
            gait: Its usual gait: ``controller_config().gait()`` of the scenario.
            publish: Sends a message to the robot.
            reports: Of the robot as it is now.
        """
        # A behavior that does not show yet, and the reports in which it has to.
        self._asked: int | str | None = None
        self._asked_for = 0

        def send(command: AtlasCommand | AtlasSimInterfaceCommand) -> None:
            if isinstance(command, AtlasSimInterfaceCommand):
                self._asked, self._asked_for = command.behavior, SHOWN_WITHIN
            publish(command)

        Walker.__init__(self, gait, send, reports.behavior)
        JointMotion.__init__(self, joints, send, reports.command, reports.position)
        self._step_foot = LEFT
        self._shares_before_user: np.ndarray | None = None

    def see(self, reports: Reports, *, jumped: bool = False) -> None:
        """Takes the latest reports.

        Args:
            reports: Of the robot.
            jumped: True if the robot was reset, or time went back: what went on until
                then is forgotten.
        """
        if jumped:
            self.forget_walk()
            self.drop_plan()
            self.forget_joints()
            self._shares_before_user = self._asked = None
        self.see_report(reports.behavior)
        self.see_joints(reports.command, reports.position)
        self._asked_for -= 1
        if reports.behavior.desired_behavior == self._asked or self._asked_for <= 0:
            self._asked = None

    def update(self, dt: float) -> None:
        """Sends the steps of a walk if it is time, and moves set-points on.

        Args:
            dt: Simulated time since the last call [s].
        """
        self.walk_on()
        self.move_on(dt)

    def behave(self, name: Behavior | str) -> None:
        """Asks for a behavior, with what people expect to go with it.

        WALK begins on the spot, STEP takes one step ahead, USER takes all joints as
        they are, and the next behavior gives back what the user had before.

        Args:
            name: Name of the behavior, in any case.
        """
        behavior = _behavior(name)
        self._give_back(behavior)
        if behavior == Behavior.WALK:
            self.walk()
            return
        self.forget_walk()
        command = AtlasSimInterfaceCommand(behavior=behavior)
        if behavior == Behavior.STEP:
            self._fill_step(command)
        self._publish(command)

    def stop(self) -> None:
        """Comes to rest: a walk ends with its next step, all else becomes STAND.

        STAND gets the legs, whoever has them: it cannot balance without. Arms, trunk
        and neck stay whose they are.
        """
        if self.walks:
            self.stop_walking()
            return
        self.behave(Behavior.STAND)
        legs = self._joints.legs
        if self.shares[legs].any():
            self.set_shares(np.where(legs, 0, self.shares))

    def _fill_step(self, command: AtlasSimInterfaceCommand) -> None:
        """Requests one step ahead, with alternating feet."""
        report, gait, foot = self._report, self._gait, self._step_foot
        active = report.current_behavior == Behavior.STEP
        index = report.step_feedback.next_step_index_needed if active else 1
        stance = foothold(report.foot_pos_est[1 - foot])
        place = step_from(stance, foot, gait, gait.stride, 0.0, 0.0)
        command.step_params.desired_step = step_data(index, foot, place, gait)
        command.step_params.use_relative_step_height = True
        self._step_foot = 1 - foot

    def _give_back(self, behavior: Behavior | str) -> None:
        """Gives USER all joints as they are, and the next behavior its joints back."""
        asked = self._asked
        present = self._report.desired_behavior if asked is None else asked
        nothing = np.zeros(len(self.shares))
        if behavior == Behavior.USER and present not in _USERS:
            self._shares_before_user = self.shares
            self.set_shares(nothing + K_EFFORT_MAX)
        elif present in _USERS and behavior not in _USERS:
            before, self._shares_before_user = self._shares_before_user, None
            self.set_shares(nothing if before is None else before)


def _behavior(name: Behavior | str) -> Behavior | str:
    """Returns one of the original interface; a user's own one stays a name."""
    if isinstance(name, Behavior):
        return name
    plain = name.strip().upper().replace("-", "_").replace(" ", "_")
    return Behavior.__members__.get(plain, plain)


def pilot_of(sim: AtlasSimulation) -> Pilot:
    """Returns a pilot of a simulation, which calls it from now on.

    Args:
        sim: The simulation; one of its ``hooks`` updates the pilot.
    """
    gait = sim.scenario.controller_config().gait()
    pilot = Pilot(JointFacts.of(sim.robot), gait, sim.publish, reports_of(sim))
    time, beginning = sim.time, sim.beginning

    def attend(sim: AtlasSimulation) -> None:
        nonlocal time, beginning
        passed = sim.time - time
        jumped = passed < 0.0 or sim.beginning is not beginning
        time, beginning = sim.time, sim.beginning
        pilot.see(reports_of(sim), jumped=jumped)
        pilot.update(passed)

    sim.hooks.append(attend)
    return pilot


def reports_of(sim: AtlasSimulation) -> Reports:
    """Returns what a pilot sees of a simulation."""
    return Reports(
        sim.atlas_sim_interface_state,
        sim.output("commands").joints,
        np.array(sim.atlas_state.position),
    )
