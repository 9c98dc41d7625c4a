"""The forces of single contacts on the robot, from the plant's contact results."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import SceneGraphInspector
from pydrake.multibody.plant import ContactResults
from pydrake.multibody.tree import world_index

from atlas_drake.records.tick_record import ContactForce

MIN_FORCE = 5.0
"""Force below which a contact is left out [N]."""


def contact_forces(
    results: ContactResults, inspector: SceneGraphInspector
) -> tuple[ContactForce, ...]:
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
    return tuple(one for one in forces if np.linalg.norm(one.force_W) > MIN_FORCE)


def _on_robot(
    p_WC: np.ndarray, force_B: np.ndarray, a_is_world: bool, b_is_world: bool
) -> ContactForce:
    """Chooses between the force on body B, which may be the ground, and on A."""
    is_reaction = b_is_world or (not a_is_world and force_B[2] < 0.0)
    return ContactForce(np.array(p_WC), np.array(-force_B if is_reaction else force_B))
