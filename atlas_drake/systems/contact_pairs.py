"""Measures what chosen bodies exert on each other, of the robot and beside it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.math import RigidTransform
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import Context, DiscreteValues

from atlas_drake.control.wrenches import shift_wrench
from atlas_drake.errors import ScenarioError, did_you_mean
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.contact_forces import pair_wrenches, shapes_of


class ContactPairs(CollectableSystem):
    """Contacts of the plant in, sums between two bodies out.

    Input ports:
        contact_results: Contacts of the plant.
        body_poses: Poses of the plant's bodies.

    Output ports:
        contact_pairs: For each pair the wrench of contacts on its first body, in W at
            that body's origin [N·m; N], shape (6 k,), one control tick ago.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        plant: MultibodyPlant,
        pairs: Sequence[Sequence[str]],
        period: float,
    ) -> None:
        """Samples every ``period`` [s].

        Args:
            robot: Its bodies come first among those of one name.
            plant: Plant of the whole simulation.
            pairs: Names of one or two bodies each; one has contact with all others.
            period: Control period [s].

        Raises:
            ScenarioError: If there is no such body, or several.
        """
        super().__init__()
        found = [
            [_body(plant, robot, name, f"contacts[{index}]") for name in pair]
            for index, pair in enumerate(pairs)
        ]
        self._pairs = [(one, other[0] if other else None) for one, *other in found]
        self._shapes = shapes_of(plant, {body for pair in found for body in pair})
        self._contacts = self.DeclareAbstractInputPort(
            "contact_results", AbstractValue.Make(ContactResults())
        )
        self._poses = self.DeclareAbstractInputPort(
            "body_poses", AbstractValue.Make([RigidTransform()])
        )
        wrenches = self.DeclareDiscreteState(6 * len(pairs))
        self.DeclareStateOutputPort("contact_pairs", wrenches)
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._sample)

    def reset(self, context: Context) -> None:
        """Clears the last contact forces."""
        context.SetDiscreteState(np.zeros(6 * len(self._pairs)))

    def _sample(self, context: Context, discrete: DiscreteValues) -> None:
        # As the sensors do: the plant's step at this instant solves the contacts.
        results, poses = self._contacts.Eval(context), self._poses.Eval(context)
        wrenches = np.array(pair_wrenches(results, self._pairs, self._shapes))
        for wrench, (body, _) in zip(wrenches, self._pairs, strict=True):
            shift_wrench(wrench, poses[body].translation())
        discrete.set_value(wrenches.ravel())


def _body(plant: MultibodyPlant, robot: Robot, name: str, field: str) -> int:
    """Finds a body by its name, or by ``model::name`` where several have that name."""
    own = robot.instance(plant)
    bodies = [plant.get_body(BodyIndex(index)) for index in range(plant.num_bodies())]
    known = {body.scoped_name().get_full(): body for body in bodies}
    among = [body for body in bodies if body.name() == name]
    if name in known:
        among = [known[name]]
    elif any(body.model_instance() == own for body in among):
        among = [body for body in among if body.model_instance() == own]
    if len(among) == 1:
        return int(among[0].index())
    problem = f"several models have such a body: say MODEL::{name}"
    if not among:
        hint = did_you_mean(name, [*known, *(body.name() for body in bodies)])
        problem = f"there is no such body.{hint}"
    raise ScenarioError.about(field, name, problem)
