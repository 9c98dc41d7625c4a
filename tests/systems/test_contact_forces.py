"""Contact forces: Drake's own law, and its unchanged values in the sensors."""

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
from atlas_drake.scenario.drake_configs import plant_config
from atlas_drake.systems.robot_sensors import contact_wrenches, shapes_of
from atlas_drake.visualization.overlay_shapes import contact_forces_of

MU = 0.9
STIFFNESS, DISSIPATION = 5e5, 50.0
"""Of two of Drake's default surfaces in series [N/m], [s/m]."""
RADIUS = 0.01
HERON = Path(__file__).parents[1] / "robots/heron"


class SlidingBall:
    """A heavy ball on a plane, in plain Drake; nothing of this project is in it."""

    def __init__(self, approximation, velocity, slope=0.0, mu=MU, step=0.001):
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlant(
            MultibodyPlantConfig(
                time_step=step,
                discrete_contact_approximation=approximation,
                contact_model="point",
                use_sampled_output_ports=False,
            ),
            builder,
        )
        ball = plant.AddRigidBody(
            "ball",
            SpatialInertia(20.0, np.zeros(3), UnitInertia.SolidSphere(0.1)),
        )
        surface = CoulombFriction(mu, mu)
        self.R_WS = RotationMatrix.MakeYRotation(-slope)
        plant.RegisterCollisionGeometry(
            ball, RigidTransform(), Sphere(RADIUS), "ball", surface
        )
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(self.R_WS), HalfSpace(), "plane", surface
        )
        plant.Finalize()
        self.plant, self.step = plant, step
        self.simulator = Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(
            self.simulator.get_mutable_context()
        )
        place = self.R_WS @ np.array([0.0, 0.0, RADIUS - 1e-4])
        plant.SetPositions(self.context, np.concatenate([[1.0, 0.0, 0.0, 0.0], place]))
        velocities = np.concatenate([np.zeros(3), self.R_WS @ np.array(velocity)])
        plant.SetVelocities(self.context, velocities)
        self.simulator.Initialize()

    def results(self):
        """The contacts of the step that begins now."""
        return self.plant.get_contact_results_output_port().Eval(self.context)

    def law(self):
        """Normal force, friction, and the normal force as the step begins [N]."""
        info = self.results().point_pair_contact_info(0)
        normal = self.R_WS.matrix()[:, 2]
        force = np.array(info.contact_force())
        along = force @ normal
        friction = np.linalg.norm(force - along * normal)
        rate = self.plant.GetVelocities(self.context)[3:] @ normal
        depth = info.point_pair().depth
        first = STIFFNESS * depth * max(0.0, 1.0 - DISSIPATION * rate)
        return abs(along), friction, first

    def advance(self):
        self.simulator.AdvanceTo(self.simulator.get_context().get_time() + self.step)


@pytest.mark.parametrize("approximation", ["lagged", "similar", "sap"])
def test_only_lagged_friction_may_pass_coulombs_bound(approximation):
    ball = SlidingBall(approximation, [1.0, 0.0, -0.3])
    beyond = 0.0
    for _ in range(20):
        if ball.results().num_point_pair_contacts():
            normal, friction, first = ball.law()
            beyond = max(beyond, friction - MU * normal)
            if approximation == "lagged":
                # Its bound is the normal force at the state that the step begins with.
                assert friction <= MU * first + 1e-6
        ball.advance()
    if approximation == "lagged":
        assert beyond > 100.0
    else:
        assert beyond < 1e-6


@pytest.mark.parametrize("approximation", ["lagged", "similar", "sap"])
def test_the_sensors_read_what_the_plant_exerts(approximation):
    plant = plant_config(discrete_contact_approximation=approximation)
    results = check_sensors(AtlasSimulation(Scenario(plant=plant)), 60.0)
    assert results.num_point_pair_contacts() == 8


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


def test_without_surfaces_contact_falls_back_to_points_or_ends_the_run():
    surfaces = Scenario(plant=plant_config(contact_model="hydroelastic_with_fallback"))
    sims = AtlasSimulation(), AtlasSimulation(surfaces)
    for sim in sims:
        sim.advance(0.05)
    np.testing.assert_array_equal(*(sim.output("state") for sim in sims))
    strict = Scenario(plant=plant_config(contact_model="hydroelastic"))
    with pytest.raises(SimulationError, match="without hydroelastic representation"):
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
    total = np.sum(contact_wrenches(results, bodies, shapes), axis=0)
    pelvis = plant.GetBodyByName(robot.file.pelvis)
    shift_wrench(total, plant.EvalBodyPoseInWorld(context, pelvis).translation())
    # The floating base's generalized forces are the wrench about its origin.
    port = plant.get_generalized_contact_forces_output_port(pelvis.model_instance())
    exerted = port.Eval(context)[:6]
    assert np.linalg.norm(exerted[3:5]) > 0.1 * push
    np.testing.assert_allclose(total, exerted, atol=1e-6)
    inspector = sim.output("query_object").inspector()
    forces = contact_forces_of(results, inspector)
    arrows = np.sum([force.force_W for force in forces], axis=0)
    np.testing.assert_allclose(arrows, exerted[3:], atol=20.0)
    return results


def test_an_arrow_points_down_where_friction_does():
    # Up a steep and rough slope friction holds the ball back more than it is borne.
    ball = SlidingBall("sap", [1.0, 0.0, -0.3], slope=1.2, mu=2.0)
    query = ball.plant.get_geometry_query_input_port().Eval(ball.context)
    (force,) = contact_forces_of(ball.results(), query.inspector())
    assert force.force_W[2] < 0.0
    assert force.force_W @ ball.R_WS.matrix()[:, 2] > 0.0
