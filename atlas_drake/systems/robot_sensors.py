"""What the robot measures: joints, IMU and the wrenches on its feet.

Messages are made only when somebody reads them; the controller reads plain vectors.
"""

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DiscreteValues,
    LeafSystem,
    ValueProducer,
)

from atlas_drake.control.whole_body_model import GRAVITY
from atlas_drake.messages import (
    AtlasState,
    Imu,
    Quaternion,
    Vector3,
    Wrench,
)
from atlas_drake.noise import NoiseModel, SensorNoise
from atlas_drake.robot import Robot


class RobotSensors(LeafSystem):
    """The plant's outputs in, measurements out.

    Input ports:
        state: Positions and velocities of the plant.
        contact_results: Of the plant.
        body_accelerations: Spatial accelerations of all bodies in W.
        effort: What the motors do [N·m], shape (n,).
        commands: ``CommandsInForce``, whose gains are reported.

    Output ports:
        measured_state: The state as measured: noise on the pelvis' angular velocity
            and on the joints, if the noise model has any.
        foot_wrenches: Of the ground on the left and the right sole, in W at the
            sole's centre [N·m; N], shape (12,), as they were one control tick ago.
        atlas_state: ``AtlasState``
        imu: ``Imu``
    """

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
        self._noise = SensorNoise(noise, seed, n, physics_step)
        self._pelvis = plant.GetBodyByName(robot.file.pelvis)
        imu_frame = plant.GetFrameByName(robot.file.imu_frame)
        self._X_PI = imu_frame.GetFixedPoseInBodyFrame()
        self._soles = [plant.GetFrameByName(f.sole_frame) for f in robot.file.feet]
        self._foot_of = {
            int(plant.GetBodyByName(foot.body).index()): i
            for i, foot in enumerate(robot.file.feet)
        }
        self._hands = [plant.GetBodyByName(name) for name in robot.file.hands]
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self._contacts = self.DeclareAbstractInputPort(
            "contact_results", AbstractValue.Make(ContactResults())
        )
        self._accelerations = self.DeclareAbstractInputPort(
            "body_accelerations",
            plant.get_body_spatial_accelerations_output_port().Allocate(),
        )
        self._effort = self.DeclareVectorInputPort("effort", n)
        self._commands = self.DeclareAbstractInputPort(
            "commands", AbstractValue.Make(None)
        )
        self._scratch = self.DeclareCacheEntry(
            "scratch context of the plant",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(plant.CreateDefaultContext()),
                calc=ValueProducer.NoopCalc,
            ),
            {self.nothing_ticket()},
        )
        state_ticket = self.input_port_ticket(self._state.get_index())
        self.DeclareVectorOutputPort(
            "measured_state",
            plant.num_multibody_states(),
            self._calc_measured_state,
            # Noise is new at every instant; without it the cache lasts longer.
            prerequisites_of_calc={state_ticket}
            if self._noise.silent
            else {state_ticket, self.time_ticket()},
        )
        self._wrenches = self.DeclareDiscreteState(12)
        self.DeclareVectorOutputPort(
            "foot_wrenches",
            12,
            lambda context, output: output.SetFromVector(
                context.get_discrete_state(self._wrenches).value()
            ),
            prerequisites_of_calc={self.xd_ticket()},
        )
        self.DeclarePeriodicDiscreteUpdateEvent(
            control_period, 0.0, self._sample_foot_wrenches
        )
        self.DeclareAbstractOutputPort(
            "atlas_state", lambda: AbstractValue.Make(AtlasState()), self._calc_state
        )
        self.DeclareAbstractOutputPort(
            "imu", lambda: AbstractValue.Make(Imu()), self._calc_imu
        )

    def _at_state(self, context: Context) -> Context:
        """The plant's scratch context at the present state."""
        scratch = self._scratch.Eval(context)
        self._plant.SetPositionsAndVelocities(scratch, self._state.Eval(context))
        return scratch

    def _calc_measured_state(self, context: Context, output: BasicVector) -> None:
        state = self._state.Eval(context)
        if not self._noise.silent:
            noise = self._noise.sample(context.get_time())
            indices, num_q = self._indices, self._plant.num_positions()
            state[indices.q] += noise.joint_position
            state[num_q + indices.v] += noise.joint_velocity
            state[num_q + indices.generalized[:3]] += noise.angular_velocity
        output.SetFromVector(state)

    def _sample_foot_wrenches(self, context: Context, discrete: DiscreteValues) -> None:
        """Reads the contacts that the plant's step at this instant solves anyway.

        Read before the controller's update they would have to be solved once more,
        with efforts that are about to change.
        """
        results: ContactResults = self._contacts.Eval(context)
        wrenches = [[0.0] * 6, [0.0] * 6]
        scratch = self._at_state(context)
        centres = [sole.CalcPoseInWorld(scratch).translation() for sole in self._soles]
        for k in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(k)
            # The force is that on body B.
            foot, sign = self._foot_of.get(int(info.bodyB_index())), 1.0
            if foot is None:
                foot, sign = self._foot_of.get(int(info.bodyA_index())), -1.0
                if foot is None:
                    continue
            fx, fy, fz = (sign * info.contact_force()).tolist()
            rx, ry, rz = (info.contact_point() - centres[foot]).tolist()
            wrench = wrenches[foot]
            wrench[0] += ry * fz - rz * fy
            wrench[1] += rz * fx - rx * fz
            wrench[2] += rx * fy - ry * fx
            wrench[3] += fx
            wrench[4] += fy
            wrench[5] += fz
        discrete.get_mutable_vector(self._wrenches).SetFromVector(
            wrenches[0] + wrenches[1]
        )

    def _calc_imu(self, context: Context, output: AbstractValue) -> None:
        scratch = self._at_state(context)
        X_WP = self._plant.EvalBodyPoseInWorld(scratch, self._pelvis)
        V_WP = self._plant.EvalBodySpatialVelocityInWorld(scratch, self._pelvis)
        A_WP = self._accelerations.Eval(context)[int(self._pelvis.index())]
        p_PI_W = X_WP.rotation() @ self._X_PI.translation()
        A_WI = A_WP.Shift(p_PI_W, V_WP.rotational())
        R_IW = (X_WP.rotation() @ self._X_PI.rotation()).inverse()
        gravity = np.array([0.0, 0.0, -GRAVITY])
        rate = R_IW @ V_WP.rotational()
        force = R_IW @ (A_WI.translational() - gravity)
        if not self._noise.silent:
            noise = self._noise.sample(context.get_time())
            rate = rate + noise.angular_velocity
            force = force + noise.specific_force
        imu = Imu()
        imu.header.stamp = context.get_time()
        imu.orientation = Quaternion.from_wxyz(R_IW.inverse().ToQuaternion().wxyz())
        imu.angular_velocity = Vector3.from_array(rate)
        imu.linear_acceleration = Vector3.from_array(force)
        output.set_value(imu)

    def _calc_state(self, context: Context, output: AbstractValue) -> None:
        state = self.GetOutputPort("measured_state").Eval(context)
        commands = self._commands.Eval(context)
        imu: Imu = self.GetOutputPort("imu").Eval(context)
        message = AtlasState()
        message.header.stamp = context.get_time()
        message.position = state[self._indices.q].tolist()
        velocities = state[self._plant.num_positions() :]
        message.velocity = velocities[self._indices.v].tolist()
        message.effort = self._effort.Eval(context).tolist()
        for name in (
            "kp_position",
            "ki_position",
            "kd_position",
            "kp_velocity",
            "i_effort_min",
            "i_effort_max",
        ):
            setattr(message, name, getattr(commands.joints, name).tolist())
        message.k_effort = commands.k_effort.astype(int).tolist()
        message.orientation = imu.orientation
        message.angular_velocity = imu.angular_velocity
        message.linear_acceleration = imu.linear_acceleration
        wrenches = self.GetOutputPort("foot_wrenches").Eval(context)
        message.l_foot = _wrench(wrenches[:6])
        message.r_foot = _wrench(wrenches[6:])
        message.l_hand, message.r_hand = self._hand_wrenches(context)
        output.set_value(message)

    def _hand_wrenches(self, context: Context) -> tuple[Wrench, Wrench]:
        """Contact forces on the hands, about their body origins, in W."""
        results: ContactResults = self._contacts.Eval(context)
        scratch = self._at_state(context)
        totals = []
        for hand in self._hands:
            origin = self._plant.EvalBodyPoseInWorld(scratch, hand).translation()
            total = np.zeros(6)
            for k in range(results.num_point_pair_contacts()):
                info = results.point_pair_contact_info(k)
                for index, sign in (
                    (int(info.bodyB_index()), 1.0),
                    (int(info.bodyA_index()), -1.0),
                ):
                    if index == int(hand.index()):
                        force = sign * info.contact_force()
                        total[:3] += np.cross(info.contact_point() - origin, force)
                        total[3:] += force
            totals.append(_wrench(total))
        return totals[0], totals[1]


def _wrench(coefficients: np.ndarray) -> Wrench:
    return Wrench(
        torque=Vector3.from_array(coefficients[:3]),
        force=Vector3.from_array(coefficients[3:]),
    )
