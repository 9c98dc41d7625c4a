"""Models beside the robot in a scenario: files for Drake's parser, and their poses.

Callables that add models to a plant are in ``world``.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from annotated_types import Interval, Len, Unit
from pydantic import PlainValidator
from pydrake.common.schema import Transform
from pydrake.common.yaml import yaml_dump, yaml_dump_typed, yaml_load_typed
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, RigidBody, SpatialInertia
from pydrake.systems.framework import Context

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.config import (
    Configuration,
    NotNegative,
    as_plain,
    joined,
    read_yaml,
)
from atlas_drake.errors import ScenarioError, shown
from atlas_drake.robot.parsing import parse
from atlas_drake.units import Meters, Radians, Ratio
from atlas_drake.worlds.world import WorldMaker


@as_plain.register
def _(pose: Transform) -> Any:
    return read_yaml(yaml_dump_typed(pose))


def _pose(value: Any) -> Transform:
    """Reads a pose as Drake does: its rotation has several forms."""
    if isinstance(value, Transform):
        return value
    if isinstance(value, RigidTransform):
        return Transform(value)
    try:
        pose: Transform = yaml_load_typed(schema=Transform, data=yaml_dump(value))
    except Exception as error:  # Drake raises several kinds.
        why = " ".join(str(error).split())
        raise ValueError(f"is {shown(value)}; must be a pose: {why}") from error
    return pose


Pose = Annotated[Transform, PlainValidator(_pose)]
"""A pose in Drake's schema."""


@dataclass(frozen=True)
class ModelJitter(Configuration):
    """Random variations of a free model at the start, drawn from the scenario's seed.

    Every value is the half width of a uniform distribution; 0 is no variation.
    """

    position: NotNegative[Meters] = 0.0
    """Position of the base body along x and y of W."""
    yaw: NotNegative[Radians] = 0.0
    """Turn of the base body about the vertical."""
    mass: Annotated[Ratio, Interval(ge=0.0, lt=1.0)] = 0.0
    """Mass and inertia of the base body, as a share; below 1."""


class ModelDraw(NamedTuple):
    """What a run draws for one model."""

    x: float
    """Position of the base body beside its usual one, in W [m]."""
    y: float
    yaw: float
    """Turn of it [rad]."""
    mass_factor: float
    """Factor of its mass [-]."""


@dataclass(frozen=True)
class Model(Configuration):
    """One file of models, such as a table, a ball or a ramp."""

    file: str = ""
    """URDF, SDFormat, MJCF or Drake's Model Directives (``.dmd.yaml``), relative to the
    scenario's file; or a URI such as ``package://drake_models/...``."""
    name: str = ""
    """Name of the model in the plant; the file's name if left out."""
    X_WB: Pose | None = None
    """Pose of the model's base body in W, a ``Transform`` of Drake's schema, such as
    ``{translation: [1, 0, 0.5], rotation: !Rpy {deg: [0, 0, 90]}}``; null for the pose
    in the file."""
    V_WB: Annotated[list[float], Unit("rad/s; m/s"), Len(6, 6)] | None = None
    """Velocity of the base body at the start, rotation first; null for at rest."""
    weld: bool = False
    """True to fix the base body in W, at X_WB or at W's origin."""
    jitter: ModelJitter | None = None
    """Random variations at the start, so that every seed has another place or mass;
    null for none."""

    def add_to(self, plant: MultibodyPlant, name: str, path: str) -> None:
        """Adds the models of the file to a plant that is not finalized yet.

        Args:
            plant: Plant to add to.
            name: Name of the model, for a file with one model.
            path: Path of this entry in its scenario, for errors.
        """

        def refusal(field: str, problem: str) -> ScenarioError:
            return ScenarioError(joined(path, field), getattr(self, field), problem)

        try:
            instances = parse(plant, self.file)
        except RuntimeError as error:
            raise refusal("file", f"cannot be read: {error}") from None
        if len(instances) != 1:
            for field in ("name", "X_WB", "V_WB", "weld", "jitter"):
                if getattr(self, field):
                    count = len(instances)
                    raise refusal(field, f"is not for a file of {count} models")
            return
        try:
            plant.RenameModelInstance(instances[0], name)
        except RuntimeError as error:
            raise refusal("name", f"{name!r} is taken; give another name") from error
        X_WB = RigidTransform()
        if self.X_WB is not None:
            X_WB = self.X_WB.GetDeterministicValue()
        if self.weld:
            base = _base(plant, instances[0], joined(path, "weld"))
            plant.WeldFrames(plant.world_frame(), base.body_frame(), X_WB)
        elif self.X_WB is not None:
            base = _base(plant, instances[0], joined(path, "X_WB"))
            plant.SetDefaultFloatingBaseBodyPose(base, X_WB)

    def check(self) -> None:
        """Checks the fields with the file, by a plant on trial."""
        if not self.file:
            raise ScenarioError("file", self.file, "must be given")
        if "://" not in self.file and why_not_readable(Path(self.file)):
            raise ScenarioError.about("file", self.file, "there is no such file")
        X_WB = self.X_WB
        if X_WB is not None and not (
            X_WB.IsDeterministic() and X_WB.base_frame in (None, "", "world")
        ):
            raise ScenarioError(
                "X_WB", X_WB, "must be one pose in W: no distribution, no frame"
            )
        plant = MultibodyPlant(time_step=0.001)
        self.add_to(plant, "model", "")
        plant.Finalize()
        for name in ("V_WB", "jitter"):
            if getattr(self, name) and not plant.HasUniqueFloatingBaseBody(
                plant.GetModelInstanceByName("model")
            ):
                problem = "needs a model with one base body that is free"
                if self.weld:
                    problem = "is not for a welded model"
                raise ScenarioError(name, getattr(self, name), problem)

    def draw(self, random: np.random.Generator) -> ModelDraw:
        """Draws what a run varies.

        Args:
            random: Generator of the run.
        """
        jitter = self.jitter or ModelJitter()
        half = [jitter.position, jitter.position, jitter.yaw, jitter.mass]
        x, y, yaw, mass = random.uniform(np.negative(half), half).tolist()
        return ModelDraw(x, y, yaw, 1.0 + mass)


def _base(plant: MultibodyPlant, instance: ModelInstanceIndex, path: str) -> RigidBody:
    """Finds the one body of a model that is no joint's child."""
    joints = map(plant.get_joint, plant.GetJointIndices(instance))
    children = {int(joint.child_body().index()) for joint in joints}
    bodies = map(plant.get_body, plant.GetBodyIndices(instance))
    bases = [body for body in bodies if int(body.index()) not in children]
    if len(bases) != 1:
        problem = (
            f"needs a model with one base body, not {len(bases)}; leave the field out "
            "for a file that welds its model to the world"
        )
        raise ScenarioError(path, None, problem)
    return bases[0]


def world_of(models: Sequence[Model]) -> list[WorldMaker]:
    """Returns callables that add the models of a scenario to a plant."""
    return [
        functools.partial(model.add_to, name=name, path=f"models[{index}]")
        for index, (model, name) in enumerate(zip(models, _names(models), strict=True))
    ]


def begin_models(
    models: Sequence[Model],
    draws: Sequence[ModelDraw],
    plant: MultibodyPlant,
    context: Context,
) -> None:
    """Varies the models of a scenario in a plant's context, and sets them going.

    Each is in its default state before.
    """
    for model, draw, name in zip(models, draws, _names(models), strict=True):
        if not (model.V_WB or model.jitter):
            continue
        instance = plant.GetModelInstanceByName(name)
        base = plant.GetUniqueFloatingBaseBodyOrThrow(instance)
        X_WB = plant.GetFreeBodyPose(context, base)
        place = X_WB.translation() + np.array([draw.x, draw.y, 0.0])
        turned = RotationMatrix.MakeZRotation(draw.yaw) @ X_WB.rotation()
        plant.SetFreeBodyPose(context, base, RigidTransform(turned, place))
        scale_mass(base, context, draw.mass_factor)
        if model.V_WB is not None:
            V_WB = SpatialVelocity(model.V_WB[:3], model.V_WB[3:])
            plant.SetFreeBodySpatialVelocity(context, base, V_WB)


def scale_mass(body: RigidBody, context: Context, factor: float) -> None:
    """Scales the default mass and inertia of a body in a context of its plant."""
    inertia = body.default_spatial_inertia()
    mass, unit = inertia.get_mass() * factor, inertia.get_unit_inertia()
    scaled = SpatialInertia(mass, inertia.get_com(), unit)
    body.SetSpatialInertiaInBodyFrame(context, scaled)


def _names(models: Sequence[Model]) -> list[str]:
    """Names each model: its own name, or its file's name with a number if needed."""
    names: list[str] = []
    for model in models:
        stem = name = model.name or Path(model.file).name.split(".")[0]
        number = 1
        while name in names and not model.name:
            number += 1
            name = f"{stem}_{number}"
        names.append(name)
    return names
