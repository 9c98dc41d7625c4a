"""The tutorial and a push with the estimated state; walks are in test_walking."""

import pytest

from atlas_drake import AtlasSimulation, Scenario

pytestmark = pytest.mark.slow

LANDING_ERROR = 0.02
"""As on the true state: where the robot believes its feet to have landed [m]."""


def assert_drifted_by_at_most(sim, position, velocity):
    """Whatever the sensors' noise, tilt and heading stay within 1 mrad."""
    drift = sim.summary()["estimator_drift"]
    assert 0.0 < drift["final"]["position_m"] <= drift["largest"]["position_m"]
    assert drift["largest"]["position_m"] < position
    assert drift["largest"]["velocity_m_s"] < velocity
    assert drift["largest"]["tilt_rad"] < 1.5e-3
    assert drift["largest"]["yaw_rad"] < 1e-3


def test_the_tutorial():
    sim = AtlasSimulation(
        Scenario(
            programme="tutorial",
            state="estimated",
            noise="rough",
            seed=1,
        )
    )
    sim.advance_to(13.6)
    summary = sim.summary()
    assert summary["success"]
    assert len(sim.footsteps) == 4
    assert max(step["error_m"] for step in sim.footsteps) < LANDING_ERROR
    assert_drifted_by_at_most(sim, position=0.012, velocity=0.03)


def test_a_push_on_the_standing_robot_is_caught():
    sim = AtlasSimulation(Scenario(state="estimated", noise="none"))
    sim.advance(1.0)
    sim.apply_push("utorso", [0.0, 120.0, 0.0], 0.2)
    sim.advance(2.5)
    assert not sim.has_fallen
    assert_drifted_by_at_most(sim, position=0.01, velocity=0.03)
