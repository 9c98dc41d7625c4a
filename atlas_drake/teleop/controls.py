"""The elements of the control panel: buttons with their keys, sliders, a legend.

Data only. ``pages`` arranges the elements, ``panel`` puts them into the browser,
``commander`` defines their effects.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.control.feet.footstep import clip
from atlas_drake.control.pelvis.pelvis_pose import PelvisRange
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasBehaviorPelvisServoParams,
    Behavior,
)
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.planning.footholds import Gait
from atlas_drake.robot import Robot
from atlas_drake.teleop.limbs import GROUPS
from atlas_drake.teleop.walking import Direction


class Key(NamedTuple):
    """A key of the keyboard: its name in the browser, and its label."""

    code: str
    cap: str


def _letter(cap: str) -> Key:
    return Key(f"Key{cap.upper()}", cap)


def _digit(cap: str) -> Key:
    return Key(f"Digit{cap}", cap)


class Action(Enum):
    """A button: its label and its key."""

    PREVIOUS_PAGE = ("previous page", Key("PageUp", "PgUp"))
    NEXT_PAGE = ("next page", Key("PageDown", "PgDn"))
    STAND = ("STAND", _digit("1"))
    WALK = ("WALK on the spot", _digit("2"))
    STEP = ("STEP", _digit("3"))
    MANIPULATE = ("MANIPULATE", _digit("4"))
    FREEZE = ("FREEZE", _digit("5"))
    USER = ("USER", _digit("6"))
    STAND_PREP = ("STAND_PREP", _digit("7"))
    ARC_LEFT = ("arc left", _letter("u"))
    FORWARD = ("forward", _letter("i"))
    ARC_RIGHT = ("arc right", _letter("o"))
    LEFT = ("to the left", _letter("j"))
    STOP = ("stop", _letter("k"))
    RIGHT = ("to the right", _letter("l"))
    TURN_LEFT = ("turn left", _letter("m"))
    BACKWARD = ("backward", Key("Comma", ","))
    TURN_RIGHT = ("turn right", Key("Period", "."))
    PUSH = ("push", _letter("p"))
    PAUSE = ("pause or go on", Key("Space", "space"))
    SINGLE_STEP = ("single time step", _letter("n"))
    RESET = ("reset", _letter("r"))

    @property
    def label(self) -> str:
        """Label of the button, with its key."""
        return f"{self.value[0]} ({self.key.cap})"

    @property
    def key(self) -> Key:
        """Key of the button."""
        return self.value[1]


@dataclass(frozen=True)
class BehaviorButton:
    """The button of a user's own behavior.

    Attributes:
        behavior: Behavior that is requested, with default parameters.
        key: Key of the button; None if no digit is left.
    """

    behavior: Behavior
    key: Key | None

    @property
    def label(self) -> str:
        """Label of the button, with its key."""
        return self.behavior.name + (f" ({self.key.cap})" if self.key else "")


Button = Action | BehaviorButton
FREE_DIGITS = "890"
"""Digits that no shipped button uses."""


def behavior_buttons(catalog: BehaviorCatalog) -> tuple[BehaviorButton, ...]:
    """Makes a button for each of the user's own behaviors.

    Args:
        catalog: The robot's behaviors.
    """
    own = [
        entry.behavior for entry in catalog if entry.name not in Behavior.__members__
    ]
    keys = [*map(_digit, FREE_DIGITS)]
    return tuple(
        BehaviorButton(behavior, keys[number] if number < len(keys) else None)
        for number, behavior in enumerate(own)
    )


DIRECTIONS = {
    Action.WALK: Direction(),
    Action.FORWARD: Direction(forward=1.0),
    Action.BACKWARD: Direction(forward=-1.0),
    Action.ARC_LEFT: Direction(forward=1.0, turn=1.0),
    Action.ARC_RIGHT: Direction(forward=1.0, turn=-1.0),
    Action.LEFT: Direction(left=1.0),
    Action.RIGHT: Direction(left=-1.0),
    Action.TURN_LEFT: Direction(turn=1.0),
    Action.TURN_RIGHT: Direction(turn=-1.0),
}
"""Direction of each walking key."""


PAGE_TURNS = {Action.PREVIOUS_PAGE: -1, Action.NEXT_PAGE: 1}
"""Number of pages by which these buttons turn the panel; they send no command."""


class Slider(NamedTuple):
    """A slider: its label, range, smallest change and initial value.

    The constants below have Atlas' ranges; ``fitted`` computes the ranges of another
    robot.
    """

    label: str
    low: float
    high: float
    step: float
    value: float


def _walking_sliders(walk: WalkConfig) -> tuple[Slider, ...]:
    """Makes the sliders for stride, turn, duration and swing height."""
    usual, limits = walk.steps, walk.limits
    stride, height = usual.stride, walk.swing.height
    quickest = limits.duration.least
    return (
        Slider("stride [m]", 0.25 * stride, 1.5 * stride, 0.01, stride),
        Slider("turn per step [rad]", 0.05, limits.toe_in, 0.01, usual.turn),
        Slider("step duration [s]", quickest, 2.0 * quickest, 0.01, usual.duration),
        Slider("swing height [m]", 0.5 * height, 2.5 * height, 0.01, height),
    )


def _pelvis_sliders(allowed: PelvisRange) -> tuple[Slider, ...]:
    """Makes the sliders for height and yaw."""
    pose = AtlasBehaviorPelvisServoParams()
    height, yaw = allowed.height, allowed.yaw
    return (
        Slider(
            "pelvis height [m]",
            height.least,
            height.greatest,
            0.005,
            clip(pose.pelvis_height, *height),
        ),
        Slider("pelvis yaw [rad]", yaw.least, yaw.greatest, 0.01, clip(0.0, *yaw)),
    )


def _push_body(bodies: int) -> Slider:
    """Makes the slider that selects the pushed body by number."""
    return Slider("body", 1, bodies, 1, min(2, bodies))


STRIDE, TURN, DURATION, SWING_HEIGHT = _walking_sliders(WalkConfig())
PELVIS_HEIGHT, PELVIS_YAW = _pelvis_sliders(PelvisRange())
PUSH_BODY = _push_body(5)
PUSH_DIRECTION = Slider("direction [deg]", -180, 180, 5, 0)
PUSH_IMPULSE = Slider("impulse [N.s]", 1, 60, 1, 15)
SHARES = {group: Slider(f"k_effort {group}", 0, K_EFFORT_MAX, 1, 0) for group in GROUPS}
"""Slider of each group of limbs."""

SLIDERS = (
    STRIDE,
    TURN,
    DURATION,
    SWING_HEIGHT,
    PELVIS_HEIGHT,
    PELVIS_YAW,
    *SHARES.values(),
    PUSH_BODY,
    PUSH_DIRECTION,
    PUSH_IMPULSE,
)


def fitted(robot: Robot, config: ControllerConfig) -> dict[str, Slider]:
    """Returns the sliders of the panel with the ranges of a robot, by label."""
    own = (
        *_walking_sliders(config.walk),
        *_pelvis_sliders(config.manipulate.range),
        _push_body(len(robot.file.pushed)),
    )
    return {slider.label: slider for slider in (*SLIDERS, *own)}


@dataclass(frozen=True)
class Controls:
    """One reading of the panel.

    Attributes:
        clicks: Buttons pressed since the last reading.
        sliders: Positions of the sliders, by label.
        joints: Positions of the joint sliders [rad], by index of the joint.
        stick: Direction of a gamepad's sticks; None without a gamepad.
    """

    clicks: tuple[Button, ...] = ()
    sliders: Mapping[str, float] = field(
        default_factory=lambda: {s.label: s.value for s in SLIDERS}
    )
    joints: Mapping[int, float] = field(default_factory=dict)
    stick: Direction | None = None

    def value(self, slider: Slider) -> float:
        """Returns the position of a slider."""
        return self.sliders[slider.label]

    def gait(self, usual: Gait) -> Gait:
        """Returns the gait that the sliders set, within the limits of ``usual``."""
        return usual.nearest(
            stride=self.value(STRIDE),
            turn=self.value(TURN),
            duration=self.value(DURATION),
            swing_height=self.value(SWING_HEIGHT),
        )

    @property
    def shares(self) -> dict[str, int]:
        """Shares of user control by group, 0 to 255."""
        return {group: int(self.value(slider)) for group, slider in SHARES.items()}


LEGEND = """\
Keys work where the 3D view has the focus; every key is a button there too.

   u  i  o     arc left, forward, arc right        1  STAND
   j  k  l     to the left, stop, to the right     2  WALK on the spot
   m  ,  .     turn left, backward, turn right     3  STEP, one per press
                                                   4  MANIPULATE: pelvis sliders
   space  pause or go on    p  push                5  FREEZE
   n      single time step  r  reset               6  USER
   PgUp  PgDn  turn the panel's pages              7  STAND_PREP
{own}
"Open Controls" unfolds the panel, page by page: modes, {page}walking, pelvis, push,
limbs, overlays, scene. Every key works on every page, and while the panel is folded.

The robot keeps its direction until another key; a gamepad's sticks steer it while they
are held. Sliders set the stride and, per limb, k_effort: 0 is the behavior, 255 you.
A limb that is yours gets a page with a slider for each joint. A push goes ahead at
0 deg and to the robot's left at 90 deg; bodies are
{bodies}."""


def legend(robot: Robot, catalog: BehaviorCatalog = SHIPPED) -> str:
    """Makes the terminal's explanation of the keys.

    Args:
        robot: Robot whose bodies can be pushed.
        catalog: The robot's behaviors; the user's own are listed with their keys.
    """
    buttons = behavior_buttons(catalog)
    own = [
        f"   {button.key.cap if button.key else '-'}  {button.behavior.name}\n"
        for button in buttons
    ]
    return LEGEND.format(
        own="".join(["\nBehaviors of your own:\n\n", *own]) if own else "",
        page="behaviors, " if own else "",
        bodies=pushed_bodies(robot),
    )


def pushed_bodies(robot: Robot) -> str:
    """Lists the bodies that can be pushed, by their number on the slider."""
    return ", ".join(f"{i} {name}" for i, name in enumerate(robot.file.pushed, 1))
