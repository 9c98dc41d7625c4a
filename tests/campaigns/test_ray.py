"""Campaigns on a Ray cluster: two worker nodes on this machine, one of them killed."""

import threading
import time

import pytest

from atlas_drake.campaigns import run_campaign
from atlas_drake.campaigns.folder import same_result

ray = pytest.importorskip("ray", reason='needs ray: pip install "atlas-drake[ray]"')

pytestmark = [
    pytest.mark.slow,
    # Of Ray's own, when a node is killed.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]
TRIALS = 10
LIMIT = 12.0
"""Of a trial [s]: enough to kill a node meanwhile."""
ENDS = {
    5: "the process died (7)",
    6: "SystemExit: enough",
    7: f"took longer than {LIMIT:g} s",
}
"""Last lines of the errors of trials that end their process, or hang."""
OWN = """
    import os
    import subprocess
    import sys
    import time
    from pathlib import Path

    def stuck_once(sim, parameters):
        sim.advance(0.1)
        if sim.scenario.seed == 5:
            os._exit(7)
        if sim.scenario.seed == 6:
            sys.exit("enough")
        if sim.scenario.seed == 7:
            time.sleep(300.0)
        begun = Path(parameters["folder"], "begun")
        if sim.scenario.seed == 4 and parameters["stuck"] and not begun.exists():
            # The node's raylet is the parent of Ray's worker, and that of this process.
            parent = ["ps", "-o", "ppid=", "-p", str(os.getppid())]
            begun.write_text(subprocess.check_output(parent, text=True))
            time.sleep(300.0)
"""


@pytest.fixture
def cluster():
    """A head that calls nothing, and two nodes of one processor each."""
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    nodes = [cluster.add_node(num_cpus=1) for _ in range(2)]
    cluster.wait_for_nodes()
    yield cluster, nodes
    ray.shutdown()
    cluster.shutdown()


def raylet_of(node):
    return node.all_processes["raylet"][0].process.pid


def test_a_cluster_finds_the_same_though_a_node_is_killed(cluster, campaign, tmp_path):
    cluster, nodes = cluster
    begun = tmp_path / "begun"
    lines = f"""
trial: stuck_once
seeds: counted
trials: {TRIALS}
trial_timeout: {LIMIT:g}
"""

    def run(stuck, **where):
        stays = campaign(
            f"{lines}parameters: {{folder: {tmp_path}, stuck: {stuck}}}\n", OWN
        )
        return run_campaign(stays, tmp_path / f"out-{stuck}", **where)

    killed = []

    def kill_in_the_middle():
        deadline = time.monotonic() + 120.0
        while time.monotonic() < deadline:
            if begun.exists() and (raylet := begun.read_text()):
                (node,) = [n for n in nodes if raylet_of(n) == int(raylet)]
                cluster.remove_node(node, allow_graceful=False)
                killed.append(node)
                return
            time.sleep(0.1)

    killer = threading.Thread(target=kill_in_the_middle)
    killer.start()
    done = []
    there = run(
        "true",
        jobs=0,
        ray=cluster.address,
        on_trial=lambda record, *_: done.append(record["trial"]),
    )
    killer.join()
    assert len(killed) == 1
    # No trial is lost, and none counts twice.
    assert sorted(done) == list(range(TRIALS))
    here = run("false", jobs=1)
    for number, record in there.items():
        if number in ENDS:
            for one in (record, here[number]):
                assert one["error"].splitlines()[-1] == ENDS[number]
        else:
            assert record["error"] is None
            assert same_result(record) == same_result(here[number])
