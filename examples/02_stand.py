"""Behavior mode: STAND balances, also when Atlas is pushed."""

import argparse
import signal
import sys

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Behavior

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

sim = AtlasSimulation(view=not options.headless)

command = AtlasSimInterfaceCommand()
command.behavior = command.STAND
command.k_effort = [0] * sim.robot.num_joints  # 0: all joints are the behavior's
sim.publish(command)
sim.advance(1.0)


def report(what: str) -> None:
    """Prints the behavior and the position of the pelvis."""
    state = sim.atlas_sim_interface_state
    at = state.pos_est.position
    name = Behavior(state.current_behavior).name
    print(f"{sim.time:5.2f} s  {name:6} pelvis at x {at.x:+.3f} y {at.y:+.3f}  {what}")


def is_still(sim: AtlasSimulation) -> bool:
    """Returns True once no joint moves."""
    return max(abs(v) for v in sim.atlas_state.velocity) < 0.05  # [rad/s]


report("at rest")
for force, where in (([150.0, 0.0, 0.0], "forward"), ([0.0, 100.0, 0.0], "left")):
    sim.apply_push("trunk", force, 0.1)  # [N] for 0.1 s
    sim.advance(0.3)
    report(f"pushed {where}")
    took = sim.wait_until(is_still, timeout=5.0, what="rest after the push")
    report(f"recovered, {took:.1f} s later")

print("Atlas fell." if sim.has_fallen else "Atlas still stands.")
sys.exit(sim.has_fallen)
