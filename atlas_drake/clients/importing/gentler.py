"""What bounds a robot that stands and does not walk, and a gait with which it walks.

The usual gait is that of Atlas, scaled. A gentler one has smaller, slower or narrower
steps.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator
from functools import reduce
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import lxml.etree as etree
import numpy as np

from atlas_drake.clients.importing.files import MESHES, URDF
from atlas_drake.clients.importing.motions import SETTLES, advance, walk
from atlas_drake.config import overlaid
from atlas_drake.robot import load_robot
from atlas_drake.scenario import ControllerConfig, Scenario
from atlas_drake.simulation import AtlasSimulation, SimulationError

STRONGER = 10.0
"""Factor on all effort limits with which a walk shows the efforts that it takes [-]."""
SMALLER, SLOWER, NARROWER, SMALLEST = 0.5, 1.5, 0.8, 0.25
"""Stride, duration of a step, distance between the feet, and stride of the last gait
that is tried, in usual ones [-]."""
FINE_PERIOD, FINE_STEP = 0.003, 0.001
"""Steps of control and physics for a robot that is too quick for the usual ones [s]."""
LONGEST = 60.0
"""Wall time after which no further gait is tried [s]."""


def what_bounds(model: Path, say: Callable[[str], object]) -> str:
    """Says what bounds a robot that does not walk with its usual gait.

    These are joints that need more than their effort for it, or else the time steps.

    Args:
        model: The robot's YAML file.
        say: Takes a line on what is tried.
    """
    say("walking with stronger motors")
    with TemporaryDirectory() as temporary:
        strong = Path(temporary) / model.name
        shutil.copy(model, strong)
        _strengthen(model.parent / URDF, strong.parent / URDF)
        if (model.parent / MESHES).exists():
            shutil.copytree(model.parent / MESHES, strong.parent / MESHES)
        efforts = _efforts_of_walk(Scenario(model=str(strong)))
    if efforts is not None:
        return _weak_joints(model, efforts)
    say("walking with shorter time steps")
    fine = Scenario(
        model=str(model), control_period=FINE_PERIOD, physics_step=FINE_STEP
    )
    if _efforts_of_walk(fine) is None:
        return f"neither {STRONGER:g} times its efforts nor shorter time steps suffice"
    return (
        "its motors suffice, and the time steps are too long: it walks with "
        f"control_period {FINE_PERIOD:g} s and physics_step {FINE_STEP:g} s"
    )


def _strengthen(urdf: Path, strong: Path) -> None:
    tree = etree.parse(str(urdf))
    for limit in tree.iterfind("joint/limit"):
        limit.set("effort", str(STRONGER * float(limit.get("effort"))))
    tree.write(str(strong))


def _efforts_of_walk(scenario: Scenario) -> np.ndarray | None:
    """Returns the peak effort of each joint [N·m]; None if the robot does not walk."""
    with AtlasSimulation(scenario) as sim:
        try:
            advance(sim, SETTLES)
            does_walk = walk(sim)
        except SimulationError:  # Its motors threw it about.
            return None
        if not does_walk:
            return None
        peaks: np.ndarray = sim.output("peaks")[: sim.robot.num_joints]
        return peaks * sim.robot.effort_limit


def _weak_joints(model: Path, efforts: np.ndarray) -> str:
    robot = load_robot(model)
    shares = efforts / robot.effort_limit
    weak = [index for index in np.argsort(-shares).tolist() if shares[index] > 1.0]
    joints = [
        f"{robot.joint_names[index]} needs {efforts[index]:.3g} N·m and has "
        f"{robot.effort_limit[index]:.3g} N·m"
        for index in weak
    ]
    return "; ".join(joints) or "it needs stronger motors for a reserve"


def find_gentler(
    model: Path, say: Callable[[str], object]
) -> tuple[str, dict[str, Any], list[str]]:
    """Finds a gait with which a robot walks.

    Args:
        model: YAML file of a robot that does not walk with its usual gait.
        say: Takes a line on what is tried.

    Returns:
        The gait in words, and its values of the robot's ``controller``, both empty if
        the robot walks with none; and the gaits with which it does not, in words.
    """
    deadline = time.monotonic() + LONGEST
    config = Scenario(model=str(model)).controller_config()
    failed: list[str] = []
    for words, values in gentler_gaits(config):
        if time.monotonic() > deadline:
            break
        say(f"{words} steps")
        if _efforts_of_walk(Scenario(model=str(model), controller=values)) is not None:
            return words, values, failed
        failed.append(words)
    return "", {}, failed


def gentler_gaits(config: ControllerConfig) -> Iterator[tuple[str, dict[str, Any]]]:
    """Makes gentler gaits, in words and as values, the nearest to the usual one first.

    One that falls short of a limit has the value at the limit.
    """
    usual = config.gait()
    stride, smallest = (
        usual.nearest(stride=_round(share * usual.stride)).stride
        for share in (SMALLER, SMALLEST)
    )
    duration = usual.nearest(duration=_round(SLOWER * usual.duration)).duration
    least = config.walk.limits.width.least
    width = _round(max(NARROWER * config.stance.width, least))
    ways: dict[str, dict[str, Any]] = {
        "smaller": {"walk": {"steps": {"stride": stride}}},
        "slower": {"walk": {"steps": {"duration": duration}}},
    }
    if width < config.stance.width:
        ways["narrower"] = {"stance": {"width": width}}
    for number in range(1, len(ways) + 1):
        for names in combinations(ways, number):
            yield ", ".join(names), reduce(overlaid, map(ways.__getitem__, names))
    yield "much smaller", {"walk": {"steps": {"stride": smallest}}}


def _round(value: float) -> float:
    return float(f"{value:.3g}")
