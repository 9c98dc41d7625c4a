"""The pages of the control panel.

Data only; ``paged_controls`` turns the pages.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from atlas_drake.robot import Robot
from atlas_drake.teleop.controls import (
    DIRECTIONS,
    DURATION,
    PELVIS_HEIGHT,
    PELVIS_YAW,
    PUSH_BODY,
    PUSH_DIRECTION,
    PUSH_IMPULSE,
    SHARES,
    STRIDE,
    SWING_HEIGHT,
    TURN,
    Action,
    BehaviorButton,
    Button,
    Slider,
    pushed_bodies,
)
from atlas_drake.teleop.limbs import SLIDER_STEP, group_of
from atlas_drake.visualization.overlays import OVERLAYS

MAX_ROWS = 16
"""Greatest number of rows of a page, with its title and the two buttons that turn it:
16 rows of 28 pixels fit a small window (657 pixels of height)."""


@dataclass(frozen=True)
class Page:
    """One page of the panel.

    Attributes:
        title: Title at the top.
        actions: Buttons beside those that turn the page.
        sliders: Sliders below the buttons.
        note: A line of explanation below the sliders.
        scene: True to show Meshcat's own folders (Scene, Save, Animations) as well.
    """

    title: str
    actions: tuple[Button, ...] = ()
    sliders: tuple[Slider, ...] = ()
    note: str = ""
    scene: bool = False


MODES = Page(
    "modes",
    (
        Action.STAND,
        Action.WALK,
        Action.STEP,
        Action.MANIPULATE,
        Action.FREEZE,
        Action.USER,
        Action.STAND_PREP,
        Action.PAUSE,
        Action.SINGLE_STEP,
        Action.RESET,
    ),
)
WALKING = Page(
    "walking",
    (*(action for action in DIRECTIONS if action is not Action.WALK), Action.STOP),
    (STRIDE, TURN, DURATION, SWING_HEIGHT),
)
PELVIS = Page("pelvis", (Action.STAND, Action.MANIPULATE), (PELVIS_HEIGHT, PELVIS_YAW))
PUSH = Page("push", (Action.PUSH,), (PUSH_BODY, PUSH_DIRECTION, PUSH_IMPULSE))
LIMBS = Page(
    "limbs",
    (),
    tuple(SHARES.values()),
    "0 is the behavior, 255 you; your limbs get pages with their joints",
)
SWITCHES = {name: Slider(f"show {name}", 0, 1, 1, 0) for name in OVERLAYS}
"""Button of each overlay, which switches it on and off."""
VIEW = Page("overlays", (), tuple(SWITCHES.values()))
SCENE = Page("scene", scene=True)


def joint_slider(robot: Robot, index: int) -> Slider:
    """Makes the slider of a joint's set-point [rad]."""
    low, high = robot.position_lower[index], robot.position_upper[index]
    label = f"{robot.joint_names[index]} [rad]"
    return Slider(label, float(low), float(high), SLIDER_STEP, 0.0)


def pages_with(
    robot: Robot,
    own: Mapping[str, Slider],
    joints: Collection[int],
    behaviors: Sequence[BehaviorButton] = (),
) -> tuple[Page, ...]:
    """Makes all pages, with one more for each limb under user control.

    Args:
        robot: Robot whose joints get sliders.
        own: Sliders with the ranges of the robot, by label, see ``fitted``.
        joints: Joints under user control.
        behaviors: Buttons of the user's own behaviors, which get a page if there are
            any.
    """
    groups = group_of(robot)

    def fit(page: Page, note: str = "") -> Page:
        sliders = tuple(own[slider.label] for slider in page.sliders)
        return replace(page, sliders=sliders, note=note or page.note)

    push = fit(PUSH, f"0 deg is ahead, 90 to the left; bodies: {pushed_bodies(robot)}")
    shares = tuple(SHARES[group] for group in SHARES if group in groups)
    by_group = {
        group: [joint_slider(robot, i) for i in sorted(joints) if groups[i] == group]
        for group in SHARES
    }
    limbs = [
        Page(group, sliders=(SHARES[group], *sliders))
        for group, sliders in by_group.items()
        if sliders
    ]
    own_behaviors = [Page("behaviors", tuple(behaviors))] if behaviors else []
    return (
        MODES,
        *own_behaviors,
        fit(WALKING),
        fit(PELVIS),
        push,
        replace(LIMBS, sliders=shares),
        *limbs,
        VIEW,
        SCENE,
    )
