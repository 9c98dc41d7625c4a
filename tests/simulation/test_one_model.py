"""The plants of a run: that of the simulation, and one model of the robot alone."""

import pytest
from pydrake.geometry import Meshcat

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.robot import Robot


@pytest.mark.parametrize("state", ["true", "estimated"])
def test_a_run_with_log_and_view_has_two_plants_with_the_robot(
    monkeypatch, tmp_path, state
):
    plants = []
    add_to = Robot.add_to

    def counted(self, plant):
        plants.append(plant)
        return add_to(self, plant)

    monkeypatch.setattr(Robot, "add_to", counted)
    log = tmp_path / "run.mcap"
    with AtlasSimulation(Scenario(state=state), log=log, view=Meshcat()) as sim:
        sim.advance(0.05)
        sim.summary()
        assert sim.plant in plants
    assert len(plants) <= 2
