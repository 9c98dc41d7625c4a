"""Obstacles: Atlas walks up stairs, up a ramp or over tilted blocks.

The robot sees no ground. The footholds come from the world's own boxes: where each sole
shall land, how high that is, and how the ground is tilted there.
"""

import argparse
import signal
import sys

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Quaternion,
    Scenario,
    StepStream,
    Vector3,
)
from atlas_drake.worlds.terrain import Block, surface_height
from atlas_drake.worlds.world_file import World

HALF_WIDTH = 0.13
"""Of each foot from the middle [m]."""
TOE = 0.16
"""From the middle of a sole to an edge that it keeps clear of [m]."""
STRIDE = 0.3
"""Between footholds on a slope and on a landing [m]."""


def rows(world: World) -> list[float]:
    """Where both feet come to stand side by side, along x in the world [m]."""
    if world.stairs is not None:
        stairs = world.stairs
        treads = [(step + 0.5) * stairs.run for step in range(stairs.number)]
        return [stairs.position[0] + x for x in (*treads, treads[-1] + STRIDE)]
    if world.ramp is not None:
        _, landing = world.terrain()
        end = landing.position[0] - 0.5 * landing.size[0]
        places = [world.ramp.position[0] + TOE]
        while places[-1] + STRIDE + TOE < end:
            places.append(places[-1] + STRIDE)
        return [*places, end - TOE, end + TOE]
    blocks = world.blocks
    pitch = blocks.size + blocks.gap
    return [
        blocks.position[0] + 0.5 * blocks.size + row * pitch
        for row in range(blocks.rows + 1)  # The last one is behind the blocks.
    ]


def foothold(terrain: list[Block], x: float, y: float) -> tuple[Vector3, Quaternion]:
    """The highest surface at a place: where it is, and its tilt."""
    place = Vector3(x, y, surface_height(terrain, x, y))
    if place.z == 0.0:  # The ground.
        return place, Quaternion()
    top = max(terrain, key=lambda block: surface_height([block], x, y))
    tilt = top.X_WT.rotation().ToQuaternion()
    return place, Quaternion.from_wxyz(tilt.wxyz())


def normal(orientation: Quaternion) -> Vector3:
    """The z axis of a sole on the ground."""
    w, x, y, z = orientation.to_wxyz()
    return Vector3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))


def steps_over(world: World) -> list[AtlasBehaviorStepData]:
    """Steps to every row, left foot first."""
    terrain, steps = world.terrain(), []
    for x in rows(world):
        for foot, y in enumerate((HALF_WIDTH, -HALF_WIDTH)):
            step = AtlasBehaviorStepData()
            step.step_index, step.foot_index = len(steps) + 1, foot
            step.duration, step.swing_height = 0.63, 0.15
            step.pose.position, step.pose.orientation = foothold(terrain, x, y)
            steps.append(step)
    return steps


def walk(sim: AtlasSimulation, steps: list[AtlasBehaviorStepData]) -> None:
    """Takes the steps in one go, each in 0.63 s."""
    stream = StepStream(steps)
    while not (stream.is_over(sim.atlas_sim_interface_state) or sim.has_fallen):
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance(0.1)


def step(sim: AtlasSimulation, steps: list[AtlasBehaviorStepData]) -> None:
    """Takes one step after the other, each with a rest."""
    for number, data in enumerate(steps, start=1):
        command = AtlasSimInterfaceCommand(behavior="STEP")
        command.step_params.use_spec = True
        spec = command.step_params.desired_step_spec
        spec.step_index, spec.foot_index = data.step_index, data.foot_index
        spec.foot.position = data.pose.position
        spec.foot.normal = normal(data.pose.orientation)
        spec.action.lift_height = 0.1  # Straight up, before it moves ahead.
        sim.publish(command)
        sim.advance(0.1)  # It has begun then.
        sim.wait_until(
            lambda sim: (
                sim.has_fallen
                or sim.atlas_sim_interface_state.step_feedback.t_step_rem <= 0.0
            ),
            what=f"the end of step {number}",
        )
        if sim.has_fallen or len(sim.footsteps) < number:
            return
    sim.publish(AtlasSimInterfaceCommand(behavior="STAND"))


def main() -> None:
    """Runs the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    parser.add_argument("--world", choices=("stairs", "ramp", "blocks"))
    parser.add_argument("--behavior", choices=("walk", "step"))
    parser.set_defaults(world="stairs", behavior="walk")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

    sim = AtlasSimulation(Scenario(world=options.world), view=not options.headless)
    steps = steps_over(sim.scenario.world)
    sim.advance(0.5)
    {"walk": walk, "step": step}[options.behavior](sim, steps)
    sim.advance(1.0)
    for taken in sim.footsteps:
        print(
            f"step {taken['index']} landed {1e3 * taken['error_m']:.0f} mm off, at a "
            f"height of {taken['landed_height']:.3f} m"
        )
    done = not sim.has_fallen and len(sim.footsteps) == len(steps)
    print("Atlas stands behind it." if done else "Atlas did not get there.")
    sys.exit(not done)


if __name__ == "__main__":
    main()
