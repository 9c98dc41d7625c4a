"""Trials that compare contact approximations: one run each, with its figures.

Walk and tutorial are those of the other benchmarks; `contact_models` chooses the runs
and evaluates their figures.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from campaigns.walking import STANDING, Push, strike
from contact_probe import ContactProbe
from disturbed import CAMPAIGNS, Physics, disturbed_simulation

from atlas_drake import K_EFFORT_MAX, AtlasCommand, AtlasSimulation
from atlas_drake.clients.campaigns import load_campaign
from atlas_drake.clients.campaigns.plan import Trial as CampaignTrial
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.simulation.tutorial import DURATION

BEYOND = 1.001
"""Friction over Coulomb's bound above which a contact is beyond it; 1 with a tolerance
for rounding [-]."""
SWING, SWING_TIME, SWINGS = 0.5, 1.0, 8
"""Arms of a standing robot jump by SWING [rad] to both sides, every SWING_TIME [s]."""
ARM_KP, ARM_KP_VELOCITY = 200.0, 20.0
"""Gains of the user who swings them [N·m/rad], [N·m·s/rad]."""

INCREMENT = {"standing": 5.0, "walking": 10.0}
"""Increment of the impulse [N·s]."""
FIRST_IMPULSE = {"standing": 25.0, "walking": 40.0}
"""First impulse of the search for the largest impulse without a fall [N·s]."""
PUSHED_STEPS, EARLIEST = 9, 3.0
"""Length of a walk with a push, and when the push comes at the earliest [s]."""
RECOVERY = 3.0
"""Time after a push after which a standing robot counts as not fallen [s]."""
DIRECTIONS = ("forward", "left")
"""Directions of the pushes."""


@dataclass(frozen=True)
class Trial:
    """One trial of one robot under one approximation."""

    part: str
    physics: Physics
    model: str
    seed: int


def walk_trial(trial: Trial) -> dict[str, float]:
    """Walks twenty steps: forces, slip and landing errors of the feet."""
    sim = _simulation(trial)
    probe = ContactProbe(sim)
    record = judged(sim, "walking")
    ratios = probe.ratios()
    return {
        "walk ok": float(record["success"]),
        "walk friction max": float(ratios.max()),
        "walk friction p99.9": float(np.percentile(ratios, 99.9)),
        "walk beyond": float((ratios > BEYOND).mean()),
        "walk slip": max(probe.slips, default=0.0),
        **_landing("walk", record),
    }


def stand_trial(trial: Trial) -> dict[str, float]:
    """STAND while the user swings the arms: slip of the soles."""
    sim = _simulation(trial)
    sim.advance(STANDING)
    probe = ContactProbe(sim)
    places = probe.sole_places()
    arms = sim.robot.limb("l_arm", "r_arm")
    for swing in range(SWINGS):
        command = AtlasCommand()
        command.position = sim.robot.stand_prep + SWING * arms * (-1) ** swing
        command.kp_position = [ARM_KP] * sim.robot.num_joints
        command.kp_velocity = [ARM_KP_VELOCITY] * sim.robot.num_joints
        command.k_effort = np.where(arms, K_EFFORT_MAX, 0)
        sim.publish(command)
        sim.advance(SWING_TIME)
    ratios = probe.ratios()
    away = np.linalg.norm((probe.sole_places() - places)[:, :2], axis=1)
    return {
        "stand ok": float(not sim.has_fallen),
        "stand friction max": float(ratios.max()),
        "stand slip": float(away.max()),
    }


def tutorial_trial(trial: Trial) -> dict[str, float]:
    """Runs the tutorial with the criteria of its campaign."""
    sim = _simulation(trial, schedule="tutorial", duration=DURATION)
    record = judged(sim, "tutorial")
    return {
        "tutorial ok": float(record["success"]),
        **_landing("tutorial", record),
    }


def push_trial(trial: Trial) -> dict[str, float]:
    """Finds the largest impulse per direction, standing and walking [N·s]."""
    pushes = {
        f"push {posture} {direction}": _largest_push(trial, posture, direction)
        for posture in INCREMENT
        for direction in DIRECTIONS
    }
    return {"push ok": 1.0, **pushes}


def _largest_push(trial: Trial, posture: str, direction: str) -> float:
    """Goes up or down from FIRST_IMPULSE until the verdict changes."""
    increment, impulse = INCREMENT[posture], FIRST_IMPULSE[posture]

    def borne(impulse: float) -> bool:
        push = Push(impulse, direction, EARLIEST)
        sim = _simulation(trial)
        if posture == "walking":
            asked = {**vars(push), "num_steps": PUSHED_STEPS}
            return bool(judged(sim, "pushes", asked)["success"])
        sim.advance(STANDING)
        strike(sim, push, 0.0)
        sim.advance(RECOVERY)
        return not sim.has_fallen

    if borne(impulse):
        while borne(impulse + increment):
            impulse += increment
        return impulse
    while impulse > increment and not borne(impulse - increment):
        impulse -= increment
    return impulse - increment


def judged(
    sim: AtlasSimulation, name: str, parameters: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Does what a trial of a campaign does, and judges it likewise.

    Args:
        sim: A simulation that has just begun.
        name: Of the campaign's file.
        parameters: In place of the campaign's own.

    Returns:
        ``success`` and ``figures``.
    """
    campaign = load_campaign(CAMPAIGNS / f"{name}.yaml")
    campaign.parameters |= parameters or {}
    trial = CampaignTrial(0, sim.scenario.seed, {})
    return TrialRunner(campaign).judged(sim, trial)


def _landing(part: str, record: dict) -> dict[str, float]:
    error = record["figures"]["landing_max_m"]
    return {} if error is None else {f"{part} landing": error}


def _simulation(
    trial: Trial, schedule: str = "none", duration: float = 10.0
) -> AtlasSimulation:
    return disturbed_simulation(
        trial.seed,
        model=trial.model,
        schedule=schedule,
        duration=duration,
        physics=trial.physics,
    )


PARTS: dict[str, Callable[[Trial], dict[str, float]]] = {
    "walk": walk_trial,
    "stand": stand_trial,
    "tutorial": tutorial_trial,
    "push": push_trial,
}
"""Kinds of trials by name."""


def run_trial(trial: Trial) -> dict[str, float]:
    """Returns the figures of the trial, by name."""
    return PARTS[trial.part](trial)
