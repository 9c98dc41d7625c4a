"""MANIPULATE: its goals for messages, and its references."""

import dataclasses
import math

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand, AtlasState
from atlas_drake.behaviors.body_reference import BodyRates, capture_body
from atlas_drake.behaviors.stand.stand import Stand
from atlas_drake.parts.manipulate.manipulate import Manipulate, ManipulateConfig
from tests.parts.conftest import as_request

POSE_FIELDS = (
    "pelvis_height",
    "pelvis_yaw",
    "pelvis_pitch",
    "pelvis_roll",
    "com_v0",
    "com_v1",
)


def message(use_desired=True, demo=False, **desired):
    command = AtlasSimInterfaceCommand(behavior="MANIPULATE")
    params = command.manipulate_params
    params.use_desired, params.use_demo_mode = use_desired, demo
    for name, value in desired.items():
        setattr(params.desired, name, value)
    return command


def asked(use_desired=True, demo=False, **desired):
    """Like ``message``, as a behavior gets it."""
    return as_request(message(use_desired, demo, **desired))


def numbers(pose):
    return np.array([getattr(pose, name) for name in POSE_FIELDS])


@dataclasses.dataclass
class Ticked:
    """The behavior with its state, ticked by the test."""

    behavior: Manipulate
    state: object
    body: object
    outcome: object = None

    def tick(self, seen, request, leaving=False):
        self.outcome = self.behavior.update(
            self.state, seen, self.body, request, leaving
        )
        self.state, self.body = self.outcome.state, self.outcome.body

    @property
    def feedback(self):
        return self.behavior.feedback(self.state, 0)


@pytest.fixture(scope="module")
def parts(make_tools, observe):
    terms = observe().terms
    height = float(terms.com[2] - terms.feet[0].p_WF[2])
    tools = make_tools(height)
    stand = Stand(tools.balance, height, tools.rates)
    return Manipulate(tools, ManipulateConfig()), stand


@pytest.fixture
def start(parts, observe):
    """Enters the behavior with a message."""

    def make(request, pitch=0.0):
        seen = observe(pitch=pitch)
        body = capture_body(seen.terms)
        behavior = parts[0]
        return Ticked(behavior, behavior.enter(seen, body, request), body)

    return make


def test_the_body_rises_and_sinks_with_the_pelvis(start, observe):
    request, terms = asked(pelvis_height=0.8), observe().terms
    robot = start(request)
    for _ in range(20):
        robot.tick(observe(), request)
    pelvis = robot.state.motion.height
    sunk = pelvis.position[0] - terms.p_WP[2]
    assert -0.02 < sunk < -1e-4
    assert robot.body.height - terms.com[2] == pytest.approx(sunk)
    assert robot.body.height_rate == pytest.approx(pelvis.velocity[0])


def test_the_reference_moves_as_a_pendulum_on_its_cop(start, observe):
    omega, request = 3.2, asked(com_v0=0.03, com_v1=-0.02)
    robot = start(request)
    for _ in range(20):
        robot.tick(observe(), request)
    com = robot.state.motion.com
    assert np.abs(com.acceleration).min() > 1e-4
    reference = robot.state.dcm_reference(omega)
    np.testing.assert_allclose(omega * (reference.dcm - com.position), com.velocity)
    away = com.position - reference.cop
    np.testing.assert_allclose(omega**2 * away, com.acceleration, atol=1e-12)


def test_manipulate_takes_over_from_stand_and_back_without_a_jump(
    parts, observe, start
):
    """At the hand-over both ask for the same accelerations."""
    manipulate, stand = parts
    seen = observe(pitch=0.02)
    body = dataclasses.replace(
        capture_body(observe().terms), height=capture_body(seen.terms).height + 0.01
    )
    quiet = asked(use_desired=False)
    state = stand.enter(seen, body, quiet)
    first = stand.update(state, seen, body, quiet, False)
    state = manipulate.enter(seen, first.body, quiet)
    second = manipulate.update(state, seen, first.body, quiet, False)
    state = stand.enter(seen, second.body, quiet)
    third = stand.update(state, seen, second.body, quiet, False)
    for before, after in ((first, second), (second, third)):
        tasks = zip(before.command.tasks, after.command.tasks, strict=True)
        for task_before, task_after in tasks:
            assert type(task_before) is type(task_after)
            # STAND's reference sets off at once; nothing else may differ.
            np.testing.assert_allclose(
                task_after.target, task_before.target, atol=12.5 * BodyRates().height
            )


def test_home_is_the_pose_of_stand(start, observe):
    terms = observe().terms
    height = terms.p_WP[2] - terms.feet[0].p_WF[2]
    assert start(asked(use_desired=False)).state.home.height == pytest.approx(height)


def test_messages_change_the_goal_and_no_desired_keeps_it(start, observe):
    robot = start(asked(pelvis_height=0.85))
    robot.tick(observe(), asked(pelvis_height=0.83))
    assert robot.feedback.clamped.pelvis_height == 0.83
    robot.tick(observe(), asked(use_desired=False, pelvis_height=0.7))
    assert robot.feedback.clamped.pelvis_height == 0.83


def test_a_repeated_demo_continues_and_stops_at_its_pose(start, observe):
    demo = asked(demo=True)
    robot = start(demo)
    robot.state = dataclasses.replace(robot.state, demo_time=1.4)
    robot.tick(observe(), demo)
    moved = robot.feedback.clamped
    assert moved.pelvis_height < 0.9
    robot.tick(observe(), asked(demo=True))
    assert robot.feedback.clamped.pelvis_height < moved.pelvis_height
    stopped = asked(use_desired=False)
    robot.tick(observe(), stopped)
    held = robot.feedback.clamped.pelvis_height
    assert held == pytest.approx(moved.pelvis_height, abs=1e-3)
    robot.tick(observe(), stopped)
    assert robot.feedback.clamped.pelvis_height == held


def test_arms_stay_and_hands_are_taken_back_where_the_user_leaves_them(
    start, observe, model
):
    quiet = asked(use_desired=False)
    robot = start(quiet)
    arm = AtlasState.l_arm_ely
    raised = dataclasses.replace(
        robot.body, joints=robot.body.joints + 0.3 * model.robot.limb("l_arm")
    )
    robot.body = raised
    for _ in range(5):
        robot.tick(observe(), quiet)
    assert robot.body.joints[arm] == raised.joints[arm]
    # The user's joints are where the user has them, and stay there afterwards.
    held = observe(users={"l_arm_ely": 1.0})
    robot.tick(held, quiet)
    assert robot.body.joints[arm] == held.terms.q[arm]
    robot.tick(observe(), quiet)
    assert robot.body.joints[arm] == held.terms.q[arm]


def test_a_users_back_bends_the_trunk_as_it_does(start, observe):
    quiet = asked(use_desired=False)
    robot = start(quiet, pitch=0.1)
    robot.tick(observe(pitch=0.12, users={"back_bky": 1.0}), quiet)
    tilt = robot.body.pelvis_tilt
    np.testing.assert_allclose(tilt, [0.0, 0.1], atol=1e-3)
    np.testing.assert_allclose(robot.body.chest_tilt, [0.0, 0.12], atol=1e-3)


@pytest.mark.parametrize("bend", [-0.02, 0.02])
def test_the_back_is_straightened_at_its_rate(start, observe, model, bend):
    quiet = asked(use_desired=False)
    robot, back = start(quiet), model.robot.limb("back")
    straight = model.robot.stand_prep[back]
    bent = robot.body.joints + bend * back
    tilt = robot.body.pelvis_tilt + bend
    robot.body = dataclasses.replace(robot.body, joints=bent, chest_tilt=tilt)
    step = BodyRates().joints * observe().dt
    robot.tick(observe(), quiet)
    relative = robot.body.chest_tilt - robot.body.pelvis_tilt
    tilt_step = BodyRates().tilt * observe().dt
    np.testing.assert_allclose(relative, bend - np.sign(bend) * tilt_step, atol=1e-9)
    moved = robot.body.joints[back] - bent[back]
    np.testing.assert_allclose(moved, -np.sign(bend) * step)
    for _ in range(math.ceil(abs(bend) / step)):
        robot.tick(observe(), quiet)
    np.testing.assert_allclose(robot.body.joints[back], straight, atol=1e-12)


@pytest.mark.parametrize(("moved", "again"), [(0.008, False), (0.012, True)])
def test_arms_that_reach_out_clamp_the_pose_again(start, observe, moved, again):
    request = asked(pelvis_height=0.85)
    robot = start(request)
    upper = robot.state.upper + np.array([0.0, 0.6, -0.8]) * moved
    robot.state = dataclasses.replace(robot.state, upper=upper)
    robot.tick(observe(), request)
    assert (robot.state.upper is not upper) == again


def test_the_pelvis_rests_while_the_user_controls_a_leg(start, observe):
    request = asked(pelvis_height=0.85)
    robot = start(request)
    held = observe(users={"r_leg_kny": 1.0})
    for _ in range(20):
        robot.tick(held, request)
    feedback = robot.feedback
    began = numbers(feedback.internal_sensed)
    np.testing.assert_allclose(numbers(feedback.clamped), began, atol=1e-4)
    # STAND need not wait for what cannot be done.
    stand = AtlasSimInterfaceCommand(behavior="STAND")
    robot.tick(held, stand, leaving=True)
    assert robot.outcome.finished
    robot.tick(observe(), request)
    assert robot.feedback.clamped.pelvis_height == 0.85


def test_the_way_back_to_stand_is_as_low_as_the_legs_need(parts, start, observe):
    # With feet far apart no leg is long enough for STAND's height.
    seen = observe()
    feet = list(seen.terms.feet)
    for foot, side in enumerate((1.0, -1.0)):
        aside = np.array([-0.15 * side, 0.22 * side, 0.0])
        feet[foot] = feet[foot]._replace(p_WF=feet[foot].p_WF + aside)
    terms = dataclasses.replace(seen.terms, feet=tuple(feet))
    seen = dataclasses.replace(seen, terms=terms)
    request, stand = asked(use_desired=False), AtlasSimInterfaceCommand()
    body = capture_body(terms)
    behavior = parts[0]
    robot = Ticked(behavior, behavior.enter(seen, body, request), body)
    robot.tick(seen, request)
    robot.tick(seen, as_request(stand), leaving=True)
    state = robot.state
    home = behavior._home(seen, state.stance)
    upper = behavior._reach.upper_body(terms, state.stance)
    assert not behavior._reach.allows(home, state.stance, upper)
    assert behavior._reach.allows(state.goal, state.stance, upper)
    assert state.goal.height < home.height
