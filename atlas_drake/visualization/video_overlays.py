"""Draws the shapes of overlays onto pictures of a video, and colors links in them.

Nothing in a picture hides the shapes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform

from atlas_drake.palette import Color
from atlas_drake.robot import Robot
from atlas_drake.visualization.overlay_shapes import SEEN_THROUGH, Shape, ShapeKind
from atlas_drake.visualization.video_stage import Picture, VideoStage

FINER = 3
"""Pixels of the drawing per pixel of the picture, which smooths the edges."""
LINE, THIN = 0.007, 0.003
"""Width of paths and arrows, and of the plumb line, as shares of the height."""
HEAD = 0.02
"""Length of an arrow's head as a share of the height."""
ROUND = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
"""Angles of the corners of a disc [rad]."""
DARKEST, BRIGHTEST = 0.35, 1.25
"""Brightness of a colored link where the picture is black, and where it is white."""


class VideoOverlays:
    """Draws overlays onto the pictures of a stage."""

    def __init__(self, robot: Robot, stage: VideoStage) -> None:
        """Takes the robot, and the stage of the pictures."""
        self._stage = stage
        self._moved = [stage.bodies(links) for links in robot.moved_links]

    def onto(
        self,
        picture: Picture,
        shapes: Sequence[Shape],
        colors: Sequence[Color] | None,
        X_WC: RigidTransform,
    ) -> Picture:
        """Returns the stage's last picture with the overlays.

        Args:
            picture: The picture.
            shapes: Shapes of the overlays, the lowest first.
            colors: Colors of the joints' links; None leaves the links their own.
            X_WC: Pose of the camera.
        """
        from PIL import Image, ImageDraw

        if colors is not None:
            picture = self._colored(picture, colors, X_WC)
        if not shapes:
            return picture
        height, width = picture.shape[:2]
        layer = Image.new("RGBA", (FINER * width, FINER * height))
        pencil = _Pencil(ImageDraw.Draw(layer), self._stage, X_WC, FINER * height)
        for shape in shapes:
            pencil.draw(shape)
        layer = layer.resize((width, height), Image.Resampling.BOX)
        below = Image.fromarray(picture).convert("RGBA")
        return np.array(Image.alpha_composite(below, layer).convert("RGB"))

    def _colored(
        self, picture: Picture, colors: Sequence[Color], X_WC: RigidTransform
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

    def draw(self, shape: Shape) -> None:
        """Draws a shape, unless a part of it is behind the camera."""
        points = shape.points
        if shape.kind is ShapeKind.DISC:
            rim = np.column_stack([np.cos(ROUND), np.sin(ROUND), np.zeros(ROUND.size)])
            points = points + shape.radius * rim
        projected = self._stage.pixels(points, self._X_WC)
        if projected is None:
            return
        corners = [(FINER * x, FINER * y) for x, y, _ in projected]
        match shape.kind:
            case ShapeKind.AREA:
                self._draw.polygon(corners, fill=_ink(shape.color, SEEN_THROUGH))
            case ShapeKind.DISC:
                self._draw.polygon(corners, fill=_ink(shape.color))
            case ShapeKind.BALL:
                scale = FINER * self._stage.focal_length / projected[0, 2]
                self._draw.circle(corners[0], shape.radius * scale, _ink(shape.color))
            case ShapeKind.CURVE:
                self._line(corners, shape.color, LINE)
            case ShapeKind.ROD:
                self._line(corners, shape.color, THIN)
            case ShapeKind.ARROW:
                tail, tip = map(np.array, corners)
                self._arrow(tail, tip, shape.color)

    def _line(
        self, corners: list[tuple[float, float]], color: Color, width: float
    ) -> None:
        """Draws a curve; its width is a share of the picture's height."""
        wide = max(round(width * self._height), 1)
        self._draw.line(corners, _ink(color), wide, joint="curve")

    def _arrow(
        self, tail: NDArray[np.float64], tip: NDArray[np.float64], color: Color
    ) -> None:
        along = tip - tail
        length = max(float(np.linalg.norm(along)), 1e-9)
        along *= min(HEAD * self._height / length, 1.0)
        across = 0.4 * np.array([-along[1], along[0]])
        neck = tip - along
        self._line([tuple(tail), tuple(neck)], color, LINE)
        head = [tuple(tip), tuple(neck + across), tuple(neck - across)]
        self._draw.polygon(head, _ink(color))


def _ink(color: Color, opacity: float = 1.0) -> tuple[int, int, int, int]:
    red, green, blue = (round(255 * part) for part in color)
    return red, green, blue, round(255 * opacity)
