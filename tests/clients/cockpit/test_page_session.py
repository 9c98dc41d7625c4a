"""The viewers of the page, and which of them has control."""

import asyncio
import json

import pytest

from atlas_drake.clients.cockpit.page import sockets
from atlas_drake.clients.cockpit.page.session import (
    MOST_EVENTS,
    MOST_VIEWERS,
    SILENCE,
    SPAN,
    Session,
    Viewer,
)
from atlas_drake.clients.cockpit.page.sockets import MOST_WAITING, Pending
from atlas_drake.clients.cockpit.wire import Frame, Notice

from .page_of import Clock


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def session(clock):
    return Session(clock)


def joined(session, may_steer=True):
    viewer = Viewer(may_steer)
    session.join(viewer)
    return viewer


def told(viewer, kind=None):
    """Returns all that a viewer was told, or all of a kind, and clears it."""

    async def take():
        return [json.loads(await viewer.pending.take()) for _ in range(waiting)]

    waiting = len(viewer.pending)
    messages = asyncio.run(take())
    return messages if kind is None else [m for m in messages if m["kind"] == kind]


def control_of(viewer):
    return told(viewer, "session")[-1]


def frame(time, run=0, events=()):
    return Frame(b"{}", run, time, 1.0, "STAND", 0.5, events)


def test_the_first_viewer_has_control_and_others_ask(session):
    first, second = joined(session), joined(session)
    assert session.holder is first
    told(first)
    session.take_control(second)
    assert control_of(first)["asked"]
    waiting = control_of(second)
    assert (waiting["control"], waiting["asking"]) == ("other", True)
    session.release_control(first)
    assert session.holder is second
    assert control_of(first)["control"] == "other"
    got = control_of(second)
    assert (got["control"], got["asking"], got["asked"]) == ("you", False, False)
    session.leave(second)
    assert session.holder is None
    session.take_control(first)
    assert session.holder is first


def test_only_the_latest_asks(session):
    first, second, third = (joined(session) for _ in range(3))
    session.take_control(second)
    session.take_control(third)
    assert not control_of(second)["asking"]
    assert session.leave(first)
    assert session.holder is third
    assert not session.leave(second)
    assert session.holder is third


def test_who_asks_may_think_better_of_it(session):
    first, second = joined(session), joined(session)
    session.take_control(second)
    session.release_control(second)
    session.release_control(first)
    assert session.holder is None


def test_control_goes_from_who_is_silent(session, clock):
    first, second = joined(session), joined(session)
    clock.time = SILENCE - 1.0
    session.acted(first)
    session.take_control(second)
    clock.time = 2.0 * SILENCE - 1.5
    session.pass_on()
    assert session.holder is first
    clock.time = 2.0 * SILENCE - 1.0
    session.pass_on()
    assert session.holder is second
    clock.time = 10.0 * SILENCE
    session.pass_on()
    assert session.holder is second  # Nobody asks.
    session.take_control(first)  # Silent for long already.
    assert session.holder is first


def test_a_page_that_opens_gets_control_only_with_the_token(session):
    guest = joined(session, may_steer=False)
    assert session.holder is None
    assert control_of(guest)["control"] == "nobody"
    viewer = joined(session)
    assert session.holder is viewer


def test_guests_leave_room_for_who_may_steer(session):
    for _ in range(MOST_VIEWERS):
        assert session.has_room(may_steer=False)
        joined(session, may_steer=False)
    assert not session.has_room(may_steer=False)
    for _ in range(MOST_VIEWERS):
        assert session.has_room(may_steer=True)
        joined(session)
    assert not session.has_room(may_steer=True)


def test_stop_is_shown_to_all_and_who_has_control_learns_by_whom(session):
    first, second = joined(session), joined(session)
    session.show_stopping(second)
    assert told(second, "stopping")
    messages = told(first)
    assert {"kind": "stopping"} in messages
    assert f"{second.name} pressed STOP" in [m.get("text") for m in messages]
    session.show_stopping(first)
    assert not told(first, "notice")


def test_a_slow_viewer_gets_the_latest_frame_and_every_event(session):
    viewer = joined(session)
    told(viewer)
    for step in range(100):
        session.show_frame(frame(0.1 * step, events=[(0.1 * step, "fall", "ouch")]))
    messages = told(viewer)
    assert [m["kind"] for m in messages] == ["events"] * 100 + ["frame"]


def test_a_viewer_that_takes_nothing_is_dropped_and_the_others_are_not(session):
    stuck, other = joined(session), joined(session)
    dropped = []
    stuck.drop = lambda: dropped.append(stuck)
    other.drop = lambda: dropped.append(other)
    for step in range(MOST_WAITING):
        session.show_frame(frame(0.1 * step, events=[(0.1 * step, "fall", "ouch")]))
        if step % 1000 == 0:
            told(other)
    assert set(dropped) == {stuck}


def test_what_waits_is_bounded_in_bytes_too(monkeypatch):
    monkeypatch.setattr(sockets, "MOST_BYTES_WAITING", 1000)
    pending = Pending()
    for _ in range(3):
        pending.put(bytes(1000), "same")
    pending.put(b"more")
    with pytest.raises(asyncio.QueueFull):
        pending.put(b"even more")
    asyncio.run(pending.take())
    pending.put(b"even more")


def test_who_opens_later_gets_the_time_before(session):
    for step in range(2 * MOST_EVENTS):
        session.show_frame(frame(0.1 * step, events=[(0.1 * step, "fall", str(step))]))
    session.show_notice(Notice("it cannot be built", lasting=True))
    messages = told(joined(session))
    (history,) = [m for m in messages if m["kind"] == "history"]
    now = 0.1 * (2 * MOST_EVENTS - 1)
    assert len(history["events"]) == MOST_EVENTS
    assert history["moments"][-1] == [now, "STAND", 0.5]
    assert history["moments"][0][0] == pytest.approx(now - SPAN, abs=0.11)
    assert [m["text"] for m in messages if m["kind"] == "notice"] == [
        "it cannot be built"
    ]
    session.show_notice(Notice("it is built"))
    assert not told(joined(session), "notice")


def test_a_jump_of_time_takes_back_what_is_not_past_any_more(session):
    viewer = joined(session)
    for time in (1.0, 2.0, 3.0):
        session.show_frame(frame(time, events=[(time, "fall", "ouch")]))
    told(viewer)
    session.show_frame(frame(2.0, run=1, events=[(1.0, "fall", "ouch")]))
    messages = told(viewer)
    assert [m["kind"] for m in messages] == ["history", "frame"]
    assert [time for time, *_ in messages[0]["moments"]] == [1.0, 2.0]
    assert messages[0]["events"] == [[1.0, "fall", "ouch"]]
