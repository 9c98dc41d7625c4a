"""What overlays show: shapes in W, in the order in which to draw them.

``overlay_marks`` draws them in Meshcat, ``video_overlays`` onto pictures of a video.
Colors of links are in ``control_colors``, footsteps in ``footsteps``.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from enum import Enum, auto
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import SceneGraphInspector
from pydrake.multibody.plant import ContactResults
from pydrake.multibody.tree import world_index

from atlas_drake.control.balance.feedback import dcm, pendulum_frequency
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.control.wrenches import center_of_pressure
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.palette import COM, COP, DCM, FORCE, SUPPORT, SWING, Color

LEAST_FORCE = 5.0
"""Force below which a contact is left out [N]."""


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


Points = NDArray[np.float64]

BALL, PLUMB_LINE, TUBE, ARROW = 0.03, 0.003, 0.005, 0.006
"""Radii of the center of mass, of the line down to the ground, of paths and arrows
[m]."""
DISC = {"com": 0.018, "dcm": 0.022, "cop": 0.014}
"""Radii of the discs on the ground [m]."""
LIFT = {"support": 0.006, "plan": 0.010, "com": 0.012, "dcm": 0.014, "cop": 0.016}
"""Heights above the ground, all different, so that none hides another [m]."""
FORCE_SCALE = 0.0012
"""Length of an arrow per force [m/N]: the robot's weight on one corner is a metre."""
LOWEST = 0.1
"""Lower bound of the center of mass' height, for a robot that lies on the ground
[m]."""
SEEN_THROUGH = 0.5
"""Opacity of areas."""
DRAWN = frozenset({"com", "dcm", "cop", "support", "plan", "swing", "forces"})
"""The overlays that are shapes."""


class ShapeKind(Enum):
    """What the points of a shape are."""

    AREA = auto()
    """Corners of a polygon."""
    CURVE = auto()
    """Points along a curve."""
    ROD = auto()
    """Both ends of a straight line."""
    DISC = auto()
    """The center of a level disc."""
    BALL = auto()
    """The center of a ball."""
    ARROW = auto()
    """Tail and tip."""


class Shape(NamedTuple):
    """A part of an overlay.

    Attributes:
        name: Name of its own, the same at all times.
        kind: Kind of the shape.
        points: Points in W [m], shape (k, 3).
        color: Color of all of it.
        radius: Radius, or half the thickness [m]; an area has none.
    """

    name: str
    kind: ShapeKind
    points: Points
    color: Color
    radius: float = 0.0


def overlay_shapes(
    on: Collection[str],
    terms: WholeBodyTerms,
    plan: Plan,
    paths: PlannedPaths,
    foot_wrenches: Points,
    forces: Iterable[ContactForce],
) -> list[Shape]:
    """Computes the shapes of overlays, from the ground up.

    Args:
        on: Names of the overlays.
        terms: The robot's model at its state.
        plan: Plan of the controller.
        paths: Its planned paths.
        foot_wrenches: Contact wrenches on both soles, see ``RobotSensors``.
        forces: Contact forces on the robot.
    """
    soles = [foot.p_WF for foot in terms.feet]
    ground = min(float(p_WF[2]) for p_WF in soles)
    x, y, z = map(float, terms.com)
    shapes: list[Shape] = []

    def disc(name: str, place: Points, color: Color) -> None:
        center = _at(place[None, :2], ground + LIFT[name])
        shapes.append(Shape(name, ShapeKind.DISC, center, color, DISC[name]))

    if "support" in on and plan.support is not None:
        corners = _at(plan.support, ground + LIFT["support"])
        shapes.append(Shape("support", ShapeKind.AREA, corners, SUPPORT))
    if "plan" in on:
        for name, path, color in (("com", paths.com, COM), ("dcm", paths.dcm, DCM)):
            if path is not None:
                points = _at(path, ground + LIFT["plan"])
                curve = Shape(f"plan_{name}", ShapeKind.CURVE, points, color, TUBE)
                shapes.append(curve)
    if "swing" in on and paths.swing is not None:
        shapes.append(Shape("swing", ShapeKind.CURVE, paths.swing, SWING, TUBE))
    if "com" in on:
        top = max(z, ground + LOWEST)
        line = np.array([[x, y, ground], [x, y, top]])
        shapes.append(Shape("com_line", ShapeKind.ROD, line, COM, PLUMB_LINE))
        disc("com", terms.com, COM)
        ball = np.array([[x, y, z]])
        shapes.append(Shape("com_ball", ShapeKind.BALL, ball, COM, BALL))
    if "dcm" in on:
        disc("dcm", dcm(terms, pendulum_frequency(z - ground)), DCM)
    if "cop" in on:
        cop = center_of_pressure(soles, foot_wrenches)
        if cop is not None:  # There is none without a load on the feet.
            disc("cop", cop, COP)
    if "forces" in on:
        for number, force in enumerate(forces):
            ends = np.array([force.p_WC, force.p_WC + FORCE_SCALE * force.force_W])
            name = f"forces/{number}"
            shapes.append(Shape(name, ShapeKind.ARROW, ends, FORCE, ARROW))
    return shapes


def _at(flat: Points, height: float) -> Points:
    """Adds a height [m] to points in the plane, shape (k, 2)."""
    return np.column_stack([flat, np.full(len(flat), height)])
