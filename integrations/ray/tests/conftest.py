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
    """Three nodes of one CPU each: the head, and two more."""
    ray = pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    store = 100 * 2**20
    node = {"num_cpus": 1, "object_store_memory": store}
    head = {**node, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    cluster.add = lambda: cluster.add_node(**node)
    cluster.further = [cluster.add(), cluster.add()]
    cluster.wait_for_nodes()
    yield cluster
    ray.shutdown()
    cluster.shutdown()
