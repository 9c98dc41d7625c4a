"""Measures the speed of the tutorial relative to the bare plant.

Machines drift, so that bare and closed-loop pieces alternate and only their ratio
counts. The robot's motion is not judged, except that it must not fall.
"""

from __future__ import annotations

import argparse
import logging
import statistics
import sys
import time

import numpy as np
from pydrake.geometry import HalfSpace
from pydrake.math import RigidTransform
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import PdControllerGains
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from report import command_line, write_figures

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.diagrams.standing import place_robot
from atlas_drake.robot import Robot, load_robot
from atlas_drake.simulation.start import draw_variation, scale_masses
from atlas_drake.simulation.tutorial import DURATION

PIECE = 0.5
"""Simulated time between changes from closed loop to bare plant [s]."""
UPRIGHT_SHARE = 0.9
"""Height of the bare plant's pelvis, over its initial height, below which it fell
[-]."""
GOALS = {
    "ratio": ("closed loop / bare plant", "<=", 2.5, ""),
    "real_time_factor": ("real-time factor", ">=", 1.2, ""),
    "tick_median": ("median controller tick", "<=", 0.6, "ms"),
}
"""By key: description, comparison, goal and unit."""


class BarePlant:
    """The station's plant alone, held in stand-prep by the plant's own PD."""

    def __init__(self, robot: Robot, scenario: Scenario):
        self._robot = robot
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlant(
            MultibodyPlantConfig(
                time_step=scenario.physics_step,
                discrete_contact_approximation=scenario.plant.discrete_contact_approximation,
                contact_model="point",
                # As in the station; sampled ports would add their cost to each step.
                use_sampled_output_ports=False,
            ),
            builder,
        )
        instance = robot.add_to(plant)
        friction = CoulombFriction(scenario.ground_friction, scenario.ground_friction)
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(), HalfSpace(), "ground", friction
        )
        for entry in robot.file.joints:
            actuator = self._actuator(plant, entry.name)
            actuator.set_controller_gains(PdControllerGains(p=entry.kp, d=entry.kd))
        plant.Finalize()
        self._plant = plant
        self._simulator = Simulator(builder.Build())
        context = self._simulator.get_mutable_context()
        plant_context = plant.GetMyMutableContextFromRoot(context)
        variation = draw_variation(scenario, robot)
        scale_masses(plant, plant_context, robot, variation)
        place_robot(
            plant,
            plant_context,
            robot,
            position=variation.position,
            rpy=variation.rpy,
            joints=variation.joints,
        )
        wanted = np.zeros(robot.num_joints)
        for entry in robot.file.joints:
            start = self._actuator(plant, entry.name).input_start()
            wanted[start] = entry.stand_prep
        plant.get_desired_state_input_port(instance).FixValue(
            plant_context, np.concatenate([wanted, np.zeros_like(wanted)])
        )
        self._simulator.Initialize()

    @staticmethod
    def _actuator(plant, joint: str):
        return next(
            actuator
            for actuator in map(
                plant.get_joint_actuator, plant.GetJointActuatorIndices()
            )
            if actuator.joint().name() == joint
        )

    def advance(self, seconds: float) -> float:
        """Simulates; returns the wall time [s]."""
        end = self._simulator.get_context().get_time() + seconds
        begin = time.perf_counter()
        self._simulator.AdvanceTo(end)
        return time.perf_counter() - begin

    def pelvis_height(self) -> float:
        """Height of the pelvis in the world [m]."""
        context = self._plant.GetMyContextFromRoot(self._simulator.get_context())
        pelvis = self._plant.GetBodyByName(self._robot.file.pelvis)
        pose = self._plant.EvalBodyPoseInWorld(context, pelvis)
        return float(pose.translation()[2])


def measure(model: str) -> dict:
    """Runs the tutorial and the bare plant in turns."""
    scenario = Scenario(
        name="tutorial",
        model=model,
        programme="tutorial",
        duration=DURATION,
        physics_step=0.001,
        control_period=0.002,
    )
    bare = BarePlant(load_robot(model), scenario)
    start_height = bare.pelvis_height()
    sim = AtlasSimulation(scenario)
    closed_walls, bare_walls = [], []
    for piece in range(round(DURATION / PIECE)):
        begin = time.perf_counter()
        sim.advance_to((piece + 1) * PIECE)
        closed_walls.append(time.perf_counter() - begin)
        bare_walls.append(bare.advance(PIECE))
        print(f"\r{sim.time:5.1f} of {DURATION:g} s", end="", flush=True)
    print("\r" + " " * 20 + "\r", end="")
    steps = PIECE / scenario.physics_step
    total_steps = steps * len(bare_walls)
    bare_step = 1e3 * sum(bare_walls) / total_steps
    closed_step = 1e3 * sum(closed_walls) / total_steps
    pairs = [c / b for c, b in zip(closed_walls, bare_walls, strict=True)]
    summary = sim.summary()
    return {
        "model": model,
        "physics_step": scenario.physics_step,
        "control_period": scenario.control_period,
        "sim_time": sim.time,
        "success": summary["success"],
        "bare_upright": bare.pelvis_height() > UPRIGHT_SHARE * start_height,
        "bare_step_ms": bare_step,
        "closed_loop_ms_per_step": closed_step,
        "ratio": closed_step / bare_step,
        "ratio_median_of_pieces": statistics.median(pairs),
        "bare_step_ms_median_of_pieces": 1e3 * statistics.median(bare_walls) / steps,
        "closed_loop_ms_per_step_median_of_pieces": (
            1e3 * statistics.median(closed_walls) / steps
        ),
        "real_time_factor": sim.time / sum(closed_walls),
        "tick_ms": summary["controller_tick_ms"],
    }


def print_table(result: dict) -> bool:
    """Prints the figures beside their goals; returns whether all are met."""
    print(f"bare plant            {result['bare_step_ms']:6.3f} ms per step")
    print(f"closed loop           {result['closed_loop_ms_per_step']:6.3f} ms per step")
    tick = result["tick_ms"]
    print(
        f"controller tick       {tick['median']:6.3f} ms median,"
        f" {tick['p99']:.3f} p99, {tick['max']:.3f} max"
    )
    values = {**result, "tick_median": tick["median"]}
    met_all = True
    for key, (label, side, goal, unit) in GOALS.items():
        value = values[key]
        met = value <= goal if side == "<=" else value >= goal
        met_all = met_all and met
        verdict = "met" if met else "NOT MET"
        print(f"{label:26} {value:6.3f} {unit:2}  goal {side} {goal:<4} {verdict}")
    for key, text in (
        ("success", "the tutorial failed: its time means nothing"),
        ("bare_upright", "the bare plant fell: its time means nothing"),
    ):
        if not result[key]:
            met_all = False
            print(text)
    return met_all


def main() -> int:
    """The command line; status 1 when a goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--model", default="atlas", help="robot (default: atlas)")
    options = command_line(parser)
    logging.getLogger("drake").setLevel(logging.ERROR)
    result = measure(options.model)
    met = print_table(result)
    write_figures(options.json, result)
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
