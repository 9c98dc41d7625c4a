"""The socket for a controller: its ports, and their connections.

Any Drake System with the output port ``behavior_effort`` fits. The station connects the
other ports that the System has, by name:

===================== ======== ======================================================
port                           value
===================== ======== ======================================================
``behavior_effort``   output   joint efforts [N·m], shape (n,), message order; required
``controller_status`` output   ``ControllerStatus``: behaviors, events, plan
``planned_paths``     output   ``PlannedPaths``, computed when viewers and logs read it
``state``             input    measured (or estimated) q and v, in plant order
``foot_loads``        input    normal forces on left and right foot [N], shape (2,)
``foot_wrenches``     input    contact wrenches on both soles, see ``RobotSensors``
``hand_wrenches``     input    wrenches on both hands, likewise
``user_forecast``     input    ``UserForecast``, the user's law during the next tick
``commands``          input    ``ActiveCommand``, k_effort and requests among them
``imu``               input    ``Imu``
===================== ======== ======================================================

The values of ``imu`` and ``user_forecast`` depend on the efforts of the same instant. A
controller therefore reads them in a periodic update, and declares ``behavior_effort``
with only its state as ``prerequisites_of_calc``, as ``WholeBodyController`` does. The
other inputs may have direct feedthrough to the efforts.

Two optional members are used besides the ports: a method ``reset(context, behavior)``,
called when the robot is put back on its feet (without it the controller gets its
default state again), and an attribute ``tick_seconds``, a list to which the controller
appends the wall time of each tick [s].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from pydrake.systems.framework import (
    Context,
    DiagramBuilder,
    OutputPort,
    PortDataType,
    System,
)

from atlas_drake.errors import AtlasError, did_you_mean, shown
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.controller_status import (
    ControllerStatus,
    PlannedPaths,
    check_paths,
    check_status,
)
from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.whole_body_controller import WholeBodyController

ControllerSource: TypeAlias = System | Callable[..., System]
"""A controller, or a callable (robot, scenario) -> System that makes one."""
EFFORT, STATUS, PATHS = "behavior_effort", "controller_status", "planned_paths"
COUNT = "event_count"
HOLD = "speed_hold"
DELAYED = ("imu", "user_forecast")
"""Inputs that depend on the efforts, and so must not have direct feedthrough."""
CONTROLLER = "controller"
"""Name of the controller in the station."""


class ControllerError(AtlasError):
    """A controller that does not fit the station's socket."""


def add_controller(
    builder: DiagramBuilder,
    source: ControllerSource,
    robot: Robot,
    scenario: Scenario,
    catalog: BehaviorCatalog,
) -> dict[str, OutputPort]:
    """Adds a controller to a station, under the name ``controller``.

    A callable source gets the ``scenario``: resolved, its steps on the common grid.
    Returns efforts, status, planned paths and number of events, by name of the port,
    and the speeds that motors hold if the controller has that port.
    """
    controller: Any = source
    if not isinstance(source, System) and callable(source):
        controller = source(robot, scenario)
    if not isinstance(controller, System):
        raise ControllerError(
            "controller must be a System or a callable (robot, scenario) -> System, "
            f"is {shown(source)}, which gives {shown(controller)}"
        )
    if not controller.HasOutputPort(EFFORT):
        raise ControllerError(
            f"{_named(controller)} has no output port {EFFORT!r}, which gives the "
            f"joint efforts [N·m], shape ({robot.num_joints},)"
        )
    effort = controller.GetOutputPort(EFFORT)
    is_vector = effort.get_data_type() == PortDataType.kVectorValued
    if not is_vector or effort.size() != robot.num_joints:
        size = effort.size() if is_vector else "none"
        raise ControllerError(
            f"the port {EFFORT!r} of {_named(controller)} must be a vector of size "
            f"{robot.num_joints} for {robot.name}, its size is {size}"
        )
    path = controller.GetSystemPathname().removeprefix("::")
    if "::" in path:
        raise ControllerError(
            f"{_named(controller)} is in another diagram already, as {path}; a "
            "callable (robot, scenario) -> System makes one for each"
        )
    builder.AddNamedSystem(CONTROLLER, controller)
    reports = controller
    if not isinstance(controller, WholeBodyController):
        reports = builder.AddNamedSystem("checked_reports", _Reports(catalog))
        for name in (STATUS, PATHS):
            if controller.HasOutputPort(name):
                source_port = controller.GetOutputPort(name)
                _connect(builder, source_port, reports.GetInputPort(name))
    signals = {name: reports.GetOutputPort(name) for name in (STATUS, PATHS, COUNT)}
    if controller.HasOutputPort(HOLD):
        signals[HOLD] = controller.GetOutputPort(HOLD)
    return {EFFORT: effort, **signals}


def connect_controller(
    builder: DiagramBuilder, sources: Mapping[str, OutputPort]
) -> None:
    """Connects every input port of the controller to the source of its name."""
    controller: Any = builder.GetSubsystemByName(CONTROLLER)
    effort = controller.GetOutputPort(EFFORT).get_index()
    for index in range(controller.num_input_ports()):
        port = controller.get_input_port(index)
        name = port.get_name()
        if name not in sources:
            raise ControllerError(
                f"{_named(controller)} has an input port {name!r}, which no port "
                f"of the station feeds.{did_you_mean(name, sources)} Known are "
                + ", ".join(sources)
            )
        _connect(builder, sources[name], port)
        if name in DELAYED and controller.HasDirectFeedthrough(index, effort):
            raise ControllerError(
                f"the port {EFFORT!r} of {_named(controller)} reads {name!r}, "
                "which depends on the efforts of the same instant. Read it in a "
                "periodic update, and give the port prerequisites_of_calc without "
                "it, such as {self.xd_ticket()}"
            )


def _connect(builder: DiagramBuilder, source: OutputPort, port: Any) -> None:
    try:
        builder.Connect(source, port)
    except RuntimeError as error:
        raise ControllerError(f"the controller does not fit: {error}") from error


class _Reports(CollectableSystem):
    """Checks the reports of a user's controller; those that it lacks are blank."""

    __slots__ = ()

    def __init__(self, catalog: BehaviorCatalog) -> None:
        super().__init__()
        self._catalog = catalog
        self._status = self.declare_value_input(STATUS)
        self._paths = self.declare_value_input(PATHS)
        of_status, of_paths = {self._status.ticket()}, {self._paths.ticket()}
        self._checked = self.declare_value_output(STATUS, self._calc_status, of_status)
        self.declare_value_output(PATHS, self._calc_paths, of_paths)
        self.declare_vector_output(COUNT, 1, self._count, of_status)

    def _calc_status(self, context: Context) -> ControllerStatus:
        if not self._status.HasValue(context):
            return ControllerStatus()
        return check_status(self._status.Eval(context), self._catalog)

    def _calc_paths(self, context: Context) -> PlannedPaths:
        if not self._paths.HasValue(context):
            return PlannedPaths()
        return check_paths(self._paths.Eval(context))

    def _count(self, context: Context) -> list[float]:
        return [self._checked.Eval(context).event_count]


def _named(system: System) -> str:
    return f"the controller ({type(system).__name__})"
