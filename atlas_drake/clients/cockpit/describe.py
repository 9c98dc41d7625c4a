"""Describes a run, or a log, to the page: what stays the same, as plain data."""

from __future__ import annotations

import dataclasses
import secrets
from collections.abc import Iterable
from typing import Any

import numpy as np
from pydrake.multibody.tree import Frame

from atlas_drake.clients.cockpit.fields import param_fields
from atlas_drake.clients.cockpit.frame import shown_event
from atlas_drake.clients.logs import Log
from atlas_drake.clients.view.overlays import OVERLAYS, logged_overlays
from atlas_drake.config import fields_of
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasBehaviorPelvisServoParams,
    Behavior,
)
from atlas_drake.messages.behavior_catalog import BehaviorInterface
from atlas_drake.planning.footholds import Gait
from atlas_drake.records import Schema, TickRecord
from atlas_drake.records.plain import PARTS, leaves, to_plain
from atlas_drake.records.schema import TIME
from atlas_drake.robot import Robot
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.simulation.tutorial import STEPS
from atlas_drake.units import unit_of

PELVIS = tuple(
    field.name for field in dataclasses.fields(AtlasBehaviorPelvisServoParams)
)
"""Coordinates of the pelvis in MANIPULATE."""
COM_SHIFT = 0.1
"""Largest shift of the center of mass that the page offers [m]."""
SHARES_OF_LOG = 1000
"""Number of instants at which the page knows who had the joints in a log."""


def describe_run(sim: AtlasSimulation) -> dict[str, Any]:
    """Describes a simulation."""
    config: Any = sim.scenario.controller_config()
    steps = () if sim.scenario.schedule == "none" else STEPS
    return {
        **_robot(sim.robot, sim.behaviors),
        "title": sim.scenario.name,
        "gait": _gait(config.gait()),
        "pelvis": _pelvis(config.manipulate.range, sim.robot.pelvis_height),
        "pushed": [sim.robot.pushed_link(name) for name in sim.robot.file.pushed],
        "overlays": dict(OVERLAYS),
        "columns": columns_of(sim.schema, sim.record),
        "steps": [step._asdict() for step in steps],
        "log": None,
    }


def describe_log(log: Log, beside: Log | None) -> dict[str, Any]:
    """Describes a log, and whether there is one beside it."""
    shown = logged_overlays(log.scenario.log)
    numbers = log["behavior.current"]
    begins = np.flatnonzero(np.diff(numbers, prepend=-1))
    rows = thinned(len(log), SHARES_OF_LOG)
    shares = log["joints.k_effort"][rows].mean(axis=1) / K_EFFORT_MAX
    return {
        **_robot(log.robot, log.header.catalog),
        "title": log.path.name,
        "gait": {},
        "pelvis": {},
        "pushed": [],
        "overlays": {name: OVERLAYS[name] for name in shown},
        "columns": {name: {"unit": unit} for name, unit in log.units.items()},
        "steps": [],
        "log": {
            "begin": float(log.time[0]),
            "end": float(log.time[-1]),
            "phases": [
                [float(log.time[row]), log.behavior(int(numbers[row])).name]
                for row in begins
            ],
            "share": np.column_stack([log.time[rows], shares]).round(4).tolist(),
            "events": [shown_event(event) for event in log.events],
            "beside": beside is not None,
        },
    }


def thinned(count: int, most: int) -> slice:
    """Returns evenly spaced places among ``count``, at most ``most``."""
    return slice(None, None, max(-(-count // most), 1))


def _robot(robot: Robot, behaviors: Iterable[BehaviorInterface]) -> dict[str, Any]:
    sole = robot.file.sole
    return {
        "id": secrets.token_hex(4),
        "robot": robot.name,
        "mass": robot.mass,
        "joints": joints_of(robot),
        "behaviors": [_behavior(one) for one in behaviors if one.name != "NONE"],
        "sole": [sole.length, sole.width],
        "hands": [
            {"limb": limb, "link": hand, "palm": robot.palms[hand]}
            for hand, limb in robot.arms.items()
        ],
    }


def joints_of(robot: Robot) -> list[dict[str, Any]]:
    """Describes the joints, with their places in a figure seen from the front [m].

    The figure is the robot in its stand-prep pose: y to its left, z up.
    """
    plant = robot.plant
    context = plant.CreateDefaultContext()
    own = robot.instance(plant)
    joints = [plant.GetJointByName(name, own) for name in robot.joint_names]
    for joint, angle in zip(joints, robot.stand_prep, strict=True):
        joint.set_angle(context, float(angle))

    def place(frame: Frame) -> tuple[float, float]:
        _, y, z = frame.CalcPoseInWorld(context).translation()
        return round(float(y), 3), round(float(z), 3)

    root = place(plant.GetFrameByName(robot.file.pelvis, own))
    places = [place(joint.frame_on_child()) for joint in joints]
    moved_at = {
        link: at
        for at, links in zip(places, robot.moved_links, strict=True)
        for link in links
    }
    return [
        {
            "name": robot.joint_names[index],
            "limb": robot.file.joints[index].limb,
            "lower": float(robot.position_lower[index]),
            "upper": float(robot.position_upper[index]),
            "effort": float(robot.effort_limit[index]),
            "links": list(robot.moved_links[index]),
            "place": places[index],
            "parent": moved_at.get(joint.parent_body().name(), root),
        }
        for index, joint in enumerate(joints)
    ]


def _behavior(entry: BehaviorInterface) -> dict[str, Any]:
    own = entry.name not in Behavior.__members__
    return {
        "name": entry.name,
        "color": entry.color,
        "description": entry.description,
        "own": own,
        "params": param_fields(entry.params) if own and entry.params else [],
    }


def _range(low: float, high: float, step: float, unit: Any, usual: float) -> Any:
    return {"low": low, "high": high, "step": step, "unit": unit, "usual": usual}


def _gait(gait: Gait) -> dict[str, Any]:
    kinds = fields_of(Gait)
    return {
        name: _range(low, high, 0.01, unit_of(kinds[name]), getattr(gait, name))
        for name, low, high in gait.bounds()
        if name != "stride_change"
    }


def _pelvis(allowed: Any, upright: float) -> dict[str, Any]:
    """Returns the bounds of the pelvis' coordinates; the behavior clamps further.

    The usual height is that of the stand-prep pose [m], all else is 0.
    """
    kind: Any = type(allowed)
    ranges, kinds = {}, fields_of(kind)
    for name in PELVIS:
        field = name.removeprefix("pelvis_")
        known: Any = getattr(allowed, field, None)
        low, high = known or (-COM_SHIFT, COM_SHIFT)
        unit, usual = unit_of(kinds.get(field, kinds["com"])), 0.0
        if field == "height":
            low, high, usual = upright + low, upright + high, upright
        ranges[name] = _range(float(low), float(high), 0.005, unit, usual)
    return ranges


def columns_of(schema: Schema, record: TickRecord) -> dict[str, Any]:
    """Returns unit and place of each number in the JSON of a record, by name."""
    found: dict[str, Any] = {}
    for name, column in schema.columns.items():
        if name == TIME:
            continue
        keys: list[Any] = name.split(".")
        for place, label in enumerate(column.elements):
            rows = divmod(place, column.width) if column.width else (place,)
            found[f"{name}.{label}"] = {"unit": column.unit, "path": [*keys, *rows]}
        if not column.elements:
            found[name] = {"unit": column.unit, "path": keys}
    for part in PARTS:
        for keys, _ in leaves(to_plain(getattr(record, part)), (part,)):
            found[".".join(map(str, keys))] = {"unit": "", "path": keys}
    return found
