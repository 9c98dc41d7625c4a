"""What publishers and subscribers of a run share, and topics of the program's own."""

from __future__ import annotations

import copy
from collections import defaultdict, deque
from collections.abc import Callable

from atlas_drake.clients.ros_scripts.clock import Clock
from atlas_drake.clients.ros_scripts.ros_message import RosMessage
from atlas_drake.clients.ros_scripts.topics import READ, WRITE
from atlas_drake.clients.ros_scripts.unknown import hint_for


class Network:
    """The clock, the notes for the user, and topics that no part of the robot has.

    As in ROS, messages on any topic reach the program's own subscribers.
    """

    def __init__(self, clock: Clock, say: Callable[[str], object]) -> None:
        """Begins without topics; ``say`` prints a line."""
        self.clock, self._say = clock, say
        self._noted: set[str] = set()
        self._inboxes: dict[str, list[deque[RosMessage]]] = defaultdict(list)

    def note(self, text: str | None) -> None:
        """Prints a note, unless it was printed before or is None."""
        if text and text not in self._noted:
            self._noted.add(text)
            self._say(text)

    def send(self, topic: str, message: RosMessage) -> None:
        """Hands a copy of a message to the program's subscribers."""
        for inbox in self._inboxes[topic]:
            inbox.append(copy.deepcopy(message))

    def receive(self, topic: str) -> deque[RosMessage]:
        """Returns the inbox of a new subscriber."""
        self.note_own(topic, "writes")
        inbox: deque[RosMessage] = deque()
        self._inboxes[topic].append(inbox)
        return inbox

    def note_own(self, topic: str, does: str) -> None:
        """Prints that no robot ``reads`` or ``writes`` a topic."""
        hint = hint_for(topic, [*READ, *WRITE])
        self.note(f"! Nothing but this program {does} topic {topic}.{hint}")
