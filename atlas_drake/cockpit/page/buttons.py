"""Buttons in the page's own colors."""

from __future__ import annotations

from typing import Any

from nicegui import ui


def button(text: str = "", press: Any = None, *, icon: str | None = None) -> ui.button:
    """Makes a small button; the style sheet gives its colors."""
    return ui.button(text, on_click=press, icon=icon, color=None).props(
        "dense no-caps unelevated"
    )
