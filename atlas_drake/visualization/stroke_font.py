"""Letters as strokes, because Meshcat draws lines but no text.

Geometry only; the caller gives text and place.
"""

from __future__ import annotations

import numpy as np

GLYPH_WIDTH, GLYPH_HEIGHT = 4, 6
"""Size of the grid on which the letters are drawn; strokes join its points."""
ADVANCE = 5.5
"""Distance from one letter to the next, on the same grid."""

# Each stroke is a chain of grid points, written as two digits: x, then y.
_GLYPHS = {
    "A": ("00 04 16 36 44 40", "03 43"),
    "B": ("03 33 44 45 36 06 00 30 41 42 33",),
    "C": ("45 36 16 05 01 10 30 41",),
    "D": ("00 06 36 45 41 30 00",),
    "E": ("46 06 00 40", "03 33"),
    "F": ("46 06 00", "03 33"),
    "G": ("45 36 16 05 01 10 30 41 43 23",),
    "H": ("00 06", "40 46", "03 43"),
    "I": ("16 36", "26 20", "10 30"),
    "J": ("46 41 30 10 01",),
    "K": ("00 06", "46 03 40"),
    "L": ("06 00 40",),
    "M": ("00 06 23 46 40",),
    "N": ("00 06 40 46",),
    "O": ("01 05 16 36 45 41 30 10 01",),
    "P": ("00 06 36 45 44 33 03",),
    "Q": ("01 05 16 36 45 41 30 10 01", "22 40"),
    "R": ("00 06 36 45 44 33 03", "23 40"),
    "S": ("45 36 16 05 04 13 33 42 41 30 10 01",),
    "T": ("06 46", "26 20"),
    "U": ("06 01 10 30 41 46",),
    "V": ("06 20 46",),
    "W": ("06 10 23 30 46",),
    "X": ("00 46", "06 40"),
    "Y": ("06 23 46", "23 20"),
    "Z": ("06 46 00 40",),
    "0": ("01 05 16 36 45 41 30 10 01", "12 34"),
    "1": ("05 26 20", "10 30"),
    "2": ("05 16 36 45 44 00 40",),
    "3": ("05 16 36 45 44 33 42 41 30 10 01", "13 33"),
    "4": ("30 36 02 42",),
    "5": ("46 06 04 34 43 41 30 10 01",),
    "6": ("45 36 16 05 01 10 30 41 42 33 03",),
    "7": ("06 46 10",),
    "8": ("13 04 05 16 36 45 44 33 42 41 30 10 01 02 13 33",),
    "9": ("01 10 30 41 45 36 16 05 04 13 43",),
    " ": (),
    ".": ("20 21",),
    ",": ("21 10",),
    ":": ("21 22", "24 25"),
    "-": ("13 33",),
    "_": ("00 40",),
    "+": ("13 33", "22 24"),
    "/": ("00 46",),
    ">": ("05 43 01",),
    "(": ("36 25 21 30",),
    ")": ("16 25 21 10",),
    "!": ("26 22", "20 21"),
}
_UNKNOWN = ("00 06 46 40 00",)


def text_segments(text: str, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Converts one line of text to line segments, in capitals.

    Args:
        text: Text; characters that the font lacks become an empty box.
        height: Height of the letters [m].

    Returns:
        Starts and ends of the segments [m], each of shape (3, number of segments), x to
        the right, y up, z = 0; the middle of the baseline is the origin.
    """
    starts: list[tuple[float, float]] = []
    ends: list[tuple[float, float]] = []
    left = -0.5 * (ADVANCE * (len(text) - 1) + GLYPH_WIDTH)
    for letter in text.upper():
        for stroke in _GLYPHS.get(letter, _UNKNOWN):
            chain = [(left + int(xy[0]), float(xy[1])) for xy in stroke.split()]
            starts += chain[:-1]
            ends += chain[1:]
        left += ADVANCE
    return _points(starts, height), _points(ends, height)


def _points(grid: list[tuple[float, float]], height: float) -> np.ndarray:
    points = np.zeros((3, len(grid)), order="F")
    if grid:
        points[:2] = np.array(grid).T * (height / GLYPH_HEIGHT)
    return points
