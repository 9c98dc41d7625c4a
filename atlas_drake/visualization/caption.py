"""A caption of what the robot is doing, fixed to the picture like a subtitle.

The text is drawn in front of the camera, so it faces the viewer from everywhere, and
appears in recordings, which a label beside the 3D view would not.
"""

from __future__ import annotations

from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat, Rgba
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context, LeafSystem

from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
    WalkStatus,
)
from atlas_drake.visualization.marks import Marks
from atlas_drake.visualization.stroke_font import text_segments

CAMERA = "/Cameras/default/rotated/<object>"
"""Path of Meshcat's camera; what hangs below it moves with the view."""
DISTANCE = 1.0
"""Of the text from the camera [m]."""
TITLE_HEIGHT, NOTE_HEIGHT = 0.055, 0.024
"""Of the letters [m]; at DISTANCE the picture is 1.53 m high."""
TITLE_Y, NOTE_Y = 0.62, 0.56
"""Of the baselines, above the middle of the picture [m]."""
TITLE_WIDTH, NOTE_WIDTH = 4.0, 2.0
"""Of the strokes [pixel]."""
COLOR = Rgba(0.13, 0.17, 0.22, 1.0)


def caption_of(report: AtlasSimInterfaceState) -> tuple[str, str]:
    """Title and note about what the robot is doing."""
    shares = list(report.k_effort)
    users = sum(share >= K_EFFORT_MAX for share in shares)
    blended = sum(0 < share < K_EFFORT_MAX for share in shares)
    behavior = Behavior(report.current_behavior)
    note = f"{users} of {len(shares)} joints under user control"
    if users == 0:
        note = "all joints under behavior control"
    if blended:
        note = f"{note}, {blended} shared"
    if report.behavior_feedback.status_flags & BehaviorStatus.ERROR_FALLING:
        return "falling", note
    if users == len(shares) or behavior in (Behavior.USER, Behavior.NONE):
        return "user", "all joints under user control"
    title = behavior.name.replace("_", " ")
    if behavior is Behavior.WALK:
        walk = report.walk_feedback
        if walk.status_flags & WalkStatus.SUBSTATE_STEPPING:
            title = f"{title} - step {max(walk.current_step_index, 1)}"
    return title, note


class CaptionDisplay(LeafSystem):
    """Keeps the caption up to date.

    Input ports:
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
    """

    def __init__(self, meshcat: Meshcat, period: float) -> None:
        """Looks every ``period`` [s]."""
        super().__init__()
        self._meshcat = meshcat
        self._report = self.DeclareAbstractInputPort(
            "atlas_sim_interface_state", AbstractValue.Make(AtlasSimInterfaceState())
        )
        self._marks = Marks(meshcat, f"{CAMERA}/caption", self._draw)
        self.DeclarePeriodicPublishEvent(period, 0.0, self._publish)

    def _publish(self, context: Context) -> None:
        title, note = caption_of(self._report.Eval(context))
        marks = [
            (title, TITLE_HEIGHT, TITLE_Y, TITLE_WIDTH),
            (note, NOTE_HEIGHT, NOTE_Y, NOTE_WIDTH),
        ]
        self._marks.show(marks, context.get_time())

    def _draw(self, path: str, mark: object) -> None:
        text, height, y, width = mark  # type: ignore[misc]
        starts, ends = text_segments(text, height)
        self._meshcat.SetLineSegments(path, starts, ends, width, COLOR)
        self._meshcat.SetTransform(path, RigidTransform([0.0, y, -DISTANCE]))
