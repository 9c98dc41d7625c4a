"""A slow viewer gets fewer pictures, and gets them in time."""

import socket
from pathlib import Path

import pytest
from pydrake.math import RigidTransform

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.simulation import atlas_simulation
from atlas_drake.visualization import viewer_gate
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.viewer import start_meshcat
from atlas_drake.visualization.viewer_gate import (
    GATE,
    LIMIT,
    LOOK_EVERY,
    TABLES,
    bytes_on_the_way,
    read_sockets,
    show_latest,
)

websocket = pytest.importorskip("websocket")

TABLE = """\
0: 0100007F:1B58 00000000:0000 0A 00000000:00000007 00:00000000
1: 0100007F:1B58 0100007F:C001 01 00000010:00000000 00:00000000
2: 0100007F:C001 0100007F:1B58 01 00000000:00000020 00:00000000
3: 0100007F:1B58 0200A8C0:C002 01 00000100:00000000 00:00000000
4: 0100007F:C003 0100007F:1B59 01 00000000:00001000 00:00000000
5: 0100007F:1B58 0200A8C0:C004 06 00000200:00000000 00:00000000
"""


def test_what_is_on_its_way_is_counted_for_each_viewer_of_the_port():
    rows = [line.split() for line in TABLE.splitlines()]
    assert bytes_on_the_way(rows, 7000) == [0x30, 0x100]
    assert bytes_on_the_way(rows, 80) == []


@pytest.fixture
def watched(monkeypatch):
    """A simulation with a view, and somebody who has opened the view."""
    # What an advance ends with is looked at by itself.
    monkeypatch.setattr(atlas_simulation, "SHOWN_EVERY", float("inf"))
    if not Path(TABLES[0]).is_file():
        pytest.skip("only Linux lists its sockets in /proc")
    meshcat = start_meshcat()
    sim = AtlasSimulation(
        Scenario(),
        view=meshcat,
        overlays=Overlays(["com", "dcm", "cop", "support"]),
    )
    viewer = websocket.create_connection(
        meshcat.ws_url(), sockopt=[(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)]
    )
    yield sim, meshcat, viewer
    viewer.close()


def test_without_a_viewer_no_socket_is_looked_at(monkeypatch):
    looks = []
    monkeypatch.setattr(viewer_gate, "read_sockets", lambda: looks.append(1) or ())
    meshcat = start_meshcat()
    sim = AtlasSimulation(view=meshcat)
    sim.advance(0.3)
    assert not looks
    viewer = websocket.create_connection(meshcat.ws_url())
    sim.advance(0.3)
    viewer.close()
    assert looks


def waiting(meshcat):
    return max(bytes_on_the_way(read_sockets(), meshcat.port()))


def read_all(viewer):
    """How much there was to read [byte]."""
    viewer.settimeout(0.3)
    count = 0
    try:
        while True:
            count += len(viewer.recv())
    except websocket.WebSocketTimeoutException:
        return count


@pytest.mark.slow
def test_pictures_are_left_out_while_a_viewer_has_too_many(watched):
    sim, meshcat, viewer = watched
    gate = sim.diagram.GetSubsystemByName(GATE)
    step = LOOK_EVERY / 32.0
    read_all(viewer)
    sim.advance(step)
    assert gate.is_open
    for _ in range(2 * LIMIT // 200):  # More than the buffers of a slow line hold.
        meshcat.SetTransform("/mark", RigidTransform())
    sim.advance(2 * step)
    assert not gate.is_open
    before = waiting(meshcat)
    sim.advance(step)
    assert not gate.is_open
    # But for Drake's own word on the real-time rate.
    assert waiting(meshcat) - before < 2000
    # It has read all that was on its way, and sees the latest picture again.
    read_all(viewer)
    sim.advance(2 * step)
    assert gate.is_open
    assert read_all(viewer) > 4000


@pytest.mark.slow
def test_where_it_ends_is_shown_through_a_closed_gate(watched, monkeypatch):
    sim, _meshcat, viewer = watched
    read_all(viewer)
    monkeypatch.setattr(viewer_gate, "LIMIT", -1)
    sim.advance(2 * LOOK_EVERY / 32.0)
    assert not sim.diagram.GetSubsystemByName(GATE).is_open
    read_all(viewer)
    show_latest(sim.diagram, sim.context)
    assert read_all(viewer) > 4000


def test_a_recording_has_no_gate_and_misses_nothing():
    meshcat = start_meshcat()
    meshcat.StartRecording()
    sim = AtlasSimulation(view=meshcat, recorded=True)
    assert not sim.diagram.HasSubsystemNamed(GATE)
