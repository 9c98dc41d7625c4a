"""What several test files share."""

import pytest


@pytest.fixture
def summary_keys():
    """What a summary holds at least."""
    return {
        "success",
        "fell",
        "model",
        "seed",
        "sim_time",
        "wall_time",
        "real_time_factor",
        "physics_step",
        "control_period",
        "controller_tick_ms",
        "min_pelvis_height",
        "max_pelvis_tilt_rad",
        "final_pelvis_pose",
        "footsteps",
        "peak_effort_fraction",
        "events",
    }
