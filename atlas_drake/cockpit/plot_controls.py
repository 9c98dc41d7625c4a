"""Plots of a run: the columns of a log's row, sampled as the simulation goes on.

Nothing is computed while no plot is shown.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from atlas_drake.errors import InvalidMessageError, did_you_mean
from atlas_drake.logs.channels import Tick
from atlas_drake.logs.layout import Layout
from atlas_drake.logs.rows import RowMaker
from atlas_drake.robot import Robot

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

Sample = tuple[float, Mapping[str, float]]
"""Time [s], and numbers by the names of their columns."""
MOST_COLUMNS = 24
"""Number of columns that can be plotted at a time."""
MOST_SAMPLES = 500
"""Number of samples that are kept until a state takes them."""
UNPLOTTED = ("controller.tick_time",)
"""Columns that only a log of every control tick has."""


def column_units(layout: Layout) -> dict[str, str]:
    """Returns the unit of each column of a row, by name."""
    units = [channel.unit for channel in layout.channels for _ in range(channel.size)]
    return dict(zip(layout.columns(), units, strict=True))


def live_units(robot: Robot) -> dict[str, str]:
    """Returns the units of the columns that can be plotted during a run, by name."""
    units = column_units(RowMaker(robot).layout)
    return {name: unit for name, unit in units.items() if name not in UNPLOTTED}


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
        self._maker: RowMaker | None = None
        self._samples: deque[Sample] = deque(maxlen=MOST_SAMPLES)
        self._sampled = -1.0

    def choose(self, names: Sequence[str]) -> None:
        """Samples these columns from now on, such as ``balance.com.x``."""
        if self._maker is None:
            self._maker = RowMaker(self._sim.robot)
            self._places = {
                name: place for place, name in enumerate(self._maker.layout.columns())
            }
        self._chosen = check_columns(names, self._places)

    def update(self) -> None:
        """Takes a sample, if columns were chosen and time has gone on."""
        if self._maker is None or not self._chosen or self._sim.time == self._sampled:
            return
        self._sampled = self._sim.time
        (row,) = self._maker.rows(self._maker.sample(self._tick(self._maker))[None])
        numbers = {name: float(row[self._places[name]]) for name in self._chosen}
        self._samples.append((self._sampled, numbers))

    def take(self) -> tuple[Sample, ...]:
        """Returns the samples since the last call."""
        samples = tuple(self._samples)
        self._samples.clear()
        return samples

    def _tick(self, maker: RowMaker) -> Tick:
        sim = self._sim
        return Tick(
            sim.time,
            np.nan,
            {name: sim.output(name) for name in maker.port_sizes},
            sim.output("commands"),
            sim.output("controller_status"),
            sim.atlas_sim_interface_state,
            sim.imu,
        )
