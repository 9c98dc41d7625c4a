"""What a walk costs: energy, knees and torques, without its first and last steps.

``gait.yaml`` repeats it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake import AtlasSimulation
from atlas_drake.messages.event import FOOTSTEP
from atlas_drake.records import TickRecord
from atlas_drake.robot import Robot
from atlas_drake.units import GRAVITY

SKIPPED = 3
"""Steps at both ends of the walk that do not count."""
STANDS = 0.2
"""Load from which a knee counts as that of a stance leg [weights of the robot]."""


@dataclass(frozen=True)
class Sums:
    """Sums since the start, and the CoM, at a touchdown."""

    work: float  # Positive work of the motors [J]
    knees: float  # Sum of the knee joints' angles over the ticks of stance legs [rad]
    ticks: int  # Number of these angles
    com: np.ndarray  # Horizontal, in W [m]


class WalkingEffort:
    """Energy per metre, mean stance knee, and peak torques of knees and ankles."""

    def __init__(self, robot: Robot) -> None:
        """Measures ``robot``."""
        legs = robot.legs
        self._knees = [leg.knee for leg in legs]
        self._least = STANDS * robot.mass * GRAVITY
        self._joints = {
            "knee": self._knees,
            "ankle_pitch": [leg.ankle_pitch for leg in legs],
            "ankle_roll": [leg.ankle_roll for leg in legs],
        }
        self._now = Sums(0.0, 0.0, 0, np.zeros(2))
        self._landed: list[Sums] = []
        self._time = 0.0

    def update(self, record: TickRecord) -> None:
        """Adds a record to the sums."""
        joints, now = record.joints, self._now
        power = joints.effort * joints.velocity
        bent = np.abs(joints.position[self._knees])
        stands = np.array(record.feet.loads) > self._least
        self._now = Sums(
            now.work + float(power[power > 0.0].sum()) * (record.time - self._time),
            now.knees + float(bent[stands].sum()),
            now.ticks + int(stands.sum()),
            record.balance.com[:2],
        )
        self._time = record.time
        if any(event.kind == FOOTSTEP for event in record.events):
            self._landed.append(self._now)

    def result(self, sim: AtlasSimulation) -> dict[str, Any]:
        """Returns the figures; none of a walk that was too short."""
        if len(self._landed) < 2 * SKIPPED + 1:
            return {}
        first, last = self._landed[SKIPPED - 1], self._landed[-SKIPPED]
        way = float(np.hypot(*(last.com - first.com)))
        share = sim.output("peaks")
        return {
            "energy_j_per_m": (last.work - first.work) / way,
            "stance_knee_deg": float(
                np.degrees((last.knees - first.knees) / (last.ticks - first.ticks))
            ),
            **{
                f"{name}_peak_share": float(share[places].max())
                for name, places in self._joints.items()
            },
        }
