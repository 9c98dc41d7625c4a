"""The pelvis in MANIPULATE."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import (
    AtlasBehaviorPelvisServoParams,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.messages.checks import check_number

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

LARGEST = 3.0
"""Largest value of any coordinate [m] or [rad]; the behavior clamps what is asked."""


class PelvisControls:
    """Height, orientation and center of mass over the feet."""

    def __init__(self, sim: AtlasSimulation) -> None:
        """Asks for nothing yet."""
        self._sim = sim
        self._asked: dict[str, float] | None = None

    def begin(self) -> None:
        """Forgets what was asked for: MANIPULATE begins where the pelvis is."""
        self._asked = None

    def move(self, **coordinates: float) -> None:
        """Moves the pelvis; the coordinates that are left out stay as asked.

        Args:
            **coordinates: Fields of ``AtlasBehaviorPelvisServoParams`` [m], [rad].

        Raises:
            InvalidMessageError: If a value cannot be used, or another behavior acts.
        """
        report = self._sim.atlas_sim_interface_state
        if report.current_behavior != Behavior.MANIPULATE:
            name = self._sim.current_behavior.name
            raise InvalidMessageError("pelvis", name, "moves in MANIPULATE only")
        sensed = report.manipulate_feedback.clamped
        asked = self._asked or {name: getattr(sensed, name) for name in COORDINATES}
        for name, value in coordinates.items():
            if name not in COORDINATES:
                known = ", ".join(COORDINATES)
                raise InvalidMessageError(name, value, f"there are {known}")
            asked = {**asked, name: check_number(value, name, -LARGEST, LARGEST)}
        self._asked = asked
        command = AtlasSimInterfaceCommand(behavior=Behavior.MANIPULATE)
        command.manipulate_params.use_desired = True
        command.manipulate_params.desired = AtlasBehaviorPelvisServoParams(**asked)
        self._sim.publish(command)


COORDINATES = tuple(asdict(AtlasBehaviorPelvisServoParams()))
"""Names of the coordinates."""
