"""Observations and states of behaviors, made up; no test is here."""

import itertools

import numpy as np
import pytest

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
)
from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.body_reference import BodyRates
from atlas_drake.behaviors.entry import BehaviorTools, EntryLimits
from atlas_drake.behaviors.freeze import Freeze
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.control.gains import ControlGains
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.frozen import replace
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.planning.footholds import Gait
from atlas_drake.robot import load_robot

_numbers = itertools.count(1)


def as_request(command):
    """What the command interface makes of a message; each has a number of its own."""
    return BehaviorRequest(command.behavior, command, next(_numbers))


@pytest.fixture(scope="session")
def robot():
    """The default robot."""
    return load_robot()


@pytest.fixture(scope="session")
def model(robot):
    """The controller's model of it."""
    return WholeBodyModel(robot)


@pytest.fixture(scope="session")
def balance(robot):
    """What behaviors command the robot with, with default gains."""
    return Balance(robot, ControlGains())


@pytest.fixture(scope="session")
def make_tools(model, balance):
    """Makes what behaviors are built from, for a height of the center of mass [m]."""
    freeze = Freeze(balance)
    return lambda height: BehaviorTools(
        model,
        balance,
        height,
        BodyRates(),
        EntryLimits(),
        freeze,
        Gait(),
        StandConfig(),
    )


@pytest.fixture(scope="session")
def observe(model):
    """Makes what a behavior sees of the robot in the stand-prep pose.

    Tilted by ``pitch`` [rad] forward, moving ahead at ``speed`` [m/s], with joints that
    move by name [rad/s], and the ``users`` share of joints by name. With ``above`` [m]
    the center of mass is at rest over this place.
    """
    robot, plant = model.robot, model.plant
    indices = robot.indices(plant)

    def make(pitch=0.0, speed=0.0, joints=None, users=None, above=None):
        users = users or {}
        state = np.zeros(model.num_states)
        state[[0, 2]] = np.cos(0.5 * pitch), np.sin(0.5 * pitch)
        state[indices.q] = robot.stand_prep
        velocities = state[plant.num_positions() :]
        velocities[3] = speed
        for name, velocity in (joints or {}).items():
            velocities[indices.v[robot.joint_names.index(name)]] = velocity
        terms = model.evaluate(model.create_context(), state)
        if above is not None:
            com = np.append(above, terms.com[2])
            terms = replace(terms, com=com, com_velocity=np.zeros(3))
        return Observation(
            time=1.0,
            dt=0.002,
            terms=terms,
            foot_force=np.full(2, 0.5 * robot.mass * 9.81),
            k=np.array([users.get(name, 0.0) for name in robot.joint_names]),
        )

    return make


@pytest.fixture(scope="session")
def walk_message():
    """Makes a WALK command from (index, foot, x, y) of each step, and z if not 0."""

    def make(*steps, duration=0.63):
        command = AtlasSimInterfaceCommand(behavior="WALK")
        for place, (index, foot, x, y, *z) in enumerate(steps):
            step = AtlasBehaviorStepData()
            step.step_index, step.foot_index = index, foot
            step.duration, step.swing_height = duration, 0.1
            step.pose.position.x, step.pose.position.y = x, y
            step.pose.position.z = sum(z)
            command.walk_params.step_queue[place] = step
        return command

    return make
