"""What there is to label: the lines of ``occlabel plan``."""

import json
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass


class Refused(Exception):
    """The program refuses its input or its configuration; trying again would not help."""


@dataclass(frozen=True)
class Scene:
    """A scene as a work item."""

    name: str
    shard: str
    """``I/N``: what ``--shard`` is given."""
    keyframes: int
    cpu_seconds: float
    """What labelling it is expected to cost."""
    memory_bytes: int
    """What labelling it takes at most."""


def read_plan(program: str, flags: list[str]) -> list[Scene]:
    """The scenes of a log, by the flags that say which log and how it is labelled."""
    ended = subprocess.run([program, "plan", *flags], capture_output=True, text=True)
    if ended.returncode not in (0, 3):
        raise Refused(ended.stderr.strip())
    return [scene_of(json.loads(line)) for line in ended.stdout.splitlines()]


def scene_of(line: dict) -> Scene:
    """A line of the plan; what it says beyond this is left aside."""
    return Scene(
        name=line["scene"],
        shard=line["shard"],
        keyframes=line["keyframes"],
        cpu_seconds=line["cpu_seconds"],
        memory_bytes=line["memory_bytes"],
    )


def largest_first(scenes: Iterable[Scene]) -> list[Scene]:
    """The most expensive scene first, so that none is left to run alone at the end.

    Graham, Bounds on Multiprocessing Timing Anomalies, 1969: at most 4/3 of the best order.
    """
    return sorted(scenes, key=lambda scene: (-scene.cpu_seconds, scene.shard))
