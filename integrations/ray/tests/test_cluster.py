"""A real cluster, of which nodes and workers are lost."""

import json
import os
import shutil
import signal
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from occlabel_ray.cluster import Cluster
from occlabel_ray.command import end
from occlabel_ray.label import DEGRADED, Line
from occlabel_ray.plan import Scene, read_plan
from occlabel_ray.schedule import run

PROGRAM = os.environ.get("OCCLABEL_PROGRAM") or shutil.which("occlabel")
SCENES = int(os.environ.get("OCCLABEL_RAY_SCENES", "6"))


def test_a_lost_node_and_a_poisoned_scene(nodes, program, tmp_path):
    """Each scene notes that it was begun and that it ended; shard 3 never does."""
    does = """
        shard=${3%/*}
        echo $shard >> begun
        sleep 1
        test "$shard" != 3 || { echo "scene 3 is broken" >&2; exit 1; }
        echo $shard >> ended"""
    line = Line(program(does), [], str(tmp_path))
    scenes = [Scene(f"s{at}", f"{at}/8", 40, 8.0 - at, 1 << 20) for at in range(8)]

    with ThreadPoolExecutor() as pool:
        running = pool.submit(run, scenes, Cluster(line, 1), 3, print)
        wait_for(lambda: len(lines(tmp_path / "begun")) >= 2)
        nodes.remove_node(nodes.labelling[1], allow_graceful=False)
        nodes.add()
        outcome = running.result()
    assert outcome.set_aside == {"s3": "scene 3 is broken"}
    assert sorted(outcome.complete) == [f"s{at}" for at in range(8) if at != 3]
    assert outcome.tries["s3"] == 3
    assert sum(outcome.tries.values()) >= 7 + 3 + 1, "a scene was lost with its node"
    assert sorted(set(lines(tmp_path / "ended"))) == [str(at) for at in range(8) if at != 3]


@pytest.mark.skipif(PROGRAM is None, reason="there is no occlabel, nor OCCLABEL_PROGRAM")
def test_a_cluster_gives_the_tree_of_one_process(nodes, tmp_path):
    """Two workers are killed, and a scene is broken: all else is as one process has it."""
    log, alone, together = (tmp_path / name for name in ("log", "alone", "together"))
    simulate(log)
    scenes = read_plan(PROGRAM, flags(log))
    poisoned = scenes[SCENES // 2].name
    others = ",".join(scene.name for scene in scenes if scene.name != poisoned)
    command("label", *flags(log), "--scenes", others, "--output", alone)
    cut_a_sweep(log, poisoned)

    line = Line(PROGRAM, [*flags(log), "--output", str(together)], str(tmp_path))
    with ThreadPoolExecutor() as pool:
        running = pool.submit(run, scenes, Cluster(line, 1), 3, print)
        kill_workers(2)
        outcome = running.result()
    assert list(outcome.set_aside) == [poisoned]
    assert outcome.tries.total() >= SCENES - 1 + 3 + 2
    assert end(PROGRAM, str(together), outcome) == DEGRADED
    assert labels_under(together) == labels_under(alone)
    assert len(labels_under(alone)) == sum(
        scene.keyframes for scene in scenes if scene.name != poisoned
    )


def kill_workers(count):
    """Kills programs that label, with the workers that started them."""
    for _ in range(count):
        parent = wait_for(worker)
        os.kill(parent, signal.SIGKILL)
        time.sleep(2)


def worker():
    """The process that runs an `occlabel label`; none if none does."""
    line = f"{PROGRAM} label .*--shard"
    found = subprocess.run(["pgrep", "-of", line], capture_output=True, text=True).stdout
    stat = Path(f"/proc/{found.strip()}/stat")
    return int(stat.read_text().rsplit(")")[1].split()[1]) if found and stat.exists() else None


def simulate(log):
    world = ["--world", "street", "--scenes", SCENES, "--format", "nuscenes", "--images", "none"]
    command("simulate", *world, "--output", log)


def cut_a_sweep(log, scene):
    """Breaks the sweep of a scene's first keyframe."""
    [token] = [row["first_sample_token"] for row in table(log, "scene") if row["name"] == scene]
    [file, *_] = [
        row["filename"]
        for row in table(log, "sample_data")
        if row["sample_token"] == token and row["filename"].endswith(".pcd.bin")
    ]
    os.truncate(log / file, 7)


def table(log, name):
    [path] = log.glob(f"*/{name}.json")
    return json.loads(path.read_text())


def flags(log):
    return ["--format", "nuscenes", "--input", str(log), "--set", "grid.voxel_size_m=0.8"]


def command(*arguments):
    line = [PROGRAM, *map(str, arguments)]
    return subprocess.run(line, check=True, capture_output=True, text=True).stdout


def labels_under(tree):
    return {path.relative_to(tree): path.read_bytes() for path in sorted(tree.rglob("*.npz"))}


def lines(path):
    return path.read_text().splitlines() if path.exists() else []


def wait_for(find):
    for _ in range(600):
        if found := find():
            return found
        time.sleep(0.1)
    raise AssertionError("it did not come")
