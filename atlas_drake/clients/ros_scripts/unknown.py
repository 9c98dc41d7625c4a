"""Errors that name a module, attribute, field or service without a stand-in."""

from collections.abc import Iterable

from atlas_drake.errors import AtlasError, did_you_mean

LIST = "; there are "
"""Words of an error that introduce the list of the known names."""
RENAMED = {
    # Messages and topics.
    "AtlasSimInterface": "AtlasSimInterfaceCommand",
    "AtlasSimInterfaceAction": "WalkDemoAction",
    "AtlasSimInterfaceGoal": "WalkDemoGoal",
    "/atlas/state": "/atlas/atlas_state",
    # Fields of commands.
    "multistep_walk_params": "walk_params",
    "pelvis_lat": "com_v0",
    "singlestep_walk_params": "step_params",
    "step_data": "step_queue, in walk_feedback step_queue_saturated",
    # Fields of reports; feedback was part of behavior_feedback.
    "current_step_index": "walk_feedback.current_step_index",
    "foot_pose_est": "foot_pos_est",
    **{
        f"{behavior}_feedback": f"AtlasSimInterfaceState.{behavior}_feedback"
        for behavior in ("manipulate", "stand", "step", "walk")
    },
    "step_data_saturated": "step_queue_saturated",
}
"""Names of the first versions of DRCSim, with today's."""


class ScriptError(AtlasError):
    """A program that cannot be run as it is."""


class UnknownNameError(ScriptError, AttributeError):
    """A module, attribute, message field or parameter that no stand-in has."""


def hint_for(name: str, known: Iterable[str]) -> str:
    """Names, after a space, today's name or the one that may be meant, if any."""
    if name in RENAMED:
        return f" Its name is now {RENAMED[name]}."
    return did_you_mean(name, known)


def unknown(
    what: str, name: str, known: Iterable[str], kind: type[ScriptError] = ScriptError
) -> ScriptError:
    """Return the error about ``what``, in which ``name`` may be old or misspelt."""
    names = sorted(set(known))
    listed = f"{LIST}{', '.join(names)}.{hint_for(name, names)}"
    return kind(f"atlas-drake script has no stand-in for {what}{listed}")
