"""Who labels what when: largest first, tried again, set aside after too many tries."""

from collections import Counter, deque
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

    def next_ended(self) -> tuple[Scene, Try]:
        """Waits until one of the submitted scenes has ended, well or not."""


@dataclass
class Outcome:
    """What came of a run."""

    complete: list[str] = field(default_factory=list)
    degraded: list[str] = field(default_factory=list)
    set_aside: dict[str, str] = field(default_factory=dict)
    """Scenes that failed too often, with what was said of each at last."""
    tries: Counter[str] = field(default_factory=Counter)

    def ended(self) -> int:
        """How many scenes need nothing more."""
        return len(self.complete) + len(self.degraded) + len(self.set_aside)


def run(
    scenes: Iterable[Scene], engine: Engine, tries: int, tell: Callable[[str], None]
) -> Outcome:
    """Labels all scenes, each in at most so many tries."""
    waiting = deque(largest_first(scenes))
    count, outcome = len(waiting), Outcome()
    while outcome.ended() < count:
        while waiting and engine.has_room():
            engine.submit(waiting.popleft())
        scene, last = engine.next_ended()
        outcome.tries[scene.name] += 1
        if not settle(outcome, scene, last, tries):
            waiting.append(scene)
        tell(line_of(outcome, count, scene, last))
    return outcome


def settle(outcome: Outcome, scene: Scene, last: Try, tries: int) -> bool:
    """Whether a scene needs nothing more."""
    if last.ending is Ending.REFUSED:
        raise Refused(last.told)
    if last.ending is Ending.COMPLETE:
        outcome.complete.append(scene.name)
    elif last.ending is Ending.DEGRADED:
        outcome.degraded.append(scene.name)
    elif outcome.tries[scene.name] >= tries:
        outcome.set_aside[scene.name] = last.told
    else:
        return False
    return True


def line_of(outcome: Outcome, count: int, scene: Scene, last: Try) -> str:
    """How far the run is."""
    line = f"{outcome.ended()} of {count} scenes; {scene.name}: {last.ending.value}"
    if last.ending is not Ending.FAILED:
        return line
    fate = "set aside" if scene.name in outcome.set_aside else "tried again"
    return f"{line} in try {outcome.tries[scene.name]}, {fate}: {last.told}"
