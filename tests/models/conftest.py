"""Fixtures for tests of the robot models; no test is here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import HalfSpace, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import JointActuator, ModelInstanceIndex
from pydrake.systems.framework import Context, Diagram, DiagramBuilder

REPOSITORY = Path(__file__).parents[2]
MODELS = REPOSITORY / "models"
ROBOTS = ("atlas", "atlas_v3")

TIME_STEP = 0.002
GROUND_FRICTION = 0.9


@dataclass
class LoadedRobot:
    """One robot in a diagram of its own, with or without a ground to stand on."""

    name: str
    diagram: Diagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    instance: ModelInstanceIndex

    def __post_init__(self) -> None:
        self.context: Context = self.diagram.CreateDefaultContext()
        self.plant_context: Context = self.plant.GetMyMutableContextFromRoot(
            self.context
        )

    @property
    def actuators(self) -> list[JointActuator]:
        """All actuators, in the order of their indices."""
        indices = self.plant.GetJointActuatorIndices()
        return [self.plant.get_joint_actuator(index) for index in indices]

    def set_pose(self, joint_positions: np.ndarray, X_WB: RigidTransform) -> None:
        """Places the pelvis, and the joints in the order of the actuators."""
        positions = np.zeros(self.plant.num_positions())
        for actuator, value in zip(self.actuators, joint_positions, strict=True):
            positions[actuator.joint().position_start()] = value
        self.plant.SetPositions(self.plant_context, positions)
        pelvis = self.plant.GetBodyByName("pelvis")
        self.plant.SetFreeBodyPose(self.plant_context, pelvis, X_WB)

    def colliding(self) -> list[tuple[str, str]]:
        """Returns the pairs of links that penetrate each other."""
        query = self.scene_graph.get_query_output_port().Eval(
            self.scene_graph.GetMyContextFromRoot(self.context)
        )
        inspector = query.inspector()

        def link(geometry: object) -> str:
            frame = inspector.GetFrameId(geometry)
            return self.plant.GetBodyFromFrameId(frame).name()

        pairs = query.ComputePointPairPenetration()
        return [
            tuple(sorted((link(pair.id_A), link(pair.id_B))))  # type: ignore[misc]
            for pair in pairs
        ]


def load(name: str, *, ground: bool = False) -> LoadedRobot:
    """Loads one robot."""
    builder = DiagramBuilder()
    config = MultibodyPlantConfig(
        time_step=TIME_STEP, discrete_contact_approximation="lagged"
    )
    plant, scene_graph = AddMultibodyPlant(config, builder)
    (instance,) = Parser(plant).AddModels(str(MODELS / f"{name}.urdf"))
    if ground:
        plant.RegisterCollisionGeometry(
            plant.world_body(),
            RigidTransform(),
            HalfSpace(),
            "ground",
            CoulombFriction(GROUND_FRICTION, GROUND_FRICTION),
        )
    plant.Finalize()
    return LoadedRobot(name, builder.Build(), plant, scene_graph, instance)


@pytest.fixture(params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> LoadedRobot:
    """Each robot in turn, freshly loaded, without a ground."""
    return load(request.param)


@pytest.fixture(params=ROBOTS)
def grounded_robot(request: pytest.FixtureRequest) -> LoadedRobot:
    """Each robot in turn, freshly loaded, above a ground at z = 0."""
    return load(request.param, ground=True)


@pytest.fixture
def stand_prep() -> np.ndarray:
    """Pose from which standing can begin, as the tutorial sends it [rad]."""
    return np.array(
        [
            *(2.438504816382192e-05, 0.0015186156379058957, 9.983908967114985e-06),
            -0.0010675729718059301,
            *(-0.0003740221436601132, 0.06201673671603203, -0.2333149015903473),
            *(0.5181407332420349, -0.27610817551612854, -0.062101610004901886),
            *(0.00035181696875952184, -0.06218484416604042, -0.2332201600074768),
            *(0.51811283826828, -0.2762000858783722, 0.06211360543966293),
            *(0.29983898997306824, -1.303462266921997, 2.0007927417755127),
            *(0.49823325872421265, 0.0003098883025813848, -0.0044272784143686295),
            *(0.29982614517211914, 1.3034454584121704, 2.000779867172241),
            *(-0.498238742351532, 0.0003156556049361825, 0.004448802210390568),
        ]
    )


@pytest.fixture
def models_folder() -> Path:
    """Folder that holds the robots' URDF files."""
    return MODELS
