"""A loaded robot: joints, limits, legs, and its indices in a plant.

The only module that converts between message order and a plant's order. ``load`` makes
the robot; control laws and state are elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FrameIndex, ModelInstanceIndex
from pydrake.systems.framework import Context

from atlas_drake.errors import RobotDescriptionError, did_you_mean, shown
from atlas_drake.frozen import read_only
from atlas_drake.robot.file import TRUNK, ContactEntry, JointEntry, RobotFile
from atlas_drake.robot.leg import Leg
from atlas_drake.robot.parsing import find_urdf, parse
from atlas_drake.robot.soles import add_soles


@dataclass(frozen=True)
class PelvisParts:
    """Parts of a plant's state [q; v] that belong to the free pelvis, in W."""

    orientation: slice
    """Quaternion, w first."""
    position: slice
    angular_velocity: slice
    velocity: slice


@dataclass(frozen=True)
class PlantIndices:
    """Index of each joint in the robot's own vectors, in message order.

    The robot's own vectors belong to its model instance: they are the same for a plant
    with other models and for a plant with the robot alone.
    """

    q: np.ndarray
    """Into the robot's positions, shape (n,)."""
    v: np.ndarray
    """Into the robot's velocities, shape (n,)."""
    actuation: np.ndarray
    """Into the robot's actuation, shape (n,)."""
    generalized: np.ndarray
    """The six base velocities, then ``v``: shape (6 + n,)."""
    pelvis: PelvisParts
    """The free pelvis, in the robot's state [q; v]."""


class JointConstants:
    """Index of each joint in message order, by name and by alias, as attributes."""

    def __init__(self, joints: Iterable[JointEntry]) -> None:
        for index, joint in enumerate(joints):
            # A joint without an alias has an empty one, which names nothing.
            names = filter(None, (joint.name, joint.alias))
            self.__dict__.update(dict.fromkeys(names, index))

    def __getattr__(self, name: str) -> int:
        """Refuses a name that no joint has; ``vars`` has those of the joints."""
        hint = did_you_mean(name, vars(self))
        raise AttributeError(f"the robot has no joint {name!r}.{hint}")


@dataclass(frozen=True)
class Size:
    """What the defaults of the controller scale by.

    Attributes:
        mass: Of the robot [kg].
        height: Of the center of mass above the soles in the stand-prep pose [m].
        sole_length: Of each sole [m].
        sole_width: Of each sole [m].
        stance_width: Distance between the soles' middles in the stand-prep pose [m].
        hip_time: How long the hips take to swing a leg, see ``Robot.hip_time`` [s].
    """

    mass: float
    height: float
    sole_length: float
    sole_width: float
    stance_width: float
    hip_time: float


ATLAS = Size(
    mass=90.92,
    height=0.9354,
    sole_length=0.26,
    sole_width=0.1249,
    stance_width=0.24,
    hip_time=0.1243,
)
"""Atlas, whose values are the defaults. Its stance is narrower than its pose."""


@dataclass(frozen=True, eq=False)
class Robot:
    """One robot, read from its YAML description and its URDF.

    All joint arrays are in message order, have shape (n,), and are read-only.

    Attributes:
        name: Name of the robot, and of its model instance in a plant.
        path: Path of its YAML file, absolute.
        model: Argument for ``load_robot``: the name of a robot in the package, or the
            path.
        file: The description as read, with omitted values filled in.
        joint_names: Names in message order.
        position_lower: Lower position limits [rad].
        position_upper: Upper position limits [rad].
        velocity_limit: Velocity limits [rad/s].
        effort_limit: Effort limits [N·m].
        mass: Total mass [kg].
        com_height: Height of the center of mass above the soles in the stand-prep pose
            [m].
        stance_width: Distance between the soles' middles in the stand-prep pose [m].
        pelvis_height: Height of the pelvis' origin above the soles, likewise [m].
        body_names: Names of all links.
        moved_links: For each joint the names of the link that it moves and of all links
            that are fixed to that one.
        trunk: Link that balance keeps upright.
        legs: Left and right leg.
    """

    name: str
    path: Path
    model: str
    file: RobotFile
    joint_names: tuple[str, ...]
    position_lower: np.ndarray
    position_upper: np.ndarray
    velocity_limit: np.ndarray
    effort_limit: np.ndarray
    mass: float
    com_height: float
    stance_width: float
    pelvis_height: float
    body_names: tuple[str, ...]
    moved_links: tuple[tuple[str, ...], ...]
    trunk: str
    legs: tuple[Leg, Leg]

    def __post_init__(self) -> None:
        """Make the arrays read-only, because all parts of a simulation share them."""
        read_only(self)

    @property
    def size(self) -> Size:
        """What the defaults of the controller scale by."""
        sole = self.file.sole
        return Size(
            mass=self.mass,
            height=self.com_height,
            sole_length=sole.length,
            sole_width=sole.width,
            stance_width=self.stance_width,
            hip_time=self.hip_time,
        )

    @cached_property
    def hip_time(self) -> float:
        """Measure of how long the hips take to swing a leg [s].

        It is √(I/τ), with the inertia I of the leg in the stand-prep pose and the
        effort limit τ: from rest a radian takes √2 times as long. It is the geometric
        mean of those of hip pitch and roll.
        """
        M = self.plant.CalcMassMatrix(self.standing_context())
        inertia = np.diag(M)[self.indices(self.plant).v]
        leg = self.legs[0]
        hip = [leg.hip_pitch, leg.hip_roll]
        pitch, roll = (inertia[hip] / self.effort_limit[hip]).tolist()
        return math.sqrt(math.sqrt(pitch * roll))

    @property
    def num_joints(self) -> int:
        """Number of actuated joints, which is the length of message arrays."""
        return len(self.joint_names)

    @cached_property
    def stand_prep(self) -> np.ndarray:
        """Joint positions of the stand-prep pose [rad], shape (n,)."""
        return read_only(np.array([joint.stand_prep for joint in self.file.joints]))

    @cached_property
    def default_kp(self) -> np.ndarray:
        """Default position gains [N·m/rad], shape (n,)."""
        return read_only(np.array([joint.kp for joint in self.file.joints]))

    @cached_property
    def default_kd(self) -> np.ndarray:
        """Default derivative gains [N·m·s/rad], shape (n,)."""
        return read_only(np.array([joint.kd for joint in self.file.joints]))

    @cached_property
    def kp_velocity_limit(self) -> np.ndarray:
        """Largest velocity gain that counts, as in the original [N·m·s/rad]."""
        return read_only(50.0 * self.effort_limit / self.velocity_limit)

    def limb(self, *names: str) -> np.ndarray:
        """Returns the mask of joints in the named limbs, bool, shape (n,)."""
        return np.array([joint.limb in names for joint in self.file.joints])

    @cached_property
    def joints(self) -> JointConstants:
        """Indices of joints in messages as constants: ``robot.joints.l_arm_elx``."""
        return JointConstants(self.file.joints)

    def joint_index(self, name: str) -> int:
        """Returns the index of a joint in the messages' arrays, by name or by alias."""
        index: int | None = vars(self.joints).get(name)
        if index is None:
            known = ", ".join(self.joint_names)
            problem = f"robot '{self.name}' has no joint '{name}'; it has {known}"
            raise RobotDescriptionError("joint", name, problem)
        return index

    def pushed_link(self, name: str) -> str:
        """Returns the link that a push names: ``trunk``, or a link's own name."""
        return self.trunk if name == TRUNK else name

    def contact(self, name: str) -> ContactEntry:
        """Returns the contact of this name in the robot's file."""
        for entry in self.file.contacts:
            if entry.name == name:
                return entry
        known = ", ".join(entry.name for entry in self.file.contacts) or "none"
        problem = f"robot '{self.name}' has no contact {shown(name)}; it has {known}"
        raise RobotDescriptionError("contact", name, problem)

    @cached_property
    def urdf(self) -> Path:
        """The URDF file."""
        return find_urdf(self.path.parent, self.file.urdf)

    @cached_property
    def plant(self) -> MultibodyPlant:
        """The model of the robot alone: a finalized plant without geometry and ground.

        It holds no state; whoever calculates with it has a Context of its own.
        """
        plant = MultibodyPlant(time_step=0.0)
        self.add_to(plant)
        plant.Finalize()
        return plant

    def standing_context(self) -> Context:
        """Creates a Context of ``plant`` with the robot in its stand-prep pose."""
        context = self.plant.CreateDefaultContext()
        q = self.plant.GetPositions(context)
        q[self.indices(self.plant).q] = self.stand_prep
        self.plant.SetPositions(context, q)
        return context

    def add_to(self, plant: MultibodyPlant) -> ModelInstanceIndex:
        """Parses the robot into ``plant`` (before Finalize)."""
        instance = add_urdf(plant, self.urdf, self.name)
        shape_contacts(plant, instance, self.file)
        return instance

    def instance(self, plant: MultibodyPlant) -> ModelInstanceIndex:
        """The robot's model instance in ``plant``, which may hold other models."""
        return plant.GetModelInstanceByName(self.name)

    def soles(self, plant: MultibodyPlant) -> list[FrameIndex]:
        """Returns the frames of the left and the right sole in ``plant``.

        As indices, because a frame holds its plant where the garbage collector cannot
        see it.
        """
        own = self.instance(plant)
        return [
            plant.GetFrameByName(foot.sole_frame, own).index()
            for foot in self.file.feet
        ]

    def hand_bodies(self, plant: MultibodyPlant) -> dict[int, int]:
        """Maps the index of each body of a hand in ``plant`` to 0, left, or 1, right.

        Bodies that are fixed to a hand, such as a gripper, belong to it.
        """
        instance = self.instance(plant)
        hands = [plant.GetBodyByName(name, instance) for name in self.file.hands]
        return {
            int(body.index()): side
            for side, hand in enumerate(hands)
            for body in plant.GetBodiesWeldedTo(hand)
        }

    @cached_property
    def arms(self) -> dict[str, str]:
        """Limbs that move the hands, by hand; empty for a robot without hands."""
        return dict(zip(self.file.hands, ("l_arm", "r_arm"), strict=False))

    @cached_property
    def palms(self) -> dict[str, list[float]]:
        """Points of the hands that go where these are told, in their frames [m]."""
        bodies = [self.plant.GetBodyByName(hand) for hand in self.file.hands]
        given = self.file.palms or [body.default_com().tolist() for body in bodies]
        return dict(zip(self.file.hands, given, strict=True))

    def indices(self, plant: MultibodyPlant) -> PlantIndices:
        """Finds the joints' indices in the robot's vectors of a finalized ``plant``."""
        return self._own_indices if plant is self.plant else self._indices_in(plant)

    @cached_property
    def _own_indices(self) -> PlantIndices:
        # Read in every tick of a hand's motion.
        return read_only(self._indices_in(self.plant))

    def _indices_in(self, plant: MultibodyPlant) -> PlantIndices:
        instance = self.instance(plant)
        joints = [plant.GetJointByName(name, instance) for name in self.joint_names]
        indices = plant.GetJointActuatorIndices(instance)
        starts = {
            actuator.joint().name(): actuator.input_start()
            for actuator in map(plant.get_joint_actuator, indices)
        }
        own_q, own_v = map(_places, own_places(plant, self))
        own_v = {index - plant.num_positions(): k for index, k in own_v.items()}
        all_u = np.arange(plant.num_actuated_dofs(), dtype=float)
        own_u = _places(plant.GetActuationFromArray(instance, all_u))
        v = np.array([own_v[joint.velocity_start()] for joint in joints])
        base = plant.GetBodyByName(self.file.pelvis, instance)
        base_q = own_q[base.floating_positions_start()]
        base_v = own_v[base.floating_velocities_start_in_v()]
        in_state = len(own_q) + base_v
        return PlantIndices(
            q=np.array([own_q[joint.position_start()] for joint in joints]),
            v=v,
            actuation=np.array([own_u[starts[name]] for name in self.joint_names]),
            generalized=np.concatenate([np.arange(base_v, base_v + 6), v]),
            pelvis=PelvisParts(
                orientation=slice(base_q, base_q + 4),
                position=slice(base_q + 4, base_q + 7),
                angular_velocity=slice(in_state, in_state + 3),
                velocity=slice(in_state + 3, in_state + 6),
            ),
        )


def _places(own: np.ndarray) -> dict[int, int]:
    """Maps an index of the plant's vector to the index of the robot's own vector."""
    return {int(index): place for place, index in enumerate(own)}


def own_places(plant: MultibodyPlant, robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Returns the places of the robot's positions and velocities in a plant's state."""
    own, num_q = robot.instance(plant), plant.num_positions()
    places = np.arange(plant.num_multibody_states(), dtype=float)
    q = plant.GetPositionsFromArray(own, places[:num_q])
    v = plant.GetVelocitiesFromArray(own, places[num_q:])
    return q.astype(int), v.astype(int)


def coordinates_beside(
    plant: MultibodyPlant, robot: Robot
) -> dict[str, dict[str, int]]:
    """Finds the coordinates of a finalized plant that are not the robot's.

    Maps ``q`` and ``v`` to places in the plant's state by name; empty for none.
    """
    own = set(np.concatenate(own_places(plant, robot)).tolist())
    names = [*plant.GetPositionNames(), *plant.GetVelocityNames()]
    others = {name: place for place, name in enumerate(names) if place not in own}
    num_q = plant.num_positions()
    if not others:
        return {}
    return {
        "q": {name: place for name, place in others.items() if place < num_q},
        "v": {name: place for name, place in others.items() if place >= num_q},
    }


def add_urdf(plant: MultibodyPlant, urdf: Path, name: str) -> ModelInstanceIndex:
    """Parses a URDF file into ``plant`` as a model instance of this name."""
    instance = parse(plant, urdf)[0]
    if plant.GetModelInstanceName(instance) != name:
        plant.RenameModelInstance(instance, name)
    return instance


def shape_contacts(
    plant: MultibodyPlant, instance: ModelInstanceIndex, file: RobotFile
) -> None:
    """Gives the feet their soles, and lets the pairs of bodies that do not touch pass.

    Does nothing to a plant without geometry (before Finalize).
    """
    if not plant.geometry_source_is_registered():
        return
    scene_graph = Parser(plant).scene_graph()
    add_soles(plant, scene_graph, instance, file)
    filters = scene_graph.collision_filter_manager()
    for pair in file.no_collisions:
        bodies = (plant.GetBodyByName(name, instance).index() for name in pair)
        one, other = map(GeometrySet, map(plant.GetBodyFrameIdOrThrow, bodies))
        filters.Apply(CollisionFilterDeclaration().ExcludeBetween(one, other))
