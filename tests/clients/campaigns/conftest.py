"""What the tests of campaigns share: a campaign that takes a moment."""

import re
import textwrap

import pytest

from atlas_drake.clients.campaigns import load_campaign

TINY = """
name: tiny
scenario: {physics_step: 2e-3, control_period: 4e-3, jitter: {mass: 0.05}}
duration: 0.1
pushes:
  - time: 0.02
    impulse: {uniform: [5, 40]}
    direction: {uniform: [-3.14, 3.14]}
metrics: [success, tilt, energy]
"""


@pytest.fixture(autouse=True)
def _small_figures(monkeypatch):
    monkeypatch.setattr("atlas_drake.clients.campaigns.figures.DPI", 20)


@pytest.fixture
def campaign_file(tmp_path):
    """Writes a campaign: the tiny one with more lines, and code beside it."""

    def write(more="", code=None, name="tiny.yaml"):
        if code is not None:
            (tmp_path / "own.py").write_text(textwrap.dedent(code))
            more += "\ncode: own.py\n"
        path = tmp_path / name
        tiny = re.sub("metrics:.*\n", "", TINY) if "metrics:" in more else TINY
        path.write_text(tiny + more)
        return path

    return write


@pytest.fixture
def campaign(campaign_file):
    """The same, loaded."""

    def load(more="", code=None):
        return load_campaign(campaign_file(more, code))

    return load
