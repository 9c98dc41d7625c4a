"""Contact forces from the plant's contact results: sums on bodies, single contacts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydrake.geometry import SceneGraphInspector
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.multibody.tree import BodyIndex, world_index

from atlas_drake.records.tick_record import ContactForce

MIN_FORCE = 5.0
"""Force below which a single contact is left out [N]."""


def shapes_of(plant: MultibodyPlant, bodies: Mapping[int, int]) -> dict[int, int]:
    """Maps the number of each collision shape of some bodies to what its body maps to.

    A ``GeometryId`` of the plant would keep the plant alive.
    """
    return {
        shape.get_value(): place
        for body, place in bodies.items()
        for shape in plant.GetCollisionGeometriesForBody(
            plant.get_body(BodyIndex(body))
        )
    }


def contact_wrenches(
    results: ContactResults, bodies: Mapping[int, int], shapes: Mapping[int, int]
) -> list[list[float]]:
    """Sums moment and force on some bodies in W, about W's origin [N·m; N].

    ``bodies`` maps the index of a body in the plant to its index in the result,
    ``shapes`` each collision shape of these bodies likewise.
    """
    totals = [[0.0] * 6 for _ in set(bodies.values())]

    def add(place: int, point: list[float], force: list[float]) -> None:
        x, y, z = point
        fx, fy, fz = force
        total = totals[place]
        total[0] += y * fz - z * fy
        total[1] += z * fx - x * fz
        total[2] += x * fy - y * fx
        total[3] += fx
        total[4] += fy
        total[5] += fz

    for k in range(results.num_point_pair_contacts()):
        info = results.point_pair_contact_info(k)
        # The force is that on body B.
        on_A = bodies.get(int(info.bodyA_index()))
        on_B = bodies.get(int(info.bodyB_index()))
        if on_A is None and on_B is None:
            continue
        point, force = info.contact_point().tolist(), info.contact_force().tolist()
        if on_B is not None:
            add(on_B, point, force)
        if on_A is not None:
            add(on_A, point, [-f for f in force])
    for k in range(results.num_hydroelastic_contacts()):
        info = results.hydroelastic_contact_info(k)
        surface, F_Ac_W = info.contact_surface(), info.F_Ac_W()
        # The force is that on body A, whose shape is M.
        for shape, sign in ((surface.id_M(), 1.0), (surface.id_N(), -1.0)):
            place = shapes.get(shape.get_value())
            if place is not None:
                force = (sign * F_Ac_W.translational()).tolist()
                add(place, surface.centroid().tolist(), force)
                for axis, moment in enumerate((sign * F_Ac_W.rotational()).tolist()):
                    totals[place][axis] += moment
    return totals


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
