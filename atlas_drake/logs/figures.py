"""The page of figures of a log: modes, joints, efforts, balance, feet, tick times.

Panels are data here; drawing them is up to ``png_page`` and ``html_page``.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.log import Log
from atlas_drake.logs.panels import (
    Band,
    Heat,
    Item,
    Line,
    Marker,
    Outline,
    Page,
    Panel,
    Span,
)
from atlas_drake.logs.support import Feet, double_supports, feet_of, footprints, runs
from atlas_drake.messages import K_EFFORT_MAX, Behavior

BEHAVIOR_COLORS = {
    Behavior.NONE: "#9e9e9e",
    Behavior.FREEZE: "#4fc3d9",
    Behavior.STAND_PREP: "#b39ddb",
    Behavior.STAND: "#7cb342",
    Behavior.WALK: "#42a5f5",
    Behavior.STEP: "#26a69a",
    Behavior.MANIPULATE: "#ec407a",
    Behavior.USER: "#ffb74d",
}
JOINT_COLORS = ("#1f77b4", "#d95f02", "#2a9d3a", "#c2185b", "#7e57c2", "#8d6e63")
SIDE_COLORS = ("#1a6bd8", "#e66b14")
"""Of the left and the right foot, as in the 3D view."""
COM, DCM, COP, SUPPORT = "#222222", "#c2185b", "#2a9d3a", "#cfd8dc"
ALARM = "#d50000"
SHARE_COLORS = ("#eceff1", "#ffe0b2", "#ffb74d", "#f57c00")
LOAD_COLORS = ("#f7fbff", "#9ecae1", "#4292c6", "#fdae61", "#d7191c")
LIMBS = (
    ("Left leg", ("l_leg",)),
    ("Right leg", ("r_leg",)),
    ("Left arm", ("l_arm",)),
    ("Right arm", ("r_arm",)),
    ("Back and neck", ("back", "neck")),
)
HEIGHTS = (0.4, 3.5, 2.0, 2.0, 2.0, 2.2, 2.2, 2.0, 2.0)
"""Of the rows of the page [inch]."""
TICK_MARGIN = 1.3
"""How far the axis of tick times reaches beyond what is usual [-]."""


def make_page(log: Log) -> Page:
    """The page of a log."""
    feet = feet_of(log)
    time = log.time
    panels = [
        _modes(log, 0),
        _solved(log, 0),
        _k_effort(log),
        _efforts(log),
        *_joints(log),
        _tick_times(log),
        _from_above(log, feet),
        _balance_over_time(log, feet, 0, "x", 5),
        _balance_over_time(log, feet, 1, "y", 6),
        _foot_heights(log, feet),
        _foot_forces(log),
        _pelvis(log),
        _pelvis_speed(log),
    ]
    falls = [
        Marker(event.time, ALARM, "fall")
        for event in log.events
        if event.kind == "fall"
    ]
    if falls:
        panels = [_with(panel, falls) if panel.over_time else panel for panel in panels]
    return Page(
        title=f"{log.path.name}: {log.header.model}, scenario {_scenario_name(log)}",
        subtitle=f"{time[0]:.1f} s to {time[-1]:.1f} s, {len(log)} control ticks of "
        f"{1e3 * log.header.control_period:g} ms",
        heights=HEIGHTS,
        columns=2,
        panels=tuple(panels),
        # The last row holds for one more period.
        time=(float(time[0]), float(time[-1]) + log.header.control_period),
    )


def _with(panel: Panel, more: list[Marker]) -> Panel:
    return Panel(**{**panel.__dict__, "items": (*panel.items, *more)})


def _scenario_name(log: Log) -> str:
    for line in log.header.scenario.splitlines():
        if line.startswith("name:"):
            return line.partition(":")[2].strip()
    return "(unnamed)"


# ---- modes and efforts -------------------------------------------------------


def _modes(log: Log, row: int) -> Panel:
    current, time = log["behavior.current"], log.time
    spans = []
    for number in np.unique(current).tolist():
        behavior = Behavior(number)
        for begin, end in runs(current == number):
            last = time[min(end, len(time) - 1)]
            color = BEHAVIOR_COLORS[behavior]
            spans.append(Span(time[begin], last, color, behavior.name))
    spans.sort(key=lambda span: span.start)
    return Panel("Active behaviour", "", tuple(spans), row, 0, x_label="")


def _solved(log: Log, row: int) -> Panel:
    """Where the QP had a solution."""
    unsolved = np.diff(log["controller.unsolved"], prepend=0) > 0
    spans = []
    for flags, color, label in (
        (~unsolved, "#a5d6a7", "solved"),
        (unsolved, ALARM, "no solution"),
    ):
        for begin, end in runs(flags):
            last = log.time[min(end, len(log) - 1)]
            spans.append(Span(log.time[begin], last, color, label))
    return Panel("Whole-body QP", "", tuple(spans), row, 1, x_label="")


def _k_effort(log: Log) -> Panel:
    heat = Heat(
        x=log.time,
        names=log.robot.joint_names,
        values=log["joints.k_effort"].T.astype(float),
        low=0.0,
        high=float(K_EFFORT_MAX),
        colors=SHARE_COLORS,
        label="0: behaviour, 255: user",
    )
    return Panel("Share of the user (k_effort)", "", (heat,), 1, 0)


def _efforts(log: Log) -> Panel:
    share = np.abs(log["joints.effort"]) / log.robot.effort_limit
    names = log.robot.joint_names
    joint = int(share.max(axis=0).argmax())
    heat = Heat(
        x=log.time,
        names=names,
        values=share.T,
        low=0.0,
        high=1.0,
        colors=LOAD_COLORS,
        label="|effort| / limit",
    )
    peak = 100.0 * share[:, joint].max()
    title = f"Efforts against their limits (most: {names[joint]}, {peak:.0f} %)"
    return Panel(title, "", (heat,), 1, 1)


# ---- joints ------------------------------------------------------------------


def _joints(log: Log) -> Iterator[Panel]:
    robot = log.robot
    position, setpoint = log["joints.position"], log["joints.position_setpoint"]
    users = log["joints.k_effort"] > 0
    for number, (title, limbs) in enumerate(LIMBS):
        items: list[Item] = []
        for place, joint in enumerate(np.flatnonzero(robot.limb(*limbs)).tolist()):
            color = JOINT_COLORS[place % len(JOINT_COLORS)]
            name = robot.joint_names[joint]
            for limb in limbs:
                name = name.removeprefix(f"{limb}_")
            items.append(Line(log.time, position[:, joint], color, name))
            wanted = np.where(users[:, joint], setpoint[:, joint], np.nan)
            if users[:, joint].any():
                items.append(Line(log.time, wanted, color, dashed=True, width=0.9))
        yield Panel(
            f"{title} (dashed: set-points)",
            "position [rad]",
            tuple(items),
            2 + number // 2,
            number % 2,
        )


def _tick_times(log: Log) -> Panel:
    ticks = 1e3 * log["controller.tick_time"]
    period = 1e3 * log.header.control_period
    known = ticks[np.isfinite(ticks)]
    title = "Controller ticks"
    top = period
    if known.size:
        median, high = np.percentile(known, [50, 99])
        title += (
            f" (median {median:.2f}, 99 % {high:.2f}, longest {known.max():.1f} ms)"
        )
        top = max(period, high)
    limit = np.full(2, period)
    items = (
        Line(log.time, ticks, "#546e7a", "tick", width=0.7),
        Line(log.time[[0, -1]], limit, ALARM, "control period", dashed=True),
    )
    return Panel(title, "wall time [ms]", items, 4, 1, y_range=(0.0, TICK_MARGIN * top))


# ---- balance -----------------------------------------------------------------

_TRACKS = (
    ("com", COM, "CoM", False),
    ("dcm_reference", DCM, "", True),
    ("dcm", DCM, "DCM", False),
    ("cop", COP, "CoP", False),
)


def _from_above(log: Log, feet: Feet) -> Panel:
    items: list[Item] = [
        Outline(polygon, SUPPORT, opacity=0.35)
        for polygon in double_supports(log, feet)
    ]
    for foot, side in enumerate(SIDES):
        color = SIDE_COLORS[foot]
        for number, corners in enumerate(footprints(log, feet, foot)):
            label = f"{side} foot" if number == 0 else ""
            items.append(Outline(corners, color, label, opacity=0.18))
    items += [
        Outline(_sole(log, event.data["commanded"]), "#555555", dashed=True)
        for event in log.events
        if event.kind == "footstep"
    ]
    for name, color, label, dashed in _TRACKS:
        track = log[f"balance.{name}"]
        width = 0.6 if name == "cop" else 1.3
        items.append(Line(track[:, 0], track[:, 1], color, label, dashed, width))
    return Panel(
        "From above (dashed: planned)",
        "y, to the left [m]",
        tuple(items),
        5,
        0,
        rows=2,
        x_label="x, ahead [m]",
        over_time=False,
        equal=True,
    )


def _balance_over_time(log: Log, feet: Feet, axis: int, name: str, row: int) -> Panel:
    items: list[Item] = [Band(log.time, *feet.extent(axis), SUPPORT, "support")]
    items += [
        Line(log.time, log[f"balance.{key}"][:, axis], color, label, dashed)
        for key, color, label, dashed in _TRACKS
    ]
    where = "ahead" if axis == 0 else "sideways"
    title = f"Balance {where} (dashed: planned)"
    return Panel(title, f"{name} [m]", tuple(items), row, 1)


def _sole(log: Log, pose: list[float]) -> np.ndarray:
    """Corners of a sole at x, y [m] and yaw [rad], shape (4, 2)."""
    x, y, yaw = pose
    size = log.robot.file.sole
    half = 0.5 * np.array([size.length, size.width])
    corners = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * half
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([x, y]) + corners @ np.array([[cos, sin], [-sin, cos]])


# ---- feet and pelvis ---------------------------------------------------------


def _foot_heights(log: Log, feet: Feet) -> Panel:
    items = tuple(
        Line(log.time, log[f"feet.{side}_position"][:, 2], SIDE_COLORS[foot], side)
        for foot, side in enumerate(SIDES)
    )
    return Panel("Foot heights", "sole z [m]", items, 7, 0)


def _foot_forces(log: Log) -> Panel:
    items = tuple(
        Line(log.time, log[f"feet.{side}_force"][:, 2], SIDE_COLORS[foot], side)
        for foot, side in enumerate(SIDES)
    )
    return Panel("Foot forces", "vertical [N]", items, 7, 1)


def _pelvis(log: Log) -> Panel:
    w, x, y, z = log["pelvis.orientation"].T
    angles = {
        "roll": np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
        "pitch": np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0)),
        "yaw": np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
    }
    items = tuple(
        Line(log.time, angle, color, name)
        for (name, angle), color in zip(angles.items(), JOINT_COLORS, strict=False)
    )
    return Panel("Orientation of the pelvis", "angle [rad]", items, 8, 0)


def _pelvis_speed(log: Log) -> Panel:
    velocity = log["pelvis.velocity"]
    items = tuple(
        Line(log.time, velocity[:, axis], color, name)
        for axis, (name, color) in enumerate(zip("xyz", JOINT_COLORS, strict=False))
    )
    return Panel("Velocity of the pelvis in the world", "velocity [m/s]", items, 8, 1)
