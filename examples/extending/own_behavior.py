"""A behavior of your own: BOW, which bends the trunk forward while Atlas balances.

    python examples/extending/own_behavior.py

One function and one entry: BOW is requested, refused, logged and drawn like STAND.
"""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.messages.checks import check_number
from atlas_drake.units import Radians

LOWERING = 0.05  # of the center of mass in a bow of 1 rad [m]


@dataclass
class BowParams:
    """Parameters of BOW."""

    depth: Radians = 0.4  # of the bow


def check_bow(params, field):
    """Refuses a bow beyond the range of the back."""
    check_number(params.depth, f"{field}.depth", 0.0, 0.6)


def make_bow(tools, config):
    """STAND with the back bent: balance and feet are as there."""
    back = tools.robot.joint_index("back_bky")

    def pose(upright, observation, request, leaving):
        """Goals of trunk and posture; upright again once STAND is requested."""
        depth = 0.0 if leaving else (request.command.params or BowParams()).depth
        joints = upright.joints.copy()
        joints[back] += depth
        height = upright.height - LOWERING * depth
        chest_tilt = np.array([0.0, depth])
        return replace(upright, chest_tilt=chest_tilt, joints=joints, height=height)

    return tools.stand(pose)


BOW = BehaviorEntry(
    name="BOW",
    number=100,
    make=make_bow,
    params=BowParams,
    check=check_bow,
    color="#795548",
)
behaviors = [BOW]  # what --with takes from this file


def main():
    """Bows, and stands up again."""
    sim = AtlasSimulation(behaviors=behaviors, listeners=[SimpleNamespace(event=print)])
    sim.publish(AtlasSimInterfaceCommand(behavior="BOW", params=BowParams(depth=0.4)))
    sim.advance(3.0)
    bend = sim.atlas_state.position[sim.robot.joint_index("back_bky")]
    print(f"{sim.current_behavior}: the back is bent by {bend:.2f} rad.")
    sim.publish(AtlasSimInterfaceCommand(behavior="STAND"))
    sim.wait_until(lambda sim: sim.current_behavior.name == "STAND")
    print("It fell." if sim.has_fallen else "It stands.")


if __name__ == "__main__":
    main()
