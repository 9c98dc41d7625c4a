"""Your own world: a ball is thrown at Atlas, and the log shows the impact.

    python examples/extending/own_world.py

A world is made by functions that add to Drake's plant before it is finalized.
"""

import tempfile
from pathlib import Path

import numpy as np
from pydrake.geometry import Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import SpatialInertia

from atlas_drake import AtlasSimulation, read_log

RADIUS, MASS = 0.1, 2.0  # of the ball [m], [kg]
START, SPEED = np.array([2.5, 0.0, 1.2]), 5.0  # in W [m], of the throw [m/s]
GRAVITY = 9.81  # [m/s²]
ORANGE = np.array([1.0, 0.5, 0.1, 1.0])


def add_ball(plant):
    """Adds a ball that floats freely."""
    instance = plant.AddModelInstance("ball")
    inertia = SpatialInertia.SolidSphereWithMass(MASS, RADIUS)
    ball = plant.AddRigidBody("ball", instance, inertia)
    shape, middle = Sphere(RADIUS), RigidTransform()
    plant.RegisterVisualGeometry(ball, middle, shape, "ball", ORANGE)
    friction = CoulombFriction(0.5, 0.5)
    plant.RegisterCollisionGeometry(ball, middle, shape, "ball", friction)
    plant.SetDefaultFloatingBaseBodyPose(ball, RigidTransform(START))


def throw(sim, speed):
    """Lets the ball fly towards the robot's chest from where it is."""
    velocity = np.array([-speed, 0.0, 0.5 * GRAVITY * START[0] / speed])
    sim.plant.SetFreeBodySpatialVelocity(
        sim.plant.GetMyMutableContextFromRoot(sim.context),
        sim.plant.GetBodyByName("ball"),
        SpatialVelocity(np.zeros(3), velocity),
    )


def find_hit(log):
    """Finds the time of the first impact [s], and its impulse [N·s], shape (3,)."""
    axes = [log[f"world.v.ball_ball_v{axis}"] for axis in "xyz"]
    step = np.diff(log.time)[:, None]
    change = np.diff(np.column_stack(axes), axis=0)
    impulses = MASS * (change - step * [0.0, 0.0, -GRAVITY])  # of contact, per tick
    hit = np.linalg.norm(impulses, axis=1) > 0.01
    first = int(np.argmax(hit))
    last = first + int(np.argmin(hit[first:]))
    return log.time[first], impulses[first:last].sum(axis=0)


world = [add_ball]  # what --with takes from this file


def main():
    """Throws, and reads the log."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        with AtlasSimulation(world=world, log=path) as sim:
            throw(sim, SPEED)
            sim.advance(2.0)
        log = read_log(path)
    time, impulse = find_hit(log)
    print(*sim.events, sep="\n")
    print(f"The ball hit at {time:.3f} s with {np.linalg.norm(impulse):.1f} N·s.")
    sway = np.abs(log["balance.com_velocity.x"]).max()
    print(f"Its center of mass moved at {sway:.2f} m/s at most.")
    print("It fell." if sim.has_fallen else "It stands.")


if __name__ == "__main__":
    main()
