"""A report survives the conversion to a row and back with all of its fields."""

import numpy as np
import pytest

from atlas_drake.logs.layout import Layout
from atlas_drake.logs.report_channels import REPORT_CHANNELS, report_from
from atlas_drake.messages import AtlasSimInterfaceState

KEPT_ELSEWHERE = {"header", "f_out", "k_effort"}
"""As the row's time, and with the other numbers of the joints."""


def by_channel(report, dtype=None):
    """The numbers of a report as those of one row of a log, by channel."""
    layout = Layout(entry.channel for entry in REPORT_CHANNELS)
    numbers = [number for entry in REPORT_CHANNELS for number in entry.read(report)]
    table = np.array([numbers], dtype=dtype)
    rows = {name: table[0, place] for name, place in layout.places.items()}
    return {
        channel.name: rows[channel.name] if channel.labels else rows[channel.name][0]
        for channel in layout.channels
    }


@pytest.fixture
def report(filled):
    """A report with another number in each field that the report's channels keep."""
    report = filled(AtlasSimInterfaceState)
    for name in KEPT_ELSEWHERE:
        setattr(report, name, getattr(AtlasSimInterfaceState(), name))
    return report


def test_every_field_of_a_report_is_recorded(report):
    assert report != AtlasSimInterfaceState()
    assert report_from(by_channel(report)) == report
    # Each number is kept once.
    row = [number for entry in REPORT_CHANNELS for number in entry.read(report)]
    assert len(set(row)) == len(row) == sum(e.channel.size for e in REPORT_CHANNELS)
    for entry in REPORT_CHANNELS:
        assert entry.channel.size == len(entry.leaves), entry.channel.name
        assert len(set(entry.channel.labels)) == len(entry.channel.labels)


def test_whole_numbers_come_back_whole(report):
    again = report_from(by_channel(report, dtype=float))
    assert isinstance(again.walk_feedback.step_queue_saturated[3].step_index, int)
    assert isinstance(again.behavior_feedback.status_flags, int)
