"""A harness that carries the pelvis until it is released, as a crane carries a robot.

It pulls as springs and dampers do; nothing is welded and no position is set. Built
into a station only where the scenario asks for it.
"""

from dataclasses import dataclass

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.control.rotations import rotation_error
from atlas_drake.control.whole_body_model import GRAVITY
from atlas_drake.frozen import Frozen, replace
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.systems.scratch import declare_scratch_context


@dataclass(frozen=True)
class HarnessGains:
    """Stiff enough to hold the robot, soft enough for every physics step on offer."""

    natural_frequency: float = 12.0
    """Of the robot's mass on the harness [rad/s]."""
    damping_ratio: float = 1.0
    """[-]"""
    rotational_stiffness: float = 4000.0
    """[N·m/rad]"""
    rotational_damping: float = 300.0
    """[N·m·s/rad]"""
    lowering_speed: float = 0.10
    """At which a released robot is let down [m/s]."""
    fading_time: float = 1.0
    """In which the harness then gives its load to the legs [s]."""


@dataclass(frozen=True)
class HarnessState(Frozen):
    """What the harness does.

    Attributes:
        p_WH: Where the pelvis is held [m]; None for a harness that hangs loose.
        R_WH: In which orientation.
        drop: How far it is to be let down before its feet can stand [m].
        released: When it was released [s]; None while it holds.
    """

    p_WH: np.ndarray | None = None
    R_WH: np.ndarray | None = None
    drop: float = 0.0
    released: float | None = None


class Harness(CollectableSystem):
    """State and the forces of others in, these and the harness' own out.

    Input ports:
        state: Positions and velocities of the plant.
        other_spatial_force: List of ``ExternallyAppliedSpatialForce``; optional.

    Output ports:
        applied_spatial_force: The same and that on the pelvis.
    """

    __slots__ = ()

    def __init__(
        self, robot: Robot, plant: MultibodyPlant, gains: HarnessGains | None = None
    ):
        """Holds ``robot`` in ``plant``."""
        super().__init__()
        self._gains = gains or HarnessGains()
        self._mass = robot.mass
        self._plant = plant
        # A number, as a body keeps its plant where nobody can see it.
        self._pelvis = plant.GetBodyByName(robot.file.pelvis).index()
        self._state_input = self.DeclareVectorInputPort(
            "state", plant.num_multibody_states()
        )
        no_forces = AbstractValue.Make([ExternallyAppliedSpatialForce()])
        self._others = self.DeclareAbstractInputPort("other_spatial_force", no_forces)
        self._scratch = declare_scratch_context(self, plant.CreateDefaultContext)
        self._memory = self.DeclareAbstractState(AbstractValue.Make(HarnessState()))
        self.DeclareAbstractOutputPort(
            "applied_spatial_force", no_forces.Clone, self._calc_forces
        )

    def hold(
        self, context: Context, p_WH: np.ndarray, R_WH: np.ndarray, drop: float
    ) -> None:
        """Holds the pelvis from now on.

        Args:
            context: Of this system.
            p_WH: Where [m].
            R_WH: In which orientation.
            drop: How far above its standing height that is [m].
        """
        self._remember(context, HarnessState(p_WH.copy(), R_WH.copy(), drop))

    def release(self, context: Context) -> None:
        """Lets the robot down and then go; nothing where it holds nothing."""
        state = self.state(context)
        if state.p_WH is not None and state.released is None:
            self._remember(context, replace(state, released=context.get_time()))

    def let_go(self, context: Context) -> None:
        """Hangs loose from now on."""
        self._remember(context, HarnessState())

    def state(self, context: Context) -> HarnessState:
        """What the harness does."""
        return context.get_abstract_state(self._memory).get_value()

    def _remember(self, context: Context, state: HarnessState) -> None:
        context.get_mutable_abstract_state(self._memory).set_value(state)

    def _calc_forces(self, context: Context, output: AbstractValue) -> None:
        forces = self._others.Eval(context) if self._others.HasValue(context) else []
        own = self._pull(context)
        output.set_value([*forces, own] if own is not None else forces)

    def _pull(self, context: Context) -> ExternallyAppliedSpatialForce | None:
        """What the harness does to the pelvis; None once it is off."""
        state, gains = self.state(context), self._gains
        if state.p_WH is None or state.R_WH is None:
            return None
        lowered, strength = 0.0, 1.0
        if state.released is not None:
            since = context.get_time() - state.released
            lowered = min(gains.lowering_speed * since, state.drop)
            fading = since - state.drop / gains.lowering_speed
            strength = 1.0 - max(fading, 0.0) / gains.fading_time
            if strength <= 0.0:
                return None
        scratch = self._scratch.Eval(context)
        self._plant.SetPositionsAndVelocities(scratch, self._state_input.Eval(context))
        pelvis = self._plant.get_body(self._pelvis)
        X_WP = self._plant.EvalBodyPoseInWorld(scratch, pelvis)
        V_WP = self._plant.EvalBodySpatialVelocityInWorld(scratch, pelvis)
        w = gains.natural_frequency
        away = state.p_WH - np.array([0.0, 0.0, lowered]) - X_WP.translation()
        pull = self._mass * (
            w * w * away - 2.0 * gains.damping_ratio * w * V_WP.translational()
        )
        pull[2] += self._mass * GRAVITY
        error = rotation_error(state.R_WH, X_WP.rotation().matrix())
        turn = (
            gains.rotational_stiffness * error
            - gains.rotational_damping * V_WP.rotational()
        )
        force = ExternallyAppliedSpatialForce()
        force.body_index = self._pelvis
        force.F_Bq_W = SpatialForce(strength * turn, strength * pull)
        return force
