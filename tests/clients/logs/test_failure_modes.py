"""What failed first, from the records of one tick after another."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation
from atlas_drake.clients.logs.failure_modes import (
    AT_LIMIT,
    CHAIN,
    DCM_LEFT,
    DELAY,
    LATE,
    LIMIT_TIME,
    SATURATED,
    SATURATED_TIME,
    SLID,
    STUBBED,
    TIPPED,
    UNSOLVED,
    Failure,
    FailureWatch,
)
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasBehaviorWalkFeedback
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import Footstep
from atlas_drake.units import GRAVITY

TICK = 0.01
SOLES = np.array([[0.0, 0.1, 0.0], [0.0, -0.1, 0.0]])
SQUARE = 0.2 * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@pytest.fixture(scope="module")
def sim():
    return AtlasSimulation()


class Runs:
    """Records of made-up runs, in parts that differ from standing still."""

    def __init__(self, sim):
        self.robot, self._record = sim.robot, sim.record
        self._q = sim.robot.indices(sim.robot.plant).q

    def watched(self, *parts):
        """The first failure after parts of a run: durations [s], and their fields.

        A field may be a function of the time since the part began.
        """
        watch, tick = FailureWatch(self.robot), 0
        for duration, fields in parts:
            for since in range(round(duration / TICK)):
                tick += 1
                now = {
                    name: value(since * TICK) if callable(value) else value
                    for name, value in fields.items()
                }
                watch.update(self.record(tick * TICK, **now))
        return watch.first

    def record(
        self,
        time,
        *,
        soles=SOLES,
        loads=(0.5, 0.5),
        tilted=0.0,
        at_limit=(),
        full=(),
        k_effort=0,
        landing=None,
        outside=0.0,
        unsolved=0,
        events=(),
    ):
        robot, record = self.robot, self._record
        weight = robot.mass * GRAVITY
        tilt = np.array([np.cos(tilted / 2), np.sin(tilted / 2), 0.0, 0.0])
        feet = replace(
            record.feet,
            left_position=soles[0],
            right_position=soles[1],
            left_orientation=tilt,
            left_force=np.array([0.0, 0.0, loads[0] * weight]),
            right_force=np.array([0.0, 0.0, loads[1] * weight]),
        )
        q, effort = record.state.q.copy(), np.zeros(robot.num_joints)
        for name in at_limit:
            joint = robot.joint_index(name)
            q[self._q[joint]] = robot.position_upper[joint]
        for name in full:
            joint = robot.joint_index(name)
            effort[joint] = -robot.effort_limit[joint]
        edge = np.array([0.2, 0.0])
        foot, place, remaining = landing or (0, np.zeros(3), 0.0)
        return replace(
            record,
            time=time,
            state=replace(record.state, q=q),
            joints=replace(
                record.joints,
                effort=effort,
                k_effort=np.full(robot.num_joints, k_effort),
            ),
            feet=feet,
            balance=replace(
                record.balance,
                support=SQUARE,
                omega=3.0,
                dcm=edge + np.array([outside, 0.0]),
                dcm_reference=edge,
            ),
            controller=replace(record.controller, unsolved=unsolved),
            footsteps=(Footstep(1, foot, place, 0.0),) if landing else (),
            walk=AtlasBehaviorWalkFeedback(t_step_rem=remaining),
            events=events,
        )


@pytest.fixture(scope="module")
def runs(sim):
    return Runs(sim)


def soles_at(x, y=-0.1):
    return np.array([SOLES[0], [x, y, 0.0]])


def swinging(duration=0.6, away=0.0):
    """The right foot in the air, with so much of its swing's duration to come."""
    place = np.array([away, -0.1, 0.0])
    return {
        "loads": (1.0, 0.0),
        "landing": lambda t: (1, place, max(duration - t, 0.0)),
    }


KNEE, WRIST = "l_leg_kny", "l_arm_wrx"
FAILURES = {
    "slid": ({"soles": soles_at(0.03)}, SLID, "right"),
    "tipped": ({"tilted": 0.31}, TIPPED, "left"),
    "limit": ({"at_limit": [WRIST, KNEE]}, AT_LIMIT, KNEE),
    "effort": ({"full": [WRIST, KNEE]}, SATURATED, KNEE),
    "unsolved": ({"unsolved": lambda t: 1 + round(t / TICK)}, UNSOLVED, ""),
    "dcm": ({"outside": 0.051}, DCM_LEFT, ""),
}


@pytest.mark.parametrize(("fields", "kind", "place"), FAILURES.values(), ids=FAILURES)
def test_each_failure_is_named_with_its_place_and_begin(fields, kind, place, runs):
    first = runs.watched((0.5, {}), (0.4, fields))
    assert first == Failure(pytest.approx(0.51), kind, place)


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"soles": soles_at(0.015)},
        {"soles": soles_at(0.1), "loads": (0.9, 0.1)},
        {"tilted": 0.29},
        {"outside": 0.049},
        {"at_limit": [WRIST], "full": [WRIST]},
        {"at_limit": [KNEE], "full": [KNEE], "k_effort": 1},
    ],
)
def test_what_a_good_walk_shows_is_no_failure(fields, runs):
    assert runs.watched((0.5, {}), (1.0, fields)) is None


@pytest.mark.parametrize(
    ("field", "duration"), [("at_limit", LIMIT_TIME), ("full", SATURATED_TIME)]
)
def test_a_limit_counts_only_after_some_time(field, duration, runs):
    there = {field: [KNEE]}
    assert runs.watched((0.1, {}), (duration, there), (0.5, {})) is None
    assert runs.watched((0.1, {}), (duration + 2 * TICK, there)) is not None


def test_the_earliest_of_failures_that_belong_together_is_the_first(runs):
    # The motor saturates before the DCM leaves, which is noticed at once.
    full = {"full": [KNEE]}
    first = runs.watched((0.5, {}), (0.1, full), (0.4, {**full, "outside": 0.1}))
    assert first == Failure(pytest.approx(0.51), SATURATED, KNEE)


def test_a_failure_that_passed_is_not_the_first_of_later_ones(runs):
    slid, lost = {"soles": soles_at(0.03)}, {"outside": 0.1}
    away = {"soles": soles_at(0.03), "loads": (1.0, 0.0)}
    begin = (0.5, {}), (0.2, slid)
    assert runs.watched(*begin, (CHAIN - 0.1, away), (0.1, lost)).kind == SLID
    first = runs.watched(*begin, (CHAIN + 0.1, away), (0.1, lost))
    assert first == Failure(pytest.approx(1.31), DCM_LEFT)


@pytest.mark.parametrize(
    ("swing", "away", "stubbed"),
    [(0.25, 0.0, True), (0.45, 0.0, False), (0.45, 0.06, True)],
)
def test_a_foot_is_stubbed_that_touches_early_or_away_from_its_place(
    swing, away, stubbed, runs
):
    touch = {**swinging(0.6 - swing, away), "loads": (0.8, 0.2)}
    first = runs.watched((0.2, {}), (swing, swinging(away=away)), (0.05, touch))
    expected = Failure(pytest.approx(0.21 + swing), STUBBED, "right")
    assert first == (expected if stubbed else None)


def test_a_foot_that_landed_or_never_stood_is_not_stubbed(runs):
    touch = {"loads": (0.8, 0.2), "landing": (0, np.zeros(3), 0.7)}
    assert runs.watched((0.2, {}), (0.5, swinging()), (0.1, touch)) is None
    # The first record has no forces yet.
    begin = {**swinging(), "loads": (0.0, 0.0)}
    assert runs.watched((TICK, begin), (0.1, {**begin, "loads": (0.5, 0.5)})) is None


def test_a_foot_that_finds_no_ground_is_late(runs):
    air = swinging()
    assert runs.watched((0.2, {}), (0.6 + DELAY, air)) is None
    first = runs.watched((0.2, {}), (0.6 + DELAY + 0.05, air))
    assert first == Failure(pytest.approx(0.81), LATE, "right")


def test_what_fails_after_a_fall_is_not_watched(runs):
    fell = {"events": (Event(0.1, "fall", "falling"),)}
    assert runs.watched((TICK, fell), (0.1, {"unsolved": 9})) is None


def test_a_run_is_watched_until_it_fails():
    sim = AtlasSimulation()
    watch = FailureWatch(sim.robot)

    def run_until(end):
        while sim.time < end - 1e-9:
            sim.advance(sim.scenario.control_period)
            watch.update(sim.record)

    run_until(0.1)
    assert watch.first is None
    sim.apply_push("utorso", [2500.0, 0.0, 0.0], 0.1)
    run_until(0.3)
    assert (watch.first.kind, watch.first.place) == (DCM_LEFT, "")
    assert 0.1 < watch.first.time < 0.25
