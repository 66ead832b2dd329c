"""Ray as the engine: places on its nodes, each a process that labels a scene at a time."""

from collections.abc import Callable, Sequence

import ray
from ray.exceptions import RayError

import occlabel_ray
from occlabel_ray.label import Line, Try
from occlabel_ray.place import Needs, Place
from occlabel_ray.plan import Refused, Scene, first_line

# Nodes need Ray and the program, and not this package: what they run is sent to them.
ray.cloudpickle.register_pickle_by_value(occlabel_ray)

LOOK_AGAIN_S = 5.0
"""How often the nodes are looked at while no scene ends: some may have come."""

CANCELLED_S = 30.0
"""How long scenes in work may take to end when the run is ended."""

LOST_AT_MOST = 10
"""So many places may be lost as they open before any has opened."""


class Cluster:
    """Labels scenes on the Ray cluster that this process is connected to.

    A task for each scene would wait some 0.1 s for its turn on a node that is not the driver's; a
    place that is held waits for nothing.
    """

    def __init__(self, line: Line, needs: Needs, size: "Size", tell: Callable[[str], None]) -> None:
        """Places are asked for when scenes are waited for."""
        # A lost place is counted as a try by who schedules: Ray itself tries nothing again.
        memory_bytes = size.memory_bytes or None
        self.place = ray.remote(num_cpus=size.cpus, memory=memory_bytes, max_restarts=0)(Place)
        self.line, self.needs, self.size, self.tell = line, needs, size, tell
        self.coming: dict[ray.ObjectRef, ray.actor.ActorHandle] = {}
        self.idle: list[ray.actor.ActorHandle] = []
        self.running: dict[ray.ObjectRef, tuple[ray.actor.ActorHandle, Scene]] = {}
        # They keep what they hold of their nodes, so that no other place opens there.
        self.unfit: list[ray.actor.ActorHandle] = []
        self.told: set[str] = set()
        self.most_places, self.lost = 0, 0

    def has_room(self) -> bool:
        """Whether a place is idle."""
        return bool(self.idle)

    def submit(self, scene: Scene) -> None:
        """Has a scene labelled at once."""
        place = self.idle.pop()
        self.running[place.label.remote(scene.shard)] = place, scene

    def ended(self) -> list[tuple[Scene, Try]]:
        """Waits for a scene to end or a place to open, not for ever."""
        self.ask_for_places()
        awaited = [*self.running, *self.coming]
        ray.wait(awaited, num_returns=1, timeout=LOOK_AGAIN_S)
        ready, _ = ray.wait(awaited, num_returns=len(awaited), timeout=0)
        for reference in [one for one in ready if one in self.coming]:
            self.open(reference)
        self.most_places = max(self.most_places, len(self.idle) + len(self.running))
        return [self.end(reference) for reference in ready if reference in self.running]

    def ask_for_places(self) -> None:
        """As many in all as the nodes hold, and no more than there are scenes."""
        held = sum(int(cpus) // self.size.cpus for cpus in of_nodes("CPU"))
        if held == 0:
            self.tell_once(f"no node has the {self.size.cpus} CPUs of a scene: waiting for one")
        wanted = min(max(1, held), self.size.scenes + len(self.unfit))
        there = sum(map(len, (self.coming, self.idle, self.running, self.unfit)))
        for _ in range(wanted - there):
            place = self.place.remote(self.line, self.needs)
            self.coming[place.fault.remote()] = place

    def open(self, reference: ray.ObjectRef) -> None:
        """Takes a place that has come into use, if it is fit."""
        place = self.coming.pop(reference)
        try:
            fault = ray.get(reference)
        except RayError as error:
            return self.lost_opening(error)
        (self.unfit if fault else self.idle).append(place)
        if fault:
            self.tell_once(f"not used: {fault}")
        if not self.idle and not self.running and not self.coming:
            raise Refused("error: no place is fit to label")

    def lost_opening(self, error: RayError) -> None:
        """Bears with places that are lost as they open, if not with all of them."""
        self.lost += 1
        told = f"a place was lost as it opened: {type(error).__name__}: {first_line(error)}"
        self.tell_once(told)
        if self.most_places == 0 and self.lost >= LOST_AT_MOST:
            raise Refused(f"error: {told}")

    def end(self, reference: ray.ObjectRef) -> tuple[Scene, Try]:
        """What came of a scene; a place that was lost leaves a failed try."""
        place, scene = self.running.pop(reference)
        try:
            ended = Try(*ray.get(reference))
        except RayError as error:
            return scene, Try(None, f"its worker was lost: {type(error).__name__}")
        self.idle.append(place)
        return scene, ended

    def cancel(self) -> None:
        """Ends the scenes in work."""
        for place, _ in self.running.values():
            ray.kill(place)
        if self.running:
            ray.wait(list(self.running), num_returns=len(self.running), timeout=CANCELLED_S)

    def tell_once(self, line: str) -> None:
        """Tells what has not been told."""
        if line not in self.told:
            self.told.add(line)
            self.tell(line)


class Size:
    """How large places are, and how many at most."""

    def __init__(self, scenes: Sequence[Scene], cpus: int, tables_bytes: int = 0) -> None:
        """Any place may be given the scene that takes most memory, and reads the log's tables."""
        self.scenes, self.cpus = len(scenes), cpus
        wanted = max(scene.memory_bytes for scene in scenes) + tables_bytes
        largest = int(max(of_nodes("memory"), default=0))
        self.memory_bytes = min(wanted, largest)
        """Ray would wait for ever for a node that has more than any."""
        self.bound_bytes = max(1, largest - tables_bytes) if 0 < largest < wanted else None
        """For a scene, where no node has what is wanted."""


def of_nodes(resource: str) -> list[float]:
    """What each node that is alive has of a resource."""
    return [node["Resources"].get(resource, 0) for node in ray.nodes() if node["Alive"]]
