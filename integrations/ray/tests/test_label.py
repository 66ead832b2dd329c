"""Labelling one scene, by a program that does as it is told."""

import subprocess
import sys

import pytest
from processes import is_gone, wait_for

from occlabel_ray.label import Ending, Line, label


@pytest.mark.parametrize(
    ("does", "ending"),
    [
        ("exit 0", Ending.COMPLETE),
        ("exit 1", Ending.FAILED),
        ("exit 2", Ending.REFUSED),
        ("exit 3", Ending.DEGRADED),
        ("exit 130", Ending.FAILED),
        ("kill -9 $$", Ending.FAILED),
    ],
)
def test_exit_codes(program, does, ending):
    assert label(Line(program(does), [], "."), "0/1").ending is ending


def test_a_shard_is_labelled_with_the_flags_of_the_run(program, tmp_path):
    line = Line(program('echo "$@" > line; echo why >&2'), ["--format", "mcap"], tmp_path)
    assert label(line, "3/7").told == "why"
    told = (tmp_path / "line").read_text()
    assert told == "label --format mcap --shard 3/7 --progress none\n"


def test_a_try_may_take_so_long_and_no_longer(program):
    ended = label(Line(program("sleep 60"), [], ".", timeout_s=0.2), "0/1")
    assert (ended.ending, ended.told) == (Ending.FAILED, "not done after 0.2 s")
    assert 0.2 <= ended.seconds < 30


def test_what_a_try_takes_is_measured(program):
    ended = label(Line(program("i=0; while [ $i -lt 50000 ]; do i=$((i+1)); done"), [], "."), "0/1")
    assert 0 < ended.cpu_seconds <= 1.1 * ended.seconds
    assert ended.host


def test_a_program_that_cannot_be_started_is_a_failed_try(tmp_path):
    ended = label(Line("./absent", [], str(tmp_path)), "0/1")
    assert (ended.code, ended.ending) == (None, Ending.FAILED)
    assert ended.told == "cannot be started: [Errno 2] No such file or directory: './absent'"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends a process with its parent")
def test_the_program_does_not_outlive_a_killed_worker(program, tmp_path):
    does = f"echo $$ > {tmp_path}/pid; exec sleep 60"
    line = Line(program(does), [], ".")
    worker = f"from occlabel_ray.label import Line, label; label({line!r}, '0/1')"
    process = subprocess.Popen([sys.executable, "-c", worker])
    noted = tmp_path / "pid"
    pid = wait_for(lambda: noted.exists() and noted.read_text().strip())
    assert not is_gone(pid)
    process.kill()
    process.wait()
    wait_for(lambda: is_gone(pid))
