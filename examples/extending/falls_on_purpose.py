"""A controller that falls on purpose: its events, summary and log.

    python examples/extending/falls_on_purpose.py

Joint springs hold the robot, and its ankles let go after a second. The controller
reports this in its status; the simulation detects the fall for any controller.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import LeafSystem

from atlas_drake import AtlasSimulation, ControllerStatus, Event, read_log


class Fainting(LeafSystem):
    """Joint springs, of which those of the ankles end at a given time."""

    def __init__(self, robot, scenario, faint_at=1.0):
        super().__init__()
        self._robot, self._faint_at = robot, faint_at
        plant = robot.plant
        self._split, self._indices = plant.num_positions(), robot.indices(plant)
        self._ankles = [i for i, name in enumerate(robot.joint_names) if "_ak" in name]
        self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self.DeclareVectorOutputPort("behavior_effort", robot.num_joints, self._effort)
        self.DeclareAbstractOutputPort(
            "controller_status",
            alloc=lambda: AbstractValue.Make(ControllerStatus()),
            calc=self._tell,
        )

    def _effort(self, context, output):
        robot = self._robot
        state = self.GetInputPort("state").Eval(context)
        q = state[: self._split][self._indices.q]
        v = state[self._split :][self._indices.v]
        effort = robot.default_kp * (robot.stand_prep - q) - robot.default_kd * v
        if context.get_time() >= self._faint_at:
            effort[self._ankles] = 0.0
        output.SetFromVector(effort)

    def _tell(self, context, output):
        events = ()
        if context.get_time() >= self._faint_at:
            events = (Event(self._faint_at, "warning", "the ankles let go"),)
        status = ControllerStatus(events=events, event_count=len(events))
        output.set_value(status)


controller = Fainting  # what --with takes from this file


def main():
    """Falls, and prints the report of the fall."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--log", type=Path, help="default: in a temporary folder")
    path = parser.parse_args().log or Path(tempfile.mkdtemp()) / "fall.mcap"
    with AtlasSimulation(controller=controller, log=path) as sim:
        sim.wait_until(lambda sim: sim.has_fallen)
        sim.advance(1.5)
    summary = sim.summary()
    for name in ("success", "fell", "final_behavior", "min_pelvis_height"):
        print(f"summary: {name} is {summary[name]}")
    log = read_log(path)
    fall = next(event for event in log.events if event.kind == "fall")
    speed = log["balance.com_velocity.z"]
    height = log["balance.com.z"]
    row = np.argmin(speed)
    print(f"log: {path}, events {[event.kind for event in log.events]}")
    print(f"log: warned {log.time[row] - fall.time:.2f} s before the impact")
    print(f"It fell, by {height[0] - height[-1]:.2f} m, at {-speed[row]:.1f} m/s.")


if __name__ == "__main__":
    main()
