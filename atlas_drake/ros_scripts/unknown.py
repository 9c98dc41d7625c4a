"""Errors that name a module, attribute, field or topic without a stand-in.

The caller gives the list of the names that exist.
"""

from collections.abc import Iterable

from atlas_drake.errors import AtlasError, did_you_mean


class ScriptError(AtlasError):
    """A program that cannot be run as it is.

    Attributes:
        brief: The message without the list of known names.
    """

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)
        self.brief = " ".join(map(str, arguments))


class UnknownNameError(ScriptError, AttributeError):
    """A module, attribute, message field or parameter that no stand-in has."""


def unknown(
    what: str, name: str, known: Iterable[str], kind: type[ScriptError] = ScriptError
) -> ScriptError:
    """Return the error that names a missing thing and lists the known ones.

    Args:
        what: Full name of the missing thing, such as ``rospy.Foo``.
        name: The part of the name that may be misspelt.
        known: Names that exist.
        kind: Class of the error.
    """
    listed = sorted(set(known))
    error = kind(
        f"{what} is not among what atlas-drake script stands in for: "
        f"{', '.join(listed)}.{did_you_mean(name, listed)}"
    )
    error.brief = f"{what} is not among what atlas-drake script stands in for"
    return error
