"""How a run goes, in lines for people, and how it went, in a file for programs."""

import time
from collections.abc import Callable, Iterable

from occlabel_ray.label import Ending, Try
from occlabel_ray.plan import Scene
from occlabel_ray.schedule import Outcome


class Progress:
    """Tells of every try how far the run is by then."""

    def __init__(self, scenes: Iterable[Scene], tell: Callable[[str], None]) -> None:
        """The clock runs from here."""
        self.tell = tell
        self.cost, self.done = sum(scene.cpu_seconds for scene in scenes), 0.0
        self.began = time.monotonic()

    def __call__(self, outcome: Outcome, scene: Scene, last: Try) -> None:
        """Tells of a scene that ended, or is to be tried again."""
        count = len(outcome.tries[scene.name])
        how = f"{scene.name}: {last.ending.value} in {duration(last.seconds)}"
        if last.ending is not Ending.FAILED:
            self.done += scene.cpu_seconds
        elif scene.name in outcome.set_aside:
            self.done += scene.cpu_seconds
            how = f"{how}, try {count}, set aside: {last.told}"
        else:
            how = f"{how}, try {count}, to be tried again: {last.told}"
        self.tell(f"{outcome.ended()} of {outcome.shards} shards{self.left()}; {how}")

    def seconds(self) -> float:
        """Since the beginning."""
        return time.monotonic() - self.began

    def left(self) -> str:
        """How long the rest will take, if it goes on as it went."""
        if not 0 < self.done < self.cost:
            return ""
        return f", {duration(self.seconds() * (self.cost / self.done - 1))} left"


def report(outcome: Outcome, places: int, seconds: float) -> dict:
    """What came of a run, as JSON."""
    tries = [one for of_scene in outcome.tries.values() for one in of_scene]
    again = {name: len(of) for name, of in outcome.tries.items() if len(of) > 1}
    aside = {name: outcome.tries[name][-1].told for name in outcome.set_aside}
    return {
        "shards": outcome.shards,
        "complete": len(outcome.complete),
        "degraded": outcome.degraded,
        "set_aside": aside,
        "tries": len(tries),
        "tried_again": again,
        "lost": sum(one.code is None for one in tries),
        "seconds": seconds,
        "places": places,
        "labelling_seconds": sum(one.seconds for one in tries),
        "cpu_seconds": sum(one.cpu_seconds for one in tries),
    }


def lines(report: dict) -> list[str]:
    """The same for people."""
    aside = [f"set aside: {name}: {told}" for name, told in report["set_aside"].items()]
    counts = (
        f"{report['complete']} of {report['shards']} shards complete, "
        f"{len(report['degraded'])} with something left out, {len(aside)} set aside"
    )
    busy = report["labelling_seconds"] / max(1e-9, report["places"] * report["seconds"])
    times = (
        f"{duration(report['seconds'])} on {report['places']} places, which labelled for "
        f"{min(1.0, busy):.0%} of it; {duration(report['cpu_seconds'])} of CPU"
    )
    return [*aside, f"{counts}; {report['tries']} tries", times]


def duration(seconds: float) -> str:
    """Seconds as people say them."""
    if seconds < 99.5:
        return f"{seconds:.1f} s" if seconds < 9.95 else f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
