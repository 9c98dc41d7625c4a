"""From where STAND can take over, as a trial: the measure of its entry conditions.

The robot begins in STAND, with its center of mass aside, moving, or its arms flung, and
is left to itself. What it survives is more than what the conditions let in. Amounts and
increments are in ``entry_position.yaml`` and its neighbors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
)
from atlas_drake.control.whole_body.model import WholeBodyModel

DIRECTIONS = {
    "forward": (1.0, 0.0),
    "backward": (-1.0, 0.0),
    "left": (0.0, 1.0),
    "right": (0.0, -1.0),
}
WATCHED = 2.0
"""How long a start is watched [s]."""


@dataclass(frozen=True)
class Start:
    """One start.

    Attributes:
        kind: What is displaced: ``position`` or ``velocity`` of the center of mass, or
            the ``joints`` of the arms.
        direction: Of the center of mass, one of DIRECTIONS.
        amount: How far or fast [m], [m/s], [rad/s].
    """

    kind: str
    direction: str
    amount: float


def begin(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Lets a robot that is in STAND already stand from there.

    Returns:
        Whether it ``survived``; and if not, whether STAND can be ``let_in`` from there
        all the same, 1 or 0.
    """
    start = Start(
        str(parameters["kind"]),
        str(parameters["direction"]),
        float(parameters["amount"]),
    )
    seed = sim.scenario.seed
    _displace(sim, start, np.random.default_rng(seed))
    sim.advance(WATCHED)
    survived = not sim.has_fallen
    let_in = not survived and lets_in(start, sim.scenario.model, seed)
    return {"survived": survived, "let_in": int(let_in)}


def lets_in(start: Start, model: str, seed: int) -> bool:
    """Whether STAND can be entered from there."""
    sim = AtlasSimulation(Scenario(model=model, seed=seed, initial_behavior="USER"))
    _displace(sim, start, np.random.default_rng(seed))
    stand = AtlasSimInterfaceCommand(behavior=Behavior.STAND)
    stand.k_effort = [0] * sim.robot.num_joints
    sim.publish(stand)
    sim.advance(2.0 * sim.scenario.control_period)
    return sim.current_behavior is Behavior.STAND


def _displace(sim: AtlasSimulation, start: Start, random: np.random.Generator) -> None:
    """Moves the CoM over planted feet, or sets it or the arms in motion."""
    robot, plant = sim.robot, sim.plant
    aim = start.amount * np.array(DIRECTIONS[start.direction])
    context = plant.GetMyMutableContextFromRoot(sim.context)
    model = WholeBodyModel(robot)
    scratch = model.create_context()
    order = robot.indices(plant).generalized
    state = plant.GetPositionsAndVelocities(context).copy()
    num_q = plant.num_positions()

    def motion(com_velocity: np.ndarray) -> np.ndarray:
        """Least generalized velocity of that CoM motion, feet and pelvis' tilt kept."""
        terms = model.evaluate(scratch, state)
        upright = np.eye(3, len(order))
        feet = [foot.J_WF for foot in terms.feet]
        rows = np.vstack([*feet, terms.M[3:6] / robot.mass, upright])
        wanted = np.concatenate([np.zeros(12), com_velocity, [0.0], np.zeros(3)])
        velocity = np.zeros(len(order))
        velocity[order] = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        return velocity

    jitter = 0.005 * random.normal(size=2)
    steps = 20
    shift = (aim if start.kind == "position" else np.zeros(2)) + jitter
    for _ in range(steps):
        plant.SetPositionsAndVelocities(context, state)
        rate = plant.MapVelocityToQDot(context, motion(shift / steps))
        state[:num_q] += rate
        state[:4] /= np.linalg.norm(state[:4])
    if start.kind == "velocity":
        state[num_q:] = motion(aim)
    elif start.kind == "joints":
        arms = np.flatnonzero(robot.limb("l_arm", "r_arm"))
        signs = random.choice([-1.0, 1.0], len(arms))
        state[num_q + robot.indices(plant).v[arms]] = start.amount * signs
    plant.SetPositionsAndVelocities(context, state)
    sim.simulator.Initialize()
