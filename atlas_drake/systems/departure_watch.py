"""Watches a run for what happened first when it went wrong.

The thin system around ``departures``; a campaign adds it if its metrics ask for it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, State

from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.frozen import NOTHING
from atlas_drake.messages.controller_status import ControllerStatus, Plan
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.departures import Landing, Signals, initial, watch
from atlas_drake.systems.push_source import VERTICAL, time_to_touchdown

WATCHED_LIMBS = ("l_leg", "r_leg", "back")
"""Limbs whose joints are watched."""


class DepartureWatch(CollectableSystem):
    """Signals of the robot in, the first departure of the latest chain out.

    Of the joints, legs and back are watched as far as the behavior alone moves them:
    an arm that is flung against a stop does not fell a robot. Nothing is watched after
    the robot fell.

    Input ports:
        state: Positions and velocities of the robot.
        effort: Efforts of the motors [N·m], shape (n,).
        foot_wrenches: Wrenches of the ground on the soles [N·m; N], shape (12,).
        commands: ``ActiveCommand``.
        controller_status: ``ControllerStatus``.
        fall: ``Fall``; NOTHING until the robot falls.

    Output ports:
        departures: ``WatchState``.
    """

    __slots__ = ()

    def __init__(
        self, robot: Robot, plant: MultibodyPlant, period: float, offset: float
    ) -> None:
        """Watches ``robot`` in ``plant`` every ``period`` from ``offset`` on [s].

        Between two control ticks the signals cost nothing: the plant's step needs the
        same efforts.
        """
        super().__init__()
        self._robot, self._plant = robot, plant
        self._instance = own = robot.instance(plant)
        self._joints = robot.indices(plant).q
        self._watched_joints = robot.limb(*WATCHED_LIMBS)
        self._soles = robot.soles(plant)
        self._state_input = self.DeclareVectorInputPort(
            "state", plant.num_multibody_states(own)
        )
        self._effort = self.DeclareVectorInputPort("effort", robot.num_joints)
        self._wrenches = self.DeclareVectorInputPort("foot_wrenches", 12)
        self._commands, self._status, self._fall = (
            self.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
            for name in ("commands", "controller_status", "fall")
        )
        self._scratch = self.declare_scratch_context(plant.CreateDefaultContext)
        self._watched = self.DeclareAbstractState(
            AbstractValue.Make(initial(robot.num_joints))
        )
        self.DeclareStateOutputPort("departures", self._watched)
        self.DeclarePeriodicUnrestrictedUpdateEvent(period, offset, self._update)

    def _update(self, context: Context, state: State) -> None:
        if self._fall.Eval(context) is not NOTHING:
            return
        before = context.get_abstract_state(self._watched).get_value()
        after = watch(before, self._signals(context), self._robot.joint_names)
        state.get_mutable_abstract_state(self._watched).set_value(after)

    def _signals(self, context: Context) -> Signals:
        robot, plant = self._robot, self._plant
        values = self._state_input.Eval(context)
        scratch = self._scratch.Eval(context)
        plant.SetPositionsAndVelocities(scratch, self._instance, values)
        q = values[self._joints]
        ours = self._watched_joints & (self._commands.Eval(context).k_effort == 0)
        margin = np.minimum(q - robot.position_lower, robot.position_upper - q)
        effort = np.abs(self._effort.Eval(context)) / robot.effort_limit
        wrenches = self._wrenches.Eval(context)
        weight = robot.mass * GRAVITY
        poses = [plant.get_frame(sole).CalcPoseInWorld(scratch) for sole in self._soles]
        status: ControllerStatus = self._status.Eval(context)
        return Signals(
            time=round(context.get_time(), 6),
            margin=np.where(ours, margin, np.inf),
            effort=np.where(ours, effort, 0.0),
            loads=[float(wrenches[index]) / weight for index in VERTICAL],
            soles=np.array([pose.translation() for pose in poses]),
            normals=np.array([pose.rotation().col(2) for pose in poses]),
            landing=_landing(status),
            outside=self._outside(scratch, status.plan),
            unsolved=status.unsolved,
        )

    def _outside(self, scratch: Any, plan: Plan) -> float | None:
        """Computes how far the DCM is outside the support, beyond the plan's [m]."""
        if plan.support is None or plan.omega is None or len(plan.support) < 3:
            return None
        own = [self._instance]
        com = self._plant.CalcCenterOfMassPositionInWorld(scratch, own)
        velocity = self._plant.CalcCenterOfMassTranslationalVelocityInWorld(
            scratch, own
        )
        support = SupportPolygon(plan.support)
        outside = max(support.distance_outside((com + velocity / plan.omega)[:2]), 0.0)
        if plan.dcm_reference is None:
            return outside
        return outside - max(support.distance_outside(plan.dcm_reference), 0.0)


def _landing(status: ControllerStatus) -> Landing | None:
    """Returns the next landing that the behavior plans."""
    steps = status.plan.footsteps
    if not steps:
        return None
    return Landing(steps[0].foot, steps[0].p_WF[:2], time_to_touchdown(status))
