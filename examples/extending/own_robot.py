"""A robot of your own: one from a folder stands, and takes a few steps.

    python examples/extending/own_robot.py [path/to/robot.yaml]

A robot is a URDF and a YAML file, here of Heron, a biped of 43 kg with 15 joints.
Gains, steps and limits come from that file; the controller is the same.
"""

import argparse
from pathlib import Path
from types import SimpleNamespace

from atlas_drake import (
    AtlasSimulation,
    Behavior,
    Scenario,
    StepStream,
    steps_ahead,
)

HERON = Path(__file__).parents[2] / "tests" / "robots" / "heron" / "heron.yaml"


def main():
    """Stands for a second, and walks."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robot", type=Path, nargs="?", default=HERON, help="YAML file")
    parser.add_argument("--distance", type=float, default=0.5, help="of the walk [m]")
    options = parser.parse_args()
    sim = AtlasSimulation(
        Scenario(model=str(options.robot)), listeners=[SimpleNamespace(event=print)]
    )
    robot = sim.robot
    print(f"{robot.name} has {robot.num_joints} joints: {', '.join(robot.joint_names)}")
    sim.advance(1.0)
    start = sim.pelvis_pose.translation()

    # The usual length and duration of its steps are in its file, too.
    gait = sim.scenario.controller_config().gait()
    report = sim.atlas_sim_interface_state
    walk = StepStream(steps_ahead(report, options.distance, gait))
    while not walk.is_over(sim.atlas_sim_interface_state) and not sim.has_fallen:
        sim.publish(walk.next_command(sim.atlas_sim_interface_state))
        sim.advance(0.1)

    way = sim.pelvis_pose.translation() - start
    stands = sim.current_behavior is Behavior.STAND and not sim.has_fallen
    print(f"{len(sim.footsteps)} steps, {way[0]:.2f} m")
    print("It stands." if stands else "It fell.")


if __name__ == "__main__":
    main()
