"""The command ``occlabel-ray``."""

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import ray
from ray.exceptions import RayError

from occlabel_ray.cluster import Cluster, Size
from occlabel_ray.label import COMPLETE, DEGRADED, Line
from occlabel_ray.place import needs_of
from occlabel_ray.plan import Refused, first_line, in_shards, read_plan
from occlabel_ray.progress import Progress, lines, report
from occlabel_ray.schedule import Outcome, run

FAILED, INTERRUPTED = 1, 130
"""Further exit codes, as the program has them."""

KNOCK_S = 10.0
"""How long a cluster may take to answer."""

OUR_FLAGS = ("--output", "--jobs", "--resume", "--shard", "--progress")
"""Flags of `occlabel label` that are not said behind `--`."""


def main(arguments: list[str] | None = None) -> int:
    """Labels a log's scenes on a Ray cluster; the exit code is as that of `occlabel label`."""
    args = parse(arguments)
    try:
        return label_log(args)
    except Refused as refused:
        tell(str(refused))
        return refused.code
    except KeyboardInterrupt:
        tell("interrupted: the same command goes on from here")
        return INTERRUPTED
    except RayError as error:
        tell(f"error: the cluster is lost: {first_line(error)}")
        return FAILED


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """The command line; what follows `--` are flags of ``occlabel label``."""
    parser = argparse.ArgumentParser(prog="occlabel-ray", description=main.__doc__)
    add = parser.add_argument
    add("--output", required=True, help="the label tree, where every node sees it")
    add("--address", default="auto", help="the Ray cluster [default: the one at hand]")
    add("--program", default="occlabel", help="the program, on every node")
    add("--jobs", type=at_least_one, default=1, help="CPUs for each process [default: 1]")
    add("--shards", type=at_least_one, help="processes in all [default: one for each scene]")
    add("--tries", type=at_least_one, default=3, help="then a scene is set aside [default: 3]")
    add("--timeout-s", type=float, help="after which a try has failed")
    add("--resume", choices=["if-same", "never", "always"], help="as of `occlabel label`")
    add("--report", type=Path, help="a JSON file that tells how the run went")
    add("flags", nargs="+", metavar="-- FLAGS", help="of `occlabel label`: --format, --input, ...")
    args = parser.parse_args(arguments)
    for flag in args.flags:
        if flag.split("=")[0] in OUR_FLAGS:
            parser.error(f"{flag} is not said after `--`")
    return args


def at_least_one(text: str) -> int:
    """A count."""
    if int(text) < 1:
        raise argparse.ArgumentTypeError("at least 1")
    return int(text)


def label_log(args: argparse.Namespace) -> int:
    """Plans, labels and merges."""
    flags = [*args.flags, "--jobs", str(args.jobs)]
    scenes, tables_bytes = read_plan(args.program, flags)
    if args.shards:
        scenes = in_shards(scenes, args.shards)
    connect(args.address)
    size = Size(scenes, args.jobs, tables_bytes)
    line = Line(args.program, [*flags, *own_flags(args, size)], os.getcwd(), args.timeout_s)
    with needs_of(line, args.output) as needs:
        cluster, progress = Cluster(line, needs, size, tell), Progress(scenes, tell)
        outcome = run(scenes, cluster, args.tries, progress)
    told = report(outcome, cluster.most_places, progress.seconds())
    code = merge(args.program, args.output, outcome)
    return write(args.report, told) or code


def own_flags(args: argparse.Namespace, size: Size) -> list[str]:
    """What `label` is told beyond what the plan is made with.

    If no node has the memory of the largest scene, the program labels fewer keyframes at once to
    stay under what there is, or says how many bytes it needs.
    """
    flags = ["--output", args.output]
    if args.resume:
        flags += ["--resume", args.resume]
    is_bounded = any(flag.split("=")[0] == "--memory" for flag in args.flags)
    if size.bound_bytes and not is_bounded:
        flags += ["--memory", str(size.bound_bytes)]
    return flags


def connect(address: str) -> None:
    """Joins the cluster. A driver that is told to end does so as on Ctrl-C."""
    try:
        knock(address)
        ray.init(address=address, log_to_driver=False, logging_level="warning")
    except (OSError, RuntimeError, ValueError, RayError) as error:
        raise Refused(f"error: no Ray cluster at {address}: {first_line(error)}") from error
    signal.signal(signal.SIGTERM, signal.default_int_handler)


def knock(address: str) -> None:
    """Fails if nobody listens there: Ray itself would try for minutes."""
    host, _, port = address.rpartition("//")[2].rpartition(":")
    if host:
        socket.create_connection((host, int(port)), KNOCK_S).close()


def merge(program: str, output: str, outcome: Outcome) -> int:
    """Makes of the shards' manifests one, without those of scenes that were set aside."""
    without = ["--without-missing", "--quiet"] if outcome.set_aside else []
    merged = subprocess.run([program, "merge-manifests", output, *without])
    if merged.returncode not in (COMPLETE, DEGRADED):
        return FAILED
    return DEGRADED if outcome.set_aside else merged.returncode


def write(path: Path | None, report: dict) -> int:
    """Tells how the run went."""
    for line in lines(report):
        tell(line)
    try:
        if path is not None:
            path.write_text(json.dumps(report, indent=2) + "\n")
    except OSError as error:
        tell(f"error: --report: {error}")
        return FAILED
    return COMPLETE


def tell(line: str) -> None:
    """Says something to whoever watches."""
    print(line, file=sys.stderr, flush=True)
