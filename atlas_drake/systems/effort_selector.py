"""Blends the user's and the behavior's efforts, joint by joint.

effort = k·user + (1 - k)·behavior with k = k_effort/255, within the effort limits.
"""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import PdControllerGains
from pydrake.systems.framework import Context, DependencyTicket, InputPort

from atlas_drake.control.joints.blend import limited
from atlas_drake.control.joints.joint_pid import MotorLaw
from atlas_drake.control.joints.speed_hold import SpeedHold
from atlas_drake.frozen import NOTHING
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem


class EffortSelector(CollectableSystem):
    """The k_effort selector, and what it tells the plant's motors.

    Input ports, shape (n,), message order:
        received_effort: Efforts of the behavior, as the motors receive them [N·m].
        k: The user's blend weight, 0 to 1.
        motor_law: ``MotorLaw``, the user's part.
        received_hold: ``SpeedHold``, what the motors add to these efforts, or
            ``NOTHING``; optional.
        state: Positions and velocities of the robot, see ``_actuation``.

    Output ports:
        actuation: What the plant's motors add to spring and dampings [N·m],
            shape (n,), in their order; they limit the sum.
        desired_state: Set-points of spring and damping, as the plant's port takes them.
    """

    __slots__ = ()

    def __init__(self, robot: Robot, plant: MultibodyPlant):
        """Blends for the motors of ``robot`` in ``plant``."""
        super().__init__()
        n, own = robot.num_joints, robot.instance(plant)
        self._limit = robot.effort_limit
        self._to_plant = np.argsort(robot.indices(plant).actuation)
        self._plant = plant
        self._motors = plant.GetJointActuatorIndices(own)
        # Stiffness and damping that the plant's motors have; at first not known.
        self._known = np.full((2, n), np.nan)
        self._behavior = self.DeclareVectorInputPort("received_effort", n)
        self._k = self.DeclareVectorInputPort("k", n)
        self._law = self.declare_value_input("motor_law")
        self._hold = self.declare_value_input("received_hold")
        state = self.DeclareVectorInputPort("state", plant.num_multibody_states(own))
        sources = self._of(self._behavior, self._k, self._law, self._hold)
        self._given = self.declare_cached("given efforts", self._efforts, sources)
        sources = {*self._of(state), self._given.ticket()}
        self.declare_vector_output("actuation", n, self._actuation, sources)
        self.declare_vector_output(
            "desired_state", 2 * n, self._desired_state, self._of(self._law)
        )

    def _of(self, *ports: InputPort) -> set[DependencyTicket]:
        return {self.input_port_ticket(port.get_index()) for port in ports}

    def _actuation(self, context: Context) -> np.ndarray:
        """Returns the efforts, after the plant's motors were given the law's gains.

        Drake keeps gains in the plant and not in the Context. It reads them after this
        port whenever it prepares a step, and the port's value lasts as long as the
        state: each step has the gains of its own Context, in whatever order Contexts
        take turns. Only two threads must not step Contexts of one plant at once.
        """
        gains, effort = self._given.Eval(context)
        if (gains != self._known).any():
            self._give(gains)
        return effort

    def _efforts(self, context: Context) -> tuple[np.ndarray, np.ndarray]:
        law: MotorLaw = self._law.Eval(context)
        rest, own = 1.0 - self._k.Eval(context), self._behavior.Eval(context)
        gains = np.array([law.stiffness, law.damping])
        connected = self._hold.HasValue(context)
        hold = self._hold.Eval(context) if connected else NOTHING
        if isinstance(hold, SpeedHold):
            gains[1] += rest * hold.damping
            own = own + hold.damping * hold.speed
        effort = law.feed_forward + rest * own
        # Motors without gains do not limit what they are told to give.
        effort = np.where(gains.any(axis=0), effort, limited(effort, self._limit))
        return gains, effort.take(self._to_plant)

    def _give(self, gains: np.ndarray) -> None:
        of_motors = gains.T[self._to_plant].tolist()
        for index, (p, d) in zip(self._motors, of_motors, strict=True):
            motor = self._plant.get_mutable_joint_actuator(index)
            motor.set_controller_gains(PdControllerGains(p=p, d=d))
        self._known = gains

    def _desired_state(self, context: Context) -> np.ndarray:
        position = self._law.Eval(context).position[self._to_plant]
        return np.concatenate([position, np.zeros_like(position)])
