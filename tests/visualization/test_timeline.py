"""Properties that change over time are correct in a recording from its beginning."""

import numpy as np
import pytest

from atlas_drake.visualization.marks import PERIOD, Timeline


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


def test_what_comes_later_is_not_there_before():
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


def test_what_is_hidden_later_is_there_before():
    recording = Recording()
    timeline = Timeline(recording)
    timeline.show("/link", False, 2.0)
    assert recording.visible("/link", 0.0)
    assert not recording.visible("/link", 2.0)


def test_what_is_there_from_the_beginning_has_one_key():
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
