"""Physics step and control period whose multiples meet exactly.

Drake begins a physics step and a control tick together only where both fall on the very
same number; a third of 2 ms and 2 ms do so at two of three ticks. The others would come
one rounding error too late, and act a physics step later.
"""

import numpy as np

STEPS = 2**22
"""Number of steps whose ticks are guaranteed to meet: more than an hour of 1 ms."""
_BITS = 53 - 22
"""Of a step, such that all of its first ``STEPS`` multiples are exact."""


def on_common_grid(physics_step: float, control_period: float) -> tuple[float, float]:
    """Return the nearest pair whose multiples are the same floating-point numbers.

    Args:
        physics_step: [s]
        control_period: A whole multiple of it but for rounding [s].

    Returns:
        The same pair if it is one, as wherever the ratio is a power of two; else one
        that differs from it by less than 1e-9 of itself.
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
