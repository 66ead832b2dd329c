"""A cluster of three nodes on this machine, and programs that do as they are told."""

import pytest


@pytest.fixture
def program(tmp_path):
    """Writes a script that stands in the place of `occlabel`."""

    def write(text):
        path = tmp_path / "occlabel"
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
        return str(path)

    return write


@pytest.fixture
def nodes():
    """A head that labels nothing, and two nodes of one CPU each."""
    ray = pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    store = 100 * 2**20
    head = {"num_cpus": 0, "include_dashboard": False, "object_store_memory": store}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    cluster.add = lambda: cluster.add_node(num_cpus=1, object_store_memory=store)
    cluster.labelling = [cluster.add(), cluster.add()]
    cluster.wait_for_nodes()
    ray.init(address=cluster.address, log_to_driver=False)
    yield cluster
    ray.shutdown()
    cluster.shutdown()
