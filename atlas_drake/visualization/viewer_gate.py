"""Leaves pictures out that a slow viewer could not take in time.

What a viewer has not yet taken waits in buffers, without bound: the picture would be
seconds, and then minutes, behind the robot. What is drawn is not known here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from pydrake.geometry import Meshcat
from pydrake.systems.framework import Context, Diagram

from atlas_drake.systems.collectable_system import CollectableSystem

LIMIT = 48_000
"""More than this on its way to a viewer is too much [byte]: eight pictures or so."""
LOOK_EVERY = 4
"""Pictures between looks at what is on its way."""
TABLES = ("/proc/net/tcp", "/proc/net/tcp6")
"""Where Linux lists its sockets. Elsewhere no picture is left out."""
GATE = "viewer_gate"
"""Name of the gate in a diagram."""
_ESTABLISHED = "01"


class ViewerGate(CollectableSystem):
    """Is closed while a viewer still has too much to take; the slowest one counts.

    Drake's visualiser then records, without showing, and the recording is thrown away:
    that is the one way to keep it from sending. A diagram whose view is recorded must
    not have a gate. Meshcat does not say whether a recording runs: one that somebody
    else began would be thrown away, too. Our own displays ask ``is_open``. All of them
    draw what is, not what has changed, so that the first picture through an open gate
    is the latest.

    Whether it is open is a fact about the browser, and no part of the Context. It has
    to be added to a diagram before the systems that draw.
    """

    __slots__ = ()

    def __init__(self, meshcat: Meshcat, period: float) -> None:
        """Looks at the viewers of ``meshcat``; a picture comes every ``period`` [s]."""
        super().__init__()
        self._meshcat = meshcat
        self._pictures = 0
        self.is_open = True
        self.DeclarePeriodicPublishEvent(period, 0.0, self._publish)

    def open(self) -> None:
        """Lets pictures through until the next look."""
        if not self.is_open:
            self._meshcat.StopRecording()
            self._meshcat.DeleteRecording()
        self.is_open = True
        self._pictures = 0

    def _publish(self, _context: Context) -> None:
        self._pictures += 1
        if self._pictures % LOOK_EVERY:
            return
        port = self._meshcat.port()
        waiting = max((bytes_on_the_way(read_sockets(), port)), default=0)
        if waiting < LIMIT:
            self.open()
        elif self.is_open:
            self._meshcat.StartRecording(set_visualizations_while_recording=False)
            self.is_open = False
        else:
            self._meshcat.DeleteRecording()  # It would grow as long as it is closed.


def show_latest(diagram: Diagram, context: Context) -> None:
    """Draws what is now, through a closed gate too: where a simulation ends or rests.

    Args:
        diagram: Whose gate has the name GATE, if there is one.
        context: Of the diagram.
    """
    if diagram.HasSubsystemNamed(GATE):
        gate: Any = diagram.GetSubsystemByName(GATE)
        if not gate.is_open:
            gate.open()
            diagram.ForcedPublish(context)


def read_sockets() -> Iterator[list[str]]:
    """The rows of the kernel's tables of sockets, each of them split into words."""
    for table in map(Path, TABLES):
        if table.is_file():
            yield from (line.split() for line in table.read_text().splitlines()[1:])


def bytes_on_the_way(rows: Iterable[list[str]], port: int) -> list[int]:
    """What each connection of a port has sent that the other end has not yet read.

    If that end is on this computer, what waits there is known and counts, too.

    Args:
        rows: As ``read_sockets`` gives them.
        port: Of the server.
    """
    ending = f":{port:04X}"
    sent: dict[tuple[str, str], int] = {}
    received: dict[tuple[str, str], int] = {}
    for _, here, there, state, queues, *_ in rows:
        outgoing, _, incoming = queues.partition(":")
        if state == _ESTABLISHED and here.endswith(ending):
            sent[here, there] = int(outgoing, 16)
        elif state == _ESTABLISHED and there.endswith(ending):
            received[there, here] = int(incoming, 16)
    return [count + received.get(ends, 0) for ends, count in sent.items()]
