"""Scenarios: what is simulated, read from typed YAML.

One dataclass, one comment per field, all defaults here. What is done with it is in
``simulation``.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from pydrake.common.yaml import yaml_load, yaml_load_typed

from atlas_drake.errors import (
    InvalidMessageError,
    RobotDescriptionError,
    ScenarioError,
    shown,
)
from atlas_drake.kinds import check_kinds, make_plain
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import SHIPPED
from atlas_drake.robot import DEFAULT_ROBOT, find_robot, model_beside
from atlas_drake.scenario.noise import NOISE_MODELS
from atlas_drake.scenario.terrain import Block

PHYSICS_STEPS = (0.0005, 0.001, 0.002)
"""Physics steps on offer [s]."""
LARGEST_SEED = 2**64 - 1
"""What the generator of the sensors' noise takes."""
LONGEST_PERIOD = 0.02
"""Longest control period on offer [s]."""
CONTACT_APPROXIMATIONS = ("lagged", "similar", "sap", "tamsi")
PROGRAMMES = ("none", "tutorial", "tutorial_literal")
STATES = ("true", "estimated")
IN_THE_AIR = (Behavior.USER, Behavior.FREEZE)
"""Behaviours that a robot without ground under its feet can begin with."""


@dataclass
class Jitter:
    """Random changes of the start and of the physics, drawn from the scenario's seed.

    Every value is the half width of a uniform distribution; 0 changes nothing.
    """

    position: float = 0.0
    """Of the pelvis along x and y [m]."""
    orientation: float = 0.0
    """Of the pelvis' roll, pitch and yaw [rad]."""
    joints: float = 0.0
    """Of each joint [rad]."""
    mass: float = 0.0
    """Of each link's mass and inertia, as a share of what the controller believes;
    below 1."""


@dataclass
class Start:
    """Where the robot begins, on its feet on whatever terrain is there."""

    position: list[float] = field(default_factory=lambda: [0.0, 0.0])
    """Of the pelvis along x and y in W [m]."""
    yaw: float = 0.0
    """Heading [rad]."""
    harnessed: bool = False
    """Hangs with its feet in the air, in a harness that holds the pelvis."""
    release_time: float | None = None
    """Time after the start, or the reset, at which the harness lets the robot down by
    itself [s]; null for not by itself."""

    def validate(self, behavior: Behavior) -> None:
        """Checks every field against each other and the behaviour to begin with.

        Args:
            behavior: The one to begin with.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        position = self.position
        if len(position) != 2 or not np.isfinite(position).all():
            raise ScenarioError(
                "start.position", position, f"is {shown(position)}; must be two numbers"
            )
        if not np.isfinite(self.yaw):
            raise ScenarioError(
                "start.yaw", self.yaw, f"is {shown(self.yaw)}; must be a number"
            )
        release = self.release_time
        if release is not None:
            if not (np.isfinite(release) and release >= 0.0):
                raise ScenarioError(
                    "start.release_time",
                    release,
                    f"is {shown(release)}; must be a number not below 0",
                )
            if not self.harnessed:
                raise ScenarioError(
                    "start.release_time", release, "needs start.harnessed: true"
                )
        if self.harnessed and behavior not in IN_THE_AIR:
            raise ScenarioError(
                "initial_behavior",
                behavior.name,
                "must be USER or FREEZE in a harness: nothing else knows how to hang",
            )


@dataclass
class Scenario:
    """Everything that can be chosen about a run."""

    name: str = "sandbox"
    """Shown to the user."""
    model: str = DEFAULT_ROBOT
    """Robot: a name from ``models/``, or the path of a robot's YAML file, relative to
    the scenario's file, and in Python and on the command line to the working folder."""
    programme: str = "none"
    """Commands that are sent by themselves: one of PROGRAMMES."""
    duration: float = 10.0
    """Length of the run on the command line [s]."""
    initial_behavior: str = "STAND"
    """Behaviour active at the start; USER gives all joints to the user."""
    physics_step: float = 0.001
    """Step of plant and joint controllers [s], one of PHYSICS_STEPS."""
    control_period: float = 0.002
    """Step of the behaviours [s], a multiple of physics_step."""
    contact_approximation: str = "similar"
    """How Drake solves contact, one of CONTACT_APPROXIMATIONS."""
    ground_friction: float = 0.9
    """Coefficient of the ground."""
    friction_jitter: float = 0.0
    """Half width of a uniform change of it."""
    terrain: list[Block] = field(default_factory=list)
    """Boxes on the level ground at z = 0."""
    start: Start = field(default_factory=Start)
    """Where the robot begins."""
    noise: str = "none"
    """Sensor noise, a name from NOISE_MODELS."""
    state: str | bool = "true"
    """What the behaviours see, one of STATES: the true state with the noise of the
    sensors, or what an estimator makes of IMU, joints and loads on the feet. A bare
    ``true``, which YAML takes for a truth value, means the word."""
    seed: int = 0
    """Of noise and jitter."""
    jitter: Jitter = field(default_factory=Jitter)
    """Random changes at the start."""

    def validate(self) -> "Scenario":
        """Checks every field.

        A truth value for ``state`` becomes the word, and numbers become Python's own.

        Returns:
            The scenario itself.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        check_kinds(self, Scenario)
        make_plain(self)
        try:
            find_robot(self.model)
        except RobotDescriptionError as error:
            raise ScenarioError("model", self.model, error.problem) from None
        _one_of("programme", self.programme, PROGRAMMES)
        _one_of("noise", self.noise, tuple(NOISE_MODELS))
        if self.state is True:
            self.state = "true"
        _one_of("state", self.state, STATES)
        _one_of("physics_step", self.physics_step, PHYSICS_STEPS)
        _one_of(
            "contact_approximation",
            self.contact_approximation,
            CONTACT_APPROXIMATIONS,
        )
        self.behavior()
        _positive("duration", self.duration)
        _positive("ground_friction", self.ground_friction)
        _positive("control_period", self.control_period)
        steps = self.control_period / self.physics_step
        if abs(steps - round(steps)) > 1e-6 or round(steps) < 1:
            raise ScenarioError(
                "control_period",
                self.control_period,
                f"is {shown(self.control_period)}; must be a whole multiple of "
                f"physics_step ({self.physics_step} s)",
            )
        if self.control_period > LONGEST_PERIOD:
            raise ScenarioError(
                "control_period",
                self.control_period,
                f"is {shown(self.control_period)}; must be at most {LONGEST_PERIOD}: "
                "the robot cannot balance with longer ones",
            )
        if not 0 <= self.seed <= LARGEST_SEED:
            raise ScenarioError(
                "seed",
                self.seed,
                f"is {shown(self.seed)}; must be from 0 to {LARGEST_SEED}",
            )
        for name, value in vars(self.jitter).items():
            most = 1.0 if name == "mass" else np.inf
            if not 0.0 <= value < most:
                wanted = "0 or more, and below 1" if name == "mass" else "0 or more"
                raise ScenarioError(
                    f"jitter.{name}", value, f"is {shown(value)}; must be {wanted}"
                )
        if not 0.0 <= self.friction_jitter < self.ground_friction:
            raise ScenarioError(
                "friction_jitter",
                self.friction_jitter,
                f"is {shown(self.friction_jitter)}; must be 0 or more, and below the "
                f"ground's friction ({self.ground_friction})",
            )
        for index, block in enumerate(self.terrain):
            block.validate(f"terrain[{index}]")
        self.start.validate(self.behavior())
        return self

    def behavior(self) -> Behavior:
        """The initial behaviour.

        Raises:
            ScenarioError: If it cannot be started in.
        """
        try:
            return starting_behavior(self.initial_behavior, "initial_behavior")
        except InvalidMessageError as error:
            raise ScenarioError(
                "initial_behavior", self.initial_behavior, error.problem
            ) from error


def starting_behavior(value: object, name: str) -> Behavior:
    """A behaviour that the robot can begin with.

    Args:
        value: Its name in any case, its number, or the behaviour itself.
        name: Of the field it comes from, for the error.

    Raises:
        InvalidMessageError: If there is no such behaviour, or none can begin with it.
    """
    behavior = SHIPPED.find(value, name)
    allowed = (Behavior.STAND, Behavior.STAND_PREP, Behavior.USER, Behavior.FREEZE)
    if behavior not in allowed:
        names = ", ".join(b.name for b in allowed)
        raise InvalidMessageError(
            name, value, f"is {shown(value)}; must be one of {names}"
        )
    return behavior


def load_scenario(path: str | Path) -> Scenario:
    """Reads and validates one YAML file; fields left out have their defaults.

    Args:
        path: Of the file.

    Raises:
        ScenarioError: If the file cannot be read, has unknown keys or bad values.
    """
    try:
        text = Path(path).read_text()
        raw = yaml_load(data=text) if text.strip() else None
    except Exception as error:
        # The parser raises many kinds of exception for what is always a faulty file.
        problem = f"{path} cannot be read: {error}"
        raise ScenarioError("file", str(path), problem) from error
    try:
        if not isinstance(raw, Mapping):
            raise ScenarioError(
                "file", raw, "must have fields of a scenario, such as duration: 10"
            )
        check_kinds(raw, Scenario, from_text=True)
        scenario: Scenario = yaml_load_typed(
            schema=Scenario, data=text, defaults=Scenario()
        )
        scenario.model = model_beside(scenario.model, Path(path).parent)
        return scenario.validate()
    except ScenarioError as error:
        raise ScenarioError(
            error.field, error.value, f"{error.problem} (in {path})"
        ) from None


def _one_of(name: str, value: object, allowed: Collection[object]) -> None:
    if value not in allowed:
        raise ScenarioError(
            name,
            value,
            f"is {shown(value)}; must be one of {', '.join(map(str, allowed))}",
        )


def _positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise ScenarioError(
            name, value, f"is {shown(value)}; must be a positive number"
        )
