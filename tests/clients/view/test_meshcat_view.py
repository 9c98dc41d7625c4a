"""The 3D view: its contents, live and in a recording, and that it changes no run."""

import numpy as np
import pytest
from pydrake.geometry import Meshcat
from pydrake.math import RigidTransform

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
)
from atlas_drake.clients.view.colors import COVER
from atlas_drake.clients.view.meshcat_shapes import (
    PATH,
    SPARE,
    MeshcatShapes,
    Visibility,
)
from atlas_drake.clients.view.overlays import OVERLAYS, Overlays, overlays_from
from atlas_drake.clients.view.shapes import Shape
from atlas_drake.clients.view.solids import Solid, polygon
from atlas_drake.palette import COM

LINK = "/drake/visualizer/atlas/l_uarm/atlas/l_uarm_visual"
SWINGING = 1.5
"""When a foot is in the air if WALK is asked for at the start [s]."""


class Recording:
    """A Meshcat that plays properties back as a browser does."""

    def __init__(self):
        self.keys, self.unrecorded, self.drawn, self.deleted = {}, {}, [], []

    def SetProperty(self, path, name, value, time=None):
        if time is None:
            self.unrecorded[path, name] = value
        else:
            self.keys.setdefault((path, name), {})[time] = value

    def SetTransform(self, path, pose, time):
        self.keys.setdefault((path, "pose"), {})[time] = pose

    def SetTriangleMesh(self, path, *_):
        self.drawn.append(path.removesuffix("/solid"))

    def Delete(self, path):
        self.deleted.append(path)
        self.drawn = [one for one in self.drawn if not one.startswith(path)]

    def visible(self, time):
        """Paths of the objects that are seen; a first key holds from the beginning."""
        seen = set()
        for path, name in self.keys:
            if name == "visible" and path in self.drawn:
                keys = sorted(self.keys[path, name].items())
                if ([keys[0][1]] + [shown for at, shown in keys if at <= time])[-1]:
                    seen.add(path)
        return seen


def mark(name, x=0.0, pose=None):
    """A triangle at a place of its own."""
    corners = np.array([[x, x + 1.0, x], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    return Shape(name, Solid(polygon(corners), COM), pose or RigidTransform())


def test_an_object_that_changes_later_was_different_before():
    recording = Recording()
    recording.drawn = ["/late", "/link", "/start"]
    visibility = Visibility(recording)
    visibility.show("/start", True, 0.0)
    for time, shown in ((2.0, True), (3.0, True), (4.0, False)):
        visibility.show("/late", shown, time)
        visibility.show("/link", not shown, time)
    both = {"/late", "/link"}
    for time, seen in ((0.0, {"/link"}), (1.9, {"/link"}), (2.0, {"/late"})):
        assert recording.visible(time) & both == seen, time
    assert recording.visible(4.0) & both == {"/link"}
    assert recording.keys["/start", "visible"] == {0.0: True}
    assert len(recording.keys["/late", "visible"]) == 3
    # Nor is it there while the recording is being loaded.
    assert recording.unrecorded["/late", "visible"] is False


def test_a_recording_shows_each_shape_at_its_time():
    recording = Recording()
    shapes = MeshcatShapes(recording, True)
    for time, x in ((0.0, 1.0), (1.0, 2.0), (2.0, 1.0), (3.0, 1.0)):
        shapes.show([mark("step", x)], time)
    first, second = recording.drawn
    seen = [recording.visible(time) for time in (0.0, 1.0, 2.0, 3.0)]
    assert seen == [{first}, {second}, {first}, {first}]


def test_a_shape_that_moves_keeps_its_object():
    recording = Recording()
    shapes = MeshcatShapes(recording, True)
    for time in (0.0, 1.0):
        pose = RigidTransform([1.0 + time, 0.0, 0.0])
        shapes.show([mark("disc", pose=pose)._replace(length=2.0)], time)
    (path,) = recording.drawn
    poses = recording.keys[path, "pose"]
    assert [poses[t].translation()[0] for t in (0.0, 1.0)] == [1.0, 2.0]
    assert recording.keys[f"{path}/solid", "scale"][1.0] == [1.0, 1.0, 2.0]


def test_a_new_run_draws_anew():
    recording = Recording()
    shapes = MeshcatShapes(recording, True)
    shapes.show([mark("step")], 5.0)
    shapes.show([mark("step")], 0.0)
    assert recording.deleted == [PATH, PATH]
    assert len(recording.drawn) == 1


@pytest.mark.parametrize("recorded", [False, True])
def test_few_hidden_objects_are_kept_unless_recorded(recorded):
    recording = Recording()
    shapes = MeshcatShapes(recording, recorded)
    always = mark("always")
    for time, number in enumerate([*range(50), 0, 49]):
        shapes.show([mark("step", float(number)), always], float(time))
        assert len(recording.visible(time)) == 2
    assert len(recording.drawn) == (51 if recorded else SPARE + 2)
    assert len({*recording.drawn}) == len(recording.drawn)


def test_the_view_has_robot_ground_and_footsteps():
    meshcat = Meshcat()
    sim = AtlasSimulation(view=meshcat)
    sim.advance_to(0.1)
    for path in ("/drake/visualizer", "/atlas_drake/ground/bold"):
        assert meshcat.HasPath(path), path
    assert not meshcat.HasPath(PATH)
    command = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    for place in range(2):
        step = AtlasBehaviorStepData()
        step.step_index, step.foot_index, step.duration = place + 1, place, 0.63
        step.pose.position.y = 0.12 if place == 0 else -0.12
        step.swing_height = 0.1
        command.walk_params.step_queue[place] = step
    sim.publish(command)
    sim.advance_to(0.15)
    assert meshcat.HasPath(f"{PATH}/footsteps/0")
    assert meshcat.HasPath(f"{PATH}/footsteps/1")


@pytest.mark.slow
def test_links_are_covered_by_copies_while_they_are_colored():
    meshcat, overlays = Meshcat(), Overlays(["owner"])
    sim = AtlasSimulation(view=meshcat, overlays=overlays)
    for _ in range(2):
        sim.advance(0.04)
        assert meshcat.HasPath(f"{LINK}{COVER}/0")
        assert not meshcat.HasPath(f"{LINK}{COVER}/1")  # All are the behavior's.
        assert visible(meshcat, f"{LINK}{COVER}/0")
        assert not visible(meshcat, LINK)
        sim.reset()  # Drake's visualizer begins anew.
    overlays.switch("owner", False)
    sim.advance(0.04)
    assert visible(meshcat, LINK)


def visible(meshcat, path):
    """Whether Meshcat shows an object; a message ends with its value."""
    return meshcat._GetPackedProperty(path, "visible")[-1:] != b"\xc2"


def test_a_simulation_opens_its_view_and_prints_the_address(capsys):
    sim = AtlasSimulation(view=True)
    address = sim.meshcat.web_url()
    assert f"Watch at {address}\n" in capsys.readouterr().out
    assert address.startswith("http://localhost:")
    assert sim.realtime_rate == 1.0
    assert sim.meshcat.HasPath("/drake/visualizer")


@pytest.mark.slow
def test_a_walk_has_a_plan_and_a_swing_that_overlays_show_once_switched_on():
    meshcat, overlays = Meshcat(), Overlays()
    sim = AtlasSimulation(view=meshcat, overlays=overlays)
    command = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    sim.advance_to(SWINGING)
    record, planned = sim.record, sim.output("planned_paths")
    assert len(planned.com) == len(planned.dcm) == len(planned.cop) > 10
    np.testing.assert_allclose(planned.dcm[0], record.balance.dcm_reference, atol=0.01)
    # Both come to rest over the same point.
    np.testing.assert_allclose(planned.com[-1], planned.dcm[-1], atol=0.05)
    step = record.footsteps[0]
    foot = record.feet.positions[step.foot]
    assert np.linalg.norm(planned.swing - foot, axis=1).min() < 0.03
    np.testing.assert_allclose(planned.swing[-1][:2], step.p_WF[:2], atol=0.005)
    assert planned.swing[:, 2].max() > 0.05
    assert record.balance.support.shape[1] == 2
    names = ("support", "plan_com", "plan_dcm", "swing", "com_ball", "cop", "forces/0")
    assert not any(meshcat.HasPath(f"{PATH}/{name}") for name in names)
    for name in overlays_from("all"):
        overlays.switch(name, True)
    sim.advance(0.15)
    assert [name for name in names if not meshcat.HasPath(f"{PATH}/{name}")] == []


@pytest.mark.slow
def test_a_view_does_not_change_the_motion():
    scenario = Scenario(noise="reference", seed=3)
    seen = AtlasSimulation(scenario, view=Meshcat(), overlays=Overlays(OVERLAYS))
    plain = AtlasSimulation(scenario)
    for sim in (seen, plain):
        sim.advance_to(0.1)
    assert np.array_equal(seen.output("state"), plain.output("state"))
