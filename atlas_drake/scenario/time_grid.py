"""Physics step and control period whose multiples meet exactly.

Drake starts a physics step and a control tick together only if both times are the same
floating-point number; for a third of 2 ms and 2 ms this holds at two of three ticks.
The other ticks would come one rounding error too late, and act a physics step later.
"""

from fractions import Fraction

import numpy as np

_BITS = 53 - 22
"""Bits of a step with which its first 2**22 multiples are exact: more than an hour of
1 ms steps."""
NOMINAL_PERIOD = 0.009
"""Control period that is chosen for the user, up to rounding [s]."""


def nominal_period(physics_step: float) -> float:
    """Returns the multiple of ``physics_step`` nearest to ``NOMINAL_PERIOD`` [s]."""
    return round(max(round(NOMINAL_PERIOD / physics_step), 1) * physics_step, 12)


def is_multiple(control_period: float, physics_step: float) -> bool:
    """Returns True if the period is a whole number of steps, up to rounding, or 0."""
    steps = control_period / physics_step
    return control_period == 0.0 or (
        round(steps) >= 1 and (abs(steps - round(steps)) <= 1e-9 * steps)
    )


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
    # Each multiple is rounded once: equal numbers have equal multiples.
    if Fraction(control_period) == ratio * Fraction(physics_step):
        return physics_step, control_period
    mantissa, exponent = np.frexp(physics_step)
    step = float(np.ldexp(np.round(np.ldexp(mantissa, _BITS)), exponent - _BITS))
    return step, ratio * step
