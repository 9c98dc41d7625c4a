"""Buttons and sliders of Meshcat, one page at a time.

The value of a slider stays in force while another page is open. The meaning of the
controls is in ``panel``.

A key works only as long as its button exists, so every button exists on every page.
Meshcat cannot hide a button, nor its own folders; but it writes a button's name into
the page as HTML, and a ``<style>`` there is obeyed (dat.GUI, in Drake 1.51 to 1.58).
Without the style sheet all buttons show on all pages.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from pydrake.geometry import Meshcat

from atlas_drake.control.feet.footstep import clip
from atlas_drake.errors import shown
from atlas_drake.teleop.controls import (
    PAGE_TURNS,
    Action,
    BehaviorButton,
    Button,
    Slider,
)
from atlas_drake.teleop.pages import Page

_OPEN = ".dg.main>ul:not(.closed)"
_ROWS = ".dg.main>ul>li"
_TEXT = "display:block;line-height:17px;padding:5px 8px;background:#000"


def page_style(
    title: str, note: str, shown: Sequence[bool], *, show_folders: bool
) -> str:
    """Makes the name of a hidden button that contains the style.

    Args:
        title: Title of the page, without quotes and backslashes.
        note: Text below the page's controls, likewise; empty for none.
        shown: True for each button of the panel, in order, that is on the page. Later
            buttons are hidden.
        show_folders: True to show Meshcat's own folders.
    """
    hidden = [
        f"{_ROWS}:nth-child({place} of .function)"
        for place, on_page in enumerate(shown, 1)
        if not on_page
    ]
    hidden.append(f"{_ROWS}:nth-child(n+{len(shown) + 1} of .function)")
    rules = [
        # An open folder may be long: it scrolls on its own, without the view.
        ".dg.main>ul{max-height:calc(100vh - 20px);overflow-y:auto}",
        # Text typed into a slider's number would otherwise act as keys of the robot.
        f"{_ROWS}.has-slider input{{pointer-events:none}}",
        f'{_OPEN}::before{{content:"{title}";font-weight:bold;{_TEXT}}}',
        ",".join(hidden) + "{display:none}",
    ]
    if show_folders:
        # Below the buttons that turn the page, so that these stay where they are.
        rules.append(f"{_OPEN}{{display:flex;flex-direction:column}}")
        rules.append(f"{_OPEN}>li{{flex:none}}{_OPEN}>li.folder{{order:1}}")
    else:
        rules.append(f"{_ROWS}.folder{{display:none}}")
    if note:
        rules.append(f'{_OPEN}::after{{content:"{note}";{_TEXT}}}')
    return f"<style>{''.join(rules)}</style>"


class PagedControls:
    """Pages in Meshcat's panel, of which one is open."""

    def __init__(
        self,
        meshcat: Meshcat,
        pages: Sequence[Page],
        more_buttons: Sequence[BehaviorButton] = (),
        say: Callable[[str], object] = print,
    ) -> None:
        """Adds the buttons, and opens the first page.

        ``say`` is called with a message about a value beyond its slider's range.
        """
        self._meshcat = meshcat
        self._say = say
        self._clicks: dict[Button, int] = dict.fromkeys((*Action, *more_buttons), 0)
        self._values: dict[Slider, float] = {}
        self._in_view: dict[Slider, float] = {}  # Meshcat's values when last read.
        self._style: str | None = None
        # Added once: a key works only while its button exists.
        for button in self._clicks:
            code = "" if button.key is None else button.key.code
            meshcat.AddButton(button.label, code)
        self._pages = tuple(pages)
        self._open(0)

    @property
    def page(self) -> Page:
        """The open page."""
        return self._pages[self._number]

    def read(self) -> tuple[Button, ...]:
        """Reads sliders and turns pages; returns the other buttons pressed since."""
        for slider, before in self._in_view.items():
            value = self._meshcat.GetSliderValue(slider.label)
            if value != before:
                self._take(slider, value)
        pressed: list[Button] = []
        turns = 0
        for action, before in self._clicks.items():
            clicks = self._meshcat.GetButtonClicks(action.label)
            if clicks == before:
                continue
            self._clicks[action] = clicks
            if isinstance(action, Action) and action in PAGE_TURNS:
                turns += PAGE_TURNS[action] * (clicks - before)
            else:
                pressed.append(action)
        if turns % len(self._pages):
            self._open((self._number + turns) % len(self._pages))
        return tuple(pressed)

    def _take(self, slider: Slider, value: float) -> None:
        """Takes a value that a browser sent, within the range of its slider.

        Meshcat passes on any number that a web client sends, also infinities and NaN.
        """
        within = self.value(slider)
        if math.isfinite(value):
            within = clip(value, slider.low, slider.high)
        self._in_view[slider], self._values[slider] = value, within
        # A browser rounds to steps from zero, which may lead beyond the end by less
        # than a step; the difference from NaN is not below anything.
        if not abs(value - within) < slider.step:
            sent = shown(value)
            self._say(f"! {slider.label}: a browser sent {sent}, {within:g} holds.")
            self.set(slider, within)

    def value(self, slider: Slider) -> float:
        """Returns the value in force of a slider on any page."""
        return self._values.get(slider, slider.value)

    def set(self, slider: Slider, value: float) -> None:
        """Moves a slider on any page."""
        self._values[slider] = min(max(value, slider.low), slider.high)
        if slider in self._in_view:
            self._in_view[slider] = self._meshcat.SetSliderValue(slider.label, value)

    def set_pages(self, pages: Sequence[Page]) -> None:
        """Replaces the pages; the open page stays open, or the page before it opens.

        Values of removed sliders are dropped.
        """
        pages = tuple(pages)
        if pages == self._pages:
            return
        kept = {page.title: number for number, page in enumerate(pages)}
        before = [page.title for page in self._pages[: self._number + 1]]
        number = next(kept[title] for title in reversed(before) if title in kept)
        self._pages = pages
        sliders = {slider for page in pages for slider in page.sliders}
        self._values = {s: v for s, v in self._values.items() if s in sliders}
        self._open(number)

    def _open(self, number: int) -> None:
        """Shows a page by number."""
        self._number = number
        page, meshcat = self.page, self._meshcat
        self._show_buttons()
        if tuple(self._in_view) == page.sliders:
            return
        for slider in self._in_view:
            meshcat.DeleteSlider(slider.label)
        self._in_view = {
            slider: meshcat.AddSlider(*slider[:4], self.value(slider))
            for slider in page.sliders
        }

    def _show_buttons(self) -> None:
        """Hides the buttons of other pages, and shows title and page number."""
        page, before = self.page, self._style
        self._style = page_style(
            f"{page.title}: page {self._number + 1} of {len(self._pages)}",
            page.note,
            [button in (*page.actions, *PAGE_TURNS) for button in self._clicks],
            show_folders=page.scene,
        )
        if self._style == before:
            return
        # Add the new style first, so that all buttons never show at once.
        self._meshcat.AddButton(self._style)
        if before is not None:
            self._meshcat.DeleteButton(before)
