"""What there is to label: the lines of ``occlabel plan``."""

import json
import resource
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass, replace

from occlabel_ray.label import COMPLETE, DEGRADED, USAGE


class Refused(Exception):
    """Something that no further try would mend: the input, the configuration, the cluster."""

    def __init__(self, told: str, code: int = USAGE) -> None:
        """What is told, and the exit code of the run."""
        super().__init__(told)
        self.code = code


@dataclass(frozen=True)
class Scene:
    """A scene as a work item, or several that one process labels."""

    name: str
    """Of several, it tells the first and how many more there are."""
    shard: str
    """``I/N``: what ``--shard`` is given."""
    keyframes: int
    cpu_seconds: float
    """What labelling it is expected to cost."""
    memory_bytes: int
    """What labelling it takes at most."""


def read_plan(program: str, flags: list[str]) -> tuple[list[Scene], int]:
    """The scenes of a log, by the flags that say which log and how it is labelled.

    And the bytes of memory that its tables take, as far as the program that read them tells: each
    process that labels reads them too.
    """
    command = [program, "plan", *flags]
    try:
        ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    except OSError as error:
        raise Refused(f"error: {program} cannot be started: {error}") from error
    if ended.returncode not in (COMPLETE, DEGRADED):
        raise Refused(ended.stderr.strip(), max(1, ended.returncode))
    scenes = [scene_of(json.loads(line)) for line in ended.stdout.splitlines()]
    if not scenes:
        raise Refused("error: no scene to label")
    return scenes, peak_bytes_of_children()


def peak_bytes_of_children() -> int:
    """What the largest program that this process started, and that has ended, had of memory."""
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * unit


def scene_of(line: dict) -> Scene:
    """A line of the plan; what it says beyond this is left aside."""
    return Scene(
        name=line["scene"],
        shard=line["shard"],
        keyframes=line["keyframes"],
        cpu_seconds=line["cpu_seconds"],
        memory_bytes=line["memory_bytes"],
    )


def in_shards(scenes: list[Scene], count: int) -> list[Scene]:
    """The scenes in fewer shards, as `--shard` divides them: every N-th, counted from the I-th."""
    shares: dict[int, list[Scene]] = {}
    for scene in scenes:
        index, of = map(int, scene.shard.split("/"))
        if count >= of:
            return scenes
        shares.setdefault(index % count, []).append(scene)
    return [as_one(share, f"{at}/{count}") for at, share in sorted(shares.items())]


def as_one(scenes: list[Scene], shard: str) -> Scene:
    """What one process labels, one after the other."""
    first, *others = scenes
    return replace(
        first,
        name=f"{first.name} and {len(others)} more" if others else first.name,
        shard=shard,
        keyframes=sum(scene.keyframes for scene in scenes),
        cpu_seconds=sum(scene.cpu_seconds for scene in scenes),
        memory_bytes=max(scene.memory_bytes for scene in scenes),
    )


def largest_first(scenes: Iterable[Scene]) -> list[Scene]:
    """The most expensive scene first, so that none is left to run alone at the end.

    Graham, Bounds on Multiprocessing Timing Anomalies, 1969: at most 4/3 of the best order.
    """
    return sorted(scenes, key=lambda scene: (-scene.cpu_seconds, scene.shard))


def first_line(error: Exception) -> str:
    """Of what an error says."""
    return (str(error).strip().splitlines() or [type(error).__name__])[0]
