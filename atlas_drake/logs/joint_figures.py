"""Figures about joints: shares of user control, efforts, positions.

Panels as data; ``figures`` arranges them on the page.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from atlas_drake.logs.log import Log
from atlas_drake.logs.panels import Heat, Item, Line, Panel
from atlas_drake.messages import K_EFFORT_MAX

JOINT_COLORS = ("#1f77b4", "#d95f02", "#2a9d3a", "#c2185b", "#7e57c2", "#8d6e63")
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
