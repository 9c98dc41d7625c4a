"""The walker in one file: four steps, other step times, pushes, and again."""

from functools import partial
from pathlib import Path
from runpy import run_path

import numpy as np
import pytest

from atlas_drake import AtlasSimulation

FILE = Path(__file__).parents[1] / "examples" / "walker.py"
WALKER = run_path(str(FILE))["Walker"]
ARRIVAL = 0.5  # two strides of 0.25 m [m]


def walk(sim, end):
    """Gives the records of a walk until a time, ten per second."""
    records = [sim.record]
    while sim.time < end:
        sim.advance(0.1)
        records.append(sim.record)
    return records


def arrives(records):
    """Checks that both feet are at the last footsteps, and the robot at rest."""
    first, last = records[0].feet.positions, records[-1]
    middle = 0.5 * (first[0] + first[1])
    for sole, side in zip(last.feet.positions, (0.15, -0.15), strict=True):
        goal = middle[:2] + np.array([ARRIVAL, side])
        np.testing.assert_allclose(sole[:2], goal, atol=0.02)
    assert abs(last.pelvis.orientation[0]) > 0.999  # upright, heading along x
    assert last.pelvis.position[2] == pytest.approx(0.89, abs=0.02)
    np.testing.assert_allclose(last.balance.com_velocity, 0.0, atol=0.05)
    assert last.controller.unsolved == 0


@pytest.mark.slow
def test_it_takes_the_four_steps_and_stands():
    sim = AtlasSimulation(controller=WALKER)
    records = walk(sim, end=4.8)
    arrives(records)
    to_go = [len(one.footsteps) for one in records[1:]]
    assert sorted({*to_go}) == [0, 1, 2, 3, 4]
    assert to_go == sorted(to_go, reverse=True)
    heights = np.array([[p[2] for p in one.feet.positions] for one in records])
    assert (heights.max(axis=0) > 0.2).all()  # Both feet swing,
    assert heights.min(axis=1).max() < 0.005  # and one is always down.
    errors = [one.balance.dcm - one.balance.dcm_reference for one in records[1:]]
    assert np.hypot(*np.transpose(errors)).max() < 0.04


@pytest.mark.slow
def test_it_walks_faster():
    sim = AtlasSimulation(controller=partial(WALKER, step_time=0.5))
    arrives(walk(sim, end=2.5 + 4.5 * 0.5))


@pytest.mark.slow
def test_a_push_does_not_stop_it_and_a_reset_begins_anew():
    sim = AtlasSimulation(controller=WALKER)
    for impulse in ((20, 0), (-20, 0), (0, 8), (0, -20)):
        before = walk(sim, end=sim.time + 1.9)
        sim.apply_push("utorso", 10.0 * np.array([*impulse, 0.0]), 0.1)
        arrives(before + walk(sim, end=sim.time + 3.6))
        sim.reset()


@pytest.mark.slow
def test_with_its_qp_written_out_it_walks_the_same():
    written_out = run_path(str(FILE.with_name("walker_qp.py")))["WrittenOutWalker"]
    feet = []
    for controller in (WALKER, written_out):
        sim = AtlasSimulation(controller=controller)
        sim.advance(2.3)  # Both feet have landed.
        feet.append(np.array(sim.record.feet.positions))
    np.testing.assert_allclose(*feet, atol=0.01)
