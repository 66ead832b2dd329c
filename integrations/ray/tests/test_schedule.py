"""Who labels what when, on an engine that is a list."""

import pytest

from occlabel_ray.label import COMPLETE, DEGRADED, USAGE, Try
from occlabel_ray.plan import Refused, Scene, in_shards, largest_first, scene_of
from occlabel_ray.progress import Progress, duration, lines, report
from occlabel_ray.schedule import run

FAILED = 1


class Played:
    """Ends scenes as written down, in the order in which they were submitted."""

    def __init__(self, endings, places=2):
        self.endings = {name: iter(of_scene) for name, of_scene in endings.items()}
        self.places = places
        self.running, self.submitted, self.cancelled = [], [], []

    def has_room(self):
        return len(self.running) < self.places

    def submit(self, scene):
        assert self.has_room()
        self.running.append(scene)
        self.submitted.append(scene.name)

    def ended(self):
        if not self.running:
            return []
        scene = self.running.pop(0)
        return [(scene, Try(next(self.endings[scene.name]), f"{scene.name} said so"))]

    def cancel(self):
        self.cancelled = [scene.name for scene in self.running]


def scenes(**costs):
    return [
        Scene(name, f"{at}/{len(costs)}", 40, cost, 1 << 30)
        for at, (name, cost) in enumerate(costs.items())
    ]


def nobody(*_):
    """Is told nothing."""


def test_the_most_expensive_scene_goes_first():
    assert [scene.name for scene in largest_first(scenes(a=1, b=9, c=5, d=9))] == list("bdca")


def test_no_more_is_begun_than_there_is_room_for():
    engine = Played({name: [COMPLETE] for name in "abcde"}, places=2)
    outcome = run(scenes(a=1, b=2, c=3, d=4, e=5), engine, 3, nobody)
    assert engine.submitted == list("edcba") == outcome.complete


def test_a_scene_that_fails_is_tried_again_and_at_last_set_aside():
    engine = Played({"a": [FAILED, None, COMPLETE], "b": [FAILED] * 3, "c": [DEGRADED]})
    told, work = [], scenes(a=1, b=2, c=3)
    outcome = run(work, engine, 3, Progress(work, told.append))
    assert (outcome.complete, outcome.degraded, outcome.set_aside) == (["a"], ["c"], ["b"])
    assert {name: len(tries) for name, tries in outcome.tries.items()} == {"a": 3, "b": 3, "c": 1}
    assert len(told) == 7
    assert sum("b said so" in line for line in told) == 3
    assert sum("try 3, set aside: b said so" in line for line in told) == 1
    assert sum("to be tried again" in line for line in told) == 4


def test_what_no_try_would_mend_ends_the_run():
    engine = Played({"a": [USAGE], "b": [COMPLETE]})
    with pytest.raises(Refused, match="a said so"):
        run(scenes(a=2, b=1), engine, 3, nobody)
    assert engine.cancelled == ["b"]


def test_an_interrupt_cancels_what_is_in_work():
    def interrupt(*_):
        raise KeyboardInterrupt

    engine = Played({name: [COMPLETE] for name in "abc"})
    with pytest.raises(KeyboardInterrupt):
        run(scenes(a=3, b=2, c=1), engine, 3, interrupt)
    assert (engine.submitted, engine.cancelled) == (["a", "b"], ["b"])


def test_the_report_counts_tries_and_tells_of_what_was_set_aside():
    engine = Played({"a": [FAILED, COMPLETE], "b": [None] * 2, "c": [DEGRADED]})
    told = report(run(scenes(a=1, b=2, c=3), engine, 2, nobody), places=2, seconds=7.0)
    assert (told["shards"], told["complete"], told["degraded"]) == (3, 1, ["c"])
    assert told["set_aside"] == {"b": "b said so"}
    assert (told["tries"], told["lost"], told["tried_again"]) == (5, 2, {"a": 2, "b": 2})
    assert lines(told) == [
        "set aside: b: b said so",
        "1 of 3 shards complete, 1 with something left out, 1 set aside; 5 tries",
        "7.0 s on 2 places, which labelled for 0% of it; 0.0 s of CPU",
    ]


def test_what_is_left_is_told_from_the_plan():
    work = scenes(a=30, b=10)
    told = []
    progress = Progress(work, told.append)
    progress.began -= 60
    run(work, Played({"a": [COMPLETE], "b": [COMPLETE]}, places=1), 3, progress)
    assert told[0].startswith("1 of 2 shards, 20 s left; a: complete in ")
    assert told[1].startswith("2 of 2 shards; b: complete in ")


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(0.04, "0.0 s"), (9.96, "10 s"), (99.4, "99 s"), (100, "2 min"), (6000, "1 h 40 min")],
)
def test_durations(seconds, told):
    assert duration(seconds) == told


def test_what_else_a_plan_says_is_left_aside():
    line = {"scene": "s", "shard": "0/1", "keyframes": 2, "cpu_seconds": 1.5, "memory_bytes": 3}
    assert scene_of({**line, "rays": 7}) == Scene("s", "0/1", 2, 1.5, 3)


def test_fewer_shards_than_scenes_are_divided_as_the_program_does():
    work = scenes(a=1, b=2, c=3, d=4, e=5)
    assert in_shards(work, 5) == in_shards(work, 9) == work
    assert in_shards(work, 2) == [
        Scene("a and 2 more", "0/2", 120, 9, 1 << 30),
        Scene("b and 1 more", "1/2", 80, 6, 1 << 30),
    ]
    assert [scene.name for scene in in_shards(work, 4)] == ["a and 1 more", "b", "c", "d"]
