"""What a view shows of a record, once for Meshcat and for videos.

``meshcat_view`` and ``video_display`` draw it.
"""

from __future__ import annotations

from typing import NamedTuple

from pydrake.systems.framework import Context, LeafSystem

from atlas_drake.frozen import replace
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.palette import Color
from atlas_drake.records import TickRecord
from atlas_drake.robot import Robot
from atlas_drake.systems.record_reader import RecordInputs
from atlas_drake.visualization.caption import caption_of, feedback_words
from atlas_drake.visualization.control_colors import joint_colors
from atlas_drake.visualization.footsteps import FootstepMark, footstep_marks
from atlas_drake.visualization.overlay_shapes import DRAWN, Shape, overlay_shapes
from atlas_drake.visualization.overlays import Overlays

PATHS = frozenset({"plan", "swing"})
"""The overlays that show planned paths."""


class Seen(NamedTuple):
    """What a view shows at an instant.

    Attributes:
        record: The record that is shown.
        title: Title of the caption.
        notes: Lines below the title.
        footsteps: Marks of footsteps.
        shapes: Shapes of the overlays, the lowest first.
        joint_colors: Colors of the joints' links; None leaves the links their own.
    """

    record: TickRecord
    title: str
    notes: list[str]
    footsteps: list[FootstepMark]
    shapes: list[Shape]
    joint_colors: list[Color] | None


def see(
    record: TickRecord, robot: Robot, catalog: BehaviorCatalog, overlays: Overlays
) -> Seen:
    """Returns what a view shows of a record."""
    title, note = caption_of(record, catalog)
    flags = [feedback_words(record)] if overlays.is_on("flags") else []
    joints = record.joints
    return Seen(
        record,
        title,
        [note, *flags],
        footstep_marks(record),
        overlay_shapes(_drawn(overlays), record),
        joint_colors(overlays, joints.k_effort, joints.effort, robot.effort_limit),
    )


def _drawn(overlays: Overlays) -> set[str]:
    return {name for name in DRAWN if overlays.is_on(name)}


class ViewInputs(RecordInputs):
    """The input ports of a view, which reads the costly parts only if they are shown.

    The paths that were read last belong to the view, as with Drake's own visualisers,
    and not to the Context.
    """

    def __init__(
        self, system: LeafSystem, overlays: Overlays, paths_every: int = 1
    ) -> None:
        """Declares the ports of ``system``.

        Args:
            system: The system that draws.
            overlays: Switches of the overlays.
            paths_every: Pictures between updates of the paths, which are slow to
                compute and change slowly.
        """
        super().__init__(system)
        self._overlays, self._paths_every = overlays, paths_every
        self._pictures = 0
        self._paths: PlannedPaths | None = None

    def shown(self, context: Context) -> TickRecord:
        """Returns the latest record with what the overlays show."""
        record, on = self.record(context), _drawn(self._overlays)
        if "forces" in on:
            record = self.with_contacts(record, context)
        if record.paths is not None or not on & PATHS:
            # A replay's record has its own paths.
            self._pictures = 0
            return record
        if self._pictures % self._paths_every == 0:
            self._paths = self.with_paths(record, context).paths
        self._pictures += 1
        return replace(record, paths=self._paths)
