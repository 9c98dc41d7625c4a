"""A behavior of your own: BOW, which bends the trunk forward while Atlas balances.

    python examples/extending/own_behavior.py

One class and one entry: BOW is requested, refused, logged and drawn like STAND.
"""

from dataclasses import dataclass, replace

import numpy as np

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.stand.stand import Stand
from atlas_drake.messages.checks import check_number

LOWERING = 0.05  # of the center of mass in a bow of 1 rad [m]


@dataclass
class BowParams:
    """Parameters of BOW."""

    depth: float = 0.4  # of the bow [rad]


def check_bow(params, field):
    """Refuses a bow beyond the range of the back."""
    check_number(params.depth, f"{field}.depth", 0.0, 0.6)


class Bow(Stand):
    """STAND with the back bent: balance and feet are as there."""

    def __init__(self, tools, config):
        super().__init__(tools.balance, tools.nominal_height, tools.rates)
        self._robot = tools.robot

    def target(self, state, observation, request, leaving):
        """Goals of trunk and posture; upright again once STAND is requested."""
        depth = 0.0 if leaving else (request.command.params or BowParams()).depth
        upright = super().target(state, observation, request, leaving)
        joints = self._robot.stand_prep.copy()
        joints[self._robot.joint_index("back_bky")] += depth
        height = upright.height - LOWERING * depth
        chest_tilt = np.array([0.0, depth])
        return replace(upright, chest_tilt=chest_tilt, joints=joints, height=height)

    def update(self, state, observation, body, request, leaving):
        """One tick; the behavior is over when the chest is upright again."""
        outcome = super().update(state, observation, body, request, leaving)
        return replace(outcome, finished=leaving and outcome.body.chest_tilt[1] < 0.01)


BOW = BehaviorEntry(
    name="BOW",
    number=100,
    make=lambda tools, config: tools.guarded(Bow(tools, config)),
    params=BowParams,
    check=check_bow,
    caption="bowing",
    color="#795548",
)
behaviors = [BOW]  # what --with takes from this file


def main():
    """Bows, and stands up again."""
    sim = AtlasSimulation(behaviors=behaviors, on_event=print)
    sim.publish(AtlasSimInterfaceCommand(behavior="BOW", params=BowParams(depth=0.4)))
    sim.advance(3.0)
    bend = sim.atlas_state.position[sim.robot.joint_index("back_bky")]
    print(f"{sim.current_behavior}: the back is bent by {bend:.2f} rad.")
    sim.publish(AtlasSimInterfaceCommand(behavior="STAND"))
    sim.wait_until(lambda sim: sim.current_behavior.name == "STAND")
    print("It fell." if sim.has_fallen else "It stands.")


if __name__ == "__main__":
    main()
