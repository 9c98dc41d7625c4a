"""All changes of behavior, legal and illegal, and their reports."""

import dataclasses
import itertools

import numpy as np
import pytest

from atlas_drake.behaviors.entry import (
    EntryLimits,
    Transition,
    legal_transitions,
    refusal,
)
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.supervisor import Supervisor
from atlas_drake.errors import ErrorCode
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    AtlasState,
    Behavior,
    BehaviorStatus,
)
from atlas_drake.messages.behavior_catalog import SHIPPED
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.shipped import BEHAVIORS, CONTROLLER

NONE, FREEZE, STAND_PREP, STAND, WALK, STEP, MANIPULATE, USER = Behavior

ALWAYS = {NONE, FREEZE, USER}
"""What may be asked for at any moment."""
LEGAL = {
    NONE: ALWAYS | {STAND_PREP, STAND},
    FREEZE: ALWAYS | {STAND_PREP, STAND},
    USER: ALWAYS | {STAND_PREP, STAND},
    STAND_PREP: ALWAYS | {STAND_PREP, STAND},
    STAND: ALWAYS | {STAND_PREP, STAND, WALK, STEP, MANIPULATE},
    WALK: ALWAYS | {STAND, WALK},
    STEP: ALWAYS | {STAND, STEP},
    MANIPULATE: ALWAYS | {STAND, MANIPULATE},
}
"""The rules as they are promised, written down a second time."""

WRIST = "l_arm_wry"
WRIST_INDEX = AtlasState.l_arm_wry
"""A joint so light that its speed hardly moves the robot."""


class Robot:
    """A supervisor with its state, asked and ticked by the test."""

    def __init__(self, model, observe, behavior):
        # The height is what the pose has, so that nothing counts as a fall.
        terms = observe().terms
        height = float(terms.com[2] - terms.feet[0].p_WF[2])
        self.supervisor = Supervisor(model, CONTROLLER, height, BEHAVIORS)
        self.state = self.supervisor.start(behavior)
        self.request = self._request(behavior, 0)
        self.command = None
        self.tick(observe())

    def _request(self, behavior, number):
        command = AtlasSimInterfaceCommand(behavior=behavior)
        return BehaviorRequest(behavior, command, number)

    def ask(self, behavior):
        self.request = self._request(behavior, self.request.number + 1)

    def send(self, command):
        self.request = BehaviorRequest(
            SHIPPED.find(command.behavior), command, self.request.number + 1
        )

    def tick(self, seen):
        self.state, self.command = self.supervisor.update(
            self.state, seen, (self.request,)
        )

    @property
    def status(self):
        return self.supervisor.status(self.state, np.zeros(2), 3.0)

    def texts(self, kind):
        return [event.text for event in self.state.events if event.kind == kind]


@pytest.fixture
def make(model, observe):
    """Makes a robot that is in a behavior already."""
    return lambda behavior: Robot(model, observe, behavior)


def assert_refused(robot, source, target, flags, code):
    report = robot.status
    assert (report.current_behavior, report.desired_behavior) == (source, source)
    feedback = report.behavior_feedback
    assert feedback.status_flags == flags
    assert (feedback.trans_from, feedback.trans_to) == (source, target)
    assert report.error_code is code
    (text,) = robot.texts("refusal")
    assert target.name in text


def test_the_legal_transitions_are_the_documented_ones():
    names = {s.name: frozenset(t.name for t in targets) for s, targets in LEGAL.items()}
    known = [entry for entry in BEHAVIORS if entry.name in names]
    assert legal_transitions(known) == names


@pytest.mark.parametrize(
    ("source", "target"),
    [
        (source, target)
        for source, target in itertools.product(LEGAL, LEGAL)
        if target in LEGAL[source]
        and not (source in (WALK, MANIPULATE) and target is STAND)
    ],
    ids=lambda behavior: behavior.name,
)
def test_a_legal_change_happens_in_the_same_tick(make, observe, source, target):
    robot = make(source)
    robot.ask(target)
    robot.tick(observe())
    report = robot.status
    assert (report.current_behavior, report.desired_behavior) == (target, target)
    assert report.error_code is ErrorCode.NO_ERRORS
    feedback = report.behavior_feedback
    if source is target:
        # More of the same is no transition.
        assert feedback.status_flags == BehaviorStatus.OK
        assert robot.texts("behavior") == []
    else:
        assert feedback.status_flags == BehaviorStatus.TRANSITION_SUCCESS
        assert (feedback.trans_from, feedback.trans_to) == (source, target)
        assert robot.texts("behavior") == [f"{source.name} -> {target.name}"]
    # NONE and USER give no effort; all others say what they want.
    assert (robot.command is None) == (target in (NONE, USER))


@pytest.mark.parametrize(
    ("source", "target"),
    [
        (source, target)
        for source, target in itertools.product(LEGAL, LEGAL)
        if target not in LEGAL[source]
    ],
    ids=lambda behavior: behavior.name,
)
def test_an_illegal_change_is_refused(make, observe, source, target):
    robot = make(source)
    robot.ask(target)
    for _ in range(3):
        robot.tick(observe())
        assert_refused(
            robot,
            source,
            target,
            BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR,
            ErrorCode.FAILED_TO_START_BEHAVIOR,
        )
    assert (robot.command is None) == (source in (NONE, USER))


@pytest.mark.parametrize("source", [USER, FREEZE])
@pytest.mark.parametrize(
    ("bad", "flag"),
    [
        ({"pitch": 0.5}, BehaviorStatus.FAILED_TRANS_COM_POS),
        ({"pitch": -0.5}, BehaviorStatus.FAILED_TRANS_COM_POS),
        ({"speed": 1.2}, BehaviorStatus.FAILED_TRANS_COM_VEL),
        ({"joints": {WRIST: 8.0}}, BehaviorStatus.FAILED_TRANS_VEL),
        ({"joints": {WRIST: -8.0}}, BehaviorStatus.FAILED_TRANS_VEL),
    ],
    ids=["ahead", "behind", "fast", "turning", "turning back"],
)
def test_stand_takes_over_only_a_robot_that_it_can_hold(
    make, observe, source, bad, flag
):
    robot = make(source)
    robot.ask(STAND)
    robot.tick(observe(**bad))
    assert_refused(robot, source, STAND, flag, ErrorCode.FAILED_TO_START_BEHAVIOR)
    # Asked again when all is well, it does.
    robot.tick(observe())
    assert robot.status.current_behavior is source
    robot.ask(STAND)
    robot.tick(observe())
    assert robot.status.current_behavior is STAND
    assert robot.status.error_code is ErrorCode.NO_ERRORS


@pytest.mark.parametrize("name", ["com_inside", "dcm_inside"])
def test_stand_takes_over_within_its_margins(make_tools, observe, name):
    still = StandConfig(recovery_steps=False)
    tools, seen = dataclasses.replace(make_tools(0.9), stand_config=still), observe()
    support = tools.balance.support(*seen.foot_poses)
    inside = -support.distance_outside(seen.terms.com[:2])  # At rest, also the DCM.
    entries = {entry.behavior: entry for entry in BEHAVIORS}
    for margin, flag in (
        (inside - 1e-4, BehaviorStatus.OK),
        (
            inside + 1e-4,
            BehaviorStatus.FAILED_TRANS_COM_POS
            if name == "com_inside"
            else BehaviorStatus.FAILED_TRANS_COM_VEL,
        ),
    ):
        limits = dataclasses.replace(EntryLimits(), **{name: margin})
        now = dataclasses.replace(tools, entry_limits=limits)
        asked = Transition(entries[FREEZE], seen, now, AtlasSimInterfaceCommand())
        assert refusal(entries[STAND], asked) == (flag, "")


@pytest.mark.parametrize("source", [USER, FREEZE])
def test_stand_takes_over_a_robot_that_a_step_catches(make, observe, source):
    knee = "l_leg_kny"
    for seen, status in (
        ({"speed": 0.6, "joints": {knee: 8.0}}, BehaviorStatus.OK),
        # With a leg in the user's hands there is no step.
        ({"speed": 0.6, "users": {knee: 1.0}}, BehaviorStatus.FAILED_TRANS_COM_VEL),
    ):
        robot = make(source)
        robot.ask(STAND)
        robot.tick(observe(**seen))
        flags = robot.status.behavior_feedback.status_flags
        assert flags & BehaviorStatus.FAILED_TRANS_COM_VEL == status


def test_stand_ignores_the_speed_of_joints_under_user_control(make, observe):
    robot = make(USER)
    robot.ask(STAND)
    robot.tick(observe(joints={WRIST: 8.0}, users={WRIST: 1.0}))
    assert robot.status.current_behavior is STAND


@pytest.mark.parametrize("source", [WALK, MANIPULATE])
def test_walk_and_manipulate_end_in_order_before_stand(make, observe, source):
    robot = make(source)
    robot.ask(STAND)
    robot.tick(observe())
    report = robot.status
    assert (report.current_behavior, report.desired_behavior) == (source, STAND)
    flags = report.behavior_feedback.status_flags
    assert flags == BehaviorStatus.TRANSITION_IN_PROGRESS
    # Asked for the source again, it stays.
    robot.ask(source)
    robot.tick(observe())
    assert robot.status.desired_behavior is source


def test_freeze_holds_the_joints_where_they_are(make, observe):
    robot = make(STAND)
    robot.ask(FREEZE)
    robot.tick(observe(joints={WRIST: 1.0}))
    desired = robot.command.posture.target
    moving = WRIST_INDEX
    assert desired[moving] < 0.0
    np.testing.assert_array_equal(np.delete(desired, moving), np.zeros(27))


def test_freeze_stands_on_soles_that_carry(make, observe, model):
    robot = make(FREEZE)
    robot.tick(dataclasses.replace(observe(), foot_force=np.full(2, np.nan)))
    assert len(robot.command.contacts) == 2
    weight = 9.81 * model.robot.mass
    for share, count in ((0.03, 2), (0.01, 0), (0.0, 0)):
        force = np.full(2, share * weight)
        robot.tick(dataclasses.replace(observe(), foot_force=force))
        assert len(robot.command.contacts) == count


@pytest.mark.parametrize("behavior", LEGAL, ids=lambda behavior: behavior.name)
def test_a_fall_is_reported_once_and_ends_all_effort(make, observe, behavior):
    robot = make(behavior)
    assert not robot.state.falling
    for _ in range(3):
        robot.tick(observe(pitch=1.0))
        flags = robot.status.behavior_feedback.status_flags
        assert flags & BehaviorStatus.ERROR_FALLING
        assert robot.command is None
    assert len(robot.texts("fall")) == 1
    # It stays so until another behavior begins ...
    robot.tick(observe())
    assert robot.command is None
    robot.ask(STAND)
    robot.tick(observe())
    flags = robot.status.behavior_feedback.status_flags
    assert not flags & BehaviorStatus.ERROR_FALLING
    assert robot.command is not None


@pytest.mark.parametrize("behavior", [USER, FREEZE], ids=lambda b: b.name)
def test_a_lying_robot_stays_flagged_in_user_and_freeze(make, observe, behavior):
    robot = make(STAND)
    lying = observe(pitch=1.5)
    robot.tick(lying)
    robot.ask(behavior)
    for _ in range(3):
        robot.tick(lying)
        flags = robot.status.behavior_feedback.status_flags
        assert flags & BehaviorStatus.ERROR_FALLING
        assert robot.command is None
    assert len(robot.texts("fall")) == 1


@pytest.mark.parametrize(
    "target", [STAND, STAND_PREP, WALK, STEP, MANIPULATE], ids=lambda b: b.name
)
@pytest.mark.parametrize("source", [NONE, STAND, MANIPULATE], ids=lambda b: b.name)
def test_behaviors_on_feet_refuse_a_lying_robot(make, observe, source, target):
    robot = make(source)
    lying = observe(pitch=1.5)
    robot.tick(lying)
    robot.ask(target)
    robot.tick(lying)
    report = robot.status
    assert report.current_behavior == source
    assert report.error_code is ErrorCode.FAILED_TO_START_BEHAVIOR
    assert report.behavior_feedback.status_flags & BehaviorStatus.ERROR_FALLING
    assert robot.command is None
    assert len(robot.texts("refusal")) == 1


def test_a_refused_command_changes_nothing_of_what_is_done(make, observe, walk_message):
    robot = make(STAND)
    steps = [(k, k % 2, 0.2 * k, 0.15 - 0.3 * (k % 2)) for k in range(1, 5)]
    robot.send(walk_message(*steps))
    robot.tick(observe())
    coming = list(robot.status.feedback.step_queue_saturated)
    assert [step.step_index for step in coming] == [1, 2, 3, 4]
    assert [step.index for step in robot.status.plan.footsteps] == [1, 2, 3, 4]
    other = AtlasSimInterfaceCommand(behavior="MANIPULATE")
    other.walk_params.use_demo_walk = True
    robot.send(other)
    robot.tick(observe())
    assert robot.status.error_code is ErrorCode.FAILED_TO_START_BEHAVIOR
    assert list(robot.status.feedback.step_queue_saturated) == coming


def test_a_refusal_does_not_hide_that_another_change_is_under_way(
    make, observe, walk_message
):
    robot = make(STAND)
    robot.send(walk_message((1, 0, 0.2, 0.15), (2, 1, 0.2, -0.15)))
    robot.tick(observe())
    robot.ask(STAND)
    robot.tick(observe())
    robot.ask(MANIPULATE)
    robot.tick(observe())
    flags = robot.status.behavior_feedback.status_flags
    assert flags == (
        BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR
        | BehaviorStatus.TRANSITION_IN_PROGRESS
    )
    assert robot.status.desired_behavior == STAND
