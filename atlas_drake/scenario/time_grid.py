"""Physics step and control period whose multiples meet exactly.

Drake starts a physics step and a control tick together only if both times are the same
floating-point number; for a third of 2 ms and 2 ms this holds at two of three ticks.
The other ticks would come one rounding error too late, and act a physics step later.
"""

import numpy as np

STEPS = 2**22
"""Number of steps whose ticks coincide exactly: more than an hour of 1 ms steps."""
_BITS = 53 - 22
"""Bits of a step with which all of its first ``STEPS`` multiples are exact."""


def on_common_grid(physics_step: float, control_period: float) -> tuple[float, float]:
    """Return the nearest pair whose multiples are the same floating-point numbers.

    Args:
        physics_step: Step of plant and joint controllers [s].
        control_period: A whole multiple of ``physics_step`` up to rounding [s].

    Returns:
        The same pair if its multiples coincide, as for every ratio that is a power of
        two; otherwise a pair that differs from it by a relative error below 1e-9.
    """
    ratio = round(control_period / physics_step)
    doubled = ratio.bit_count() == 1  # A power of two: doubling is exact.
    if doubled and ratio * physics_step == control_period:
        return physics_step, control_period
    ticks = np.arange(1, STEPS // ratio, dtype=float)
    if (ticks * control_period == ticks * ratio * physics_step).all():
        return physics_step, control_period
    mantissa, exponent = np.frexp(physics_step)
    step = float(np.ldexp(np.round(np.ldexp(mantissa, _BITS)), exponent - _BITS))
    return step, ratio * step
