"""Records a station: one row of numbers per control tick, and notes beside it.

What a row holds is in ``channels``. Files are the business of the writer it is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.systems.framework import (
    Context,
    DiagramBuilder,
    DiscreteValues,
    LeafSystem,
    System,
    ValueProducer,
)

from atlas_drake.behaviors.base import Event
from atlas_drake.control.centre_of_pressure import centre_of_pressure
from atlas_drake.control.tasks import pendulum_frequency
from atlas_drake.logs.channels import GAINS, robot_layout
from atlas_drake.logs.layout import SIDES, Layout
from atlas_drake.logs.notes import COMMANDS, LogWriter, Note, event_note, to_plain
from atlas_drake.logs.report_channels import reported
from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.robot import Robot
from atlas_drake.systems.robot_sensors import contact_wrenches

LEAST_HEIGHT = 0.1
"""Of the CoM above the soles, for the DCM of a robot that lies on the ground [m]."""

_VECTORS = ("state", "behavior_state", "foot_wrenches", "effort", "user_effort")
_VALUES = (
    "commands",
    "controller_state",
    "atlas_sim_interface_state",
    "imu",
    "contact_results",
)


def layout_of(robot: Robot) -> Layout:
    """The layout of a robot's log."""
    plant = _plant(robot)
    return robot_layout(
        robot,
        plant.GetPositionNames(add_model_instance_prefix=False),
        plant.GetVelocityNames(add_model_instance_prefix=False),
    )


class LogRecorder(LeafSystem):
    """Ports of a station in, a log out.

    A row is sampled by a discrete update, which sees what the controller decided at
    the same instant and reads the contact forces that the plant is about to solve
    anyway. It is written a tick later, by a publish event, as is everything that
    leaves a diagram.

    Input ports, as the station's outputs of the same names:
        state, behavior_state, foot_wrenches, effort, user_effort
        commands, controller_state, atlas_sim_interface_state, imu, contact_results

    State: the row sampled last, shape (layout's width,). What has been written
    already is known here and not in a Context: it is a fact about the file.
    """

    def __init__(
        self,
        robot: Robot,
        layout: Layout,
        writer: LogWriter,
        period: float,
        tick_seconds: Sequence[float] = (),
    ):
        """Samples every ``period`` [s].

        Args:
            robot: The station's.
            layout: Of ``layout_of`` the robot.
            writer: Takes rows and notes.
            period: The control period [s].
            tick_seconds: Wall times of the controller's ticks, which it appends to.
        """
        super().__init__()
        self._layout = layout
        self._writer = writer
        self._period = period
        self._tick_seconds = tick_seconds
        self._plant = plant = _plant(robot)
        self._indices = robot.indices(plant)
        self._num_q = plant.num_positions()
        self._hands = [plant.GetBodyByName(name) for name in robot.file.hands]
        # The robot is the first in both plants: its bodies have the same numbers.
        self._hand_bodies = {int(body.index()): i for i, body in enumerate(self._hands)}
        sizes = (plant.num_multibody_states(),) * 2 + (12,) + (robot.num_joints,) * 2
        self._vectors = [
            self.DeclareVectorInputPort(name, size)
            for name, size in zip(_VECTORS, sizes, strict=True)
        ]
        self._values = [
            self.DeclareAbstractInputPort(
                name,
                AbstractValue.Make(
                    ContactResults() if name == "contact_results" else None
                ),
            )
            for name in _VALUES
        ]
        self._scratch = self.DeclareCacheEntry(
            "scratch context of the plant",
            ValueProducer(
                allocate=lambda: AbstractValue.Make(plant.CreateDefaultContext()),
                calc=ValueProducer.NoopCalc,
            ),
            {self.nothing_ticket()},
        )
        self._row = self.DeclareDiscreteState(np.full(layout.width, np.nan))
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._sample)
        self.DeclarePeriodicPublishEvent(period, 0.0, self._write)
        self._written_time = -np.inf
        self._seen: dict[str, object] = dict.fromkeys(COMMANDS)

    # ---- writing -------------------------------------------------------------

    def event(self, event: Event) -> None:
        """Records an event, which no port says in full."""
        self._writer.note(event_note(event))

    def flush(self, context: Context) -> None:
        """Writes the latest row, which waits for the next tick otherwise."""
        self._write(context)

    def close(self) -> None:
        """Completes the log; nothing is recorded any more."""
        self._writer.close()

    def _write(self, context: Context) -> None:
        row = context.get_discrete_state(self._row).value().copy()
        time = row[0]
        # There is none before the first tick; after a reset Drake publishes once more.
        if not time > self._written_time:
            return
        self._written_time = time
        commands: Any = self._values[0].Eval(context)
        latest = (commands.atlas_command, commands.sim_command)
        for kind, message in zip(COMMANDS, latest, strict=True):
            if message is not None and message is not self._seen[kind]:
                self._seen[kind] = message
                self._writer.note(Note(time, kind, to_plain(message)))
        self._writer.row(row)

    # ---- sampling ------------------------------------------------------------

    def _sample(self, context: Context, discrete: DiscreteValues) -> None:
        row = np.full(self._layout.width, np.nan)
        state, measured, wrenches, effort, user = (
            port.Eval(context) for port in self._vectors
        )
        commands, controller, report, imu, contacts = (
            port.Eval(context) for port in self._values
        )
        n = self._num_q
        values: dict[str, Any] = {
            "time": context.get_time(),
            "behavior.request_number": commands.request.number,
            "joints.position": measured[self._indices.q],
            "joints.velocity": measured[n + self._indices.v],
            "joints.effort": effort,
            "joints.user_effort": user,
            "joints.behavior_effort": controller.effort,
            "joints.k_effort": commands.k_effort,
            "imu.orientation": imu.orientation.to_wxyz(),
            "imu.angular_velocity": imu.angular_velocity.to_array(),
            "imu.linear_acceleration": imu.linear_acceleration.to_array(),
            "controller.unsolved": controller.unsolved,
            "controller.tick_time": self._tick_seconds[-1]
            if self._tick_seconds
            else np.nan,
            "state.q": state[:n],
            "state.v": state[n:],
        }
        for name in ("position", "velocity", "effort"):
            values[f"joints.{name}_setpoint"] = getattr(commands.joints, name)
        for name in GAINS:
            values[f"gains.{name}"] = getattr(commands.joints, name)
        values.update(reported(report))
        # The free pelvis comes first in the plant's positions, and its quaternion.
        values["pelvis.orientation"] = measured[:4]
        for foot, side in enumerate(SIDES):
            wrench = wrenches[6 * foot : 6 * foot + 6]
            values[f"feet.{side}_torque"] = wrench[:3]
            values[f"feet.{side}_force"] = wrench[3:]
        memory = controller.supervisor.memory
        values.update(self._balance(context, measured, report, memory))
        values.update(self._hand_wrenches(context, state, contacts))
        cop = centre_of_pressure(
            [values[f"feet.{side}_position"] for side in SIDES], wrenches
        )
        if cop is not None:
            values["balance.cop"] = cop[:2]
        for name, value in values.items():
            row[self._layout.places[name]] = value
        discrete.get_mutable_vector(self._row).SetFromVector(row)

    def _balance(
        self,
        context: Context,
        measured: np.ndarray,
        report: AtlasSimInterfaceState,
        memory: Any,
    ) -> dict[str, Any]:
        """Centre of mass and DCM as the controller believes them, and their plan."""
        scratch = self._scratch.Eval(context)
        plant: Any = self._plant
        plant.SetPositionsAndVelocities(scratch, measured)
        com = plant.CalcCenterOfMassPositionInWorld(scratch)
        velocity = plant.CalcCenterOfMassTranslationalVelocityInWorld(scratch)
        soles = [foot.position.z for foot in report.foot_pos_est]
        height = max(com[2] - 0.5 * sum(soles), LEAST_HEIGHT)
        omega = getattr(memory, "omega", None) or pendulum_frequency(height)
        values = {
            "balance.com": com,
            "balance.com_velocity": velocity,
            "balance.dcm": com[:2] + velocity[:2] / omega,
        }
        plan = getattr(memory, "dcm_reference", None)
        if plan is not None:
            reference = plan(omega)
            values["balance.dcm_reference"] = reference.dcm
            values["balance.cop_reference"] = reference.cop
        return values

    def _hand_wrenches(
        self, context: Context, state: np.ndarray, contacts: ContactResults
    ) -> dict[str, np.ndarray]:
        """Contact on both hands, about their body origins."""
        totals = np.array(contact_wrenches(contacts, self._hand_bodies))
        if totals.any():
            plant: Any = self._plant
            scratch = self._scratch.Eval(context)
            plant.SetPositionsAndVelocities(scratch, state)
            for hand, wrench in zip(self._hands, totals, strict=True):
                X_WH = plant.EvalBodyPoseInWorld(scratch, hand)
                wrench[:3] -= np.cross(X_WH.translation(), wrench[3:])
        values = {}
        for side, wrench in zip(SIDES, totals, strict=True):
            values[f"hands.{side}_torque"] = wrench[:3]
            values[f"hands.{side}_force"] = wrench[3:]
        return values


def add_log_recorder(
    builder: DiagramBuilder, station: System, recorder: LogRecorder
) -> None:
    """Adds a recorder to a diagram and connects it.

    Args:
        builder: Of the diagram that holds the station.
        station: An AtlasStation.
        recorder: Of the station's robot.
    """
    builder.AddNamedSystem("log_recorder", recorder)
    for index in range(recorder.num_input_ports()):
        port = recorder.get_input_port(index)
        builder.Connect(station.GetOutputPort(port.get_name()), port)


def _plant(robot: Robot) -> MultibodyPlant:
    """The robot alone: its coordinates lie as in the station's plant."""
    plant = MultibodyPlant(time_step=0.0)
    robot.add_to(plant)
    plant.Finalize()
    return plant
