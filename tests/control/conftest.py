"""Robots, model and random states for tests of the control layer; no test is here."""

import numpy as np
import pytest

from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.robot import DEFAULT_ROBOT

TUTORIAL_ROBOTS = ("atlas", "atlas_v3")


@pytest.fixture(scope="session")
def robot(request, load_or_skip):
    """The default robot, or those that a file names in turn."""
    return load_or_skip(getattr(request, "param", DEFAULT_ROBOT))


@pytest.fixture(scope="session")
def model(robot):
    """The controller's model of the robot."""
    return WholeBodyModel(robot)


@pytest.fixture(scope="session")
def random_state(model):
    """Makes a state of the robot in plant order from a seed: everything moves."""

    def make(seed):
        random = np.random.default_rng(seed)
        robot, indices = model.robot, model.robot.indices(model.plant)
        quaternion = random.normal(size=4)
        q = np.empty(model.plant.num_positions())
        q[:4] = quaternion / np.linalg.norm(quaternion)
        q[4:7] = random.uniform(-1.0, 1.0, 3)
        q[indices.q] = random.uniform(robot.position_lower, robot.position_upper)
        v = random.uniform(-2.0, 2.0, model.plant.num_velocities())
        return np.concatenate([q, v])

    return make


@pytest.fixture(scope="session")
def standing(model):
    """Makes terms of the robot at rest in the stand-prep pose, soles at z = 0."""
    plant, robot = model.plant, model.robot
    context = model.create_context()
    state = np.zeros(model.num_states)
    state[0] = 1.0
    state[robot.indices(plant).q] = robot.stand_prep
    soles = model.evaluate(context, state).feet
    state[6] = -0.5 * (soles[0].p_WF[2] + soles[1].p_WF[2])
    return model.evaluate(context, state)


def motion(terms, solution):
    """Generalized accelerations of a QP's solution.

    The pelvis', which the solution leaves out, are from the rows without motors.
    """
    joints = solution.joint_acceleration
    force = -terms.h[:6] - terms.M[:6, 6:] @ joints
    for name, wrench in solution.contact_wrenches.items():
        force += terms.frame(name).J_WF[:, :6].T @ wrench
    return np.concatenate([np.linalg.solve(terms.M[:6, :6], force), joints])


def residual(terms, solution):
    """What the equations of motion lack with the solution's forces, shape (6 + n,)."""
    force = -terms.h
    for name, wrench in solution.contact_wrenches.items():
        force = force + terms.frame(name).J_WF.T @ wrench
    force[6:] += solution.effort
    return terms.M @ motion(terms, solution) - force
