"""Figures of a log, drawn with matplotlib: one page, or curves of chosen columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RollPitchYaw

from atlas_drake.clients.logs.drawing import (
    ALARM,
    FOOTER,
    GAP,
    HEADER,
    LEFT,
    MIDDLE,
    RIGHT,
    STYLE,
    WIDTH,
    draw_curve,
    draw_map,
    draw_outline,
    draw_spans,
    over_time,
    titled_figure,
)
from atlas_drake.clients.logs.footprints import (
    SIDES,
    Soles,
    commanded_footprints,
    soles_of,
)
from atlas_drake.clients.logs.header import LogError
from atlas_drake.clients.logs.log import Log
from atlas_drake.errors import did_you_mean
from atlas_drake.messages import K_EFFORT_MAX
from atlas_drake.palette import CMP, COM, COP, DCM, FEET, Color
from atlas_drake.records.tick_record import NO_QP

SUFFIXES = (".png", ".svg", ".pdf")
"""Endings of the files that figures are drawn to."""

# ---- layout ------------------------------------------------------------------

PAGE = (
    ("behavior", "qp"),
    ("k_effort", "effort"),
    ("left leg", "right leg"),
    ("left arm", "right arm"),
    ("trunk", "ticks"),
    ("above", "balance x"),
    ("above", "balance y"),
    ("foot heights", "foot forces"),
    ("pelvis angles", "pelvis velocity"),
)
"""Figures of the page by row and column."""
HEIGHTS = (0.4, 3.5, 2.0, 2.0, 2.0, 2.2, 2.2, 2.0, 2.0)
"""Heights of the rows of the page [inch]."""
LEGEND = 3.2
"""Space for the names of chosen columns, to the right of their curves [inch]."""
TICK_MARGIN = 1.3
"""Range of the tick-time axis over the usual tick time [-]."""

# ---- what the figures show ---------------------------------------------------

COLORS = ("#1f77b4", "#d95f02", "#2a9d3a", "#c2185b", "#7e57c2", "#8d6e63")
"""Colors of curves that stand for joints or axes."""
SUPPORT = "#cfd8dc"
"""Pale, as the supports of many steps overlap."""
USER_COLORS = ("#eceff1", "#ffe0b2", "#ffb74d", "#f57c00")
LOAD_COLORS = ("#f7fbff", "#9ecae1", "#4292c6", "#fdae61", "#d7191c")
LIMBS = {
    "left leg": ("l_leg",),
    "right leg": ("r_leg",),
    "left arm": ("l_arm",),
    "right arm": ("r_arm",),
    "trunk": ("back", "neck"),
}
CURVES: dict[str, tuple[str, str, dict[str, str], Sequence[str | Color]]] = {
    "foot heights": (
        "Foot heights",
        "sole z [m]",
        {"left": "feet.left_position.z", "right": "feet.right_position.z"},
        FEET,
    ),
    "foot forces": (
        "Foot forces",
        "vertical [N]",
        {"left": "feet.left_force.z", "right": "feet.right_force.z"},
        FEET,
    ),
    "pelvis velocity": (
        "Velocity of the pelvis in the world",
        "velocity [m/s]",
        {axis: f"pelvis.velocity.{axis}" for axis in "xyz"},
        COLORS,
    ),
}
"""Title, label of the y axis, columns by label, and colors of plain curves."""
TRACKS = (
    ("com", "CoM", COM),
    ("dcm", "DCM", DCM),
    ("cop", "CoP", COP),
    ("cmp", "CMP", CMP),
)
"""Columns in ``balance``, labels and colors; the planned ones end in ``_reference``."""


@rc_context(STYLE)
def draw_page(log: Log) -> Figure:
    """Draws the page of all figures of a log."""
    rows, columns = len(HEIGHTS), len(PAGE[0])
    height = HEADER + sum(HEIGHTS) + GAP * (rows - 1) + FOOTER
    figure = titled_figure(log, height)
    axes: dict[str, Any] = figure.subplot_mosaic(
        [[*row] for row in PAGE],
        height_ratios=HEIGHTS,
        gridspec_kw={
            "left": LEFT / WIDTH,
            "right": 1.0 - RIGHT / WIDTH,
            "top": 1.0 - HEADER / height,
            "bottom": FOOTER / height,
            # As shares of a mean row and of a column.
            "hspace": GAP * rows / sum(HEIGHTS),
            "wspace": MIDDLE * columns / (WIDTH - LEFT - RIGHT - MIDDLE),
        },
    )
    soles = soles_of(log)
    for name, one in axes.items():
        if name != "above":
            over_time(one, log)
    _draw_behaviors(axes["behavior"], log)
    _draw_qp(axes["qp"], log)
    _draw_k_effort(axes["k_effort"], log)
    _draw_efforts(axes["effort"], log)
    for name, limbs in LIMBS.items():
        _draw_positions(axes[name], log, name, limbs)
    _draw_tick_times(axes["ticks"], log)
    _draw_from_above(axes["above"], log, soles)
    _draw_balance(axes["balance x"], log, soles, 0)
    _draw_balance(axes["balance y"], log, soles, 1)
    for name, (title, y_label, curves, colors) in CURVES.items():
        axes[name].set(title=title, ylabel=y_label)
        for (label, column), color in zip(curves.items(), colors, strict=False):
            draw_curve(axes[name], log.time, log[column], color, label)
    _draw_pelvis_angles(axes["pelvis angles"], log)
    for one in axes.values():
        if one.get_legend_handles_labels()[1]:
            one.legend(loc="lower right", bbox_to_anchor=(1.01, 0.985), ncol=8)
    return figure


@rc_context(STYLE)
def draw_channels(log: Log, patterns: Sequence[str]) -> Figure:
    """Draws chosen numbers over time, those of one unit in one figure."""
    units: dict[str, list[str]] = {}
    for name in _matching(log, patterns):
        units.setdefault(log.units[name], []).append(name)
    row = HEIGHTS[1]
    height = HEADER + (row + GAP) * len(units) - GAP + FOOTER
    figure = titled_figure(log, height)
    figure.subplots_adjust(
        left=LEFT / WIDTH,
        right=1.0 - LEGEND / WIDTH,
        top=1.0 - HEADER / height,
        bottom=FOOTER / height,
        hspace=GAP / row,
    )
    for index, (unit, names) in enumerate(units.items()):
        axes = figure.add_subplot(len(units), 1, index + 1)
        over_time(axes, log)
        axes.set_ylabel(f"[{unit or '-'}]")
        for place, name in enumerate(names):
            again, color = divmod(place, len(COLORS))
            numbers, dashed = log[name], again > 0
            draw_curve(axes, log.time, numbers, COLORS[color], name, dashed=dashed)
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


def _matching(log: Log, patterns: Sequence[str]) -> list[str]:
    """Returns the names of chosen numbers, each once, in the order of the patterns.

    A pattern is a name such as ``balance.com.x``, the beginning of names such as
    ``balance.com``, or has wildcards, such as ``*.l_leg_kny``.
    """
    found: dict[str, None] = {}
    for pattern in patterns:
        names = [
            name
            for name in log.numbers
            if name.startswith(f"{pattern}.") or fnmatchcase(name, pattern)
        ]
        if not names:
            hint = did_you_mean(pattern, [*log.arrays, *log.numbers])
            raise LogError(f"{log.path}: it has no column {pattern!r}.{hint}")
        found |= dict.fromkeys(names)
    return [*found]


# ---- the figures of the page -------------------------------------------------


def _draw_behaviors(axes: Any, log: Log) -> None:
    axes.set_title("Active behavior")
    current = log["behavior.current"]
    for number in np.unique(current).tolist():
        entry = log.header.catalog.entry(log.behavior(number))
        draw_spans(axes, log, current == number, entry.color, entry.name)


def _draw_qp(axes: Any, log: Log) -> None:
    """Draws where there was a QP, and whether it had a solution."""
    axes.set_title("Whole-body QP")
    solved = log["controller.solved"]
    unsolved, unknown = solved == 0, solved == NO_QP
    draw_spans(axes, log, ~unsolved & ~unknown, "#a5d6a7", "solved")
    draw_spans(axes, log, unknown, "#cfd8dc", "no report")
    draw_spans(axes, log, unsolved, ALARM, "no solution")


def _draw_k_effort(axes: Any, log: Log) -> None:
    axes.set_title("Share of the user (k_effort)")
    k_effort, label = log["joints.k_effort"], "0: behavior, 255: user"
    draw_map(axes, log, k_effort, float(K_EFFORT_MAX), USER_COLORS, label)


def _draw_efforts(axes: Any, log: Log) -> None:
    """Draws efforts as shares of their limits."""
    share = np.abs(log["joints.effort"]) / log.robot.effort_limit
    joint = int(share.max(axis=0).argmax())
    most = f"{log.robot.joint_names[joint]}, {100.0 * share[:, joint].max():.0f} %"
    axes.set_title(f"Efforts against their limits (most: {most})")
    draw_map(axes, log, share, 1.0, LOAD_COLORS, "|effort| / limit")


def _draw_positions(axes: Any, log: Log, name: str, limbs: Sequence[str]) -> None:
    """Draws positions, and set-points while the user has a share of the joint."""
    title = "Back and neck" if name == "trunk" else name.capitalize()
    axes.set(title=f"{title} (dashed: set-points)", ylabel="position [rad]")
    joints = np.array(log.robot.joint_names)[log.robot.limb(*limbs)].tolist()
    for place, joint in enumerate(joints):
        color = COLORS[place % len(COLORS)]
        label = joint
        for limb in limbs:
            label = label.removeprefix(f"{limb}_")
        draw_curve(axes, log.time, log[f"joints.position.{joint}"], color, label)
        users = log[f"joints.k_effort.{joint}"] > 0
        if users.any():
            setpoint = np.where(users, log[f"joints.position_setpoint.{joint}"], np.nan)
            draw_curve(axes, log.time, setpoint, color, dashed=True, width=0.9)


def _draw_tick_times(axes: Any, log: Log) -> None:
    ticks = 1e3 * log["controller.tick_time"]
    period = 1e3 * log.header.control_period
    known = ticks[np.isfinite(ticks)]
    title, top = "Controller ticks", period
    if known.size:
        median, high = np.percentile(known, [50, 99])
        longest = f"longest {known.max():.1f} ms"
        title += f" (median {median:.2f}, 99 % {high:.2f}, {longest})"
        top = max(period, high)
    axes.set(title=title, ylabel="wall time [ms]")
    draw_curve(axes, log.time, ticks, "#546e7a", "tick", width=0.7)
    limit = np.full(2, period)
    draw_curve(axes, log.time[[0, -1]], limit, ALARM, "control period", dashed=True)
    axes.set_ylim(0.0, TICK_MARGIN * top)


def _draw_from_above(axes: Any, log: Log, soles: Soles) -> None:
    """Draws CoM, DCM and CoP over the footprints and support polygons."""
    axes.set(title="From above (dashed: planned)", ylabel="y, to the left [m]")
    axes.set_xlabel("x, ahead [m]", labelpad=1)
    for polygon in soles.double_supports():
        draw_outline(axes, polygon, SUPPORT, opacity=0.35)
    for foot, color in enumerate(FEET):
        for number, corners in enumerate(soles.footprints(foot)):
            label = f"{SIDES[foot]} foot" if number == 0 else ""
            draw_outline(axes, corners, color, label, opacity=0.18)
    for corners in commanded_footprints(log):
        draw_outline(axes, corners, "#555555")
    for name, track, style in _tracks(log):
        if name != "cmp":  # It would hide the CoP.
            draw_curve(axes, *track.T[:2], width=0.6 if name == "cop" else 1.3, **style)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.04)


def _draw_balance(axes: Any, log: Log, soles: Soles, axis: int) -> None:
    """Draws CoM, DCM, CoP, CMP and support along x (axis 0) or y (1)."""
    where = ("ahead", "sideways")[axis]
    axes.set(title=f"Balance {where} (dashed: planned)", ylabel=f"{'xy'[axis]} [m]")
    band = {"color": SUPPORT, "alpha": 0.55, "lw": 0.0, "label": "support"}
    axes.fill_between(log.time, *soles.extent(axis), **band)
    for _, track, style in _tracks(log):
        draw_curve(axes, log.time, track[:, axis], **style)


def _tracks(log: Log) -> Iterator[tuple[str, np.ndarray, dict[str, Any]]]:
    """Yields names, tracks and styles of curves; planned ones as far as there are."""
    for name, label, color in TRACKS:
        planned = log[f"balance.{name}_reference"]
        if np.isfinite(planned).any():
            yield name, planned, {"color": color, "dashed": True}
        yield name, log[f"balance.{name}"], {"color": color, "label": label}


def _draw_pelvis_angles(axes: Any, log: Log) -> None:
    axes.set(title="Orientation of the pelvis", ylabel="angle [rad]")
    wxyz = log["pelvis.orientation"]
    unit = wxyz / np.linalg.norm(wxyz, axis=1, keepdims=True)
    angles = np.array([RollPitchYaw(Quaternion(one)).vector() for one in unit])
    labels = ("roll", "pitch", "yaw")
    for label, angle, color in zip(labels, angles.T, COLORS, strict=False):
        draw_curve(axes, log.time, angle, color, label)
