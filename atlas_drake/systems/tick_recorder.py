"""Makes the record of each control tick from what the systems of a station hold.

A discrete update latches the numbers of the tick, which Drake runs after the
controller's unrestricted update of the same instant; the controller keeps its own state
until the next tick. The record is put together when somebody reads it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, DiscreteValues

from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import read_only
from atlas_drake.messages import Message
from atlas_drake.messages.commands import ActiveCommand, BehaviorRequest
from atlas_drake.messages.controller_status import ControllerStatus, Plan
from atlas_drake.messages.event import Event
from atlas_drake.messages.joint_command import JOINT_FIELDS
from atlas_drake.records.column import XYZ, Names
from atlas_drake.records.groups import (
    BehaviorNumbers,
    ContactPairs,
    ControllerNumbers,
    Estimator,
    Gains,
    ImuNumbers,
    Joints,
    Pelvis,
    State,
    World,
)
from atlas_drake.records.plain import to_plain
from atlas_drake.records.schema import GROUPS, OPTIONAL, Schema
from atlas_drake.records.tick_record import NO_QP, TickRecord, landed_among
from atlas_drake.robot import Robot
from atlas_drake.robot.robot import coordinates_beside
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.imu import ImuModel
from atlas_drake.systems.interface_reporter import FEEDBACK_FIELDS, answer
from atlas_drake.systems.record_kinematics import RecordKinematics
from atlas_drake.systems.tick_events import Marks, events_between, marks_at

_ANSWER = ("request_number", "error_code", "reached")
_PLAN_FIELDS = frozenset(field.name for field in fields(Plan))


class TickRecorder(CollectableSystem):
    """The signals of a station in, the record of the latest control tick out.

    Before the first tick, and after a reset until the next one, the record describes
    the present instant.

    Input ports:
        numbers: The signals in ``sizes``, one after the other.
        event_count: Number of events of the controller so far, shape (1,).
        sensor_noise: ``SensorNoise`` in force.
        commands: ``ActiveCommand``
        controller_status: ``ControllerStatus``
        pushes: ``PushState``
        fall: ``Fall``; NOTHING until the robot falls.
        gantry: Has ``released``, the time at which the robot is let down [s], or None;
            left out without a gantry.

    Output ports:
        record: ``TickRecord``.
        marks: Counts of events until now, see ``tick_events``.

    State: the numbers of the last tick, NaN before the first one except for marks.

    Attributes:
        sizes: Lengths of the signals that ``numbers`` is made of, by name, in order.
        schema: Schema of the records.
        period: Time between two control ticks [s].
        tick_seconds: Wall times of the controller's ticks [s], which are not part of
            the Context; the last one goes into the record.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        plant: MultibodyPlant,
        period: float,
        estimated: bool,
        contacts: Sequence[Sequence[str]],
    ) -> None:
        """Latches the numbers of each tick.

        Args:
            robot: The robot.
            plant: Plant of the whole simulation.
            period: Control period [s].
            estimated: True if there is a state estimator.
            contacts: Names of the bodies of each of the ``ContactPairs``.
        """
        super().__init__()
        n = robot.num_joints
        self._robot, self.period = robot, period
        self._model: Any = robot.plant
        self._indices = robot.indices(self._model)
        self._num_q = self._model.num_positions()
        self._imu_model = ImuModel(robot, self._model)
        self._kinematics = RecordKinematics(robot)
        beside = coordinates_beside(plant, robot)
        self._beside = {name: [*places.values()] for name, places in beside.items()}
        size = self._model.num_multibody_states()
        self.sizes = {"state": size, "behavior_state": size, "contact_wrenches": 24}
        # Signals that the plant's step at the tick needs anyway.
        self.sizes |= {"acceleration": self._model.num_velocities(), "effort": n}
        self.sizes |= dict.fromkeys(("user_effort", "behavior_effort"), n)
        if beside:
            self.sizes["plant_state"] = plant.num_multibody_states()
        if estimated:
            self.sizes["estimation_error"] = 9
        if contacts:
            self.sizes["contact_pairs"] = 6 * len(contacts)
        self.schema = self._schema(beside, ["-".join(names) for names in contacts])
        self.tick_seconds: Sequence[float] = ()
        self._places = _places(
            {
                "time": 1,
                **self.sizes,
                **{f"joint {name}": n for name in JOINT_FIELDS},
                **dict.fromkeys(_ANSWER, 1),
                "marks": len(Marks()),
                "marks before": len(Marks()),
            }
        )
        self._numbers = self.DeclareVectorInputPort("numbers", sum(self.sizes.values()))
        self._event_count = self.DeclareVectorInputPort("event_count", 1)
        self._noise = self.declare_value_input("sensor_noise")
        self._commands = self.declare_value_input("commands")
        self._status = self.declare_value_input("controller_status")
        self._pushes = self.declare_value_input("pushes")
        self._fall = self.declare_value_input("fall")
        self._gantry = self.declare_value_input("gantry")
        self._scratch = self.declare_scratch_context(self._model.CreateDefaultContext)
        self._nothing = np.full(self._places["marks before"].stop, np.nan)
        self._nothing[self._places["marks"]] = Marks()
        self._latest = self.DeclareDiscreteState(self._nothing)
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, self._latch)
        self.declare_value_output("record", self._latest_record)
        self.declare_vector_output("marks", len(Marks()), self._marks)

    def _schema(
        self, beside: dict[str, dict[str, int]], pairs: Sequence[str]
    ) -> Schema:
        model = self._model
        names = {
            Names.JOINTS: self._robot.joint_names,
            Names.POSITIONS: tuple(model.GetPositionNames(False)),
            Names.VELOCITIES: tuple(model.GetVelocityNames(False)),
            Names.WORLD_POSITIONS: tuple(beside.get("q", ())),
            Names.WORLD_VELOCITIES: tuple(beside.get("v", ())),
            Names.CONTACT_PAIRS: tuple(
                f"{pair}.{axis}" for pair in pairs for axis in XYZ
            ),
        }
        has = {
            "world": bool(beside),
            "estimator": "estimation_error" in self.sizes,
            "contact_pairs": bool(pairs),
        }
        groups = tuple(name for name in GROUPS if name not in OPTIONAL or has[name])
        return Schema(names, groups)

    def reset(self, context: Context) -> None:
        """Forgets the last tick, which was before the robot was placed."""
        latest, marks = context.get_discrete_state(self._latest), self._places["marks"]
        forgotten = self._nothing.copy()
        forgotten[marks] = latest.value()[marks]  # No event is told again.
        context.SetDiscreteState(self._latest, forgotten)

    def events_since(
        self, context: Context, before: Marks
    ) -> tuple[tuple[Event, ...], Marks]:
        """Returns the events since the marks ``before``, and the present marks."""
        now = self._marks(context)
        return self._events(context, before, now), now

    def events_after_tick(self, context: Context) -> tuple[Event, ...]:
        """Returns the events since the last tick, which are in no record yet."""
        return self.events_since(context, self._latest_marks(context))[0]

    def _latest_marks(self, context: Context) -> Marks:
        latest = context.get_discrete_state(self._latest).value()
        return Marks(*latest[self._places["marks"]].tolist())

    def _latch(self, context: Context, discrete: DiscreteValues) -> None:
        discrete.set_value(self._latest, self._sample(context))

    def _sample(self, context: Context) -> np.ndarray:
        """Reads the numbers of the present instant."""
        commands: ActiveCommand = self._commands.Eval(context)
        joints = commands.joints
        return np.concatenate(
            [
                (context.get_time(),),
                self._numbers.Eval(context),
                joints.numbers,
                (
                    commands.request.number,
                    commands.error_code,
                    commands.received == commands.request.number,
                ),
                self._marks(context),
                context.get_discrete_state(self._latest).value()[self._places["marks"]],
            ]
        )

    def _marks(self, context: Context) -> Marks:
        held = self._gantry.HasValue(context)
        released = self._gantry.Eval(context).released if held else None
        return marks_at(
            context.get_time(),
            float(self._event_count.Eval(context)[0]),
            self._commands.Eval(context),
            self._pushes.Eval(context),
            self._fall.Eval(context),
            released,
        )

    def _latest_record(self, context: Context) -> TickRecord:
        numbers = context.get_discrete_state(self._latest).value().copy()
        if np.isnan(numbers[0]):
            numbers = self._sample(context)
        numbers.setflags(write=False)
        return self._record_at(context, numbers)

    def _record_at(self, context: Context, numbers: np.ndarray) -> TickRecord:
        """Makes the record of the instant of the ``numbers``."""
        latched = {name: numbers[place] for name, place in self._places.items()}
        commands: ActiveCommand = self._commands.Eval(context)
        status: ControllerStatus = self._status.Eval(context)
        request = _request(commands, int(latched["request_number"][0]))
        error = ErrorCode(int(latched["error_code"][0]))
        transition, error = answer(status, error, bool(latched["reached"][0]))
        measured, num_q = latched["behavior_state"], self._num_q
        pelvis = self._indices.pelvis
        scratch = self._scratch.Eval(context)
        feet, hands = self._kinematics.feet_and_hands(
            scratch, latched["state"], measured, latched["contact_wrenches"]
        )
        setpoints = {name: latched[f"joint {name}"] for name in JOINT_FIELDS}
        feedback = status.feedback
        known = FEEDBACK_FIELDS.get(type(feedback))
        own = None if known or isinstance(feedback, Message) else to_plain(feedback)
        return TickRecord(
            time=float(latched["time"][0]),
            behavior=BehaviorNumbers(
                int(status.current_behavior),
                int(status.desired_behavior),
                int(error),
                int(transition.status_flags),
                int(transition.trans_from),
                int(transition.trans_to),
                request.number,
            ),
            request=request.command if request.number else None,
            joints=Joints(
                read_only(measured[self._indices.q]),
                read_only(measured[num_q + self._indices.v]),
                latched["effort"],
                latched["user_effort"],
                latched["behavior_effort"],
                setpoints["position"],
                setpoints["velocity"],
                setpoints["effort"],
                setpoints["k_effort"],
            ),
            gains=Gains(
                **{field.name: setpoints[field.name] for field in fields(Gains)}
            ),
            pelvis=Pelvis(
                measured[pelvis.position],
                measured[pelvis.velocity],
                measured[pelvis.orientation],
            ),
            imu=self._imu(context, latched),
            feet=feet,
            hands=hands,
            balance=self._kinematics.balance(scratch, feet, status.plan),
            controller=ControllerNumbers(
                status.unsolved,
                NO_QP if status.solved is None else int(status.solved),
                self.tick_seconds[-1] if self.tick_seconds else None,
            ),
            state=State(latched["state"][:num_q], latched["state"][num_q:]),
            world=self._world(latched),
            estimator=_estimator(latched),
            contact_pairs=_contact_pairs(latched),
            **({known: feedback} if known else {"feedback": own}),
            plan=_additions(status.plan),
            footsteps=status.plan.footsteps,
            landed=landed_among(status.events),
            pushes=tuple(
                (body, tuple(force_W.tolist()))
                for body, force_W in self._pushes.Eval(context).forces
            ),
            events=self._events(
                context,
                Marks(*latched["marks before"].tolist()),
                Marks(*latched["marks"].tolist()),
            ),
        )

    def _events(
        self, context: Context, before: Marks, after: Marks
    ) -> tuple[Event, ...]:
        if before == after:
            return ()
        return events_between(
            before,
            after,
            self._status.Eval(context),
            self._commands.Eval(context),
            self._pushes.Eval(context),
            self._fall.Eval(context),
        )

    def _imu(self, context: Context, latched: dict[str, np.ndarray]) -> ImuNumbers:
        noise, time = self._noise.Eval(context), float(latched["time"][0])
        state, acceleration = latched["state"], latched["acceleration"]
        measured = self._imu_model.measure(state, acceleration, noise, time)
        return ImuNumbers(*read_only(measured))

    def _world(self, latched: dict[str, np.ndarray]) -> World | None:
        if not self._beside:
            return None
        state = latched["plant_state"]
        return World(*(read_only(state[self._beside[name]]) for name in ("q", "v")))


def _places(sizes: dict[str, int]) -> dict[str, slice]:
    """Returns the places of parts that lie one after the other."""
    ends = np.cumsum([*sizes.values()]).tolist()
    return dict(zip(sizes, map(slice, [0, *ends], ends), strict=False))


def _request(commands: ActiveCommand, number: int) -> BehaviorRequest:
    """Returns the request of a number among the latest ones."""
    known = (one for one in reversed(commands.requests) if one.number <= number)
    return next(known, commands.requests[0])


def _estimator(latched: dict[str, np.ndarray]) -> Estimator | None:
    error = latched.get("estimation_error")
    return None if error is None else Estimator(error[:3], error[3:6], error[6:])


def _contact_pairs(latched: dict[str, np.ndarray]) -> ContactPairs | None:
    if (wrenches := latched.get("contact_pairs")) is None:
        return None
    torque_force = wrenches.reshape(-1, 2, 3)
    return ContactPairs(torque_force[:, 0], torque_force[:, 1])


def _additions(plan: Plan) -> dict[str, Any]:
    """Returns what a subclass of ``Plan`` adds, as plain data."""
    if type(plan) is Plan:
        return {}
    return {
        field.name: to_plain(getattr(plan, field.name))
        for field in fields(plan)
        if field.name not in _PLAN_FIELDS
    }
