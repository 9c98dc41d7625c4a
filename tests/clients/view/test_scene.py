"""The scene of the 3D view: its first camera, and that it goes with the robot."""

import struct

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import AtlasSimulation, Scenario, Start
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.scene import (
    GROUND,
    SUN,
    SUN_POSITION,
    USUAL,
    Following,
    show_start,
)
from atlas_drake.worlds.world_file import load_world


class Camera:
    """Remembers where it was put, as a Meshcat would."""

    def SetCameraPose(self, lens, target):
        self.lens, self.target = lens, target

    def SetTransform(self, path, pose):
        pass

    def SetProperty(self, path, name, value):
        pass


@pytest.mark.parametrize(
    ("scenario", "place"),
    [
        (Scenario(), [0.0, 0.0, 0.0]),
        (Scenario(start=Start(position=[2.0, -1.0])), [2.0, -1.0, 0.0]),
        (Scenario(world={"name": "qual_task_1", "view": None}), [-0.5, 0.0, 1.0]),
    ],
)
def test_the_view_begins_beside_the_robot_unless_the_world_has_a_view(scenario, place):
    camera = Camera()
    show_start(camera, Scenario(world="stairs").validate())
    view = load_world("stairs").view
    assert (camera.lens.tolist(), camera.target.tolist()) == (view.lens, view.target)
    show_start(camera, scenario.validate())
    np.testing.assert_allclose(camera.lens, np.add(USUAL.lens, place))
    np.testing.assert_allclose(camera.target, np.add(USUAL.target, place))


def doubles(packed, count):
    """The last numbers of a message in MessagePack."""
    return [n for (n,) in struct.iter_unpack(">xd", packed[-9 * count :])]


def test_ground_grid_and_lamp_go_with_the_robot():
    meshcat = Meshcat()
    AtlasSimulation(Scenario(start=Start(position=[8.3, -4.8])), view=meshcat)
    # By whole squares, so that the lines stay where they were.
    assert doubles(meshcat._GetPackedTransform(GROUND), 16)[12:14] == [8.0, -5.0]
    lamp = doubles(meshcat._GetPackedProperty(SUN, "position"), 3)
    assert lamp == pytest.approx(SUN_POSITION + np.array([8.3, -4.8, 0.0]), abs=0.05)


def test_the_camera_follows_the_pelvis_over_the_ground_if_asked_to(record_of):
    feet = {"left_position": np.array([2.0, 0.1, 0.2])}
    feet["right_position"] = np.array([2.0, -0.1, 0.3])
    record = record_of(pelvis={"position": np.array([2.0, 0.0, 0.9])}, feet=feet)
    for overlays, place in (([], None), (["follow"], [2.0, 0.0, 0.2])):
        camera = Camera()
        Following(camera, Overlays(overlays)).show(record)
        assert hasattr(camera, "target") == (place is not None)
    np.testing.assert_allclose(camera.target, np.add(USUAL.target, place))
