"""Processes of this machine, as /proc tells of them."""

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Process:
    """A process that lived when it was looked at."""

    pid: int
    parent: int
    state: str
    words: list[str]
    """Its command line."""


def look_at(pid):
    """A process; none if it is gone."""
    try:
        state, parent, *_ = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        words = Path(f"/proc/{pid}/cmdline").read_bytes().decode().rstrip("\0").split("\0")
    except (FileNotFoundError, ProcessLookupError):
        return None
    return Process(int(pid), int(parent), state, words)


def labelling(program, log):
    """The programs that label a log, each in the hands of a Ray worker."""
    pids = [path.name for path in Path("/proc").iterdir() if path.name.isdigit()]
    for process in filter(None, map(look_at, pids)):
        is_ours = process.words[:2] == [program, "label"] and str(log) in process.words
        worker = look_at(process.parent)
        if is_ours and process.state != "Z" and worker and worker.words[0].startswith("ray::"):
            yield process


def halt(process):
    """Stops a process; whether it has stopped."""
    try:
        os.kill(process.pid, signal.SIGSTOP)
    except ProcessLookupError:
        return False
    wait_for(lambda: (now := look_at(process.pid)) is None or now.state in "TZ")
    now = look_at(process.pid)
    return now is not None and now.state == "T"


def is_gone(pid):
    """Whether a process has ended."""
    process = look_at(pid)
    return process is None or process.state == "Z"


def wait_for(find, seconds=60):
    """What is found at last."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := find():
            return found
        time.sleep(0.02)
    raise AssertionError("it did not come")
