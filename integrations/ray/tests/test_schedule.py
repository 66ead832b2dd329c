"""Who labels what when, on an engine that is a list."""

import pytest

from occlabel_ray.label import Ending, Try
from occlabel_ray.plan import Refused, Scene, largest_first, scene_of
from occlabel_ray.schedule import run


class Played:
    """Ends scenes as written down, in the order in which they were submitted."""

    def __init__(self, endings, places=2):
        self.endings = {name: iter(of_scene) for name, of_scene in endings.items()}
        self.places = places
        self.running, self.submitted = [], []

    def has_room(self):
        return len(self.running) < self.places

    def submit(self, scene):
        assert self.has_room()
        self.running.append(scene)
        self.submitted.append(scene.name)

    def next_ended(self):
        scene = self.running.pop(0)
        ending = next(self.endings[scene.name])
        return scene, Try(ending, f"{scene.name} said so")


def scenes(**costs):
    return [
        Scene(name, f"{at}/{len(costs)}", 40, cost, 1 << 30)
        for at, (name, cost) in enumerate(costs.items())
    ]


def test_the_most_expensive_scene_goes_first():
    assert [scene.name for scene in largest_first(scenes(a=1, b=9, c=5, d=9))] == list("bdca")


def test_no_more_is_begun_than_there_is_room_for():
    engine = Played({name: [Ending.COMPLETE] for name in "abcde"}, places=2)
    outcome = run(scenes(a=1, b=2, c=3, d=4, e=5), engine, 3, lambda line: None)
    assert engine.submitted == list("edcba") == outcome.complete


def test_a_scene_that_fails_is_tried_again_and_at_last_set_aside():
    fails, ends = Ending.FAILED, Ending.COMPLETE
    engine = Played({"a": [fails, fails, ends], "b": [fails] * 3, "c": [Ending.DEGRADED]})
    told = []
    outcome = run(scenes(a=1, b=2, c=3), engine, 3, told.append)
    assert (outcome.complete, outcome.degraded) == (["a"], ["c"])
    assert outcome.set_aside == {"b": "b said so"}
    assert outcome.tries == {"a": 3, "b": 3, "c": 1}
    assert len(told) == 7
    assert told.count("3 of 3 scenes; b: failed in try 3, set aside: b said so") <= 1
    assert sum("tried again" in line for line in told) == 4


def test_what_no_try_would_mend_ends_the_run():
    engine = Played({"a": [Ending.REFUSED]})
    with pytest.raises(Refused, match="a said so"):
        run(scenes(a=1), engine, 3, lambda line: None)


def test_what_else_a_plan_says_is_left_aside():
    line = {"scene": "s", "shard": "0/1", "keyframes": 2, "cpu_seconds": 1.5, "memory_bytes": 3}
    assert scene_of({**line, "rays": 7}) == Scene("s", "0/1", 2, 1.5, 3)
