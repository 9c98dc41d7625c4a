"""Errors that name a module, attribute, field or topic without a stand-in."""

from collections.abc import Iterable

from atlas_drake.errors import AtlasError, did_you_mean

LIST = "; there are "
"""Words of an error that introduce the list of the known names."""


class ScriptError(AtlasError):
    """A program that cannot be run as it is."""


class UnknownNameError(ScriptError, AttributeError):
    """A module, attribute, message field or parameter that no stand-in has."""


def unknown(
    what: str, name: str, known: Iterable[str], kind: type[ScriptError] = ScriptError
) -> ScriptError:
    """Return the error about ``what``, in which ``name`` may be misspelt."""
    names = sorted(set(known))
    listed = f"{LIST}{', '.join(names)}.{did_you_mean(name, names)}"
    return kind(f"atlas-drake script has no stand-in for {what}{listed}")
