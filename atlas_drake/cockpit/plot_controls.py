"""Plots of a run: numbers of its records, sampled as the simulation goes on.

Nothing is computed while no plot is shown.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from atlas_drake.errors import InvalidMessageError, did_you_mean
from atlas_drake.records.plain import flat_numbers, flat_units

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

Sample = tuple[float, Mapping[str, float]]
"""Time [s], and numbers by the names of their columns."""
MOST_COLUMNS = 24
"""Number of columns that can be plotted at a time."""
MOST_SAMPLES = 500
"""Number of samples that are kept until a state takes them."""


def check_columns(names: object, known: Mapping[str, object]) -> tuple[str, ...]:
    """Checks names of columns.

    Raises:
        InvalidMessageError: If one is unknown, or there are too many.
    """
    if isinstance(names, str) or not isinstance(names, Sequence):
        raise InvalidMessageError("names", names, "must be names of columns")
    if len(names) > MOST_COLUMNS:
        rule = f"at most {MOST_COLUMNS} can be plotted at a time"
        raise InvalidMessageError("names", len(names), rule)
    for name in names:
        if name not in known:
            hint = did_you_mean(str(name), known)
            raise InvalidMessageError("names", name, f"there is no such column.{hint}")
    return tuple(names)


class PlotControls:
    """Samples the columns that were chosen."""

    def __init__(self, sim: AtlasSimulation) -> None:
        """Samples nothing yet."""
        self._sim = sim
        self._chosen: tuple[str, ...] = ()
        self._samples: deque[Sample] = deque(maxlen=MOST_SAMPLES)
        self._sampled = -1.0

    def choose(self, names: Sequence[str]) -> None:
        """Samples these columns from now on, such as ``balance.com.x``."""
        known = flat_units(self._sim.schema, self._sim.record)
        self._chosen = check_columns(names, known)

    def update(self) -> None:
        """Takes a sample, if columns were chosen and time has gone on."""
        if not self._chosen:
            return
        record = self._sim.record
        if record.time != self._sampled:
            self._sampled = record.time
            numbers = flat_numbers(self._sim.schema, record, self._chosen)
            self._samples.append((record.time, numbers))

    def take(self) -> tuple[Sample, ...]:
        """Returns the samples since the last call."""
        samples = tuple(self._samples)
        self._samples.clear()
        return samples
