"""The default robot for tests of parts; no test is here."""

import pytest

from atlas_drake.robot import load_robot


@pytest.fixture(scope="session")
def robot():
    """The default robot."""
    return load_robot()
