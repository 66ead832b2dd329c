"""Labelling one scene, by a program that does as it is told."""

import os
import subprocess
import sys
import time

import pytest

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
    line = Line(program("sleep 60"), [], ".", timeout_s=0.2)
    assert label(line, "0/1").ending is Ending.FAILED


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends a process with its parent")
def test_the_program_does_not_outlive_a_killed_worker(program, tmp_path):
    does = f"echo $$ > {tmp_path}/pid; exec sleep 60"
    line = Line(program(does), [], ".")
    worker = f"from occlabel_ray.label import Line, label; label({line!r}, '0/1')"
    process = subprocess.Popen([sys.executable, "-c", worker])
    pid = wait_for(lambda: (tmp_path / "pid").read_text().strip())
    process.kill()
    process.wait()
    wait_for(lambda: not is_running(pid) or None)


def wait_for(find):
    for _ in range(200):
        try:
            found = find()
        except FileNotFoundError:
            found = None
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError("it did not come")


def is_running(pid):
    try:
        with open(f"/proc/{pid}/stat") as stat:
            return stat.read().rsplit(")")[1].split()[0] != "Z"
    except FileNotFoundError:
        return False
    finally:
        assert os.getpid() != int(pid)
