"""Fixtures for tests of the robot models; no test is here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import JointActuator, ModelInstanceIndex
from pydrake.systems.framework import Context, Diagram, DiagramBuilder

from atlas_drake.robot import load_robot

MODELS = Path(__file__).parents[2] / "models"
ROBOTS = ("atlas", "atlas_v3")


@dataclass
class LoadedRobot:
    """One robot in a diagram of its own."""

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


@pytest.fixture(params=ROBOTS, scope="package")
def robot(request: pytest.FixtureRequest) -> LoadedRobot:
    """Each robot in turn; each test sets the pose it needs."""
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.002)
    (instance,) = Parser(plant).AddModels(str(MODELS / f"{request.param}.urdf"))
    plant.Finalize()
    return LoadedRobot(request.param, builder.Build(), plant, scene_graph, instance)


@pytest.fixture(scope="session")
def stand_prep() -> np.ndarray:
    """Pose from which standing can begin [rad]."""
    return load_robot().stand_prep
