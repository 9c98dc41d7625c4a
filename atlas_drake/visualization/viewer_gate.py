"""A gate that leaves out pictures that a slow viewer could not take in time.

Data that a viewer has not yet read waits in unbounded buffers: the picture would lag
seconds, and then minutes, behind the robot. The gate is independent of the displays.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from pydrake.geometry import Meshcat
from pydrake.systems.framework import Context, Diagram

from atlas_drake.systems.collectable_system import CollectableSystem

LIMIT = 48_000
"""Amount of unread data above which the gate closes [byte]: about eight pictures."""
LOOK_EVERY = 4
"""Pictures between checks of the unread data."""
TABLES = ("/proc/net/tcp", "/proc/net/tcp6")
"""Linux' lists of sockets. On other systems no picture is left out."""
GATE = "viewer_gate"
"""Name of the gate in a diagram."""
_ESTABLISHED = "01"


class ViewerGate(CollectableSystem):
    """A gate that is closed while the slowest viewer has too much unread data.

    While the gate is closed Drake's visualiser records without showing, and the
    recording is deleted: no other way keeps it from sending. A diagram whose view is
    recorded must not have a gate. Meshcat does not report a running recording, so that
    a recording from elsewhere would be deleted, too. The displays of this project read
    ``is_open``. All displays draw the full state, not changes, so that the first
    picture through an open gate is the latest.

    The state of the gate belongs to the browser and not to the Context. The gate must
    be added to a diagram before the systems that draw.
    """

    __slots__ = ()

    def __init__(self, meshcat: Meshcat, period: float) -> None:
        """Watches the viewers of ``meshcat``; a picture comes every ``period`` [s]."""
        super().__init__()
        self._meshcat = meshcat
        self._pictures = 0
        self.is_open = True
        self.DeclarePeriodicPublishEvent(period, 0.0, self._publish)

    def open(self) -> None:
        """Opens the gate until the next check."""
        if not self.is_open:
            self._meshcat.StopRecording()
            self._meshcat.DeleteRecording()
        self.is_open = True
        self._pictures = 0

    def _publish(self, _context: Context) -> None:
        self._pictures += 1
        if self._pictures % LOOK_EVERY:
            return
        waiting = 0
        # Reading the tables takes milliseconds on some systems.
        if self._meshcat.GetNumActiveConnections():
            unread = bytes_on_the_way(read_sockets(), self._meshcat.port())
            waiting = max(unread, default=0)
        if waiting < LIMIT:
            self.open()
        elif self.is_open:
            self._meshcat.StartRecording(set_visualizations_while_recording=False)
            self.is_open = False
        else:
            self._meshcat.DeleteRecording()  # It would grow while the gate is closed.


def show_latest(diagram: Diagram, context: Context) -> None:
    """Draws the present state, also through a closed gate, when a simulation stops.

    Args:
        diagram: Diagram whose gate has the name GATE, if there is one.
        context: Context of the diagram.
    """
    if diagram.HasSubsystemNamed(GATE):
        gate: Any = diagram.GetSubsystemByName(GATE)
        if not gate.is_open:
            gate.open()
            diagram.ForcedPublish(context)


def read_sockets() -> Iterator[list[str]]:
    """Reads the rows of the kernel's tables of sockets, each split into words."""
    for table in map(Path, TABLES):
        if table.is_file():
            yield from (line.split() for line in table.read_text().splitlines()[1:])


def bytes_on_the_way(rows: Iterable[list[str]], port: int) -> list[int]:
    """Computes the unread data of each connection of a port [byte].

    If the other end is on this computer, the data in its receive buffer counts, too.

    Args:
        rows: Rows of ``read_sockets``.
        port: Port of the server.
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
