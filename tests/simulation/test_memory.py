"""Memory: a simulation without references is freed, with its port and threads."""

import gc
import importlib
import socket
import weakref
from pathlib import Path

import pytest
from pydrake.systems.framework import Diagram, LeafSystem

from atlas_drake import AtlasSimulation, Scenario, Start
from atlas_drake.clients.view.viewer import start_meshcat
from atlas_drake.systems.collectable_system import CollectableSystem


def parts_of(diagram):
    """A diagram and all systems in it, also those of diagrams in it."""
    yield diagram
    for system in diagram.GetSystems():
        yield from parts_of(system) if isinstance(system, Diagram) else [system]


def threads_and_files():
    """How many this process has, also those of Drake's, where Linux tells."""
    folders = {name: Path("/proc/self") / name for name in ("task", "fd")}
    return {n: len([*f.iterdir()]) for n, f in folders.items() if f.is_dir()}


@pytest.mark.slow
def test_a_simulation_that_is_dropped_is_freed_with_its_view_and_log(tmp_path):
    def run():
        meshcat = start_meshcat()
        sim = AtlasSimulation(
            Scenario(
                state="estimated",
                initial_behavior="USER",
                start=Start(on_gantry=True),
            ),
            view=meshcat,
            log=tmp_path / "run.mcap",
        )
        sim.advance(0.02)
        parts = [sim, meshcat, sim.simulator, *parts_of(sim.diagram)]
        names = [type(part).__name__ for part in parts]
        return meshcat.port(), names, [weakref.ref(part) for part in parts]

    run()  # What libraries open once, at their first use, stays open.
    gc.collect()
    before = threads_and_files()
    port, names, alive = run()
    gc.collect()
    left = [name for name, part in zip(names, alive, strict=True) if part()]
    assert left == []
    assert {"Gantry", "StateEstimator", "MeshcatView", "RecordListener"} <= {*names}
    for name, count in threads_and_files().items():
        assert count <= before[name], name  # Of another test's, some may go as well.
    with socket.socket() as free:
        free.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        free.bind(("localhost", port))


def test_every_system_of_this_package_can_be_freed():
    for name in (
        "clients.logs.log_player",
        "clients.view.meshcat_view",
    ):
        importlib.import_module(f"atlas_drake.{name}")
    ours = [
        kind
        for kind in LeafSystem.__subclasses__()
        if kind.__module__.startswith("atlas_drake")
    ]
    assert ours == [CollectableSystem]
    systems = CollectableSystem.__subclasses__()
    assert len(systems) > 15
    ours = [one for one in systems if one.__module__.startswith("atlas_drake")]
    assert all("__slots__" in one.__dict__ for one in ours)


def test_a_system_is_freed_with_the_callbacks_that_drake_holds():
    class Counter(CollectableSystem):
        __slots__ = ()

        def __init__(self):
            super().__init__()
            self.itself = self
            self.declare_vector_output("size", 1, lambda _context: [len(self.name())])
            self.cached = self.declare_cached("cached", lambda _context: self.name())
            self.scratch = self.declare_scratch_context(
                lambda: CollectableSystem().CreateDefaultContext()
            )

        def name(self):
            return type(self).__name__

    def used():
        system = Counter()
        context = system.CreateDefaultContext()
        assert system.GetOutputPort("size").Eval(context) == [7.0]
        assert system.cached.Eval(context) == "Counter"
        return weakref.ref(system)

    alive = used()
    gc.collect()
    assert alive() is None
