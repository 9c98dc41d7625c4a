"""A report survives the conversion to a row and back with all of its fields."""

import itertools
from dataclasses import fields

import numpy as np

from atlas_drake.logs.layout import Layout
from atlas_drake.logs.report_channels import REPORT_CHANNELS, report_from
from atlas_drake.messages import AtlasSimInterfaceState, Message

KEPT_ELSEWHERE = {"header", "f_out", "k_effort"}
"""As the row's time, and with the other numbers of the joints."""


def fill(message, numbers):
    """Gives every number of a message another value."""
    for field in fields(message):
        value = getattr(message, field.name)
        if isinstance(value, Message):
            fill(value, numbers)
        elif isinstance(value, list):
            for element in value:
                fill(element, numbers)
        else:
            kind = int if isinstance(value, int) else float
            setattr(message, field.name, kind(next(numbers)))


def filled_report():
    report, numbers = AtlasSimInterfaceState(), itertools.count(2)
    for field in fields(report):
        # What an own behavior reports is of any type, and in no log.
        if field.name in KEPT_ELSEWHERE or field.name == "feedback":
            continue
        value = getattr(report, field.name)
        if isinstance(value, int):
            setattr(report, field.name, next(numbers))
        else:
            for message in value if isinstance(value, list) else [value]:
                fill(message, numbers)
    return report, next(numbers)


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


def test_no_field_of_a_report_is_left_out():
    report, count = filled_report()
    assert report != AtlasSimInterfaceState()
    assert report_from(by_channel(report)) == report
    # Each number is kept once.
    assert sum(entry.channel.size for entry in REPORT_CHANNELS) == count - 2
    for entry in REPORT_CHANNELS:
        assert entry.channel.size == len(entry.leaves), entry.channel.name
        assert len(set(entry.channel.labels)) == len(entry.channel.labels)


def test_whole_numbers_come_back_whole():
    report, _ = filled_report()
    again = report_from(by_channel(report, dtype=float))
    assert isinstance(again.walk_feedback.step_queue_saturated[3].step_index, int)
    assert isinstance(again.behavior_feedback.status_flags, int)
