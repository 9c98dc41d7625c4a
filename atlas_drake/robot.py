"""The description of one robot: joints, aliases, default gains, feet, limits.

Everything is loaded from ``models/``; nothing here knows a particular robot. This
is also the one place that converts between message order and the plant's order.
It holds no control law and no state.
"""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from pydrake.common.yaml import yaml_load_typed
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, ModelInstanceIndex

from atlas_drake.errors import RobotDescriptionError

MODELS_FOLDER = Path(__file__).parent / "models"
DEFAULT_ROBOT = "atlas"
LIMBS = ("back", "neck", "l_leg", "r_leg", "l_arm", "r_arm")


@dataclass
class JointEntry:
    """One joint of the YAML description, in message order."""

    name: str = ""
    alias: str = ""
    """Name of the same joint on the first version of the robot."""
    limb: str = ""
    """One of LIMBS: what the joint is part of."""
    kp: float = 0.0
    """Default position gain in force before any command [N·m/rad]."""
    kd: float = 0.0
    """Default derivative gain in force before any command [N·m·s/rad]."""
    stand_prep: float = 0.0
    """Position in the pose from which STAND can begin [rad]."""


@dataclass
class FootEntry:
    """One foot: its body and the frame in which footsteps are commanded."""

    body: str = ""
    sole_frame: str = ""
    """Centre of the sole on its bottom plane, x ahead, z along the normal."""


@dataclass
class SoleSize:
    """Contact rectangle of one sole."""

    length: float = 0.0
    """Along the sole's x [m]."""
    width: float = 0.0
    """Along the sole's y [m]."""


@dataclass
class RobotFile:
    """The schema of ``models/<name>.yaml``."""

    urdf: str = ""
    pelvis: str = ""
    chest: str = ""
    hands: list[str] = field(default_factory=list)
    """Bodies of the left and the right hand."""
    imu_frame: str = ""
    feet: list[FootEntry] = field(default_factory=list)
    """Left foot, right foot: the order of foot_index."""
    sole: SoleSize = field(default_factory=SoleSize)
    joints: list[JointEntry] = field(default_factory=list)
    """Every actuated joint in the order of the messages' arrays."""


@dataclass(frozen=True)
class LegLengths:
    """Lengths of the legs; index 0 left, 1 right.

    Attributes:
        p_PH: Hip pitch joints in the pelvis frame, joints at zero [m], shape (2, 3).
        p_FA: Ankle joints in their sole frames [m], shape (2, 3).
        thigh: From hip to knee [m].
        shank: From knee to ankle [m].
        straight: Knee position at which hip, knee and ankle are in line [rad].
        knees: Indices of the knee joints in message order.
    """

    p_PH: np.ndarray
    p_FA: np.ndarray
    thigh: float
    shank: float
    straight: float
    knees: tuple[int, int]


@dataclass(frozen=True)
class PelvisParts:
    """Parts of a plant's state [q; v] that are the free pelvis'.

    Attributes:
        orientation: Quaternion, w first.
        position: In W [m].
        angular_velocity: In W [rad/s].
        velocity: In W [m/s].
    """

    orientation: slice
    position: slice
    angular_velocity: slice
    velocity: slice


@dataclass(frozen=True)
class PlantIndices:
    """Where each joint lies in the robot's own vectors, in message order.

    The robot's own vectors are those of its model instance: as in a plant that holds
    nothing but the robot, whatever else is in the plant.

    Attributes:
        q: Index of each joint into the robot's positions, shape (n,).
        v: Index of each joint into the robot's velocities, shape (n,).
        actuation: Index of each joint into the robot's actuation, shape (n,).
        generalized: The six base velocities, then ``v``: shape (6 + n,).
        pelvis: The free pelvis, in the robot's state [q; v].
    """

    q: np.ndarray
    v: np.ndarray
    actuation: np.ndarray
    generalized: np.ndarray
    pelvis: PelvisParts


@dataclass(frozen=True)
class Robot:
    """One robot, read from its YAML description and its URDF.

    All joint arrays are in message order and have shape (n,).

    Attributes:
        name: Name of the robot, also of its files in ``models/``.
        file: The description as read.
        joint_names: Names in message order.
        position_lower: Lower position limits [rad].
        position_upper: Upper position limits [rad].
        velocity_limit: Velocity limits [rad/s].
        effort_limit: Effort limits [N·m].
        mass: Total mass [kg].
        body_names: Names of all links.
        moved_links: Name of the link that each joint moves.
        legs: Their lengths.
    """

    name: str
    file: RobotFile
    joint_names: tuple[str, ...]
    position_lower: np.ndarray
    position_upper: np.ndarray
    velocity_limit: np.ndarray
    effort_limit: np.ndarray
    mass: float
    body_names: tuple[str, ...]
    moved_links: tuple[str, ...]
    legs: LegLengths

    @property
    def num_joints(self) -> int:
        """Number of actuated joints, which is the length of message arrays."""
        return len(self.joint_names)

    @cached_property
    def stand_prep(self) -> np.ndarray:
        """Joint positions of the stand-prep pose [rad], shape (n,)."""
        return np.array([joint.stand_prep for joint in self.file.joints])

    @cached_property
    def default_kp(self) -> np.ndarray:
        """Default position gains [N·m/rad], shape (n,)."""
        return np.array([joint.kp for joint in self.file.joints])

    @cached_property
    def default_kd(self) -> np.ndarray:
        """Default derivative gains [N·m·s/rad], shape (n,)."""
        return np.array([joint.kd for joint in self.file.joints])

    @cached_property
    def kp_velocity_limit(self) -> np.ndarray:
        """Largest velocity gain that counts, as in the original [N·m·s/rad]."""
        return 50.0 * self.effort_limit / self.velocity_limit

    def limb(self, *names: str) -> np.ndarray:
        """Which joints belong to any of the limbs named, bool, shape (n,)."""
        return np.array([joint.limb in names for joint in self.file.joints])

    def joint_index(self, name: str) -> int:
        """Index of a joint in the messages' arrays, by name or by v1 alias.

        Raises:
            RobotDescriptionError: If the robot has no such joint.
        """
        for index, joint in enumerate(self.file.joints):
            # A joint without an alias has an empty one, which names nothing.
            if name and name in (joint.name, joint.alias):
                return index
        raise RobotDescriptionError(
            f"robot '{self.name}' has no joint '{name}'; it has "
            + ", ".join(self.joint_names)
        )

    def make_plant(self) -> MultibodyPlant:
        """A finalized plant of the robot alone, for models: no geometry, no ground."""
        plant = MultibodyPlant(time_step=0.0)
        self.add_to(plant)
        plant.Finalize()
        return plant

    def add_to(self, plant: MultibodyPlant) -> ModelInstanceIndex:
        """Parses the robot into ``plant`` (before Finalize)."""
        return Parser(plant).AddModels(MODELS_FOLDER / self.file.urdf)[0]

    def instance(self, plant: MultibodyPlant) -> ModelInstanceIndex:
        """The robot's model instance in ``plant``, which may hold other models."""
        return plant.GetModelInstanceByName(self.name)

    def indices(self, plant: MultibodyPlant) -> PlantIndices:
        """Where the joints lie in the robot's vectors of the finalized ``plant``."""
        instance = self.instance(plant)
        joints = [plant.GetJointByName(name, instance) for name in self.joint_names]
        starts = {
            actuator.joint().name(): actuator.input_start()
            for actuator in (
                plant.get_joint_actuator(index)
                for index in plant.GetJointActuatorIndices(instance)
            )
        }
        all_q, all_v, all_u = (
            np.arange(count, dtype=float)
            for count in (
                plant.num_positions(),
                plant.num_velocities(),
                plant.num_actuated_dofs(),
            )
        )
        own_q = _places(plant.GetPositionsFromArray(instance, all_q))
        own_v = _places(plant.GetVelocitiesFromArray(instance, all_v))
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
    """Place in the robot's own vector by index into the plant's."""
    return {int(index): place for place, index in enumerate(own)}


def available_robots() -> list[str]:
    """Names that ``load_robot`` accepts, the default first."""
    names = sorted(path.stem for path in MODELS_FOLDER.glob("*.yaml"))
    return sorted(names, key=lambda name: name != DEFAULT_ROBOT)


def load_robot(name: str = DEFAULT_ROBOT) -> Robot:
    """Reads one robot from ``models/``.

    Raises:
        RobotDescriptionError: If there is no such robot, or its description and
            its URDF do not belong together.
    """
    # A name, and no path: it may come from a file of somebody else's.
    if name not in available_robots():
        raise RobotDescriptionError(
            f"there is no robot '{name}'; available: {', '.join(available_robots())}"
        )
    path = MODELS_FOLDER / f"{name}.yaml"
    file = yaml_load_typed(schema=RobotFile, filename=str(path))
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModels(MODELS_FOLDER / file.urdf)
    plant.Finalize()
    names = tuple(joint.name for joint in file.joints)
    actuators = {
        plant.get_joint_actuator(index).joint().name(): plant.get_joint_actuator(index)
        for index in plant.GetJointActuatorIndices()
    }
    if sorted(names) != sorted(actuators):
        raise RobotDescriptionError(
            f"{path.name} and {file.urdf} name different actuated joints: "
            f"{sorted(set(names) ^ set(actuators)) or 'one is listed twice'}"
        )
    joints = [plant.GetJointByName(joint_name) for joint_name in names]
    return Robot(
        name=name,
        file=file,
        joint_names=names,
        position_lower=np.array([j.position_lower_limits()[0] for j in joints]),
        position_upper=np.array([j.position_upper_limits()[0] for j in joints]),
        velocity_limit=np.array([j.velocity_upper_limits()[0] for j in joints]),
        effort_limit=np.array([actuators[n].effort_limit() for n in names]),
        mass=plant.CalcTotalMass(plant.CreateDefaultContext()),
        body_names=tuple(
            plant.get_body(index).name()
            for index in plant.GetBodyIndices(plant.GetModelInstanceByName(name))
        ),
        moved_links=tuple(str(joint.child_body().name()) for joint in joints),
        legs=_leg_lengths(file, plant),
    )


HIP_PITCH, KNEE, ANKLE_PITCH = 2, 3, 4
"""Places among a leg's joints: hip z, x, y, knee, ankle y, x."""


def _leg_lengths(file: RobotFile, plant: MultibodyPlant) -> LegLengths:
    """Reads the legs' lengths off the robot with all joints at zero."""
    context = plant.CreateDefaultContext()

    def position(frame: Frame) -> np.ndarray:
        return np.array(frame.CalcPoseInWorld(context).translation())

    pelvis = plant.GetBodyByName(file.pelvis).body_frame()

    def pitch(down: np.ndarray) -> float:
        return float(np.arctan2(-down[0], -down[2]))

    hips, ankles, knees = [], [], []
    for foot, limb in zip(file.feet, ("l_leg", "r_leg"), strict=True):
        leg = [i for i, joint in enumerate(file.joints) if joint.limb == limb]
        hip, knee, ankle = (
            position(plant.GetJointByName(file.joints[leg[k]].name).frame_on_child())
            for k in (HIP_PITCH, KNEE, ANKLE_PITCH)
        )
        hips.append(hip - position(pelvis))
        ankles.append(ankle - position(plant.GetFrameByName(foot.sole_frame)))
        knees.append(leg[KNEE])
    thigh, shank = knee - hip, ankle - knee
    return LegLengths(
        p_PH=np.array(hips),
        p_FA=np.array(ankles),
        thigh=float(np.linalg.norm(thigh)),
        shank=float(np.linalg.norm(shank)),
        straight=pitch(thigh) - pitch(shank),
        knees=(knees[0], knees[1]),
    )
