"""A picture of the simulation's block diagram, made from the diagram itself.

Drawing only; Drake provides the systems and their connections.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, InputPortIndex, OutputPortIndex, System

from atlas_drake.app import exit_status
from atlas_drake.errors import AtlasError
from atlas_drake.systems.robot_sensors import RobotSensors
from atlas_drake.visualization.viewer import open_on_desktop

FORMATS = (".svg", ".png", ".pdf", ".dot")

_STYLE = """
  graph [rankdir=LR, fontname="Helvetica", fontsize=13, ranksep=0.9, nodesep=0.35,
         bgcolor="white", pad=0.2]
  node [shape=plain, fontname="Helvetica", fontsize=11]
  edge [fontname="Helvetica", fontsize=9, color="#5f6b7a", arrowsize=0.6]
"""
_MEASURING = (MultibodyPlant, RobotSensors)
_OURS, _DRAKE = "#dbe8f6", "#e9e9e9"
"""Colors of this project's systems and of Drake's."""


class PictureError(AtlasError):
    """The picture cannot be drawn or written."""


def show_diagram_picture(options: argparse.Namespace) -> int:
    """Draws the picture and opens it; returns the exit status."""
    write_diagram_picture(options.file)
    sys.stdout.write(f"Wrote {options.file}.\n")
    if not options.no_open and options.file.suffix != ".dot":
        open_on_desktop(options.file.resolve().as_uri())
    return exit_status.OK


def write_diagram_picture(path: Path) -> None:
    """Draws the whole simulation.

    Args:
        path: Path of the picture; the ending is one of FORMATS and selects the format.

    Raises:
        PictureError: If the format is unknown, Graphviz is missing or the file cannot
            be written.
    """
    from atlas_drake.diagrams.control_mode_switch import make_control_mode_switch
    from atlas_drake.robot import load_robot
    from atlas_drake.simulation.tutorial import tutorial_schedule

    if path.suffix not in FORMATS:
        raise PictureError(f"{path}: must end in one of {', '.join(FORMATS)}")
    dot = shutil.which("dot")
    if path.suffix != ".dot" and dot is None:
        raise PictureError(
            f"{path}: drawing it needs Graphviz, which is not installed: "
            "apt install graphviz, brew install graphviz or https://graphviz.org; or "
            f"ask for {path.with_suffix('.dot')}, which any Graphviz viewer draws"
        )
    robot = load_robot()
    schedule = tutorial_schedule(robot)
    source = graphviz_source(make_control_mode_switch(robot, schedule=schedule))
    try:
        if path.suffix == ".dot":
            path.write_text(source)
        else:
            command = [str(dot), f"-T{path.suffix[1:]}", "-o", str(path)]
            subprocess.run(
                command, input=source, text=True, check=True, capture_output=True
            )
    except OSError as error:
        raise PictureError(f"{path}: cannot be written: {error.strerror}") from error
    except subprocess.CalledProcessError as error:
        raise PictureError(f"{path}: {error.stderr.strip()}") from error


def graphviz_source(diagram: Diagram) -> str:
    """Writes the diagram in Graphviz's language; inner diagrams are boxes."""
    lines = [f"digraph {diagram.get_name()} {{", _STYLE]
    for system in diagram.GetSystems():
        if isinstance(system, Diagram):
            lines.append(f"  subgraph cluster_{system.get_name()} {{")
            lines.append(f'    label=<<B>{system.get_name()}</B>>; color="#9aa7b5";')
            lines.append("    style=rounded;")
            lines += [f"    {_box(inner)}" for inner in system.GetSystems()]
            lines.append("  }")
        else:
            lines.append(f"  {_box(system)}")
    for (tail, head), names in _edges(diagram).items():
        label = escape("\\n".join(names), quote=True)
        # Commands run from left to right, so feedback must not shape the layout.
        feedback = isinstance(tail, _MEASURING) or head in diagram.GetSystems()
        lines.append(
            f'  {tail.get_name()} -> {head.get_name()} [label="{label}", '
            f"constraint={'false' if feedback else 'true'}]"
        )
    return "\n".join([*lines, "}", ""])


def _box(system: System) -> str:
    kind = type(system)
    ours = kind.__module__.startswith("atlas_drake")
    name = system.get_name()
    return (
        f'{name} [label=<<TABLE BORDER="0" CELLBORDER="1" CELLSPACING="0" '
        f'CELLPADDING="7" BGCOLOR="{_OURS if ours else _DRAKE}" COLOR="#5f6b7a">'
        f"<TR><TD><B>{name}</B><BR/>"
        f'<FONT POINT-SIZE="9">{kind.__name__.rstrip("_")}</FONT></TD></TR></TABLE>>]'
    )


def _edges(diagram: Diagram) -> dict[tuple[System, System], list[str]]:
    """Finds connected pairs of systems with the names of their signals."""
    edges: dict[tuple[System, System], list[str]] = {}
    for (reader, into), (source, out) in _all_connections(diagram):
        tail, name = _behind_output(source, out)
        for head in _behind_input(reader, into):
            names = edges.setdefault((tail, head), [])
            if name not in names:
                names.append(name)
    return edges


def _all_connections(diagram: Diagram) -> Iterator[tuple[Any, Any]]:
    yield from diagram.connection_map().items()
    for system in diagram.GetSystems():
        if isinstance(system, Diagram):
            yield from _all_connections(system)


def _behind_output(system: System, index: OutputPortIndex) -> tuple[System, str]:
    """Finds the system that computes an output inside a diagram that exports it."""
    if isinstance(system, Diagram):
        return _behind_output(*system.get_output_port_locator(index))
    return system, system.get_output_port(int(index)).get_name()


def _behind_input(system: System, index: InputPortIndex) -> Iterator[System]:
    """Finds the systems that read an input."""
    if isinstance(system, Diagram):
        for inner in system.GetInputPortLocators(index):
            yield from _behind_input(*inner)
    else:
        yield system
