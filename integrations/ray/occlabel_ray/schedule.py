"""Who labels what when: largest first, tried again, set aside after too many tries."""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Protocol

from occlabel_ray.label import Ending, Try
from occlabel_ray.plan import Refused, Scene, largest_first


class Engine(Protocol):
    """Runs scenes somewhere, several at once."""

    def has_room(self) -> bool:
        """Whether one more scene would soon be begun."""

    def submit(self, scene: Scene) -> None:
        """Has a scene labelled as soon as somebody is free."""

    def ended(self) -> list[tuple[Scene, Try]]:
        """Waits for some of the submitted scenes to end, well or not; perhaps in vain."""

    def cancel(self) -> None:
        """Ends all submitted scenes."""


@dataclass
class Outcome:
    """What came of a run."""

    shards: int
    """How many there are to label: one a scene, or fewer."""
    tries: dict[str, list[Try]] = field(default_factory=dict)
    """All of each scene that was tried, in order."""
    complete: list[str] = field(default_factory=list)
    degraded: list[str] = field(default_factory=list)
    set_aside: list[str] = field(default_factory=list)
    """Scenes that failed too often."""

    def ended(self) -> int:
        """How many scenes need nothing more."""
        return len(self.complete) + len(self.degraded) + len(self.set_aside)


def run(
    scenes: Iterable[Scene],
    engine: Engine,
    tries: int,
    each: Callable[[Outcome, Scene, Try], None],
) -> Outcome:
    """Labels all scenes, each in at most so many tries; `each` is told of every try."""
    waiting = deque(largest_first(scenes))
    outcome = Outcome(len(waiting))
    try:
        while outcome.ended() < outcome.shards:
            while waiting and engine.has_room():
                engine.submit(waiting.popleft())
            for scene, last in engine.ended():
                if not settle(outcome, scene, last, tries):
                    waiting.append(scene)
                each(outcome, scene, last)
    except BaseException:
        engine.cancel()
        raise
    return outcome


def settle(outcome: Outcome, scene: Scene, last: Try, tries: int) -> bool:
    """Whether a scene needs nothing more."""
    if last.ending is Ending.REFUSED:
        raise Refused(last.told)
    of_scene = outcome.tries.setdefault(scene.name, [])
    of_scene.append(last)
    if last.ending is Ending.COMPLETE:
        outcome.complete.append(scene.name)
    elif last.ending is Ending.DEGRADED:
        outcome.degraded.append(scene.name)
    elif len(of_scene) >= tries:
        outcome.set_aside.append(scene.name)
    else:
        return False
    return True
