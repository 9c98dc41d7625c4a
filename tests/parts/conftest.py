"""Robots, observations and random states for tests of parts; no test is here."""

from tests.behaviors.conftest import as_request, balance, make_tools, observe
from tests.control.conftest import TUTORIAL_ROBOTS, model, random_state, robot, standing

__all__ = [
    "TUTORIAL_ROBOTS",
    "as_request",
    "balance",
    "make_tools",
    "model",
    "observe",
    "random_state",
    "robot",
    "standing",
]
