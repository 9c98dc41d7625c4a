"""A task of your own in the QP: the left hand tracks a circle while Atlas walks.

    python examples/extending/own_task.py

WALK with one more task, for which the posture of the arm is made cheap.
"""

import argparse
from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Behavior
from atlas_drake.behaviors.walk.walk import Walk
from atlas_drake.control.gains import PdGains
from atlas_drake.control.whole_body import PositionTask
from atlas_drake.shipped import shipped_entry

CENTER = np.array([0.40, 0.35, 0.25])  # of the circle, in the pelvis' frame P [m]
RADIUS, PERIOD = 0.12, 2.0  # [m], [s]
GAINS, WEIGHT = PdGains(kp=150.0, kd=25.0), 20.0  # [1/s²], [1/s]; [cost]/[m/s²]²


def circle(time):
    """Computes desired position in P [m] and velocity [m/s] of the hand."""
    rate = 2.0 * np.pi / PERIOD
    c, s = np.cos(rate * time), np.sin(rate * time)
    return CENTER + RADIUS * np.array([0.0, c, s]), RADIUS * rate * np.array([0, -s, c])


class WalkWithHand(Walk):
    """WALK, and the left hand goes round a circle in front of the pelvis."""

    def __init__(self, tools, config):
        super().__init__(tools, config)
        self._arm = tools.robot.limb("l_arm")

    def update(self, state, observation, body, request, leaving):
        """Computes one tick of WALK, and adds the task of the hand to its command."""
        outcome = super().update(state, observation, body, request, leaving)
        terms, P = observation.terms, observation.terms.frame("pelvis")
        p_PD, v_PD = circle(observation.time)
        p_WD, v_WD = P.p_WF + P.R_WF @ p_PD, P.V_WF[3:] + P.R_WF @ v_PD
        hand = PositionTask.tracking(terms, "l_hand", p_WD, GAINS, WEIGHT, v_WD)
        command = outcome.command.with_posture_scaled(self._arm, 0.01).plus(hand)
        return replace(outcome, command=command)


WALK = shipped_entry(Behavior.WALK)
WALK_WITH_HAND = replace(
    WALK, name="WALK_WITH_HAND", number=101, make=WalkWithHand, follows=("STAND",)
)
behaviors = [WALK_WITH_HAND]  # what --with takes from this file


def main():
    """Walks a few steps, and stops."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=float, default=6.0, help="of walking [s]")
    options = parser.parse_args()
    sim = AtlasSimulation(behaviors=behaviors, listeners=[SimpleNamespace(event=print)])
    errors, command = [], AtlasSimInterfaceCommand(behavior="WALK_WITH_HAND")
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    while sim.time < options.seconds:
        sim.advance(0.02)
        X_PH = sim.pelvis_pose.inverse() @ sim.frame_pose("l_hand")
        errors.append(np.linalg.norm(X_PH.translation() - circle(sim.time)[0]))
    settled = 1e3 * np.array(errors[50:])  # [mm]; the first second is the way there
    print(f"error {settled.mean():.0f} mm in the mean, {settled.max():.0f} mm at most")
    sim.publish(AtlasSimInterfaceCommand(behavior="STAND"))
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.STAND or sim.has_fallen)
    print("It fell." if sim.has_fallen else "It stands.")


if __name__ == "__main__":
    main()
