"""A tour of waypoints, with the arms in your hands and a punch at each.

In the page the sliders of the arms are yours, and the robot steers itself; its next
waypoint is a red pole. --headless drives the arms, too.
"""

import argparse
import math
import sys

import numpy as np
from pydrake.geometry import Cylinder, Rgba
from pydrake.math import RigidTransform

from atlas_drake import AtlasCommand, AtlasSimulation, walk_to
from atlas_drake.clients.cli.interrupts import ctrl_c
from atlas_drake.clients.cockpit.cockpit import open_cockpit

PIECE, POLL = 0.02, 0.1  # between two looks at Ctrl+C, and two commands [s]
EACH = 5.0  # time for a waypoint [s]
LINKS = ("pelvis", "utorso", "head", "l_uarm", "r_uarm", "l_hand", "r_hand")

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no page, driven arms")
parser.add_argument("--waypoints", type=int, default=3, help="number of them")
parser.add_argument("--punch", type=float, default=4.0, help="force per mass [N/kg]")
parser.add_argument("--seed", type=int, default=1, help="of waypoints and punches")
options = parser.parse_args()

random = np.random.default_rng(options.seed)
if options.headless:
    sim, cockpit = AtlasSimulation(), None
else:
    sim, cockpit = open_cockpit()  # Prints the address of the page.
gait = sim.scenario.controller_config().gait()
arms = sim.robot.limb("l_arm", "r_arm")


def hold_arms():
    """Gives the arms to the user; without a page they swing."""
    command = AtlasCommand(k_effort=np.where(arms, 255, 0))
    swing = 0.2 * math.sin(2.0 * sim.time) if options.headless else 0.0
    command.position = sim.robot.stand_prep + swing * arms
    sim.publish(command)


def punch():
    """Punches a random link, in any horizontal direction."""
    angle, link = random.uniform(-math.pi, math.pi), random.choice(LINKS)
    force = options.punch * sim.robot.mass
    sim.apply_push(link, [force * math.cos(angle), force * math.sin(angle), 0.0], 0.08)


def visit(place, heading, stop):
    """Steers to a waypoint for some seconds."""
    if cockpit:
        pole = RigidTransform([*place, 0.5])
        cockpit.meshcat.SetObject("waypoint", Cylinder(0.02, 1.0), Rgba(0.8, 0.1, 0.1))
        cockpit.meshcat.SetTransform("waypoint", pole)
    end, due = sim.time + EACH, sim.time
    while sim.time < end and not (sim.has_fallen or stop()):
        if sim.time >= due:
            due += POLL
            report = sim.atlas_sim_interface_state
            sim.publish(walk_to(report, sim.pelvis_pose, place, heading, gait))
            if options.headless:
                hold_arms()
        sim.advance(PIECE)


with ctrl_c() as asked_to_stop:
    if cockpit:
        cockpit.asked_to_stop = asked_to_stop.is_set
    hold_arms()
    sim.advance(1.0)
    for _ in range(options.waypoints):
        if options.punch:
            punch()
        place = 0.3 + random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7)
        visit(place, random.uniform(-math.pi, math.pi), asked_to_stop.is_set)
print("Atlas fell." if sim.has_fallen else "Atlas completed its tour.")
sys.exit(sim.has_fallen)
