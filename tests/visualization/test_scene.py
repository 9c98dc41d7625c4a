"""The 3D view's first camera: beside the robot, or where a world has it."""

import numpy as np
import pytest

from atlas_drake import Scenario, Start
from atlas_drake.scenario.world_file import load_world
from atlas_drake.visualization.scene import (
    CAMERA_POSITION,
    CAMERA_TARGET,
    show_start,
)


class Camera:
    """Remembers where it was put, as a Meshcat would."""

    def SetCameraPose(self, lens, target):
        self.lens, self.target = lens, target


@pytest.mark.parametrize(
    ("scenario", "place"),
    [
        (Scenario(), [0.0, 0.0, 0.0]),
        (Scenario(start=Start(position=[2.0, -1.0])), [2.0, -1.0, 0.0]),
        (
            Scenario(world={"name": "qual_task_1", "view": None}),
            [-0.5, 0.0, 1.0],
        ),
    ],
)
def test_the_view_begins_beside_the_robot(scenario, place):
    camera = Camera()
    show_start(camera, scenario.validate())
    np.testing.assert_allclose(camera.lens, CAMERA_POSITION + place)
    np.testing.assert_allclose(camera.target, CAMERA_TARGET + place)


def test_a_world_may_say_where_the_view_begins():
    camera = Camera()
    show_start(camera, Scenario(world="stairs").validate())
    view = load_world("stairs").view
    assert camera.lens.tolist() == view.lens
    assert camera.target.tolist() == view.target
