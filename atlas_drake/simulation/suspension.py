"""The harness of a scenario: when it holds the robot, and when it lets the robot down.

The forces of the harness are in ``systems.harness``.
"""

from __future__ import annotations

from typing import Any

from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, Diagram

from atlas_drake.errors import ScenarioError
from atlas_drake.scenario import Start

CLEARANCE = 0.10
"""Height of a harnessed robot's feet above the ground [m]."""


class Suspension:
    """The harness in a station; without one, every method but ``release`` is empty.

    Attributes:
        release_time: Simulated time at which the robot is to be let down [s]; None if
            no time is set.
    """

    def __init__(self, station: Diagram, harnessed: bool):
        """Takes a station, and whether its scenario has a harness."""
        self._harness: Any = None
        if harnessed:
            self._harness = station.GetSubsystemByName("harness")
        self.release_time: float | None = None

    def update(self, root: Context, start: Start, X_WP: RigidTransform) -> None:
        """Holds a robot that begins in the harness, and lets go of any other.

        Args:
            root: Context of the whole diagram.
            start: How the run begins.
            X_WP: Pose of the pelvis at which the robot is held.
        """
        self.release_time = None
        if self._harness is None:
            return
        context = self._harness.GetMyMutableContextFromRoot(root)
        if not start.harnessed:
            self._harness.let_go(context)
            return
        R_WP = X_WP.rotation().matrix()
        self._harness.hold(context, X_WP.translation(), R_WP, CLEARANCE)
        if start.release_time is not None:
            self.release_time = root.get_time() + start.release_time

    def is_due(self, time: float) -> bool:
        """Returns True if the robot is to be let down at ``time`` [s]."""
        return self.release_time is not None and self.release_time <= time + 1e-9

    def release(self, root: Context) -> None:
        """Lets the robot down to the ground, and then go.

        Raises:
            ScenarioError: If the scenario has no harness.
        """
        if self._harness is None:
            raise ScenarioError(
                "start.harnessed", False, "there is no harness to release"
            )
        self._harness.release(self._harness.GetMyMutableContextFromRoot(root))
        self.release_time = None
