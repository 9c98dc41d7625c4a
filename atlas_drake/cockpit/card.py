"""Describes a simulation to the page: what stays the same in a run."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from atlas_drake.cockpit.pelvis_controls import COORDINATES
from atlas_drake.cockpit.state import (
    BehaviorCard,
    JointCard,
    ParamCard,
    Point,
    Range,
    RunCard,
)
from atlas_drake.cockpit.walk_controls import GAIT
from atlas_drake.control.pelvis.pelvis_pose import PelvisRange
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorInterface
from atlas_drake.planning.footholds import Gait
from atlas_drake.records.plain import flat_units
from atlas_drake.robot import Robot
from atlas_drake.visualization.overlays import OVERLAYS

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation


def card_of(sim: AtlasSimulation, meshcat_port: int) -> RunCard:
    """Makes the card of a simulation, whose 3D view is on a port."""
    config, robot = sim.scenario.controller_config(), sim.robot
    sole = robot.file.sole
    return RunCard(
        title=sim.scenario.name,
        robot=robot.name,
        mass=robot.mass,
        joints=joint_cards(robot),
        behaviors=tuple(
            _behavior(entry) for entry in sim.behaviors if entry.name != "NONE"
        ),
        gait=_gait_ranges(config.gait()),
        pelvis=_pelvis_ranges(config.manipulate.range),
        pushed=tuple(robot.file.pushed),
        overlays=dict(OVERLAYS),
        sole=(sole.length, sole.width),
        meshcat_port=meshcat_port,
        columns=flat_units(sim.schema, sim.record),
    )


def joint_cards(robot: Robot) -> tuple[JointCard, ...]:
    """Describes the joints, with their places in a figure seen from the front.

    The figure is the robot in its stand-prep pose.
    """
    plant = robot.plant
    context = plant.CreateDefaultContext()
    own = robot.instance(plant)
    joints = [plant.GetJointByName(name, own) for name in robot.joint_names]
    for joint, angle in zip(joints, robot.stand_prep, strict=True):
        joint.set_angle(context, float(angle))

    def place(joint: object) -> Point:
        frame = joint.frame_on_child()  # type: ignore[attr-defined]
        p_W = frame.CalcPoseInWorld(context).translation()
        return round(float(p_W[1]), 3), round(float(p_W[2]), 3)

    pelvis = plant.GetBodyByName(robot.file.pelvis, own)
    p_WP = pelvis.EvalPoseInWorld(context).translation()
    root = (round(float(p_WP[1]), 3), round(float(p_WP[2]), 3))
    places = [place(joint) for joint in joints]
    owner = {link: i for i, links in enumerate(robot.moved_links) for link in links}
    cards = []
    for index, joint in enumerate(joints):
        before = owner.get(joint.parent_body().name())
        cards.append(
            JointCard(
                name=robot.joint_names[index],
                limb=robot.file.joints[index].limb,
                lower=float(robot.position_lower[index]),
                upper=float(robot.position_upper[index]),
                effort=float(robot.effort_limit[index]),
                links=robot.moved_links[index],
                place=places[index],
                parent=root if before is None else places[before],
            )
        )
    return tuple(cards)


def _behavior(entry: BehaviorInterface) -> BehaviorCard:
    own = entry.name not in Behavior.__members__
    params: tuple[ParamCard, ...] = ()
    if own and entry.params is not None:
        blank = entry.params()
        params = tuple(
            ParamCard(one.name, type(value).__name__, value)
            for one in dataclasses.fields(entry.params)
            if isinstance(value := getattr(blank, one.name), bool | int | float | str)
        )
    return BehaviorCard(entry.name, entry.color, entry.description, own, params)


def _gait_ranges(gait: Gait) -> dict[str, Range]:
    units = {"stride": "m", "turn": "rad", "duration": "s", "swing_height": "m"}
    return {
        name: Range(low, high, 0.01, units[name], getattr(gait, name))
        for name, low, high in gait.bounds()
        if name in GAIT
    }


def _pelvis_ranges(allowed: PelvisRange) -> dict[str, Range]:
    """Returns the bounds of the pelvis' coordinates; the behavior clamps further."""
    known = {
        "pelvis_height": allowed.height,
        "pelvis_yaw": allowed.yaw,
        "pelvis_pitch": allowed.pitch,
        "pelvis_roll": allowed.roll,
    }
    ranges = {}
    for name in COORDINATES:
        low, high = known.get(name, (-COM_SHIFT, COM_SHIFT))
        unit = "rad" if name in known and name != "pelvis_height" else "m"
        usual = float(np.clip(0.0, low, high))
        ranges[name] = Range(float(low), float(high), 0.005, unit, usual)
    return ranges


COM_SHIFT = 0.1
"""Largest shift of the center of mass that the page offers [m]."""
