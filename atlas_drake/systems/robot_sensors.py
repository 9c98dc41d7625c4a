"""The robot's sensors: joints, IMU and the wrenches on its feet and hands.

Messages are made only when their ports are read; the controller reads plain vectors.
"""

from collections.abc import Sequence
from dataclasses import fields
from functools import partial

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.multibody.tree import BodyIndex, FrameIndex
from pydrake.systems.framework import Context, DiscreteValues

from atlas_drake.control.wrenches import shift_to_frames
from atlas_drake.messages import AtlasState, Header, Imu, Quaternion, Vector3, Wrench
from atlas_drake.records.groups import Gains
from atlas_drake.robot import Robot
from atlas_drake.rotations import rotation_matrix
from atlas_drake.systems.contact_forces import contact_wrenches, shapes_of
from atlas_drake.systems.imu import ImuModel, NoisySystem
from atlas_drake.systems.sensor_noise import NoiseModel, SensorNoise
from atlas_drake.units import GRAVITY

_GAINS = [field.name for field in fields(Gains)]


class RobotSensors(NoisySystem):
    """The plant's outputs in, measurements out.

    Input ports:
        state: Positions and velocities of the robot.
        contact_results: Contacts of the plant, those with other models included.
        acceleration: Generalized accelerations of the robot, in the order of its
            velocities.
        net_actuation: Efforts of the motors, in the plant's order [N·m], shape (n,).
        commands: ``ActiveCommand``, whose gains are reported.

    Output ports:
        measured_state: The state as measured: noise on the pelvis' angular velocity
            and on the joints, if the noise model has any.
        effort: Efforts of the motors [N·m], shape (n,), message order.
        foot_loads: Vertical contact forces on the left and the right foot [N], shape
            (2,), one control tick ago.
        foot_wrenches: Contact wrenches on both feet, in W at the sole's center
            [N·m; N], shape (12,), at the instant of ``foot_loads``.
        hand_wrenches: Wrenches on both hands, in W at their body origins [N·m; N],
            shape (12,), of contacts and of the weight of other models that are welded
            to them; zero for a robot without hands. A hand that touches the robot
            itself moves nothing, and feels nothing.
        contact_wrenches: The wrenches of contacts on feet and hands, all about W's
            origin, shape (24,).
        atlas_state: ``AtlasState``
        imu: ``Imu``
        sensor_noise: ``SensorNoise`` in force, for measurements that are made later.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        plant: MultibodyPlant,
        noise: NoiseModel,
        seed: int,
        physics_step: float,
        control_period: float,
    ):
        """Measures ``robot`` in ``plant``; noise changes every ``physics_step`` [s]."""
        super().__init__()
        n = robot.num_joints
        self._robot = robot
        self._plant = plant
        self._indices = robot.indices(plant)
        self.declare_noise(SensorNoise(noise, seed, n, physics_step))
        # Indices, because bodies and frames hold their plant where the garbage
        # collector cannot see it.
        self._instance = own = robot.instance(plant)
        self._imu_model = ImuModel(robot, plant)
        feet = [plant.GetBodyByName(foot.body, own) for foot in robot.file.feet]
        self._bodies = {int(body.index()): i for i, body in enumerate(feet)}
        hands = [
            plant.GetBodyByName(name, own).body_frame().index()
            for name in robot.file.hands
        ]
        tools = []
        for index, hand in robot.hand_bodies(plant).items():
            self._bodies[index] = len(feet) + hand
            if plant.get_body(BodyIndex(index)).model_instance() != own:
                tools.append((hand, index))
        links = {int(index) for index in plant.GetBodyIndices(own)}
        self._shapes = shapes_of(plant, links | self._bodies.keys())
        self._ignored = dict.fromkeys(robot.hand_bodies(plant), links)
        num_states = plant.num_multibody_states(own)
        self._num_q = plant.num_positions(own)
        self._state = self.DeclareVectorInputPort("state", num_states)
        self._contacts = self.DeclareAbstractInputPort(
            "contact_results", AbstractValue.Make(ContactResults())
        )
        self._acceleration = self.DeclareVectorInputPort(
            "acceleration", plant.num_velocities(own)
        )
        self._net_actuation = self.DeclareVectorInputPort("net_actuation", n)
        # Places of the joints among the motors of the robot.
        self._motors = np.argsort(np.argsort(self._indices.actuation))
        self._commands = self.declare_value_input("commands")
        self._scratch = self.declare_scratch_context(plant.CreateDefaultContext)
        state_ticket = self.input_port_ticket(self._state.get_index())
        # Noise depends on time; without noise the cache stays valid longer.
        sources = {state_ticket}
        if noise != NoiseModel():
            sources |= {self.time_ticket(), self.pa_ticket()}
        self.declare_vector_output(
            "measured_state", num_states, self._measured, sources
        )
        # About W's origin, because the poses of soles and hands are costly and seldom
        # needed: both feet, then both hands.
        self._wrenches = self.DeclareDiscreteState(24)
        self.DeclareStateOutputPort("contact_wrenches", self._wrenches)
        self.declare_vector_output(
            "foot_loads",
            2,
            lambda context: self._sampled(context)[[5, 11]],
            {self.xd_ticket()},
        )
        for name, part, frames, hung in (
            ("foot_wrenches", slice(0, 12), robot.soles(plant), []),
            ("hand_wrenches", slice(12, 24), hands, tools),
        ):
            self.declare_vector_output(
                name,
                12,
                partial(self._shifted, part, frames, hung),
                {self.xd_ticket(), state_ticket},
            )
        self.DeclarePeriodicDiscreteUpdateEvent(
            control_period, 0.0, self._sample_wrenches
        )
        self.declare_vector_output(
            "effort",
            n,
            self._effort,
            {self.input_port_ticket(self._net_actuation.get_index())},
        )
        self.declare_value_output("atlas_state", self._atlas_state)
        self.declare_value_output("imu", self._imu)
        self.declare_value_output("sensor_noise", self.noise, {self.pa_ticket()})

    def reset(self, context: Context) -> None:
        """Clears the last contact forces."""
        context.SetDiscreteState(self._wrenches, np.zeros(24))

    def _measured(self, context: Context) -> np.ndarray:
        state = self._state.Eval(context)
        if not self.noise(context).silent:
            noise = self.noise(context).sample(context.get_time())
            indices, num_q = self._indices, self._num_q
            state[indices.q] += noise.joint_position
            state[num_q + indices.v] += noise.joint_velocity
            # Rotate the gyroscope's noise from the IMU's axes to the world's.
            R_WP = rotation_matrix(state[indices.pelvis.orientation])
            turned = R_WP @ (self._imu_model.R_PI @ noise.angular_velocity)
            state[self._imu_model.w] += turned
        return state

    def _sample_wrenches(self, context: Context, discrete: DiscreteValues) -> None:
        # The plant's step at this instant solves the contacts anyway; before the
        # controller's update they would be solved once more, with outdated efforts.
        totals = contact_wrenches(
            self._contacts.Eval(context), self._bodies, self._shapes, self._ignored
        )
        wrenches = np.zeros(24)
        wrenches[: 6 * len(totals)] = [number for total in totals for number in total]
        discrete.set_value(self._wrenches, wrenches)

    def _sampled(self, context: Context) -> np.ndarray:
        """Returns the wrenches on feet and hands about W's origin, shape (24,)."""
        return context.get_discrete_state(self._wrenches).value()

    def _shifted(
        self,
        part: slice,
        frames: Sequence[FrameIndex],
        hung: Sequence[tuple[int, int]],
        context: Context,
    ) -> np.ndarray:
        """Computes a part of the wrenches, each about the origin of its frame.

        The weight of bodies that are ``hung`` on one of the frames counts: each has the
        place of its frame and its own index in the plant.
        """
        wrenches, plant = self._sampled(context)[part].copy(), self._plant
        if hung or wrenches.any():
            scratch = self._scratch.Eval(context)
            plant.SetPositions(
                scratch, self._instance, self._state.Eval(context)[: self._num_q]
            )
            of_frames = wrenches.reshape(-1, 6)
            for place, index in hung:
                body = plant.get_body(BodyIndex(index))
                X_WB = plant.EvalBodyPoseInWorld(scratch, body)
                x, y, _ = X_WB @ body.default_spatial_inertia().get_com()
                weight = GRAVITY * body.default_mass()
                of_frames[place] += [-y * weight, x * weight, 0.0, 0.0, 0.0, -weight]
            shift_to_frames(of_frames, map(plant.get_frame, frames), scratch)
        return wrenches

    def _effort(self, context: Context) -> np.ndarray:
        effort: np.ndarray = self._net_actuation.Eval(context)[self._motors]
        return effort

    def _imu(self, context: Context) -> Imu:
        time = context.get_time()
        q_WI, rate, force = self._imu_model.measure(
            self._state.Eval(context),
            self._acceleration.Eval(context),
            self.noise(context),
            time,
        )
        vectors = Vector3.from_array(rate), Vector3.from_array(force)
        return Imu(Header(time), Quaternion.from_wxyz(q_WI), *vectors)

    def _atlas_state(self, context: Context) -> AtlasState:
        state = self.GetOutputPort("measured_state").Eval(context)
        commands = self._commands.Eval(context)
        imu: Imu = self.GetOutputPort("imu").Eval(context)
        message = AtlasState()
        message.header.stamp = context.get_time()
        message.position = state[self._indices.q].tolist()
        velocities = state[self._num_q :]
        message.velocity = velocities[self._indices.v].tolist()
        message.effort = self._effort(context).tolist()
        for name in _GAINS:
            setattr(message, name, getattr(commands.joints, name).tolist())
        message.k_effort = commands.k_effort.astype(int).tolist()
        message.orientation = imu.orientation
        message.angular_velocity = imu.angular_velocity
        message.linear_acceleration = imu.linear_acceleration
        feet = self.GetOutputPort("foot_wrenches").Eval(context)
        hands = self.GetOutputPort("hand_wrenches").Eval(context)
        message.l_foot, message.r_foot = _wrench(feet[:6]), _wrench(feet[6:])
        message.l_hand, message.r_hand = _wrench(hands[:6]), _wrench(hands[6:])
        return message


def _wrench(coefficients: np.ndarray) -> Wrench:
    return Wrench(
        torque=Vector3.from_array(coefficients[:3]),
        force=Vector3.from_array(coefficients[3:]),
    )
