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

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    DiagramBuilder,
    InputPort,
    OutputPort,
    PortDataType,
    System,
)
from pydrake.systems.primitives import ConstantValueSource

from atlas_drake.errors import AtlasError, did_you_mean, shown
from atlas_drake.frozen import NOTHING
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
DELAYED = ("imu", "user_forecast")
"""Inputs that depend on the efforts, and so must not have direct feedthrough."""
CONTROLLER = "controller"
"""Name of the controller in the station."""


class ControllerError(AtlasError):
    """A controller that does not fit the station's socket."""


@dataclass(frozen=True)
class ControllerSocket:
    """A controller in a station that is being built.

    Attributes:
        system: The controller.
        effort: Output port of its efforts.
        status: Output port of its status, or of a blank status if it has none.
        paths: Output port of its planned paths, or of blank paths.
        event_count: Output port of the number of its events.
    """

    system: System
    effort: OutputPort
    status: OutputPort
    paths: OutputPort
    event_count: OutputPort

    def connect_inputs(self, builder: DiagramBuilder, **sources: OutputPort) -> None:
        """Connects every input port that the controller has to the source of its name.

        Raises:
            ControllerError: If the controller has an input that nothing can feed, or
                one of another size or type.
        """
        for index in range(self.system.num_input_ports()):
            port = self.system.get_input_port(index)
            name = port.get_name()
            if name not in sources:
                raise ControllerError(
                    f"{_named(self.system)} has an input port {name!r}, which no port "
                    f"of the station feeds.{did_you_mean(name, sources)} Known are "
                    + ", ".join(sources)
                )
            source = sources[name]
            if port.get_data_type() != source.get_data_type() or (
                port.get_data_type() == PortDataType.kVectorValued
                and port.size() != source.size()
            ):
                raise ControllerError(
                    f"{_named(self.system)} has an input port {name!r} that is "
                    f"{_kind(port)}; the station's is {_kind(source)}"
                )
            if name in DELAYED and self.system.HasDirectFeedthrough(
                index, self.effort.get_index()
            ):
                raise ControllerError(
                    f"the port {EFFORT!r} of {_named(self.system)} reads {name!r}, "
                    "which depends on the efforts of the same instant. Read it in a "
                    "periodic update, and give the port prerequisites_of_calc without "
                    "it, such as {self.xd_ticket()}"
                )
            builder.Connect(source, port)


class _Check(CollectableSystem):
    """Passes a value on after checking it; for controllers that are not ours."""

    def __init__(self, check: Callable[[object], Any], blank: object):
        super().__init__()
        port = self.DeclareAbstractInputPort("value", AbstractValue.Make(NOTHING))
        index = port.get_index()
        self.DeclareAbstractOutputPort(
            "checked",
            lambda: AbstractValue.Make(blank),
            lambda context, output: output.set_value(
                check(self.get_input_port(index).Eval(context))
            ),
        )


class _EventCounter(CollectableSystem):
    """Reads the number of events from a status; for controllers that are not ours."""

    def __init__(self) -> None:
        super().__init__()
        port = self.DeclareAbstractInputPort(STATUS, AbstractValue.Make(NOTHING))
        index = port.get_index()
        self.DeclareVectorOutputPort(
            "event_count",
            1,
            lambda context, output: output.SetAtIndex(
                0, self.get_input_port(index).Eval(context).event_count
            ),
        )


def add_controller(
    builder: DiagramBuilder,
    source: ControllerSource,
    robot: Robot,
    scenario: Scenario,
    catalog: BehaviorCatalog,
) -> ControllerSocket:
    """Adds a controller to a station, under the name ``controller``.

    A callable source gets the ``scenario``: resolved, its steps on the common grid.

    Raises:
        ControllerError: If the source is neither, or does not return a System; if the
            controller lacks the port for efforts, or the port has another size.
    """
    controller = source
    if not isinstance(source, System):
        if not callable(source):
            raise ControllerError(
                "controller must be a System or a callable (robot, scenario) -> "
                f"System, is {shown(source)}"
            )
        controller = source(robot, scenario)
    if not isinstance(controller, System):
        raise ControllerError(
            "the callable given as controller must return a System, returned "
            f"{shown(controller)}"
        )
    if not controller.HasOutputPort(EFFORT):
        raise ControllerError(
            f"{_named(controller)} has no output port {EFFORT!r}, which gives the "
            f"joint efforts [N·m], shape ({robot.num_joints},)"
        )
    effort = controller.GetOutputPort(EFFORT)
    if (
        effort.get_data_type() != PortDataType.kVectorValued
        or effort.size() != robot.num_joints
    ):
        raise ControllerError(
            f"{_named(controller)} has an output port {EFFORT!r} that is "
            f"{_kind(effort)}; {robot.name} needs a vector of size {robot.num_joints}"
        )
    path = controller.GetSystemPathname().removeprefix("::")
    if "::" in path:
        raise ControllerError(
            f"{_named(controller)} is in another diagram already, as {path}; a "
            "callable (robot, scenario) -> System makes one for each"
        )
    builder.AddNamedSystem(CONTROLLER, controller)
    status = _report_port(
        builder,
        controller,
        STATUS,
        ControllerStatus(),
        partial(check_status, catalog=catalog),
    )
    paths = _report_port(builder, controller, PATHS, PlannedPaths(), check_paths)
    if isinstance(controller, WholeBodyController):
        count = controller.GetOutputPort("event_count")
    else:
        counter = builder.AddNamedSystem("event_counter", _EventCounter())
        builder.Connect(status, counter.get_input_port())
        count = counter.get_output_port()
    return ControllerSocket(controller, effort, status, paths, count)


def _report_port(
    builder: DiagramBuilder,
    controller: System,
    name: str,
    blank: object,
    check: Callable[[object], Any],
) -> OutputPort:
    """Returns an optional port of the controller, checked unless it is ours."""
    if not controller.HasOutputPort(name):
        source = ConstantValueSource(AbstractValue.Make(blank))
        return builder.AddNamedSystem(f"no_{name}", source).get_output_port()
    port = controller.GetOutputPort(name)
    if port.get_data_type() != PortDataType.kAbstractValued:
        raise ControllerError(
            f"{_named(controller)} has an output port {name!r} that is "
            f"{_kind(port)}; it must hold a {type(blank).__name__}"
        )
    if isinstance(controller, WholeBodyController):
        return port
    checked = builder.AddNamedSystem(f"{name}_check", _Check(check, blank))
    builder.Connect(port, checked.get_input_port())
    return checked.get_output_port()


def _named(system: System) -> str:
    return f"the controller ({type(system).__name__})"


def _kind(port: InputPort | OutputPort) -> str:
    if port.get_data_type() == PortDataType.kVectorValued:
        return f"a vector of size {port.size()}"
    return "abstract-valued"
