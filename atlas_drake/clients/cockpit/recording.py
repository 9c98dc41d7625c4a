"""A recording of the 3D view, from now on."""

from __future__ import annotations

import base64
import re

from pydrake.geometry import Meshcat

from atlas_drake.clients.view import FRAME_RATE
from atlas_drake.errors import InvalidMessageError


class Recording:
    """Starts and ends a recording, which becomes a web page.

    A recording holds the motion of what the view has when it begins: the robot and the
    models around it.

    Attributes:
        is_on: True while the view is recorded.
        why_not: Why it cannot be; empty if it can.
    """

    def __init__(self, meshcat: Meshcat) -> None:
        """Records nothing yet."""
        self._meshcat = meshcat
        self.is_on = False
        self.why_not = ""

    def record(self, on: bool) -> str:
        """Records from now on, or ends the recording.

        Returns:
            At the end a web page that plays it without this program.
        """
        if on and self.why_not:
            raise InvalidMessageError("recording", on, self.why_not)
        if on:
            self._meshcat.DeleteRecording()
            self._meshcat.StartRecording(frames_per_second=FRAME_RATE)
            self.is_on = True
            return ""
        if not self.is_on:
            raise InvalidMessageError("recording", on, "nothing is recorded")
        self.is_on = False
        self._meshcat.StopRecording()
        self._meshcat.PublishRecording()
        page: str = self._meshcat.StaticHtml()
        self._meshcat.DeleteRecording()
        return trimmed(page)


MESSAGE = re.compile(r'(data:application/octet-binary;base64,)([^"\']*)(?=["\'])')
"""A message of Meshcat's in a web page that it wrote."""
ANIMATION = base64.b64encode(b"\x83\xa4type\xadset_animation")[:24].decode()
"""How a message with an animation begins: three entries, the first is its type."""


def trimmed(page: str) -> str:
    """Lets the animation of a recording begin at its first motion.

    Meshcat counts time from the begin of the run, which may be long before that of the
    recording.
    """
    import msgpack

    def trim(found: re.Match[str]) -> str:
        if not found[2].startswith(ANIMATION):
            return found[0]
        message = msgpack.unpackb(base64.b64decode(found[2]), strict_map_key=False)
        tracks = [
            track for one in message["animations"] for track in one["clip"]["tracks"]
        ]
        moves = [track for track in tracks if track["name"] == ".position"]
        begin = min((key["time"] for one in moves for key in one["keys"]), default=0)
        for track in tracks:
            for key in track["keys"]:
                key["time"] = max(key["time"] - begin, 0)
        return found[1] + base64.b64encode(msgpack.packb(message)).decode()

    return MESSAGE.sub(trim, page)
