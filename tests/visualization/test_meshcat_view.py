"""The 3D view as a whole: its contents, and a run that does not depend on it."""

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
)
from atlas_drake.visualization.marks import PERIOD, SPARE, Marks, Timeline
from atlas_drake.visualization.scene import CAMERA

SHORT = 0.1


class Recording:
    """Plays properties back as a browser does."""

    def __init__(self):
        self.keys, self.unrecorded = {}, {}

    def SetProperty(self, path, name, value, time=None):
        if time is None:
            self.unrecorded[path, name] = value
            return
        self.keys.setdefault((path, name), {})[time] = value

    def visible(self, path, time):
        """Switches hold until the next one; the first counts from the beginning."""
        keys = sorted(self.keys[path, "visible"].items())
        return ([keys[0][1]] + [value for at, value in keys if at <= time])[-1]

    def number(self, path, name, time):
        """Numbers fade from key to key."""
        keys = sorted(self.keys[path, name].items())
        return float(np.interp(time, *zip(*keys, strict=True)))


class Recorder:
    """A Meshcat that only remembers what it is told."""

    def __init__(self):
        self.deleted = []
        self.properties = []

    def Delete(self, path):
        self.deleted.append(path)

    def SetProperty(self, path, name, value, time=None):
        self.properties.append((path, name, value, time))


def test_an_object_shown_later_is_hidden_before():
    recording = Recording()
    timeline = Timeline(recording)
    timeline.show("/late", True, 2.0)
    timeline.show("/late", True, 3.0)
    timeline.show("/late", False, 4.0)
    seen = [recording.visible("/late", time) for time in (0.0, 1.9, 2.0, 3.9, 4.0)]
    assert seen == [False, False, True, True, False]
    assert len(recording.keys["/late", "visible"]) == 3
    # Nor is it while the recording is being loaded.
    assert recording.unrecorded == {("/late", "visible"): False}


def test_an_object_hidden_later_is_shown_before():
    recording = Recording()
    timeline = Timeline(recording)
    timeline.show("/link", False, 2.0)
    assert recording.visible("/link", 0.0)
    assert not recording.visible("/link", 2.0)


def test_an_object_shown_from_the_beginning_has_one_key():
    recording = Recording()
    Timeline(recording).show("/start", True, 0.0)
    assert recording.keys == {("/start", "visible"): {0.0: True}}


def test_a_number_stays_until_the_next_one():
    recording = Recording()
    timeline = Timeline(recording)
    for picture in range(100):
        timeline.jump("/link", "red", 0.2 if picture < 60 else 0.9, picture * PERIOD)
    assert len(recording.keys["/link", "red"]) == 3
    for picture, red in ((0, 0.2), (30, 0.2), (59, 0.2), (60, 0.9), (99, 0.9)):
        shown = recording.number("/link", "red", picture * PERIOD)
        assert shown == pytest.approx(red), picture


def test_marks_are_drawn_once_and_then_shown_or_hidden():
    recorder, drawn = Recorder(), []
    marks = Marks(
        recorder, "/marks", lambda path, mark: drawn.append((path, mark)), True
    )
    marks.show(["a"], 0.0)
    marks.show(["b"], 1.0)
    marks.show(["a"], 2.0)
    marks.show(["a"], 3.0)
    assert drawn == [("/marks/0", "a"), ("/marks/1", "b")]
    assert recorder.properties == [
        ("/marks/0", "visible", True, 0.0),
        ("/marks/0", "visible", False, 1.0),
        # Where a recording begins b is yet to come.
        ("/marks/1", "visible", False, 0.0),
        ("/marks/1", "visible", False, None),
        ("/marks/1", "visible", True, 1.0),
        ("/marks/1", "visible", False, 2.0),
        ("/marks/0", "visible", True, 2.0),
    ]


def test_a_new_run_deletes_the_marks():
    recorder, drawn = Recorder(), []
    marks = Marks(recorder, "/marks", lambda path, _mark: drawn.append(path), True)
    marks.show(["a"], 5.0)
    recorder.deleted.clear()
    marks.show(["a"], 0.0)
    assert recorder.deleted == ["/marks"]
    assert drawn == ["/marks/0", "/marks/0"]


@pytest.mark.parametrize("recorded", [False, True])
def test_marks_are_reused_unless_recorded(recorded):
    recorder, drawn = Recorder(), {}
    marks = Marks(recorder, "/marks", drawn.__setitem__, recorded)
    seen = {}
    for number in range(100):
        marks.show([number, "always"], float(number))
        for path, name, value, _time in recorder.properties:
            if name == "visible":
                seen[path] = value
        visible = {drawn[path] for path, shown in seen.items() if shown}
        assert visible == {number, "always"}
    assert len(drawn) == (101 if recorded else SPARE + 2)


def test_a_reused_mark_may_be_drawn_again():
    recorder, drawn = Recorder(), {}
    marks = Marks(recorder, "/marks", drawn.__setitem__, False)
    for time, number in enumerate([*range(50), 0, 49]):
        marks.show([number], float(time))
    path, _, visible, _ = recorder.properties[-1]
    assert (drawn[path], visible) == (49, True)
    assert 0 in drawn.values()


def test_the_view_has_robot_ground_caption_and_footsteps():
    meshcat = Meshcat()
    sim = AtlasSimulation(view=meshcat)
    sim.advance_to(SHORT)
    for path in (
        "/drake/visualizer",
        "/atlas_drake/ground/slab",
        "/atlas_drake/ground/bold",
        f"{CAMERA}/caption/0",
        f"{CAMERA}/caption/1",
    ):
        assert meshcat.HasPath(path), path
    assert not meshcat.HasPath("/atlas_drake/footsteps/0")
    command = AtlasSimInterfaceCommand()
    command.behavior = command.WALK
    for place in range(2):
        step = AtlasBehaviorStepData()
        step.step_index, step.foot_index, step.duration = place + 1, place, 0.63
        step.pose.position.y = 0.12 if place == 0 else -0.12
        step.swing_height = 0.1
        command.walk_params.step_queue[place] = step
    sim.publish(command)
    sim.advance_to(1.5 * SHORT)
    for path in ("/atlas_drake/footsteps/0", "/atlas_drake/footsteps/1"):
        assert meshcat.HasPath(path), path


def test_a_simulation_opens_its_view_and_prints_the_address(capsys):
    sim = AtlasSimulation(view=True)
    address = sim.meshcat.web_url()
    assert f"Watch at {address}\n" in capsys.readouterr().out
    assert address.startswith("http://localhost:")
    assert sim.realtime_rate == 1.0
    assert sim.meshcat.HasPath("/drake/visualizer")
