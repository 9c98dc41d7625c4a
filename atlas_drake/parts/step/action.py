"""The requested step of STEP, with all thresholds and defaults applied.

Converts the step action from messages and back. The reach of a foothold is checked when
the step begins.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorStepAction,
    AtlasBehaviorStepParams,
    AtlasBehaviorStepSpec,
    ToeOff,
    Vector3,
)
from atlas_drake.messages.footstep import (
    LEFT,
    RIGHT,
    FootPose,
    Footstep,
    StepAction,
    footstep_from,
)
from atlas_drake.planning.demo_steps import demo_steps
from atlas_drake.planning.footholds import Gait
from atlas_drake.rotations import mean_yaw
from atlas_drake.units import (
    Meters,
    MetersPerSecond,
    MetersPerSecondSquared,
    Radians,
    Seconds,
)


@dataclass(frozen=True)
class ActionValues(Configuration):
    """Values of a step action, usual or at their limits; see ``StepAction``."""

    step_duration: NotNegative[Seconds] = 0.7
    """Duration of single support."""
    sway_duration: NotNegative[Seconds] = 0.6
    """Duration of the weight shift before single support."""
    swing_height: NotNegative[Meters] = 0.02
    """Rise above the lift height while the foot moves across."""
    lift_height: NotNegative[Meters] = 0.06
    """Vertical lift above the higher of the two footholds."""
    knee_nominal: NotNegative[Radians] = 0.6
    """Angle of the standing knee; the usual one follows from the height of the center
    of mass."""
    max_body_accel: NotNegative[MetersPerSecondSquared] = 0.4
    """Largest acceleration of the body."""
    max_foot_vel: NotNegative[MetersPerSecond] = 0.5
    """Largest speed of the foot."""
    sway_end_dist: NotNegative[Meters] = 0.01
    """Distance from the end of the weight shift to the middle of the standing sole."""
    step_end_dist: NotNegative[Meters] = 0.0
    """Distance by which the body leans into the step as the foot comes down."""


@dataclass(frozen=True)
class ActionRules(Configuration):
    """Values of step actions, and which of a message count."""

    usual: ActionValues = field(default_factory=ActionValues)
    """Values that a message leaves open."""
    least: ActionValues = field(
        default_factory=lambda: ActionValues(
            step_duration=0.0,
            sway_duration=0.2,
            swing_height=0.1,
            lift_height=0.1,
            knee_nominal=0.3,
            max_body_accel=0.0,
            max_foot_vel=0.0,
            sway_end_dist=0.0,
        )
    )
    """A value below this is ignored, as are all others at 0 or below."""
    ignored_end_dist: NotNegative[Meters] = 0.05
    """End distances beyond this are ignored."""
    most: ActionValues = field(
        default_factory=lambda: ActionValues(
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
    )
    """Values to which those of a message are clamped; ± for the end distances."""


def resolve_action(
    sent: AtlasBehaviorStepAction, default: StepAction, rules: ActionRules
) -> StepAction:
    """Returns the message's values, with ``default`` where a rule ignores them."""
    bounded = {}
    for name, largest in vars(rules.most).items():
        value = getattr(sent, name)
        if name in ("sway_end_dist", "step_end_dist"):
            counts = abs(value) <= rules.ignored_end_dist
        else:
            counts = value > 0.0 and value >= getattr(rules.least, name)
        value = value if counts else getattr(default, name)
        bounded[name] = min(max(value, -largest), largest)
    return StepAction(**bounded, toe_off=ToeOff(sent.toe_off))


SIDE_BY_SIDE = 0.1
"""Feet closer than this along the heading count as side by side, in strides [-]."""


def desired_step(
    params: AtlasBehaviorStepParams,
    feet_z: tuple[float, float],
    default: StepAction,
    rules: ActionRules,
) -> Footstep | None:
    """Returns the step that a message requests; None if it requests none.

    ``feet_z`` are the heights of the soles in W [m].
    """
    if params.use_spec:
        desired = _from_spec(params.desired_step_spec, default, rules)
    else:
        desired = _from_data(params, feet_z, default, rules.most)
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
    near = SIDE_BY_SIDE * gait.stride
    behind = float(ahead @ (feet[1].p_WF[:2] - feet[0].p_WF[:2])) < -near
    steps = demo_steps(feet, index, RIGHT if behind else LEFT, gait)
    if not steps:
        return None
    return replace(
        steps[0],
        duration=default.step_duration,
        swing_height=default.lift_height + default.swing_height,
        action=default,
    )


def _from_spec(
    spec: AtlasBehaviorStepSpec, default: StepAction, rules: ActionRules
) -> Footstep | None:
    if spec.step_index == NO_STEP:
        return None
    action = resolve_action(spec.action, default, rules)
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
    params: AtlasBehaviorStepParams,
    feet_z: tuple[float, float],
    default: StepAction,
    most: ActionValues,
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
        step_duration=min(step.duration, most.step_duration),
        swing_height=min(max(arc, default.swing_height), most.swing_height),
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
