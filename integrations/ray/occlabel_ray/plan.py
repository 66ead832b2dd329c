"""What there is to label: the lines of ``occlabel plan``."""

import json
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass

from occlabel_ray.label import COMPLETE, DEGRADED, USAGE


class Refused(Exception):
    """Something that no further try would mend: the input, the configuration, the cluster."""

    def __init__(self, told: str, code: int = USAGE) -> None:
        """What is told, and the exit code of the run."""
        super().__init__(told)
        self.code = code


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
    return scenes


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
