"""What the command says to those who err."""

import pytest

from occlabel_ray import cluster
from occlabel_ray.command import main, own_flags, parse
from occlabel_ray.plan import Scene

PLAN = (
    """echo '{"scene": "s", "shard": "0/1", "keyframes": 1, "cpu_seconds": 1, "memory_bytes": 1}'"""
)


def told_by(capfd, *arguments):
    """The exit code, and what was said on stderr."""
    try:
        code = main(["--output", "labels", *arguments, "--", "--format", "any"])
    except SystemExit as exited:
        code = exited.code
    return code, capfd.readouterr().err


def test_a_program_that_is_not_there(capfd):
    code, told = told_by(capfd, "--program", "./absent")
    assert (code, told.count("\n")) == (2, 1)
    assert told.startswith("error: ./absent cannot be started: ")


@pytest.mark.parametrize("code", [1, 2])
def test_a_plan_that_the_program_refuses(capfd, program, code):
    line = program(f"echo 'error: nowhere: expected a log, found nothing' >&2; exit {code}")
    expected = "error: nowhere: expected a log, found nothing\n"
    assert told_by(capfd, "--program", line) == (code, expected)


def test_a_log_without_scenes(capfd, program):
    assert told_by(capfd, "--program", program("exit 0")) == (2, "error: no scene to label\n")


@pytest.mark.parametrize(
    ("flags", "expected"),
    [
        (["--jobs", "0"], "at least 1"),
        (["--tries", "none"], "invalid"),
        (["--resume", "perhaps"], "invalid choice"),
        (["--", "--output=elsewhere"], "--output=elsewhere is not said after `--`"),
        (["--", "--shard", "0/4"], "--shard is not said after `--`"),
    ],
)
def test_a_wrong_command_line(capfd, flags, expected):
    code, told = told_by(capfd, *flags)
    assert code == 2
    assert expected in told.splitlines()[-1]


@pytest.mark.parametrize("address", ["127.0.0.1:1", "ray://127.0.0.1:1", "127.0.0.1:port"])
def test_no_cluster_at_the_address(capfd, program, address):
    pytest.importorskip("ray")
    code, told = told_by(capfd, "--program", program(PLAN), "--address", address)
    assert (code, told.count("\n")) == (2, 1)
    assert told.startswith(f"error: no Ray cluster at {address}: ")


@pytest.mark.parametrize(
    ("nodes", "flags", "asked", "told"),
    [
        ([8, 6], [], 8, []),
        ([7, 6], [], 7, ["--memory", "6"]),
        ([5, 6], ["--memory=5"], 6, []),
        ([0], [], 0, []),
    ],
)
def test_a_place_asks_for_no_more_memory_than_a_node_has(monkeypatch, nodes, flags, asked, told):
    monkeypatch.setattr(cluster, "of_nodes", lambda resource: nodes)
    scenes = [Scene(str(need), "0/2", 1, 1.0, need) for need in (3, 7)]
    size = cluster.Size(scenes, 1, tables_bytes=1)
    args = parse(["--output", "out", "--resume", "never", "--", "--format", "any", *flags])
    assert size.memory_bytes == asked
    assert own_flags(args, size) == ["--output", "out", "--resume", "never", *told]
