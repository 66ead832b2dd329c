"""Ray as the engine: a task for each scene, on whichever node has room for it."""

import ray
from ray.exceptions import RayError

from occlabel_ray.label import Ending, Line, Try, label
from occlabel_ray.plan import Scene


class Cluster:
    """Labels scenes on the Ray cluster that this process is connected to."""

    def __init__(self, line: Line, jobs: int) -> None:
        """Each scene takes `jobs` CPUs and the memory that the plan expects of it."""
        self.line, self.jobs = line, jobs
        self.running: dict[ray.ObjectRef, Scene] = {}
        # A lost worker is counted as a try by who schedules: Ray itself tries nothing again.
        self.task = ray.remote(max_retries=0)(label)

    def has_room(self) -> bool:
        """Whether fewer than twice as many scenes are in work or wait as the nodes hold."""
        at_once = max(1, int(ray.cluster_resources().get("CPU", 0)) // self.jobs)
        return len(self.running) < 2 * at_once

    def submit(self, scene: Scene) -> None:
        """Has a scene labelled as soon as a node has room."""
        memory_bytes = min(scene.memory_bytes, largest_node_bytes())
        task = self.task.options(
            num_cpus=self.jobs, memory=memory_bytes, name=f"label {scene.name}"
        )
        self.running[task.remote(self.line, scene.shard)] = scene

    def next_ended(self) -> tuple[Scene, Try]:
        """Waits until one of the scenes has ended; a lost worker is a failed try."""
        [reference], _ = ray.wait(list(self.running), num_returns=1)
        scene = self.running.pop(reference)
        try:
            return scene, ray.get(reference)
        except RayError as error:
            return scene, Try(Ending.FAILED, f"the worker was lost: {type(error).__name__}")


def largest_node_bytes() -> int:
    """What a task may ask for: Ray would wait for ever for a node that has more.

    Whether a scene fits is told by the program itself, with the bytes that it needs.
    """
    alive = (node for node in ray.nodes() if node["Alive"])
    return max((int(node["Resources"].get("memory", 0)) for node in alive), default=0)
