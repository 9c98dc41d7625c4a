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


@pytest.mark.slow
def test_a_hand_holds_a_point_in_the_world_while_the_robot_stands():
    def make(tools, _config):
        arm = tools.robot.limb("l_arm")

        def hold_the_hand(command, seen):
            hand = PositionTask.tracking(seen.terms, HAND, goal, GAINS, 20.0)
            return command.with_posture_scaled(arm, 0.01).plus(hand)

        return Extended(tools.stand(), hold_the_hand)

    sim = AtlasSimulation(behaviors=[BehaviorEntry(name="HOLD", number=100, make=make)])
    goal = sim.frame_pose(HAND).translation() + AWAY
    sim.publish(AtlasSimInterfaceCommand(behavior="HOLD"))
    sim.advance(1.5)
    assert not sim.has_fallen
    # Critically damped at 10 1/s; what is left is what the arm's posture holds back.
    assert np.linalg.norm(sim.frame_pose(HAND).translation() - goal) < 0.005
