"""A report of a robot, for what plans by reports."""

import pytest

from atlas_drake.messages import AtlasSimInterfaceState, Behavior


@pytest.fixture
def standing():
    """A report of a robot that stands at the origin and looks along x."""
    report = AtlasSimInterfaceState()
    report.current_behavior = report.desired_behavior = Behavior.STAND
    for pose, y in zip(report.foot_pos_est, (0.12, -0.12), strict=True):
        pose.position.y = y
    return report
