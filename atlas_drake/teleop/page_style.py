"""The style sheet that shows one page of the control panel and hides the others.

A key works only as long as its button exists, so every button exists on every page.
Meshcat cannot hide a button, nor its own folders; but it writes a button's name into
the page as HTML, and a ``<style>`` there is obeyed (dat.GUI, in Drake 1.51 to 1.58).
Without the style sheet all buttons show on all pages.
"""

from __future__ import annotations

from collections.abc import Sequence

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
