"""The requested step of STEP, with all thresholds and defaults applied.

Converts the step action from messages and back. The reach of a foothold is checked when
the step begins.
"""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.behaviors.footsteps import footstep_from
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorStepAction,
    AtlasBehaviorStepParams,
    AtlasBehaviorStepSpec,
    ToeOff,
    Vector3,
)
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep, StepAction
from atlas_drake.planning.demo_steps import demo_steps
from atlas_drake.planning.footholds import Gait
from atlas_drake.rotations import mean_yaw

MIN_VALUES = {
    "sway_duration": 0.2,
    "swing_height": 0.1,
    "lift_height": 0.1,
    "knee_nominal": 0.3,
}
"""A value below this is ignored [s], [m], [m], [rad]; all others below or at 0 are."""
MAX_END_DISTANCE = 0.05
"""End distances beyond this are ignored [m]."""


MAX_ACTION = StepAction(
    step_duration=20.0,
    sway_duration=20.0,
    swing_height=0.20,
    lift_height=0.25,
    knee_nominal=1.0,
    max_body_accel=1.0,
    max_foot_vel=1.0,
    sway_end_dist=0.03,
    step_end_dist=0.03,
)
"""Largest values of a step action, to which requests are clamped; ± for the end
distances."""


def resolve_action(sent: AtlasBehaviorStepAction, default: StepAction) -> StepAction:
    """Returns the message's values, with ``default`` where a threshold ignores them."""
    bounded = {}
    for name, largest in vars(MAX_ACTION).items():
        if name == "toe_off":
            continue
        value = getattr(sent, name)
        if name in ("sway_end_dist", "step_end_dist"):
            counts = abs(value) <= MAX_END_DISTANCE
        else:
            counts = value > 0.0 and value >= MIN_VALUES.get(name, 0.0)
        value = value if counts else getattr(default, name)
        bounded[name] = min(max(value, -largest), largest)
    return StepAction(**bounded, toe_off=ToeOff(sent.toe_off))


SIDE_BY_SIDE = 0.02
"""Feet closer than this along the heading count as side by side [m]."""


def desired_step(
    params: AtlasBehaviorStepParams, feet_z: tuple[float, float], default: StepAction
) -> Footstep | None:
    """Returns the step that a message requests; None if it requests none.

    ``feet_z`` are the heights of the soles in W [m].
    """
    if params.use_spec:
        desired = _from_spec(params.desired_step_spec, default)
    else:
        desired = _from_data(params, feet_z, default)
    if desired is not None and params.use_relative_step_height:
        rise = np.array([0.0, 0.0, feet_z[1 - desired.foot]])
        desired = replace(desired, p_WF=desired.p_WF + rise)
    return desired


def demo_step(
    feet: tuple[FootPose, FootPose], index: int, default: StepAction, gait: Gait
) -> Footstep | None:
    """Returns a step ahead with the rear foot; None after the demo's last step."""
    yaw = mean_yaw(feet[0].yaw, feet[1].yaw)
    ahead = np.array([math.cos(yaw), math.sin(yaw)])
    behind = float(ahead @ (feet[1].p_WF[:2] - feet[0].p_WF[:2])) < -SIDE_BY_SIDE
    steps = demo_steps(feet, index, RIGHT if behind else LEFT, gait)
    if not steps:
        return None
    return replace(
        steps[0],
        duration=default.step_duration,
        swing_height=default.lift_height + default.swing_height,
        action=default,
    )


def _from_spec(spec: AtlasBehaviorStepSpec, default: StepAction) -> Footstep | None:
    if spec.step_index == NO_STEP:
        return None
    action = resolve_action(spec.action, default)
    normal = spec.foot.normal.to_array()
    return Footstep(
        index=int(spec.step_index),
        foot=int(spec.foot_index),
        p_WF=spec.foot.position.to_array(),
        yaw=float(spec.foot.yaw),
        duration=action.step_duration,
        swing_height=action.lift_height + action.swing_height,
        normal=normal / np.linalg.norm(normal),
        action=action,
    )


def _from_data(
    params: AtlasBehaviorStepParams, feet_z: tuple[float, float], default: StepAction
) -> Footstep | None:
    """Reads the short form, whose apex counts from the midpoint between the feet."""
    data = params.desired_step
    if data.step_index == NO_STEP:
        return None
    step = footstep_from(data)
    landing_z = float(step.p_WF[2])
    if params.use_relative_step_height:
        landing_z += feet_z[1 - step.foot]
    rise = 0.5 * abs(landing_z - feet_z[step.foot])
    arc = step.swing_height - rise - default.lift_height
    action = replace(
        default,
        step_duration=min(step.duration, MAX_ACTION.step_duration),
        swing_height=min(max(arc, default.swing_height), MAX_ACTION.swing_height),
    )
    return replace(step, action=action)


def step_spec_from(step: Footstep) -> AtlasBehaviorStepSpec:
    """Converts an executed step to its message."""
    spec = AtlasBehaviorStepSpec()
    spec.step_index = step.index
    spec.foot_index = step.foot
    spec.foot.position = Vector3.from_array(step.p_WF)
    spec.foot.yaw = float(step.yaw)
    spec.foot.normal = Vector3.from_array(step.normal)
    for name, value in vars(step.action).items():
        setattr(spec.action, name, value)
    return spec
