"""The command ``occlabel-ray``."""

import argparse
import os
import subprocess
import sys

import ray

from occlabel_ray.cluster import Cluster
from occlabel_ray.label import COMPLETE, DEGRADED, USAGE, Line
from occlabel_ray.plan import Refused, read_plan
from occlabel_ray.schedule import Outcome, run

FAILED = 1


def main(arguments: list[str] | None = None) -> int:
    """Labels a log's scenes on a cluster; the exit code is as that of ``occlabel label``."""
    args = parse(arguments)
    ray.init(address=args.address, log_to_driver=False)
    try:
        flags = [*args.flags, "--jobs", str(args.jobs)]
        scenes = read_plan(args.program, flags)
        flags += ["--output", args.output]
        line = Line(args.program, flags, os.getcwd(), args.timeout_s)
        outcome = run(scenes, Cluster(line, args.jobs), args.tries, tell)
    except Refused as refused:
        tell(str(refused))
        return USAGE
    return end(args.program, args.output, outcome)


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """The command line; what follows `--` are flags of ``occlabel label``."""
    parser = argparse.ArgumentParser(prog="occlabel-ray", description=main.__doc__)
    add = parser.add_argument
    add("--output", required=True, help="the label tree, where every node sees it")
    add("--address", default="auto", help="the Ray cluster [default: the one at hand]")
    add("--program", default="occlabel", help="the program, on every node")
    add("--jobs", type=int, default=1, help="CPUs for each scene")
    add("--tries", type=int, default=3, help="after which a scene is set aside")
    add("--timeout-s", type=float, help="after which a try has failed")
    add("flags", nargs="+", metavar="-- FLAGS", help="of `occlabel label`: --format, --input, ...")
    return parser.parse_args(arguments)


def end(program: str, output: str, outcome: Outcome) -> int:
    """Makes of the shards' manifests one, and tells what was set aside."""
    for scene, told in outcome.set_aside.items():
        tell(f"set aside: {scene}: {told}")
    without = ["--without-missing"] if outcome.set_aside else []
    merged = subprocess.run([program, "merge-manifests", output, *without])
    if merged.returncode not in (COMPLETE, DEGRADED):
        return FAILED
    return DEGRADED if outcome.set_aside or outcome.degraded else COMPLETE


def tell(line: str) -> None:
    """Says how the run goes."""
    print(line, file=sys.stderr, flush=True)
