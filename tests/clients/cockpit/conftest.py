"""A simulation, and what the page asks of it, without a page."""

import orjson
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import AtlasSimulation
from atlas_drake.clients.cockpit.calls import call
from atlas_drake.clients.cockpit.recording import Recording
from atlas_drake.clients.cockpit.run_page import RunPage
from atlas_drake.clients.cockpit.scenario_requests import NextRun
from atlas_drake.clients.view.overlays import Overlays


class Asked:
    """A page without a browser."""

    def __init__(self, page, sim=None):
        self.page, self.sim = page, sim

    def do(self, request, **values):
        """Asks for something as the line does."""
        return call(self.page.requests, request, values)

    def shown(self):
        """What a browser gets of a frame."""
        return orjson.loads(self.page.frame().page)


@pytest.fixture(scope="session")
def meshcat():
    return Meshcat()


@pytest.fixture(scope="module")
def shared_sim(meshcat):
    return AtlasSimulation(view=meshcat)


@pytest.fixture
def next_run():
    return NextRun()


@pytest.fixture
def run(shared_sim, meshcat, next_run):
    shared_sim.reset(seed=0)
    overlays, recording = Overlays(), Recording(meshcat)
    return Asked(
        RunPage(shared_sim, meshcat, overlays, next_run, recording), shared_sim
    )
