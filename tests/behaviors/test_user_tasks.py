"""A task that a user's behavior appends, in the closed loop with the physics."""

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.extended import Extended
from atlas_drake.control.gains import PdGains
from atlas_drake.control.whole_body import PositionTask

HAND = "l_hand"
GAINS = PdGains(kp=100.0, kd=20.0)
AWAY = np.array([0.10, 0.05, 0.12])
"""Of the hand's goal from where it is at the start [m]."""


def hand_position(sim):
    plant = sim.plant
    context = plant.GetMyContextFromRoot(sim.context)
    body = plant.GetBodyByName(HAND)
    return np.array(plant.EvalBodyPoseInWorld(context, body).translation())


def run():
    """Makes a STAND whose left hand holds a point in the world; returns the errors."""

    def make(tools, _config):
        arm = tools.robot.limb("l_arm")

        def hold_the_hand(command, seen):
            hand = PositionTask.tracking(seen.terms, HAND, goal, GAINS, 20.0)
            return command.with_posture_scaled(arm, 0.01).plus(hand)

        return Extended(tools.stand(), hold_the_hand)

    sim = AtlasSimulation(behaviors=[BehaviorEntry(name="HOLD", number=100, make=make)])
    goal = hand_position(sim) + AWAY
    sim.publish(AtlasSimInterfaceCommand(behavior="HOLD"))
    errors = []
    for _ in range(10):
        sim.advance(0.15)
        errors.append(np.linalg.norm(hand_position(sim) - goal))
    return sim, np.array(errors)


@pytest.mark.slow
def test_a_hand_holds_a_point_in_the_world_while_the_robot_stands():
    sim, errors = run()
    assert not sim.has_fallen
    assert errors[0] > 0.05
    # Critically damped at 10 1/s; what is left is what the arm's posture holds back.
    assert errors[-1] < 0.005
    # A second run gives the same bits.
    np.testing.assert_array_equal(run()[1], errors)
