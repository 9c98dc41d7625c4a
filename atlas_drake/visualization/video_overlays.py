"""Overlays of a video: drawn onto its pictures, so that nothing hides them.

The same overlays as in the 3D view, whose files compute what is shown.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform

from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.palette import COM, COP, DCM, FORCE, SUPPORT, SWING, Color
from atlas_drake.robot import Robot
from atlas_drake.visualization.balance_marks import BALL, DISC, balance_points
from atlas_drake.visualization.contact_forces import SCALE, ContactForce
from atlas_drake.visualization.control_colors import effort_colors, owner_colors
from atlas_drake.visualization.overlays import OVERLAYS, Overlays
from atlas_drake.visualization.video_stage import Picture, VideoStage

FINER = 3
"""Pixels of the drawing per pixel of the picture, which smooths the edges."""
LINE, THIN = 0.007, 0.003
"""Width of paths and arrows, and of the plumb line, as shares of the height."""
HEAD = 0.02
"""Length of an arrow's head as a share of the height."""
SEEN_THROUGH = 0.5
"""Opacity of the support polygon."""
ROUND = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
"""Angles of the corners of a disc [rad]."""
DARKEST, BRIGHTEST = 0.35, 1.25
"""Brightness of a colored link where the picture is black, and where it is white."""


class Seen(NamedTuple):
    """What the overlays show.

    Attributes:
        state: State of the robot.
        plan: Plan of the controller.
        paths: Its planned paths; blank if no overlay shows them.
        foot_wrenches: Contact wrenches on both soles, see ``RobotSensors``.
        forces: Contact forces on the robot; none in a replay.
        k_effort: User's share per joint, 0 to 255, shape (n,).
        effort: Efforts of the motors [N·m], shape (n,).
    """

    state: NDArray[np.float64]
    plan: Plan
    paths: PlannedPaths
    foot_wrenches: NDArray[np.float64]
    forces: Sequence[ContactForce]
    k_effort: NDArray[np.float64]
    effort: NDArray[np.float64]


class VideoOverlays:
    """Draws the overlays that are switched on."""

    def __init__(self, robot: Robot, overlays: Overlays, stage: VideoStage) -> None:
        """Takes the robot, the switches, and the stage of the pictures."""
        self._robot = robot
        self._overlays = overlays
        self._stage = stage
        self._model = WholeBodyModel(robot)
        self._scratch = self._model.create_context()
        self._moved = [stage.bodies(links) for links in robot.moved_links]

    def onto(self, picture: Picture, seen: Seen, X_WC: RigidTransform) -> Picture:
        """Returns the stage's last picture with the overlays; the camera is at X_WC."""
        from PIL import Image, ImageDraw

        on = {name for name in OVERLAYS if self._overlays.is_on(name)}
        if "owner" in on:
            picture = self._colored(picture, owner_colors(seen.k_effort), X_WC)
        elif "effort" in on:
            colors = effort_colors(seen.effort, self._robot.effort_limit)
            picture = self._colored(picture, colors, X_WC)
        if not on & {"com", "dcm", "cop", "support", "plan", "swing", "forces"}:
            return picture
        height, width = picture.shape[:2]
        layer = Image.new("RGBA", (FINER * width, FINER * height))
        pencil = _Pencil(ImageDraw.Draw(layer), self._stage, X_WC, FINER * height)
        self._draw(pencil, on, seen)
        layer = layer.resize((width, height), Image.Resampling.BOX)
        below = Image.fromarray(picture).convert("RGBA")
        return np.array(Image.alpha_composite(below, layer).convert("RGB"))

    def _draw(self, pencil: _Pencil, on: set[str], seen: Seen) -> None:
        """Draws from the ground up: areas, lines, points."""
        terms = self._model.evaluate(self._scratch, seen.state)
        points = balance_points(terms, seen.foot_wrenches)
        plan, paths, ground = seen.plan, seen.paths, points.ground
        if "support" in on and plan.support is not None:
            pencil.area(_at(plan.support, ground), SUPPORT, SEEN_THROUGH)
        if "plan" in on:
            for path, color in ((paths.com, COM), (paths.dcm, DCM)):
                if path is not None:
                    pencil.line(_at(path, ground), color)
        if "swing" in on and paths.swing is not None:
            pencil.line(paths.swing, SWING)
        if "com" in on:
            foot = np.array([*points.com[:2], ground])
            pencil.line(np.array([foot, points.com]), COM, THIN)
            pencil.disc(foot, DISC["com"], COM)
            pencil.ball(points.com, BALL, COM)
        if "dcm" in on:
            pencil.disc(points.dcm, DISC["dcm"], DCM)
        if "cop" in on and points.cop is not None:
            pencil.disc(points.cop, DISC["cop"], COP)
        if "forces" in on:
            for force in seen.forces:
                pencil.arrow(force, FORCE)

    def _colored(
        self, picture: Picture, colors: list[Color], X_WC: RigidTransform
    ) -> Picture:
        """Colors the links in their own light and shade."""
        table = np.zeros((np.iinfo(np.int16).max + 1, 3))
        for bodies, color in zip(self._moved, colors, strict=True):
            table[bodies] = color
        wanted = table[self._stage.links(X_WC)]
        grey = picture.mean(axis=2, keepdims=True) / 255.0
        lit = 255.0 * wanted * (DARKEST + (BRIGHTEST - DARKEST) * grey)
        is_link = wanted.any(axis=2, keepdims=True)
        return np.where(is_link, np.clip(lit, 0.0, 255.0), picture).astype(np.uint8)


class _Pencil:
    """Draws shapes of the world onto a layer of the picture."""

    def __init__(
        self, draw: Any, stage: VideoStage, X_WC: RigidTransform, height: int
    ) -> None:
        """Draws with Pillow on a layer of this height [pixel]."""
        self._draw = draw
        self._stage = stage
        self._X_WC = X_WC
        self._height = height

    def area(
        self, points: NDArray[np.float64], color: Color, opacity: float = 1.0
    ) -> None:
        """Fills a polygon."""
        corners = self._projected(points)
        if corners is not None:
            self._draw.polygon(corners, fill=_ink(color, opacity))

    def disc(self, center: NDArray[np.float64], radius: float, color: Color) -> None:
        """Fills a level disc of a radius [m]."""
        rim = np.column_stack([np.cos(ROUND), np.sin(ROUND), np.zeros(ROUND.size)])
        self.area(center + radius * rim, color)

    def ball(self, center: NDArray[np.float64], radius: float, color: Color) -> None:
        """Fills a ball of a radius [m]."""
        at = self._stage.pixels(center[None], self._X_WC)
        if at is not None:
            (x, y, away), size = at[0], FINER * self._stage.focal_length
            self._draw.circle((FINER * x, FINER * y), radius * size / away, _ink(color))

    def line(
        self, points: NDArray[np.float64], color: Color, width: float = LINE
    ) -> None:
        """Draws a curve; its width is a share of the picture's height."""
        corners = self._projected(points)
        if corners is not None:
            wide = max(round(width * self._height), 1)
            self._draw.line(corners, _ink(color), wide, joint="curve")

    def arrow(self, force: ContactForce, color: Color) -> None:
        """Draws a force from where it acts."""
        ends = np.array([force.p_WC, force.p_WC + SCALE * force.force_W])
        corners = self._projected(ends)
        if corners is None:
            return
        tail, tip = map(np.array, corners)
        along = tip - tail
        length = max(float(np.linalg.norm(along)), 1e-9)
        along *= min(HEAD * self._height / length, 1.0)
        across = 0.4 * np.array([-along[1], along[0]])
        neck = tip - along
        wide = max(round(LINE * self._height), 1)
        self._draw.line([tuple(tail), tuple(neck)], _ink(color), wide)
        head = [tuple(tip), tuple(neck + across), tuple(neck - across)]
        self._draw.polygon(head, _ink(color))

    def _projected(
        self, points: NDArray[np.float64]
    ) -> list[tuple[float, float]] | None:
        at = self._stage.pixels(points, self._X_WC)
        return None if at is None else [(FINER * x, FINER * y) for x, y, _ in at]


def _at(flat: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Adds a height [m] to points in the plane, shape (k, 2)."""
    return np.column_stack([flat, np.full(len(flat), height)])


def _ink(color: Color, opacity: float = 1.0) -> tuple[int, int, int, int]:
    red, green, blue = (round(255 * part) for part in color)
    return red, green, blue, round(255 * opacity)
