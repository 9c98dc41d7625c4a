"""Contact forces: the sensors read Drake's own values, unchanged."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import HalfSpace, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from atlas_drake import AtlasSimulation, Scenario, SimulationError
from atlas_drake.control.wrenches import shift_wrench
from atlas_drake.scenario import with_settings
from atlas_drake.scenario.physics import plant_config
from atlas_drake.systems.contact_forces import (
    contact_forces,
    contact_wrenches,
    shapes_of,
)

HERON = Path(__file__).parents[1] / "robots/heron"


@pytest.mark.parametrize("approximation", ["lagged", "similar", "sap"])
def test_the_sensors_read_what_the_plant_exerts(approximation):
    plant = plant_config(discrete_contact_approximation=approximation)
    results = check_sensors(AtlasSimulation(Scenario(plant=plant)), 60.0)
    assert results.num_point_pair_contacts() > 4


def test_the_sensors_read_surfaces_as_well_as_points(tmp_path):
    robot = tmp_path / "heron.yaml"
    shutil.copy(HERON / "heron.yaml", robot)
    soft = "<drake:proximity_properties><drake:compliant_hydroelastic/>"
    soft += '<drake:hydroelastic_modulus value="1e8"/>'
    soft += '<drake:mesh_resolution_hint value="0.005"/>'
    text = (HERON / "heron.urdf").read_text()
    text = text.replace("<drake:proximity_properties>", soft)
    (tmp_path / "heron.urdf").write_text(text)
    scenario = with_settings(
        Scenario(model=str(robot)), ["plant.contact_model=hydroelastic_with_fallback"]
    )
    sim = AtlasSimulation(scenario)
    results = check_sensors(sim, 10.0)
    assert results.num_hydroelastic_contacts() == 8
    loads = sim.output("foot_wrenches")[[5, 11]]
    assert sum(loads) == pytest.approx(9.81 * sim.robot.mass, rel=0.1)


@pytest.mark.slow
def test_soles_touch_the_ground_at_points():
    points = Scenario(plant=plant_config(contact_model="point"))
    sims = AtlasSimulation(), AtlasSimulation(points)
    for sim in sims:
        sim.advance(0.05)
    np.testing.assert_array_equal(*(sim.output("state") for sim in sims))
    strict = Scenario(plant=plant_config(contact_model="hydroelastic"))
    # Which pair comes first is Drake's: links that overlap, or a sole and the ground.
    with pytest.raises(SimulationError, match=r"two rigid|without hydroelastic"):
        AtlasSimulation(strict).advance(0.05)


def check_sensors(sim, push):
    """Pushes the robot, and compares the forces that are read with the plant's own."""
    plant, robot = sim.plant, sim.robot
    sim.apply_push(robot.file.chest, [push, -push, 0.0], 0.1)
    sim.advance(0.051)
    context = plant.GetMyContextFromRoot(sim.context)
    results = sim.diagram.GetOutputPort("contact_results").Eval(sim.context)
    bodies = {
        int(plant.GetBodyByName(name).index()): place
        for place, name in enumerate(robot.body_names)
    }
    shapes = shapes_of(plant, bodies)
    total = np.sum(contact_wrenches(results, bodies, shapes, {}), axis=0)
    pelvis = plant.GetBodyByName(robot.file.pelvis)
    shift_wrench(total, plant.EvalBodyPoseInWorld(context, pelvis).translation())
    # The floating base's generalized forces are the wrench about its origin.
    port = plant.get_generalized_contact_forces_output_port(pelvis.model_instance())
    exerted = port.Eval(context)[:6]
    assert np.linalg.norm(exerted[3:5]) > 0.1 * push
    np.testing.assert_allclose(total, exerted, atol=1e-6)
    inspector = sim.output("query_object").inspector()
    forces = contact_forces(results, inspector)
    arrows = np.sum([force.force_W for force in forces], axis=0)
    np.testing.assert_allclose(arrows, exerted[3:], atol=20.0)
    return results


def test_an_arrow_points_down_where_friction_does():
    """On a steep and rough slope friction pulls down more than the contact lifts."""
    builder = DiagramBuilder()
    config = MultibodyPlantConfig(
        discrete_contact_approximation="sap",
        contact_model="point",
        use_sampled_output_ports=False,
    )
    plant, _ = AddMultibodyPlant(config, builder)
    inertia = SpatialInertia(20.0, np.zeros(3), UnitInertia.SolidSphere(0.1))
    ball, rough = plant.AddRigidBody("ball", inertia), CoulombFriction(2.0, 2.0)
    R_WS, radius = RotationMatrix.MakeYRotation(-1.2), 0.01
    plant.RegisterCollisionGeometry(
        ball, RigidTransform(), Sphere(radius), "ball", rough
    )
    plant.RegisterCollisionGeometry(
        plant.world_body(), RigidTransform(R_WS), HalfSpace(), "plane", rough
    )
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    place = R_WS @ np.array([0.0, 0.0, radius - 1e-4])
    plant.SetPositions(context, np.concatenate([[1.0, 0.0, 0.0, 0.0], place]))
    velocity = R_WS @ np.array([1.0, 0.0, -0.3])
    plant.SetVelocities(context, np.concatenate([np.zeros(3), velocity]))
    simulator.Initialize()
    query = plant.get_geometry_query_input_port().Eval(context)
    results = plant.get_contact_results_output_port().Eval(context)
    (force,) = contact_forces(results, query.inspector())
    assert force.force_W[2] < 0.0
    assert force.force_W @ R_WS.matrix()[:, 2] > 0.0
