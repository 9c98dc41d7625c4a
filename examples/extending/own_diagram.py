"""Systems of your own in the diagram: a camera on the head, whose pictures are saved.

    python examples/extending/own_diagram.py [--folder pictures]

``extend`` adds Drake's camera and writer of pictures, without window or display.
"""

import argparse
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
from pydrake.geometry import (
    Box,
    ClippingRange,
    DepthRange,
    DepthRenderCamera,
    LightParameter,
    MakeRenderEngineVtk,
    RenderCameraCore,
    RenderEngineVtkParams,
)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.systems.sensors import CameraInfo, ImageWriter, PixelType, RgbdSensor

from atlas_drake import AtlasSimulation

PERIOD = 0.5  # between two pictures [s]
LENS = CameraInfo(width=480, height=320, fov_y=np.radians(60.0))
LIGHT = LightParameter(type="directional", frame="world", direction=[1.0, -0.5, -1.2])
LIGHT.intensity = 2.0
X_HC = RigidTransform(  # of the camera in the head: z ahead, y down
    RollPitchYaw(-np.pi / 2 - 0.3, 0.0, -np.pi / 2), [0.12, 0.0, 0.05]
)


def add_scenery(plant):
    """Adds a floor, and boxes ahead, for the camera."""
    for name, size, p_WB, color in (
        ("floor", (20.0, 20.0, 0.02), (0.0, 0.0, -0.01), (0.75, 0.78, 0.80, 1.0)),
        ("red", (0.4, 0.4, 0.4), (1.9, 0.4, 0.2), (0.85, 0.25, 0.2, 1.0)),
        ("blue", (0.3, 0.3, 1.0), (2.4, -0.5, 0.5), (0.2, 0.4, 0.8, 1.0)),
    ):
        X_WB, color = RigidTransform(p_WB), np.array(color)
        plant.RegisterVisualGeometry(plant.world_body(), X_WB, Box(*size), name, color)


def add_head_camera(builder, station, files="head_{count:02}.png"):
    """Adds a camera on the head, and a writer of its pictures."""
    renderer = MakeRenderEngineVtk(RenderEngineVtkParams(lights=[LIGHT]))
    station.GetSubsystemByName("scene_graph").AddRenderer("vtk", renderer)
    plant = station.GetSubsystemByName("plant")
    head = plant.GetBodyFrameIdOrThrow(plant.GetBodyByName("head").index())
    core = RenderCameraCore("vtk", LENS, ClippingRange(0.02, 30.0), RigidTransform())
    lens = DepthRenderCamera(core, DepthRange(0.1, 10.0))
    camera = builder.AddNamedSystem("camera", RgbdSensor(head, X_HC, lens))
    geometry = station.GetOutputPort("query_object")
    builder.Connect(geometry, camera.GetInputPort("geometry_query"))
    writer = builder.AddNamedSystem("writer", ImageWriter())
    port = writer.DeclareImageInputPort(PixelType.kRgba8U, "head", files, PERIOD, 0.0)
    builder.Connect(camera.GetOutputPort("color_image"), port)


world, extend = [add_scenery], add_head_camera  # what --with takes from this file


def main():
    """Stands, and counts the pictures."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--folder", default=tempfile.mkdtemp(), help="of the pictures")
    folder = Path(parser.parse_args().folder)
    files = str(folder / "head_{count:02}.png")
    sim = AtlasSimulation(world=world, extend=partial(extend, files=files))
    sim.advance(1.2)
    print(f"{len(list(folder.glob('head_*.png')))} pictures are in {folder}.")


if __name__ == "__main__":
    main()
