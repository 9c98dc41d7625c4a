"""The progress that a run prints, on terminals and into log files."""

import io
import os
import time
from contextlib import suppress

import pytest

from atlas_drake.clients.cli import progress
from atlas_drake.clients.cli.main import main
from atlas_drake.clients.cli.progress import (
    Progress,
    StatusLine,
    TrialProgress,
    event_line,
)
from atlas_drake.messages.event import Event


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


def test_events_are_lines_with_their_time():
    command = Event(2.0, "command", "[USER] Going to stand prep position...")
    assert event_line(command) == "   2.00 s [USER] Going to stand prep position..."
    fall = Event(12.3, "fall", "falling in WALK")
    assert event_line(fall) == "  12.30 s   ! falling in WALK"


def test_a_terminal_has_one_line_that_is_rewritten(monkeypatch):
    monkeypatch.setenv("COLUMNS", "44")
    stream = Terminal()
    shown = Progress(stream, end=17.0)
    shown.update(1.0, "STAND")
    shown.update(1.1, "STAND_PREP")
    assert "\n" not in stream.getvalue()
    assert stream.getvalue().count("\r") == 2
    last = stream.getvalue().split("\r")[-1]
    assert "1.10 s of 17 s" in last
    assert len(last) < 44
    # An event first wipes the line away, so that nothing of it sticks out.
    shown.event(Event(1.1, "command", "x"))
    wiped, line = stream.getvalue().split("\r")[-2:]
    assert wiped.strip() == ""
    assert len(wiped) >= len(last.rstrip())
    assert line == "   1.10 s x\n"


HOSTILE = "a\x1b[31m\x9b31m\u202e\u2066\u2028\x07\r\nWrote b"


@pytest.mark.parametrize(
    "put",
    [
        lambda stream: StatusLine(stream).say(HOSTILE),
        lambda stream: StatusLine(stream).show(HOSTILE),
        lambda stream: Progress(stream, 1.0).event(Event(0.0, "warning", HOSTILE)),
        lambda _: main(["run", HOSTILE]),
        lambda _: main(["import", HOSTILE]),
        lambda _: main(["demo", "--model", HOSTILE]),
        lambda _: main(["demo", "--seed", HOSTILE]),
    ],
)
@pytest.mark.usefixtures("restored_loggers")
def test_text_from_elsewhere_is_printable(put, capsys):
    stream = Terminal()
    with suppress(SystemExit):
        put(stream)
    said = (capsys.readouterr().err or stream.getvalue()).strip("\r\n")
    assert said.isprintable()
    assert r"\u2028\x07\r\nWrote b" in said.replace(r"\\", "\\")


def test_a_log_has_a_line_now_and_then(monkeypatch):
    clock = {"now": 0.0}
    monkeypatch.setattr(progress.time, "perf_counter", lambda: clock["now"])
    stream = io.StringIO()
    shown = Progress(stream, end=17.0)
    for i in range(1, 101):
        clock["now"] = 0.2 * i
        shown.update(0.1 * i, "STAND")
    lines = stream.getvalue().splitlines()
    assert len(lines) == 4
    assert "\r" not in stream.getvalue()
    # 0.1 s simulated in 0.2 s.
    assert all("0.50 x real time" in line for line in lines)


def test_a_reader_that_is_gone_ends_no_run():
    # As after `atlas-drake run ... | head`.
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as stream:
        line = StatusLine(stream)
        for _ in range(3):
            line.say("Nobody reads this.")


def test_a_long_trial_is_not_silent(monkeypatch):
    monkeypatch.setattr(progress, "AGAIN", 0.01)
    stream = Terminal()
    with TrialProgress(stream) as shown:
        while "no trial done yet | 0:00:00 so far" not in stream.getvalue():
            time.sleep(0.01)
        shown.update(True, 1, 3)
        assert "1 of 3 trials | 100 % of these 1 succeed" in stream.getvalue()
    length = len(stream.getvalue())
    time.sleep(0.05)
    # Nothing is written into what comes after it.
    assert len(stream.getvalue()) == length
