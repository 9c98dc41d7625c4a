"""The place and time of the next touchdown that keep the DCM plan feasible.

After Khadiv, Herzog, Moosavian, Righetti, "Walking control based on step timing
adaptation", T-RO 2020: in single support with the center of pressure r, the DCM of
touchdown is ξ_T = r + e^{ωT}(ξ - r), so that both the landing place and the time T
correct an error. They solve a quadratic program over place and e^{ωT}; here T is
searched, with the place that follows from each T.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from atlas_drake.config import Configuration, LeastGreatest, NotNegative, Positive
from atlas_drake.control.feet.footstep import saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.frozen import replace
from atlas_drake.messages.footstep import FootPose, Footstep
from atlas_drake.rotations import rotation_z
from atlas_drake.units import Meters, MetersPerSecond, Ratio, Seconds

_WAY = np.linspace(0.0, 1.0, 9)
"""Places on the way of a foot at which it must not be over the other one."""
_TIMES = 9
"""Times of touchdown that are compared: a resolution of some 20 ms."""


@dataclass(frozen=True)
class StepAdjustmentLimits(Configuration):
    """When a step is moved or hastened for balance, and how far.

    The ankles and double support correct the first part of a DCM error; ``StepLimits``
    with ``stretch``, and ``reach`` bound the place of the step.
    """

    cop_forward: NotNegative[Meters] = 0.10
    """Shift of the CoP that the stance foot can hold along the sole."""
    cop_sideways: NotNegative[Meters] = 0.049
    """Shift of the CoP that the stance foot can hold across the sole."""
    tolerated_forward: NotNegative[Meters] = 0.075
    """DCM error at touchdown that double support can correct, along the sole."""
    tolerated_sideways: NotNegative[Meters] = 0.03
    """DCM error at touchdown that double support can correct, across the sole."""
    stretch: NotNegative[Meters] = 0.30
    """Distance by which a step for balance may exceed the limits of commanded steps
    ahead, back and outward."""
    reach: Positive[Meters] = 0.95
    """Largest distance between the feet after a step for balance."""
    clearance: NotNegative[Meters] = 0.03
    """Least gap between the soles after a step for balance: a foot that lands a
    centimeter nearer must not stand on the other one, which steps next."""
    crossing: NotNegative[Meters] = 0.14
    """Distance beyond the line of the stance foot to which a foot may land ahead of it
    or behind it. A push over the stance foot, where the legs would have to pass through
    each other, is caught only so: with both feet on one line, or crossed, the next step
    leads from where the push has brought the robot."""
    shortest_swing: Positive[Seconds] = 0.20
    """Duration of the fastest swing that balance may demand. A swing that has begun
    slower takes the same share of it for the rest of its path."""
    foot_speed: Positive[MetersPerSecond] = 3.5
    """Largest mean horizontal speed of a foot in a hastened swing."""
    turn_lead: NotNegative[Seconds] = 0.25
    """Time ahead for which the turn of the pelvis is foreseen, at its present rate: a
    step for balance turns as far."""
    haste_cost: NotNegative[MetersPerSecond] = 0.3
    """Distance out of reach that is accepted for each second that the swing is not
    hastened. The faster the foot, the farther its leg throws the CMP from the CoP."""
    shift_cost: NotNegative[Ratio] = 0.2
    """Distance out of reach that is accepted for each meter by which the landing place
    is not shifted."""


def step_shift(
    dcm_error: np.ndarray,
    remaining: float,
    omega: float,
    sensitivity: float,
    stance: FootPose,
    limits: StepAdjustmentLimits,
) -> np.ndarray:
    """Computes the shift of the next footstep that keeps the DCM plan feasible [m].

    In single support the DCM error ξ - ξ_ref grows as e^{ωt}. A shift of the center of
    pressure within the stance sole corrects what it can until touchdown; a shift of the
    next footstep corrects the rest, by ``sensitivity`` [-].
    """
    c, s = math.cos(stance.yaw), math.sin(stance.yaw)
    x, y = dcm_error.tolist()
    growth = math.exp(omega * remaining)

    def along(error: float, ankle: float, tolerated: float) -> float:
        final = error * growth
        rest = abs(final) - ankle * (growth - 1.0) - tolerated
        return math.copysign(max(rest / sensitivity, 0.0), final)

    forward = along(c * x + s * y, limits.cop_forward, limits.tolerated_forward)
    sideways = along(c * y - s * x, limits.cop_sideways, limits.tolerated_sideways)
    return np.array([c * forward - s * sideways, s * forward + c * sideways])


@dataclass(frozen=True)
class SingleSupportState:
    """The pendulum on its stance foot, and the touchdown that is planned."""

    dcm: np.ndarray  # Measured DCM in W [m], shape (2,)
    planned_dcm: np.ndarray  # DCM of the plan now [m], shape (2,)
    cop: np.ndarray  # CoP of the plan, constant until touchdown [m], shape (2,)
    omega: float  # Natural frequency [1/s]
    remaining: float  # Time to the planned touchdown [s]
    sensitivity: float  # ∂(DCM planned for touchdown)/∂(landing place) [-]
    stance: FootPose  # The foot on the ground
    sole: tuple[float, float]  # Its length and width [m]

    def error(self, remaining: float) -> np.ndarray:
        """Computes ξ - ξ_ref now if touchdown comes after ``remaining`` [m], (2,).

        The DCM planned for touchdown stays the same, so that the reference now is
        the later, the sooner it is reached.
        """
        later = math.exp(self.omega * (self.remaining - remaining))
        return self.dcm - self.cop - later * (self.planned_dcm - self.cop)


def within_reach(step: Footstep, stance: FootPose, reach: float) -> Footstep:
    """Returns the step, not farther than ``reach`` [m] from the stance foot."""
    ahead = step.p_WF - stance.p_WF
    distance = float(np.hypot(*ahead[:2]))
    if distance <= reach:
        return step
    ahead[:2] *= reach / distance
    return replace(step, p_WF=stance.p_WF + ahead)


def place_for_balance(
    step: Footstep,
    state: SingleSupportState,
    foot: np.ndarray,
    adjustment: StepAdjustmentLimits,
    limits: StepLimits,
) -> Footstep:
    """Returns the nearest step that can be taken: beside the stance foot, or across it.

    Feet beside each other are as near as their soles allow. Ahead of the stance foot,
    or behind it, a foot may land on its line and beyond, if its straight way there from
    ``foot``, horizontal in W [m], does not lead over the stance foot.
    """
    stance, (length, width) = state.stance, state.sole
    narrowest, widest = limits.width
    narrow = width + adjustment.clearance
    beside = LeastGreatest(min(narrowest, narrow), widest)
    across = LeastGreatest(-adjustment.crossing, widest)
    R_WS = rotation_z(stance.yaw)
    forth = R_WS[:, 0]
    ahead = float(forth @ (step.p_WF - stance.p_WF))
    past = length + adjustment.clearance

    def within(width: LeastGreatest, x: float) -> Footstep:
        there = replace(step, p_WF=step.p_WF + (x - ahead) * forth)
        saturated = saturate(there, stance, replace(limits, width=width))
        return within_reach(saturated, stance, adjustment.reach)

    def is_clear(place: Footstep) -> bool:
        way = foot + _WAY[:, None] * (place.p_WF[:2] - foot)
        x, y = np.abs((way - stance.p_WF[:2]) @ R_WS[:2, :2]).T
        return bool(((x >= length) | (y >= width)).all())

    near = within(beside, ahead)
    places = [within(across, x) for x in (max(ahead, past), min(ahead, -past))]
    places = [near, *filter(is_clear, places)]
    return min(places, key=lambda one: _apart(one, step))


def _apart(one: Footstep, other: Footstep) -> float:
    return float(np.hypot(*(one.p_WF - other.p_WF)[:2]))


class Touchdown(NamedTuple):
    """A step that keeps the balance, and what it costs.

    Attributes:
        step: The step, moved.
        remaining: Time to the touchdown [s].
        cost: Distance out of reach, and what shift and haste cost [m].
    """

    step: Footstep
    remaining: float
    cost: float


def touchdown_for_balance(
    step: Footstep,
    state: SingleSupportState,
    progress: float,
    foot: np.ndarray,
    adjustment: StepAdjustmentLimits,
    limits: StepLimits,
) -> Touchdown:
    """Chooses place and time of a touchdown: the least cost of all times.

    ``foot`` is the horizontal reference of the foot in the air in W [m], ``progress``
    its share of the swing.
    """

    def after(remaining: float) -> Touchdown:
        shift = step_shift(
            state.error(remaining),
            remaining,
            state.omega,
            state.sensitivity,
            state.stance,
            adjustment,
        )
        hasty = adjustment.haste_cost * (state.remaining - remaining)
        if not shift.any():
            return Touchdown(step, remaining, hasty)
        desired = step.p_WF + np.append(shift, 0.0)
        wanted = replace(step, p_WF=desired)
        moved = place_for_balance(wanted, state, foot, adjustment, limits)
        missing = _apart(wanted, moved)
        far = adjustment.shift_cost * float(np.hypot(*shift))
        return Touchdown(moved, remaining, missing + far + hasty)

    planned = after(state.remaining)
    if planned.step is step:
        return planned
    left = (1.0 - progress) * adjustment.shortest_swing
    way = float(np.hypot(*(planned.step.p_WF[:2] - foot)))
    earliest = min(max(left, way / adjustment.foot_speed), state.remaining)
    sooner = np.linspace(state.remaining, earliest, _TIMES)[1:].tolist()
    return min((planned, *map(after, sooner)), key=lambda found: found.cost)
