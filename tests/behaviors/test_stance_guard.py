"""The stance guard holds the pose without a leg to balance on: rule and change."""

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand
from atlas_drake.behaviors.balance import StanceConfig
from atlas_drake.behaviors.body_reference import capture_body
from atlas_drake.behaviors.stand.stance_guard import Holding
from atlas_drake.control.whole_body import ComTask
from atlas_drake.parts.manipulate.manipulate import Manipulate, ManipulateConfig

from .conftest import as_request

HEIGHT = 0.9
"""Of the CoM above the soles in STAND [m]."""


@pytest.fixture(scope="module")
def stand(make_tools):
    return make_tools(HEIGHT).stand()


@pytest.fixture(scope="module")
def manipulate(make_tools):
    tools = make_tools(HEIGHT)
    return tools.guarded(Manipulate(tools, ManipulateConfig()))


BOTH_HIPS = {"l_leg_hpy": 1.0, "r_leg_hpy": 1.0}


@pytest.mark.parametrize(
    ("shares", "balances"),
    [
        ({}, True),
        (BOTH_HIPS, False),
        ({"l_leg_aky": 1.0, "r_leg_aky": 1.0}, False),
        ({"l_leg_aky": 1.0, "r_leg_hpy": 1.0}, False),
        ({"l_leg_aky": 1.0, "l_leg_hpy": 1.0}, True),
        ({"l_leg_kny": 1.0, "r_leg_kny": 1.0}, True),
        ({"l_leg_akx": 1.0, "r_leg_akx": 1.0, "l_leg_hpx": 1.0}, True),
        ({"back_bky": 1.0, "l_arm_shx": 1.0}, True),
    ],
)
def test_balance_needs_hip_and_ankle_pitch_of_one_leg(stand, observe, shares, balances):
    assert stand.can_balance(observe(users=shares)) is balances


def test_a_shared_joint_counts_by_its_remaining_effort(robot, stand, observe):
    limit = robot.effort_limit[robot.joint_index("l_leg_hpy")]

    def balances_with(effort):
        shares = {"l_leg_hpy": 1.0 - effort / limit, "r_leg_hpy": 1.0}
        return stand.can_balance(observe(users=shares))

    least = StanceConfig().balance_effort
    assert balances_with(least + 0.1)
    assert not balances_with(least - 0.1)


def run(behavior, state, observations, command=None, leaving=False):
    """Outcomes of one tick after the other; ``state`` None enters first."""
    request = as_request(command or AtlasSimInterfaceCommand())
    outcomes = []
    for seen in observations:
        body = capture_body(seen.terms)
        if state is None:
            state = behavior.enter(seen, body, request)
        outcomes.append(behavior.update(state, seen, body, request, leaving))
        state = outcomes[-1].state
    return outcomes


def balances(command):
    """Whether a command moves the center of mass."""
    return any(isinstance(task, ComTask) for task in command.tasks)


def test_the_held_pose_gives_one_warning(stand, observe):
    balancing, first, second = run(
        stand, None, [observe(), observe(users=BOTH_HIPS), observe(users=BOTH_HIPS)]
    )
    assert balances(balancing.command)
    assert not balances(first.command)
    assert [event.kind for event in first.events] == ["warning"]
    assert second.events == ()
    np.testing.assert_array_equal(second.state.pose.joints, first.state.pose.joints)
    # Also where STAND is entered without a leg.
    (entered,) = run(stand, None, [observe(users=BOTH_HIPS)])
    assert isinstance(entered.state, Holding)
    # With a leg it balances again.
    (again,) = run(stand, second.state, [observe()])
    assert balances(again.command)
    assert not isinstance(again.state, Holding)


def test_leaving_ends_at_once_while_the_pose_is_held(manipulate, observe):
    (held,) = run(manipulate, None, [observe(users=BOTH_HIPS)])
    assert not held.finished
    (left,) = run(manipulate, held.state, [observe(users=BOTH_HIPS)], leaving=True)
    assert left.finished


def test_the_commanded_pose_survives_the_stance_guard(manipulate, observe):
    commanded = AtlasSimInterfaceCommand(behavior="MANIPULATE")
    commanded.manipulate_params.use_desired = True
    commanded.manipulate_params.desired.pelvis_height = 0.80
    outcomes = run(
        manipulate, None, [observe(), observe(users=BOTH_HIPS), observe()], commanded
    )
    # A message of another kind, such as one that gives the legs back, asks for nothing.
    silent = AtlasSimInterfaceCommand(behavior="MANIPULATE")
    held = outcomes[1].state
    (resumed,) = run(manipulate, held, [observe()], silent)
    for state in (outcomes[2].state, resumed.state):
        clamped = manipulate.feedback(state, 0).clamped
        assert clamped.pelvis_height == pytest.approx(0.80, abs=1e-6)


def test_the_measured_pose_is_updated_under_the_stance_guard(manipulate, observe):
    (held,) = run(manipulate, None, [observe(users=BOTH_HIPS)])
    tilted = observe(pitch=0.1, users=BOTH_HIPS)
    (later,) = run(manipulate, held.state, [tilted])
    sensed = manipulate.feedback(later.state, 0).internal_sensed
    assert sensed.pelvis_pitch == pytest.approx(0.1, abs=0.01)
