"""The style sheet that leaves one page of the control panel in sight.

A key works only as long as its button exists, so every button exists on every page.
Meshcat cannot hide a button, nor its own folders; but it writes a button's name into
the page as HTML, and a ``<style>`` there is obeyed (dat.GUI, in Drake 1.51 to 1.58).
Without it nothing is lost but room: all buttons would show on all pages.
"""

from __future__ import annotations

from collections.abc import Sequence

_OPEN = ".dg.main>ul:not(.closed)"
_ROWS = ".dg.main>ul>li"
_TEXT = "display:block;line-height:17px;padding:5px 8px;background:#000"


def page_style(
    title: str, note: str, shown: Sequence[bool], *, show_folders: bool
) -> str:
    """The name of a button that brings the style and is itself hidden.

    Args:
        title: Of the page; it and the note are free of quotes and backslashes.
        note: Below the page's controls; empty for none.
        shown: For each button of the panel in its order whether it is on the page.
            The buttons after these are hidden.
        show_folders: Whether Meshcat's own folders are.
    """
    hidden = [
        f"{_ROWS}:nth-child({place} of .function)"
        for place, on_page in enumerate(shown, 1)
        if not on_page
    ]
    hidden.append(f"{_ROWS}:nth-child(n+{len(shown) + 1} of .function)")
    rules = [
        # What is open in the folders may be long: it scrolls by itself, not the view.
        ".dg.main>ul{max-height:calc(100vh - 20px);overflow-y:auto}",
        # The keys of the robot would hear what is typed into a slider's number.
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
