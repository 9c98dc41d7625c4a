"""Draws the steps of a plan that is not sent yet into the 3D view."""

from __future__ import annotations

from pydrake.geometry import Meshcat

from atlas_drake.cockpit.walk_controls import WalkControls, marks_of
from atlas_drake.messages import AtlasBehaviorStepData
from atlas_drake.palette import FEET
from atlas_drake.robot import Robot
from atlas_drake.visualization.footsteps import (
    COMMANDED,
    FootstepMark,
    mark_triangles,
)
from atlas_drake.visualization.meshcat_shapes import draw_solid
from atlas_drake.visualization.solids import Solid

PATH = "/atlas_drake/planned"
MOST = 60
"""Number of steps that are drawn."""


class PlanMarks:
    """The footprints of a plan; each is drawn once and then moved."""

    def __init__(self, meshcat: Meshcat, robot: Robot) -> None:
        """Shows no plan."""
        self._meshcat = meshcat
        triangles = mark_triangles(COMMANDED, robot.file.sole)
        self._soles = [Solid(triangles, color) for color in FEET]
        self._shown: tuple[AtlasBehaviorStepData, ...] = ()
        self._feet: list[int] = []
        meshcat.Delete(PATH)

    def show(self, walk: WalkControls) -> None:
        """Shows the plan, at the height of the ground."""
        plan = walk.plan
        if plan is self._shown or (not plan and not self._shown):
            return
        self._shown, height = plan, walk.ground
        places = marks_of(self._shown)[:MOST]
        for number, (foot, x, y, yaw) in enumerate(places):
            path = f"{PATH}/{number}"
            mark = FootstepMark(COMMANDED, foot, x, y, yaw, height)
            if number >= len(self._feet) or self._feet[number] != foot:
                draw_solid(self._meshcat, path, self._soles[foot])
                self._feet[number : number + 1] = [foot]
            self._meshcat.SetTransform(path, mark.X_WF)
            self._meshcat.SetProperty(path, "visible", True)
        for number in range(len(places), len(self._feet)):
            self._meshcat.SetProperty(f"{PATH}/{number}", "visible", False)
