"""The behaviors on the simulated robot: what they do, and what they report of it."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Scenario
from atlas_drake.messages import (
    NO_STEP,
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
    StepStatus,
    Vector3,
    WalkStatus,
)
from atlas_drake.messages.event import STEPS_LEFT
from atlas_drake.parts.step.config import StepRules
from atlas_drake.worlds.terrain import Block

LEFT, RIGHT = 0, 1
LOOK = 0.02
"""Time between looks at a running simulation [s]."""
LONGEST = 12.0
"""No step or walk of this file takes as long [s]."""
LANDING_ERROR = 0.02
"""Farthest that a step within reach may land from where it was sent [m]."""
STEPPING = StepStatus.SUBSTATE_STEPPING
PUSH_DURATION = 0.15
"""[s]"""


@dataclass
class Look:
    """The robot's report at one moment."""

    time: float
    report: AtlasSimInterfaceState


class Recording:
    """A simulation that is looked at every LOOK seconds."""

    def __init__(self, **scenario):
        self.sim = AtlasSimulation(Scenario(**scenario))
        self.looks: list[Look] = []

    def advance(self, seconds, until=None):
        """Runs for so long, or until ``until`` is true of the latest report."""
        end = self.sim.time + seconds
        while self.sim.time < end - 1e-9:
            self.sim.advance_to(min(end, self.sim.time + LOOK))
            self.looks.append(Look(self.sim.time, self.report))
            if until is not None and until(self.report):
                return True
        return False

    def ask(self, behavior):
        """Asks for a behavior."""
        self.sim.publish(AtlasSimInterfaceCommand(behavior=behavior))

    def send(self, index, foot, x, y, z=0.0, yaw=0.0, normal=(0, 0, 1.0), **action):
        """Asks for a single step."""
        command = AtlasSimInterfaceCommand(behavior="STEP")
        command.step_params.use_spec = True
        spec = command.step_params.desired_step_spec
        spec.step_index, spec.foot_index = index, foot
        spec.foot.position, spec.foot.yaw = Vector3(x, y, z), yaw
        spec.foot.normal = Vector3.from_array(normal)
        for name, value in action.items():
            setattr(spec.action, name, value)
        self.sim.publish(command)

    @property
    def report(self):
        return self.sim.atlas_sim_interface_state

    @property
    def status(self):
        return self.report.behavior_feedback.status_flags

    def texts(self, kind):
        return [event.text for event in self.sim.events if event.kind == kind]

    def changes(self, value):
        """The values of the reports while walking, repetitions left out."""
        walking = [
            value(look.report)
            for look in self.looks
            if look.report.current_behavior is Behavior.WALK
        ]
        return [key for key, _ in itertools.groupby(walking)]


def in_stand(report):
    return report.current_behavior is Behavior.STAND


def soles(sim):
    frames = [foot.sole_frame for foot in sim.robot.file.feet]
    return np.array([sim.frame_pose(frame).translation() for frame in frames])


# ---- FREEZE and USER ---------------------------------------------------------


@pytest.mark.slow
def test_freeze_stands_still():
    robot = Recording()
    robot.ask(" Freeze ")
    robot.advance(0.7)
    assert robot.report.current_behavior is Behavior.FREEZE
    assert np.abs(robot.sim.atlas_state.velocity).max() < 0.03


def test_user_takes_all_joints_at_once():
    robot = Recording()
    command = AtlasSimInterfaceCommand(behavior="user")
    command.k_effort = [0] * 28
    robot.sim.publish(command)
    robot.advance(0.02)
    assert robot.report.current_behavior is Behavior.USER
    assert list(robot.report.k_effort) == [255] * 28
    assert not np.any(robot.report.f_out)
    assert np.abs(robot.sim.atlas_state.effort).max() > 1.0


# ---- WALK --------------------------------------------------------------------


def stepping(index):
    """Whether the robot takes this step."""

    def look(report):
        walk = report.walk_feedback
        coming = walk.step_queue_saturated[0].step_index
        return walk.current_step_index == coming == index

    return look


def walk_flags(report):
    return report.walk_feedback.status_flags


@pytest.fixture(scope="module")
def two_steps(walk_message):
    """A walk of two steps, from the command to STAND."""
    robot = Recording()
    robot.sim.publish(walk_message((1, 0, 0.2, 0.14), (2, 1, 0.2, -0.14)))
    robot.advance(LONGEST, in_stand)
    return robot


@pytest.mark.slow
def test_a_walk_takes_its_steps_and_returns_to_stand_by_itself(two_steps):
    report = two_steps.report
    assert report.desired_behavior is report.current_behavior is Behavior.STAND
    feedback = report.behavior_feedback
    assert feedback.status_flags == BehaviorStatus.WARNING_AUTO_TRANS
    assert (feedback.trans_from, feedback.trans_to) == (Behavior.WALK, Behavior.STAND)
    # The walk's own flags end with it.
    assert walk_flags(report) == WalkStatus.OKAY
    steps = two_steps.sim.footsteps
    assert [(step["index"], step["foot"]) for step in steps] == [(1, 0), (2, 1)]
    assert all(step["error_m"] <= LANDING_ERROR for step in steps)
    # What is said to have landed is where the feet are.
    for foot, step in zip(soles(two_steps.sim), steps, strict=True):
        np.testing.assert_allclose(foot[:2], step["landed"][:2], atol=0.005)
    assert two_steps.sim.summary()["success"]


@pytest.mark.slow
def test_a_walk_reports_its_phases_and_steps_as_they_come_up(two_steps):
    assert two_steps.changes(walk_flags) == [
        WalkStatus.SUBSTATE_SWAYING,
        WalkStatus.SUBSTATE_STEPPING,
        WalkStatus.SUBSTATE_CATCHING | WalkStatus.WARNING_INSUFFICIENT_STEP_DATA,
    ]

    def steps(report):
        walk = report.walk_feedback
        queue = [step.step_index for step in walk.step_queue_saturated]
        known = [index for index in queue if index != NO_STEP]
        return walk.current_step_index, known, walk.next_step_index_needed

    assert two_steps.changes(steps) == [
        (0, [1, 2], 3),
        (1, [1, 2], 3),
        (1, [2], 3),
        (2, [2], 3),
        (2, [], 3),
    ]
    # The rest of a step counts down to its touchdown, whichever phase it is in.
    landings = [e.time for e in two_steps.sim.events if e.kind == "footstep"]
    looks = [
        (look.time, look.report.walk_feedback.t_step_rem)
        for look in two_steps.looks
        if look.report.current_behavior is Behavior.WALK
    ]
    for begin, end in ((-math.inf, landings[0]), tuple(landings)):
        during = [(t, rest) for t, rest in looks if begin + 0.02 < t < end - 0.02]
        assert len(during) > 5
        left = [end - t for t, _ in during]
        np.testing.assert_allclose([rest for _, rest in during], left, atol=0.03)
    assert all(rest == 0.0 for t, rest in looks if t > landings[1] + 0.01)


@pytest.mark.slow
def test_a_walk_is_changed_asked_to_stand_and_frozen(walk_message):
    robot = Recording()
    robot.sim.publish(walk_message((1, 0, 0.2, 0.14), (2, 1, 0.4, -0.14)))
    assert robot.advance(LONGEST, stepping(1))
    assert robot.report.walk_feedback.next_step_index_needed == 3
    # Step 1 has begun and stays what it is; step 2 is changed, 3 and 4 are new.
    changed = walk_message(
        (1, 0, 0.1, 0.14), (2, 1, 0.3, -0.14), (3, 0, 0.5, 0.14), (4, 1, 0.7, -0.14)
    )
    robot.sim.publish(changed)
    robot.advance(0.1)
    assert robot.report.walk_feedback.next_step_index_needed == 5
    robot.ask("stand")
    robot.advance(0.06)
    # Another WALK withdraws the request, and sends the steps anew.
    robot.sim.publish(changed)
    robot.advance(0.06)
    assert robot.report.desired_behavior is Behavior.WALK
    assert not robot.status & BehaviorStatus.TRANSITION_IN_PROGRESS
    assert robot.advance(LONGEST, stepping(3))
    robot.ask("stand")
    robot.advance(0.1)
    assert robot.report.current_behavior is Behavior.WALK
    assert robot.report.desired_behavior is Behavior.STAND
    assert robot.status == BehaviorStatus.TRANSITION_IN_PROGRESS
    assert walk_flags(robot.report) & WalkStatus.SUBSTATE_STEPPING
    assert robot.advance(LONGEST, in_stand)
    assert robot.status == BehaviorStatus.TRANSITION_SUCCESS
    # It was asked to stop: that there are no more steps is no warning.
    assert robot.changes(walk_flags)[-1] == WalkStatus.SUBSTATE_CATCHING
    steps = robot.sim.footsteps
    assert [step["commanded"][0] for step in steps] == [0.2, 0.3, 0.5]
    assert all(step["error_m"] <= LANDING_ERROR for step in steps)
    # No pause for the news.
    times = [e.time for e in robot.sim.events if e.kind == "footstep"]
    np.testing.assert_allclose(np.diff(times), 0.63, atol=0.08)
    assert robot.sim.summary()["max_pelvis_tilt_rad"] < 0.2
    # FREEZE holds staggered feet without sliding.
    robot.advance(0.5)
    before = soles(robot.sim)
    robot.ask("freeze")
    robot.advance(2.0)
    assert not robot.sim.has_fallen
    np.testing.assert_allclose(soles(robot.sim), before, atol=1e-3)
    assert np.abs(robot.sim.atlas_state.velocity).max() < 0.02


# ---- STEP --------------------------------------------------------------------


def waiting(index):
    """Whether this step is done and the robot waits for the next one."""

    def look(report):
        step = report.step_feedback
        done = step.current_step_index == index and step.t_step_rem == 0.0
        return done and step.status_flags == StepStatus.SUBSTATE_SWAYING

    return look


def in_air(report):
    return report.step_feedback.status_flags == StepStatus.SUBSTATE_STEPPING


@pytest.mark.slow
def test_a_step_is_quasi_static_and_returns_if_there_is_no_ground():
    robot = Recording()
    before = soles(robot.sim)
    robot.send(1, LEFT, 0.2, 0.14, 0.15, step_end_dist=0.03)
    assert robot.advance(LONGEST, waiting(1))
    (text,) = robot.texts(STEPS_LEFT)
    assert "no ground" in text
    np.testing.assert_allclose(soles(robot.sim), before, atol=LANDING_ERROR)
    # A foot that is back where it was has taken no step.
    assert robot.sim.footsteps == []
    assert not robot.sim.summary()["success"]
    robot.send(2, LEFT, 0.2, 0.14)
    assert robot.advance(LONGEST, in_air)
    robot.ask("stand")
    pelvis = []
    while in_air(robot.report):
        robot.advance(LOOK)
        pelvis.append(robot.sim.pelvis_pose.translation()[:2])
    # The body stands over the stance foot and does not fall towards the other.
    assert np.ptp(pelvis, axis=0).max() < 0.03
    assert abs(pelvis[-1][1] - before[RIGHT][1]) < 0.05
    assert len(pelvis) * LOOK > 1.0
    # Asked to stand, it puts the foot down first.
    assert robot.report.current_behavior is Behavior.STEP
    assert robot.status == BehaviorStatus.TRANSITION_IN_PROGRESS
    assert robot.advance(LONGEST, in_stand)
    assert robot.status == BehaviorStatus.TRANSITION_SUCCESS
    (step,) = robot.sim.footsteps
    assert step["error_m"] <= LANDING_ERROR
    # Over both feet when STAND takes over.
    middle = soles(robot.sim)[:, 0].mean()
    assert robot.sim.pelvis_pose.translation()[0] == pytest.approx(middle, abs=0.05)


@pytest.mark.slow
def test_the_robot_steps_with_one_foot_on_a_tilted_block():
    block = Block(
        size=[0.4, 0.34, 0.2], position=[0.38, 0.13, 0.06], rpy=[0.1, -0.15, 0.0]
    )
    normal = block.X_WT.rotation().matrix()[:, 2]
    robot = Recording(terrain=[block])
    robot.send(1, LEFT, 0.38, 0.13, 0.06, normal=normal)
    assert robot.advance(LONGEST, waiting(1))
    robot.advance(1.0)
    sole = robot.sim.frame_pose(robot.sim.robot.file.feet[LEFT].sole_frame)
    assert sole.rotation().matrix()[:, 2] @ normal == pytest.approx(1.0, abs=1e-3)
    # The other foot: for its step the robot stands on the slope alone.
    robot.send(2, RIGHT, 0.2, -0.2)
    assert robot.advance(LONGEST, waiting(2))
    assert max(step["error_m"] for step in robot.sim.footsteps) <= LANDING_ERROR
    assert robot.texts("warning") == robot.texts(STEPS_LEFT) == []
    robot.ask("stand")
    robot.advance(LOOK)
    assert in_stand(robot.report)  # At once.
    robot.advance(0.6)
    assert not robot.sim.has_fallen


@pytest.mark.slow
def test_a_client_that_sends_at_every_state_stays_four_steps_ahead(walk_message):
    robot = Recording()

    def send():
        first = robot.report.walk_feedback.next_step_index_needed
        indices = range(first, first + 4)
        robot.sim.publish(
            walk_message(
                *((i, i % 2, 0.1 * i, -0.14 + 0.28 * (i % 2 == 0)) for i in indices)
            )
        )

    while len(robot.sim.footsteps) < 3:
        send()
        robot.advance(LOOK)
        walk = robot.report.walk_feedback
        ahead = walk.next_step_index_needed - walk.current_step_index
        assert ahead <= 4
    assert ahead == 4
    assert all(step["error_m"] <= LANDING_ERROR for step in robot.sim.footsteps)


MESSAGES = {
    "the first foot changes as the weight shifts": (
        (0.0, ((1, LEFT, 0.2, 0.14), (2, RIGHT, 0.2, -0.14))),
        (0.6, ((1, RIGHT, 0.2, -0.14), (2, LEFT, 0.2, 0.14))),
    ),
    "the first steps come as the weight shifts": (
        (0.0, ()),
        (0.3, ((1, LEFT, 0.2, 0.14), (2, RIGHT, 0.2, -0.14))),
    ),
    "a step in the swing, and one that is too high": (
        (0.0, ((1, LEFT, 0.22, 0.14),)),
        (1.2, ((2, RIGHT, 0.44, -0.14), (3, LEFT, 0.6, 0.14, 0.25))),
    ),
    "a step that was too high is corrected as the robot settles": (
        (0.0, ((1, LEFT, 0.22, 0.14), (2, RIGHT, 0.44, -0.14, 0.25))),
        (1.6, ((2, RIGHT, 0.22, -0.14),)),
    ),
}
"""By name: times of messages [s], and their steps: index, foot, x, y, z [m]."""


@pytest.mark.slow
@pytest.mark.parametrize("messages", MESSAGES.values(), ids=MESSAGES)
def test_steps_land_on_their_places_whenever_their_message_comes(
    walk_message, messages
):
    robot = Recording()
    for time, steps in messages:
        robot.advance(time - robot.sim.time)
        robot.sim.publish(walk_message(*steps))
        robot.advance(LOOK)
    assert robot.advance(LONGEST, in_stand)
    assert [step["index"] for step in robot.sim.footsteps] == [1, 2]
    assert all(step["error_m"] <= LANDING_ERROR for step in robot.sim.footsteps)


@pytest.mark.slow
@pytest.mark.parametrize("push", [(0.66, 0.0), (0.0, 0.66), (0.0, -0.55)])
def test_a_push_in_step_with_a_foot_in_the_air_is_caught(push):
    robot = Recording()
    robot.send(1, LEFT, 0.1, 0.14)
    assert robot.advance(
        LONGEST, lambda report: report.step_feedback.status_flags == STEPPING
    )
    robot.advance(0.4)
    # Over the standing leg the foot has to cross, and less is caught.
    force = robot.sim.robot.mass / PUSH_DURATION * np.array([*push, 0.0])
    robot.sim.apply_push("trunk", force, PUSH_DURATION)
    robot.advance(4.0)
    assert robot.texts("recovery")
    assert not robot.sim.has_fallen


def test_a_step_is_reported_as_it_is_taken():
    robot = Recording()
    right = soles(robot.sim)[RIGHT]
    robot.send(1, LEFT, 1.0, 0.9, yaw=1.0, max_foot_vel=0.25, lift_height=0.12)
    robot.advance(0.12)
    feedback = robot.report.step_feedback
    assert (feedback.current_step_index, feedback.next_step_index_needed) == (1, 2)
    spec, data = feedback.desired_step_spec_saturated, feedback.desired_step_saturated
    assert (spec.step_index, spec.foot_index) == (1, LEFT)
    # As far as a leg reaches, and no farther.
    place = spec.foot.position
    assert 0.2 < place.x - right[0] < 0.5
    assert 0.2 < place.y - right[1] < 0.6
    assert 0.3 < spec.foot.yaw < 0.7
    assert (data.pose.position.x, data.pose.position.y) == (place.x, place.y)
    assert spec.action.lift_height == 0.12
    # The foot's speed asks for more time than the message does.
    assert spec.action.step_duration > 2.0
    assert data.duration == spec.action.step_duration
    assert data.swing_height >= 0.12
    planned = spec.action.sway_duration + spec.action.step_duration + StepRules.settle
    assert feedback.t_step_rem == pytest.approx(planned - 0.12, abs=0.05)
    # It will land so far from where it was sent.
    (text,) = robot.texts("warning")
    away = math.hypot(place.x - 1.0, place.y - 0.9)
    assert f"step 1 is out of reach and ends {away:.2f} m" in text


def test_a_step_out_of_reach_is_refused_and_the_next_one_taken():
    robot = Recording(model="atlas_v3")
    # Too far down for its place, too far up, and beyond the edge of what is up there.
    for count, (x, z) in enumerate(((-0.25, -0.15), (0.2, 0.22), (0.6, 0.1)), 1):
        robot.send(1, LEFT, x, 0.13, z)
        robot.advance(0.04)
        left = robot.texts(STEPS_LEFT)
        assert len(left) == count
        assert "step 1 is not taken: it is out of reach" in left[-1]
        assert robot.report.step_feedback.current_step_index == 0
    robot.send(1, LEFT, 0.1, 0.13)
    robot.advance(0.06)
    assert robot.report.step_feedback.current_step_index == 1


# ---- MANIPULATE --------------------------------------------------------------


@pytest.mark.slow
def test_manipulate_takes_the_pose_that_is_granted():
    robot = Recording()
    tolerance = {"pelvis_yaw": 0.02, "pelvis_pitch": 0.02, "pelvis_roll": 0.02}
    command = AtlasSimInterfaceCommand(behavior="MANIPULATE")
    command.manipulate_params.use_desired = True
    desired = command.manipulate_params.desired
    heights = []
    # Far too deep and sideways; leaning and turned.
    for pose, granted in (
        ((0.1, 0.0, 0.0, -2.0, 1.0, 0.0), False),
        ((0.86, 0.1, 0.3, -0.1, -0.03, 0.04), True),
    ):
        names = ("height", "yaw", "pitch", "roll")
        names = [*(f"pelvis_{name}" for name in names), "com_v0", "com_v1"]
        for name, value in zip(names, pose, strict=True):
            setattr(desired, name, value)
        robot.sim.publish(command)
        for _ in range(190):
            robot.advance(LOOK)
            heights.append(robot.sim.pelvis_pose.translation()[2])
            load = np.abs(robot.sim.atlas_state.effort) / robot.sim.robot.effort_limit
            assert load.max() < 1.0
        feedback = robot.report.manipulate_feedback
        assert (feedback.clamped == desired) == granted
        for name in names:
            clamped, sensed = (
                getattr(one, name)
                for one in (feedback.clamped, feedback.internal_sensed)
            )
            assert sensed == pytest.approx(clamped, abs=tolerance.get(name, 0.01))
    assert not robot.sim.has_fallen
    middle = soles(robot.sim).mean(axis=0)
    assert heights[-1] - middle[2] == pytest.approx(0.86, abs=0.012)
    # No jerks on the way, once the soles have settled on the ground.
    speed = np.diff(heights[5:]) / LOOK
    assert np.abs(speed).max() < 0.15
    assert np.abs(np.diff(speed)).max() < 0.03


# ---- recovery ----------------------------------------------------------------


def pushed(speed, direction=(1.0, 0.0), behavior="STAND", **fields):
    """The simulation of a push on the standing robot, until it stands again."""
    robot = Recording(**fields)
    sim = robot.sim
    if behavior != "STAND":
        robot.ask(behavior)
    sim.advance(0.5)
    force = speed * sim.robot.mass / PUSH_DURATION * np.array([*direction, 0.0])
    sim.apply_push(sim.robot.file.chest, force, PUSH_DURATION)
    sim.advance(0.4)
    robot.advance(LONGEST, lambda report: report.current_behavior is not Behavior.WALK)
    sim.advance(0.5)
    return robot


@pytest.mark.slow
@pytest.mark.parametrize(
    ("behavior", "direction"), [("STAND", (1.0, 0.0)), ("MANIPULATE", (-1.0, 0.0))]
)
def test_a_pushed_robot_steps_and_stands_again(behavior, direction):
    robot = pushed(0.5, direction, behavior)
    assert not robot.sim.has_fallen
    assert in_stand(robot.report)
    assert robot.sim.footsteps[0]["error_m"] < 0.05  # From its own aim.
    texts = robot.texts("behavior")
    assert f"{behavior} -> WALK (by itself)" in texts
    assert texts[-1] == "WALK -> STAND (by itself)"
    assert robot.status & BehaviorStatus.WARNING_AUTO_TRANS
    assert np.linalg.norm(np.subtract(*soles(robot.sim))) < 0.3


@pytest.mark.slow
def test_without_recovery_steps_the_same_push_makes_it_fall():
    sim = pushed(0.5, controller={"stand": {"recovery_steps": False}}).sim
    sim.advance(1.5)
    assert sim.has_fallen
    assert not sim.footsteps
