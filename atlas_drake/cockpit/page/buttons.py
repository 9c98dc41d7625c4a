"""Buttons in the page's own colors."""

from __future__ import annotations

from typing import Any

from nicegui import ui


def light(element: ui.element, on: bool, style: str = "lit") -> None:
    """Gives an element a class of the style sheet, or takes it away."""
    element.classes(**{"add" if on else "remove": style})


def button(text: str = "", press: Any = None, *, icon: str | None = None) -> ui.button:
    """Makes a small button; the style sheet gives its colors."""
    return ui.button(text, on_click=press, icon=icon, color=None).props(
        "dense no-caps unelevated"
    )
