"""What failed first, from the signals of one tick after another."""

from dataclasses import replace

import numpy as np
import pytest

from atlas_drake import AtlasSimulation
from atlas_drake.logs.failure_modes import (
    AT_LIMIT,
    CHAIN,
    DCM_LEFT,
    DELAY,
    LATE,
    SATURATED,
    SLID,
    STUBBED,
    TIPPED,
    UNSOLVED,
    Failure,
    FailureWatch,
    Landing,
    Signals,
    initial,
    watch,
)
from atlas_drake.messages.event import Event

TICK = 0.01
NAMES = ("hip", "knee")
SOLES = np.array([[0.0, 0.1, 0.0], [0.0, -0.1, 0.0]])
UP = np.array([0.0, 0.0, 1.0])
GOOD = Signals(
    time=0.0,
    margin=np.array([0.5, 0.2]),
    effort=np.array([0.3, 0.9]),
    loads=(0.5, 0.5),
    soles=SOLES,
    normals=np.array([UP, UP]),
    landing=None,
    outside=0.0,
    unsolved=0,
)


def watched(*parts):
    """The state after parts of a run: each a duration [s] and fields that it changes.

    A field may be a function of the time since the part began.
    """
    state, tick = initial(len(NAMES)), 0
    for duration, fields in parts:
        for since in range(round(duration / TICK)):
            tick += 1
            changed = {
                name: value(since * TICK) if callable(value) else value
                for name, value in fields.items()
            }
            state = watch(state, replace(GOOD, time=tick * TICK, **changed), NAMES)
    return state


def soles_at(x, y=-0.1):
    return np.array([SOLES[0], [x, y, 0.0]])


def swinging(place, duration=0.6, away=0.0):
    """The right foot in the air, with so much of its swing's duration to come."""
    return {
        "loads": (1.0, 0.0),
        "soles": soles_at(place),
        "landing": lambda t: Landing(
            1, np.array([place + away, -0.1]), max(duration - t, 0.0)
        ),
    }


SIDEWAYS = np.array([0.0, 0.5, 0.9])
FAILURES = {
    "slid": ({"soles": soles_at(0.03)}, SLID, "right"),
    "tipped": ({"normals": np.array([SIDEWAYS, UP])}, TIPPED, "left"),
    "limit": ({"margin": np.array([0.5, -0.001])}, AT_LIMIT, "knee"),
    "effort": ({"effort": np.array([1.0, 0.2])}, SATURATED, "hip"),
    "unsolved": ({"unsolved": lambda t: 1 + round(t / TICK)}, UNSOLVED, ""),
    "dcm": ({"outside": 0.06}, DCM_LEFT, ""),
}


def test_a_good_run_has_no_failure():
    assert watched((1.0, {})).first is None


@pytest.mark.parametrize(("fields", "kind", "place"), FAILURES.values(), ids=FAILURES)
def test_each_failure_is_named_with_its_place_and_begin(fields, kind, place):
    state = watched((0.5, {}), (0.4, fields))
    assert state.first == Failure(pytest.approx(0.51), kind, place)


@pytest.mark.parametrize(
    "fields",
    [
        {"soles": soles_at(0.015)},
        {"soles": soles_at(0.1), "loads": (0.9, 0.1)},
        {"outside": 0.04},
        {"outside": None},
        {"effort": np.array([0.99, 0.99])},
    ],
)
def test_what_a_good_walk_shows_is_no_failure(fields):
    assert watched((0.5, {}), (1.0, fields)).first is None


@pytest.mark.parametrize(
    ("field", "value", "most"), [("margin", 0.0, 0.05), ("effort", 1.0, 0.3)]
)
def test_a_limit_counts_only_after_some_time(field, value, most):
    there = {field: np.full(2, value)}
    assert watched((0.1, {}), (most, there), (0.5, {})).first is None
    assert watched((0.1, {}), (most + 2 * TICK, there)).first is not None


def test_the_earliest_of_failures_that_belong_together_is_the_first():
    # The motor saturates before the DCM leaves, which is noticed at once.
    full = {"effort": np.array([1.0, 0.2])}
    state = watched((0.5, {}), (0.1, full), (0.4, {**full, "outside": 0.1}))
    assert state.first == Failure(pytest.approx(0.51), SATURATED, "hip")


def test_a_failure_that_passed_is_not_the_first_of_later_ones():
    slid = {"soles": soles_at(0.03)}
    away = {"soles": soles_at(0.03), "loads": (1.0, 0.0)}
    lost = {"outside": 0.1}
    state = watched((0.5, {}), (0.2, slid), (CHAIN - 0.1, away), (0.1, lost))
    assert state.first.kind == SLID
    state = watched((0.5, {}), (0.2, slid), (CHAIN + 0.1, away), (0.1, lost))
    assert state.first == Failure(pytest.approx(1.31), DCM_LEFT)


@pytest.mark.parametrize(
    ("swing", "away", "stubbed"),
    [(0.25, 0.0, True), (0.45, 0.0, False), (0.45, 0.06, True)],
)
def test_a_foot_is_stubbed_that_touches_early_or_away_from_its_place(
    swing, away, stubbed
):
    left = 0.6 - swing
    air = swinging(0.0, away=away)
    touch = {**swinging(0.0, left, away), "loads": (0.8, 0.2)}
    first = watched((0.2, {}), (swing, air), (0.05, touch)).first
    if stubbed:
        assert first == Failure(pytest.approx(0.21 + swing), STUBBED, "right")
    else:
        assert first is None


def test_a_foot_that_the_behavior_took_for_landed_is_not_stubbed():
    touch = {"loads": (0.8, 0.2), "landing": Landing(0, np.zeros(2), 0.7)}
    assert watched((0.2, {}), (0.5, swinging(0.0)), (0.1, touch)).first is None


def test_a_foot_that_finds_no_ground_is_late():
    air = swinging(0.0)
    assert watched((0.2, {}), (0.6 + DELAY, air)).first is None
    first = watched((0.2, {}), (0.6 + DELAY + 0.05, air)).first
    assert first == Failure(pytest.approx(0.81), LATE, "right")


def records_until(sim, end):
    """The records of a run, one for each tick."""
    while sim.time < end - 1e-9:
        sim.advance(sim.scenario.control_period)
        yield sim.record


def test_a_run_is_watched_until_it_fails():
    sim = AtlasSimulation()
    watch = FailureWatch(sim.robot)
    for record in records_until(sim, 0.1):
        watch.update(record)
    assert watch.first is None
    sim.apply_push("utorso", [2500.0, 0.0, 0.0], 0.1)
    for record in records_until(sim, 0.3):
        watch.update(record)
    assert (watch.first.kind, watch.first.place) == (DCM_LEFT, "")
    assert 0.1 < watch.first.time < 0.25


@pytest.mark.parametrize("limb", ["back", "l_arm"])
@pytest.mark.parametrize("share", [0, 255])
def test_joints_of_the_user_and_arms_are_not_watched(sim, limb, share):
    robot, record = sim.robot, sim.record
    joint = int(np.flatnonzero(robot.limb(limb))[0])
    q = record.state.q.copy()
    q[robot.indices(robot.plant).q[joint]] = robot.position_upper[joint]
    bent = replace(
        record,
        state=replace(record.state, q=q),
        joints=replace(record.joints, k_effort=np.full(robot.num_joints, share)),
    )
    watch = FailureWatch(robot)
    for tick in range(10):
        watch.update(replace(bent, time=tick * TICK))
    if limb == "back" and share == 0:
        assert watch.first == Failure(0.0, AT_LIMIT, robot.joint_names[joint])
    else:
        assert watch.first is None


def test_what_fails_after_a_fall_is_not_watched(sim):
    lying = replace(
        sim.record, controller=replace(sim.record.controller, unsolved=9), time=0.2
    )
    watch = FailureWatch(sim.robot)
    watch.update(replace(sim.record, events=(Event(0.1, "fall", "falling"),)))
    watch.update(lying)
    assert watch.first is None
    awake = FailureWatch(sim.robot)
    awake.update(sim.record)
    awake.update(lying)
    assert awake.first == Failure(0.2, UNSOLVED)


@pytest.fixture(scope="module")
def sim():
    return AtlasSimulation()
