"""Labelling one scene: what a worker runs."""

import ctypes
import resource
import signal
import socket
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import partial

COMPLETE, USAGE, DEGRADED = 0, 2, 3
"""Exit codes of the program."""

PR_SET_PDEATHSIG = 1
"""See prctl(2)."""

LAST_CHARACTERS = 2000
"""How much of what the program said is kept."""


class Ending(Enum):
    """How a try ended."""

    COMPLETE = "complete"
    DEGRADED = "degraded"
    """Labelled, but something was left out; the run's report lists it."""
    FAILED = "failed"
    REFUSED = "refused"
    """By the command line or the configuration: no scene would do better."""


@dataclass(frozen=True)
class Try:
    """What came of labelling a scene once."""

    code: int | None
    """The program's exit code; none if it has none, as it was not started or is lost."""
    told: str = ""
    """What the program said at last."""
    seconds: float = 0.0
    """How long the worker was at it."""
    cpu_seconds: float = 0.0
    """What the program took of CPUs."""
    host: str = ""
    """Where it ran, if that is known."""

    @property
    def ending(self) -> Ending:
        """What the exit code says; a negative one is a signal's."""
        endings = {COMPLETE: Ending.COMPLETE, DEGRADED: Ending.DEGRADED, USAGE: Ending.REFUSED}
        return endings.get(self.code, Ending.FAILED)


@dataclass(frozen=True)
class Line:
    """What every scene of a run is labelled with."""

    program: str
    flags: list[str]
    """Of `occlabel label`."""
    folder: str
    """Where relative paths begin."""
    timeout_s: float | None = None
    """After which a try has failed."""


def label(line: Line, shard: str) -> Try:
    """Labels a shard in a process that does not outlive this one.

    Whatever ends it, nothing is half-written: a second try goes on where the first one ended.
    """
    command = [line.program, "label", *line.flags, "--shard", shard, "--progress", "none"]
    began, cpu_before = time.monotonic(), cpu_seconds_of_children()
    code, told = run(command, line.folder, line.timeout_s)
    seconds, cpu = time.monotonic() - began, cpu_seconds_of_children() - cpu_before
    return Try(code, told[-LAST_CHARACTERS:].strip(), seconds, cpu, socket.gethostname())


def run(command: list[str], folder: str, timeout_s: float | None) -> tuple[int | None, str]:
    """The exit code of a program, none if it did not end by itself, and what it said."""
    try:
        ended = subprocess.run(
            command,
            cwd=folder,
            timeout=timeout_s,
            preexec_fn=ending_with_parent(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
        )
    except subprocess.TimeoutExpired:
        return None, f"not done after {timeout_s} s"
    except OSError as error:
        return None, f"cannot be started: {error}"
    return ended.returncode, ended.stderr


def cpu_seconds_of_children() -> float:
    """What the programs that this process started, and that have ended, took of CPUs."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def ending_with_parent() -> Callable[[], object] | None:
    """What has Linux kill a process when the one that started it is gone; elsewhere, nothing does.

    It is looked up here: between fork and exec, little may be done safely.
    """
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    return prctl and partial(prctl, PR_SET_PDEATHSIG, signal.SIGKILL)
