"""The pictures of extending.md, from the programs in examples/extending.

``make_pictures`` calls it. Each picture shows what one of those programs puts in.
"""

# ruff: noqa: T201

import runpy
import shutil
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, Rgba
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Scenario, read_log
from atlas_drake.clients.view.scene import prepare_scene
from atlas_drake.clients.view.viewer import start_meshcat
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.robot import load_robot

PROGRAMS = Path(__file__).parents[1] / "examples" / "extending"
SIZE, COLORS = (480, 320), 200
"""Size of the pictures [pixel], and colors of their palette, for small files."""
LENS, TARGET = np.array([2.6, -2.4, 1.4]), np.array([0.1, 0.0, 0.95])
"""The camera and what it looks at, from the robot's place on the ground [m]."""
FROM_THE_LEFT = ("own_task",)
TRACE = Rgba(0.9, 0.1, 0.3, 1.0)
Photograph = Callable[[str, Path], None]
"""Opens a web page and writes what is seen into a file."""


def make_extending_pictures(folder: Path, photograph: Photograph) -> None:
    """Makes the pictures of extending.md.

    Args:
        folder: Where to.
        photograph: Takes one of a web page.
    """
    for name, show in VIEWS.items():
        meshcat = start_meshcat()
        middle = show(_program(name), meshcat)
        lens = LENS * [1.0, -1.0, 1.0] if name in FROM_THE_LEFT else LENS
        meshcat.SetCameraPose(lens + middle, TARGET + middle)
        picture = folder / f"extending_{name}.png"
        photograph(meshcat.StaticHtml(), picture)
        shrink(picture)
    _draw_fall(_program("falls_on_purpose"), folder / "extending_falls_on_purpose.png")
    _save_head_view(_program("own_diagram"), folder / "extending_own_diagram.png")


def _program(name: str) -> dict[str, Any]:
    """Loads the names that a program defines."""
    return runpy.run_path(str(PROGRAMS / f"{name}.py"))


def shrink(picture: Path) -> None:
    """Makes a picture small, in both senses."""
    from PIL import Image

    image = Image.open(picture).convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
    image.quantize(COLORS, Image.Quantize.FASTOCTREE).save(picture, optimize=True)
    print(f"Shrank {picture} to {picture.stat().st_size / 1e3:.0f} kB.")


def _ground_below(sim: AtlasSimulation) -> np.ndarray:
    """Where the robot is [m]."""
    return sim.pelvis_pose.translation() * [1.0, 1.0, 0.0]


def _trace(
    sim: AtlasSimulation, meshcat: Meshcat, place: Callable[[], Any], until: float
) -> None:
    """Simulates until a time [s] and draws the way of a point."""
    points = []
    while sim.time < until:
        sim.advance(0.02)
        points.append(place())
    meshcat.SetLine("/trace", np.array(points).T, 6.0, TRACE)


def _controller(own: dict[str, Any], meshcat: Meshcat) -> np.ndarray:
    """Joint springs do not balance: the robot falls after the push."""
    sim = AtlasSimulation(controller=own["GravityCompensatedPd"], view=meshcat)
    sim.advance(2.0)
    sim.apply_push("trunk", [300.0, 0.0, 0.0], 0.1)
    sim.advance(1.3)
    return _ground_below(sim)


def _torque_free_arms(own: dict[str, Any], meshcat: Meshcat) -> np.ndarray:
    """The arms hang as they fall."""
    sim = AtlasSimulation(controller=own["make_controller"], view=meshcat)
    sim.advance(1.5)
    return _ground_below(sim)


def _behavior(own: dict[str, Any], meshcat: Meshcat) -> np.ndarray:
    """The deepest bow."""
    sim = AtlasSimulation(behaviors=[own["BOW"]], view=meshcat)
    params = own["BowParams"](depth=0.6)
    sim.publish(AtlasSimInterfaceCommand(behavior="BOW", params=params))
    sim.advance(3.0)
    return _ground_below(sim)


def _task(own: dict[str, Any], meshcat: Meshcat) -> np.ndarray:
    """The way of the hand while the robot walks."""
    sim = AtlasSimulation(behaviors=[own["WALK_WITH_HAND"]], view=meshcat)
    command = AtlasSimInterfaceCommand(behavior="WALK_WITH_HAND")
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    sim.advance(1.0)
    hand = partial(sim.frame_pose, "l_hand")
    _trace(sim, meshcat, lambda: hand().translation(), 5.0)
    return _ground_below(sim) - [0.1, 0.0, 0.0]


def _world(own: dict[str, Any], meshcat: Meshcat) -> np.ndarray:
    """The ball's flight, up to shortly after the hit."""
    sim = AtlasSimulation(world=[own["add_ball"]], view=meshcat)
    own["throw"](sim, 5.0)
    ball = sim.plant.GetBodyByName("ball")
    context = sim.plant.GetMyContextFromRoot(sim.context)
    pose = partial(sim.plant.EvalBodyPoseInWorld, context, ball)
    _trace(sim, meshcat, lambda: pose().translation(), 0.5)
    return np.array([0.6, 0.0, 0.0])


def _robot(own: dict[str, Any], meshcat: Meshcat) -> np.ndarray:
    """Heron in a step."""
    sim = AtlasSimulation(Scenario(model=str(own["HERON"])), view=meshcat)
    command = AtlasSimInterfaceCommand(behavior="WALK")
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    sim.advance(2.5)
    return _ground_below(sim) - [0.0, 0.0, 0.35]


def _source(own: dict[str, Any], meshcat: Meshcat) -> np.ndarray:
    """Walking and waving; the view is Drake's own, put into one's own diagram."""
    builder, robot = DiagramBuilder(), load_robot("atlas")
    station = builder.AddSystem(make_atlas_station(robot))
    source = builder.AddSystem(own["WavingWalker"](robot))
    for name in ("atlas_command", "atlas_sim_interface_command"):
        builder.Connect(source.GetOutputPort(name), station.GetInputPort(name))
    report = station.GetOutputPort("atlas_sim_interface_state")
    builder.Connect(report, source.GetInputPort("report"))
    prepare_scene(meshcat)
    query = station.GetOutputPort("query_object")
    MeshcatVisualizer.AddToBuilder(builder, query, meshcat)
    Simulator(builder.Build()).AdvanceTo(2.6)
    return np.array([0.3, 0.0, 0.0])


VIEWS = {
    "own_controller": _controller,
    "torque_free_arms": _torque_free_arms,
    "own_behavior": _behavior,
    "own_task": _task,
    "own_world": _world,
    "own_robot": _robot,
    "message_source": _source,
}
"""Programs and what shows in Meshcat what they do; returns where, on the ground [m]."""


def _draw_fall(own: dict[str, Any], picture: Path) -> None:
    """Draws what the log says of the fall."""
    from matplotlib.figure import Figure

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fall.mcap"
        with AtlasSimulation(controller=own["Fainting"], log=path) as sim:
            sim.advance(3.2)
        log = read_log(path)
    figure = Figure(figsize=(4.8, 3.2), dpi=100, layout="constrained")
    height, load = figure.subplots(2, 1, sharex=True)
    height.plot(log.time, log["balance.com.z"])
    height.set_ylabel("CoM height [m]")
    for side in ("left", "right"):
        load.plot(log.time, log[f"feet.{side}_force.z"], lw=0.8, label=side)
    load.set_ylabel("on the feet [N]")
    load.set_ylim(-50.0, 1200.0)
    load.set_xlabel("time [s]")
    load.legend(fontsize=8)
    for event in log.events:
        for axes in (height, load):
            axes.axvline(event.time, color="0.5", lw=0.8, ls="--")
        height.text(event.time + 0.03, 0.2, event.text.split(" (")[0], fontsize=8)
    figure.savefig(picture)
    print(f"Wrote {picture} ({picture.stat().st_size / 1e3:.0f} kB).")


def _save_head_view(own: dict[str, Any], picture: Path) -> None:
    """Keeps the last picture of the camera on the head."""
    with tempfile.TemporaryDirectory() as folder:
        extend = partial(own["extend"], files=f"{folder}/head_{{count:02}}")
        sim = AtlasSimulation(world=[own["add_scenery"]], extend=extend)
        sim.advance(0.6)
        shutil.copy(Path(folder) / "head_01.png", picture)
    print(f"Wrote {picture} ({picture.stat().st_size / 1e3:.0f} kB).")
