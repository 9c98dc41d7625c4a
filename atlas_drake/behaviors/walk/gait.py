"""The DCM plan of a walk, from the present phase to rest. Pure functions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.control.balance.dcm_plan import CopSegment, DcmPlan, Pendulum
from atlas_drake.control.feet.footstep import outward
from atlas_drake.control.feet.swing_foot import FootSwing, begin_swing, pushes_ahead
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.rotations import rotation_z
from atlas_drake.support_polygon import SupportPolygon


def stance_cop(
    feet: Sequence[FootPose], step: Footstep, config: WalkConfig
) -> np.ndarray:
    """Computes the CoP reference for single support during ``step`` [m], shape (2,).

    It lies near the middle of the stance sole, toward the other foot, and in a step up
    or down toward the toes; on a sole that carries in part only, as near as that part.
    """
    start, stance = feet[step.foot], feet[1 - step.foot]
    ground = float(stance.p_WF[2])
    below, beyond = ground - float(start.p_WF[2]), float(step.p_WF[2]) - ground
    up, down = max(below, beyond, 0.0), max(-below, -beyond, 0.0)
    ahead = max(config.cop_up * up, config.cop_down * down)
    R_WS = rotation_z(stance.yaw)[:2]
    # The step's side is that of the other foot.
    inward = outward(step.foot) * config.cop_inward
    cop = stance.p_WF[:2] + ahead * R_WS[:, 0] + inward * R_WS[:, 1]
    if stance.part is None:
        return cop
    part = stance.p_WF[:2] + stance.part @ stance.R_WF[:2, :2].T
    return SupportPolygon(part).clamp(cop)


def plan_walk(
    cop: np.ndarray,
    first_phase: float,
    feet: tuple[FootPose, FootPose],
    steps: Sequence[Footstep],
    in_air: FootSwing | None,
    config: WalkConfig,
    pendulum: Pendulum,
) -> DcmPlan:
    """Makes the DCM plan of the present phase, and through ``steps`` to rest.

    The plan is computed backward from rest, which determines the DCM at its beginning.
    The present phase, with the CoP at ``cop``, takes ``first_phase`` [s] from its
    beginning. With a foot ``in_air`` it is the swing of the first step, and the rest of
    it is the foot's. The swinging leg moves the CMP away from the CoP.
    """
    timing = config.timing
    segments: list[CopSegment] = []
    poses = list(feet)
    for number, step in enumerate(steps):
        target = stance_cop(poses, step, config)
        motion = in_air if number == 0 else None
        if motion is None:
            duration = timing.transfer(step.duration) if number else first_phase
            segments.append(CopSegment(duration, cop, target))
            motion = begin_swing(poses[step.foot], timing.swing(step.duration))
        elif (passed := first_phase - motion.remaining) > 0.0:
            segments.append(CopSegment(passed, target, target))
        stance = rotation_z(poses[1 - step.foot].yaw)[:2, :2]
        reaction = stance * pendulum.swing_inertia @ stance.T
        for duration, push in pushes_ahead(motion, step, config.swing):
            offset = None if push is None else push @ reaction
            segments.append(CopSegment(duration, target, target, offset))
        cop = target
        poses[step.foot] = step.pose
    middle = 0.5 * (poses[0].p_WF[:2] + poses[1].p_WF[:2])
    duration = timing.settle if steps else first_phase
    segments.append(CopSegment(duration, cop, middle))
    return DcmPlan(segments, pendulum.omega)


def landing_sensitivity(
    cop: np.ndarray,
    swing_time: float,
    feet: tuple[FootPose, FootPose],
    steps: Sequence[Footstep],
    config: WalkConfig,
    pendulum: Pendulum,
) -> float:
    """Computes ∂ξ(touchdown)/∂(landing place) of the swing, ahead [-].

    Sideways it differs by the legs' momentum, less than a thousandth. The following
    steps are held fixed, so that the plan is linear in the landing place, and any
    offset gives the same result.
    """
    first, *rest = steps
    moved = replace(first, p_WF=first.p_WF + np.array([1.0, 0.0, 0.0]))
    swing = begin_swing(feet[first.foot], swing_time)

    def dcm_at_touchdown(step: Footstep) -> float:
        coming = (step, *rest)
        plan = plan_walk(cop, swing_time, feet, coming, swing, config, pendulum)
        return float(plan.evaluate(swing_time).dcm[0])

    return dcm_at_touchdown(moved) - dcm_at_touchdown(first)


def begun_at(plan: DcmPlan, dcm: np.ndarray, support: SupportPolygon) -> DcmPlan:
    """Returns the plan with a first segment that begins at the present DCM.

    To accelerate a pendulum to one side, the CoP first moves to the other side, and
    then to the end of the plan's first segment. Without this segment, the feedback
    would cause the same motion with a jump of the CoP.
    """
    first, *rest = plan.segments
    half = 0.5 * first.duration

    def through(turning: np.ndarray) -> DcmPlan:
        there = CopSegment(half, first.start, turning)
        back = CopSegment(half, turning, first.end)
        return DcmPlan([there, back, *rest], plan.omega)

    # The DCM at the beginning is linear in the turning point of the CoP, with the same
    # gain on both axes.
    begin = through(first.start).evaluate(0.0).dcm
    gain = through(first.start + 1.0).evaluate(0.0).dcm - begin
    return through(support.clamp(first.start + (dcm - begin) / gain))
