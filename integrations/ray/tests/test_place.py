"""Whether a machine is fit to label, and what is sent to it."""

import os
import subprocess
import sys

import pytest

from occlabel_ray.label import Line
from occlabel_ray.place import Needs, Place, fault_of, needs_of
from occlabel_ray.plan import Refused


def test_a_fit_place_has_the_program_and_sees_the_output(program, tmp_path):
    line = Line(program("echo occlabel 1"), [], str(tmp_path))
    with needs_of(line, "labels/here") as needs:
        assert Place(line, needs).fault() == ""
        assert needs.version == "occlabel 1"
        assert os.path.dirname(needs.mark) == str(tmp_path / "labels/here")
    assert list((tmp_path / "labels/here").iterdir()) == []


def test_an_unfit_place_says_why(program, tmp_path):
    line = Line(program("echo occlabel 1"), [], str(tmp_path))
    needs = Needs("occlabel 1", None)
    told = {
        "no folder": fault_of(Line(line.program, [], "/absent"), needs),
        "occlabel 1, the driver's is": fault_of(line, Needs("occlabel 2", None)),
        "not the folder that the driver has": fault_of(line, Needs("occlabel 1", "/absent/mark")),
        "cannot be started": fault_of(Line("absent", [], str(tmp_path)), needs),
    }
    for expected, fault in told.items():
        assert expected in fault
        assert "\n" not in fault


def test_a_store_has_no_mark(program, tmp_path):
    with needs_of(Line(program("echo 1"), [], str(tmp_path)), "s3://bucket/labels") as needs:
        assert needs == Needs("1", None)
    assert not (tmp_path / "s3:").exists()


def test_an_output_that_cannot_be_made_is_refused(program, tmp_path):
    line = Line(program("echo 1"), [], str(tmp_path))
    with pytest.raises(Refused, match="File exists"), needs_of(line, "occlabel"):
        pass


def test_nodes_need_not_have_this_package(program, tmp_path):
    pytest.importorskip("ray")
    from occlabel_ray.cluster import ray

    line = Line(program("echo $@ >&2; exit 3"), ["--format", "any"], str(tmp_path))
    place = ray.cloudpickle.dumps((Place, line, Needs("1", None)))
    does = """
import sys
from ray import cloudpickle
place, line, needs = cloudpickle.loads(sys.stdin.buffer.read())
assert "occlabel_ray" not in sys.modules
print(place(line, needs).label("0/4")[:2])
"""
    elsewhere = [sys.executable, "-I", "-c", does]
    said = subprocess.run(elsewhere, input=place, cwd="/", capture_output=True, check=True)
    assert said.stdout == b"(3, 'label --format any --shard 0/4 --progress none')\n"
