"""What the page shows of a log: its card, and the state at a row."""

from __future__ import annotations

import numpy as np

from atlas_drake.cockpit.card import joint_cards
from atlas_drake.cockpit.joint_controls import GAINS
from atlas_drake.cockpit.observe import coming_steps, place_of
from atlas_drake.cockpit.pelvis_controls import COORDINATES
from atlas_drake.cockpit.plot_controls import column_units
from atlas_drake.cockpit.state import BehaviorCard, LogCard, RunCard, RunState
from atlas_drake.control.estimation.attitude import rotation_matrix
from atlas_drake.logs.channels import polygon_from
from atlas_drake.logs.log import Log
from atlas_drake.logs.report_channels import REPORT_CHANNELS, report_from
from atlas_drake.messages import BehaviorStatus
from atlas_drake.planning.footholds import foothold
from atlas_drake.rotations import yaw_of
from atlas_drake.visualization.overlays import LOGGED, OVERLAYS

REFUSAL = "A log is shown: it can be played, not commanded"
"""Why no command is carried out."""


def card_of_log(log: Log, meshcat_port: int) -> RunCard:
    """Makes the card of a log, whose 3D view is on a port."""
    robot, sole = log.robot, log.robot.file.sole
    return RunCard(
        title=log.path.name,
        robot=robot.name,
        mass=robot.mass,
        joints=joint_cards(robot),
        behaviors=tuple(
            BehaviorCard(entry.name, entry.color, entry.description, own=False)
            for entry in log.header.catalog
            if entry.name != "NONE"
        ),
        gait={},
        pelvis={},
        pushed=(),
        overlays={name: OVERLAYS[name] for name in LOGGED},
        sole=(sole.length, sole.width),
        meshcat_port=meshcat_port,
        columns=column_units(log.header.layout),
        log=LogCard(float(log.time[0]), float(log.time[-1]), _phases(log)),
    )


def _phases(log: Log) -> tuple[tuple[float, str], ...]:
    """Returns when each behavior began [s]."""
    numbers = log["behavior.current"]
    begins = np.flatnonzero(np.diff(numbers, prepend=-1))
    return tuple(
        (float(log.time[row]), log.behavior(int(numbers[row])).name) for row in begins
    )


def user_share(log: Log, rows: np.ndarray) -> np.ndarray:
    """Returns the user's share of all joints at some rows, 0 to 1."""
    share: np.ndarray = log["joints.k_effort"][rows].mean(axis=1) / 255.0
    return share


def state_of_log(log: Log, row: int) -> RunState:
    """Reads the state at a row of a log; nobody commands, and time stands still."""

    def numbers(name: str) -> tuple[float, ...]:
        return tuple(log[name][row].tolist())

    report = report_from(
        {one.channel.name: log[one.channel.name][row] for one in REPORT_CHANNELS}
    )
    R_WP = rotation_matrix(log["pelvis.orientation"][row])
    support = polygon_from(log["balance.support"][row])
    flags = int(log["behavior.status_flags"][row])
    feet = [foothold(pose) for pose in report.foot_pos_est]
    px, py, pz = numbers("pelvis.position")
    com, dcm = log["balance.com"][row], log["balance.dcm"][row]
    cop = log["balance.cop"][row]
    loads = [float(log[f"feet.{side}_force"][row, 2]) for side in ("left", "right")]
    return RunState(
        time=float(log.time[row]),
        rate=0.0,
        pace=1.0,
        paused=True,
        tick_ms=1e3 * float(log["controller.tick_time"][row]),
        behavior=log.behavior(report.current_behavior).name,
        desired=log.behavior(report.desired_behavior).name,
        fallen=bool(flags & BehaviorStatus.ERROR_FALLING),
        refusals={entry.name: REFUSAL for entry in log.header.catalog},
        k_effort=tuple(log["joints.k_effort"][row].astype(int).tolist()),
        position=numbers("joints.position"),
        set_point=numbers("joints.position_setpoint"),
        effort=numbers("joints.effort"),
        gains={name: numbers(f"gains.{name}") for name in GAINS},
        poses=(),
        direction=None,
        gait={},
        pelvis={
            name: getattr(report.manipulate_feedback.clamped, name)
            for name in COORDINATES
        },
        robot=(px, py, pz, float(yaw_of(R_WP))),
        ground=min(pose.position.z for pose in report.foot_pos_est),
        com=place_of(com),
        dcm=place_of(dcm),
        cop=place_of(cop) if np.isfinite(cop).all() else None,
        support=() if support is None else tuple(map(place_of, support)),
        feet=tuple((foot.x, foot.y, foot.yaw) for foot in feet),
        loads=(loads[0], loads[1]),
        steps=coming_steps(report),
        plan=(),
        overlays=frozenset(),
    )
