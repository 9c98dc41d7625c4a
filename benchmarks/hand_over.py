"""Measures the largest jump of each effort at the hand-overs of the tutorial.

At every instant at which shares of control or the behavior change, efforts are
compared with those of the control tick before.
"""

from __future__ import annotations

import argparse
import logging
import sys
from typing import Any

import numpy as np
from report import command_line, write_figures

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.simulation.tutorial import DURATION

GOAL = 0.10
"""Goal: largest change of effort within a control tick of a joint without a user share,
over its effort limit [-]."""


def hand_overs(
    model: str = "atlas",
    duration: float = DURATION,
    physics_step: float = Scenario.physics_step,
    control_period: float = Scenario.control_period,
) -> list[dict[str, Any]]:
    """Measures every hand-over of the tutorial.

    Returns:
        For each its ``time`` [s], the behaviors ``before`` and ``after``, how many
        joints ``changed`` hands, and the joint with the largest jump as a share of its
        limit: among those that are ``the behavior's`` after it, and ``the user's``.
    """
    sim = AtlasSimulation(
        Scenario(
            model=model,
            schedule="tutorial",
            physics_step=physics_step,
            control_period=control_period,
        )
    )
    robot, period = sim.robot, sim.scenario.control_period
    effort = sim.diagram.GetOutputPort("effort")
    # The report holds the shares too, but costs as much as a tick.
    commands = sim.diagram.GetOutputPort("commands")
    found = []
    before = None
    for tick in range(1, round(duration / period)):
        # Between two ticks, after the efforts of the last tick are applied.
        sim.simulator.AdvanceTo((tick + 0.25) * period)
        now = (
            effort.Eval(sim.context),
            commands.Eval(sim.context).k_effort,
            sim.current_behavior,
        )
        if before is not None:
            changed = now[1] != before[1]
            if changed.any() or now[2] is not before[2]:
                jump = np.abs(now[0] - before[0]) / robot.effort_limit
                entry = {
                    "time": round(tick * period, 4),
                    "before": before[2].name,
                    "after": now[2].name,
                    "changed": int(changed.sum()),
                }
                owners = (("the behavior's", now[1] == 0), ("the user's", now[1] > 0))
                for owner, joints in owners:
                    if joints.any():
                        worst = int(np.argmax(np.where(joints, jump, -1.0)))
                        name = robot.joint_names[worst]
                        entry[owner] = (name, float(jump[worst]))
                found.append(entry)
        before = now
    return found


def main() -> int:
    """The command line; status 1 when the goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--model", default="atlas")
    parser.add_argument(
        "--steps",
        type=float,
        nargs=2,
        metavar=("PHYSICS", "CONTROL"),
        default=(Scenario.physics_step, Scenario.control_period),
        help="physics step and control period [s] (default: those of a scenario)",
    )
    options = command_line(parser)
    logging.getLogger("drake").setLevel(logging.ERROR)
    found = hand_overs(options.model, DURATION, *options.steps)
    worst = 0.0
    for entry in found:
        text = f"{entry['before']} -> {entry['after']}, {entry['changed']} joints"
        print(f"{entry['time']:6.2f} s  {text}")
        for owner in ("the behavior's", "the user's"):
            if owner in entry:
                name, jump = entry[owner]
                print(f"          {owner:16} {100 * jump:6.1f} %  {name}")
        worst = max(worst, entry.get("the behavior's", ("", 0.0))[1])
    met = worst <= GOAL
    print(
        f"largest jump of a behavior's joint: {100 * worst:.1f} % of its limit, goal "
        f"<= {100 * GOAL:.0f} %: {'met' if met else 'NOT MET'}"
    )
    write_figures(options.json, {"hand_overs": found})
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
