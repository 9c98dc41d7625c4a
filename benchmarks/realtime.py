"""Measures the speed of the tutorial relative to the bare plant, and where a tick goes.

Machines drift, so that the bare plant and the closed loops run in turns and only ratios
count: the median of all pieces, and the range of the middle 80 %. The robot's motion is
not judged, except that it must not fall.
"""

from __future__ import annotations

import argparse
import logging
import math
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import PdControllerGains
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from report import command_line, write_figures

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
)
from atlas_drake.behaviors.supervisor import Supervisor
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.control.whole_body.qp import WholeBodyQp
from atlas_drake.diagrams.standing import place_robot
from atlas_drake.messages import NUM_REQUIRED_WALK_STEPS
from atlas_drake.planning.footholds import foothold, step_data
from atlas_drake.robot import Robot, load_robot, soles
from atlas_drake.simulation.beginning import draw_variation, scale_masses
from atlas_drake.simulation.tutorial import DURATION
from atlas_drake.systems.tick_recorder import TickRecorder
from atlas_drake.worlds.scenery import add_scenery

PIECE = 0.5
"""Simulated time between changes from closed loop to bare plant [s]."""
UPRIGHT_SHARE = 0.9
"""Height of the bare plant's pelvis, over its initial height, below which it fell
[-]."""
BARE_STEP = 0.001
"""Step of the bare plant, the unit of all ratios [s]."""
PIECES = 8
"""Number of such pieces of a walk with steps to come."""
BEGUN = 1.5
"""Time after which such a walk is under way [s]."""
RESETS = 5
"""Number of resets whose median counts."""
GOALS = {
    "default": ("closed loop at the default steps / bare plant", 1.05),
    "tick": ("median controller tick / step of the bare plant", 2.0),
    "mcap": ("run with an .mcap log / without", 1.10),
    "view": ("run with a 3D view / without", 1.05),
    "soles": ("run with soles / with their four corners alone", 1.05),
    "pending": ("walk with 10,000 steps to come / with 100", 1.1),
    "reset_s": ("new run by reset(seed=...) [s]", 0.05),
    "memory": ("resident memory / that of Drake with the bare plant", 1.1),
}
"""By key: description, and the largest value that meets the goal."""
STAGES = {
    "terms": (WholeBodyModel, "evaluate"),
    "behavior": (Supervisor, "update"),
    "QP": (WholeBodyQp, "solve"),
    "record": (TickRecorder, "_latch"),
}
"""By name: the method that does a part of each tick. The controller's tick is the first
three, its ports and its state; the recorder latches the tick's numbers after it."""


class BarePlant:
    """The station's plant alone, held in stand-prep by the plant's own PD."""

    def __init__(self, robot: Robot, scenario: Scenario):
        self._robot = robot
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlant(
            MultibodyPlantConfig(
                time_step=BARE_STEP,
                discrete_contact_approximation=scenario.plant.discrete_contact_approximation,
                contact_model="hydroelastic_with_fallback",
                # As in the station; sampled ports would add their cost to each step.
                use_sampled_output_ports=False,
            ),
            builder,
        )
        instance = robot.add_to(plant)
        add_scenery(plant, (), scenario.ground_friction)
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


@contextmanager
def timed_stages() -> Iterator[dict[str, list[float]]]:
    """Notes the wall time of every call of the stages' methods [s]."""
    found: dict[str, list[float]] = {name: [] for name in STAGES}
    kept = {name: getattr(*place) for name, place in STAGES.items()}

    def timed(name):
        method, times = kept[name], found[name]

        def call(*arguments):
            begin = time.perf_counter()
            answer = method(*arguments)
            times.append(time.perf_counter() - begin)
            return answer

        return call

    for name, (owner, method) in STAGES.items():
        setattr(owner, method, timed(name))
    try:
        yield found
    finally:
        for name, (owner, method) in STAGES.items():
            setattr(owner, method, kept[name])


def in_turns(model: str) -> tuple[dict[str, list[float]], AtlasSimulation, bool]:
    """Runs the tutorial in several ways and the bare plant in turns.

    Returns:
        Wall times of all pieces [s], by name; the run without log and view, and whether
        the bare plant stood.
    """
    scenario = Scenario(
        name="tutorial", model=model, schedule="tutorial", duration=DURATION
    )
    bare = BarePlant(load_robot(model), scenario)
    start_height = bare.pelvis_height()
    walls: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        runs = {
            "default": AtlasSimulation(scenario),
            "mcap": AtlasSimulation(scenario, log=Path(folder) / "run.mcap"),
            # Pictures are sent whether or not a browser is there to draw them.
            "view": AtlasSimulation(scenario, view=Meshcat()),
        }
        with corners_alone():
            runs["corners"] = AtlasSimulation(scenario)
        for piece in range(round(DURATION / PIECE)):
            for name, sim in runs.items():
                begin = time.perf_counter()
                sim.advance_to((piece + 1) * PIECE)
                walls.setdefault(name, []).append(time.perf_counter() - begin)
            walls.setdefault("bare", []).append(bare.advance(PIECE))
            print(f"\r{sim.time:5.1f} of {DURATION:g} s", end="", flush=True)
        begin = time.perf_counter()
        runs["mcap"].close()
        walls["mcap"][-1] += time.perf_counter() - begin
    print("\r" + " " * 20 + "\r", end="")
    stood = bare.pelvis_height() > UPRIGHT_SHARE * start_height
    return walls, runs["default"], stood


@contextmanager
def corners_alone() -> Iterator[None]:
    """Lets robots that are loaded meanwhile touch by the corners of their soles."""
    kept, soles.SPACING = soles.SPACING, math.inf
    try:
        yield
    finally:
        soles.SPACING = kept


def pending() -> dict[str, float]:
    """Compares walks on the spot with many and with few steps to come."""
    walls: dict[int, list[float]] = {}
    sims = {count: walk_with(count) for count in (100, 10_000)}
    for _ in range(PIECES):
        for count, sim in sims.items():
            begin = time.perf_counter()
            sim.advance(PIECE)
            walls.setdefault(count, []).append(time.perf_counter() - begin)
    return ratio(walls[10_000], walls[100])


def walk_with(count: int) -> AtlasSimulation:
    """Begins a walk on the spot with so many steps to come."""
    sim = AtlasSimulation()
    gait = sim.scenario.controller_config().gait()
    feet = [foothold(pose) for pose in sim.atlas_sim_interface_state.foot_pos_est]
    for first in range(1, count, NUM_REQUIRED_WALK_STEPS):
        command = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
        command.walk_params.step_queue = [
            step_data(index, index % 2, feet[index % 2], gait)
            for index in range(first, first + NUM_REQUIRED_WALK_STEPS)
        ]
        sim.publish(command)
        if first == 1:
            sim.advance(BEGUN)
    # Requests of one instant are kept until a later one comes.
    sim.advance(BEGUN)
    sim.publish(command)
    return sim


def ratio(over: list[float], under: list[float]) -> dict[str, float]:
    """Returns the median ratio of two runs' pieces, and the range of most of them."""
    ratios = np.array(over) / np.array(under)
    low, median, high = np.percentile(ratios, [10.0, 50.0, 90.0]).tolist()
    return {"median": median, "low": low, "high": high}


def stages(model: str) -> dict[str, float]:
    """Returns the median wall time of each part of a tick, in a run of its own [ms]."""
    print("timing the stages of a tick ...", end="\r", flush=True)
    with timed_stages() as found:
        sim = AtlasSimulation(Scenario(model=model, schedule="tutorial"))
        sim.advance_to(DURATION)
    return {name: 1e3 * statistics.median(times) for name, times in found.items()}


def measure(model: str) -> dict:
    """Measures all figures."""
    walls, sim, stood = in_turns(model)
    summary = sim.summary()
    bare_step = 1e3 * statistics.median(walls["bare"]) * BARE_STEP / PIECE
    tick = summary["controller_tick_ms"]
    ratios = {
        "default": ratio(walls["default"], walls["bare"]),
        "mcap": ratio(walls["mcap"], walls["default"]),
        "view": ratio(walls["view"], walls["default"]),
        "soles": ratio(walls["default"], walls["corners"]),
        "pending": pending(),
    }
    return {
        "model": model,
        "steps": [sim.scenario.physics_step, sim.scenario.control_period],
        "success": summary["success"],
        "bare_upright": stood,
        "bare_step_ms": bare_step,
        "real_time_factor": DURATION / sum(walls["default"]),
        "tick_ms": tick,
        "stages_ms": stages(model),
        "ratios": ratios,
        **{name: found["median"] for name, found in ratios.items()},
        "tick": tick["median"] / bare_step,
        "reset_s": reset_time(sim),
        "memory": resident(model, "closed") / resident(model, "bare"),
    }


def reset_time(sim: AtlasSimulation) -> float:
    """Returns the median wall time of a new run by reset(seed=...) [s]."""
    times = []
    for seed in range(RESETS):
        begin = time.perf_counter()
        sim.reset(seed=seed)
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def resident(model: str, what: str) -> float:
    """Returns the resident memory of a process of its own [MB].

    Args:
        model: Name of the robot.
        what: ``closed`` for a simulation, ``bare`` for the bare plant.
    """
    command = [sys.executable, __file__, "--model", model, "--resident", what]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(found.stdout)


def hold(model: str, what: str) -> None:
    """Simulates a second in this process, and prints its resident memory [MB]."""
    if what == "bare":
        run = BarePlant(load_robot(model), Scenario(model=model))
    else:
        run = AtlasSimulation(Scenario(model=model))
    run.advance(1.0)
    # Linux only. Python's ``resource`` counts the parent's largest size, too.
    status = Path("/proc/self/status").read_text()
    print(float(status.split("VmRSS:")[1].split()[0]) / 1024)


def print_table(result: dict) -> bool:
    """Prints the figures beside their goals; returns whether all are met."""
    tick, parts = result["tick_ms"], result["stages_ms"]
    print(f"bare plant                {result['bare_step_ms']:.3f} ms per step of 1 ms")
    print(f"real-time factor          {result['real_time_factor']:.2f}")
    print(
        f"controller tick           {tick['median']:.3f} ms median,"
        f" {tick['p99']:.3f} p99, {tick['max']:.3f} max"
    )
    for name, milliseconds in parts.items():
        print(f"  {name:23} {milliseconds:.3f} ms")
    met_all = True
    for key, (label, goal) in GOALS.items():
        met = result[key] <= goal
        met_all = met_all and met
        spread = ""
        if key in result["ratios"]:
            spread = "({low:.2f} to {high:.2f})".format(**result["ratios"][key])
        verdict = "met" if met else "NOT MET"
        print(f"{label:52} {result[key]:6.3f} {spread:15} goal <= {goal:<4} {verdict}")
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
    parser.add_argument("--resident", help=argparse.SUPPRESS)
    logging.getLogger("drake").setLevel(logging.ERROR)
    if "--resident" in sys.argv:
        child = parser.parse_args()
        hold(child.model, child.resident)
        return 0
    options = command_line(parser)
    result = measure(options.model)
    met = print_table(result)
    write_figures(options.json, result)
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
