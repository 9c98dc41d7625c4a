"""What a client sees of a robot, and its way to command it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
)
from atlas_drake.messages.joint_command import JointCommand

Publish = Callable[[AtlasCommand | AtlasSimInterfaceCommand], object]
"""Sends a message to the robot."""


class Reports(NamedTuple):
    """The latest reports of a robot.

    Attributes:
        behavior: Of the behaviors.
        command: Joint commands in force.
        position: Measured positions of the joints [rad], shape (n,).
    """

    behavior: AtlasSimInterfaceState
    command: JointCommand
    position: np.ndarray
