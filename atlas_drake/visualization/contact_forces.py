"""Contact forces on the robot, as arrows.

The arrows show the forces of the physics, not those that the controller requested.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat, QueryObject, Rgba, SceneGraphInspector
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import ContactResults
from pydrake.multibody.tree import world_index
from pydrake.systems.framework import Context

from atlas_drake.palette import FORCE
from atlas_drake.visualization.display import Display
from atlas_drake.visualization.marks import Timeline
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.shapes import draw_flat, tube

PATH = "/atlas_drake/forces"
SCALE = 0.0012
"""Length of an arrow per force [m/N]: the robot's weight on one corner is a metre."""
THICKNESS, HEAD_WIDTH, HEAD_LENGTH = 0.006, 0.018, 0.15
"""Radii of shaft and head [m]; the head's share of the length."""
LEAST_FORCE = 5.0
"""Force below which no arrow is drawn [N]."""


class ContactForce(NamedTuple):
    """Force on the robot at a point, both in W [m], [N], shape (3,)."""

    p_WC: np.ndarray
    force_W: np.ndarray


def contact_forces_of(
    results: ContactResults, inspector: SceneGraphInspector
) -> list[ContactForce]:
    """Returns the forces on the robot, from contacts at points and on surfaces.

    Two touching links push each other: the returned force is the one that points up.
    """
    world = world_index()
    forces = []
    for index in range(results.num_point_pair_contacts()):
        pair = results.point_pair_contact_info(index)
        bodies = pair.bodyA_index() == world, pair.bodyB_index() == world
        # Drake gives the force on body B.
        forces.append(_on_robot(pair.contact_point(), pair.contact_force(), *bodies))
    for index in range(results.num_hydroelastic_contacts()):
        info = results.hydroelastic_contact_info(index)
        surface = info.contact_surface()
        are_world = (
            inspector.GetFrameId(shape) == inspector.world_frame_id()
            for shape in (surface.id_M(), surface.id_N())
        )
        force = -info.F_Ac_W().translational()
        forces.append(_on_robot(surface.centroid(), force, *are_world))
    return [one for one in forces if np.linalg.norm(one.force_W) > LEAST_FORCE]


def _on_robot(
    p_WC: np.ndarray, force_B: np.ndarray, a_is_world: bool, b_is_world: bool
) -> ContactForce:
    """Chooses between the force on body B, which may be the ground, and on A."""
    is_reaction = b_is_world or (not a_is_world and force_B[2] < 0.0)
    return ContactForce(np.array(p_WC), np.array(-force_B if is_reaction else force_B))


def arrow_pose(force: ContactForce) -> RigidTransform:
    """Computes the pose in W of an arrow along z that starts where the force acts."""
    return RigidTransform(
        RotationMatrix.MakeFromOneVector(force.force_W, 2), force.p_WC
    )


class ContactForces(Display):
    """Draws an arrow per point of contact while it is switched on.

    Input ports:
        contact_results: Contact results of the plant.
        query_object: Of the scene graph.
    """

    __slots__ = ()

    def __init__(self, meshcat: Meshcat, overlays: Overlays, period: float) -> None:
        """Updates the arrows every ``period`` [s]."""
        super().__init__(period)
        self._meshcat = meshcat
        self._overlays = overlays
        self._results = self.DeclareAbstractInputPort(
            "contact_results", AbstractValue.Make(ContactResults())
        )
        self._query = self.DeclareAbstractInputPort(
            "query_object", AbstractValue.Make(QueryObject())
        )
        self._timeline = Timeline(meshcat)
        self._made = 0
        meshcat.Delete(PATH)

    def _publish(self, context: Context) -> None:
        forces = []
        if self._overlays.is_on("forces"):
            inspector = self._query.Eval(context).inspector()
            forces = contact_forces_of(self._results.Eval(context), inspector)
        time = context.get_time()
        for number, force in enumerate(forces):
            path = f"{PATH}/{number}"
            if number == self._made:
                self._draw(f"{path}/arrow")
                self._made += 1
            self._meshcat.SetTransform(path, arrow_pose(force), time)
            # A separate node, because every transform resets the scale of its node.
            scale = [1.0, 1.0, SCALE * float(np.linalg.norm(force.force_W))]
            self._meshcat.SetProperty(f"{path}/arrow", "scale", scale, time)
        for number in range(self._made):
            self._timeline.show(f"{PATH}/{number}", number < len(forces), time)

    def _draw(self, path: str) -> None:
        """Draws an arrow from 0 to z = 1."""
        neck = 1.0 - HEAD_LENGTH
        shaft = tube(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, neck]]), THICKNESS)
        rim = HEAD_WIDTH * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
        cone = np.zeros((3, 5))
        cone[:2, :4], cone[2] = rim.T, [neck] * 4 + [1.0]
        count = shaft[0].shape[1]
        sides = np.array([[0, 1, 2, 3], [1, 2, 3, 0], [4, 4, 4, 4]]) + count
        bottom = np.array([[0, 0], [2, 3], [1, 2]]) + count
        vertices = np.hstack([shaft[0], cone])
        faces = np.hstack([shaft[1], sides, bottom]).astype(np.int32)
        draw_flat(self._meshcat, path, vertices, faces, Rgba(*FORCE))
