"""An open humanoid control sandbox: Atlas under user and behavior control, on Drake.

Messages are imported at once; names that need Drake, when they are first used.
"""

from typing import TYPE_CHECKING, Any

from atlas_drake.errors import (
    AtlasError,
    ErrorCode,
    InvalidMessageError,
    ScenarioError,
    WaitTimeoutError,
)
from atlas_drake.messages import *  # noqa: F403
from atlas_drake.messages import __all__ as _messages

if TYPE_CHECKING:
    from atlas_drake.clients.film.film import film
    from atlas_drake.clients.logs import Log, LogError, read_log
    from atlas_drake.clients.session import AtlasSimulation
    from atlas_drake.clients.steering.hand_motion import HandMotion
    from atlas_drake.clients.steering.hand_work import HandWork
    from atlas_drake.clients.steering.step_stream import StepStream
    from atlas_drake.diagrams.standing import place_robot
    from atlas_drake.messages.controller_status import (
        ControllerStatus,
        Plan,
        PlannedPaths,
    )
    from atlas_drake.messages.event import Event
    from atlas_drake.messages.footstep import Footstep
    from atlas_drake.planning.footholds import Gait
    from atlas_drake.planning.footstep_planner import (
        steps_ahead,
        steps_along_arc,
        steps_to,
        steps_turning,
    )
    from atlas_drake.planning.hand_goal import HandGoal
    from atlas_drake.planning.reach import reach
    from atlas_drake.planning.walk_at import (
        nearest_velocity,
        stop_walking,
        walk_at,
    )
    from atlas_drake.planning.waypoints import walk_to
    from atlas_drake.planning.whole_body_reach import whole_body_reach
    from atlas_drake.records import TickRecord
    from atlas_drake.scenario import (
        Jitter,
        Model,
        PlannedPush,
        PolicyUse,
        Scenario,
        Start,
        load_scenario,
    )
    from atlas_drake.simulation import SimulationError
    from atlas_drake.worlds.terrain import Block

_LAZY = {
    "AtlasSimulation": "atlas_drake.clients.session",
    "ControllerStatus": "atlas_drake.messages.controller_status",
    "Event": "atlas_drake.messages.event",
    "Plan": "atlas_drake.messages.controller_status",
    "PlannedPaths": "atlas_drake.messages.controller_status",
    "PlannedPush": "atlas_drake.scenario",
    "Footstep": "atlas_drake.messages.footstep",
    "Block": "atlas_drake.worlds.terrain",
    "Gait": "atlas_drake.planning.footholds",
    "Jitter": "atlas_drake.scenario",
    "Model": "atlas_drake.scenario",
    "Log": "atlas_drake.clients.logs",
    "LogError": "atlas_drake.clients.logs",
    "TickRecord": "atlas_drake.records",
    "PolicyUse": "atlas_drake.scenario",
    "Scenario": "atlas_drake.scenario",
    "SimulationError": "atlas_drake.simulation",
    "Start": "atlas_drake.scenario",
    "StepStream": "atlas_drake.clients.steering.step_stream",
    "film": "atlas_drake.clients.film.film",
    "load_scenario": "atlas_drake.scenario",
    "place_robot": "atlas_drake.diagrams.standing",
    "read_log": "atlas_drake.clients.logs",
    "steps_ahead": "atlas_drake.planning.footstep_planner",
    "steps_along_arc": "atlas_drake.planning.footstep_planner",
    "steps_to": "atlas_drake.planning.footstep_planner",
    "steps_turning": "atlas_drake.planning.footstep_planner",
    "nearest_velocity": "atlas_drake.planning.walk_at",
    "stop_walking": "atlas_drake.planning.walk_at",
    "HandGoal": "atlas_drake.planning.hand_goal",
    "HandMotion": "atlas_drake.clients.steering.hand_motion",
    "HandWork": "atlas_drake.clients.steering.hand_work",
    "reach": "atlas_drake.planning.reach",
    "whole_body_reach": "atlas_drake.planning.whole_body_reach",
    "walk_at": "atlas_drake.planning.walk_at",
    "walk_to": "atlas_drake.planning.waypoints",
}

__all__ = [  # noqa: PLE0604
    "AtlasError",
    "AtlasSimulation",
    "Block",
    "ControllerStatus",
    "Event",
    "Plan",
    "PlannedPaths",
    "PlannedPush",
    "PolicyUse",
    "Footstep",
    "ErrorCode",
    "Gait",
    "HandGoal",
    "HandMotion",
    "HandWork",
    "InvalidMessageError",
    "Jitter",
    "Model",
    "Log",
    "LogError",
    "Scenario",
    "ScenarioError",
    "SimulationError",
    "Start",
    "StepStream",
    "TickRecord",
    "WaitTimeoutError",
    "film",
    "load_scenario",
    "nearest_velocity",
    "place_robot",
    "reach",
    "read_log",
    "steps_ahead",
    "steps_along_arc",
    "steps_to",
    "steps_turning",
    "stop_walking",
    "walk_at",
    "walk_to",
    "whole_body_reach",
    *_messages,
]


def __getattr__(name: str) -> Any:
    """Imports a name that needs Drake when it is first used."""
    if name in _LAZY:
        from importlib import import_module

        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
