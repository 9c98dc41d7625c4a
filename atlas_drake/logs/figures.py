"""The page of figures of a log, and those about the run as a whole and its joints.

Panels are data here; ``png_page`` and ``html_page`` draw them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from atlas_drake.frozen import replace
from atlas_drake.logs.balance_figures import (
    balance_over_time,
    feet_of,
    foot_forces,
    foot_heights,
    pelvis_angles,
    pelvis_velocity,
    runs,
    view_from_above,
)
from atlas_drake.logs.log import Log
from atlas_drake.logs.panels import (
    JOINT_COLORS,
    Heat,
    Item,
    Line,
    Marker,
    Page,
    Panel,
    Span,
)
from atlas_drake.messages import K_EFFORT_MAX
from atlas_drake.systems.tick_recorder import NO_QP

SHARE_COLORS = ("#eceff1", "#ffe0b2", "#ffb74d", "#f57c00")
LOAD_COLORS = ("#f7fbff", "#9ecae1", "#4292c6", "#fdae61", "#d7191c")
LIMBS = (
    ("Left leg", ("l_leg",)),
    ("Right leg", ("r_leg",)),
    ("Left arm", ("l_arm",)),
    ("Right arm", ("r_arm",)),
    ("Back and neck", ("back", "neck")),
)


def share_panel(log: Log) -> Panel:
    """Draw the user's share of each joint."""
    heat = Heat(
        x=log.time,
        names=log.robot.joint_names,
        values=log["joints.k_effort"].T.astype(float),
        low=0.0,
        high=float(K_EFFORT_MAX),
        colors=SHARE_COLORS,
        label="0: behavior, 255: user",
    )
    return Panel("Share of the user (k_effort)", "", (heat,))


def effort_panel(log: Log) -> Panel:
    """Efforts as shares of their limits."""
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
    return Panel(title, "", (heat,))


def position_panels(log: Log) -> Iterator[Panel]:
    """Positions and set-points, one panel for each of LIMBS."""
    robot = log.robot
    position, setpoint = log["joints.position"], log["joints.position_setpoint"]
    users = log["joints.k_effort"] > 0
    for title, limbs in LIMBS:
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
        )


ALARM = "#d50000"
HEIGHTS = (0.4, 3.5, 2.0, 2.0, 2.0, 2.2, 2.2, 2.0, 2.0)
"""Heights of the rows of the page [inch]."""
TICK_MARGIN = 1.3
"""Range of the tick-time axis over the usual tick time [-]."""


def make_page(log: Log) -> Page:
    """The page of a log."""
    feet = feet_of(log)
    time = log.time
    left_leg, right_leg, left_arm, right_arm, trunk = position_panels(log)
    rows: list[list[Panel | None]] = [
        [_modes(log), _solved(log)],
        [share_panel(log), effort_panel(log)],
        [left_leg, right_leg],
        [left_arm, right_arm],
        [trunk, _tick_times(log)],
        [view_from_above(log, feet), balance_over_time(log, feet, 0)],
        [None, balance_over_time(log, feet, 1)],
        [foot_heights(log), foot_forces(log)],
        [pelvis_angles(log), pelvis_velocity(log)],
    ]
    falls = [
        Marker(event.time, ALARM, "fall")
        for event in log.events
        if event.kind == "fall"
    ]
    panels = []
    for row, pair in enumerate(rows):
        for column, panel in enumerate(pair):
            if panel is not None:
                marks = falls if panel.over_time else []
                items = (*panel.items, *marks)
                panels.append(replace(panel, row=row, column=column, items=items))
    return Page(
        title=f"{log.path.name}: {log.header.model}, scenario {_scenario_name(log)}",
        subtitle=f"{time[0]:.1f} s to {time[-1]:.1f} s, {len(log)} control ticks of "
        f"{1e3 * log.header.control_period:g} ms",
        heights=HEIGHTS,
        columns=2,
        panels=tuple(panels),
        # The last row is valid for one more period.
        time=(float(time[0]), float(time[-1]) + log.header.control_period),
    )


def _scenario_name(log: Log) -> str:
    for line in log.header.scenario.splitlines():
        if line.startswith("name:"):
            return line.partition(":")[2].strip()
    return "(unnamed)"


def _modes(log: Log) -> Panel:
    current = log["behavior.current"]
    spans = []
    for number in np.unique(current).tolist():
        entry = log.header.catalog.entry(log.behavior(number))
        spans += _spans(log, current == number, entry.color, entry.name)
    spans.sort(key=lambda span: span.start)
    return Panel("Active behavior", "", tuple(spans), x_label="")


def _solved(log: Log) -> Panel:
    """Draw where there was a QP, and whether it had a solution."""
    solved = log["controller.solved"]
    unsolved, unknown = solved == 0, solved == NO_QP
    spans = (
        *_spans(log, ~unsolved & ~unknown, "#a5d6a7", "solved"),
        *_spans(log, unknown, "#cfd8dc", "no QP"),
        *_spans(log, unsolved, ALARM, "no solution"),
    )
    return Panel("Whole-body QP", "", spans, x_label="")


def _spans(log: Log, flags: np.ndarray, color: str, label: str) -> list[Span]:
    """Find the time intervals in which flags, shape (rows,), are set."""
    return [
        Span(log.time[begin], log.time[min(end, len(log) - 1)], color, label)
        for begin, end in runs(flags)
    ]


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
    return Panel(title, "wall time [ms]", items, y_range=(0.0, TICK_MARGIN * top))
