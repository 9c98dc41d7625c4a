"""STEP: one quasi-static step at a time, here up a block of 12 cm."""

import argparse
import signal
import sys

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Block,
    Scenario,
)

RISE = 0.12  # [m]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

block = Block(size=[0.8, 1.2, RISE], position=[0.6, 0.0, RISE])
sim = AtlasSimulation(Scenario(terrain=[block]), view=not options.headless)

# Foot (0 left, 1 right), then x, y, z of the sole in the world [m].
FOOTHOLDS = [
    (0, 0.35, 0.12, RISE),
    (1, 0.35, -0.12, RISE),
]


def is_done(sim: AtlasSimulation) -> bool:
    """Returns True once the step has ended, completed or not."""
    feedback = sim.atlas_sim_interface_state.step_feedback
    return feedback.t_step_rem <= 0.0 or sim.has_fallen


def take_step(index: int, foot: int, x: float, y: float, z: float) -> None:
    """Requests one step and waits until the robot needs the next one."""
    command = AtlasSimInterfaceCommand()
    command.behavior = command.STEP
    command.step_params.use_spec = True
    spec = command.step_params.desired_step_spec
    spec.step_index, spec.foot_index = index, foot
    spec.foot.position.x, spec.foot.position.y = x, y
    spec.foot.position.z = z
    spec.action.lift_height = 0.1  # straight up, before it moves ahead
    sim.publish(command)
    sim.advance(0.1)  # it has begun then
    sim.wait_until(is_done, what=f"the end of step {index}")


for number, foothold in enumerate(FOOTHOLDS, start=1):
    take_step(number, *foothold)
    if sim.has_fallen or len(sim.footsteps) < number:
        break
    landed = sim.footsteps[-1]
    print(
        f"{sim.time:5.2f} s  step {number} landed {1e3 * landed['error_m']:.0f} mm off,"
        f" at a height of {landed['landed_height']:.3f} m"
    )

command = AtlasSimInterfaceCommand()
command.behavior = command.STAND  # at once: both feet are on the ground
sim.publish(command)
sim.advance(1.5)
up = all(
    foot.position.z > 0.9 * RISE for foot in sim.atlas_sim_interface_state.foot_pos_est
)
done = up and sim.current_behavior is Behavior.STAND and not sim.has_fallen
print("Atlas stands on the block." if done else "Atlas did not make it.")
sys.exit(not done)
