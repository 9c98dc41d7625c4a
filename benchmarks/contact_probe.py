"""Reads the physics of contact while a robot moves: friction, normal force, slip.

Reads Drake's contact results at every physics step, independent of this project's own
sums and views; the caller commands the robot.
"""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import (
    CalcContactFrictionFromSurfaceProperties,
    MultibodyPlant,
    PointPairContactInfo,
)
from pydrake.systems.framework import Context, EventStatus

from atlas_drake import AtlasSimulation
from atlas_drake.units import GRAVITY

LEAST_FORCE = 5.0
"""Contacts with a smaller normal force are left out of ratios [N]."""
LOADED = 0.5
"""A foot that carries more than this share of the weight, while the other touches
nothing, is in single support [-]."""
SHORTEST = 0.1
"""Least duration of a single support that counts [s]."""


class ContactProbe:
    """Records contacts and slip of a simulation from its construction on.

    The monitor is called at the end of a step, before the controllers' updates: the
    contact problem that it reads is the one that the plant solves next, with efforts
    that are at most one control tick old.

    Attributes:
        normal, friction: Force per contact of the robot with the world [N].
        bound: Coulomb's bound on that friction, μ times the normal force [N].
        slips: Greatest displacement of the stance sole in each single support [m].
    """

    def __init__(self, sim: AtlasSimulation):
        self.normal: list[float] = []
        self.friction: list[float] = []
        self.bound: list[float] = []
        self.slips: list[float] = []
        self._sim = sim
        plant: MultibodyPlant = sim.plant
        feet = sim.robot.file.feet
        self._feet = [int(plant.GetBodyByName(foot.body).index()) for foot in feet]
        self._soles = [plant.GetFrameByName(foot.sole_frame) for foot in feet]
        self._weight = sim.robot.mass * GRAVITY
        self._world = int(plant.world_body().index())
        self._coefficients: dict[tuple[int, int], float] = {}
        self._support: _Support | None = None
        self._time = -np.inf
        sim.simulator.set_monitor(self._look)

    def sole_places(self) -> np.ndarray:
        """Computes the centers of both soles in W [m], shape (2, 3)."""
        return self._places(self._sim.context)

    def ratios(self) -> np.ndarray:
        """Friction over Coulomb's bound of contacts that carry LEAST_FORCE [-]."""
        normal = np.array(self.normal)
        bearing = normal > LEAST_FORCE
        return np.array(self.friction)[bearing] / np.array(self.bound)[bearing]

    def _places(self, root: Context) -> np.ndarray:
        context = self._sim.plant.GetMyContextFromRoot(root)
        return np.array(
            [sole.CalcPoseInWorld(context).translation() for sole in self._soles]
        )

    def _look(self, root: Context) -> EventStatus:
        # The end of an advance may lie a rounding error behind that of a step.
        time = root.get_time()
        if time - self._time < 0.5 * self._sim.scenario.physics_step:
            return EventStatus.DidNothing()
        self._time = time
        results = self._sim.diagram.GetOutputPort("contact_results").Eval(root)
        loads = [0.0, 0.0]
        for k in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(k)
            bodies = int(info.bodyA_index()), int(info.bodyB_index())
            if self._world not in bodies:
                continue
            normal = self._read(info, root)
            for foot, body in enumerate(self._feet):
                if body in bodies:
                    loads[foot] += normal
        self._follow(root, loads)
        return EventStatus.DidNothing()

    def _read(self, info: PointPairContactInfo, root: Context) -> float:
        """Records a contact; returns its normal force [N]."""
        pair = info.point_pair()
        key = pair.id_A.get_value(), pair.id_B.get_value()
        force, axis = np.array(info.contact_force()), np.array(pair.nhat_BA_W)
        along = float(force @ axis)
        normal = abs(along)
        friction = float(np.linalg.norm(force - along * axis))
        coefficient = self._coefficients.get(key)
        if coefficient is None:
            query = self._sim.diagram.GetOutputPort("query_object").Eval(root)
            surfaces = (
                query.inspector()
                .GetProximityProperties(shape)
                .GetProperty("material", "coulomb_friction")
                for shape in (pair.id_A, pair.id_B)
            )
            both = CalcContactFrictionFromSurfaceProperties(*surfaces)
            coefficient = self._coefficients[key] = both.dynamic_friction()
        self.normal.append(normal)
        self.friction.append(friction)
        self.bound.append(coefficient * normal)
        return normal

    def _follow(self, root: Context, loads: list[float]) -> None:
        """Tracks the sole of the stance foot in single support."""
        alone = None
        for foot in (0, 1):
            if loads[1 - foot] == 0.0 and loads[foot] > LOADED * self._weight:
                alone = foot
        support = self._support
        if support is not None and support.foot != alone:
            if support.last - support.begin >= SHORTEST:
                self.slips.append(support.farthest)
            self._support = support = None
        if alone is None:
            return
        place = self._places(root)[alone][:2]
        if support is None:
            self._support = support = _Support(alone, root.get_time(), place)
        support.last = root.get_time()
        away = float(np.linalg.norm(place - support.place))
        support.farthest = max(support.farthest, away)


class _Support:
    """A single support in progress."""

    def __init__(self, foot: int, begin: float, place: np.ndarray):
        self.foot, self.begin, self.last = foot, begin, begin
        self.place, self.farthest = place, 0.0
