"""What the phases of WALK and STEP share.

The state of such a behavior is one of its phases: a frozen dataclass with data, a
decision, and commands of the feet.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.base import Observation
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.messages.controller_status import Plan
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.support_polygon import SupportPolygon

TIME_STEP = 0.04
"""Time between two points of a planned path [s]."""


@dataclass(frozen=True, kw_only=True)
class Phase:
    """Common part of all phases."""

    support: SupportPolygon  # Region of the CoP
    elapsed: float = 0.0  # Time since the beginning of the phase [s]

    def plan_of(
        self, reference: DcmReference, omega: float, steps: tuple[Footstep, ...]
    ) -> Plan:
        """Returns the plan for viewers and logs."""
        return Plan(
            support=self.support.vertices,
            omega=omega,
            dcm_reference=reference.dcm,
            cop_reference=reference.cop,
            footsteps=steps,
        )


def on_present_parts(
    feet: tuple[FootPose, FootPose], observation: Observation
) -> tuple[FootPose, FootPose]:
    """Returns the feet with the parts that carry now: the same feet if none changed.

    A foot of which another part carries has its present pose: it may have turned.
    """
    left, right = (
        pose
        if pose.part is observation.footholds[foot].part
        else observation.foot_pose(foot)
        for foot, pose in enumerate(feet)
    )
    return feet if left is feet[0] and right is feet[1] else (left, right)


def with_foot(
    feet: tuple[FootPose, FootPose], foot: int, pose: FootPose
) -> tuple[FootPose, FootPose]:
    """Returns the feet with another pose of one foot."""
    return (pose, feet[1]) if foot == 0 else (feet[0], pose)


def set_down(
    feet: tuple[FootPose, FootPose], airborne: int | None
) -> tuple[FootPose, FootPose]:
    """Returns the feet with the one in the air on the ground of the other one."""
    if airborne is None:
        return feet
    above, stance = feet[airborne], feet[1 - airborne]
    p_WF = np.append(above.p_WF[:2], stance.p_WF[2])
    return with_foot(feet, airborne, FootPose(p_WF, stance.R_WF))


def sampled(
    evaluate: Callable[[float], DcmReference], times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Samples the paths of DCM and CoP in W [m], each of shape (k, 2)."""
    references = [evaluate(time) for time in times]
    return (
        np.array([reference.dcm for reference in references]),
        np.array([reference.cop for reference in references]),
    )
