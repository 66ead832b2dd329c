"""What more workers gain, and what the driver costs: pairs of runs on clusters of this machine.

    OCCLABEL_PROGRAM=target/release/occlabel python benches/scaling.py [PAIRS [SCENES [VOXEL_M]]]

Each run has a cluster of its own: a head that labels nothing, and workers of one CPU. All that the
driver does is in its wall time: the start of Python, the plan, the look at the nodes, the merge.

    ratio     of the wall time of one worker to that of two
    overhead  (workers * wall - what the programs were at work) / what they were at work
    by CPU    what the driver and Ray's daemons took of CPUs / what the programs took
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from ray.cluster_utils import Cluster

PROGRAM = os.environ.get("OCCLABEL_PROGRAM", "occlabel")
STORE_BYTES = 100 * 2**20
TICKS = os.sysconf("SC_CLK_TCK")


def main(pairs: int = 5, scenes: int = 16, voxel_m: float = 0.2) -> None:
    """Runs the pairs, and tells each."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        world = ["--world", "street", "--set", "duration_s=4.1", "--scenes", str(scenes)]
        log_flags = ["--format", "nuscenes", "--images", "none", "--output", str(log)]
        subprocess.run([PROGRAM, "simulate", *world, *log_flags, "--quiet"], check=True)
        ratios = []
        for at in range(pairs):
            one, two = (measure(log, f"{folder}/{at}-{count}", count, voxel_m) for count in (1, 2))
            ratios.append(one / two)
            print(f"ratio {ratios[-1]:.3f}", flush=True)
    print(f"best ratio {max(ratios):.3f} of {[round(ratio, 3) for ratio in ratios]}")


def measure(log: Path, output: str, workers: int, voxel_m: float) -> float:
    """The wall time of a run with so many workers."""
    cluster = start(workers)
    began, daemons = time.monotonic(), cpu_seconds_of_daemons()
    driver = os.times()
    drive(cluster.address, log, output, voxel_m)
    wall, daemons = time.monotonic() - began, cpu_seconds_of_daemons() - daemons
    now = os.times()
    driver_cpu = now[2] + now[3] - driver[2] - driver[3]
    cluster.shutdown()
    told = json.loads(Path(f"{output}.json").read_text())
    assert told["complete"] == told["shards"] == told["tries"], told
    tell(workers, wall, driver_cpu, daemons, told)
    return wall


def start(workers: int) -> Cluster:
    """A head that labels nothing, and so many workers, who yield to nobody else on the machine."""
    os.environ["RAY_worker_niceness"] = "0"  # noqa: SIM112
    head = {"num_cpus": 0, "include_dashboard": False, "object_store_memory": STORE_BYTES}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    for _ in range(workers):
        cluster.add_node(num_cpus=1, object_store_memory=STORE_BYTES)
    cluster.wait_for_nodes()
    return cluster


def drive(address: str, log: Path, output: str, voxel_m: float) -> None:
    """One run of the driver."""
    line = [sys.executable, "-m", "occlabel_ray", "--address", address, "--program", PROGRAM]
    line += ["--output", output, "--report", f"{output}.json"]
    flags = ["--format", "nuscenes", "--input", str(log), "--set", f"grid.voxel_size_m={voxel_m}"]
    env = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    subprocess.run([*line, "--", *flags], check=True, capture_output=True, env=env)


def cpu_seconds_of_daemons() -> float:
    """What Ray's own processes on this machine have taken of CPUs until now."""
    ticks = 0
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")
        except (FileNotFoundError, ProcessLookupError):
            continue
        if any(name in fields[0] for name in ("raylet", "gcs_server")):
            ticks += sum(map(int, fields[2].split()[11:13]))
    return ticks / TICKS


def tell(workers: int, wall: float, driver_cpu: float, daemons: float, told: dict) -> None:
    """A line for a run."""
    work, cpu = told["labelling_seconds"], told["cpu_seconds"]
    print(
        f"{workers} workers: wall {wall:.1f} s, {told['seconds']:.1f} s of it scenes; "
        f"programs {work:.1f} s, {cpu:.1f} s of CPU; "
        f"overhead {workers * wall - work:.1f} s, {workers * wall / work - 1:.1%}; "
        f"by CPU {driver_cpu + daemons:.1f} s, {(driver_cpu + daemons) / cpu:.1%}; "
        f"a scene {(workers * told['seconds'] - work) / told['shards']:.2f} s",
        flush=True,
    )


if __name__ == "__main__":
    numbers = [float(word) for word in sys.argv[1:]]
    main(*[int(number) for number in numbers[:2]], *numbers[2:])
