"""The page of an import: pictures from front and side, and what the robot does."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.geometry import Role
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.clients.film.film import photograph
from atlas_drake.clients.importing.files import PICTURE, YAML
from atlas_drake.clients.importing.findings import GUESSED, LOST, REPAIRED, Findings
from atlas_drake.clients.importing.trial import NEAR_LIMIT, PUSH_DURATION, Trial
from atlas_drake.clients.logs import read_log
from atlas_drake.robot import Robot
from atlas_drake.worlds.world_file import View

SIZE = (420, 560)
"""Of each picture [pixel]."""
MARGIN = 1.05
"""Height of a picture over that of the robot [-]."""
FAR = 2.3
"""Distance of the camera, in heights of the robot [-]."""


def write_picture(log_path: Path, trial: Trial, robot: Robot, path: Path) -> None:
    """Writes the robot standing and walking, each from front and side, into a PNG."""
    from PIL import Image

    log = read_log(log_path)
    h = robot_height(robot)
    middle = [0.0, 0.0, 0.5 * h]
    views = [
        View([FAR * h, 0.3 * h, 0.7 * h], middle),
        View([0.1 * h, -FAR * h, 0.7 * h], middle),
    ]
    taken = [photograph(log, trial.moments, view, SIZE) for view in views]
    row = [picture for pair in zip(*taken, strict=True) for picture in pair]
    Image.fromarray(np.concatenate(row, axis=1)).save(path)


def robot_height(robot: Robot) -> float:
    """Returns the height in the stand-prep pose, with a little more [m]."""
    builder = DiagramBuilder()
    plant: Any = AddMultibodyPlantSceneGraph(builder, time_step=0.0)[0]
    robot.add_to(plant)
    plant.Finalize()
    root = builder.Build().CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    for name, angle in zip(robot.joint_names, robot.stand_prep, strict=True):
        plant.GetJointByName(name).set_angle(context, angle)
    query = plant.get_geometry_query_input_port().Eval(context)
    inspector = query.inspector()
    tops = []
    for geometry in inspector.GetAllGeometryIds(Role.kIllustration):
        box = inspector.GetObbInGeometryFrame(geometry)
        if box is not None:
            X_WB = query.GetPoseInWorld(geometry).multiply(box.pose())
            up = np.abs(X_WB.rotation().matrix()[2]) @ box.half_width()
            tops.append(float(X_WB.translation()[2] + up))
    return MARGIN * (max(tops, default=0.5 * robot.com_height) + robot.pelvis_height)


def write_page(trial: Trial, robot: Robot, findings: Findings, path: Path) -> None:
    """Writes the numbers."""
    lines = [
        f"# {robot.name}",
        "",
        f"![Standing and walking, from the front and from its right]({PICTURE})",
        "",
        f"{robot.mass:.1f} kg, center of mass {robot.com_height:.3f} m high, "
        f"{robot.num_joints} joints, soles {robot.file.sole.length:.3f} m by "
        f"{robot.file.sole.width:.3f} m.",
        "",
        "| | |",
        "| --- | --- |",
        *(f"| {name} | {value} |" for name, value in results(trial)),
        "",
        f"Pushes change the robot's speed within {PUSH_DURATION:g} s, at its trunk "
        f"(`{robot.trunk}`); the robot bears one if it stands in the end.",
        "",
    ]
    if trial.near_limit and trial.walks:
        lines += [
            f"Joints that reached {NEAR_LIMIT:.0%} of their effort limit while the "
            "robot stood and walked; those of the legs bound its speed:",
            "",
        ]
        ordered = sorted(trial.near_limit.items(), key=lambda item: -item[1])
        lines += [f"- {name}: {share:.0%}" for name, share in ordered]
        lines.append("")
    for kind in (REPAIRED, GUESSED, LOST):
        texts = findings.of(kind)
        if texts:
            lines += [f"{kind.capitalize()}:", "", *(f"- {text}" for text in texts), ""]
    if trial.events:
        lines += ["Events:", "", *(f"- {text}" for text in trial.events), ""]
    path.write_text("\n".join(lines), encoding="utf-8")


def results(trial: Trial) -> list[tuple[str, str]]:
    """Returns name and value of what the trial found."""

    def yes(done: bool) -> str:
        return "yes" if done else "no"

    found = [("stands", yes(trial.stands))]
    if trial.stands:
        landing = ""
        if math.isfinite(trial.landing):
            landing = f", feet within {1e3 * trial.landing:.0f} mm"
        found.append((f"walks, {trial.steps}", yes(trial.walks) + landing))
    if trial.bound:
        found.append(("what bounds it", trial.bound))
        gentler = f"it walks with {trial.gentler} ones; {YAML} has their values"
        if not trial.gentler:
            gentler = f"it does not walk with {'; '.join(trial.failed)} ones either"
        found.append(("gentler steps", gentler))
    if trial.walks:
        found.append(("`walk_at` accepts", trial.speeds))
    if trial.pushes:
        borne = ", ".join(
            f"{name} {speed:.2f} m/s" if speed else f"{name} none"
            for name, speed in trial.pushes.items()
        )
        found.append(("pushes while it stands", borne))
    return found
