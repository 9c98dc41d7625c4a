"""Contact between chosen bodies: Drake's own sums, in port, record and log."""

import numpy as np
import pytest
from pydrake.multibody.math import SpatialVelocity

from atlas_drake import AtlasSimulation, Scenario, ScenarioError, read_log
from atlas_drake.units import GRAVITY
from atlas_drake.worlds.models import Model

CRATE = "models/worlds/crate.sdf"
MASS = 10.0


@pytest.mark.slow
def test_pairs_are_what_the_plant_exerts():
    """The crate slides on the table on a surface, the soles are on points."""
    pairs = [["crate", "world"], ["world", "crate"], ["l_foot"], ["l_foot", "crate"]]
    sim = AtlasSimulation(Scenario(world="tables", contacts=pairs))
    sim.advance(34 * 0.009)
    context = sim.plant.GetMyMutableContextFromRoot(sim.context)
    crate = sim.plant.GetBodyByName("crate")
    sliding = SpatialVelocity([0.0, 0.0, 1.0], [0.6, 0.3, 0.0])
    sim.plant.SetFreeBodySpatialVelocity(context, crate, sliding)
    sim.advance(0.027)
    exerted = sim.plant.get_generalized_contact_forces_output_port(
        crate.model_instance()
    ).Eval(context)
    sim.advance(0.009)
    on_crate, on_world, on_foot, nothing = sim.output("contact_pairs").reshape(-1, 6)
    assert np.linalg.norm(exerted[3:5]) > 0.3 * MASS * GRAVITY
    np.testing.assert_allclose(on_crate, exerted, rtol=0.02, atol=0.2)
    np.testing.assert_allclose(on_world[3:], -on_crate[3:])
    # The wrench on the world is about the origin of W.
    p_WC = sim.plant.EvalBodyPoseInWorld(context, crate).translation()
    about_crate = on_world[:3] - np.cross(p_WC, on_world[3:])
    np.testing.assert_allclose(about_crate, -on_crate[:3], atol=0.5)
    np.testing.assert_allclose(on_foot[3:], sim.output("foot_wrenches")[3:6])
    assert not nothing.any()


def test_pairs_are_in_record_and_log(tmp_path):
    path = tmp_path / "run.mcap"
    contacts = [["l_foot", "world"], ["r_foot"]]
    with AtlasSimulation(Scenario(contacts=contacts), log=path) as sim:
        sim.advance(0.1)
        sums, feet = sim.record.contact_pairs, sim.record.feet
        np.testing.assert_array_equal(sums.force, [feet.left_force, feet.right_force])
        sim.reset()
        assert not sim.output("contact_pairs").any()
    log = read_log(path)
    loads = log["contact_pairs.force.l_foot-world.z"]
    np.testing.assert_array_equal(loads, log["feet.left_force.z"])
    assert log.units["contact_pairs.torque.r_foot.x"] == "N·m"
    assert sums in [record.contact_pairs for record in log.records()]


@pytest.mark.parametrize(
    ("names", "problem"),
    [
        (["l_hnad"], r"contacts.*'l_hnad'; .* mean 'l_hand'"),
        (["l_foot", "box"], "there is no such body"),
        (["crate"], "several models have such a body: say MODEL::crate"),
        (["a", "b", "c"], "at most 2"),
    ],
)
def test_a_body_that_is_not_there_is_named(names, problem):
    models = [Model(file=CRATE, name=name) for name in ("one", "other")]
    scenario = Scenario(models=models, contacts=[["one::crate"], names])
    with pytest.raises(ScenarioError, match=problem):
        AtlasSimulation(scenario)
