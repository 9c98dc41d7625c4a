"""Contact forces from the plant's contact results: sums on bodies, single contacts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import numpy as np
from pydrake.geometry import SceneGraphInspector
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.multibody.tree import BodyIndex, world_index

from atlas_drake.records.tick_record import ContactForce

MIN_FORCE = 5.0
"""Force below which a single contact is left out [N]."""


def shapes_of(plant: MultibodyPlant, bodies: Iterable[int]) -> dict[int, int]:
    """Maps the number of each collision shape of some bodies to the body's index.

    A ``GeometryId`` of the plant would keep the plant alive.
    """
    return {
        shape.get_value(): body
        for body in bodies
        for shape in plant.GetCollisionGeometriesForBody(
            plant.get_body(BodyIndex(body))
        )
    }


def contact_wrenches(
    results: ContactResults,
    bodies: Mapping[int, int],
    shapes: Mapping[int, int],
    ignored: Mapping[int, Collection[int]],
) -> list[list[float]]:
    """Sums moment and force on some bodies in W, about W's origin [N·m; N].

    ``bodies`` maps the index of a body in the plant to its index in the result,
    ``shapes`` each collision shape to the body's index, of these bodies and of those
    whose contact with one of them is ``ignored``.
    """
    totals = [[0.0] * 6 for _ in set(bodies.values())]
    for (body_A, body_B), (on_A, on_B) in _contacts(results, shapes):
        for body, other, wrench in ((body_A, body_B, on_A), (body_B, body_A, on_B)):
            place = bodies.get(body)
            if place is not None and other not in ignored.get(body, ()):
                _add(totals[place], wrench)
    return totals


def pair_wrenches(
    results: ContactResults,
    pairs: Sequence[tuple[int, int | None]],
    shapes: Mapping[int, int],
) -> list[list[float]]:
    """Sums moment and force of one body on another in W, about W's origin [N·m; N].

    Each pair has the index of the body on which the forces act, and that of the body
    that exerts them, or None for all bodies; ``shapes`` is as above.
    """
    totals = [[0.0] * 6 for _ in pairs]
    for (body_A, body_B), (on_A, on_B) in _contacts(results, shapes):
        for total, (body, other) in zip(totals, pairs, strict=True):
            if body == body_A and other in (None, body_B):
                _add(total, on_A)
            if body == body_B and other in (None, body_A):
                _add(total, on_B)
    return totals


def _contacts(
    results: ContactResults, shapes: Mapping[int, int]
) -> Iterator[tuple[tuple[int, int], tuple[list[float], list[float]]]]:
    """Yields both bodies of each contact and the wrenches on them, about W's origin.

    A body of a surface is -1 if its shape is not among the ``shapes``.
    """
    for k in range(results.num_point_pair_contacts()):
        pair = results.point_pair_contact_info(k)
        bodies = int(pair.bodyA_index()), int(pair.bodyB_index())
        on_B = _wrench(pair.contact_point().tolist(), pair.contact_force().tolist())
        yield bodies, ([-number for number in on_B], on_B)
    for k in range(results.num_hydroelastic_contacts()):
        info = results.hydroelastic_contact_info(k)
        surface, F_Ac_W = info.contact_surface(), info.F_Ac_W()
        # Body A has the shape M.
        ids = surface.id_M().get_value(), surface.id_N().get_value()
        on_A = _wrench(surface.centroid().tolist(), F_Ac_W.translational().tolist())
        _add(on_A, [*F_Ac_W.rotational().tolist(), 0.0, 0.0, 0.0])
        yield (
            (shapes.get(ids[0], -1), shapes.get(ids[1], -1)),
            (on_A, [-number for number in on_A]),
        )


def _wrench(point: list[float], force: list[float]) -> list[float]:
    """Returns moment and force of a force at a point, about the origin."""
    x, y, z = point
    fx, fy, fz = force
    return [y * fz - z * fy, z * fx - x * fz, x * fy - y * fx, fx, fy, fz]


def _add(total: list[float], wrench: list[float]) -> None:
    for axis, number in enumerate(wrench):
        total[axis] += number


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
